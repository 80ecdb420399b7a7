"""Objects that own something of C: closed once, used by one thread at a time."""

from __future__ import annotations

import threading
from concurrent.futures import Executor
from contextlib import contextmanager
from types import TracebackType
from typing import Any, Callable, Iterator, TypeVar

from ._native import ffi

Self = TypeVar("Self", bound="Owner")


class Owner:
    """Base of System and Scene."""

    def __init__(self, handle: Any, destroy: Callable[[Any], None]) -> None:
        self._handle = ffi.gc(handle, destroy)
        self._lock = threading.Lock()

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """The handle for this thread alone; C would not notice a second one."""
        if not self._lock.acquire(blocking=False):
            raise RuntimeError(f"this {type(self).__name__} is in use, by another thread or from "
                               "within one of its own calls")
        try:
            if self._handle is None:
                raise ValueError(f"this {type(self).__name__} is closed")
            yield
        finally:
            self._lock.release()

    def close(self) -> None:
        """Free what it owns; any later call raises ValueError. Closing twice is nothing."""
        if not self._lock.acquire(blocking=False):
            raise RuntimeError(f"this {type(self).__name__} is in use")
        try:
            if self._handle is not None:
                ffi.release(self._handle)
                self._handle = None
        finally:
            self._lock.release()

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None,
                 traceback: TracebackType | None) -> None:
        self.close()


def parallel(executor: Executor) -> Any:
    """C's callback that runs tasks on an executor of threads; C works without the GIL."""

    def run(_user: Any, task: Any, data: Any, count: int) -> None:
        for _ in executor.map(lambda i: task(data, i), range(count)):
            pass

    return ffi.callback("tribo_parallel_function", run)
