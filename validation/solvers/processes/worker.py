"""A worker process: one JSON object a line in, one a line out, kept between requests, killed where it hangs."""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import re
import select
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

GUARD = Path(__file__).with_name("guard.py")
LONGEST_ANSWER = 2**30  # bytes of an answer: ten million steps of four columns
PIECE_SIZE = 2**16  # bytes read at a time, and kept of standard error
TAIL_PIECES = 64  # of what a dead worker left in its standard error
EXIT_TIMEOUT = 0.5  # s for a process that has closed its output
GUARD_TIMEOUT = 3.0  # s for a guard to end what it guards
TAIL_LINES = 3  # lines of a dead worker's standard error that are worth telling
ERROR_LINE = re.compile(r"[\w.]+(Error|Exception)\b.*")  # the line of an error, which a launcher buries under its own
LAUNCHER_LINE = re.compile(
    r"[-=*]+|\[[^\]]*:\d+\] .*(help message|help / error messages).*"
)  # a launcher's rules and advice


class WorkerDied(RuntimeError):
    """The worker ended before it answered; the text holds the last lines of its standard error."""


class WorkerHangs(RuntimeError):
    """The worker did not answer within its time limit; it has been killed."""


def stderr_tail(text: str) -> str:
    """Return why a process ended: the errors that its standard error names, else its last lines that say something."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    error_lines = list(dict.fromkeys(line for line in lines if ERROR_LINE.fullmatch(line)))  # two ranks say the same
    other_lines = [line for line in lines if not LAUNCHER_LINE.fullmatch(line)]
    return " | ".join((error_lines or other_lines)[-TAIL_LINES:]) or "no message"


class Lines:
    """What has come through a pipe so far, to be taken line by line."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._searched = 0

    def add(self, piece: bytes) -> None:
        """Take a piece.

        Raises
        ------
        WorkerDied
            The line is longer than any answer.
        """
        self._buffer += piece
        if len(self._buffer) > LONGEST_ANSWER:
            raise WorkerDied(f"its answer is longer than {LONGEST_ANSWER} bytes")

    def next(self) -> bytes | None:
        """Return the first line, or None where it is not whole yet."""
        end = self._buffer.find(b"\n", self._searched)
        if end < 0:
            self._searched = len(self._buffer)
            return None
        line = bytes(self._buffer[:end])
        del self._buffer[: end + 1]
        self._searched = 0
        return line


class Worker:
    """A process, with whatever processes it starts, that answers requests until this one ends.

    Between the two stands a guard, which ends the worker and its descendants with this process, however it ends.
    """

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        watched, lifeline = os.pipe()
        self._process = subprocess.Popen(
            [sys.executable, "-I", "-S", str(GUARD), str(watched), *command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=dict(environment),
            pass_fds=(watched,),
            start_new_session=True,
            bufsize=0,
        )
        os.close(watched)
        self._lifeline = os.fdopen(lifeline, "wb", buffering=0)
        self._lines = Lines()
        self._stderr = b""
        self._request_number = 0
        for stream in self._streams():
            os.set_blocking(stream.fileno(), False)

    def _streams(self) -> tuple[IO[bytes], IO[bytes], IO[bytes]]:
        stdin = self._process.stdin
        stdout = self._process.stdout
        stderr = self._process.stderr
        if stdin is None or stdout is None or stderr is None:
            raise ValueError("worker: must have three pipes, got fewer")
        return stdin, stdout, stderr

    def ask(self, request: Mapping[str, Any], limit: float | None = None) -> dict[str, Any]:
        """Send a request and wait for its answer, at most `limit` seconds.

        What carries the number of another request is not taken: a process that has forked answers twice.

        Raises
        ------
        WorkerDied
            The process ended without an answer, or said what is none.
        WorkerHangs
            There was no whole answer within the limit.
        """
        self._request_number += 1
        deadline = None if limit is None else time.monotonic() + limit
        unsent = json.dumps({**request, "id": self._request_number}).encode() + b"\n"
        while (answer := self._answer()) is None:
            unsent = self._exchange(unsent, deadline)
            if deadline is not None and time.monotonic() > deadline:
                raise WorkerHangs(f"no answer within {limit:g} s")
        return answer

    def _exchange(self, unsent: bytes, deadline: float | None) -> bytes:
        """Wait until something moves; return what is left to be sent."""
        stdin, stdout, stderr = self._streams()
        remaining = None if deadline is None else max(0.0, deadline - time.monotonic())
        readable = [stdout] if stderr.closed else [stdout, stderr]
        writable = [stdin] if unsent else []
        ready, free, _ = select.select(readable, writable, [], remaining)
        if free:
            with contextlib.suppress(BlockingIOError):
                unsent = self._send(unsent)
        if stderr in ready:
            self._read_stderr()
        if stdout in ready and (piece := _read(stdout)) is not None:
            if not piece:
                raise WorkerDied(f"the process ended with status {self._status()}: {self._tail()}")
            self._lines.add(piece)
        return unsent

    def _send(self, data: bytes) -> bytes:
        """Send what the pipe takes and return the rest, nothing where nobody reads any more."""
        try:
            return data[os.write(self._streams()[0].fileno(), data) :]
        except BrokenPipeError:
            return b""

    def _read_stderr(self) -> None:
        """Keep the end of what the worker writes to its standard error, so that it neither waits nor fills a disk."""
        stream = self._streams()[2]
        if (piece := _read(stream)) is not None:
            self._stderr = (self._stderr + piece)[-PIECE_SIZE:]
            if not piece:
                stream.close()

    def _tail(self) -> str:
        stream = self._streams()[2]
        for _ in range(TAIL_PIECES):
            if stream.closed or not select.select([stream], [], [], 0)[0]:
                break
            self._read_stderr()
        return stderr_tail(self._stderr.decode(errors="replace"))

    def _answer(self) -> dict[str, Any] | None:
        """Return the answer to the latest request where all of it is here."""
        while (line := self._lines.next()) is not None:
            try:
                answer = dict(json.loads(line))
            except (ValueError, TypeError, RecursionError):
                raise WorkerDied(f"no answer but {line[:60].decode(errors='replace')!r}: {self._tail()}") from None
            if answer.pop("id", None) == self._request_number:
                return answer
        return None

    def _status(self) -> int:
        """Return the status of a process that has ended, or has closed its output and is ended for it."""
        try:
            return self._process.wait(timeout=EXIT_TIMEOUT)
        except subprocess.TimeoutExpired:
            return self.kill()

    def close(self) -> None:
        """End the process: its input ends, and so does it, or is ended by its guard."""
        for stream in (*self._streams(), self._lifeline):
            with contextlib.suppress(OSError):
                stream.close()
        self._wait()

    def kill(self) -> int:
        """End the process and all that it started, at once; return its status."""
        with contextlib.suppress(OSError, ValueError):
            self._lifeline.write(b"!")
        return self._wait()

    def _wait(self) -> int:
        try:
            return self._process.wait(timeout=GUARD_TIMEOUT)
        except subprocess.TimeoutExpired:  # somebody has stopped the guard; the worker is killed with it
            self._process.kill()
            return self._process.wait()


def _read(stream: IO[bytes]) -> bytes | None:
    """Return what a pipe holds, nothing at its end, None where there is nothing yet."""
    try:
        return os.read(stream.fileno(), PIECE_SIZE)
    except BlockingIOError:
        return None


workers: dict[tuple[int, tuple[str, ...]], Worker] = {}  # the workers, by process and command


@atexit.register
def close_all() -> None:
    """End the workers of this process."""
    for key in [key for key in workers if key[0] == os.getpid()]:
        workers.pop(key).close()


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
    if key not in workers:
        workers[key] = Worker(command, environment)
    try:
        return workers[key].ask(request, limit)
    except BaseException:
        worker = workers.pop(key)  # dead, hanging, or interrupted with an answer on its way
        worker.kill()
        worker.close()
        raise


def serve(answer: Callable[[dict[str, Any]], Mapping[str, Any]]) -> None:
    """Answer requests from standard input until it ends; what else is printed goes to standard error.

    Every answer carries its request's number. A copy of this process that `answer` has forked answers nothing.
    """
    requests = os.fdopen(os.dup(0))
    answers = os.fdopen(os.dup(1), "w")
    process = os.getpid()
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    for line in requests:
        request = json.loads(line)
        reply = json.dumps({**answer(request), "id": request["id"]})
        if os.getpid() != process:
            os._exit(0)
        answers.write(reply + "\n")
        answers.flush()
