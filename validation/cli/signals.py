"""Ctrl-C, SIGTERM and SIGHUP: an orderly end where there is one, an end in any case."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import NoReturn

from validation.cli.app import INTERRUPTED

HANDLED_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
GRACE_PERIOD = 1.0  # s for the orderly end, which a library's long call or a swallowed interruption may put off
INTERRUPTED_MESSAGE = b"interrupted\n"
RESUMABLE_MESSAGE = b"interrupted: finished rows are kept; run the same command again to continue\n"
_received: list[int] = []
_pending_messages = [INTERRUPTED_MESSAGE]
_message_lock = threading.RLock()
_watchers: list[threading.Thread] = []


def end() -> NoReturn:
    """End an interrupted command, which says once that it was, whichever of its threads comes first.

    Past the stream, which another thread may be holding, and past the pool's own exit, which may wait for a worker
    that is gone.
    """
    with _message_lock, suppress(OSError):
        while _pending_messages:
            os.write(2, _pending_messages.pop())
    status = 128 + _received[0] if _received else INTERRUPTED
    os._exit(status)


def promise_rows() -> None:
    """Have an interruption say from now on that finished rows are kept: the command keeps each as soon as it ends."""
    if _pending_messages:
        _pending_messages[:] = [RESUMABLE_MESSAGE]


@contextmanager
def interruptible() -> Iterator[None]:
    """Turn the first signal into a KeyboardInterrupt; a second one, or `GRACE_PERIOD` seconds, ends the process.

    What a signal's owner has chosen to ignore (nohup) stays ignored. Threads other than the main one, which Python
    lets set no handlers, are left as they are.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _received.clear()
    _pending_messages[:] = [INTERRUPTED_MESSAGE]
    before = {number: signal.getsignal(number) for number in HANDLED_SIGNALS}
    hook = sys.unraisablehook
    with _signal_watcher():
        for number, handler in before.items():
            if handler is not signal.SIG_IGN:
                signal.signal(number, _handler(os.getpid()))
        # A hook that ends the process where an interruption came in a place that raises nothing.

        def handle(raised: sys.UnraisableHookArgs) -> None:
            if _received:
                end()
            hook(raised)

        sys.unraisablehook = handle
        try:
            yield
        except BaseException:
            if _received:  # whatever a library has made of the interruption
                end()
            raise
        finally:
            sys.unraisablehook = hook
            for number, handler in before.items():
                signal.signal(number, handler)


@contextmanager
def _signal_watcher() -> Iterator[None]:
    """Have a thread that hears of signals even while the main thread is in a library's long call."""
    read_end, write_end = os.pipe()
    os.set_blocking(write_end, False)
    previous = signal.set_wakeup_fd(write_end, warn_on_full_buffer=False)
    watcher = threading.Thread(target=_watch, args=(read_end,), daemon=True)
    watcher.start()
    _watchers.append(watcher)
    try:
        yield
    finally:
        _watchers.remove(watcher)
        signal.set_wakeup_fd(previous)
        os.close(write_end)
        watcher.join()


def _watch(read_end: int) -> None:
    """End the process a while after a signal, wherever its main thread is."""
    while numbers := os.read(read_end, 1):
        if numbers[0] in HANDLED_SIGNALS:
            threading.Event().wait(GRACE_PERIOD)
            _received.append(numbers[0])
            end()
    os.close(read_end)


def _handler(owner: int) -> Callable[[int, FrameType | None], None]:
    """Return the handler of a process; its forks, which inherit it, just end."""

    def handle(number: int, frame: FrameType | None) -> None:
        if os.getpid() != owner:
            os._exit(128 + number)
        if _received:
            end()
        _received.append(number)
        raise KeyboardInterrupt

    return handle


def _detach_fork() -> None:
    """Keep a fork's signals from its parent's watcher."""
    if _watchers and threading.current_thread() is threading.main_thread():
        signal.set_wakeup_fd(-1)


os.register_at_fork(after_in_child=_detach_fork)
