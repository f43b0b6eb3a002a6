"""A Dask cluster's workers in place of this machine's cores; the only import of the optional `distributed`."""

from __future__ import annotations

import functools
import importlib
import math
import os
import sys
import sysconfig
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import Executor
from contextlib import contextmanager
from importlib.machinery import PathFinder
from pathlib import Path
from typing import Any

from validation.errors import InputError
from validation.solvers.registry import get_solver
from validation.solvers.user import UserSolver

PATIENCE = "10s"  # for the scheduler to answer
USER_SOURCES = "dda-validate-sources"  # of a worker's own directory: where users' solvers are imported from

INSTALLED = {"site-packages", "dist-packages"}  # folders of what workers have too, or are to have


@contextmanager
def executor(address: str | None, solvers: Iterable[str] = ()) -> Iterator[Executor | None]:
    """Yield the executor of the cluster whose scheduler is at ``tcp://host:8786``; None for the machine's own cores.

    A case whose worker is lost runs again on another one; the finished ones are in the results directory already. Of
    `solvers`, those of the cases, the sources that a user brings from a folder which is no installation's are sent to
    the workers, those that join later too.

    Raises
    ------
    InputError
        The package `distributed` is not installed, or nobody answers at the address.
    """
    if address is None:
        yield None
        return
    try:
        distributed = importlib.import_module("distributed")
    except ImportError:
        raise InputError(
            "needs the package distributed", field="--scheduler", advice="pip install 'dda-validation[cluster]'"
        ) from None
    try:
        client = distributed.Client(address, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(
            "must be the address of a running Dask scheduler", field="--scheduler", value=f"{address!r}: {error}"
        ) from None

    with client:
        if files := user_sources(solvers):
            client.register_worker_callbacks(setup=functools.partial(place_sources, files))
        yield client.get_executor(pure=False)


def place_sources(files: Mapping[str, bytes], dask_worker: Any) -> None:
    """Write users' sources into a worker's own directory, and have its processes look for modules there."""
    root = Path(dask_worker.local_directory) / USER_SOURCES
    for name, content in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    if str(root) not in sys.path:
        sys.path.insert(0, str(root))


def user_sources(solvers: Iterable[str]) -> dict[str, bytes]:
    """Return the files of users' solvers that no installation holds, by their paths below a folder of modules."""
    standard = sysconfig.get_path("stdlib")
    files: dict[str, bytes] = {}
    for solver in solvers:
        adapter = get_solver(solver)
        if not isinstance(adapter, UserSolver):
            continue
        module = adapter.target.partition(":")[0].partition(".")[0]
        spec = PathFinder.find_spec(module, [os.getcwd(), *sys.path])
        if spec is None or spec.origin is None:  # its first case says that it cannot be imported
            continue
        origin = Path(spec.origin)
        if INSTALLED & {*origin.parts} or origin.is_relative_to(standard):
            continue
        root = origin.parent.parent if origin.name == "__init__.py" else origin.parent
        sources = sorted(origin.parent.rglob("*.py")) if root != origin.parent else [origin]
        files |= {str(path.relative_to(root)): path.read_bytes() for path in sources}
    return files


def worker_memory() -> float:
    """Return the bytes that a case may take on the Dask worker that runs it, a worker's limit over its threads.

    Infinite in any other process.
    """
    if "distributed" not in sys.modules:
        return math.inf
    distributed = sys.modules["distributed"]
    try:
        worker = distributed.get_worker()
    except ValueError:
        return math.inf
    limit = worker.memory_manager.memory_limit
    return float(limit) / worker.state.nthreads if limit else math.inf
