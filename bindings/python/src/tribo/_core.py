"""What all modules share: dtypes of C's structs, pointers to arrays, options."""

from __future__ import annotations

import enum
import json
from importlib import resources
from typing import Any, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from ._native import ffi, lib

Float = NDArray[np.float64]
Struct = NDArray[np.void]
Vector = Union[Sequence[float], Float]

# ---- structs -------------------------------------------------------------------------------------

_SCALARS = {"double": "f8", "uint32_t": "u4", "uint64_t": "u8", "int32_t": "i4", "size_t": "u8",
            "tribo_status": "i4"}


def _read_dtypes() -> dict[str, np.dtype[np.void]]:
    api = json.loads(resources.files("tribo").joinpath("api.json").read_text(encoding="utf-8"))
    known: dict[str, Any] = {}
    for struct in api["structs"]:
        formats = []
        for field in struct["fields"]:
            kind = field["type"]
            base = "u8" if "pointer" in field else known.get(kind, _SCALARS.get(kind, "u8"))
            formats.append((base, (field["count"],)) if "count" in field else base)
        known[struct["name"]] = np.dtype({
            "names": [field["name"] for field in struct["fields"]],
            "formats": formats,
            "offsets": [field["offset"] for field in struct["fields"]],
            "itemsize": struct["size"],
        })
    return {name.removeprefix("tribo_"): dtype for name, dtype in known.items()}


#: NumPy dtypes of the structs of C, by their names without "tribo_".
DTYPES: dict[str, np.dtype[np.void]] = _read_dtypes()


def zeros(struct: str, count: int) -> Struct:
    """An array of `count` structs, all zeros."""
    return np.zeros(count, DTYPES[struct])


def bodies(count: int) -> Struct:
    """An array of `count` bodies (dtype DTYPES["body"]): immovable, at the origin, at rest."""
    out = zeros("body", count)
    out["orientation"][:, 0] = 1.0
    return out


# ---- arrays --------------------------------------------------------------------------------------


def array(x: Any, dtype: Any, length: int | None, name: str, writable: bool = False) -> Any:
    """Judge an array that C reads or writes in place: its dtype, layout and length as they are.

    Nothing is converted or copied: what does not fit raises."""
    if not isinstance(x, np.ndarray):
        raise TypeError(f"{name}: a NumPy array is needed, not {type(x).__name__}")
    if x.dtype != dtype:
        raise TypeError(f"{name}: dtype {np.dtype(dtype)} is needed, not {x.dtype}")
    if not x.flags.c_contiguous:
        raise ValueError(f"{name}: a C-contiguous array is needed")
    if not x.flags.aligned:
        raise ValueError(f"{name}: an aligned array is needed")
    if writable and not x.flags.writeable:
        raise ValueError(f"{name}: a writable array is needed")
    if length is not None and x.size != length:
        raise ValueError(f"{name}: {length} entries are needed, not {x.size}")
    return x


def rows(x: Any, width: int, name: str) -> int:
    """Number of rows of `width` float64 in an array."""
    array(x, np.float64, None, name)
    if x.size % width != 0:
        raise ValueError(f"{name}: {width} numbers a row are needed, not {x.size} in all")
    return int(x.size // width)


def pointer(kind: str, x: Any) -> Any:
    """C's view of an array that has been judged; null for None."""
    if x is None or x.size == 0:
        return ffi.NULL
    return ffi.from_buffer(kind + "[]", x)


def vector(x: Vector, length: int, name: str) -> Any:
    """A short vector, of any sequence of numbers, copied to C."""
    if len(x) != length:
        raise ValueError(f"{name}: {length} numbers are needed, not {len(x)}")
    return ffi.new(f"double[{length}]", [float(v) for v in x])


def vector_out(length: int) -> Any:
    return ffi.new(f"double[{length}]")


def to_numpy(cdata: Any) -> Float:
    """A copy of a C array of doubles."""
    return np.frombuffer(ffi.buffer(cdata), np.float64).copy()


def sized(kind: str, **fields: Any) -> Any:
    """A struct of C with its size set."""
    out = ffi.new(f"{kind} *", fields)
    out.struct_size = ffi.sizeof(kind)
    return out


def record(cdata: Any, struct: str) -> Struct:
    """A copy of one struct of C as a NumPy record."""
    return np.frombuffer(ffi.buffer(cdata), DTYPES[struct]).copy()[0]  # type: ignore[no-any-return]


def struct_pointer(x: Any, struct: str, name: str, writable: bool = False) -> Any:
    """C's view of one struct: a NumPy record, or an array of one."""
    if isinstance(x, np.void):
        if writable:  # a record would be a copy, and what C writes be lost
            raise TypeError(f"{name}: an array of one is needed, such as bodies[i:i + 1]")
        x = np.asarray(x).reshape(1)
    return pointer("tribo_" + struct, array(x, DTYPES[struct], 1, name, writable))


# ---- enumerations --------------------------------------------------------------------------------


class Law(enum.IntEnum):
    """Impact laws: see contact.h."""

    ALGEBRAIC = lib.TRIBO_LAW_ALGEBRAIC
    FRICTIONLESS = lib.TRIBO_LAW_FRICTIONLESS
    LECTURE = lib.TRIBO_LAW_LECTURE
    COULOMB = lib.TRIBO_LAW_COULOMB
    ROUTH_NEWTON = lib.TRIBO_LAW_ROUTH_NEWTON
    ROUTH_POISSON = lib.TRIBO_LAW_ROUTH_POISSON
    ROUTH_STRONGE = lib.TRIBO_LAW_ROUTH_STRONGE
    LECTURE_CLOSING = lib.TRIBO_LAW_LECTURE_CLOSING


class Mode(enum.IntEnum):
    """What a contact does."""

    OPEN = lib.TRIBO_MODE_OPEN
    STICK = lib.TRIBO_MODE_STICK
    SLIP = lib.TRIBO_MODE_SLIP
    JAM = lib.TRIBO_MODE_JAM


class Solver(enum.IntEnum):
    """Solvers of a system."""

    AUTO = lib.TRIBO_SOLVER_AUTO
    GAUSS_SEIDEL = lib.TRIBO_SOLVER_GAUSS_SEIDEL
    NEWTON = lib.TRIBO_SOLVER_NEWTON


class Measure(enum.IntEnum):
    """What the tolerance of a system bounds."""

    ETA = lib.TRIBO_MEASURE_ETA
    INVARIANT = lib.TRIBO_MEASURE_INVARIANT


class Stop(enum.IntEnum):
    """Why a solve ended."""

    TOLERANCE = lib.TRIBO_STOP_TOLERANCE
    ITERATIONS = lib.TRIBO_STOP_ITERATIONS
    TIME = lib.TRIBO_STOP_TIME
    CANCEL = lib.TRIBO_STOP_CANCEL
    STALL = lib.TRIBO_STOP_STALL
    JAM = lib.TRIBO_STOP_JAM


class Isa(enum.IntEnum):
    """Instruction sets of batches; no bit depends on them."""

    BEST = lib.TRIBO_ISA_BEST
    SCALAR = lib.TRIBO_ISA_SCALAR
    BASELINE = lib.TRIBO_ISA_BASELINE
    X86_64_V3 = lib.TRIBO_ISA_X86_64_V3
    X86_64_V4 = lib.TRIBO_ISA_X86_64_V4


class Mix(enum.IntEnum):
    """How two coefficients become one."""

    GEOMETRIC_MEAN = lib.TRIBO_MIX_GEOMETRIC_MEAN
    MINIMUM = lib.TRIBO_MIX_MINIMUM
    MAXIMUM = lib.TRIBO_MIX_MAXIMUM
    PRODUCT = lib.TRIBO_MIX_PRODUCT
    ARITHMETIC_MEAN = lib.TRIBO_MIX_ARITHMETIC_MEAN


class Kind(enum.IntEnum):
    """What moves a body of a scene."""

    DYNAMIC = lib.TRIBO_BODY_DYNAMIC
    KINEMATIC = lib.TRIBO_BODY_KINEMATIC
    STATIC = lib.TRIBO_BODY_STATIC


class Event(enum.IntEnum):
    """What happened to a contact in a step."""

    BEGIN = lib.TRIBO_EVENT_BEGIN
    PERSIST = lib.TRIBO_EVENT_PERSIST
    END = lib.TRIBO_EVENT_END


class Skip(enum.IntFlag):
    """Stages of a step to leave out."""

    NOTHING = 0
    WARM_START = lib.TRIBO_SKIP_WARM_START
    CORRECTION = lib.TRIBO_SKIP_CORRECTION
    RESTITUTION = lib.TRIBO_SKIP_RESTITUTION
    SPECULATION = lib.TRIBO_SKIP_SPECULATION


class Method(enum.IntEnum):
    """How a pair of shapes is done."""

    AUTOMATIC = lib.TRIBO_METHOD_AUTOMATIC
    CLOSED = lib.TRIBO_METHOD_CLOSED
    GENERAL = lib.TRIBO_METHOD_GENERAL
