"""Laws, rules and schemes that exclude each other over contacts that open, each refused by its field."""

import math
from dataclasses import replace

import pytest

from dda import (
    BaseMotion,
    Block,
    Load,
    Material,
    Scheme,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    named_scheme,
    opening_subdivided,
    solve_unilateral,
)
from dda.bodies.turning_block import RollingModel

ROUGH = {"stiffness": 1e9, "shear": 1e9, "friction": 0.5}
SMOOTH = {"stiffness": 1e9}
BAND = (1e-6, 0.0)
CENTRED = UnilateralModel(Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0)), Unilateral(1e9), 5e6)
PAPER = replace(CENTRED, eccentricity=0.3)
TURNING = RollingModel(PAPER.block, Unilateral(1e9))
MOVED = BaseMotion([0.0, 1.0], [[1e-3, 0.0], [0.0, 0.0]])
MOVES = BaseMotion([0.0, 1.0], [[0.0, 0.0], [0.0, 0.1]])
HOLLOW = Block([[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]], PAPER.block.material)


@pytest.mark.parametrize(
    ("field", "given"),
    [
        ("stiffness", {"stiffness": 0.0}),
        ("stiffness", {"stiffness": math.nan}),
        ("shear", SMOOTH | {"shear": -1.0}),
        ("shear", ROUGH | {"shear": 0.0}),
        ("gap", SMOOTH | {"gap": math.inf}),
        ("band", SMOOTH | {"band": (-1e-6, 0.0)}),
        ("band", {"stiffness": math.inf, "band": (0.0, 1e-6)}),
        ("band", ROUGH | {"band": (0.0, 1e-6)}),
        ("friction", ROUGH | {"friction": -0.1}),
        ("friction", SMOOTH | {"cohesion": 1.0}),
        ("friction", SMOOTH | {"rules": "lagged"}),
        ("cohesion", ROUGH | {"cohesion": -1.0}),
        ("rules", ROUGH | {"rules": "late"}),
        ("damping", {"stiffness": math.inf, "damping": 1.0}),
        ("damping", ROUGH | {"damping": 1.0}),
        ("damping", ROUGH | {"damping": 1.0, "cohesion": 1.0}),
        ("damping", ROUGH | {"damping": 1.0, "rules": "lagged"}),
        ("damping", SMOOTH | {"damping": 1.0, "band": BAND}),
        ("damping", SMOOTH | {"damping": -1.0}),
        ("damping", SMOOTH | {"damping": math.nan}),
    ],
)
def test_laws(field, given):
    with pytest.raises(ValueError, match=f"^{field}: "):
        Unilateral(**given)


@pytest.mark.parametrize(
    ("field", "given"),
    [
        ("rule", {"rule": "uzawa"}),
        ("solve_limit", {"solve_limit": 0}),
        ("cut", {"cut": 1.0}),
        ("restitution", {"rule": "impact"}),
        ("restitution", {"rule": "newmark", "restitution": 0.5}),
        ("restitution", {"rule": "impact", "restitution": 1.1}),
        ("restitution", {"rule": "impact", "restitution": math.nan}),
        ("penetration", {"rule": "augmented", "penetration": 0.0}),
        ("pass_limit", {"rule": "augmented", "pass_limit": 0}),
        ("rotation", {"rotation": "second"}),
    ],
)
def test_options(field, given):
    with pytest.raises(ValueError, match=f"^{field}: "):
        UnilateralOptions(**given)


@pytest.mark.parametrize(
    ("field", "model", "changes"),
    [
        ("velocity", PAPER, {"velocity": math.nan}),
        ("base", PAPER, {"base": 7}),
        ("top", PAPER, {"top": 0}),
        ("eccentricity", PAPER, {"eccentricity": 1.0}),
        ("motion", PAPER, {"motion": MOVED}),
        ("base", TURNING, {"base": 4}),
        ("top", TURNING, {"top": 0}),
        ("tilt", TURNING, {"tilt": math.nan}),
        ("velocity", TURNING, {"velocity": (0.0, math.inf)}),
        ("band", TURNING, {"contact": Unilateral(1e9, band=BAND)}),
        ("damping", TURNING, {"contact": Unilateral(1e9, damping=1e5)}),
        ("vertices", TURNING, {"block": HOLLOW}),
        ("eccentricity", TURNING, {"load": Load(1e3, 1.2)}),
        ("ramp", TURNING, {"load": Load(1e3, ramp=1.0)}),
    ],
)
def test_models(field, model, changes):
    with pytest.raises(ValueError, match=f"^{field}: "):
        replace(model, **changes)


AVERAGE = Scheme(0.25, 0.5, 1.0, 1e-3, "consistent")
CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-3)
EXPLICIT = Scheme(0.0, 0.5, 1.0, 1e-4)
COMPOSITE = named_scheme("composite", step=1e-3)
LEAPFROG = named_scheme("leapfrog", step=1e-3)
CONSERVING = {"rule": "energy-conserving"}
IMPLICIT = {"rule": "implicit"}
AUGMENTED = {"rule": "augmented"}
IMPACT = {"rule": "impact", "restitution": 0.5}
DAMPED = {"contact": Unilateral(1e9, damping=1e5)}
DAMPED_SHEAR = {"contact": Unilateral(1e9, shear=1e9, damping=1e5)}
RIGID = {"contact": Unilateral(math.inf)}
RIGID_SHEAR = {"contact": Unilateral(math.inf, shear=1e9)}
RIGID_ROUGH = {"contact": Unilateral(math.inf, shear=1e9, friction=0.3), "eccentricity": 0.0}
SHEAR = {"contact": Unilateral(1e9, shear=1e9)}
BANDED = {"contact": Unilateral(1e9, band=BAND)}


@pytest.mark.parametrize(
    ("field", "changes", "scheme", "options"),
    [
        ("damping", DAMPED, AVERAGE, IMPLICIT),
        ("damping", DAMPED, AVERAGE, CONSERVING),
        ("damping", DAMPED, AVERAGE, AUGMENTED),
        ("damping", DAMPED_SHEAR, AVERAGE, {}),
        ("rule", {}, CONSTANT, IMPLICIT),
        ("rule", {}, LEAPFROG, IMPLICIT),
        ("rule", {}, CONSTANT, CONSERVING),
        ("rule", {}, LEAPFROG, CONSERVING),
        ("rule", RIGID, AVERAGE, CONSERVING),
        ("rule", BANDED, AVERAGE, CONSERVING),
        ("rule", SHEAR, AVERAGE, CONSERVING),
        ("rule", {"motion": MOVES}, AVERAGE, CONSERVING),
        ("ramp", {"ramp": 1.0}, AVERAGE, CONSERVING),
        ("rule", RIGID, CONSTANT, IMPACT),
        ("rule", {}, AVERAGE, IMPACT),
        ("rule", RIGID, COMPOSITE, IMPACT),
        ("rule", RIGID_SHEAR, AVERAGE, IMPACT),
        ("rule", RIGID_ROUGH, AVERAGE, IMPACT),
        ("rule", RIGID | {"motion": MOVES}, AVERAGE, IMPACT),
        ("rule", RIGID, AVERAGE, AUGMENTED),
        ("rule", BANDED, AVERAGE, AUGMENTED),
        ("rule", SHEAR, AVERAGE, AUGMENTED),
        ("rule", {}, EXPLICIT, AUGMENTED),
        ("stiffness", RIGID, EXPLICIT, {}),
        ("stiffness", RIGID, LEAPFROG, {}),
    ],
)
def test_histories_of_a_block(field, changes, scheme, options):
    with pytest.raises(ValueError, match=f"^{field}: "):
        solve_unilateral(replace(PAPER, **changes), scheme, 3, options=UnilateralOptions(**options))


@pytest.mark.parametrize(
    ("field", "changes", "options"),
    [
        ("damping", DAMPED, {}),
        ("rule", {}, AUGMENTED),
        ("rule", RIGID, IMPACT),
        ("rules", {"contact": Unilateral(**ROUGH, rules="lagged")}, {}),
        ("rule", {}, IMPLICIT),
    ],
)
def test_histories_of_sub_blocks(field, changes, options):
    with pytest.raises(ValueError, match=f"^{field}: "):
        opening = opening_subdivided(replace(CENTRED, **changes), 2, 1, 1e12)
        solve_unilateral(opening, AVERAGE, 3, options=UnilateralOptions(**options))


def test_histories_of_no_step_and_of_a_block_that_turns():
    with pytest.raises(ValueError, match=r"^steps: "):
        solve_unilateral(PAPER, AVERAGE, 0)
    with pytest.raises(ValueError, match=r"^stiffness: "):
        solve_unilateral(replace(TURNING, **RIGID), EXPLICIT, 1)


@pytest.mark.parametrize("rates", [(2.0, 0.0), (0.0, 1e-4)])
def test_viscous_damping_where_contact_opens(rates):
    damped = replace(AVERAGE, mass_damping=rates[0], stiffness_damping=rates[1])
    for model in (PAPER, TURNING, opening_subdivided(CENTRED, 2, 1, 1e12)):
        with pytest.raises(ValueError, match=r"^mass_damping, stiffness_damping: "):
            solve_unilateral(model, damped, 1)
