"""What the chapter of the study `columns` draws by itself: stacks over time."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np

from validation.report.blocks import Blocks
from validation.report.chapters.described import Description
from validation.report.chapters.queries import StudyTable
from validation.report.figures.histories import saved
from validation.report.figures.space_time import SpaceTime, space_time_figure
from validation.runs.history import History
from validation.scenes.scene import Scene
from validation.solvers.columns.names import column_of

PAGE = Description(__file__)


def dropped(table: StudyTable, directory: Path) -> Blocks:
    """Return a stack that is dropped, exact in time and by blocks."""
    return over_time(table, directory, "dropped")


def torn_and_loaded(table: StudyTable, directory: Path) -> Blocks:
    """Return a pulse on bars, and blocks whose weight is put on at once."""
    return over_time(table, directory, "torn-and-loaded")


def over_time(table: StudyTable, directory: Path, name: str) -> Blocks:
    """Return the picture of columns over time: of each query the first case that a solver ran."""
    described = PAGE.described("stacks", name)
    drawn = []
    for query in described["drawn"]:
        for line in table.lines(query)[:1]:
            if line.case is not None and query["solver"] in line.case.histories:
                drawn.append(space_time(line.case.scene, line.case.histories[query["solver"]], query["title"]))
    if not drawn:
        return []
    return [saved(space_time_figure(drawn, described["height"]), directory, described["file"], described["caption"])]


def space_time(scene: Scene, history: History, title: str) -> SpaceTime:
    """Return the blocks of a column which observes their middles first, then all its contacts."""
    column = column_of(scene)
    faces = np.array(column.faces)
    blocks = len(faces) - 1
    start = -np.cumsum([contact.gap for contact in column.contacts])  # drawn with open gaps: the lowest one is largest
    moved = np.array([history.columns[f"displacement_{number + 1}"] for number in range(blocks)])
    forces = [history.columns[f"force_{blocks + number + 1}"] for number in range(len(column.contacts))]
    forces.append(np.zeros_like(history.time))
    carried = np.array([(below + above) / 2 for below, above in itertools.pairwise(forces)])
    return SpaceTime(title, history.time, faces, moved - start[:, None], carried)
