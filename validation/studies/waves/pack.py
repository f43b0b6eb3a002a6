"""The part of the reference pack on waves: speed and loss, joints and bases in closed form, and a site's histories."""

from __future__ import annotations

import itertools
import math
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from validation.errors import InputError
from validation.scenes.scene import SCENE_DIRECTORY, Scene
from validation.studies.pack import Part, history_of
from validation.studies.waves.response import amplitudes
from validation.studies.waves.rows import travelling
from validation.studies.waves.study import SITE, usual_site
from validation.theory import waves
from validation.theory.stepping import Stepping

BLOCKS = (8, 10, 16, 20, 40, 100)
COURANTS = (0.1, 0.25, 0.5, 1.0)
SCHEMES = ((0.5, 1.0), (0.25, 0.5), (1 / 3, 0.6))
DISCOUNTS = (1.0, 0.99)
GLUES = (math.inf, 1.0, 10.0, 100.0, 1e4)
JOINTS = (0.25, 0.5, 1.0, 2.0)
IMPEDANCES = (0.5, 1.0, 2.0)
UNIT = 1.0  # h, rho and E of the columns of the tables, whose numbers do not depend on them


def write_waves_pack(directory: Path) -> int:
    """Write the part into `waves` of a pack's directory, and return how many numbers its tables hold.

    Raises
    ------
    InputError
        The directory cannot be made or written.
    """
    part = Part(directory / "waves")
    count = 0
    tables = {"waves": travel(), "joints": joints(), "bases": bases(), "response": amplitudes()}
    for name, rows in ((name, list(table)) for name, table in tables.items()):
        part.add_table(name, rows)
        count += len(rows)
    try:
        shutil.copyfile(SCENE_DIRECTORY / f"{SITE}.csv", part.directory / "scenes" / f"{SITE}.csv")
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", source=part.directory) from None
    for scene in scenes():
        _add_scene(scene, part)
    part.add_readme(__file__)
    return count


def scenes() -> tuple[Scene, ...]:
    """Return the scenes of the pack: those of travelling waves that DDA runs, and the site twice."""
    scenes_by_name = {wave.scene.name: wave.scene for wave in travelling() if wave.scene.time.steps < 5000}
    usual = usual_site()
    site = usual.with_values({"time.alpha": 0.25, "time.delta": 0.5, "time.step": 2e-3, "time.steps": 4500})
    return (*scenes_by_name.values(), site.model_copy(update={"name": SITE}), usual)


def _add_scene(scene: Scene, part: Part) -> None:
    """Add a scene, its DDA history and, of the site, the exact one."""
    packed_scene = scene
    if scene.input.record is not None:
        packed_scene = scene.with_values({"input.record": Path(scene.input.record).name})
    part.add_scene(packed_scene)
    for solver in ("dda", "layers") if scene.input.record is not None else ("dda",):
        part.add_history(scene.name, solver, history_of(scene, solver))


def _cases(discounts: tuple[float, ...]) -> Iterator[tuple[dict[str, float], Stepping, float]]:
    """Yield the first columns of a table, the stepping and w of each case, for h = rho = E = 1."""
    for (alpha, delta), gg, courant, blocks in itertools.product(SCHEMES, discounts, COURANTS, BLOCKS):
        parameters = {"alpha": alpha, "delta": delta, "gg": gg, "courant": courant, "blocks": float(blocks)}
        yield parameters, Stepping(courant, alpha, delta, gg), 2 * math.pi / blocks


def travel() -> Iterator[dict[str, float]]:
    """Yield speed and loss of waves."""
    for parameters, stepping, w in _cases(DISCOUNTS):
        for glue in GLUES:
            stiffness = None if math.isinf(glue) else glue
            column = waves.Column(UNIT, UNIT, UNIT, stiffness)
            remaining_share, speed = column.travelled(stepping, w, 10 * 2 * math.pi / w)
            yield parameters | {"glue": glue, "speed_error": float(speed), "left": float(remaining_share)}


def joints() -> Iterator[dict[str, float]]:
    """Yield what joints let through and send back."""
    for parameters, stepping, w in _cases((1.0,)):
        for ratio in JOINTS:
            T, R = waves.joint_in_column(waves.Column(UNIT, UNIT, UNIT), stepping.squared_frequency(w), ratio * w)
            yield parameters | {"joint": ratio, "transmitted": float(np.abs(T)), "reflected": float(np.abs(R))}


def bases() -> Iterator[dict[str, float]]:
    """Yield what transmitting bases send back."""
    for parameters, stepping, w in _cases((1.0,)):
        for impedance in IMPEDANCES:
            R = waves.base_reflection(waves.Column(UNIT, UNIT, UNIT), stepping, w, impedance)
            yield parameters | {"impedance": impedance, "reflected": float(np.abs(R))}
