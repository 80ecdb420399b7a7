"""Sweeps: the same results in the same order however they are run; failures kept; resumable."""

import os

import numpy as np
import pytest
import tribo
from tribo import shape


def slide(mu, v):
    """Distance that a box slides, against v^2 / (2 mu g)."""
    if mu == 0.0:
        raise ValueError("it never stops")
    material = tribo.Material(mu, mu)
    with tribo.Scene((0, 0, -10.0)) as scene:
        scene.add(shape.halfspace((0, 0, 1)), kind=tribo.Kind.STATIC, material=material)
        box = scene.add(shape.box(0.5, 0.5, 0.1), density=10.0, position=(0, 0, 0.1),
                        velocity=(v, 0, 0), material=material)
        for _ in scene.run(1.0, 1 / 64):
            pass
        return float(scene.body(box)["position"][0])


def count(path, n):
    with open(path, "a") as file:
        file.write(f"{n}\n")
    return n * n


GRID = tribo.grid(mu=[0.5, 0.0, 0.8], v=[1.0, 2.0])


def same(a, b):
    return [(r.parameters, r.value, r.ok) for r in a] == [(r.parameters, r.value, r.ok) for r in b]


def test_local_and_in_this_process():
    here = tribo.sweep(slide, GRID, workers=0)
    assert [r.parameters for r in here] == GRID
    assert [r.ok for r in here] == [True, True, False, False, True, True]
    assert "it never stops" in here[2].error
    for r in here:
        if r.ok:
            exact = r.parameters["v"] ** 2 / (20 * r.parameters["mu"])
            assert abs(r.value - exact) < 0.02 * exact + r.parameters["v"] / 64
    assert same(here, tribo.sweep(slide, GRID, workers=2))


def test_resumes(tmp_path):
    journal, log = tmp_path / "sweep.journal", tmp_path / "log"
    tasks = [{"path": str(log), "n": n} for n in range(6)]
    first = tribo.sweep(count, tasks[:4], workers=0, resume=journal)
    with open(journal, "ab") as file:
        file.write(b"\x80cut off" * 9)
    second = tribo.sweep(count, tasks, workers=0, resume=journal)
    assert [r.value for r in first] == [0, 1, 4, 9]
    assert [r.value for r in second] == [0, 1, 4, 9, 16, 25]
    assert log.read_text().split() == ["0", "1", "2", "3", "4", "5"]
    assert os.path.getsize(journal) > 0


def test_on_a_cluster():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True,
                                  dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            assert same(tribo.sweep(slide, GRID, client=client),
                        tribo.sweep(slide, GRID, workers=0))


def test_pictures(tmp_path):
    import matplotlib.pyplot as plt
    from tribo import plot

    with tribo.Scene() as scene:
        scene.add(shape.box(0.5, 0.4, 0.3), density=1.0, position=(0, 0, 1))
        scene.add(shape.sphere(0.3), density=1.0, position=(1, 0, 1))
        axes = plot.scene(scene)
    assert len(axes.collections) == 2
    axes.figure.savefig(tmp_path / "scene.png")
    cone = plot.friction_cone(0.5, np.array([[1.0, 0.5, 0.0], [2.0, 0.0, 0.4]]))
    assert len(cone.lines) == 2
    cone.figure.savefig(tmp_path / "cone.png")
    plt.close("all")
