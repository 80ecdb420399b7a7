"""Errors: one exception for each status of the C library."""

from __future__ import annotations

from ._native import ffi, lib


class TriboError(Exception):
    """A call that the C library refused; nothing was changed. `status` is its number."""

    status: int = -1

    def __init__(self, where: str = "tribo") -> None:
        self.where = where
        text = ffi.string(lib.tribo_status_string(self.status)).decode()
        super().__init__(f"{where}: {text}")

    def __str__(self) -> str:
        return str(self.args[0])


class NullError(TriboError, ValueError):
    """A pointer that must not be null is null."""

    status = 10


class StructSizeError(TriboError, ValueError):
    """Struct_size is zero, odd or larger than this library knows."""

    status = 11


class OptionError(TriboError, ValueError):
    """An enumerated option has no such value."""

    status = 12


class BadIndexError(TriboError, IndexError):
    """An index lies outside of its array."""

    status = 13


class IsaError(TriboError, ValueError):
    """The instruction set is not available on this machine."""

    status = 14


class UnknownNameError(TriboError, KeyError):
    """No entry has that name."""

    status = 15


class AliasError(TriboError, ValueError):
    """Two arguments that must differ are the same object."""

    status = 16


class CapacityError(TriboError, ValueError):
    """The caller's buffer is too small; the size needed is told."""

    status = 17


class OutOfMemoryError(TriboError, MemoryError):
    """A library beneath could not allocate."""

    status = 18


class DataError(TriboError, ValueError):
    """A block of data is not one that this library made."""

    status = 19


class NotFiniteError(TriboError, ValueError):
    """An input is NaN or infinite."""

    status = 20


class RangeError(TriboError, ValueError):
    """A finite input or the result is outside of the stated range."""

    status = 21


class NormalError(TriboError, ValueError):
    """The contact normal is not of unit length."""

    status = 22


class OrientationError(TriboError, ValueError):
    """The quaternion is not of unit length."""

    status = 23


class FrameError(TriboError, ValueError):
    """The contact frame is not orthonormal and right-handed."""

    status = 24


class MassError(TriboError, ValueError):
    """Mass or inverse mass is negative, or zero where it must not be."""

    status = 30


class InertiaError(TriboError, ValueError):
    """Inertia is asymmetric, indefinite, or of no possible body."""

    status = 31


class ShapeError(TriboError, ValueError):
    """A length or density of a shape is not positive."""

    status = 32


class TimeStepError(TriboError, ValueError):
    """The time step is negative, or too long to be resolved."""

    status = 33


class DegenerateError(TriboError, ValueError):
    """Points span no volume, or no triangle has an area."""

    status = 34


class SupportError(TriboError, ValueError):
    """A user's support function contradicts itself."""

    status = 35


class PairError(TriboError, ValueError):
    """These two kinds of shapes cannot be tested against each other."""

    status = 36


class FrictionError(TriboError, ValueError):
    """Mu_s < 0, mu_d < 0 or mu_s < mu_d."""

    status = 40


class RestitutionError(TriboError, ValueError):
    """E lies outside of [0, 1] (tangential: [-1, 1])."""

    status = 41


class ContactMatrixError(TriboError, ValueError):
    """The contact matrix is not positive semidefinite."""

    status = 50


class ImmovableError(TriboError, ValueError):
    """Neither body can move at the contact along the normal."""

    status = 51


class JamError(TriboError, ValueError):
    """No bounded impulse satisfies Coulomb's law: the contact jams."""

    status = 52


_BY_STATUS = {
    cls.status: cls for cls in TriboError.__subclasses__()
}


def error_of(status: int, where: str = "tribo") -> TriboError:
    """The exception of a status; a plain TriboError for one that this version does not know."""
    cls = _BY_STATUS.get(status)
    if cls is None:
        error = TriboError.__new__(TriboError)
        error.status = status
        TriboError.__init__(error, where)
        return error
    return cls(where)


def check(status: int, where: str = "tribo") -> None:
    """Raise the exception of a status other than TRIBO_OK."""
    if status != 0:
        raise error_of(status, where)
