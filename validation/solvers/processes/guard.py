"""A guard between a worker and whoever started it: ``python -I -S guard.py LIFELINE COMMAND ...``.

It starts the command and waits for the end of the command or of the lifeline, a pipe whose other end the starter
holds: that end closes with the starter, however it ends. Then the command gets `GRACE` seconds to end by itself, and
whatever it has started ends with it, processes that left its group or its parents included (on Linux, where they
become children of the guard; elsewhere the command's group). A byte on the lifeline leaves no grace. Standard library
only, and nothing of this package: it has to start at once.
"""

import contextlib
import ctypes
import os
import select
import signal
import sys
import time

GRACE = 0.7  # s for exit hooks of a command whose starter has ended
KILL_ROUNDS = 60  # in which processes that have appeared meanwhile are ended too
KILL_INTERVAL = 0.01  # s between them
DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of Linux
SUBREAPER = 36  # PR_SET_CHILD_SUBREAPER of Linux
HANDLED_SIGNALS = (signal.SIGCHLD, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)


def control(option: int, value: int) -> None:
    """Call prctl, where there is one."""
    with contextlib.suppress(OSError, AttributeError, TypeError):
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def start(command: list[str]) -> int:
    """Start the command in a group of its own, to be killed with this process."""
    guard = os.getpid()
    child = os.fork()
    if child:
        with contextlib.suppress(OSError):  # the child does the same, whoever comes first
            os.setpgid(child, child)
        return child
    try:
        os.setpgid(0, 0)
        signal.set_wakeup_fd(-1)
        for number in HANDLED_SIGNALS:
            signal.signal(number, signal.SIG_DFL)
        control(DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() == guard:
            os.execvp(command[0], command)
    except OSError as error:
        os.write(2, f"{command[0]}: {error.strerror}\n".encode(errors="replace"))
    os._exit(127)


def parents() -> dict[int, int]:
    """Return the parent of every process that lives, as /proc tells it."""
    parent_of = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", "rb") as stream:
                state, parent = stream.read().rpartition(b")")[2].split()[:2]
        except (OSError, ValueError):  # it has ended meanwhile
            continue
        if state not in (b"Z", b"X"):
            parent_of[int(name)] = int(parent)
    return parent_of


def descendants(root: int) -> list[int]:
    """Return the processes that a process and its descendants have started."""
    parent_of = parents()
    processes = [root]
    for process in processes:
        processes += [child for child, parent in parent_of.items() if parent == process]
    return processes[1:]


def kill(group: int) -> None:
    """End the group and every descendant, those that appear meanwhile included."""
    for _ in range(KILL_ROUNDS):
        processes = [-group]
        with contextlib.suppress(OSError):  # where there is no /proc
            processes += descendants(os.getpid())
        for process in processes:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(process, signal.SIGKILL)
        if processes == [-group]:
            return
        time.sleep(KILL_INTERVAL)


def exit_status(child: int, block: bool = False) -> "int | None":
    """Return the status of the child as a shell tells it, None while it runs; reap the others that have ended.

    The child itself is not reaped: its number, which is that of its group, stays nobody else's.
    """
    if not hasattr(os, "waitid"):
        options = 0 if block else os.WNOHANG
        pid, status = os.waitpid(child, options)
        code = os.waitstatus_to_exitcode(status)
        if pid == 0:
            return None
        return code if code >= 0 else 128 - code
    kind, number, options = (os.P_PID, child, 0) if block else (os.P_ALL, 0, os.WNOHANG)
    while (process := os.waitid(kind, number, os.WEXITED | os.WNOWAIT | options)) is not None:
        if process.si_pid == child:
            return process.si_status if process.si_code == os.CLD_EXITED else 128 + process.si_status
        os.waitpid(process.si_pid, 0)
    return None


def watch(child: int, lifeline: int, wake: int) -> int:
    """Wait for the end of the child or of the lifeline; return the child's status."""
    deadline: float | None = None
    watched = [lifeline, wake]
    while (status := exit_status(child)) is None:
        remaining = None if deadline is None else max(0.0, deadline - time.monotonic())
        ready = select.select(watched, [], [], remaining)[0]
        has_signal = wake in ready and any(number != int(signal.SIGCHLD) for number in os.read(wake, 64))
        if has_signal or remaining == 0.0 or (lifeline in ready and os.read(lifeline, 1)):
            kill(child)
            return exit_status(child, block=True) or 0
        if lifeline in ready:
            deadline = time.monotonic() + GRACE
            watched = [wake]
    return status


def main() -> None:
    """Guard the command of the arguments."""
    lifeline = int(sys.argv[1])
    command = sys.argv[2:]
    os.set_inheritable(lifeline, False)
    wake, awaken = os.pipe()
    os.set_blocking(awaken, False)
    signal.set_wakeup_fd(awaken, warn_on_full_buffer=False)
    for number in HANDLED_SIGNALS:
        signal.signal(number, lambda *_: None)
    control(SUBREAPER, 1)
    child = start(command)
    nothing = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1):  # the ends of the pipes are the command's alone
        os.dup2(nothing, descriptor)
    status = watch(child, lifeline, wake)
    kill(child)
    os._exit(status)


if __name__ == "__main__":
    main()
