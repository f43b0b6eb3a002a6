"""A worker process: one JSON object a line in, one a line out, kept between requests, killed where it hangs."""

from __future__ import annotations

import atexit
import contextlib
import io
import json
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from typing import IO, Any

GRACE = 0.7  # s for exit hooks of a worker whose starter has ended
LONGEST_ANSWER = 2**30  # bytes of an answer: ten million steps of four columns
WAITING_LINES = 16  # of what a worker writes and nobody has asked for
PIECE_SIZE = 2**16  # bytes that are kept of standard error
EXIT_TIMEOUT = 0.5  # s for a process that has closed its output
TAIL_LINES = 3  # lines of a dead worker's standard error that are worth telling
ERROR_LINE = re.compile(r"[\w.]+(Error|Exception)\b.*")  # which a launcher buries under its own
LAUNCHER_LINE = re.compile(
    r"[-=*]+|\[[^\]]*:\d+\] .*(help message|help / error messages).*"
)  # a launcher's rules and advice


class WorkerDied(RuntimeError):
    """The worker ended before it answered; the text has the last lines of its standard error."""


class WorkerHangs(RuntimeError):
    """The worker did not answer within its time limit; it has been killed."""


def stderr_tail(text: str) -> str:
    """Return why a process ended: the errors in its standard error, else its last lines that say something."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    error_lines = list(dict.fromkeys(line for line in lines if ERROR_LINE.fullmatch(line)))  # two ranks say the same
    other_lines = [line for line in lines if not LAUNCHER_LINE.fullmatch(line)]
    return " | ".join((error_lines or other_lines)[-TAIL_LINES:]) or "no message"


class Worker:
    """A process in a session of its own that answers requests until this one ends, however it ends.

    Its standard input closes with this process, which `serve` takes for the end. Threads read what it writes, so that
    neither side waits for the other.
    """

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        pipe = subprocess.PIPE
        try:
            self._process: Any = subprocess.Popen(
                command, 0, stdin=pipe, stdout=pipe, stderr=pipe, env=dict(environment), start_new_session=True
            )
        except OSError as error:
            raise WorkerDied(f"cannot be started: {command[0]}: {error.strerror}") from None
        self._lines: queue.Queue[bytes] = queue.Queue(WAITING_LINES)
        self._stderr = b""
        self._request_number = 0
        _in_thread(self._read_answers, io.BufferedReader(self._process.stdout))
        self._stderr_reader = _in_thread(self._read_stderr, self._process.stderr)

    def _read_answers(self, stream: IO[bytes]) -> None:
        with stream:
            while line := stream.readline(LONGEST_ANSWER):
                self._lines.put(line)
        self._lines.put(b"")

    def _read_stderr(self, stream: IO[bytes]) -> None:
        """Keep the end of what the worker writes to its standard error."""
        with stream:
            while piece := stream.read(PIECE_SIZE):
                self._stderr = (self._stderr + piece)[-PIECE_SIZE:]

    def ask(self, request: Mapping[str, Any], limit: float | None = None) -> dict[str, Any]:
        """Send a request and wait for its answer, at most `limit` seconds.

        An answer to another request is not taken: a process that has forked answers twice.

        Raises
        ------
        WorkerDied
            The process ended without an answer, or said what is none.
        WorkerHangs
            There was no whole answer within the limit.
        """
        self._request_number += 1
        deadline = None if limit is None else time.monotonic() + limit
        _in_thread(self._send, json.dumps({**request, "id": self._request_number}).encode() + b"\n")
        while True:
            try:
                line = self._lines.get(timeout=None if deadline is None else max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                raise WorkerHangs(f"no answer within {limit:g} s") from None
            if not line:
                raise WorkerDied(f"the process ended with status {self._status()}: {self._tail()}")
            try:
                answer = dict(json.loads(line))
            except (ValueError, TypeError, RecursionError):
                beginning = line[:60].decode(errors="replace").rstrip()
                raise WorkerDied(f"no answer but {beginning!r}: {self._tail()}") from None
            if answer.pop("id", None) == self._request_number:
                return answer

    def _send(self, data: bytes) -> None:
        """Send a request, in a thread: a worker that hangs may not read what a pipe cannot hold."""
        with contextlib.suppress(OSError, ValueError):  # nobody reads any more
            while data:
                data = data[self._process.stdin.write(data) :]

    def _tail(self) -> str:
        self._stderr_reader.join(EXIT_TIMEOUT)
        return stderr_tail(self._stderr.decode(errors="replace"))

    def _status(self) -> int:
        """Return the status, as a shell tells it, of a process that has closed its output and is ended for it."""
        try:
            status: int = self._process.wait(timeout=EXIT_TIMEOUT)
        except subprocess.TimeoutExpired:
            status = self.kill()
        return status if status >= 0 else 128 - status

    def close(self) -> None:
        """End the process, whose exit hooks have `GRACE` seconds."""
        self._process.stdin.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=GRACE)
        self.kill()

    def kill(self) -> int:
        """End the process and what it has started in its group, at once; return its status."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.stdin.close()
        status: int = self._process.wait()
        return status


def _in_thread(function: Callable[..., None], *arguments: Any) -> threading.Thread:
    thread = threading.Thread(target=function, args=arguments, daemon=True)
    thread.start()
    return thread


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
        workers.pop(key).kill()  # dead, hanging, or interrupted with an answer on its way
        raise


# ---- on the other side ----


def serve(answer: Callable[[dict[str, Any]], Mapping[str, Any]]) -> None:
    """Answer requests from standard input until it ends; what else is printed goes to standard error.

    Every answer carries its request's number; a copy that `answer` has forked answers nothing. The group of this
    process ends with it: after its exit hooks, or `GRACE` seconds after the end of its input.
    """
    requests: queue.SimpleQueue[str] = queue.SimpleQueue()
    _in_thread(_take_requests, os.fdopen(os.dup(0)), requests)
    atexit.register(os.killpg, 0, signal.SIGKILL)  # the first one is called last
    answers = os.fdopen(os.dup(1), "w")
    process = os.getpid()
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    while line := requests.get():
        request = json.loads(line)
        reply = json.dumps({**answer(request), "id": request["id"]})
        if os.getpid() != process:
            os._exit(0)
        answers.write(reply + "\n")
        answers.flush()


def _take_requests(stream: IO[str], requests: queue.SimpleQueue[str]) -> None:
    for line in stream:
        requests.put(line)
    requests.put("")
    time.sleep(GRACE)
    os.killpg(0, signal.SIGKILL)
