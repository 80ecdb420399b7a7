// No memory is left: errors that say so, Qhull's way out of a hull half made among them, and all is well after.
import assert from "node:assert/strict";
import { test } from "node:test";
import * as tribo from "tribo";

const { js_allocate: allocate, js_release: release } = tribo.raw;

test("calls that find no memory throw, and do no harm", () => {
  const count = 3000;
  const points = Float64Array.from({ length: 3 * count }, (_, k) => Math.sin(k * k + 0.1 * k));
  const mass = tribo.hull(points).mass(1).mass;
  const taken = [];
  for (let bytes = 2 ** 26; bytes >= 64; bytes /= 2) {
    for (let at = allocate(bytes); at !== 0; at = allocate(bytes)) {
      taken.push(at);
    }
  }
  assert.throws(() => tribo.numbers(1e6), tribo.errors.OutOfMemoryError);
  assert.throws(() => new tribo.Scene(), tribo.errors.OutOfMemoryError);
  // Piece by piece there is more: hulls fail at a later place each time, then one is made.
  let failures = 0;
  for (let done = false; !done && taken.length > 0;) {
    release(taken.pop());
    try {
      assert.equal(tribo.hull(points).mass(1).mass, mass);
      done = true;
    } catch (error) {
      assert.ok(error instanceof tribo.errors.OutOfMemoryError, String(error));
      failures++;
    }
  }
  assert.ok(failures > 3, `${failures} failures`);
  taken.forEach((at) => release(at));
  assert.equal(tribo.hull(points).mass(1).mass, mass);
  const scene = new tribo.Scene();
  scene.add({ shape: tribo.sphere(1), density: 1 });
  scene.step(0.01);
});
