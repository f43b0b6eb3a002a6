"""A step that is too long is told from the scheme alone, for every scene that has modes, and no other one."""

import math

import pytest

from validation.advice.coarse import AGREEMENT, SAMPLED, coarse_alarms
from validation.scenes.scene import Scene
from validation.theory import columns

GRANITE = {
    "block": {"side": 1.2, "density": 2650.0, "young": 5e10, "poisson": 0.25},
    "contact": {"stiffness": 5e11},
    "load": {"gravity": 9.81, "pressure": 1e6},
    "time": {"step": 1e-3, "steps": 200},
}
COLUMN = {
    "column": {"motion": "shear", "layer": [{"thickness": 10.0, "density": 2000.0, "young": 2e9, "blocks": 20}]},
    "input": {"shape": "ricker", "velocity": 0.1, "frequency": 2.0},
    "time": {"step": 1e-3, "steps": 200},
}


def scene(base=GRANITE, **changes):
    tables = {name: dict(table) for name, table in base.items()}
    for key, value in changes.items():
        table, _, field = key.partition("__")
        if value is None:
            tables[table].pop(field, None)
        else:
            tables[table] = value if not field else tables.get(table, {}) | {field: value}
    return Scene.model_validate({"name": "granite", **tables})


def kinds(case):
    return {alarm.kind for alarm in coarse_alarms(case)}


BOTH = {AGREEMENT, SAMPLED}
FINE = 1.2e-5  # s, w dt = 0.073
UNLOCKED = {"law": "unilateral", "stiffness": 5e11}
CH = {"scheme": "chung-hulbert", "rho_inf": 0.0, "steps": 200}


@pytest.mark.parametrize(
    ("case", "raised"),
    [
        (scene(), BOTH),
        (scene(time__step=3e-4), {AGREEMENT}),
        (scene(time__step=FINE), set()),
        (scene(time__step=3e-4, block__poisson=0.0, load={"pressure": 1e6}), {AGREEMENT}),
        (scene(time__step=3e-4, block__subdivide=[2, 2]), {AGREEMENT}),
        (scene(time__step=3e-4, contact=UNLOCKED), {AGREEMENT}),
        (scene(time__step=FINE, contact=UNLOCKED), set()),
        (scene(contact=UNLOCKED | {"stiffness": math.inf, "shear_stiffness": 0.0}), BOTH),
        (scene(contact=UNLOCKED | {"rule": "energy-conserving"}, time__alpha=0.25, time__delta=0.5), {SAMPLED}),
        (scene(time=CH | {"step": 3e-4}), {AGREEMENT}),
        (scene(time=CH | {"step": 3e-5}), set()),
        (scene(time__alpha=0.25, time__delta=0.5), {SAMPLED}),
        (scene(time__alpha=0.25, time__delta=0.5, time__step=3e-4), set()),
        (scene(time__gg=0.0), set()),  # to come to rest is what is meant
        (scene(load__ramp=0.1), set()),  # 97 periods of the first mode
        (scene(contact=UNLOCKED | {"friction": 30.0}, load={"gravity": 9.81, "slope": 20.0}), set()),  # slides
        (scene(COLUMN), set()),
        (scene(COLUMN, time__step=5e-3), {AGREEMENT}),  # w1 dt = 0.56
        (scene(COLUMN, time__step=5e-2), BOTH),
        (scene(COLUMN, time__step=1e-3, input__frequency=100.0), {AGREEMENT}),  # of the wave, not of the first mode
    ],
)
def test_a_step_that_is_too_long_is_told_without_a_run(case, raised):
    assert kinds(case) == raised


@pytest.mark.parametrize(
    ("column", "frequency"),
    [
        ({"layer": [{"blocks": 200}]}, math.pi / 2 * math.sqrt(1e9 / 2000) / 10),  # a bar, to 1e-5
        ({"layer": [{"blocks": 1}]}, math.sqrt(3) * math.sqrt(1e9 / 2000) / 10),  # one strain
        (
            {"base": "springs", "base_stiffness": 1e5, "layer": [{"blocks": 4}]},
            math.sqrt(5 / (1 + 1e-3 / 3)),
        ),  # k H / 3 G
    ],
)
def test_the_first_frequency_of_a_column(column, frequency):
    layers = [{"thickness": 10.0, "density": 2000.0, "young": 2e9} | layer for layer in column["layer"]]
    section = scene(COLUMN, column=column | {"motion": "shear", "layer": layers}).column
    assert section is not None
    assert columns.first_frequency(section) == pytest.approx(frequency, rel=1e-4)
