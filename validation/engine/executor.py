"""Pending cases on worker processes, in this process or on a cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager

from validation.engine.case import Case
from validation.engine.measure import execute, failed_row
from validation.engine.study import Study
from validation.runs.history import History
from validation.runs.row import Row
from validation.runs.text import error_text
from validation.runs.threads import limit_process
from validation.solvers.logs import solver_logs
from validation.solvers.processes.guard import DEATH_SIGNAL, control

PARENT_CHECK_INTERVAL = 0.25  # s


def executed(
    pending: dict[str, Case], study: Study, jobs: int, executor: Executor | None
) -> Iterator[tuple[Row, History | None]]:
    """Run the pending cases, in this process where one worker or one case is all there is.

    Parameters
    ----------
    pending
        The cases by key.
    study
        Whose name the rows get; a study of timings runs its cases one after the other in this process.
    jobs
        Worker processes; ignored where an executor is given.
    executor
        That of a cluster, or None.
    """
    if study.timed or (executor is None and min(jobs, len(pending)) <= 1):
        for key, case in pending.items():
            yield _checked(case, key, study.name)
        return
    lost = []
    with _pool(executor, min(jobs, len(pending))) as pool:
        futures = {pool.submit(_checked, case, key, study.name): key for key, case in pending.items()}
        for future in as_completed(futures):
            error = future.exception()
            key = futures[future]
            if isinstance(error, BrokenExecutor):
                lost.append(key)
            elif error is not None:  # on its way there or back: what a worker runs never raises
                yield failed_row(pending[key], key, study.name, error_text(error)), None
            else:
                yield future.result()
    for key in lost:
        yield _in_own_process(pending[key], key, study)


def _checked(case: Case, key: str, study: str) -> tuple[Row, History | None]:
    """Run a case on a worker, which may be another machine: a row under this key is made by what the key covers.

    What fails outside the solver, memory included, is a named outcome as well.
    """
    try:
        if case.key() != key:
            return failed_row(case, key, study, "the worker holds other sources, versions or files"), None
        return execute(case, key, study)
    except Exception as error:
        return failed_row(case, key, study, error_text(error)), None


def _in_own_process(case: Case, key: str, study: Study) -> tuple[Row, History | None]:
    """Run a case in a process of its own: one that kills its worker is a row like any other."""
    with _pool(None, 1) as pool:
        try:
            return pool.submit(_checked, case, key, study.name).result()
        except BrokenExecutor:
            note = "worker killed (out of memory or a signal)"
            return failed_row(case, key, study.name, note), None


@contextmanager
def _pool(executor: Executor | None, jobs: int) -> Iterator[Executor]:
    """Yield the given executor, or one of processes that goes down at once on an interruption."""
    if executor is not None:
        yield executor
        return
    pool = ProcessPoolExecutor(jobs, initializer=_initialize_worker, initargs=(os.getpid(), solver_logs()[0].level))
    wait = True
    try:
        yield pool
    except KeyboardInterrupt:
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
    control(DEATH_SIGNAL, signal.SIGKILL)  # at once, where the system can
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
