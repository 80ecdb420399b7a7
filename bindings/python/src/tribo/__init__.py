"""tribo: contact and friction between rigid bodies, resolved exactly and fast.

One contact (solve, impact, collide), many that do not influence each other (batch_solve, ...), many
that do (System), contacts from shapes (touch), worlds that step through time (Scene), and sweeps
over parameters (sweep). SI units; quaternions are (w, x, y, z); contact coordinates are (n, t1, t2)
with the normal from body B to body A. What a function means in full stands in the C headers, at the
function of the same name.
"""

from . import errors, shape
from ._core import (DTYPES, Event, Isa, Kind, Law, Measure, Method, Mix, Mode, Skip, Solver, Stop,
                    bodies, zeros)
from ._native import ffi as _ffi
from ._native import lib as _lib
from .contact import (Contact, Impact, Material, Solution, advance, apply_impulse, audit,
                      batch_impact, batch_matrix, batch_solve, body, check_body, collide,
                      cone_contains, cone_project, impact, material_names, normalize, rotation,
                      solve, totals)
from .errors import TriboError
from .scene import Saved, Scene
from .shape import Manifold, Shape, Tree, touch, touch_batch
from .sweep import Result, grid, sweep
from .system import System

__version__: str = _ffi.string(_lib.tribo_version_string()).decode()

#: Index of a body that means the immovable world.
WORLD: int = _lib.TRIBO_WORLD

__all__ = [
    "DTYPES", "WORLD", "Contact", "Event", "Impact", "Isa", "Kind", "Law", "Manifold", "Material",
    "Measure", "Method", "Mix", "Mode", "Result", "Saved", "Scene", "Shape", "Skip", "Solution",
    "Solver", "Stop", "System", "Tree", "TriboError", "advance", "apply_impulse", "audit",
    "batch_impact", "batch_matrix", "batch_solve", "bodies", "body", "check_body", "collide",
    "cone_contains", "cone_project", "errors", "grid", "impact", "material_names", "normalize",
    "rotation", "shape", "solve", "sweep", "totals", "touch", "touch_batch", "zeros",
]
