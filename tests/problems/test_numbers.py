"""What problems ask for and are judged by, as numbers kept in `numbers.toml` beside this file.

Answers are stand-ins, waves that a name decides: what is measured on them means nothing, but a formula that has changed
shows. `KEEP_PAGES=1` writes the file anew.
"""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
from oracles.kept_answers import said
from oracles.stand_ins import assert_kept, history, numbers_in, summed

from validation.problems import quantities
from validation.problems.problem import names, problem
from validation.scenes.plain import scene_data
from validation.scenes.scene import load_scene

KEPT = Path(__file__).with_name("numbers.toml")
POISSON = {"block.poisson": 0.2, "block.hypothesis": "plane strain"}
SCENES = {  # beside those of the problems, whose digests `packs.json` keeps
    "eccentric": ("field-locked", {"load.eccentricity": 0.1, "load.traction": 3.0, "block.side": 3.0}),
    "sheared": ("field-locked", POISSON | {"contact.shear_stiffness": 7.0, "load.gravity": 3.0, "load.slope": 5.0}),
    "gap": ("field-opening", {"contact.gap": 0.1, "contact.friction": 20.0, "contact.cohesion": 5.0}),
    "shaken": ("columns-shaken", {}),
    "cosine": ("columns-joint", {"input.shape": "cosine"}),
    "slips": ("columns-slips", {}),
    "springs": ("columns-mass-ratio", {"column.base": "springs", "column.base_stiffness": 3e9}),
    "settled": ("field-stack", {"column.settled": True}),
    "rigid": ("field-cradle", {"column.stiffness": "inf"}),
    "rigid joint": ("field-joint", {"column.joint": [{"height": 40.0, "stiffness": "inf"}]}),
}


def number_of(name, factor=1.0):
    """Return the number of all that a problem says in numbers, and of what it measures on a stand-in."""
    posed = problem(name)
    answer = history(posed.scene, factor=factor)
    stated = [
        posed.title == posed.scene.title,
        len(posed.instants),
        float(posed.instants[-1]),
        *posed.columns,
        *posed.further_columns,
        *map(posed.unit, posed.columns),
    ]
    for number in posed.numbers:
        stated += [number.exact, number.low, number.high, number.scale, number.optional]
    measured = [number.measure(answer) for number in posed.numbers]
    for number in quantities.numbers(posed.scene):
        if number.column in posed.columns and name != "locked":  # no pole of a stand-in
            measured.append(number.of(answer.time, answer.columns[number.column]))
    return summed(stated) + summed(measured)


@np.errstate(all="ignore")
def numbers_of_families(*changed):
    found = {}
    for name in names():
        family = name.partition("-")[0]
        found[family] = found.get(family, 0.0) + number_of(name, *changed)
    return found


def test_problems_ask_and_measure_as_before():
    assert_kept(KEPT, "problems", numbers_of_families(), lambda: numbers_of_families(1 + 1e-11))


ROWS = (
    *((5, 0.004, 6, 0.008, 0, 7, 1), (-1, -3, -2, -2, -4, 1, 0), (3, 0, 1, 2, 3, 5, 1), (0, 0, 0, 0, 0, 0, 0)),
    *((0.1, 0.7, 0.2, -0.9, 0.5, 0.8, 1.3), (-0.2, -0.1, 0.1, 0, -0.3, -1, -1.7), (1e-4, 0, 3e-4, 4e-4, 5e-4, 0, 2e-4)),
)


def test_few_rows_are_measured_as_before():
    """Openings, rebounds, arrivals, landings, poles."""
    t = 0.1 * np.arange(1, 41)
    found = [quantities._pole(t, 2 + np.exp(-0.3 * t) * np.cos(3 * t)), quantities._pole(t[:1], t[:1])]
    for x in np.array(ROWS):
        time = 0.3 * np.arange(1, 8)
        of_tilts = [quantities._landing(SimpleNamespace(block=SimpleNamespace(tilt=tilt))) for tilt in (-90, 100, 400)]
        for measure in (quantities.openings, quantities.rebound, quantities.arrival, *of_tilts):
            found.append(measure(time, x))
    assert_kept(KEPT, "rows", {"rows": summed(said(found, 0.0))})


def test_scenes_are_stated_as_before():
    """Without what is None, in plain numbers and "inf"."""
    found = {}
    for name, (scene, values) in SCENES.items():
        found[name] = summed(numbers_in(scene_data(load_scene(scene).with_values(values))))
    assert_kept(KEPT, "scenes", found)
