"""Many contacts coupled through their bodies: solvers, warm start, certificate."""

from __future__ import annotations

import time
from concurrent.futures import Executor
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray

from ._core import (DTYPES, Float, Isa, Measure, Solver, Stop, Struct, array, pointer, record,
                    sized)
from ._native import ffi, lib
from ._owner import Owner, parallel
from .errors import check

Progress = Callable[[Struct], bool]


class System(Owner):
    """Solves systems of bodies and contacts; keeps workspace, factorisations and results.

    One System is for one thread at a time: a call while another thread is inside raises
    RuntimeError. Use it in a `with` block, or close() it."""

    def __init__(self) -> None:
        out = ffi.new("tribo_sparse **")
        check(lib.tribo_sparse_create(lib.TRIBO_SPARSE_AUTO, ffi.NULL, out), "System")
        super().__init__(out[0], lib.tribo_sparse_destroy)
        self._workspace = ffi.new("double[]", 1)
        self.impulses: Float = np.zeros((0, 3))
        self.torques: Float = np.zeros((0, 3))
        self.velocities: Float = np.zeros((0, 6))
        self.info: Struct = np.zeros(1, DTYPES["system_info"])[0]

    def _options(self, keep: list[Any], solver: Solver, measure: Measure, tolerance: float,
                 max_iterations: int, max_seconds: float, warm_start: bool, isa: Isa, tasks: int,
                 executor: Executor | None, progress: Progress | None) -> Any:
        linear = sized("tribo_linear")
        check(lib.tribo_sparse_linear(self._handle, linear), "System")
        clock = ffi.callback("tribo_clock_function", lambda _user: time.perf_counter())
        keep += [linear, clock]
        o = sized("tribo_system_options", solver=solver, measure=measure, tolerance=tolerance,
                  max_iterations=max_iterations, max_seconds=max_seconds,
                  warm_start=int(warm_start), isa=isa, tasks=tasks, linear=linear, clock=clock)
        if executor is not None:
            keep.append(parallel(executor))
            o.parallel = keep[-1]
        if progress is not None:
            def call(_user: Any, info: Any) -> int:
                return int(bool(progress(record(info, "system_info"))))

            keep.append(ffi.callback("tribo_progress_function", call, error=1))
            o.progress = keep[-1]
        return o

    def _room(self, size: int) -> Any:
        if ffi.sizeof(self._workspace) < size:
            self._workspace = ffi.new("double[]", (size + 7) // 8)
        return self._workspace

    def solve(self, bodies: Struct, contacts: Struct, *, solver: Solver = Solver.AUTO,
              tolerance: float = 0.0, measure: Measure = Measure.ETA, max_iterations: int = 0,
              max_seconds: float = 0.0, warm_start: bool = False, isa: Isa = Isa.BEST,
              tasks: int = 0, executor: Executor | None = None, progress: Progress | None = None,
              ) -> Struct:
        """Solve for bodies (DTYPES["body"]) and contacts (DTYPES["system_contact"]).

        Results: impulses (n, 3), torques (n, 3) of contacts that resist rolling or spinning,
        velocities (m, 6), info, which is also returned: a record of DTYPES["system_info"].
        warm_start: from the impulses and torques of the last call. executor: a pool
        that runs up to `tasks` tasks at once; no bit depends on it. progress: called with what is
        known so far; True stops."""
        array(bodies, DTYPES["body"], None, "bodies")
        array(contacts, DTYPES["system_contact"], None, "contacts")
        n = contacts.size
        keep: list[Any] = []
        with self._alone():
            o = self._options(keep, solver, measure, tolerance, max_iterations, max_seconds,
                              warm_start, isa, tasks, executor, progress)
            impulses = self._start(n, warm_start)
            torques = self.torques.copy() if warm_start else np.zeros((n, 3))
            o.torques = pointer("double", torques)
            velocities = np.zeros((bodies.size, 6))
            size, info = ffi.new("size_t *"), sized("tribo_system_info")
            b, c = pointer("tribo_body", bodies), pointer("tribo_system_contact", contacts)
            check(lib.tribo_system_workspace_size(bodies.size, n, c, o, size), "System.solve")
            room = self._room(size[0])
            check(lib.tribo_system_solve(bodies.size, b, n, c, o, room, ffi.sizeof(room),
                                         pointer("double", impulses),
                                         pointer("double", velocities), info), "System.solve")
            return self._take(impulses, torques, velocities, info)

    def solve_assembled(self, q: Float, mu: Float, blocks: Float,
                        row_starts: NDArray[np.uint32] | None = None,
                        columns: NDArray[np.uint32] | None = None, *,
                        solver: Solver = Solver.AUTO, tolerance: float = 0.0,
                        measure: Measure = Measure.ETA, max_iterations: int = 0,
                        max_seconds: float = 0.0, warm_start: bool = False, isa: Isa = Isa.BEST,
                        tasks: int = 0, executor: Executor | None = None,
                        progress: Progress | None = None) -> Struct:
        """Solve u = W r + q: q (n, 3), mu (n, 2), W dense (3n, 3n), or by 3x3 blocks (k, 9) with
        row_starts (n + 1) and columns (k), uint32. Results as `solve`; velocities are (n, 3)."""
        array(q, np.float64, None, "q")
        n = q.size // 3
        array(q, np.float64, 3 * n, "q")
        array(mu, np.float64, 2 * n, "mu")
        if row_starts is None or columns is None:
            array(blocks, np.float64, 9 * n * n, "blocks")
        else:
            array(row_starts, np.uint32, n + 1, "row_starts")
            array(columns, np.uint32, int(row_starts[-1]), "columns")
            array(blocks, np.float64, 9 * columns.size, "blocks")
        keep: list[Any] = []
        with self._alone():
            o = self._options(keep, solver, measure, tolerance, max_iterations, max_seconds,
                              warm_start, isa, tasks, executor, progress)
            impulses, velocities = self._start(n, warm_start), np.zeros((n, 3))
            size, info = ffi.new("size_t *"), sized("tribo_system_info")
            starts, places = pointer("uint32_t", row_starts), pointer("uint32_t", columns)
            check(lib.tribo_system_assembled_workspace_size(n, starts, places, o, size),
                  "System.solve_assembled")
            room = self._room(size[0])
            check(lib.tribo_system_solve_assembled(
                n, starts, places, pointer("double", blocks), pointer("double", q),
                pointer("double", mu), o, room, ffi.sizeof(room), pointer("double", impulses),
                pointer("double", velocities), info), "System.solve_assembled")
            return self._take(impulses, np.zeros((n, 3)), velocities, info)

    def _start(self, n: int, warm_start: bool) -> Float:
        if not warm_start:
            return np.zeros((n, 3))
        if self.impulses.size != 3 * n:
            raise ValueError("warm_start: the last call had another number of contacts")
        return self.impulses.copy()

    def _take(self, impulses: Float, torques: Float, velocities: Float, info: Any) -> Struct:
        self.impulses, self.torques, self.velocities = impulses, torques, velocities
        self.info = record(info, "system_info")
        return self.info

    @property
    def stop(self) -> Stop:
        """Why the last solve ended."""
        return Stop(int(self.info["stop"]))

    def apply(self, bodies: Struct) -> None:
        """Give the velocities of the last solve to the bodies, in place."""
        array(bodies, DTYPES["body"], self.velocities.size // 6, "bodies", True)
        check(lib.tribo_system_apply(bodies.size, pointer("tribo_body", bodies),
                                     pointer("double", self.velocities)), "System.apply")

    def report(self) -> Struct:
        """What the factorisations did (a record of DTYPES["sparse_info"])."""
        with self._alone():
            info = sized("tribo_sparse_info")
            check(lib.tribo_sparse_report(self._handle, info), "System.report")
            return record(info, "sparse_info")
