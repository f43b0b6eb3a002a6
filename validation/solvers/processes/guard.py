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
ROUNDS, PAUSE = 60, 0.01  # looks for what is left, and s between them
DEATH_SIGNAL, SUBREAPER = 1, 36  # PR_SET_PDEATHSIG and PR_SET_CHILD_SUBREAPER of Linux
CAUGHT = (signal.SIGCHLD, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)


def control(option: int, value: int) -> None:
    """Call prctl, where there is one."""
    with contextlib.suppress(OSError, AttributeError, TypeError):
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def started(command: list[str]) -> int:
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
        for caught in CAUGHT:
            signal.signal(caught, signal.SIG_DFL)
        control(DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() == guard:
            os.execvp(command[0], command)
    except OSError as error:
        os.write(2, f"{command[0]}: {error.strerror}\n".encode(errors="replace"))
    os._exit(127)


def parents() -> dict[int, int]:
    """Return the parent of every process that lives, as /proc tells it."""
    found = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", "rb") as stream:
                state, parent = stream.read().rpartition(b")")[2].split()[:2]
        except (OSError, ValueError):  # it has ended meanwhile
            continue
        if state not in (b"Z", b"X"):
            found[int(name)] = int(parent)
    return found


def descendants(root: int) -> list[int]:
    """Return the processes that a process and its descendants have started."""
    of, found = parents(), [root]
    for known in found:
        found += [child for child, parent in of.items() if parent == known]
    return found[1:]


def kill(group: int) -> None:
    """End the group and every descendant, those that appear meanwhile included."""
    for _ in range(ROUNDS):
        left = [-group]
        with contextlib.suppress(OSError):  # where there is no /proc
            left += descendants(os.getpid())
        for process in left:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(process, signal.SIGKILL)
        if left == [-group]:
            return
        time.sleep(PAUSE)


def ended(child: int, block: bool = False) -> "int | None":
    """Return the status of the child as a shell tells it, None while it runs; reap the others that have ended.

    The child itself is not reaped: its number, which is that of its group, stays nobody else's.
    """
    if not hasattr(os, "waitid"):
        process, status = os.waitpid(child, 0 if block else os.WNOHANG)
        code = os.waitstatus_to_exitcode(status)
        return None if process == 0 else code if code >= 0 else 128 - code
    which, whose = (os.P_PID, child) if block else (os.P_ALL, 0)
    while (found := os.waitid(which, whose, os.WEXITED | os.WNOWAIT | (0 if block else os.WNOHANG))) is not None:
        if found.si_pid == child:
            return found.si_status if found.si_code == os.CLD_EXITED else 128 + found.si_status
        os.waitpid(found.si_pid, 0)
    return None


def watch(child: int, lifeline: int, wake: int) -> int:
    """Wait for the end of the child or of the lifeline; return the child's status."""
    deadline: float | None = None
    watched = [lifeline, wake]
    while (status := ended(child)) is None:
        rest = None if deadline is None else max(0.0, deadline - time.monotonic())
        ready = select.select(watched, [], [], rest)[0]
        asked = wake in ready and any(number != int(signal.SIGCHLD) for number in os.read(wake, 64))
        if asked or rest == 0.0 or (lifeline in ready and os.read(lifeline, 1)):
            kill(child)
            return ended(child, block=True) or 0
        if lifeline in ready:
            deadline, watched = time.monotonic() + GRACE, [wake]
    return status


def main() -> None:
    """Guard the command of the arguments."""
    lifeline, command = int(sys.argv[1]), sys.argv[2:]
    os.set_inheritable(lifeline, False)
    wake, awaken = os.pipe()
    os.set_blocking(awaken, False)
    signal.set_wakeup_fd(awaken, warn_on_full_buffer=False)
    for caught in CAUGHT:
        signal.signal(caught, lambda *_: None)
    control(SUBREAPER, 1)
    child = started(command)
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1):  # the ends of the pipes are the command's alone
        os.dup2(nothing, number)
    status = watch(child, lifeline, wake)
    kill(child)
    os._exit(status)


if __name__ == "__main__":
    main()
