"""Solvers that are no Python: histories in files, and programs that are started.

A program reads a scene from its standard input, a key and its values in a line (`validation.scenes.plain.lines`), and
prints the history as a table. It ends with status 77 if the scene is not for it, and says why on standard error.
"""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path
from time import perf_counter

import numpy as np

from validation.errors import InputError
from validation.runs.columns import OF_BLOCK, unit_of
from validation.runs.defects import Defects, DefectsError
from validation.runs.run import Outcome, Run
from validation.scenes.plain import lines
from validation.scenes.scene import Scene
from validation.solvers.foreign import one_line, run_of_columns
from validation.solvers.history_table import read_table
from validation.solvers.processes.worker import stderr_tail
from validation.solvers.user import ALLOWANCE, Outside, base_limit

ENDING = ".csv"
REFUSED = 77  # exit status, by which test harnesses of make leave a test out


def checked(scene: Scene, text: str | None, path: Path) -> Run:
    """Return the run of a table, checked as that of a user's solver is; a `DefectsError` names every defect."""
    instants = scene.time.step * np.arange(1.0, scene.time.steps + 1)
    names = (*scene.run.columns, *OF_BLOCK)
    units = {name: unit_of(name, scene.kind.columns) for name in names}
    defects = Defects()
    table = read_table(path, instants, units, scene.run.columns[:1], defects, text=text)
    defects.check()
    if table is None:
        return Run(Outcome.NOT_RUN, notes=(f"{path} is blank",))
    return run_of_columns(scene, {"time": table.history.time, **table.history.columns})


class HistoryFiles(Outside):
    """A file with the history of a scene, or a folder with ``SCENE.csv`` for each scene that is answered."""

    def file_of(self, scene: Scene) -> Path:
        """Return the file that holds the history of a scene."""
        place = Path(self.name)
        return place / f"{scene.name}{ENDING}" if place.is_dir() else place

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or that there is no file for the scene."""
        path = self.file_of(scene)
        return None if path.is_file() else f"there is no {path}"

    def read(self, scene: Scene) -> Run:
        """Read the history of a scene."""
        if reason := self.applicable(scene):
            return Run(Outcome.NOT_APPLICABLE, notes=(reason,))
        return checked(scene, None, self.file_of(scene))


class Program(Outside):
    """A program that is started for each scene."""

    def read(self, scene: Scene) -> Run:
        """Start the program, and read what it prints."""
        try:
            stated = "\n".join([*lines(scene), ""]).encode()
        except InputError as error:
            return Run(Outcome.NOT_APPLICABLE, notes=(str(error),))
        start = perf_counter()
        limit = base_limit(scene) + ALLOWANCE * scene.time.steps
        command = os.path.abspath(self.name)
        pipe = subprocess.PIPE
        try:
            process = subprocess.Popen([command], stdin=pipe, stdout=pipe, stderr=pipe, start_new_session=True)
        except OSError as error:
            return Run(Outcome.RAISED, notes=(f"cannot be started: {error.strerror}",))
        try:
            printed, said = process.communicate(stated, timeout=limit)
        except subprocess.TimeoutExpired:
            return Run(Outcome.TIMEOUT, notes=(f"no history within {limit:g} s",))
        finally:
            if process.returncode is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
        last_words = one_line(stderr_tail(said.decode(errors="replace")))
        if process.returncode == REFUSED:
            return Run(Outcome.NOT_APPLICABLE, notes=(f"the program says that it is not made for it: {last_words}",))
        if process.returncode:
            return Run(Outcome.RAISED, notes=(f"ended with status {process.returncode}: {last_words}",))
        seconds = {"setup": 0.0, "stepping": perf_counter() - start}
        try:
            run = checked(scene, printed.decode(errors="replace"), Path(self.name))
        except DefectsError as error:
            return Run(Outcome.WRONG_SHAPE, notes=(one_line(str(error)),))
        return Run(run.outcome, run.history, run.work, seconds, run.notes)
