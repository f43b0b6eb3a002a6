"""A worker process: one JSON object a line in, one a line out, kept between requests, killed where it hangs."""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import re
import select
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from typing import Any

TAIL = 3  # lines of a dead worker's standard error that are worth telling
NAMED = re.compile(r"[\w.]+(Error|Exception)\b.*")  # the line of an error, which a launcher buries under its own
FRAME = re.compile(r"[-=*]+|\[[^\]]*:\d+\] .*(help message|help / error messages).*")  # a launcher's rules and advice


class WorkerDied(RuntimeError):
    """The worker ended before it answered; the text holds the last lines of its standard error."""


class WorkerHangs(RuntimeError):
    """The worker did not answer within its time limit; it has been killed."""


def last_words(text: str) -> str:
    """Return why a process ended: the errors that its standard error names, else its last lines that say something."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    named = list(dict.fromkeys(line for line in lines if NAMED.fullmatch(line)))  # two ranks say the same
    said = [line for line in lines if not FRAME.fullmatch(line)]
    return " | ".join((named or said)[-TAIL:]) or "no message"


class Worker:
    """A process, with whatever processes it starts, that answers requests until this one ends."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - it lives as long as the worker
        self._process = subprocess.Popen(
            list(command),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env=dict(environment),
            start_new_session=True,
        )

    def ask(self, request: Mapping[str, Any], limit: float | None = None) -> dict[str, Any]:
        """Send a request and wait for its answer, at most `limit` seconds.

        Raises
        ------
        WorkerDied
            The process ended without an answer.
        WorkerHangs
            There was no answer within the limit.
        """
        given, taken = self._process.stdin, self._process.stdout
        line = b""
        if given is not None and taken is not None:
            with contextlib.suppress(BrokenPipeError):
                given.write(json.dumps(request).encode() + b"\n")
                given.flush()
                if not select.select([taken], [], [], limit)[0]:
                    raise WorkerHangs(f"no answer within {limit:g} s")
                line = taken.readline()
        if not line:
            raise WorkerDied(f"the process ended with status {self._process.wait()}: {self._tail()}")
        return dict(json.loads(line))

    def _tail(self) -> str:
        self._errors.seek(0)
        return last_words(self._errors.read().decode(errors="replace"))

    def close(self) -> None:
        """End the process: its input ends, and so does it."""
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()
        try:
            self._process.wait(timeout=5)
        except subprocess.TimeoutExpired:
            self.kill()
        self._errors.close()

    def kill(self) -> None:
        """End the process and all that it started, at once."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()


_kept: dict[tuple[int, tuple[str, ...]], Worker] = {}


@atexit.register
def close_all() -> None:
    """End the workers of this process."""
    for key in [key for key in _kept if key[0] == os.getpid()]:
        _kept.pop(key).close()


def ask(
    command: Sequence[str], environment: Mapping[str, str], request: Mapping[str, Any], limit: float | None = None
) -> dict[str, Any]:
    """Ask the worker of a command, starting it where this process has none yet.

    Raises
    ------
    WorkerDied, WorkerHangs
        There is no answer; the next request starts another worker.
    """
    key = (os.getpid(), tuple(command))  # a forked process must not share its parent's pipes
    if key not in _kept:
        _kept[key] = Worker(command, environment)
    try:
        return _kept[key].ask(request, limit)
    except BaseException:
        worker = _kept.pop(key)  # dead, hanging, or interrupted with an answer on its way
        worker.kill()
        worker.close()
        raise


def serve(answer: Callable[[dict[str, Any]], Mapping[str, Any]]) -> None:
    """Answer requests from standard input until it ends; what else is printed goes to standard error."""
    requests, answers = os.fdopen(os.dup(0)), os.fdopen(os.dup(1), "w")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    for line in requests:
        answers.write(json.dumps(answer(json.loads(line))) + "\n")
        answers.flush()
