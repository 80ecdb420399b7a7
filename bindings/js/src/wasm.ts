/** The module: its functions, its memory, and room in it for the arguments of one call. */
import type { Functions } from "./api.js";

export interface Raw extends Functions {
  readonly memory: WebAssembly.Memory;
  _initialize(): void;
  js_allocate(bytes: number): number;
  js_release(pointer: number): void;
  js_contact_solve(problem: number): number;
  js_support(): number;
  js_progress(): number;
  js_clock(): number;
}

/** What C calls: each must return, for an exception would leave its stack as it is. */
export const callbacks = {
  support: (_user: number, _direction: number, _point: number): void => undefined,
  progress: (_user: number, _info: number): number => 0,
};

async function read(url: URL): Promise<BufferSource> {
  if (url.protocol === "file:") {
    const name = "node:fs/promises"; // a variable: bundlers for browsers leave it alone
    const fs = await import(/* @vite-ignore */ /* webpackIgnore: true */ name);
    return fs.readFile(url);
  }
  const response = await fetch(url);
  if (!response.ok) {
    throw new Error(`tribo: ${url.href}: ${response.status} ${response.statusText}`);
  }
  return response.arrayBuffer();
}

async function load(): Promise<Raw> {
  const module = await WebAssembly.compile(await read(new URL("./tribo.wasm", import.meta.url)));
  const tribo = {
    support: (user: number, direction: number, point: number) =>
      callbacks.support(user, direction, point),
    progress: (user: number, info: number) => callbacks.progress(user, info),
    clock: () => performance.now() / 1000,
  };
  // What libc would ask of a system; it is told that there is none (ENOSYS).
  const system: Record<string, () => number> = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    if (from !== "tribo") {
      system[name] = () => 52;
    }
  }
  const instance = await WebAssembly.instantiate(module, { tribo, wasi_snapshot_preview1: system });
  const raw = instance.exports as unknown as Raw;
  raw._initialize();
  return raw;
}

/** All functions of the C library, as they are: see the headers. */
export const c: Raw = await load();

// ---- memory --------------------------------------------------------------------------------------

/** Views of all of the memory. */
export interface Views {
  readonly f64: Float64Array;
  readonly u32: Uint32Array;
  readonly i32: Int32Array;
  readonly u8: Uint8Array;
  readonly u64: BigUint64Array;
}

let buffer: ArrayBufferLike | undefined;
let current: Views;

/** The views as of now: growth of the memory detaches those from before. */
export function views(): Views {
  if (buffer !== c.memory.buffer) {
    const whole = c.memory.buffer;
    buffer = whole;
    current = {
      f64: new Float64Array(whole), u32: new Uint32Array(whole), i32: new Int32Array(whole),
      u8: new Uint8Array(whole), u64: new BigUint64Array(whole),
    };
  }
  return current;
}

/** Memory of C for `bytes`, all zeros; 0 if there is none. */
export function allocate(bytes: number): number {
  if (!(bytes < 2 ** 32 - 16)) {
    return 0;
  }
  const pointer = c.js_allocate(Math.max(bytes, 8)) >>> 0;
  if (pointer !== 0) {
    views().u8.fill(0, pointer, pointer + Math.max(bytes, 8));
  }
  return pointer;
}

/** A string of C. */
export function text(pointer: number): string {
  const { u8 } = views();
  return new TextDecoder().decode(u8.slice(pointer, u8.indexOf(0, pointer)));
}

// ---- room for one call ---------------------------------------------------------------------------

const ROOM = 65536;
const start = allocate(ROOM);
let top = start;
const pieces: number[] = [];

/** Run a call; what it took by room() is given back at its end. Calls may be nested. */
export function frame<T>(call: () => T): T {
  const [mark, count] = [top, pieces.length];
  try {
    return call();
  } finally {
    top = mark;
    while (pieces.length > count) {
      c.js_release(pieces.pop() as number);
    }
  }
}

/** Memory for the call that runs, all zeros; aligned to 8. 0 if there is none. */
export function room(bytes: number): number {
  const size = Math.ceil(bytes / 8) * 8;
  if (top + size <= start + ROOM) {
    const pointer = top;
    top += size;
    views().u8.fill(0, pointer, top);
    return pointer;
  }
  const piece = allocate(size);
  if (piece !== 0) {
    pieces.push(piece);
  }
  return piece;
}
