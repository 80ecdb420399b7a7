/** tribo: contact and friction between rigid bodies, resolved exactly and fast.
 *
 *  One contact (solve, impact, collide, Contact), many that do not influence each other (batchSolve, ...),
 *  many that do (System), contacts from shapes (touch), worlds that step through time (Scene). SI units;
 *  quaternions are (w, x, y, z); contact coordinates are (n, t1, t2) with the normal from body B to body A.
 *  What a function means in full stands in the C headers, at the function of the same name. */
import { c, text } from "./wasm.js";

export * from "./api.js";
export * from "./contact.js";
export * as errors from "./errors.js";
export { TriboError } from "./errors.js";
export { numbers, Resident, words } from "./memory.js";
export type { Array32, Array64, ArrayStatus } from "./memory.js";
export * from "./scene.js";
export { box, capsule, compound, cone, convex, cylinder, ellipsoid, halfspace, hull, mesh, Shape, sphere, touch,
  touchBatch, Tree } from "./shape.js";
export type { Place, Support, TouchSettings } from "./shape.js";
export { System } from "./system.js";
export type { Coupling, SystemSettings } from "./system.js";
export { c as raw } from "./wasm.js";

export const version: string = text(c.tribo_version_string());
