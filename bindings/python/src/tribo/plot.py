"""Pictures: a scene from the side or in space, and impulses in the friction cone (matplotlib)."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from ._core import Float, Vector
from ._native import lib
from .scene import Scene
from .shape import Shape

_ROUND = {lib.TRIBO_SHAPE_SPHERE, lib.TRIBO_SHAPE_CAPSULE, lib.TRIBO_SHAPE_ELLIPSOID}


def _axes(axes: Any) -> Any:
    if axes is None:
        import matplotlib.pyplot as plt

        axes = plt.figure().add_subplot(projection="3d")
    return axes


def _rotate(q: Float, x: Float) -> Float:
    """Rows of x turned by the quaternion q."""
    w, v = q[0], q[1:]
    t = 2.0 * np.cross(v, x)
    turned: Float = x + w * t + np.cross(v, t)
    return turned


def _surface(shape: Shape, count: int) -> tuple[Float, Float, Float]:
    """Support points over a grid of directions: any convex shape, its corners found by themselves."""
    polar = np.linspace(1e-3, np.pi - 1e-3, count)
    around = np.linspace(0.0, 2.0 * np.pi, 2 * count)
    points = np.array([[shape.support((np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)))
                        for a in around] for p in polar])
    return points[..., 0], points[..., 1], points[..., 2]


def scene(world: Scene, axes: Any = None, *, count: int = 12, colors: Sequence[str] | None = None,
          ) -> Any:
    """Draw the convex shapes of a scene at their places; returns the axes."""
    axes = _axes(axes)
    palette = list(colors) if colors is not None else [f"C{i}" for i in range(10)]
    for id_ in world.ids():
        shape = world.shape(id_)
        if shape is None or shape.kind in (lib.TRIBO_SHAPE_HALFSPACE, lib.TRIBO_SHAPE_MESH,
                                           lib.TRIBO_SHAPE_COMPOUND):
            continue
        state = world.body(id_)
        grid = np.stack(_surface(shape, count if shape.kind in _ROUND else 2 * count), axis=-1)
        placed = _rotate(state["orientation"], grid.reshape(-1, 3)) + state["position"]
        x, y, z = placed.reshape(grid.shape).transpose(2, 0, 1)
        axes.plot_surface(x, y, z, color=palette[id_ % len(palette)], linewidth=0, alpha=0.9)
    axes.set_xlabel("x / m")
    axes.set_ylabel("y / m")
    axes.set_zlabel("z / m")
    axes.set_aspect("equal")
    return axes


def friction_cone(mu: float, impulses: Sequence[Vector] | Float = (), axes: Any = None) -> Any:
    """Draw the cone |p_t| <= mu p_n and impulses (n, t1, t2) in it; returns the axes."""
    axes = _axes(axes)
    p = np.asarray(impulses, np.float64).reshape(-1, 3)
    top = 1.0 if p.size == 0 else max(float(p[:, 0].max()), 1e-300)
    around, height = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 49), np.linspace(0.0, top, 2))
    axes.plot_surface(mu * height * np.cos(around), mu * height * np.sin(around), height,
                      color="C0", alpha=0.25, linewidth=0)
    for n, t1, t2 in p:
        axes.plot([0.0, t1], [0.0, t2], [0.0, n], color="C3", marker=".")
    axes.set_xlabel("t1 / N s")
    axes.set_ylabel("t2 / N s")
    axes.set_zlabel("n / N s")
    return axes
