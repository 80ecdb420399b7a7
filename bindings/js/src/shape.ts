/** Shapes, contact manifolds between them, and the broad phase. */
import { type Manifold, Method, ShapeType, type Vector } from "./api.js";
import { CAPACITY, check, SupportError } from "./errors.js";
import { argument, doubles, got, number, owned, point, read, rows, sizeOf, struct, vector, whole, write,
} from "./memory.js";
import { allocate, c, callbacks, frame, room, views } from "./wasm.js";

/** Direction to the farthest point along it, body axes. */
export type Support = (direction: Float64Array) => Vector;

const supports = new Map<number, Support>();
let lastSupport = 0;
let fault: { thrown: unknown } | undefined;

callbacks.support = (user, direction, out) => {
  let found: number[] = [NaN, NaN, NaN];
  try {
    const given = supports.get(user)!(new Float64Array(doubles(direction, 3)));
    found = [0, 1, 2].map((i) => number(given[i], "support"));
  } catch (thrown) {
    fault ??= { thrown };
  }
  views().f64.set(found, out / 8);
};

/** Run a call that may ask support functions; what one of them threw becomes the cause of the error. */
export function supported<T>(call: () => T): T {
  const outer = fault;
  fault = undefined;
  try {
    return call();
  } catch (error) {
    const inner = fault as { thrown: unknown } | undefined;
    if (error instanceof SupportError && inner) {
      error.cause = inner.thrown;
    }
    throw error;
  } finally {
    fault = outer;
  }
}

/** Where a shape is. */
export interface Place {
  position?: Vector;
  orientation?: Vector;
}

const pose = (place: Place): number => struct("tribo_pose",
  { position: place.position ?? [0, 0, 0], orientation: place.orientation ?? [1, 0, 0, 0] }, "pose");

interface Parts {
  size?: readonly number[];
  data?: number;
  count?: number;
  keep?: unknown;
}

/** A shape; made by the functions below. It keeps alive what it is made of. */
export class Shape {
  /** What the shape is: ShapeType. */
  readonly kind: ShapeType;
  /** Lengths, as the kind of shape has them. */
  readonly size: readonly number[];
  readonly #parts: Parts;

  /** @internal */
  constructor(kind: ShapeType, parts: Parts) {
    this.kind = kind;
    this.size = Object.freeze([...(parts.size ?? [])].map((x, i) => number(x, `size[${i}]`)));
    this.#parts = parts;
    if (parts.data) {
      const { data } = parts;
      owned(this, () => c.js_release(data));
    }
    frame(() => check(c.tribo_shape_check(this.struct()), "Shape"));
  }

  /** @internal The struct of C, at an address or in the room of the call that runs. */
  struct(at = got(room(sizeOf("tribo_shape")), "Shape")): number {
    write(at, "tribo_shape", { type: this.kind, count: this.#parts.count ?? 0,
      size: [...this.size, 0, 0, 0, 0].slice(0, 4) }, "Shape");
    point(at, "tribo_shape", "data", this.#parts.data ?? 0);
    return at;
  }

  /** The farthest point along a direction. */
  support(direction: Vector): number[] {
    return frame(() => supported(() => {
      const out = got(room(24), "support");
      check(c.tribo_shape_support(this.struct(), vector(direction, 3, "direction"), out), "support");
      return doubles(out, 3);
    }));
  }

  /** Axis-aligned bounds at a pose. */
  bounds(place: Place = {}): { low: number[]; high: number[] } {
    return frame(() => supported(() => {
      const [low, high] = [got(room(24), "bounds"), got(room(24), "bounds")];
      check(c.tribo_shape_bounds(this.struct(), pose(place), low, high), "bounds");
      return { low: doubles(low, 3), high: doubles(high, 3) };
    }));
  }

  /** Mass, centre of mass and inertia (9) of a uniform solid of this shape. */
  mass(density: number): { mass: number; center: number[]; inertia: number[] } {
    return frame(() => {
      const out = got(room(104), "mass");
      check(c.tribo_shape_mass(this.struct(), number(density, "density"), out, out + 8, out + 32),
        "mass");
      const all = doubles(out, 13);
      return { mass: all[0]!, center: all.slice(1, 4), inertia: all.slice(4) };
    });
  }
}

export const sphere = (radius: number): Shape => new Shape(ShapeType.SPHERE, { size: [radius] });
/** Half-extents. */
export const box = (x: number, y: number, z: number): Shape =>
  new Shape(ShapeType.BOX, { size: [x, y, z] });
export const capsule = (radius: number, halfHeight: number): Shape =>
  new Shape(ShapeType.CAPSULE, { size: [radius, halfHeight] });
export const cylinder = (radius: number, halfHeight: number): Shape =>
  new Shape(ShapeType.CYLINDER, { size: [radius, halfHeight] });
export const cone = (radius: number, halfHeight: number): Shape =>
  new Shape(ShapeType.CONE, { size: [radius, halfHeight] });
export const ellipsoid = (a: number, b: number, d: number): Shape =>
  new Shape(ShapeType.ELLIPSOID, { size: [a, b, d] });
/** All x with normal . x <= d. */
export const halfspace = (normal: Vector, d = 0): Shape =>
  new Shape(ShapeType.HALFSPACE, { size: [...Array.from(normal), d] });

/** A block that a function of C fills: asked for its size first. */
function block(where: string, build: (at: number, capacity: number, needed: number) => number): number {
  const needed = got(room(8), where);
  const status = build(0, 0, needed);
  if (status !== CAPACITY) {
    check(status, where);
  }
  const bytes = views().u32[needed / 4]!;
  const at = got(allocate(bytes), where);
  const second = build(at, bytes, needed);
  if (second !== 0) {
    c.js_release(at);
    check(second, where);
  }
  return at;
}

/** Convex hull of points (3 numbers each). */
export function hull(points: Float64Array): Shape {
  return frame(() => {
    const n = rows(points, 3, "points");
    const { pointer } = argument(points, Float64Array, 3 * n, "points");
    const data = block("hull", (at, capacity, needed) =>
      c.tribo_hull_build(n, pointer, at, capacity, needed));
    return new Shape(ShapeType.HULL, { data });
  });
}

/** Static triangle mesh: vertices (3 numbers each), triangles (3 indices each). */
export function mesh(vertices: Float64Array, triangles: Uint32Array): Shape {
  return frame(() => {
    const n = rows(vertices, 3, "vertices");
    const corners = argument(triangles, Uint32Array, undefined, "triangles").pointer;
    if (triangles.length % 3 !== 0) {
      throw new RangeError("triangles: three indices a triangle are needed");
    }
    const { pointer } = argument(vertices, Float64Array, 3 * n, "vertices");
    const data = block("mesh", (at, capacity, needed) => c.tribo_mesh_build(n, pointer,
      triangles.length / 3, corners, at, capacity, needed));
    return new Shape(ShapeType.MESH, { data });
  });
}

/** Convex parts, each at its place. */
export function compound(children: readonly (Place & { shape: Shape })[]): Shape {
  const size = sizeOf("tribo_child");
  const data = got(allocate(size * children.length), "compound");
  children.forEach(({ shape, ...place }, i) => {
    const at = data + size * i;
    frame(() => {
      shape.struct(at);
      write(at + sizeOf("tribo_shape"), "tribo_pose", read(pose(place), "tribo_pose"), "compound");
    });
  });
  return new Shape(ShapeType.COMPOUND, { data, count: children.length, keep: [...children] });
}

/** A convex shape by its support function. center: a point well inside; radius: of a ball around it
 *  that holds the shape. Calls that use the shape throw SupportError if the function throws, or gives no
 *  three numbers. */
export function convex(support: Support, center: Vector, radius: number): Shape {
  if (typeof support !== "function") {
    throw new TypeError("convex: a function is needed");
  }
  const data = got(allocate(sizeOf("tribo_convex")), "convex");
  frame(() => {
    const struct_ = struct("tribo_convex", { center, radius }, "convex");
    views().u8.copyWithin(data, struct_, struct_ + sizeOf("tribo_convex"));
  });
  const id = ++lastSupport;
  point(data, "tribo_convex", "support", c.js_support());
  point(data, "tribo_convex", "user", id);
  supports.set(id, support);
  const shape = new Shape(ShapeType.CONVEX, { data, keep: support });
  owned(shape, () => supports.delete(id));
  return shape;
}

// ---- manifolds -----------------------------------------------------------------------------------

/** Options of a query. */
export interface TouchSettings {
  method?: Method;
  maxPoints?: number;
  margin?: number;
}

function shown(at: number): Manifold {
  const manifold = read(at, "tribo_manifold");
  return { ...manifold, points: manifold.points.slice(0, manifold.count) };
}

/** Contact manifolds between two shapes at poses; none if they are farther apart than `margin`. */
export function touch(a: Shape, placeA: Place, b: Shape, placeB: Place, options: TouchSettings = {},
): Manifold[] {
  return frame(() => supported(() => {
    const settings = struct("tribo_collide_options", options, "options");
    const [count, size] = [got(room(8), "touch"), sizeOf("tribo_manifold")];
    for (let capacity = 4; ; capacity = views().u32[count / 4]!) {
      const out = got(room(size * capacity), "touch");
      const status = c.tribo_collide_shapes(a.struct(), pose(placeA), b.struct(), pose(placeB),
        settings, capacity, out, count, 0);
      if (status !== CAPACITY) {
        check(status, "touch");
        return Array.from({ length: views().u32[count / 4]! }, (_, i) => shown(out + size * i));
      }
    }
  }));
}

/** One manifold for each pair of indices of convex shapes, each at its place. */
export function touchBatch(shapes: readonly (Place & { shape: Shape })[], pairs: Uint32Array,
  options: TouchSettings = {}): Manifold[] {
  return frame(() => supported(() => {
    if (pairs.length % 2 !== 0) {
      throw new RangeError("pairs: two indices a pair are needed");
    }
    const [one, another, size] = [sizeOf("tribo_shape"), sizeOf("tribo_pose"), sizeOf("tribo_manifold")];
    const list = got(room(one * shapes.length), "touchBatch");
    const poses = got(room(another * shapes.length), "touchBatch");
    shapes.forEach(({ shape, ...place }, i) => {
      shape.struct(list + one * i);
      write(poses + another * i, "tribo_pose", read(pose(place), "tribo_pose"), "pose");
    });
    const n = pairs.length / 2;
    const out = got(room(size * n), "touchBatch");
    check(c.tribo_collide_batch(shapes.length, list, poses, n,
      argument(pairs, Uint32Array, 2 * n, "pairs").pointer,
      struct("tribo_collide_options", options, "options"), out, 0, 0), "touchBatch");
    return Array.from({ length: n }, (_, i) => shown(out + size * i));
  }));
}

// ---- broad phase ---------------------------------------------------------------------------------

/** Fill an array of uint32_t whose length C tells. */
function ids(where: string, width: number, fill: (n: number, out: number, count: number) => number,
): Uint32Array {
  const count = got(room(8), where);
  const status = fill(0, 0, count);
  if (status !== CAPACITY) {
    check(status, where);
    return new Uint32Array(0);
  }
  const n = views().u32[count / 4]!;
  const out = got(room(4 * width * n), where);
  check(fill(n, out, count), where);
  return views().u32.slice(out / 4, out / 4 + width * n);
}

/** Which of many axis-aligned boxes overlap: a dynamic tree. */
export class Tree {
  readonly #tree: number;

  constructor(capacity: number, margin = 0) {
    const bytes = c.tribo_tree_size(whole(capacity, "capacity"));
    const at = got(allocate(bytes), "Tree");
    this.#tree = at;
    owned(this, () => c.js_release(at));
    frame(() => check(c.tribo_tree_init(at, capacity, number(margin, "margin"),
      got(room(8), "Tree")), "Tree"));
  }

  /** Add a box; returns its id. */
  add(low: Vector, high: Vector): number {
    return frame(() => {
      const id = got(room(8), "Tree.add");
      check(c.tribo_tree_add(this.#tree, vector(low, 3, "low"), vector(high, 3, "high"), id),
        "Tree.add");
      return views().u32[id / 4]!;
    });
  }

  move(id: number, low: Vector, high: Vector): void {
    frame(() => check(c.tribo_tree_move(this.#tree, whole(id, "id"), vector(low, 3, "low"),
      vector(high, 3, "high")), "Tree.move"));
  }

  remove(id: number): void {
    check(c.tribo_tree_remove(this.#tree, whole(id, "id")), "Tree.remove");
  }

  /** Overlapping pairs of ids, two numbers each, sorted. */
  pairs(): Uint32Array {
    return frame(() => ids("Tree.pairs", 2, (n, out, count) =>
      c.tribo_tree_pairs(this.#tree, n, out, count)));
  }

  /** Ids of boxes that overlap a box, sorted. */
  queryBox(low: Vector, high: Vector): Uint32Array {
    return frame(() => {
      const [a, b] = [vector(low, 3, "low"), vector(high, 3, "high")];
      return ids("Tree.queryBox", 1, (n, out, count) =>
        c.tribo_tree_query_box(this.#tree, a, b, n, out, count));
    });
  }

  /** Ids of boxes that a segment meets, sorted. */
  queryRay(from: Vector, to: Vector): Uint32Array {
    return frame(() => {
      const [a, b] = [vector(from, 3, "from"), vector(to, 3, "to")];
      return ids("Tree.queryRay", 1, (n, out, count) =>
        c.tribo_tree_query_ray(this.#tree, a, b, n, out, count));
    });
  }
}
