"""Moving blocks as files for ParaView: outlines in triangles, displacements, strains and contact forces at corners."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from validation.models.plane.assembly import Assembly
from validation.models.plane.geometry import triangles_of
from validation.models.plane.motion import contacts_of, force_on_corner, outlines_at
from validation.runs.history import History

FRAMES = 200  # greatest number of steps written
STRAIN = ("ex", "ey", "gxy")


def write_fields(path: Path, assembly: Assembly, history: History) -> None:
    """Write a motion to ``.xdmf``: at most `FRAMES` steps, their data inline; or to ``.vtu``: the last step.

    The history has poses and strains of all blocks and the forces of all contacts.
    """
    corners = [block.vertices for block in assembly.blocks]
    firsts = np.cumsum([0, *map(len, corners)]).tolist()
    triangles = [np.array(triangles_of(block.vertices)) for block in assembly.blocks]
    points = np.pad(np.vstack(corners), ((0, 0), (0, 1)))
    cells = [("triangle", np.vstack([first + part for first, part in zip(firsts, triangles, strict=False)]))]
    counts = [len(part) for part in triangles]
    numbers = {block.name: number for number, block in enumerate(assembly.blocks)}

    def data(step: int) -> dict[str, Any]:
        outlines = outlines_at(assembly, history, step)
        forces = np.zeros_like(points)
        placed = dict(zip(numbers, outlines, strict=True))
        for contact in contacts_of(history):
            corner = firsts[numbers[contact[0]]] + contact[1]
            forces[corner, :2] += force_on_corner(contact, placed, history, step)
        strains = [[history.columns[f"{name}.{part}"][step] for part in STRAIN] for name in numbers]
        moved = np.pad(np.vstack(outlines), ((0, 0), (0, 1)))
        return {
            "point_data": {"displacement": moved - points, "contact force": forces},
            "cell_data": {
                "block": [np.repeat(np.arange(len(counts)), counts)],
                "strain": [np.repeat(np.array(strains), counts, axis=0)],
            },
        }

    if path.suffix == ".vtu":
        meshio.write(path, meshio.Mesh(points, cells, **data(len(history.time) - 1)))
        return
    with meshio.xdmf.TimeSeriesWriter(str(path), data_format="XML") as writer:
        writer.write_points_cells(points, cells)
        for step in _frames(len(history.time)):
            writer.write_data(float(history.time[step]), **data(step))


def _frames(steps: int) -> Iterator[int]:
    """Yield the steps that are written; the last one always is."""
    stride = -(-steps // FRAMES)
    yield from range((steps - 1) % stride, steps, stride)
