"""Parameter sweeps: a function of parameters over many sets of them, on local cores or a cluster."""

from __future__ import annotations

import hashlib
import itertools
import os
import pickle
import traceback
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Callable, Iterable, Iterator, Mapping, Sequence

Parameters = Mapping[str, Any]


@dataclass(frozen=True)
class Result:
    """What one task gave: its parameters and either a value or the text of an error."""

    parameters: dict[str, Any]
    value: Any = None
    error: str | None = None

    @property
    def ok(self) -> bool:
        return self.error is None


def grid(**axes: Iterable[Any]) -> list[dict[str, Any]]:
    """All combinations of values: grid(mu=[.1, .2], e=[0, 1]) has four; the last axis varies
    fastest."""
    names = list(axes)
    return [dict(zip(names, values)) for values in itertools.product(*axes.values())]


def _call(function: Callable[..., Any], parameters: dict[str, Any]) -> Result:
    """Run one task; its failure is its result, and no other task's matter."""
    try:
        return Result(parameters, function(**parameters))
    except Exception:
        return Result(parameters, error=traceback.format_exc())


def _key(function: Callable[..., Any], parameters: dict[str, Any]) -> str:
    name = f"{function.__module__}.{function.__qualname__}"
    return hashlib.sha256(pickle.dumps((name, sorted(parameters.items())), 4)).hexdigest()


class _Journal:
    """Results that are already there, and a file to add others to.

    A record is its length (8 bytes), the SHA-256 of what follows, and that: key and result,
    pickled. What a crash cut off, or anything else after the last whole record, is dropped."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.done: dict[str, Result] = {}
        if path.exists():
            data = path.read_bytes()
            whole = 0
            while (record := self._record(data, whole)) is not None:
                key, result = pickle.loads(record)
                self.done[key] = result
                whole += 40 + len(record)
            os.truncate(path, whole)

    @staticmethod
    def _record(data: bytes, start: int) -> bytes | None:
        size = int.from_bytes(data[start : start + 8], "little")
        record = data[start + 40 : start + 40 + size]
        digest = data[start + 8 : start + 40]
        is_whole = size > 0 and len(record) == size
        return record if is_whole and hashlib.sha256(record).digest() == digest else None

    def add(self, key: str, result: Result) -> None:
        record = pickle.dumps((key, result), 4)
        with self.path.open("ab") as file:
            file.write(len(record).to_bytes(8, "little") + hashlib.sha256(record).digest() + record)
            file.flush()
            os.fsync(file.fileno())


def _local(function: Callable[..., Any], tasks: Sequence[dict[str, Any]],
           workers: int | None) -> Iterator[tuple[int, Result]]:
    if workers == 0 or not tasks:
        yield from ((i, _call(function, task)) for i, task in enumerate(tasks))
        return
    # spawn: a fork would copy threads and locks in whatever state they are in.
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        futures: dict[Future[Result], int] = {
            pool.submit(_call, function, task): i for i, task in enumerate(tasks)
        }
        for future in as_completed(futures):
            index = futures[future]
            failure = future.exception()
            yield index, (future.result() if failure is None
                          else Result(dict(tasks[index]), error=repr(failure)))


def _cluster(function: Callable[..., Any], tasks: Sequence[dict[str, Any]],
             client: Any) -> Iterator[tuple[int, Result]]:
    import distributed

    completed: Any = distributed.as_completed

    futures = client.map(_call, [function] * len(tasks), tasks, pure=False)
    index = {future.key: i for i, future in enumerate(futures)}
    for future in completed(futures):
        i = index[future.key]
        failure = future.exception()
        yield i, (future.result() if failure is None else Result(dict(tasks[i]), error=repr(failure)))


def sweep(function: Callable[..., Any], parameters: Iterable[Parameters], *, client: Any = None,
          workers: int | None = None, resume: str | os.PathLike[str] | None = None,
          progress: bool = False) -> list[Result]:
    """Call function(**p) for each p of `parameters`; results in their order.

    By default on all local cores, in processes (workers: how many; 0: in this one); with a Dask
    client on its cluster. The results are the same in each case. A task that raises has the text
    of its error as result, and all others are still done. resume: a file that keeps what is done;
    the same call later goes on from there and tries failed tasks again. progress: a bar of tqdm.
    The function must be importable by the workers (not a lambda)."""
    from tqdm.auto import tqdm

    tasks = [dict(p) for p in parameters]
    journal = _Journal(Path(resume)) if resume is not None else None
    results: list[Result | None] = [None] * len(tasks)
    keys = [_key(function, task) for task in tasks] if journal is not None else []
    if journal is not None:
        results = [journal.done.get(key) for key in keys]
        results = [r if r is not None and r.ok else None for r in results]
    todo = [i for i, result in enumerate(results) if result is None]
    left = [tasks[i] for i in todo]
    ran = _local(function, left, workers) if client is None else _cluster(function, left, client)
    with tqdm(total=len(tasks), initial=len(tasks) - len(todo), disable=not progress) as bar:
        for k, result in ran:
            results[todo[k]] = result
            if journal is not None:
                journal.add(keys[todo[k]], result)
            bar.update()
    return [result for result in results if result is not None]
