/** Numbers and structs on their way to C and back; arrays that stay there. */
import { LAYOUTS, type Structs, type Vector } from "./api.js";
import { errorOf, MEMORY } from "./errors.js";
import { allocate, c, room, views } from "./wasm.js";

/** A pointer that is not null. */
export function got(pointer: number, where: string): number {
  if (pointer === 0) {
    throw errorOf(MEMORY, where);
  }
  return pointer;
}

/** Memory that is freed when its owner is collected, or earlier by release(). */
const owners = new FinalizationRegistry<() => void>((free) => free());

export function owned(owner: object, free: () => void): void {
  owners.register(owner, free, owner);
}

export function released(owner: object): void {
  owners.unregister(owner);
}

// ---- numbers -------------------------------------------------------------------------------------

export function number(x: unknown, name: string): number {
  if (typeof x !== "number") {
    throw new TypeError(`${name}: a number is needed, not ${typeof x}`);
  }
  return x;
}

/** An integer that uint32_t holds: ids, indices, counts, values of enumerations. */
export function whole(x: unknown, name: string): number {
  const value = number(x, name);
  if (!Number.isInteger(value) || value < 0 || value >= 2 ** 32) {
    throw new RangeError(`${name}: an integer from 0 to 2^32 - 1 is needed, not ${value}`);
  }
  return value;
}

function entries(x: unknown, length: number, name: string): ArrayLike<unknown> {
  const array = x as ArrayLike<unknown> | null | undefined;
  if (typeof array !== "object" || array === null || typeof array.length !== "number") {
    throw new TypeError(`${name}: an array of ${length} numbers is needed`);
  }
  if (array.length !== length) {
    throw new RangeError(`${name}: ${length} entries are needed, not ${array.length}`);
  }
  return array;
}

function put(pointer: number, x: unknown, length: number, name: string): void {
  const array = entries(x, length, name);
  const { f64 } = views();
  for (let i = 0; i < length; i++) {
    f64[pointer / 8 + i] = number(array[i], `${name}[${i}]`);
  }
}

/** A short vector of doubles, for the call that runs. */
export function vector(x: Vector, length: number, name: string): number {
  const pointer = got(room(8 * length), name);
  put(pointer, x, length, name);
  return pointer;
}

export function doubles(pointer: number, count: number): number[] {
  return Array.from(views().f64.subarray(pointer / 8, pointer / 8 + count));
}

// ---- structs -------------------------------------------------------------------------------------

type Name = keyof Structs & string;

export const sizeOf = (struct: Name): number => LAYOUTS[struct]!.size;

function writeField(at: number, kind: string, count: number, value: unknown, name: string): void {
  if (count > 0) {
    put(at, value, count, name);
  } else if (kind === "f8") {
    views().f64[at / 8] = number(value, name);
  } else if (kind === "u8") {
    views().u64[at / 8] = BigInt(number(value, name));
  } else if (kind in LAYOUTS) {
    write(at, kind as Name, value as object, name);
  } else {
    views().u32[at / 4] = whole(value, name);
  }
}

/** Write the fields that are given; others stay as they are. */
export function write<S extends Name>(pointer: number, struct: S, value: Partial<Structs[S]>,
  name: string): void {
  if (typeof value !== "object" || value === null) {
    throw new TypeError(`${name}: an object is needed, not ${typeof value}`);
  }
  const { fields } = LAYOUTS[struct]!;
  for (const [key, field] of Object.entries(value)) {
    const found = fields.find(([known]) => known === key);
    if (!found) {
      throw new TypeError(`${name}: there is no ${key}`);
    }
    if (field !== undefined) {
      writeField(pointer + found[2], found[1], found[3], field, `${name}.${key}`);
    }
  }
}

function readField(at: number, key: string, kind: string, count: number): unknown {
  if (kind in LAYOUTS) {
    const { size } = LAYOUTS[kind]!;
    return count === 0 ? read(at, kind as Name)
      : Array.from({ length: count }, (_, i) => read(at + size * i, kind as Name));
  }
  const { f64, i32, u32, u64 } = views();
  switch (kind) {
    case "f8": return count === 0 ? f64[at / 8] : doubles(at, count);
    case "u8": return key === "id" ? u64[at / 8] : Number(u64[at / 8]);
    case "i4": return i32[at / 4];
    default: return u32[at / 4];
  }
}

export function read<S extends Name>(pointer: number, struct: S): Structs[S] {
  const out: Record<string, unknown> = {};
  for (const [key, kind, offset, count] of LAYOUTS[struct]!.fields) {
    if (kind !== "pointer" && key !== "structSize" && key !== "reserved") {
      out[key] = readField(pointer + offset, key, kind, count);
    }
  }
  return out as unknown as Structs[S];
}

/** A struct for the call that runs: zeros but what is given; struct_size is set if it has one. */
export function struct<S extends Name>(name: S, value: Partial<Structs[S]> = {}, where: string = name,
): number {
  const { size, fields } = LAYOUTS[name]!;
  const pointer = got(room(size), where);
  if (fields[0]![0] === "structSize") {
    views().u32[pointer / 4] = size;
  }
  write(pointer, name, value, where);
  return pointer;
}

export function offsetOf(struct: Name, key: string): number {
  return LAYOUTS[struct]!.fields.find(([known]) => known === key)![2];
}

/** Set a pointer in a struct. */
export function point(pointer: number, struct: Name, key: string, value: number): void {
  views().u32[(pointer + offsetOf(struct, key)) / 4] = value;
}

// ---- arrays --------------------------------------------------------------------------------------

export type Typed = Float64Array | Uint32Array | Int32Array;
type Constructor<A extends Typed> = {
  new (length: number): A;
  new (buffer: ArrayBufferLike, offset: number, length: number): A;
  readonly BYTES_PER_ELEMENT: number;
  readonly name: string;
};

/** An array that stays in the memory of C: calls take it without copying.
 *
 *  `array` is a view as of now: take it anew after other calls, for the memory may have grown, which
 *  leaves older views with length 0. */
export class Resident<A extends Typed> {
  readonly length: number;
  readonly #kind: Constructor<A>;
  readonly #pointer: number;
  #closed = false;
  #view: A;

  constructor(kind: Constructor<A>, length: number) {
    this.length = whole(length, "length");
    this.#kind = kind;
    const pointer = got(allocate(kind.BYTES_PER_ELEMENT * length), "Resident");
    this.#pointer = pointer;
    this.#view = new kind(c.memory.buffer, pointer, length);
    owned(this, () => c.js_release(pointer));
  }

  get array(): A {
    this.at(this.#kind, "Resident");
    if (this.#view.buffer !== c.memory.buffer) {
      this.#view = new this.#kind(c.memory.buffer, this.#pointer, this.length);
    }
    return this.#view;
  }

  /** Its address, if it is of that kind. */
  at(kind: Constructor<Typed> | Constructor<A>, name: string): number {
    if (this.#closed) {
      throw new Error(`${name}: this array is closed`);
    }
    if (kind !== this.#kind) {
      throw new TypeError(`${name}: ${kind.name} is needed, not ${this.#kind.name}`);
    }
    return this.#pointer;
  }

  /** Free it; closing twice is nothing. */
  close(): void {
    if (!this.#closed) {
      this.#closed = true;
      released(this);
      c.js_release(this.#pointer);
    }
  }
}


/** Doubles in the memory of C. */
export const numbers = (length: number): Resident<Float64Array> => new Resident(Float64Array, length);
/** Integers (uint32_t) in the memory of C. */
export const words = (length: number): Resident<Uint32Array> => new Resident(Uint32Array, length);

export type Array64 = Float64Array | Resident<Float64Array>;
export type Array32 = Uint32Array | Resident<Uint32Array>;
export type ArrayStatus = Int32Array | Resident<Int32Array>;

/** An argument of a call: where C finds it, and what brings results back. */
export interface Argument {
  readonly pointer: number;
  back(): void;
}

/** Judge an array: its kind and length as they are; nothing is converted. A typed array is copied to
 *  the memory of C, and back by back(). */
export function argument<A extends Typed>(x: A | Resident<A>, kind: Constructor<A>,
  length: number | undefined, name: string): Argument {
  if (!(x instanceof Resident) && !(x instanceof (kind as unknown as new () => A))) {
    throw new TypeError(`${name}: a ${kind.name} is needed`);
  }
  if (length !== undefined && x.length !== length) {
    throw new RangeError(`${name}: ${length} entries are needed, not ${x.length}`);
  }
  if (x instanceof Resident) {
    return { pointer: x.at(kind, name), back: () => undefined };
  }
  const pointer = got(room(kind.BYTES_PER_ELEMENT * x.length), name);
  new kind(c.memory.buffer, pointer, x.length).set(x);
  return { pointer, back: () => x.set(new kind(c.memory.buffer, pointer, x.length)) };
}

/** Rows of `width` doubles in an array. */
export function rows(x: Array64, width: number, name: string): number {
  if (!(x instanceof Resident) && !(x instanceof Float64Array)) {
    throw new TypeError(`${name}: a Float64Array is needed`);
  }
  if (x.length % width !== 0) {
    throw new RangeError(`${name}: ${width} numbers a row are needed, not ${x.length} in all`);
  }
  return x.length / width;
}

/** Structs one after another, for the call that runs. */
export function structs<S extends Name>(name: S, values: readonly Partial<Structs[S]>[], where: string,
): number {
  if (!Array.isArray(values)) {
    throw new TypeError(`${where}: an array of objects is needed`);
  }
  const size = sizeOf(name);
  const pointer = got(room(size * values.length), where);
  values.forEach((value, i) => write(pointer + size * i, name, value, `${where}[${i}]`));
  return pointer;
}
