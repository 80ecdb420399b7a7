"""Random calls, right and wrong: an exception or a result, never a crash (Hypothesis)."""

import numpy as np
import tribo
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from tribo import shape

floats = st.floats(allow_nan=True, allow_infinity=True)
wild = st.lists(floats, min_size=0, max_size=10)
arrays = hnp.arrays(
    dtype=st.sampled_from([np.float64, np.float32, np.uint32, np.int64]),
    shape=hnp.array_shapes(min_dims=1, max_dims=2, min_side=0, max_side=6))
REFUSED = (TypeError, ValueError, OverflowError, IndexError, MemoryError, RuntimeError, KeyError)


@settings(max_examples=300, deadline=None)
@given(wild, wild, floats, floats)
def test_solve(w, b, mu_s, mu_d):
    try:
        out = tribo.solve(w, b, mu_s, mu_d)
    except REFUSED:
        return
    assert np.isfinite(out.impulse).all()
    assert tribo.cone_contains(out.impulse, mu_s, 1e-9) or out.mode == tribo.Mode.OPEN


@settings(max_examples=300, deadline=None)
@given(arrays, arrays, arrays)
def test_batch(w, b, mu):
    try:
        p, modes = tribo.batch_solve(w, b, mu)
    except REFUSED:
        return
    assert p.size == b.size and modes.size == b.size // 3


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 6), st.lists(floats, min_size=3, max_size=3), wild, wild, floats)
def test_touch(kind, size, position, orientation, margin):
    make = [lambda a, b, c: shape.sphere(a), shape.box, lambda a, b, c: shape.capsule(a, b),
            lambda a, b, c: shape.cylinder(a, b), lambda a, b, c: shape.cone(a, b),
            shape.ellipsoid, lambda a, b, c: shape.halfspace((a, b, c))][kind]
    try:
        out = tribo.touch(make(*size), shape.box(1, 1, 1), position_a=position,
                          orientation_a=orientation, margin=margin)
    except REFUSED:
        return
    for m in out:
        assert np.isfinite(m.normal).all() and len(m.points) > 0


@settings(max_examples=100, deadline=None)
@given(arrays, hnp.arrays(np.uint32, st.integers(0, 12)))
def test_hulls_and_meshes(points, triangles):
    for build in (lambda: shape.hull(points), lambda: shape.mesh(points, triangles)):
        try:
            build().bounds()
        except REFUSED:
            pass


steps = st.one_of(
    st.tuples(st.just("add"), st.integers(0, 4), st.lists(floats, min_size=3, max_size=3)),
    st.tuples(st.just("remove"), st.integers(0, 8)),
    st.tuples(st.just("step"), floats),
    st.tuples(st.just("steps"), st.integers(1, 5)),
    st.tuples(st.just("force"), st.integers(0, 8), wild),
    st.tuples(st.just("save")),
    st.tuples(st.just("load")),
    st.tuples(st.just("close")),
)
SHAPES = [shape.sphere(0.5), shape.box(0.5, 0.4, 0.3), shape.cylinder(0.4, 0.3),
          shape.hull(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])),
          shape.compound([(shape.sphere(0.3), (-0.3, 0, 0), (1, 0, 0, 0)),
                          (shape.sphere(0.3), (0.3, 0, 0), (1, 0, 0, 0))])]


@settings(max_examples=60, deadline=None)
@given(st.lists(steps, max_size=20))
def test_scenes(script):
    scene = tribo.Scene()
    scene.add(shape.halfspace((0, 0, 1)), kind=tribo.Kind.STATIC)
    saved = scene.save()
    for name, *values in script:
        try:
            if name == "add":
                scene.add(SHAPES[values[0]], density=10.0, position=values[1])
            elif name == "remove":
                scene.remove(values[0])
            elif name == "step":
                scene.step(values[0], substeps=2)
            elif name == "steps":
                for _ in range(values[0]):
                    scene.step(1 / 64)
            elif name == "force":
                scene.set_force(values[0], values[1])
            elif name == "save":
                saved = scene.save()
            elif name == "load":
                scene.load(saved)
            else:
                scene.close()
        except REFUSED:
            pass
    try:
        ids = scene.ids()
    except ValueError:
        return  # closed
    assert all(np.isfinite(scene.body(i)["position"]).all() for i in ids)
