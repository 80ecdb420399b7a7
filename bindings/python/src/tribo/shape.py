"""Shapes, contact manifolds between them, and the broad phase."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ._core import (DTYPES, Float, Method, Struct, Vector, array, pointer, record, rows, sized,
                    to_numpy, vector, vector_out)
from ._native import ffi, lib
from .errors import CapacityError, check


class Shape:
    """A shape; made by the functions below. It keeps alive what it is made of."""

    __slots__ = ("_c", "_keep")

    def __init__(self, kind: int, size: Sequence[float] = (), data: Any = ffi.NULL,
                 count: int = 0, keep: Any = None) -> None:
        self._c = ffi.new("tribo_shape *", {"type": kind, "count": count, "data": data,
                                            "size": [float(v) for v in size]})
        self._keep = (data, keep)
        check(lib.tribo_shape_check(self._c), "Shape")

    @property
    def kind(self) -> int:
        """TRIBO_SHAPE_... of shape.h."""
        return int(self._c.type)

    @property
    def size(self) -> Float:
        """Lengths, as the kind of shape has them."""
        return to_numpy(self._c.size)

    def support(self, direction: Vector) -> Float:
        """The farthest point along a direction."""
        out = vector_out(3)
        check(lib.tribo_shape_support(self._c, vector(direction, 3, "direction"), out), "support")
        return to_numpy(out)

    def bounds(self, position: Vector = (0, 0, 0), orientation: Vector = (1, 0, 0, 0),
               ) -> tuple[Float, Float]:
        """Least and greatest corner of the axis-aligned bounds at a pose."""
        low, high = vector_out(3), vector_out(3)
        check(lib.tribo_shape_bounds(self._c, _pose(position, orientation), low, high), "bounds")
        return to_numpy(low), to_numpy(high)

    def mass(self, density: float) -> tuple[float, Float, Float]:
        """Mass, centre of mass and inertia (3, 3) of a uniform solid of this shape."""
        out, center, inertia = ffi.new("double *"), vector_out(3), vector_out(9)
        check(lib.tribo_shape_mass(self._c, density, out, center, inertia), "mass")
        return out[0], to_numpy(center), to_numpy(inertia).reshape(3, 3)


def sphere(radius: float) -> Shape:
    return Shape(lib.TRIBO_SHAPE_SPHERE, (radius,))


def box(hx: float, hy: float, hz: float) -> Shape:
    """Half-extents."""
    return Shape(lib.TRIBO_SHAPE_BOX, (hx, hy, hz))


def capsule(radius: float, half_height: float) -> Shape:
    return Shape(lib.TRIBO_SHAPE_CAPSULE, (radius, half_height))


def cylinder(radius: float, half_height: float) -> Shape:
    return Shape(lib.TRIBO_SHAPE_CYLINDER, (radius, half_height))


def cone(radius: float, half_height: float) -> Shape:
    return Shape(lib.TRIBO_SHAPE_CONE, (radius, half_height))


def ellipsoid(a: float, b: float, c: float) -> Shape:
    return Shape(lib.TRIBO_SHAPE_ELLIPSOID, (a, b, c))


def halfspace(normal: Vector, d: float = 0.0) -> Shape:
    """All x with normal . x <= d."""
    return Shape(lib.TRIBO_SHAPE_HALFSPACE, (*vector(normal, 3, "normal"), d))


def _block(build: Callable[[Any, int, Any], int], where: str) -> Any:
    """The block of a hull or mesh: its size asked for, then filled."""
    needed = ffi.new("size_t *")
    status = build(ffi.NULL, 0, needed)
    if status != CapacityError.status:
        check(status, where)
    block = ffi.new("double[]", (needed[0] + 7) // 8)
    check(build(block, ffi.sizeof(block), needed), where)
    return block


def hull(points: Float) -> Shape:
    """Convex hull of points (n, 3)."""
    n = rows(points, 3, "points")
    data = pointer("double", points)
    block = _block(lambda b, size, needed: lib.tribo_hull_build(n, data, b, size, needed), "hull")
    return Shape(lib.TRIBO_SHAPE_HULL, data=block)


def mesh(vertices: Float, triangles: NDArray[np.uint32]) -> Shape:
    """Static triangle mesh: vertices (n, 3), triangles (m, 3) of indices, uint32."""
    n = rows(vertices, 3, "vertices")
    array(triangles, np.uint32, None, "triangles")
    if triangles.size % 3 != 0:
        raise ValueError("triangles: three indices a triangle are needed")
    count = triangles.size // 3
    v, t = pointer("double", vertices), pointer("uint32_t", triangles)
    block = _block(lambda b, size, needed: lib.tribo_mesh_build(n, v, count, t, b, size, needed),
                   "mesh")
    return Shape(lib.TRIBO_SHAPE_MESH, data=block)


def compound(children: Sequence[tuple[Shape, Vector, Vector]]) -> Shape:
    """Convex parts, each with position and orientation."""
    parts = ffi.new("tribo_child[]", len(children))
    for part, (shape, position, orientation) in zip(parts, children):
        part.shape = shape._c[0]
        part.pose = _pose(position, orientation)[0]
    return Shape(lib.TRIBO_SHAPE_COMPOUND, data=parts, count=len(children), keep=list(children))


def convex(support: Callable[[Float], Vector], center: Vector, radius: float) -> Shape:
    """A convex shape by a support function: direction -> farthest point along it, body axes.

    center: a point well inside; radius: of a ball around it that holds the shape. A function that
    raises, or gives no three numbers, makes the calls that use the shape raise SupportError."""

    def call(_user: Any, direction: Any, point: Any) -> None:
        point[0:3] = [float("nan")] * 3
        point[0:3] = [float(v) for v in support(to_numpy(ffi.cast("double(*)[3]", direction)[0]))]

    callback = ffi.callback("tribo_support_function", call, onerror=lambda *_: None)
    data = sized("tribo_convex", support=callback, center=list(vector(center, 3, "center")),
                 radius=radius)
    return Shape(lib.TRIBO_SHAPE_CONVEX, data=data, keep=callback)


# ---- manifolds -----------------------------------------------------------------------------------


def _pose(position: Vector, orientation: Vector) -> Any:
    return ffi.new("tribo_pose *", {"position": list(vector(position, 3, "position")),
                                    "orientation": list(vector(orientation, 4, "orientation"))})


@dataclass(frozen=True)
class Manifold:
    """Contact between two convex parts: normal from B to A, and a record of DTYPES["point"] for
    each point (arm_a, arm_b, distance, id)."""

    normal: Float
    points: Struct
    child_a: int
    child_b: int
    method: Method


def _manifold(raw: Struct) -> Manifold:
    return Manifold(raw["normal"].copy(), raw["points"][: raw["count"]].copy(),
                    int(raw["child_a"]), int(raw["child_b"]), Method(int(raw["method"])))


def touch(a: Shape, b: Shape, *, position_a: Vector = (0, 0, 0),
          orientation_a: Vector = (1, 0, 0, 0), position_b: Vector = (0, 0, 0),
          orientation_b: Vector = (1, 0, 0, 0), margin: float = 0.0, max_points: int = 0,
          method: Method = Method.AUTOMATIC) -> list[Manifold]:
    """Contact manifolds between two shapes at poses; none if they are farther apart than
    `margin`."""
    options = sized("tribo_collide_options", method=method, max_points=max_points, margin=margin)
    count = ffi.new("uint32_t *")
    capacity = 4
    poses = _pose(position_a, orientation_a), _pose(position_b, orientation_b)
    while True:
        out = np.zeros(capacity, DTYPES["manifold"])
        status = lib.tribo_collide_shapes(a._c, poses[0], b._c, poses[1], options, capacity,
                                          pointer("tribo_manifold", out), count, ffi.NULL)
        if status != CapacityError.status:
            check(status, "touch")
            return [_manifold(raw) for raw in out[: count[0]]]
        capacity = count[0]


def touch_batch(shapes: Sequence[Shape], poses: Struct, pairs: NDArray[np.uint32],
                margin: float = 0.0, statuses: NDArray[np.int32] | None = None) -> Struct:
    """One manifold (dtype DTYPES["manifold"]) for each pair of indices; poses: DTYPES["pose"]."""
    array(poses, DTYPES["pose"], len(shapes), "poses")
    array(pairs, np.uint32, None, "pairs")
    if pairs.size % 2 != 0:
        raise ValueError("pairs: two indices a pair are needed")
    n = pairs.size // 2
    if statuses is not None:
        array(statuses, np.int32, n, "statuses", True)
    flat = ffi.new("tribo_shape[]", [s._c[0] for s in shapes])
    out = np.zeros(n, DTYPES["manifold"])
    options = sized("tribo_collide_options", margin=margin)
    status = lib.tribo_collide_batch(len(shapes), flat, pointer("tribo_pose", poses), n,
                                     pointer("uint32_t", pairs), options,
                                     pointer("tribo_manifold", out),
                                     pointer("tribo_status", statuses), ffi.NULL)
    if statuses is None or not statuses.any():
        check(status, "touch_batch")
    return out


# ---- broad phase ---------------------------------------------------------------------------------


class Tree:
    """Which of many axis-aligned boxes overlap: a dynamic tree."""

    def __init__(self, capacity: int, margin: float = 0.0) -> None:
        size = lib.tribo_tree_size(capacity)
        self._block = ffi.new("double[]", (size + 7) // 8)
        out = ffi.new("tribo_tree **")
        check(lib.tribo_tree_init(self._block, capacity, margin, out), "Tree")
        self._tree = out[0]

    def add(self, low: Vector, high: Vector) -> int:
        """Add a box; returns its id."""
        out = ffi.new("uint32_t *")
        check(lib.tribo_tree_add(self._tree, vector(low, 3, "low"), vector(high, 3, "high"), out),
              "Tree.add")
        return int(out[0])

    def move(self, id: int, low: Vector, high: Vector) -> None:
        check(lib.tribo_tree_move(self._tree, id, vector(low, 3, "low"), vector(high, 3, "high")),
              "Tree.move")

    def remove(self, id: int) -> None:
        check(lib.tribo_tree_remove(self._tree, id), "Tree.remove")

    def pairs(self) -> NDArray[np.uint32]:
        """Overlapping pairs of ids (n, 2), sorted."""
        return _ids(lambda n, out, count: lib.tribo_tree_pairs(self._tree, n, out, count),
                    2, "Tree.pairs").reshape(-1, 2)

    def query_box(self, low: Vector, high: Vector) -> NDArray[np.uint32]:
        """Ids of boxes that overlap a box, sorted."""
        a, b = vector(low, 3, "low"), vector(high, 3, "high")
        return _ids(lambda n, out, count: lib.tribo_tree_query_box(self._tree, a, b, n, out, count),
                    1, "Tree.query_box")

    def query_ray(self, start: Vector, end: Vector) -> NDArray[np.uint32]:
        """Ids of boxes that a segment meets, sorted."""
        a, b = vector(start, 3, "start"), vector(end, 3, "end")
        return _ids(lambda n, out, count: lib.tribo_tree_query_ray(self._tree, a, b, n, out, count),
                    1, "Tree.query_ray")


def _ids(fill: Callable[[int, Any, Any], int], width: int, where: str) -> NDArray[np.uint32]:
    count = ffi.new("size_t *")
    status = fill(0, ffi.NULL, count)
    out = np.zeros(width * count[0], np.uint32)
    if status == CapacityError.status:
        status = fill(count[0], pointer("uint32_t", out), count)
    check(status, where)
    return out


__all__ = ["Manifold", "Shape", "Tree", "box", "capsule", "compound", "cone", "convex", "cylinder",
           "ellipsoid", "halfspace", "hull", "mesh", "sphere", "touch", "touch_batch"]
