"""Users' solvers that do whatever a program can do wrong; each is a row with a name and costs no other row."""

import gc
import os
import sys
import threading
import time
from typing import ClassVar

import numpy as np


def sound(scene):
    return {"displacement": np.full(scene.time.steps, -1e-3)}


def leaves_a_thread(scene):
    threading.Thread(target=time.sleep, args=(60,)).start()
    return sound(scene)


def prints(scene):
    print("{}" * 100)
    sys.__stdout__.write("{}\n")
    os.write(1, b'{"columns": {}}\n')
    return sound(scene)


def prints_without_end(scene):
    line = b"x" * 99_999 + b"\n"
    for _ in range(20):  # 2 MB
        os.write(2, line)
    return sound(scene)


def interrupts(scene):
    raise KeyboardInterrupt


class Nameless(BaseException):
    def __str__(self):
        raise RuntimeError("no text")


def raises_what_has_no_text(scene):
    raise Nameless


def raises_half_a_character(scene):
    raise ValueError("half \udc80 of \ud800 a character, \x1b[31mred\x1b[0m, \0 and\nlines")


def not_a_number(scene):
    return {"displacement": np.full(scene.time.steps, np.nan)}


def texts(scene):
    return {"displacement": ["-1e-3"] * scene.time.steps}


def ragged(scene):
    return {"displacement": [[1.0], [1.0, 2.0]]}


def odd_names(scene):
    odd = {"\udc80": [1.0], "../../x": [1.0], 3: [1.0], (1, 2): [1.0], "file": [1.0], "": [1.0]}
    return sound(scene) | odd


class Static:
    """Reports a static solution."""

    values: ClassVar = {"displacement": -1e-3}

    def solve(self, scene):
        return {"displacement": np.linspace(-1e-3, -2e-3, scene.time.steps)}

    def static(self, scene):
        return self.values


class SubnormalStatic(Static):
    values: ClassVar = {"displacement": -1e-320}


class TextStatic(Static):
    values: ClassVar = {"displacement": "x"}


class OddModes(Static):
    def modes(self, scene):
        class Mode:
            frequency, share, eigenvalues = float("nan"), "x", [complex("nan"), 0]

        return [Mode()]


def collects_itself(scene):
    gc.disable()
    sys.setrecursionlimit(50)
    np.seterr(all="raise")
    return sound(scene)
