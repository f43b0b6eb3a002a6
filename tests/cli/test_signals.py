"""Signals, in this process: who ends it, with which status, what it says once, and what it leaves as it was."""

import os
import signal
import sys
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest

from validation.cli import signals

NAMED = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Ended(BaseException):
    """The end of the process, where it would be."""


@pytest.fixture
def told(monkeypatch):
    """Return what an end writes, and its status, which does not end this process."""
    found = []

    def leave(status):
        found.append(status)
        raise Ended

    monkeypatch.setattr(os, os._exit.__name__, leave)
    monkeypatch.setattr(os, "write", lambda stream, text: found.append((stream, text)))
    signals._received.clear()
    signals._pending_messages[:] = [signals.INTERRUPTED_MESSAGE]
    yield found
    signals._received.clear()


def test_an_end_says_once_that_it_was_one_and_has_the_status_of_the_first_signal(told):
    for first, status in (([], 130), ([signal.SIGTERM, signal.SIGHUP], 143)):
        signals._received[:] = first
        with pytest.raises(Ended):
            signals.end()
        assert told[-1] == status
    assert told[:-1] == [(2, b"interrupted\n"), 130]
    signals.promise_rows()  # which is too late
    assert signals._pending_messages == []


def test_rows_that_are_kept_are_promised_instead(told):
    signals.promise_rows()
    with pytest.raises(Ended):
        signals.end()
    assert told == [(2, signals.RESUMABLE_MESSAGE), 130]


def test_the_first_signal_interrupts_a_second_one_ends_and_a_fork_just_ends(told):
    handle = signals._handler(os.getpid())
    with pytest.raises(KeyboardInterrupt):
        handle(signal.SIGTERM, None)
    assert (signals._received, told) == ([signal.SIGTERM], [])
    with pytest.raises(Ended):
        handle(signal.SIGHUP, None)
    assert told == [(2, b"interrupted\n"), 143]
    with pytest.raises(Ended):
        signals._handler(-1)(signal.SIGHUP, None)
    assert told[2:] == [129]


def test_a_watcher_ends_the_process_by_a_signal_of_ours_alone(told, monkeypatch):
    waits = []
    monkeypatch.setattr(signals, "threading", SimpleNamespace(Event=lambda: SimpleNamespace(wait=waits.append)))
    for numbers, ends in (([signal.SIGUSR1], False), ([signal.SIGUSR1, signal.SIGTERM], True)):
        read_end, write_end = os.pipe()
        with os.fdopen(write_end, "wb") as stream:
            stream.write(bytes(numbers))
        try:
            signals._watch(read_end)
        except Ended:
            os.close(read_end)
        with pytest.raises(OSError, match="Bad file descriptor"):  # it is closed
            os.fstat(read_end)
        assert signals._received == [signal.SIGTERM] * ends
    assert told[-1] == 143 and waits == [signals.GRACE_PERIOD]


@pytest.mark.usefixtures("interruptible")
def test_handlers_are_there_as_long_as_they_are_asked_for_and_what_is_ignored_stays_so(told):
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    before = [signal.getsignal(number) for number in NAMED]
    hook = sys.unraisablehook
    signals._received.append(signal.SIGHUP)
    signals._pending_messages.clear()
    with signals.interruptible():
        during = [signal.getsignal(number) for number in NAMED]
        assert [mine is theirs for mine, theirs in zip(during, before, strict=True)] == [False, False, True]
        assert (len(signals._watchers), signals._received) == (1, [])
        assert signals._pending_messages == [signals.INTERRUPTED_MESSAGE]
        signals._received.append(signal.SIGTERM)
        with pytest.raises(Ended):
            sys.unraisablehook(None)
        signals._detach_fork()
        assert signal.set_wakeup_fd(-1) == -1
        signals._received.clear()
    assert [signal.getsignal(number) for number in NAMED] == before
    assert sys.unraisablehook is hook and signals._watchers == []
    with pytest.raises(Ended), signals.interruptible():
        signals._received.append(signal.SIGTERM)
        raise ValueError("what a library has made of it")
    with pytest.raises(ZeroDivisionError), signals.interruptible():
        raise ZeroDivisionError


def test_a_thread_beside_the_main_one_is_left_as_it_is():
    def watched():
        with signals.interruptible():
            return signal.getsignal(signal.SIGTERM)

    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(watched).result() is signal.getsignal(signal.SIGTERM)
