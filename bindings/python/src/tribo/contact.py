"""One contact and many that do not influence each other: bodies, materials, impacts, batches.

Short vectors may be any sequence of numbers. Arrays of many contacts are NumPy arrays that C reads
and writes in place: C-contiguous float64 (or the dtype that is stated); anything else raises.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from ._core import (DTYPES, Float, Isa, Law, Mix, Mode, Struct, Vector, array, bodies, pointer,
                    record, rows, sized, struct_pointer, to_numpy, vector, vector_out)
from ._native import ffi, lib
from .errors import check

# ---- bodies and materials ------------------------------------------------------------------------


@dataclass(frozen=True)
class Material:
    """Coefficients of a pair: static and dynamic friction, restitution."""

    mu_s: float = 0.0
    mu_d: float = 0.0
    e: float = 0.0

    def __post_init__(self) -> None:
        check(lib.tribo_material_check(self._c()), "Material")

    def _c(self) -> Any:
        return ffi.new("tribo_material *", {"mu_s": self.mu_s, "mu_d": self.mu_d, "e": self.e})

    def mix(self, other: Material, friction: Mix = Mix.GEOMETRIC_MEAN,
            restitution: Mix = Mix.GEOMETRIC_MEAN) -> Material:
        """The pair of two surfaces."""
        out = ffi.new("tribo_material *")
        check(lib.tribo_material_mix(self._c(), other._c(), friction, restitution, out), "mix")
        return _material(out)

    @staticmethod
    def named(name: str) -> Material:
        """Entry of the table of pairs, such as "wood on stone"."""
        out = ffi.new("tribo_material *")
        check(lib.tribo_material_find(name.encode(), out), name)
        return _material(out)


def _material(c: Any) -> Material:
    return Material(c.mu_s, c.mu_d, c.e)


def material_names() -> list[str]:
    """Names of the table of pairs."""
    name = ffi.new("char const **")
    out = ffi.new("tribo_material *")
    names = []
    for index in range(lib.tribo_material_count()):
        check(lib.tribo_material_at(index, name, out), "material_names")
        names.append(ffi.string(name[0]).decode())
    return names


def body(mass: float, inertia: Sequence[float] | Float, *, position: Vector = (0, 0, 0),
         orientation: Vector = (1, 0, 0, 0), velocity: Vector = (0, 0, 0),
         angular_velocity: Vector = (0, 0, 0)) -> Struct:
    """One body as an array of one (dtype DTYPES["body"]). inertia: 3x3, kg m^2, body axes."""
    out = bodies(1)
    flat = np.asarray(inertia, np.float64).reshape(-1)
    check(lib.tribo_body_set_mass(pointer("tribo_body", out), mass, vector(flat, 9, "inertia")),
          "body")
    out["position"] = position
    out["orientation"] = orientation
    out["velocity"] = velocity
    out["angular_velocity"] = angular_velocity
    check_body(out)
    return out


def check_body(b: Struct) -> None:
    """Judge every field of a body."""
    check(lib.tribo_body_check(struct_pointer(b, "body", "body")), "check_body")


def advance(b: Struct, dt: float, acceleration: Vector = (0, 0, 0)) -> None:
    """Free flight of a body, in place."""
    check(lib.tribo_body_advance(struct_pointer(b, "body", "body", True),
                                 vector(acceleration, 3, "acceleration"), dt), "advance")


def apply_impulse(b: Struct, arm: Vector, impulse: Vector) -> None:
    """Add an impulse (N s, world axes) at an arm from the centre of mass, in place."""
    check(lib.tribo_body_apply_impulse(struct_pointer(b, "body", "body", True),
                                       vector(arm, 3, "arm"), vector(impulse, 3, "impulse")),
          "apply_impulse")


def totals(bodies: Struct, origin: Vector = (0, 0, 0)) -> Struct:
    """Momentum about `origin` and kinetic energy of bodies (a record of DTYPES["totals"])."""
    array(bodies, DTYPES["body"], None, "bodies")
    out = ffi.new("tribo_totals *")
    check(lib.tribo_audit_bodies(bodies.size, pointer("tribo_body", bodies),
                                 vector(origin, 3, "origin"), out), "totals")
    return record(out, "totals")


# ---- one contact ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Impact:
    """What one contact got: the impulse (n, t1, t2), what it does, the energy it changed."""

    impulse: Float
    mode: Mode
    velocity: Float
    energy: float
    iterations: int


@dataclass(frozen=True)
class Solution:
    """What the exact solve of one contact found."""

    impulse: Float
    mode: Mode
    nu: float
    iterations: int


def solve(w: Vector, b: Vector, mu_s: float, mu_d: float | None = None) -> Solution:
    """Exact Signorini-Coulomb solve of one contact: v = W p + b.

    w: 6 numbers (symmetric: nn, n1, n2, 11, 12, 22) or 9 (any, row by row). mu_d None: mu_s."""
    p = vector_out(3)
    info = sized("tribo_solve_info")
    function = lib.tribo_contact_solve_general if len(w) == 9 else lib.tribo_contact_solve
    check(function(vector(w, 9 if len(w) == 9 else 6, "w"), vector(b, 3, "b"), mu_s,
                   mu_s if mu_d is None else mu_d, p, info), "solve")
    return Solution(to_numpy(p), Mode(info.mode), info.nu, info.iterations)


def impact(w: Vector, u: Vector, pair: Material, law: Law = Law.ALGEBRAIC,
           tangential_restitution: float = 0.0) -> Impact:
    """Impulse of an impact with relative velocity u = (n, t1, t2)."""
    p = vector_out(3)
    info = sized("tribo_impact_info")
    options = sized("tribo_impact_options", law=law,
                    tangential_restitution=tangential_restitution)
    check(lib.tribo_impact(vector(w, 6, "w"), vector(u, 3, "u"), pair._c(), options, p, info),
          "impact")
    return Impact(to_numpy(p), Mode(info.mode), to_numpy(info.velocity), info.energy,
                  info.iterations)


def collide(a: Struct, b: Struct | None, point: Vector, normal: Vector, pair: Material,
            law: Law = Law.ALGEBRAIC, tangential_restitution: float = 0.0) -> Struct:
    """A whole collision of two bodies, in place; b None: the world.

    Returns a record of DTYPES["collision_info"]."""
    info = sized("tribo_collision_info")
    options = sized("tribo_impact_options", law=law,
                    tangential_restitution=tangential_restitution)
    check(lib.tribo_collide(struct_pointer(a, "body", "a", True),
                            ffi.NULL if b is None else struct_pointer(b, "body", "b", True),
                            vector(point, 3, "point"), vector(normal, 3, "normal"), pair._c(),
                            options, info), "collide")
    return record(info, "collision_info")


class Contact:
    """One contact whose numbers stay in C: change w, b and mu, call solve, read p.

    The arrays w (6), b (3), mu (mu_s, mu_d) and p (3) are views of memory that this object owns.
    For loops that solve one contact at a time."""

    __slots__ = ("_c", "b", "mu", "p", "w")

    def __init__(self) -> None:
        self._c = ffi.new("contact_problem *")
        self.w: Float = np.frombuffer(ffi.buffer(self._c.w), np.float64)
        self.b: Float = np.frombuffer(ffi.buffer(self._c.b), np.float64)
        self.mu: Float = np.frombuffer(ffi.buffer(self._c.mu), np.float64)
        self.p: Float = np.frombuffer(ffi.buffer(self._c.p), np.float64)

    def solve(self, _solve: Any = lib.contact_solve) -> None:
        """tribo_contact_solve: p solves v = W p + b; on an error p stays as it was."""
        status = _solve(self._c)
        if status:
            check(status, "Contact.solve")


# ---- batches -------------------------------------------------------------------------------------


def _batch(status: int, statuses: NDArray[np.int32] | None, where: str) -> None:
    """With `statuses` a contact's own fault is told there and does not raise."""
    if statuses is None or not statuses.any():
        check(status, where)


def _outputs(n: int, p: Float | None, modes: NDArray[np.uint32] | None,
             statuses: NDArray[np.int32] | None) -> tuple[Float, NDArray[np.uint32]]:
    p = np.zeros((n, 3)) if p is None else array(p, np.float64, 3 * n, "p", True)
    modes = np.zeros(n, np.uint32) if modes is None else array(modes, np.uint32, n, "modes", True)
    if statuses is not None:
        array(statuses, np.int32, n, "statuses", True)
    return p, modes


def batch_solve(w: Float, b: Float, mu: Float, p: Float | None = None,
                modes: NDArray[np.uint32] | None = None,
                statuses: NDArray[np.int32] | None = None, isa: Isa = Isa.BEST,
                ) -> tuple[Float, NDArray[np.uint32]]:
    """Exact solve of many contacts: w (n, 6), b (n, 3), mu (n, 2). Returns p (n, 3) and modes."""
    n = rows(w, 6, "w")
    array(b, np.float64, 3 * n, "b")
    array(mu, np.float64, 2 * n, "mu")
    p, modes = _outputs(n, p, modes, statuses)
    _batch(lib.tribo_batch_solve(isa, n, pointer("double", w), pointer("double", b),
                                 pointer("double", mu), pointer("double", p),
                                 pointer("uint32_t", modes), pointer("tribo_status", statuses)),
           statuses, "batch_solve")
    return p, modes


def batch_impact(w: Float, u: Float, pairs: Struct, p: Float | None = None,
                 modes: NDArray[np.uint32] | None = None,
                 statuses: NDArray[np.int32] | None = None, isa: Isa = Isa.BEST,
                 ) -> tuple[Float, NDArray[np.uint32]]:
    """ALGEBRAIC impacts: w (n, 6), u (n, 3), pairs (n, dtype DTYPES["material"])."""
    n = rows(w, 6, "w")
    array(u, np.float64, 3 * n, "u")
    array(pairs, DTYPES["material"], n, "pairs")
    p, modes = _outputs(n, p, modes, statuses)
    _batch(lib.tribo_batch_impact(isa, n, pointer("double", w), pointer("double", u),
                                  pointer("tribo_material", pairs), pointer("double", p),
                                  pointer("uint32_t", modes), pointer("tribo_status", statuses)),
           statuses, "batch_impact")
    return p, modes


def batch_matrix(bodies: Struct, pairs: NDArray[np.uint32], contacts: Struct,
                 statuses: NDArray[np.int32] | None = None, isa: Isa = Isa.BEST,
                 ) -> tuple[Float, Float]:
    """Frames (n, 9) and contact matrices (n, 6) of contacts (dtype DTYPES["contact"]) between
    bodies; pairs (n, 2): indices of A and B, or WORLD."""
    array(bodies, DTYPES["body"], None, "bodies")
    array(contacts, DTYPES["contact"], None, "contacts")
    n = contacts.size
    array(pairs, np.uint32, 2 * n, "pairs")
    if statuses is not None:
        array(statuses, np.int32, n, "statuses", True)
    frames, w = np.zeros((n, 9)), np.zeros((n, 6))
    _batch(lib.tribo_batch_matrix(isa, bodies.size, pointer("tribo_body", bodies), n,
                                  pointer("uint32_t", pairs), pointer("tribo_contact", contacts),
                                  pointer("double", frames), pointer("double", w),
                                  pointer("tribo_status", statuses)), statuses, "batch_matrix")
    return frames, w


def audit(w: Float, b: Float, mu: Float, p: Float) -> tuple[Struct, Struct]:
    """Greatest and root-mean-square measures of impulses (records of DTYPES["measures"])."""
    n = rows(w, 6, "w")
    array(b, np.float64, 3 * n, "b")
    array(mu, np.float64, n, "mu")
    array(p, np.float64, 3 * n, "p")
    most, rms = ffi.new("tribo_measures *"), ffi.new("tribo_measures *")
    check(lib.tribo_audit_contacts(n, pointer("double", w), pointer("double", b),
                                   pointer("double", mu), pointer("double", p), most, rms),
          "audit")
    return record(most, "measures"), record(rms, "measures")


# ---- the friction cone ---------------------------------------------------------------------------


def cone_project(p: Vector, mu: float) -> Float:
    """The point of the friction cone nearest to p."""
    out = vector_out(3)
    check(lib.tribo_cone_project(vector(p, 3, "p"), mu, out), "cone_project")
    return to_numpy(out)


def cone_contains(p: Vector, mu: float, tolerance: float = 0.0) -> bool:
    """Whether p lies in the friction cone, to a relative tolerance."""
    return bool(lib.tribo_cone_contains(vector(p, 3, "p"), mu, tolerance))


def rotation(v: Vector) -> Float:
    """Quaternion (w, x, y, z) of the rotation by |v| radians about v."""
    out = vector_out(4)
    check(lib.tribo_quat_from_rotation_vector(vector(v, 3, "v"), out), "rotation")
    return to_numpy(out)


def normalize(v: Vector) -> Float:
    """v / |v|."""
    out = vector_out(3)
    check(lib.tribo_vec3_normalize(vector(v, 3, "v"), out), "normalize")
    return to_numpy(out)
