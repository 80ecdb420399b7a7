"""Bodies with shapes that move, touch, slide, roll, bounce and rest."""

from __future__ import annotations

from concurrent.futures import Executor
from typing import Any, Callable, Iterator

import numpy as np

from ._core import (DTYPES, Float, Kind, Mix, Skip, Solver, Struct, Vector, pointer, record, sized,
                    struct_pointer, vector)
from ._native import ffi, lib
from ._owner import Owner, parallel
from .contact import Material
from .errors import CapacityError, check
from .shape import Shape


class Scene(Owner):
    """A world of bodies that steps through time.

    One Scene is for one thread at a time: a call while another thread is inside raises
    RuntimeError. Use it in a `with` block, or close() it."""

    def __init__(self, gravity: Vector = (0.0, 0.0, -9.81), *,
                 friction_rule: Mix = Mix.GEOMETRIC_MEAN,
                 restitution_rule: Mix = Mix.GEOMETRIC_MEAN) -> None:
        settings = sized("tribo_scene_settings", friction_rule=friction_rule,
                         restitution_rule=restitution_rule,
                         gravity=list(vector(gravity, 3, "gravity")))
        out = ffi.new("tribo_scene **")
        check(lib.tribo_scene_create(settings, ffi.NULL, out), "Scene")
        super().__init__(out[0], lib.tribo_scene_destroy)
        self._shapes: dict[int, Shape] = {}  # what C refers to must outlive the bodies
        self.time = 0.0

    # ---- bodies ----

    def add(self, shape: Shape | None = None, *, density: float | None = None,
            state: Struct | None = None, kind: Kind = Kind.DYNAMIC,
            position: Vector = (0, 0, 0), orientation: Vector = (1, 0, 0, 0),
            velocity: Vector = (0, 0, 0), angular_velocity: Vector = (0, 0, 0),
            material: Material = Material(), belt: Vector = (0, 0, 0), rolling: float = 0.0,
            spinning: float = 0.0) -> int:
        """Add a body; returns its id.

        A dynamic body needs `density` with a shape (whose centre of mass then is the body's
        origin), or `state`: a body of DTYPES["body"], which also holds pose and velocities.
        rolling, spinning: lengths (m) of resistance; of a pair the greater ones count."""
        c = ffi.new("tribo_scene_body *")
        check(lib.tribo_scene_body_init(c), "Scene.add")
        c.kind = kind
        c.material = material._c()[0]
        c.belt = list(vector(belt, 3, "belt"))
        c.rolling, c.spinning = rolling, spinning
        if shape is not None:
            c.shape = shape._c[0]
        if state is not None:
            c.state = struct_pointer(state, "body", "state")[0]
        else:
            c.state.position = list(vector(position, 3, "position"))
            c.state.orientation = list(vector(orientation, 4, "orientation"))
            c.state.velocity = list(vector(velocity, 3, "velocity"))
            c.state.angular_velocity = list(vector(angular_velocity, 3, "angular_velocity"))
            if kind == Kind.DYNAMIC:
                self._set_mass(c, shape, density)
        id_ = ffi.new("uint32_t *")
        with self._alone():
            check(lib.tribo_scene_add(self._handle, c, id_), "Scene.add")
            if shape is not None:
                self._shapes[id_[0]] = shape
        return int(id_[0])

    @staticmethod
    def _set_mass(c: Any, shape: Shape | None, density: float | None) -> None:
        if shape is None or density is None:
            raise TypeError("Scene.add: a dynamic body needs a shape and a density, or a state")
        mass, center, inertia = shape.mass(density)
        c.offset.position = [-float(x) for x in center]
        check(lib.tribo_body_set_mass(ffi.addressof(c.state), mass,
                                      vector(inertia.reshape(-1), 9, "inertia")), "Scene.add")

    def remove(self, id: int) -> None:
        """Remove a body and its contacts."""
        with self._alone():
            check(lib.tribo_scene_remove(self._handle, id), "Scene.remove")
            self._shapes.pop(id, None)

    def __len__(self) -> int:
        with self._alone():
            count = ffi.new("uint32_t *")
            check(lib.tribo_scene_counts(self._handle, count, ffi.NULL), "Scene")
            return int(count[0])

    def ids(self) -> list[int]:
        """Ids in use, ascending."""
        with self._alone():
            end = ffi.new("uint32_t *")
            body = ffi.new("tribo_body *")
            check(lib.tribo_scene_counts(self._handle, ffi.NULL, end), "Scene.ids")
            return [i for i in range(end[0])
                    if lib.tribo_scene_get_body(self._handle, i, body, ffi.NULL) == 0]

    def body(self, id: int) -> Struct:
        """Pose and velocities of a body: a record of DTYPES["body"]."""
        out = ffi.new("tribo_body *")
        with self._alone():
            check(lib.tribo_scene_get_body(self._handle, id, out, ffi.NULL), "Scene.body")
        return record(out, "body")

    def asleep(self, id: int) -> bool:
        out, asleep = ffi.new("tribo_body *"), ffi.new("uint32_t *")
        with self._alone():
            check(lib.tribo_scene_get_body(self._handle, id, out, asleep), "Scene.asleep")
        return bool(asleep[0])

    def set_body(self, id: int, state: Struct) -> None:
        """Change pose, velocities or mass of a body."""
        with self._alone():
            check(lib.tribo_scene_set_body(self._handle, id,
                                           struct_pointer(state, "body", "state")),
                  "Scene.set_body")

    def set_force(self, id: int, force: Vector, torque: Vector = (0, 0, 0)) -> None:
        """Force (N) at the centre of mass and torque (N m), from now on."""
        with self._alone():
            check(lib.tribo_scene_set_force(self._handle, id, vector(force, 3, "force"),
                                            vector(torque, 3, "torque")), "Scene.set_force")

    def set_gravity(self, gravity: Vector) -> None:
        with self._alone():
            check(lib.tribo_scene_set_gravity(self._handle, vector(gravity, 3, "gravity")),
                  "Scene.set_gravity")

    def shape(self, id: int) -> Shape | None:
        """The shape that a body was added with."""
        return self._shapes.get(id)

    # ---- time ----

    def step(self, dt: float, *, substeps: int = 1, solver: Solver = Solver.AUTO,
             tolerance: float = 0.0, max_iterations: int = 0, skip: Skip = Skip.NOTHING,
             margin: float = 0.0, threshold: float = 0.0, correction: float = 0.0,
             sleep_time: float = 0.0, sleep_speed: float = 0.0, tasks: int = 0,
             executor: Executor | None = None) -> Struct:
        """Advance by dt seconds; returns a record of DTYPES["step_info"]. Options: see scene.h.
        On an error the scene is as it was."""
        options = sized("tribo_step_options", substeps=substeps, solver=solver,
                        tolerance=tolerance, max_iterations=max_iterations, skip=skip,
                        margin=margin, threshold=threshold, correction=correction,
                        sleep_time=sleep_time, sleep_speed=sleep_speed, tasks=tasks)
        run = parallel(executor) if executor is not None else None
        if run is not None:
            options.parallel = run
        info = sized("tribo_step_info")
        with self._alone():
            check(lib.tribo_scene_step(self._handle, dt, options, info), "Scene.step")
            self.time += dt
        return record(info, "step_info")

    def run(self, seconds: float, dt: float, *, progress: bool = False, **options: Any,
            ) -> Iterator[Struct]:
        """Steps of dt for about so many seconds, one info each; progress: a bar of tqdm."""
        from tqdm.auto import tqdm

        for _ in tqdm(range(round(seconds / dt)), disable=not progress, unit="step"):
            yield self.step(dt, **options)

    # ---- what happened ----

    def _list(self, function: Callable[..., int], struct: str, where: str) -> Struct:
        count = ffi.new("size_t *")
        with self._alone():
            status = function(self._handle, 0, ffi.NULL, count)
            out = np.zeros(count[0], DTYPES[struct])
            if status == CapacityError.status:
                status = function(self._handle, count[0], pointer("tribo_" + struct, out), count)
        check(status, where)
        return out

    def contacts(self) -> Struct:
        """Contact points of the last sub-step: an array of DTYPES["scene_contact"]."""
        return self._list(lib.tribo_scene_contacts, "scene_contact", "Scene.contacts")

    def events(self) -> Struct:
        """What touched in the last step: an array of DTYPES["scene_event"]."""
        return self._list(lib.tribo_scene_events, "scene_event", "Scene.events")

    def totals(self, origin: Vector = (0, 0, 0)) -> tuple[Struct, float]:
        """Momentum about `origin` and kinetic energy (a record of DTYPES["totals"]), and potential
        energy."""
        out, potential = ffi.new("tribo_totals *"), ffi.new("double *")
        with self._alone():
            check(lib.tribo_scene_totals(self._handle, vector(origin, 3, "origin"), out,
                                         potential), "Scene.totals")
        return record(out, "totals"), float(potential[0])

    # ---- saving ----

    def save(self) -> Saved:
        """All of the scene; load() goes on from there to the bit."""
        needed = ffi.new("size_t *")
        with self._alone():
            lib.tribo_scene_save(self._handle, ffi.NULL, 0, needed)
            words = np.zeros((needed[0] + 7) // 8)
            check(lib.tribo_scene_save(self._handle, pointer("double", words), words.nbytes,
                                       needed), "Scene.save")
            return Saved(words, dict(self._shapes), self.time)

    def load(self, saved: Saved) -> None:
        """Go back to what save() of this or another Scene gave."""
        if not isinstance(saved, Saved):
            raise TypeError("Scene.load: what Scene.save gave is needed")
        with self._alone():
            check(lib.tribo_scene_load(self._handle, pointer("double", saved._words),
                                       saved._words.nbytes), "Scene.load")
            self._shapes = dict(saved._shapes)
            self.time = saved.time


class Saved:
    """A state of a scene, for this process: it keeps alive the shapes that it refers to."""

    __slots__ = ("_shapes", "_words", "time")

    def __init__(self, words: Float, shapes: dict[int, Shape], time: float) -> None:
        words.flags.writeable = False
        self._words, self._shapes, self.time = words, shapes, time

    def __eq__(self, other: object) -> bool:
        """The same to the bit."""
        return isinstance(other, Saved) and self._words.tobytes() == other._words.tobytes()

    __hash__ = None  # type: ignore[assignment]
