// The scenes of the page: what to add, seen from which place.
import { box, capsule, cone, cylinder, ellipsoid, halfspace, hull, Kind, material, Scene, sphere } from "tribo";

const DENSITY = 100;

function tower(add) {
  for (let k = 0; k < 8; k++) {
    add({ shape: box(0.5, 0.5, 0.25), position: [0, 0, 0.25 + 0.5 * k] });
  }
  add({ shape: sphere(0.4), position: [-6, 0.1, 2.5], velocity: [9, 0, 2.5] });
}

function slope(add, still) {
  const angle = 0.45; // tan: 0.48, between the ends of the slider for friction
  still({ shape: box(4, 3, 0.2), position: [0, 0, 1.8], orientation: [Math.cos(angle / 2), 0, Math.sin(angle / 2), 0] });
  const along = (x, z) => [x * Math.cos(angle) + z * Math.sin(angle), z * Math.cos(angle) - x * Math.sin(angle)];
  for (let k = 0; k < 5; k++) {
    const [x, z] = along(-3 + 0.2 * k, 0.455);
    add({ shape: k % 2 ? cylinder(0.25, 0.25) : box(0.25, 0.25, 0.25), position: [x, 1.1 * (k - 2), 1.8 + z],
      orientation: [Math.cos(angle / 2), 0, Math.sin(angle / 2), 0] });
  }
}

const CRYSTAL = new Float64Array([1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1.6, 0, 0, -1.6].map((x) => 0.35 * x));

function heap(add) {
  const make = [() => sphere(0.3), () => box(0.3, 0.25, 0.2), () => capsule(0.2, 0.25), () => cylinder(0.3, 0.2),
    () => cone(0.35, 0.3), () => ellipsoid(0.35, 0.25, 0.2), () => hull(CRYSTAL)];
  for (let k = 0; k < 21; k++) {
    const turn = 2.4 * k; // the golden angle, nearly: no two fall onto the same place
    add({ shape: make[k % make.length](), position: [0.5 * Math.cos(turn), 0.5 * Math.sin(turn), 1 + 0.6 * k],
      orientation: [Math.cos(turn), Math.sin(turn) * 0.6, Math.sin(turn) * 0.8, 0] });
  }
}

export const SCENES = { tower, slope, heap };

/** A scene by its name; calls each(id, shape) for all bodies but the floor. */
export function make(name, { mu, e }, each) {
  const scene = new Scene();
  const surface = material(mu, mu, e);
  const add = (body) => each(scene.add({ density: DENSITY, material: surface, ...body }), body.shape);
  const still = ({ ...body }) => each(scene.add({ kind: Kind.STATIC, material: surface, ...body }), body.shape);
  scene.add({ shape: halfspace([0, 0, 1]), kind: Kind.STATIC, material: surface });
  SCENES[name](add, still);
  return scene;
}
