"""Users' solvers that end, stop or copy their process, or speak in its place; each is a row with a name.

Standard library only: with `bare` as their worker they start at once.
"""

import fcntl
import os
import signal
import time


def sound(scene):
    return {"displacement": [-1e-3] * scene.time.steps}


def forks(scene):
    """Both processes return, as a forgotten os._exit makes them."""
    if os.fork() == 0:
        return {"displacement": [7.0] * scene.time.steps}
    time.sleep(0.2)
    return sound(scene)


def _answers():
    """Return the descriptor of the pipe that answers go through: the one beside 0, 1 and 2 that can be written."""
    for name in os.listdir("/proc/self/fd"):
        try:
            pipe = os.readlink(f"/proc/self/fd/{name}").startswith("pipe:")
            if pipe and int(name) > 2 and fcntl.fcntl(int(name), fcntl.F_GETFL) & os.O_WRONLY:
                return int(name)
        except OSError:
            continue
    raise LookupError("no pipe")


def writes_half_a_line(scene):
    os.write(_answers(), b'{"columns": ')
    time.sleep(60)


def drips(scene):
    while True:
        os.write(_answers(), b" ")
        time.sleep(0.05)


def writes_garbage(scene):
    os.write(_answers(), b"\xff\xfe{{{\n")
    return sound(scene)


def writes_a_list(scene):
    os.write(_answers(), b"[1, 2]\n")
    return sound(scene)


def answers_another_request(scene):
    os.write(_answers(), b'{"columns": {"displacement": [7.0]}, "id": 99}\n')
    return sound(scene)


def closes_everything(scene):
    os.closerange(0, 256)
    return sound(scene)


def closes_and_sleeps(scene):
    os.closerange(0, 256)
    time.sleep(60)


def sleeps(scene):
    time.sleep(60)


def spins(scene):
    while True:
        pass


def ignores_signals(scene):
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        signal.signal(number, signal.SIG_IGN)
    time.sleep(60)


def stops_itself(scene):
    os.kill(os.getpid(), signal.SIGSTOP)


def kills_its_group(scene):
    os.killpg(0, signal.SIGKILL)


def kills_itself(scene):
    os.kill(os.getpid(), signal.SIGKILL)


def crashes(scene):
    os.write(2, b"segmentation fault\n")
    os._exit(139)
