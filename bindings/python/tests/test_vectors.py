"""The test vectors of the C library, replayed bit for bit: see vectors.c for the rule."""

import struct

import numpy as np
import pytest
import tribo
from tribo import shape

MASK = 2**64 - 1


class Draws:
    def __init__(self, seed):
        self.state = seed

    def unit(self):
        self.state = self.state + 0x9E3779B97F4A7C15 & MASK
        z = self.state
        z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & MASK
        z = (z ^ z >> 27) * 0x94D049BB133111EB & MASK
        z ^= z >> 31
        return (z >> 11) * 2.0**-53

    def side(self):
        return 2.0 * self.unit() - 1.0

    def sides(self, count=3):
        return [self.side() for _ in range(count)]

    def matrix(self):
        return [2.0 + self.side() if i in (0, 3, 5) else 0.5 * self.side() for i in range(6)]

    def pair(self):
        mu_s = 2.0 * self.unit()
        return tribo.Material(mu_s, self.unit() * mu_s, self.unit())


class Hash:
    def __init__(self):
        self.value = 0xCBF29CE484222325

    def put(self, *words):
        for word in words:
            for byte in int(word).to_bytes(8, "little"):
                self.value = (self.value ^ byte) * 0x100000001B3 & MASK

    def numbers(self, x):
        x = np.asarray(x, np.float64).reshape(-1)
        self.put(*struct.unpack(f"<{x.size}Q", x.astype("<f8").tobytes()))


def do_solve(d, h, _):
    w, b, pair = d.matrix(), d.sides(), d.pair()
    out = tribo.solve(w, b, pair.mu_s, pair.mu_d)
    h.put(0)
    h.numbers(out.impulse)
    h.put(out.mode)


def do_impact(d, h, i):
    w, u, pair = d.matrix(), d.sides(), d.pair()
    out = tribo.impact(w, u, pair, tribo.Law(i % 8))
    h.put(0)
    h.numbers(out.impulse)
    h.put(out.mode)
    h.numbers(out.energy)


def box_mass(half):
    mass, _, inertia = shape.box(*half).mass(1000.0)
    return mass, inertia


def draw_box(d):
    mass, inertia = box_mass([0.5 + d.unit() for _ in range(3)])
    position = d.sides()
    orientation = tribo.rotation(d.sides())
    return tribo.body(mass, inertia, position=position, orientation=orientation,
                      velocity=d.sides(), angular_velocity=d.sides())


def do_collide(d, h, _):
    a, b = draw_box(d), draw_box(d)
    point, normal, pair = d.sides(), tribo.normalize(d.sides()), d.pair()
    info = tribo.collide(a, b, point, normal, pair)
    h.put(0)
    for numbers in (a["velocity"], a["angular_velocity"], b["velocity"], b["angular_velocity"],
                    info["impulse"], info["energy"]):
        h.numbers(numbers)


BATCH = 100


def draw_batch(d):
    draws = [(d.matrix(), d.sides(), d.pair()) for _ in range(BATCH)]
    pairs = tribo.zeros("material", BATCH)
    for k, (_, _, pair) in enumerate(draws):
        pairs[k]["mu_s"], pairs[k]["mu_d"], pairs[k]["e"] = pair.mu_s, pair.mu_d, pair.e
    return np.array([x[0] for x in draws]), np.array([x[1] for x in draws]), pairs


def do_batch_solve(d, h, _):
    w, b, pairs = draw_batch(d)
    p, modes = tribo.batch_solve(w, b, np.stack([pairs["mu_s"], pairs["mu_d"]], axis=1).copy())
    h.put(0)
    h.numbers(p)
    h.put(*modes)


def do_batch_impact(d, h, _):
    p, modes = tribo.batch_impact(*draw_batch(d))
    h.put(0)
    h.numbers(p)
    h.put(*modes)


def draw_shape(d, kind):
    size = [0.25 + 0.5 * d.unit() for _ in range(3)]
    make = [lambda a, b, c: shape.sphere(a), shape.box, lambda a, b, c: shape.capsule(a, b),
            lambda a, b, c: shape.cylinder(a, b), lambda a, b, c: shape.cone(a, b),
            shape.ellipsoid][kind]
    position = [0.5 * x for x in d.sides()]
    return make(*size), position, tribo.rotation(d.sides())


def do_manifold(d, h, i):
    a, position_a, orientation_a = draw_shape(d, i % 6)
    b, position_b, orientation_b = draw_shape(d, i // 6 % 6)
    out = tribo.touch(a, b, position_a=position_a, orientation_a=orientation_a,
                      position_b=position_b, orientation_b=orientation_b, margin=0.015625)
    h.put(0, len(out))
    for m in out:
        h.put(len(m.points))
        h.numbers(m.normal)
        for point in m.points:
            h.numbers(point["arm_a"])
            h.numbers(point["arm_b"])
            h.numbers(point["distance"])
            h.put(point["id"])


def do_system(d, h, i):
    bodies, contacts = tribo.bodies(5), tribo.zeros("system_contact", 20)
    mass, inertia = box_mass([0.5, 0.5, 0.5])
    for k in range(5):
        bodies[k] = tribo.body(mass, inertia, position=(0, 0, k + 0.5),
                               velocity=(0.125 * d.side(), 0.125 * d.side(), -0.015625),
                               angular_velocity=[0.125 * x for x in d.sides()])[0]
        for j in range(4):
            c = contacts[4 * k + j]
            x, y = (-0.5, 0.5)[j % 2], (-0.5, 0.5)[j // 2]
            c["a"], c["b"], c["dimension"] = k, k - 1 if k else tribo.WORLD, 3
            c["contact"]["normal"] = (0, 0, 1)
            c["contact"]["arm_a"], c["contact"]["arm_b"] = (x, y, -0.5), (x, y, 0.5)
            c["pair"]["mu_s"] = c["pair"]["mu_d"] = 0.5
    with tribo.System() as system:
        system.solve(bodies, contacts, solver=tribo.Solver(1 + i % 2), tolerance=2.0**-30)
        h.put(0)
        h.numbers(system.impulses)
        h.numbers(system.velocities)


def do_scene(d, h, _):
    material = tribo.Material(0.5, 0.5, 0.25)
    with tribo.Scene((0, 0, -9.8125)) as scene:
        scene.add(shape.halfspace((0, 0, 1)), kind=tribo.Kind.STATIC, material=material)
        for k in range(10):
            make = (shape.sphere(0.25), shape.box(0.25, 0.25, 0.25), shape.capsule(0.25, 0.25),
                    shape.cylinder(0.25, 0.25))[k % 4]
            position = (d.side(), d.side(), 1.0 + k)
            scene.add(make, density=1000.0, position=position, velocity=d.sides(),
                      angular_velocity=d.sides(), material=material)
        for step in range(1, 1001):
            scene.step(0.00390625)
            if step % 100 == 0:
                for k in range(1, 11):
                    body = scene.body(k)
                    h.put(0)
                    for name in ("position", "orientation", "velocity", "angular_velocity"):
                        h.numbers(body[name])


@pytest.mark.parametrize("name", ["solve", "impact", "collide", "batch_solve", "batch_impact",
                                  "manifold", "system", "scene"])
def test_vectors(vectors, name):
    expected = next(s for s in vectors["sets"] if s["name"] == name)
    draws, out = Draws(expected["seed"]), Hash()
    for i in range(expected["count"]):
        try:
            globals()[f"do_{name}"](draws, out, i)
        except tribo.TriboError as error:
            out.put(error.status)
    assert f"{out.value:016x}" == expected["hash"]


def test_all_sets_are_replayed(vectors):
    assert all(f"do_{s['name']}" in globals() for s in vectors["sets"])
