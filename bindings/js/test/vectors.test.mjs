// The test vectors of the C library, replayed bit for bit: see ../../vectors.c for the rule.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import * as tribo from "tribo";

const vectors = JSON.parse(readFileSync(process.env.TRIBO_VECTORS, "utf8"));
const MASK = 2n ** 64n - 1n;

class Draws {
  constructor(seed) {
    this.state = BigInt(seed);
  }

  unit() {
    this.state = (this.state + 0x9e3779b97f4a7c15n) & MASK;
    let z = this.state;
    z = ((z ^ (z >> 30n)) * 0xbf58476d1ce4e5b9n) & MASK;
    z = ((z ^ (z >> 27n)) * 0x94d049bb133111ebn) & MASK;
    z ^= z >> 31n;
    return Number(z >> 11n) * 2 ** -53;
  }

  side = () => 2 * this.unit() - 1;
  sides = (count = 3) => Array.from({ length: count }, this.side);
  matrix = () => Array.from({ length: 6 }, (_, i) =>
    [0, 3, 5].includes(i) ? 2 + this.side() : 0.5 * this.side());

  pair() {
    const muS = 2 * this.unit();
    const muD = this.unit() * muS;
    return { muS, muD, e: this.unit() };
  }
}

class Hash {
  value = 0xcbf29ce484222325n;
  #view = new DataView(new ArrayBuffer(8));

  word(word) {
    this.#view.setBigUint64(0, BigInt(word), true);
    this.#bytes();
  }

  numbers(...all) {
    for (const x of all.flat()) {
      this.#view.setFloat64(0, x, true);
      this.#bytes();
    }
  }

  #bytes() {
    for (let i = 0; i < 8; i++) {
      this.value = ((this.value ^ BigInt(this.#view.getUint8(i))) * 0x100000001b3n) & MASK;
    }
  }
}

const density = 1000;

function drawBox(d) {
  const { mass, inertia } = tribo.box(0.5 + d.unit(), 0.5 + d.unit(), 0.5 + d.unit()).mass(density);
  const position = d.sides();
  const orientation = tribo.rotation(d.sides());
  return tribo.body({ mass, inertia, position, orientation, velocity: d.sides(), angularVelocity: d.sides() });
}

function drawShape(d, kind) {
  const size = [0, 1, 2].map(() => 0.25 + 0.5 * d.unit());
  const make = [tribo.sphere, tribo.box, tribo.capsule, tribo.cylinder, tribo.cone, tribo.ellipsoid][kind];
  const position = d.sides().map((x) => 0.5 * x);
  return [make(...size), { position, orientation: tribo.rotation(d.sides()) }];
}

function drawBatch(d) {
  const all = Array.from({ length: 100 }, () => [d.matrix(), d.sides(), d.pair()]);
  const flat = (numbers) => new Float64Array(all.flatMap(numbers));
  return { w: flat(([w]) => w), b: flat(([, b]) => b), mu: flat(([, , m]) => [m.muS, m.muD]),
    pairs: flat(([, , m]) => [m.muS, m.muD, m.e]) };
}

function putBatch(h, { p, modes }) {
  h.word(0);
  h.numbers([...p]);
  modes.forEach((mode) => h.word(mode));
}

const SETS = {
  solve(d, h) {
    const [w, b, pair] = [d.matrix(), d.sides(), d.pair()];
    const { impulse, mode } = tribo.solve(w, b, pair.muS, pair.muD);
    h.word(0);
    h.numbers(impulse);
    h.word(mode);
  },
  impact(d, h, i) {
    const [w, u, pair] = [d.matrix(), d.sides(), d.pair()];
    const { impulse, mode, energy } = tribo.impact(w, u, pair, { law: i % 8 });
    h.word(0);
    h.numbers(impulse);
    h.word(mode);
    h.numbers(energy);
  },
  collide(d, h) {
    const [a, b] = [drawBox(d), drawBox(d)];
    const [point, normal, pair] = [d.sides(), tribo.normalize(d.sides()), d.pair()];
    const after = tribo.collide(a, b, point, normal, pair);
    h.word(0);
    h.numbers(after.a.velocity, after.a.angularVelocity, after.b.velocity, after.b.angularVelocity,
      after.impulse, after.energy);
  },
  batch_solve(d, h) {
    const { w, b, mu } = drawBatch(d);
    putBatch(h, tribo.batchSolve(w, b, mu));
  },
  batch_impact(d, h) {
    const { w, b, pairs } = drawBatch(d);
    putBatch(h, tribo.batchImpact(w, b, pairs));
  },
  manifold(d, h, i) {
    const [a, b] = [drawShape(d, i % 6), drawShape(d, Math.floor(i / 6) % 6)];
    const found = tribo.touch(...a, ...b, { margin: 0.015625 });
    h.word(0);
    h.word(found.length);
    for (const { normal, points } of found) {
      h.word(points.length);
      h.numbers(normal);
      for (const point of points) {
        h.numbers(point.armA, point.armB, point.distance);
        h.word(point.id);
      }
    }
  },
  system(d, h, i) {
    const { mass, inertia } = tribo.box(0.5, 0.5, 0.5).mass(density);
    const [bodies, contacts] = [[], []];
    for (let k = 0; k < 5; k++) {
      bodies.push(tribo.body({ mass, inertia, position: [0, 0, k + 0.5],
        velocity: [0.125 * d.side(), 0.125 * d.side(), -0.015625],
        angularVelocity: d.sides().map((x) => 0.125 * x) }));
      for (let j = 0; j < 4; j++) {
        const [x, y] = [j % 2 ? 0.5 : -0.5, j > 1 ? 0.5 : -0.5];
        contacts.push({ a: k, b: k > 0 ? k - 1 : tribo.WORLD, pair: { muS: 0.5, muD: 0.5, e: 0 },
          contact: { normal: [0, 0, 1], armA: [x, y, -0.5], armB: [x, y, 0.5] } });
      }
    }
    const system = new tribo.System();
    system.solve(bodies, contacts, { solver: 1 + (i % 2), tolerance: 2 ** -30 });
    h.word(0);
    h.numbers([...system.impulses], [...system.velocities]);
    system.close();
  },
  scene(d, h) {
    const material = tribo.material(0.5, 0.5, 0.25);
    const scene = new tribo.Scene({ gravity: [0, 0, -9.8125] });
    scene.add({ shape: tribo.halfspace([0, 0, 1]), kind: tribo.Kind.STATIC, material });
    for (let k = 0; k < 10; k++) {
      const make = [tribo.sphere, tribo.box, tribo.capsule, tribo.cylinder][k % 4];
      const position = [d.side(), d.side(), 1 + k];
      scene.add({ shape: make(0.25, 0.25, 0.25), density, material, position, velocity: d.sides(),
        angularVelocity: d.sides() });
    }
    for (let step = 1; step <= 1000; step++) {
      scene.step(0.00390625);
      for (let k = 1; step % 100 === 0 && k <= 10; k++) {
        const { position, orientation, velocity, angularVelocity } = scene.body(k);
        h.word(0);
        h.numbers(position, orientation, velocity, angularVelocity);
      }
    }
    scene.close();
  },
};

for (const { name, seed, count, hash } of vectors.sets) {
  test(`vectors: ${name}`, () => {
    const [draws, out] = [new Draws(seed), new Hash()];
    for (let i = 0; i < count; i++) {
      try {
        SETS[name](draws, out, i);
      } catch (error) {
        if (!(error instanceof tribo.TriboError)) {
          throw error;
        }
        out.word(error.status);
      }
    }
    assert.equal(out.value.toString(16).padStart(16, "0"), hash);
  });
}
