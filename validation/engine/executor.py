"""Pending cases on worker processes, in this process or on a cluster."""

from __future__ import annotations

import contextlib
import ctypes
import multiprocessing
import os
import signal
import threading
from collections.abc import Collection, Generator, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor, as_completed
from contextlib import closing, contextmanager
from dataclasses import dataclass

from validation.engine.case import Case
from validation.engine.measure import execute, failed_row
from validation.runs.history import History
from validation.runs.row import Row
from validation.runs.text import error_text
from validation.runs.threads import limit_process
from validation.solvers import memory
from validation.solvers.logs import solver_logs

PARENT_CHECK_INTERVAL = 0.25  # s
DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of Linux
Ending = tuple[Row, History | None]


@dataclass(frozen=True)
class Pending:
    """A case that is to be run, the key that its row is kept under, and the study whose name the row gets."""

    case: Case
    key: str
    study: str

    def run(self) -> Ending:
        """Run the case on a worker, which may be another machine: a row under this key is made by what the key covers.

        What fails outside the solver, memory included, is a named outcome as well.
        """
        try:
            if self.case.key() != self.key:
                return self.failed("the worker holds other sources, versions or files")
            return execute(self.case, self.key, self.study)
        except Exception as error:
            return self.failed(error_text(error))

    def failed(self, note: str) -> Ending:
        """Return the row of this case where it ended by an error."""
        return failed_row(self.case, self.key, self.study, note), None

    def memory(self) -> float:
        """Return the bytes that the case will take, as far as they are known."""
        try:
            return memory.needed(self.case.scene, self.case.make_solver())[0]
        except Exception:  # anybody's solver: its failure is a row of its own
            return 0.0


def executed(
    pending: Sequence[Pending], jobs: int = 1, executor: Executor | None = None
) -> Generator[Ending, None, None]:
    """Run cases in their order and yield their rows as they end: in this process where one worker or case is all.

    A worker that is killed takes the pool with it. The cases that were on its workers then run once more, each in a
    process of its own, so that the one that kills its worker is a row like any other; the remainder gets a new pool.
    Cases that take more than a worker's share of the memory follow the others, one after the other. `jobs` counts
    worker processes where there is no `executor`, that of a cluster.
    """
    jobs = min(jobs, len(pending))
    if executor is not None:
        yield from _on_cluster(pending, executor)
        return
    if jobs <= 1:
        for task in pending:
            yield task.run()
        return
    share = memory.available() / jobs
    large = {task.key for task in pending if task.memory() > share}
    remaining = {task.key: task for task in pending if task.key not in large}
    while remaining:
        with closing(run_on_processes(remaining.values(), jobs)) as endings:
            for row, history in endings:
                del remaining[row.key]
                yield row, history
        # those that were on the workers of a lost pool are the first that remain
        for key in list(remaining)[:jobs]:
            yield run_in_own_process(remaining.pop(key))
    for task in pending:
        if task.key in large:
            yield run_in_own_process(task)


def _on_cluster(pending: Sequence[Pending], executor: Executor) -> Generator[Ending, None, None]:
    """Run cases on an executor, which itself sees to workers that are lost."""
    futures = {executor.submit(task.run): task for task in pending}
    for future in as_completed(futures):
        error = future.exception()
        if error is None:
            yield future.result()
        elif isinstance(error, BrokenExecutor):
            yield run_in_own_process(futures[future])
        else:  # on its way there or back: what a worker runs never raises
            yield futures[future].failed(error_text(error))


def run_on_processes(pending: Collection[Pending], jobs: int) -> Generator[Ending, None, None]:
    """Run cases on worker processes; those that a lost worker has taken with it are left out."""
    with _pool(min(jobs, len(pending))) as pool:
        futures = {pool.submit(task.run): task for task in pending}
        for future in as_completed(futures):
            error = future.exception()
            if error is None:
                yield future.result()
            elif not isinstance(error, BrokenExecutor):
                yield futures[future].failed(error_text(error))


def run_in_own_process(task: Pending) -> Ending:
    """Run a case in a process of its own, so that one that kills its worker is a row like any other."""
    with _pool(1) as pool:
        try:
            return pool.submit(task.run).result()
        except BrokenExecutor:
            return task.failed("worker killed (out of memory or a signal)")


@contextmanager
def _pool(jobs: int) -> Iterator[Executor]:
    """Yield a pool of processes that goes down at once on an interruption."""
    arguments = (os.getpid(), solver_logs()[0].level)
    pool = ProcessPoolExecutor(jobs, initializer=_initialize_worker, initargs=arguments)
    wait = True
    try:
        yield pool
    except (KeyboardInterrupt, GeneratorExit):
        # A worker that ends while it hands over a result leaves the pool's thread waiting for the rest of it.
        wait = False
        for process in (pool._processes or {}).values():
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=wait, cancel_futures=True)


def _initialize_worker(parent: int, log_level: int) -> None:
    """Bind a worker's life to its parent's, leave Ctrl-C to the parent, which ends the workers; one BLAS thread."""
    limit_process()
    for log in solver_logs():
        log.setLevel(log_level)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    with contextlib.suppress(OSError, AttributeError, TypeError):  # at once, where the system can
        ctypes.CDLL(None).prctl(DEATH_SIGNAL, signal.SIGKILL)
    threading.Thread(target=_end_with_parent, args=(parent,), daemon=True).start()


def _end_with_parent(parent: int) -> None:
    """End this process when its parent has ended, or the server that started it in the parent's name."""
    starter = os.getppid()  # the parent, or the server of processes that forked this one
    process = multiprocessing.parent_process()
    if starter != parent and multiprocessing.get_start_method() != "forkserver":  # it ended before this thread began
        os._exit(1)
    pause = threading.Event()
    while os.getppid() == starter and (process is None or process.is_alive()):
        pause.wait(PARENT_CHECK_INTERVAL)
    os._exit(1)
