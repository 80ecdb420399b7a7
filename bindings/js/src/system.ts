/** Many contacts coupled through their bodies: solvers, warm start, certificate. */
import { type Body, type ContactGeometry, Factors, type Isa, type Material, type Measure, type Solver,
  type SparseInfo, type SystemContact, type SystemInfo, type Vector, WORLD } from "./api.js";
import { AT_REST } from "./contact.js";
import { check } from "./errors.js";
import { argument, got, point, read, rows, sizeOf, struct, structs } from "./memory.js";
import { Owner } from "./owner.js";
import { c, callbacks, frame, room, views } from "./wasm.js";

/** A contact of a system: what is not given is zero, b the world, dimension 3. */
export interface Coupling {
  a: number;
  b?: number;
  dimension?: number;
  contact: ContactGeometry;
  pair: Material;
  target?: Vector;
  rolling?: number;
  spinning?: number;
}

/** Options of a solve. */
export interface SystemSettings {
  solver?: Solver;
  measure?: Measure;
  tolerance?: number;
  maxIterations?: number;
  maxSeconds?: number;
  /** Start from the impulses of the last call. */
  warmStart?: boolean;
  isa?: Isa;
  /** Called with what is known so far; true stops. */
  progress?: (info: SystemInfo) => boolean;
}

type Progress = { call: (info: SystemInfo) => boolean; fault?: { thrown: unknown } };
let progress: Progress | undefined;

callbacks.progress = (_user, info) => {
  try {
    return progress!.call(read(info, "tribo_system_info")) ? 1 : 0;
  } catch (thrown) {
    progress!.fault ??= { thrown };
    return 1;
  }
};

/** Run a call that reports progress; what the callback throws ends the solve, and is thrown. */
function reporting(call: Progress["call"] | undefined, run: () => void): void {
  const outer = progress;
  const mine: Progress | undefined = call && { call };
  progress = mine;
  try {
    run();
  } finally {
    progress = outer;
  }
  if (mine?.fault) {
    throw mine.fault.thrown;
  }
}

function makeSparse(): number {
  return frame(() => {
    const out = got(room(8), "System");
    check(c.tribo_sparse_create(Factors.AUTO, 0, out), "System");
    return views().u32[out / 4]!;
  });
}

/** Solves systems of bodies and contacts; keeps factorisations and results. */
export class System extends Owner {
  /** Of the last solve: impulses (3 a contact), torques (3), velocities (6 a body). */
  impulses: Float64Array = new Float64Array(0);
  torques: Float64Array = new Float64Array(0);
  velocities: Float64Array = new Float64Array(0);

  constructor() {
    super(makeSparse(), (handle) => c.tribo_sparse_destroy(handle));
  }

  #options(handle: number, settings: SystemSettings): number {
    const { progress: call, warmStart, ...plain } = settings;
    const linear = struct("tribo_linear");
    check(c.tribo_sparse_linear(handle, linear), "System");
    const options = struct("tribo_system_options", { ...plain, warmStart: warmStart ? 1 : 0 }, "options");
    point(options, "tribo_system_options", "linear", linear);
    point(options, "tribo_system_options", "clock", c.js_clock());
    if (call) {
      point(options, "tribo_system_options", "progress", c.js_progress());
    }
    return options;
  }

  #start(count: number, settings: SystemSettings): [Float64Array, Float64Array] {
    if (!settings.warmStart) {
      return [new Float64Array(count), new Float64Array(count)];
    }
    if (this.impulses.length !== count) {
      throw new RangeError("warmStart: the last call had another number of contacts");
    }
    return [this.impulses.slice(), this.torques.slice()];
  }

  /** Solve for bodies and contacts; the certificate is returned, the rest is kept. */
  solve(bodies: readonly Body[], contacts: readonly Coupling[], settings: SystemSettings = {},
  ): SystemInfo {
    return this.alone((handle) => frame(() => {
      const options = this.#options(handle, settings);
      const full = contacts.map((one): Partial<SystemContact> => ({ b: WORLD, dimension: 3, ...one }));
      const [m, n] = [bodies.length, contacts.length];
      const b = structs("tribo_body", bodies.map((one) => ({ ...AT_REST, ...one })), "bodies");
      const k = structs("tribo_system_contact", full, "contacts");
      const [impulses, torques] = this.#start(3 * n, settings);
      const velocities = new Float64Array(6 * m);
      const [p, t, v] = [argument(impulses, Float64Array, 3 * n, "impulses"),
        argument(torques, Float64Array, 3 * n, "torques"),
        argument(velocities, Float64Array, 6 * m, "velocities")];
      point(options, "tribo_system_options", "torques", t.pointer);
      const size = got(room(8), "System.solve");
      check(c.tribo_system_workspace_size(m, n, k, options, size), "System.solve");
      const bytes = views().u32[size / 4]!;
      const [work, info] = [got(room(bytes), "System.solve"), struct("tribo_system_info")];
      reporting(settings.progress, () => check(c.tribo_system_solve(m, b, n, k, options, work, bytes,
        p.pointer, v.pointer, info), "System.solve"));
      [p, t, v].forEach((result) => result.back());
      [this.impulses, this.torques, this.velocities] = [impulses, torques, velocities];
      return read(info, "tribo_system_info");
    }));
  }

  /** Solve u = W r + q: q (3 a contact), mu (2), W dense (9 n^2 numbers, row by row), or by 3x3 blocks with
   *  rowStarts (n + 1) and columns. velocities has 3 numbers a contact. */
  solveAssembled(q: Float64Array, mu: Float64Array, blocks: Float64Array,
    pattern?: { rowStarts: Uint32Array; columns: Uint32Array }, settings: SystemSettings = {},
  ): SystemInfo {
    return this.alone((handle) => frame(() => {
      const n = rows(q, 3, "q");
      const count = pattern ? pattern.columns.length : n * n;
      if (pattern && pattern.rowStarts[n] !== count) {
        throw new RangeError(`rowStarts: the last entry is ${pattern.rowStarts[n]}, not ${count}`);
      }
      const starts = pattern ? argument(pattern.rowStarts, Uint32Array, n + 1, "rowStarts").pointer : 0;
      const columns = pattern ? argument(pattern.columns, Uint32Array, count, "columns").pointer : 0;
      const w = argument(blocks, Float64Array, 9 * count, "blocks").pointer;
      const [first, second] = [argument(q, Float64Array, 3 * n, "q").pointer,
        argument(mu, Float64Array, 2 * n, "mu").pointer];
      const options = this.#options(handle, settings);
      const [impulses, torques] = this.#start(3 * n, settings);
      const velocities = new Float64Array(3 * n);
      const [p, v] = [argument(impulses, Float64Array, 3 * n, "impulses"),
        argument(velocities, Float64Array, 3 * n, "velocities")];
      const size = got(room(8), "System.solveAssembled");
      check(c.tribo_system_assembled_workspace_size(n, starts, columns, options, size),
        "System.solveAssembled");
      const bytes = views().u32[size / 4]!;
      const [work, info] = [got(room(bytes), "System.solveAssembled"), struct("tribo_system_info")];
      reporting(settings.progress, () => check(c.tribo_system_solve_assembled(n, starts, columns, w, first,
        second, options, work, bytes, p.pointer, v.pointer, info), "System.solveAssembled"));
      [p, v].forEach((result) => result.back());
      [this.impulses, this.torques, this.velocities] = [impulses, torques.fill(0), velocities];
      return read(info, "tribo_system_info");
    }));
  }

  /** The bodies with the velocities of the last solve. */
  apply(bodies: readonly Body[]): Body[] {
    return frame(() => {
      const b = structs("tribo_body", bodies, "bodies");
      check(c.tribo_system_apply(bodies.length, b,
        argument(this.velocities, Float64Array, 6 * bodies.length, "bodies").pointer), "System.apply");
      return bodies.map((_, i) => read(b + sizeOf("tribo_body") * i, "tribo_body"));
    });
  }

  /** What the factorisations did. */
  report(): SparseInfo {
    return this.alone((handle) => frame(() => {
      const info = struct("tribo_sparse_info");
      check(c.tribo_sparse_report(handle, info), "System.report");
      return read(info, "tribo_sparse_info");
    }));
  }
}
