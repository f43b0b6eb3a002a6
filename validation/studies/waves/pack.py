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
from validation.theory.wave_base import base_reflection

BLOCKS = (8, 10, 16, 20, 40, 100)
COURANTS = (0.1, 0.25, 0.5, 1.0)
SCHEMES = ((0.5, 1.0), (0.25, 0.5), (1 / 3, 0.6))
DISCOUNTS = (1.0, 0.99)
GLUES = (math.inf, 1.0, 10.0, 100.0, 1e4)
JOINTS = (0.25, 0.5, 1.0, 2.0)
IMPEDANCES = (0.5, 1.0, 2.0)
UNIT = 1.0  # h, rho and E of the columns of the tables, whose numbers do not depend on them

README = """\
# Waves in columns of blocks

A part of the reference pack of dda-validation; nothing needs to be installed.

| what | where |
|---|---|
| waves in a column of like blocks | `waves.csv`: `alpha,delta,gg,courant,blocks,glue,speed_error,left` |
| a joint between two halves of it | `joints.csv`: `alpha,delta,gg,courant,blocks,joint,transmitted,reflected` |
| a transmitting base below it | `bases.csv`: `alpha,delta,gg,courant,blocks,impedance,reflected` |
| the paper's block under a pressure that vibrates | `response.csv`, see below |
| scenes, SI units | `scenes/NAME.toml`, with `waves-site.csv`, the record of one |
| histories, one row a step | `histories/NAME.SOLVER.csv` |

Blocks of height h, density rho and modulus E (that of the motion) stand on each other and move along or across the
column; each has a displacement and one strain. Newmark's scheme with alpha, delta; gg multiplies the velocity at the
start of each step. `courant` = c dt / h with c = sqrt(E / rho); `blocks` = c / (f h), blocks a wavelength of the
continuum at the frequency f; `glue` = kg h / E, kg the stiffness per area of the springs between blocks, `inf` where
faces that meet move alike. `speed_error` = phase speed / c - 1; `left` = share of the amplitude after 10 c / f.

`joint` = kj / (rho c w), welded blocks; `transmitted` and `reflected` are |T| and |R| at the joint's two faces.
`impedance` = z / (rho c), a dashpot z per area under the lowest face, welded blocks; `reflected` is |R| there.

`response.csv`: `alpha,delta,gg,step,model,frequency`, then `displacement`, `contact_pressure`, each followed by its own
column `..._phase`. A square of 2 m, density 2700 kg/m3, E = 1e9 Pa, mu = 0, on a spring of 1e9 N/m at each lower corner
vibrates under a pressure on its top of the amplitude 5e6 Pa at `frequency` [Hz]. `model` is `dda` (the block of one
strain) or `bar` (exact in space, the springs at its foot); `step` = dt [s], 0 where the motion is exact in time.
Amplitudes of the centroid's displacement, upwards [m], and of the contact pressure [Pa], and phases before the
pressure's [rad]. Step until transients have gone, and fit sine and cosine to the last whole periods. Next to the
resonance at 52 Hz numbers are right to 1e-11 only, and yours may differ by as much as the equations magnify rounding.

All numbers are closed forms, right to some 1e-13. Your code should give `speed_error` to 1e-10 and `left` to 1e-8 of
itself. A way to measure them without a transient: send a smooth pulse up a column of a dozen blocks, go on until
nothing moves, and take X_j = sum over the steps of x_j e^{-iwt} at three neighbours: cos(kh) = (X_1 + X_3) / (2 X_2).

Histories: `displacement_1`, ... at the `heights` of the scene [m]; `displacement` of the top [m]; `contact_pressure`,
the force per area of the base on the column [Pa], in shear minus the shear stress. `NAME.dda.csv` is what your code
should give, `NAME.layers.csv` the continuum, exact in space and time.
"""


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
        raise InputError(f"{part.directory}: cannot be written: {error.strerror}") from None
    for scene in scenes():
        _add_scene(scene, part)
    part.add_text("README.md", README)
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


def _cases(discounts: tuple[float, ...]) -> Iterator[tuple[dict[str, float], waves.Stepping, float]]:
    """Yield the first columns of a table, the stepping and w of each case, for h = rho = E = 1."""
    for (alpha, delta), gg, courant, blocks in itertools.product(SCHEMES, discounts, COURANTS, BLOCKS):
        parameters = {"alpha": alpha, "delta": delta, "gg": gg, "courant": courant, "blocks": float(blocks)}
        yield parameters, waves.Stepping(courant, alpha, delta, gg), 2 * math.pi / blocks


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
            R = base_reflection(waves.Column(UNIT, UNIT, UNIT), stepping, w, impedance)
            yield parameters | {"impedance": impedance, "reflected": float(np.abs(R))}
