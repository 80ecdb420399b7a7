/** Bodies with shapes that move, touch, slide, roll, bounce and rest. */
import { type Body, Kind, type Material, type Mix, type SceneBody, type SceneContact, type SceneEvent,
  type Solver, type StepInfo, type Structs, type Totals, type Vector } from "./api.js";
import { AT_REST } from "./contact.js";
import { CAPACITY, check } from "./errors.js";
import { got, number, offsetOf, read, sizeOf, struct, vector, whole, write } from "./memory.js";
import { Owner } from "./owner.js";
import { type Shape, supported } from "./shape.js";
import { c, frame, room, views } from "./wasm.js";

/** What holds for all of a scene. */
export interface SceneOptions {
  gravity?: Vector;
  frictionRule?: Mix;
  restitutionRule?: Mix;
}

/** A body to add. A dynamic one needs `density` with a shape (whose centre of mass then is the body's
 *  origin), or `inverseMass` and `inverseInertia`. */
export interface NewBody extends Partial<Body> {
  shape?: Shape;
  density?: number;
  kind?: Kind;
  material?: Material;
  belt?: Vector;
  rolling?: number;
  spinning?: number;
}

/** Options of a step: see scene.h. */
export interface StepSettings {
  substeps?: number;
  solver?: Solver;
  skip?: number;
  maxIterations?: number;
  tolerance?: number;
  margin?: number;
  threshold?: number;
  correction?: number;
  sleepTime?: number;
  sleepSpeed?: number;
}

function makeScene(settings: SceneOptions): number {
  return frame(() => {
    const out = got(room(8), "Scene");
    check(c.tribo_scene_create(struct("tribo_scene_settings",
      { gravity: [0, 0, -9.81], ...settings }, "Scene"), 0, out), "Scene");
    return views().u32[out / 4]!;
  });
}

/** A state of a scene, for as long as the module is loaded: it keeps alive the shapes it refers to. */
export class Saved {
  /** @internal */
  constructor(readonly bytes: Uint8Array, readonly shapes: ReadonlyMap<number, Shape>,
    readonly time: number) {
    Object.freeze(this);
  }

  /** The same to the bit. */
  equals(other: Saved): boolean {
    return this.bytes.length === other.bytes.length && this.bytes.every((x, i) => x === other.bytes[i]);
  }
}

/** A world of bodies that steps through time. */
export class Scene extends Owner {
  #shapes = new Map<number, Shape>();
  /** Seconds that were stepped. */
  time = 0;

  constructor(settings: SceneOptions = {}) {
    super(makeScene(settings), (handle) => c.tribo_scene_destroy(handle));
  }

  // ---- bodies ----

  /** Add a body; returns its id. */
  add(options: NewBody): number {
    const { shape, density, kind = Kind.DYNAMIC, material, belt, rolling, spinning, ...state } = options;
    return this.alone((scene) => frame(() => supported(() => {
      const [body, id] = [got(room(sizeOf("tribo_scene_body")), "Scene.add"), got(room(8), "Scene.add")];
      check(c.tribo_scene_body_init(body), "Scene.add");
      const given: Partial<SceneBody> = { kind, state: { ...AT_REST, ...massOf(shape, density, kind, state),
        ...state } };
      for (const [key, value] of Object.entries({ material, belt, rolling, spinning })) {
        if (value !== undefined) {
          Object.assign(given, { [key]: value });
        }
      }
      if (shape && density !== undefined) {
        const { center } = shape.mass(density);
        given.offset = { position: center.map((x) => -x), orientation: [1, 0, 0, 0] };
      }
      write(body, "tribo_scene_body", given, "Scene.add");
      shape?.struct(body + offsetOf("tribo_scene_body", "shape"));
      check(c.tribo_scene_add(scene, body, id), "Scene.add");
      const found = views().u32[id / 4]!;
      if (shape) {
        this.#shapes.set(found, shape);
      }
      return found;
    })));
  }

  /** Remove a body and its contacts. */
  remove(id: number): void {
    this.alone((scene) => {
      check(c.tribo_scene_remove(scene, whole(id, "id")), "Scene.remove");
      this.#shapes.delete(id);
    });
  }

  /** Ids in use, ascending. */
  ids(): number[] {
    return this.alone((scene) => frame(() => {
      const [end, body] = [got(room(8), "Scene.ids"), struct("tribo_body")];
      check(c.tribo_scene_counts(scene, 0, end), "Scene.ids");
      return Array.from({ length: views().u32[end / 4]! }, (_, i) => i)
        .filter((i) => c.tribo_scene_get_body(scene, i, body, 0) === 0);
    }));
  }

  /** Pose and velocities of a body. */
  body(id: number): Body {
    return this.#state(id).body;
  }

  asleep(id: number): boolean {
    return this.#state(id).asleep;
  }

  #state(id: number): { body: Body; asleep: boolean } {
    return this.alone((scene) => frame(() => {
      const [out, asleep] = [struct("tribo_body"), got(room(8), "Scene.body")];
      check(c.tribo_scene_get_body(scene, whole(id, "id"), out, asleep), "Scene.body");
      return { body: read(out, "tribo_body"), asleep: views().u32[asleep / 4] !== 0 };
    }));
  }

  /** Change pose, velocities or mass of a body: what is given. */
  setBody(id: number, state: Partial<Body>): void {
    this.alone((scene) => frame(() => supported(() => {
      const body = struct("tribo_body");
      check(c.tribo_scene_get_body(scene, whole(id, "id"), body, 0), "Scene.setBody");
      write(body, "tribo_body", state, "Scene.setBody");
      check(c.tribo_scene_set_body(scene, id, body), "Scene.setBody");
    })));
  }

  /** Force (N) at the centre of mass and torque (N m), from now on. */
  setForce(id: number, force: Vector, torque: Vector = [0, 0, 0]): void {
    this.alone((scene) => frame(() => check(c.tribo_scene_set_force(scene, whole(id, "id"),
      vector(force, 3, "force"), vector(torque, 3, "torque")), "Scene.setForce")));
  }

  setGravity(gravity: Vector): void {
    this.alone((scene) => frame(() => check(
      c.tribo_scene_set_gravity(scene, vector(gravity, 3, "gravity")), "Scene.setGravity")));
  }

  /** The shape that a body was added with. */
  shape(id: number): Shape | undefined {
    return this.#shapes.get(id);
  }

  // ---- time ----

  /** Advance by dt seconds. On an error the scene is as it was. */
  step(dt: number, settings: StepSettings = {}): StepInfo {
    return this.alone((scene) => frame(() => supported(() => {
      const [options, info] = [struct("tribo_step_options", settings, "options"),
        struct("tribo_step_info")];
      check(c.tribo_scene_step(scene, number(dt, "dt"), options, info), "Scene.step");
      this.time += dt;
      return read(info, "tribo_step_info");
    })));
  }

  // ---- what happened ----

  #list<S extends "tribo_scene_contact" | "tribo_scene_event">(name: S, where: string,
    call: (scene: number, capacity: number, out: number, count: number) => number): Structs[S][] {
    return this.alone((scene) => frame(() => {
      const [count, size] = [got(room(8), where), sizeOf(name)];
      const status = call(scene, 0, 0, count);
      const n = views().u32[count / 4]!;
      const out = got(room(size * n), where);
      check(status === CAPACITY ? call(scene, n, out, count) : status, where);
      return Array.from({ length: n }, (_, i) => read(out + size * i, name));
    }));
  }

  /** Contact points of the last sub-step. */
  contacts(): SceneContact[] {
    return this.#list("tribo_scene_contact", "Scene.contacts", c.tribo_scene_contacts);
  }

  /** What touched in the last step. */
  events(): SceneEvent[] {
    return this.#list("tribo_scene_event", "Scene.events", c.tribo_scene_events);
  }

  /** Momentum about `origin`, kinetic and potential energy. */
  totals(origin: Vector = [0, 0, 0]): Totals & { potential: number } {
    return this.alone((scene) => frame(() => {
      const [out, potential] = [struct("tribo_totals"), got(room(8), "Scene.totals")];
      check(c.tribo_scene_totals(scene, vector(origin, 3, "origin"), out, potential), "Scene.totals");
      return { ...read(out, "tribo_totals"), potential: views().f64[potential / 8]! };
    }));
  }

  // ---- saving ----

  /** All of the scene; load() goes on from there to the bit. */
  save(): Saved {
    return this.alone((scene) => frame(() => {
      const needed = got(room(8), "Scene.save");
      c.tribo_scene_save(scene, 0, 0, needed);
      const bytes = views().u32[needed / 4]!;
      const out = got(room(bytes), "Scene.save");
      check(c.tribo_scene_save(scene, out, bytes, needed), "Scene.save");
      return new Saved(views().u8.slice(out, out + bytes), new Map(this.#shapes), this.time);
    }));
  }

  /** Go back to what save() of this or another Scene gave. */
  load(saved: Saved): void {
    if (!(saved instanceof Saved)) {
      throw new TypeError("Scene.load: what Scene.save gave is needed");
    }
    this.alone((scene) => frame(() => {
      const at = got(room(saved.bytes.length), "Scene.load");
      views().u8.set(saved.bytes, at);
      check(c.tribo_scene_load(scene, at, saved.bytes.length), "Scene.load");
      this.#shapes = new Map(saved.shapes);
      this.time = saved.time;
    }));
  }
}

function massOf(shape: Shape | undefined, density: number | undefined, kind: Kind,
  state: Partial<Body>): Partial<Body> {
  if (kind !== Kind.DYNAMIC || (state.inverseMass !== undefined && density === undefined)) {
    return {};
  }
  if (!shape || density === undefined) {
    throw new TypeError("Scene.add: a dynamic body needs a shape and a density, or inverseMass");
  }
  const { mass, inertia } = shape.mass(density);
  return frame(() => {
    const body = struct("tribo_body", AT_REST);
    check(c.tribo_body_set_mass(body, mass, vector(inertia, 9, "inertia")), "Scene.add");
    const { inverseMass, inverseInertia } = read(body, "tribo_body");
    return { inverseMass, inverseInertia };
  });
}
