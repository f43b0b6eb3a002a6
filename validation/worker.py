"""A worker process: one JSON object a line in, one a line out, kept between requests."""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any

TAIL = 3  # lines of a dead worker's standard error that are worth telling


class WorkerDied(RuntimeError):
    """The worker ended before it answered; the text holds the last lines of its standard error."""


class Worker:
    """A process that answers requests until this one ends."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - it lives as long as the worker
        self._process = subprocess.Popen(
            list(command), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, env=dict(environment)
        )

    def ask(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Send a request and wait for its answer.

        Raises
        ------
        WorkerDied
            The process ended without an answer.
        """
        given, taken = self._process.stdin, self._process.stdout
        line = b""
        if given is not None and taken is not None:
            with contextlib.suppress(BrokenPipeError):
                given.write(json.dumps(request).encode() + b"\n")
                given.flush()
                line = taken.readline()
        if not line:
            raise WorkerDied(f"the worker ended with status {self._process.wait()}: {self._tail()}")
        return dict(json.loads(line))

    def _tail(self) -> str:
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").split("\n")
        return " | ".join([line.strip() for line in lines if line.strip()][-TAIL:]) or "no message"

    def close(self) -> None:
        """End the process: its input ends, and so does it."""
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()
        try:
            self._process.wait(timeout=5)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._errors.close()


_kept: dict[tuple[int, tuple[str, ...]], Worker] = {}


@atexit.register
def close_all() -> None:
    """End the workers of this process."""
    for key in [key for key in _kept if key[0] == os.getpid()]:
        _kept.pop(key).close()


def ask(command: Sequence[str], environment: Mapping[str, str], request: Mapping[str, Any]) -> dict[str, Any]:
    """Ask the worker of a command, starting it where this process has none yet.

    Raises
    ------
    WorkerDied
        The worker ended without an answer; the next request starts another.
    """
    key = (os.getpid(), tuple(command))  # a forked process must not share its parent's pipes
    if key not in _kept:
        _kept[key] = Worker(command, environment)
    try:
        return _kept[key].ask(request)
    except BaseException:
        _kept.pop(key).close()  # dead, or interrupted with an answer on its way
        raise
