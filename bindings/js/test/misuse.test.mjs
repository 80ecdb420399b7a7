// What is refused, and how: an error of the right kind, nothing changed, and all goes on after it.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import * as tribo from "tribo";

const { errors } = tribo;
const vectors = JSON.parse(readFileSync(process.env.TRIBO_VECTORS, "utf8"));
const UNIT = [1, 0, 0, 1, 0, 1];

/** The module still works: a solve gives what it must. */
function works() {
  assert.deepEqual(tribo.solve(UNIT, [-1, 0, 0], 0.5).impulse, [1, 0, 0]);
}

function throws(call, kind, pattern = /./) {
  assert.throws(call, (error) => {
    assert.ok(error instanceof kind, `${error} is no ${kind.name}`);
    assert.match(error.message, pattern);
    return true;
  });
  works();
}

test("every status is an error of its own class", () => {
  const seen = new Set();
  const of = errors.errorOf;
  for (const { value, name, text } of vectors.statuses.filter((s) => s.value !== 0)) {
    const error = of(value, "here");
    assert.ok(error instanceof tribo.TriboError && error instanceof Error);
    assert.equal(error.status, value);
    assert.equal(error.code, name);
    assert.equal(error.message, `here: ${text}`);
    assert.notEqual(error.constructor, tribo.TriboError);
    assert.equal(error.name, error.constructor.name);
    seen.add(error.constructor);
  }
  assert.equal(seen.size, vectors.statuses.length - 1);
  assert.equal(of(999).constructor, tribo.TriboError);
});


test("one contact refuses", () => {
  throws(() => tribo.solve(UNIT, [NaN, 0, 0], 0.5), errors.NotFiniteError);
  throws(() => tribo.solve(UNIT, [-1, 0, 0], 0.1, 0.5), errors.FrictionError);
  throws(() => tribo.solve(UNIT, [1, 2], 0.5), RangeError, /b: 3 entries/);
  throws(() => tribo.solve(UNIT, ["a", 0, 0], 0.5), TypeError);
  throws(() => tribo.solve(UNIT, null, 0.5), TypeError);
  throws(() => tribo.solve(UNIT, [1, 2, 3], "0.5"), TypeError);
  throws(() => tribo.material(0.5, 0.5, 2), errors.RestitutionError);
  throws(() => tribo.materialNamed("cheese on moon"), errors.UnknownNameError);
  throws(() => tribo.body({ mass: -1, inertia: [1, 0, 0, 0, 1, 0, 0, 0, 1] }), errors.MassError);
  throws(() => tribo.body({ mas: 1 }), TypeError, /no mas/);
  throws(() => tribo.impact(UNIT, [-1, 0, 0], { muS: 0, muD: 0, e: 0 }, { law: 99 }), errors.OptionError);
  throws(() => tribo.impact(UNIT, [-1, 0, 0], { muS: 0, muD: 0, e: 0 }, { law: 0.5 }), RangeError);
  assert.ok("wood on stone" in tribo.materials());
});

function batch(n = 4) {
  return [new Float64Array(Array(n).fill(UNIT).flat()), new Float64Array(3 * n).fill(-1),
    new Float64Array(2 * n).fill(0.5)];
}

test("a batch refuses arrays that do not fit", () => {
  const [w, b, mu] = batch();
  throws(() => tribo.batchSolve(new Float32Array(w), b, mu), TypeError);
  throws(() => tribo.batchSolve([...w], b, mu), TypeError);
  throws(() => tribo.batchSolve(w, b.slice(1), mu), RangeError, /b: 12 entries/);
  throws(() => tribo.batchSolve(w.slice(1), b, mu), RangeError, /numbers a row/);
  throws(() => tribo.batchSolve(w, b, mu, { p: new Float64Array(1) }), RangeError);
  throws(() => tribo.batchSolve(w, b, mu, { modes: new Int32Array(4) }), TypeError);
  throws(() => tribo.batchSolve(w, b, tribo.words(8)), TypeError);
  throws(() => tribo.batchSolve(w, b, mu, {}, 77), errors.OptionError);
  throws(() => tribo.batchSolve(w, b.fill(NaN), mu), errors.NotFiniteError);
});

test("a batch tells each contact", () => {
  const [w, b, mu] = batch();
  b[6] = NaN;
  const statuses = new Int32Array(4);
  const { p } = tribo.batchSolve(w, b, mu, { statuses });
  assert.deepEqual([...statuses], [0, 0, 20, 0]);
  assert.ok(p[0] > 0 && p[3] > 0 && p[6] === 0 && p[9] > 0);
});

test("resident arrays are taken in place, and their views are renewed after growth", () => {
  const n = 4;
  const [w, b, mu, p] = [tribo.numbers(6 * n), tribo.numbers(3 * n), tribo.numbers(2 * n), tribo.numbers(3 * n)];
  const given = batch(n);
  [w, b, mu].forEach((x, i) => x.array.set(given[i]));
  const old = p.array;
  tribo.batchSolve(w, b, mu, { p });
  assert.ok(old === p.array && old[0] === tribo.batchSolve(...given).p[0]);
  const pages = tribo.raw.memory.buffer.byteLength;
  const large = tribo.numbers(4e6);
  assert.ok(tribo.raw.memory.buffer.byteLength > pages, "the memory has grown");
  assert.equal(old.length, 0, "a view from before is empty, not wrong");
  assert.equal(p.array.length, 3 * n);
  assert.equal(p.array[0], tribo.batchSolve(...given).p[0]);
  throws(() => tribo.batchSolve(w, b, mu, { p: old }), RangeError);
  large.close();
  large.close();
  throws(() => large.array, Error, /closed/);
  throws(() => tribo.numbers(2 ** 31), errors.OutOfMemoryError);
  throws(() => tribo.numbers(-1), RangeError);
});

test("a contact that stays in the memory of C", () => {
  const contact = new tribo.Contact();
  contact.numbers.set([...UNIT, -1, 0.25, 0, 0.5, 0.5]);
  contact.solve();
  assert.deepEqual([...contact.numbers.subarray(11)], tribo.solve(UNIT, [-1, 0.25, 0], 0.5).impulse);
  contact.numbers[6] = NaN;
  throws(() => contact.solve(), errors.NotFiniteError);
});

const CUBE = new Float64Array([0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [i & 1, (i >> 1) & 1, i >> 2].map((x) => x - 0.5)));

test("hulls: degenerate points are an error, by Qhull's own way out too", () => {
  assert.equal(tribo.hull(CUBE).mass(2).mass, 2);
  throws(() => tribo.hull(new Float64Array(24)), errors.DegenerateError);
  throws(() => tribo.hull(CUBE.map((x, i) => (i % 3 === 2 ? 0 : x))), errors.DegenerateError);
  throws(() => tribo.hull(CUBE.slice(0, 9)), tribo.TriboError);
  throws(() => tribo.hull(CUBE.map(() => NaN)), errors.NotFiniteError);
  // Flat to a few parts in 1e12, in many ways: what the check before Qhull lets through.
  let refused = 0;
  let state = 1;
  const random = () => ((state = (state * 48271) % 2147483647) / 2147483647) - 0.5;
  for (let i = 0; i < 300; i++) {
    const flat = 10 ** (-9 - (i % 40) / 8);
    const points = Float64Array.from({ length: 60 }, (_, k) => random() * (k % 3 === 2 ? flat : 1));
    try {
      assert.ok(tribo.hull(points).mass(1).mass > 0);
    } catch (error) {
      assert.ok(error instanceof tribo.TriboError, String(error));
      refused++;
    }
  }
  assert.ok(refused > 0 && refused < 300, `${refused} of 300 refused`);
  works();
  assert.equal(tribo.hull(CUBE).mass(2).mass, 2);
});

test("shapes refuse", () => {
  throws(() => tribo.sphere(-1), errors.ShapeError);
  throws(() => tribo.sphere("1"), TypeError);
  throws(() => tribo.halfspace([0, 0, 2]), errors.NormalError);
  throws(() => tribo.mesh(CUBE, new Uint32Array([0, 1, 99])), errors.IndexError);
  throws(() => tribo.mesh(CUBE, new Uint32Array([0, 1])), RangeError);
  throws(() => tribo.compound([]), errors.ShapeError);
  throws(() => tribo.compound([{ shape: tribo.halfspace([0, 0, 1]) }]), errors.ShapeError);
  throws(() => tribo.touch(tribo.sphere(1), {}, tribo.sphere(1), { orientation: [2, 0, 0, 0] }),
    errors.OrientationError);
  throws(() => tribo.touchBatch([{ shape: tribo.sphere(1) }], new Uint32Array([0, 7])), errors.IndexError);
  const tree = new tribo.Tree(2);
  assert.equal(tree.add([0, 0, 0], [1, 1, 1]), 0);
  assert.equal(tree.add([1, 1, 1], [2, 2, 2]), 1);
  assert.deepEqual([...tree.pairs()], [0, 1]);
  throws(() => tree.add([0, 0, 0], [1, 1, 1]), errors.CapacityError);
  throws(() => tree.remove(9), errors.IndexError);
  throws(() => tree.remove(-1), RangeError);
});

test("support functions: what they throw is the cause", () => {
  const ball = tribo.convex((d) => d.map((x) => x / Math.hypot(...d)), [0, 0, 0], 1);
  const at = { position: [0, 0, 1.5] };
  const [manifold] = tribo.touch(ball, {}, tribo.sphere(1), at);
  assert.ok(Math.abs(manifold.points[0].distance + 0.5) < 1e-9);
  const fault = new Error("no");
  const bad = tribo.convex(() => { throw fault; }, [0, 0, 0], 1);
  assert.throws(() => tribo.touch(bad, {}, tribo.sphere(1), at),
    (error) => error instanceof errors.SupportError && error.cause === fault);
  const short = tribo.convex(() => [1], [0, 0, 0], 1);
  throws(() => tribo.touch(short, {}, tribo.sphere(1), at), errors.SupportError);
});

function ballScene() {
  const scene = new tribo.Scene();
  scene.add({ shape: tribo.halfspace([0, 0, 1]), kind: tribo.Kind.STATIC });
  return [scene, scene.add({ shape: tribo.sphere(0.5), density: 1, position: [0, 0, 0.75] })];
}

test("a scene refuses", () => {
  const [scene, ball] = ballScene();
  throws(() => scene.step(-1), errors.TimeStepError);
  throws(() => scene.step(NaN), errors.NotFiniteError);
  throws(() => scene.step(0.01, { solver: 9 }), errors.OptionError);
  throws(() => scene.step(0.01, { solvr: 1 }), TypeError);
  throws(() => scene.body(99), errors.IndexError);
  throws(() => scene.body(-1), RangeError);
  throws(() => scene.body("0"), TypeError);
  throws(() => scene.remove(7), errors.IndexError);
  throws(() => scene.add({ shape: tribo.sphere(1) }), TypeError);
  throws(() => scene.setBody(ball, { velocity: [NaN, 0, 0] }), errors.NotFiniteError);
  throws(() => scene.load(new Uint8Array(8)), TypeError);
  assert.deepEqual(scene.body(ball).position, [0, 0, 0.75]);
  assert.deepEqual(scene.ids(), [0, 1]);
});

test("use after close", () => {
  const [scene, ball] = ballScene();
  scene.close();
  scene.close();
  for (const call of [() => scene.step(0.01), () => scene.body(ball), () => scene.contacts(), () => scene.save(),
    () => scene.remove(ball), () => scene.totals()]) {
    throws(call, Error, /closed/);
  }
  const system = new tribo.System();
  system.close();
  throws(() => system.solve([], []), Error, /closed/);
});

test("a callback cannot come back to the scene that called it", () => {
  const scene = new tribo.Scene();
  let inside;
  const ball = tribo.convex((d) => {
    try {
      scene.step(0.01);
    } catch (error) {
      inside = error;
    }
    works(); // other calls may be made
    return d.map((x) => x / Math.hypot(...d));
  }, [0, 0, 0], 1);
  scene.add({ shape: tribo.box(1, 1, 1), kind: tribo.Kind.STATIC });
  scene.add({ shape: ball, position: [0, 0, 1.99], inverseMass: 1, inverseInertia: [1, 0, 0, 1, 0, 1] });
  scene.step(0.01);
  assert.match(inside.message, /in use/);
});

test("saved states keep their shapes, and go on to the bit", () => {
  const scene = new tribo.Scene();
  scene.add({ shape: tribo.halfspace([0, 0, 1]), kind: tribo.Kind.STATIC });
  const id = scene.add({ shape: tribo.hull(CUBE), density: 1, position: [0, 0, 0.6] });
  const saved = scene.save();
  const ends = [0, 1].map(() => {
    for (let i = 0; i < 50; i++) {
      scene.step(1 / 128);
    }
    const end = scene.save();
    scene.remove(id);
    scene.load(saved);
    return end;
  });
  assert.ok(ends[0].equals(ends[1]) && !ends[0].equals(saved));
});

// Boxes side by side on the ground: in the plane, so that no order of them makes their matrix narrow.
function field(side) {
  const { mass, inertia } = tribo.box(0.5, 0.5, 0.5).mass(1);
  const bodies = Array.from({ length: side * side }, (_, k) =>
    tribo.body({ mass, inertia, position: [k % side, Math.floor(k / side), 0.5], velocity: [0, 0, -1] }));
  const pair = { muS: 0.5, muD: 0.5, e: 0 };
  const contacts = bodies.flatMap((_, k) => {
    const ground = [0, 1, 2, 3].map((j) => {
      const [x, y] = [j % 2 - 0.5, (j >> 1) - 0.5];
      return { a: k, b: tribo.WORLD, pair, contact: { normal: [0, 0, 1], armA: [x, y, -0.5], armB: [0, 0, 0] } };
    });
    const beside = [[1, 0, 0], [0, 1, 0]].map((n) => ({ a: k + n[0] + side * n[1], b: k, pair,
      contact: { normal: n, armA: n.map((x) => -x / 2), armB: n.map((x) => x / 2) } }));
    return [...ground, ...beside.filter((_, i) => (i ? k + side < side * side : (k + 1) % side))];
  });
  return [bodies, contacts];
}

test("systems: sparse Newton, progress, faults", () => {
  const system = new tribo.System();
  const [bodies, contacts] = field(8);
  const info = system.solve(bodies, contacts, { solver: tribo.Solver.NEWTON });
  assert.equal(info.stop, tribo.Stop.TOLERANCE);
  assert.ok(system.report().factorizations > 0, "by SuiteSparse");
  assert.ok(Math.abs(system.apply(bodies)[49].velocity[2]) < 1e-6);
  assert.equal(system.solve(bodies, contacts, { progress: () => true }).stop, tribo.Stop.CANCEL);
  const fault = new Error("no more");
  assert.throws(() => system.solve(bodies, contacts, { progress: () => { throw fault; } }), fault);
  throws(() => system.solve(bodies, [{ ...contacts[0], a: 99 }]), errors.IndexError);
  throws(() => system.solve(bodies, [{ ...contacts[0], b: 0 }]), errors.AliasError);
  throws(() => system.solve(bodies, contacts.slice(1), { warmStart: true, tolerance: 1e-8 }), RangeError);
  throws(() => system.solve({}, contacts), TypeError);
  const n = 2;
  const w = Float64Array.from({ length: 36 }, (_, i) => (i % 7 === 0 ? 1 : 0));
  const q = new Float64Array([-1, 0, 0, -1, 0.25, 0]);
  const mu = new Float64Array(2 * n).fill(0.5);
  assert.equal(system.solveAssembled(q, mu, w).stop, tribo.Stop.TOLERANCE);
  assert.ok(Math.abs(system.impulses[0] - 1) < 1e-9);
  throws(() => system.solveAssembled(q.slice(1), mu, w), RangeError);
  throws(() => system.solveAssembled(q, mu, w, { rowStarts: new Uint32Array([0, 1, 9]),
    columns: new Uint32Array(2) }), RangeError);
  system.close();
});
