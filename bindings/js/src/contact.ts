/** One contact and many that do not influence each other: bodies, materials, impacts, batches. */
import { type Body, type Change, type CollisionInfo, type ContactGeometry, type ImpactInfo, Isa,
  type Law, type Material, type Measures, Mix, type SolveInfo, type Totals, type Vector,
} from "./api.js";
import { check } from "./errors.js";
import { type Argument, argument, type Array32, type Array64, type ArrayStatus, doubles, got, number,
  read, Resident, rows, struct, structs, vector, whole } from "./memory.js";
import { c, frame, room, text, views } from "./wasm.js";

// ---- bodies and materials ------------------------------------------------------------------------

export const AT_REST: Readonly<Body> = Object.freeze({
  position: [0, 0, 0], orientation: [1, 0, 0, 0], velocity: [0, 0, 0], angularVelocity: [0, 0, 0],
  inverseMass: 0, inverseInertia: [0, 0, 0, 0, 0, 0],
});

/** A body, judged: immovable at the origin but for what is given. */
export function body(state: Partial<Body> & { mass?: number; inertia?: Vector } = {}): Body {
  return frame(() => {
    const { mass, inertia, ...rest } = state;
    const out = struct("tribo_body", { ...AT_REST, ...rest }, "body");
    if (mass !== undefined || inertia !== undefined) {
      check(c.tribo_body_set_mass(out, number(mass, "mass"),
        vector(inertia as Vector, 9, "inertia")), "body");
    }
    check(c.tribo_body_check(out), "body");
    return read(out, "tribo_body");
  });
}

/** A body after `dt` seconds of free flight. */
export function advance(state: Body, dt: number, acceleration: Vector = [0, 0, 0]): Body {
  return frame(() => {
    const out = struct("tribo_body", state, "body");
    check(c.tribo_body_advance(out, vector(acceleration, 3, "acceleration"), number(dt, "dt")),
      "advance");
    return read(out, "tribo_body");
  });
}

/** A body after an impulse (N s, world axes) at an arm from its centre of mass. */
export function applyImpulse(state: Body, arm: Vector, impulse: Vector): Body {
  return frame(() => {
    const out = struct("tribo_body", state, "body");
    check(c.tribo_body_apply_impulse(out, vector(arm, 3, "arm"), vector(impulse, 3, "impulse")),
      "applyImpulse");
    return read(out, "tribo_body");
  });
}

/** Momentum about `origin` and kinetic energy of bodies. */
export function totals(bodies: readonly Body[], origin: Vector = [0, 0, 0]): Totals {
  return frame(() => {
    const out = struct("tribo_totals");
    check(c.tribo_audit_bodies(bodies.length, structs("tribo_body", bodies, "bodies"),
      vector(origin, 3, "origin"), out), "totals");
    return read(out, "tribo_totals");
  });
}

/** What changed between two totals of the same bodies. */
export function change(before: Totals, after: Totals): Change {
  return frame(() => {
    const out = struct("tribo_change");
    check(c.tribo_audit_change(struct("tribo_totals", before, "before"),
      struct("tribo_totals", after, "after"), out), "change");
    return read(out, "tribo_change");
  });
}

/** Coefficients, judged; muD: muS if it is not given. */
export function material(muS = 0, muD = muS, e = 0): Material {
  return frame(() => {
    const out = struct("tribo_material", { muS, muD, e }, "material");
    check(c.tribo_material_check(out), "material");
    return { muS, muD, e };
  });
}

/** The pair of two surfaces. */
export function mix(a: Material, b: Material, friction: Mix = Mix.GEOMETRIC_MEAN,
  restitution: Mix = Mix.GEOMETRIC_MEAN): Material {
  return frame(() => {
    const out = struct("tribo_material");
    check(c.tribo_material_mix(struct("tribo_material", a, "a"), struct("tribo_material", b, "b"),
      whole(friction, "friction"), whole(restitution, "restitution"), out), "mix");
    return read(out, "tribo_material");
  });
}

/** The table of pairs: "wood on stone" and so on. */
export function materials(): Record<string, Material> {
  return frame(() => {
    const [name, out] = [got(room(8), "materials"), struct("tribo_material")];
    const table: Record<string, Material> = {};
    for (let i = 0; i < c.tribo_material_count(); i++) {
      check(c.tribo_material_at(i, name, out), "materials");
      table[text(views().u32[name / 4]!)] = read(out, "tribo_material");
    }
    return table;
  });
}

/** Entry of the table of pairs. */
export function materialNamed(name: string): Material {
  return frame(() => {
    const bytes = new TextEncoder().encode(name);
    const [pointer, out] = [got(room(bytes.length + 1), name), struct("tribo_material")];
    views().u8.set(bytes, pointer);
    check(c.tribo_material_find(pointer, out), name);
    return read(out, "tribo_material");
  });
}

/** Quaternion (w, x, y, z) of the rotation by |v| radians about v. */
export function rotation(v: Vector): number[] {
  return frame(() => {
    const out = got(room(32), "rotation");
    check(c.tribo_quat_from_rotation_vector(vector(v, 3, "v"), out), "rotation");
    return doubles(out, 4);
  });
}

/** v / |v|. */
export function normalize(v: Vector): number[] {
  return frame(() => {
    const out = vector(v, 3, "v");
    check(c.tribo_vec3_normalize(out, out), "normalize");
    return doubles(out, 3);
  });
}

// ---- one contact ---------------------------------------------------------------------------------

/** Exact Signorini-Coulomb solve of one contact: v = W p + b.
 *
 *  w: 6 numbers (symmetric: nn, n1, n2, 11, 12, 22) or 9 (any, row by row). */
export function solve(w: Vector, b: Vector, muS: number, muD = muS,
): SolveInfo & { impulse: number[] } {
  return frame(() => {
    const [p, info] = [got(room(24), "solve"), struct("tribo_solve_info")];
    const general = w.length === 9;
    const call = general ? c.tribo_contact_solve_general : c.tribo_contact_solve;
    check(call(vector(w, general ? 9 : 6, "w"), vector(b, 3, "b"), number(muS, "muS"),
      number(muD, "muD"), p, info), "solve");
    return { impulse: doubles(p, 3), ...read(info, "tribo_solve_info") };
  });
}

/** Options of an impact. */
export interface ImpactSettings {
  law?: Law;
  tangentialRestitution?: number;
}

/** Impulse of an impact with relative velocity u = (n, t1, t2). */
export function impact(w: Vector, u: Vector, pair: Material, options: ImpactSettings = {},
): ImpactInfo & { impulse: number[] } {
  return frame(() => {
    const [p, info] = [got(room(24), "impact"), struct("tribo_impact_info")];
    check(c.tribo_impact(vector(w, 6, "w"), vector(u, 3, "u"), struct("tribo_material", pair, "pair"),
      struct("tribo_impact_options", options, "options"), p, info), "impact");
    return { impulse: doubles(p, 3), ...read(info, "tribo_impact_info") };
  });
}

/** A whole collision of two bodies (b null: the world). Returns what it did and the bodies after it. */
export function collide(a: Body, b: Body | null, point: Vector, normal: Vector, pair: Material,
  options: ImpactSettings = {}): CollisionInfo & { a: Body; b: Body | null } {
  return frame(() => {
    const [first, info] = [struct("tribo_body", a, "a"), struct("tribo_collision_info")];
    const second = b === null ? 0 : struct("tribo_body", b, "b");
    check(c.tribo_collide(first, second, vector(point, 3, "point"), vector(normal, 3, "normal"),
      struct("tribo_material", pair, "pair"), struct("tribo_impact_options", options, "options"),
      info), "collide");
    return { ...read(info, "tribo_collision_info"), a: read(first, "tribo_body"),
      b: b === null ? null : read(second, "tribo_body") };
  });
}

/** One contact whose numbers stay in the memory of C: change w, b and mu, call solve, read p. For loops
 *  that solve one contact at a time. */
export class Contact {
  readonly #numbers = new Resident(Float64Array, 14);
  readonly #pointer = this.#numbers.at(Float64Array, "Contact");

  /** 14 numbers, w (6), b (3), mu_s, mu_d, p (3): a view as of now, see Resident. */
  get numbers(): Float64Array {
    return this.#numbers.array;
  }

  /** p solves v = W p + b; on an error p stays as it was. */
  solve(): void {
    const status = c.js_contact_solve(this.#pointer);
    if (status !== 0) {
      check(status, "Contact.solve");
    }
  }
}

/** The point of the friction cone nearest to p. */
export function coneProject(p: Vector, mu: number): number[] {
  return frame(() => {
    const out = got(room(24), "coneProject");
    check(c.tribo_cone_project(vector(p, 3, "p"), number(mu, "mu"), out), "coneProject");
    return doubles(out, 3);
  });
}

/** Whether p lies in the friction cone, to a relative tolerance. */
export function coneContains(p: Vector, mu: number, tolerance = 0): boolean {
  return frame(() => c.tribo_cone_contains(vector(p, 3, "p"), number(mu, "mu"), tolerance) !== 0);
}

// ---- batches -------------------------------------------------------------------------------------

/** Where a batch puts its results; arrays that are not given are made. With `statuses` a contact's own
 *  fault is told there and does not throw. */
export interface BatchResults {
  p?: Array64;
  modes?: Array32;
  statuses?: ArrayStatus;
}

export interface BatchSolution {
  p: Array64;
  modes: Array32;
}

function batch(count: number, out: BatchResults, where: string,
  call: (p: number, modes: number, statuses: number) => number): BatchSolution {
  const p = out.p ?? new Float64Array(3 * count);
  const modes = out.modes ?? new Uint32Array(count);
  const results: Argument[] = [argument(p, Float64Array, 3 * count, "p"),
    argument(modes, Uint32Array, count, "modes")];
  if (out.statuses) {
    results.push(argument(out.statuses, Int32Array, count, "statuses"));
  }
  const status = call(results[0]!.pointer, results[1]!.pointer, results[2]?.pointer ?? 0);
  results.forEach((result) => result.back());
  if (!out.statuses || !told(results[2]!.pointer, count)) {
    check(status, where);
  }
  return { p, modes };
}

function told(statuses: number, count: number): boolean {
  return views().i32.subarray(statuses / 4, statuses / 4 + count).some((status) => status !== 0);
}

/** Exact solve of many contacts: w (6 each), b (3), mu (2: mu_s, mu_d). */
export function batchSolve(w: Array64, b: Array64, mu: Array64, out: BatchResults = {},
  isa: Isa = Isa.BEST): BatchSolution {
  return frame(() => {
    const n = rows(w, 6, "w");
    const [first, second, third] = [argument(w, Float64Array, 6 * n, "w"),
      argument(b, Float64Array, 3 * n, "b"), argument(mu, Float64Array, 2 * n, "mu")];
    return batch(n, out, "batchSolve", (p, modes, statuses) => c.tribo_batch_solve(
      whole(isa, "isa"), n, first.pointer, second.pointer, third.pointer, p, modes, statuses));
  });
}

/** ALGEBRAIC impacts of many contacts: w (6 each), u (3), pairs (3: mu_s, mu_d, e). */
export function batchImpact(w: Array64, u: Array64, pairs: Array64, out: BatchResults = {},
  isa: Isa = Isa.BEST): BatchSolution {
  return frame(() => {
    const n = rows(w, 6, "w");
    const [first, second, third] = [argument(w, Float64Array, 6 * n, "w"),
      argument(u, Float64Array, 3 * n, "u"), argument(pairs, Float64Array, 3 * n, "pairs")];
    return batch(n, out, "batchImpact", (p, modes, statuses) => c.tribo_batch_impact(
      whole(isa, "isa"), n, first.pointer, second.pointer, third.pointer, p, modes, statuses));
  });
}

/** Frames (9 each) and contact matrices (6) of contacts between bodies, by pairs of indices. */
export function batchMatrix(bodies: readonly Body[], pairs: Uint32Array,
  contacts: readonly ContactGeometry[], isa: Isa = Isa.BEST): { frames: Float64Array; w: Float64Array } {
  return frame(() => {
    const n = contacts.length;
    const [frames, w] = [new Float64Array(9 * n), new Float64Array(6 * n)];
    const [first, second] = [argument(frames, Float64Array, 9 * n, "frames"),
      argument(w, Float64Array, 6 * n, "w")];
    check(c.tribo_batch_matrix(whole(isa, "isa"), bodies.length,
      structs("tribo_body", bodies, "bodies"), n, argument(pairs, Uint32Array, 2 * n, "pairs").pointer,
      structs("tribo_contact", contacts, "contacts"), first.pointer, second.pointer, 0),
    "batchMatrix");
    first.back();
    second.back();
    return { frames, w };
  });
}

/** Greatest and root-mean-square measures of impulses: w (6 each), b (3), mu (1), p (3). */
export function audit(w: Array64, b: Array64, mu: Array64, p: Array64,
): { max: Measures; rms: Measures } {
  return frame(() => {
    const n = rows(w, 6, "w");
    const [max, rms] = [struct("tribo_measures"), struct("tribo_measures")];
    check(c.tribo_audit_contacts(n, argument(w, Float64Array, 6 * n, "w").pointer,
      argument(b, Float64Array, 3 * n, "b").pointer, argument(mu, Float64Array, n, "mu").pointer,
      argument(p, Float64Array, 3 * n, "p").pointer, max, rms), "audit");
    return { max: read(max, "tribo_measures"), rms: read(rms, "tribo_measures") };
  });
}
