"""Histories by other time schemes than Newmark's, and by contact methods with a force of their own."""

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.compared import Case, dashpot_of, scene_of, verdict
from oracles.few_moves import only
from oracles.scheme_histories import Body, Run

from validation import load_scene, solve
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.diagnosis.schemes import companion_split
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Rectangle, Variant
from validation.errors import InputError
from validation.theory.stages import equal_split

ROUNDINGS = 1e-12  # relative, that two formulations of one recursion over 60 steps differ by

# a run, and the same as a candidate change
STEPPED = [
    ("chung-hulbert", {"r": 0.8}, {"family": "chung-hulbert", "spectral": 0.8}),
    ("chung-hulbert", {"r": 0.3, "zero": True}, {"family": "chung-hulbert", "spectral": 0.3, "start": "zero"}),
    ("hht", {"e": 0.12}, {"family": "hht", "spectral": 0.12}),
    ("wbz", {"r": 0.4}, {"family": "wbz", "spectral": 0.4}),
    ("leapfrog", {}, {"family": "leapfrog"}),
    ("symplectic-euler", {}, {"family": "symplectic-euler"}),
    ("theta", {"share": 0.6}, {"family": "theta", "spectral": 0.6}),
    ("implicit-euler", {}, {"family": "theta", "spectral": 1.0}),
    ("composite", {"split": 0.4, "r": 0.3}, {"family": "composite", "split": 0.4, "spectral": 0.3}),
    ("composite", {"split": 2 - math.sqrt(2), "r": 0.0}, {"family": "composite"}),
    ("contact-split", {"law": "kane"}, {"alpha": 0.25, "delta": 0.5, "contact": "implicit"}),
    ("contact-split", {"law": "conserving"}, {"alpha": 0.25, "delta": 0.5, "contact": "energy-conserving"}),
    ("dashpot", {"c": 0.2}, {"alpha": 0.25, "delta": 0.5, "contact": "dashpot", "dashpot": 0.2}),
]
OPENED = [
    *STEPPED,
    ("dashpot", {"c": 0.4, "clipped": False}, {**STEPPED[-1][2], "dashpot": 0.4, "clipped": False}),
    ("chung-hulbert", {"r": 0.6, "form": "state"}, {"family": "chung-hulbert", "spectral": 0.6, "contact": "mean gap"}),
    ("moreau", {"e": 0.4, "theta": 0.7}, {"family": "theta", "spectral": 0.7, "contact": "impact", "restitution": 0.4}),
    ("lagrange", {"alpha": 0.5, "delta": 1.0}, {"contact": "rigid"}),
]


@pytest.mark.parametrize("opens", [False, True])
def test_candidates_step_as_the_recursions_of_the_papers(opens):
    body = Body(p=1e10)
    dt, steps, gg = 2e-4, 40, 0.98
    variants = []
    runs = []
    for method, numbers, changes in OPENED if opens else STEPPED:
        in_units = {"c": dashpot_of(body, numbers["c"])} if "c" in numbers else {}
        runs.append(Run(method, numbers | in_units, body, dt, steps, gg, opens).history())
        variants.append(replace(Variant(0.5, 1.0, gg, "consistent", opens=opens), **changes))
    rectangle = Rectangle(body.a, body.a, body.rho, body.E, 0.0, False, body.k, body.k, body.q)
    stepped = histories(rectangle, variants, np.full(steps, dt))
    for j, (displacement, pressure) in enumerate(runs):
        assert np.max(np.abs(stepped.displacement[:, j] - displacement)) < ROUNDINGS * np.max(np.abs(displacement)), j
        assert np.max(np.abs(stepped.pressure[:, j] - pressure)) < 10 * ROUNDINGS * np.max(np.abs(pressure)), j


OTHER = {"time.step": 5e-4, "time.steps": 60, "run.solvers": ["dda"], "load.gravity": 9.81}
DDA_S = load_scene("figures-3-4").with_values(OTHER)
CHUNG_HULBERT = DDA_S.with_values({"time.scheme": "chung-hulbert", "time.rho_inf": 0.7})


@pytest.mark.parametrize("law", ["locked", "unilateral"])
def test_a_scene_of_another_scheme_has_its_own_history(law):
    scene = CHUNG_HULBERT.with_values({"contact.law": law, "time.gg": 0.98})
    run = solve(scene, "dda")
    answer = compare(scene, Foreign(run.time, run.displacement, run.contact_pressure))
    assert answer.causes == [] and answer.misfit < 1e-9


def test_dda_s_own_scheme_beside_a_scene_of_another_one_is_named(monkeypatch):
    only(monkeypatch, "scheme", "gg", "hht")
    run = solve(DDA_S, "dda")
    answer = compare(CHUNG_HULBERT, Foreign(run.time, run.displacement, run.contact_pressure))
    assert answer.causes == ["scheme"]
    assert answer.scheme == {"alpha": 0.5, "delta": 1.0, "gg": 1.0}
    assert answer.remedy.split()[1::2] == ["time.scheme=newmark", "time.alpha=0.5", "time.delta=1"]


@pytest.mark.parametrize(
    "changes",
    [
        {"contact.law": "unilateral", "contact.friction": 20.0},
        {"load.eccentricity": 0.1},
        {"contact.law": "unilateral", "block.poisson": 0.2},
    ],
)
def test_what_is_stepped_by_newmark_s_scheme_only_is_refused_by_name(changes):
    with pytest.raises(InputError) as refusal:
        compare(CHUNG_HULBERT.with_values(changes), Foreign(5e-4 * np.arange(1, 9), -np.ones(8)))
    assert refusal.value.field == "time.scheme"


LOCKED, OPENING = {"dt": 2e-3}, {"dt": 5e-4, "opens": True}


def judged(method, numbers, digits=6, **of_run):
    run = Run(method, numbers, **of_run)
    case = Case(run, scene_of(run), digits)
    return case, case.judged()


NAMED = [
    ("chung-hulbert", {"r": 0.63}, LOCKED, ["generalised-alpha"]),
    ("composite", {"split": 0.45, "r": 0.2}, LOCKED, ["composite"]),
    ("hht", {"e": 0.07, "form": "state"}, OPENING, ["hht"]),
    ("moreau", {"e": 0.3}, OPENING, ["impact-law"]),
    ("implicit-euler", {}, {"dt": 2e-3, "gg": 0.98}, ["theta"]),
    ("contact-split", {"law": "energy-conserving"}, OPENING, ["energy-conserving-contact"]),
    ("lagrange", {"alpha": 0.5, "delta": 1.0}, OPENING, ["rigid-contact"]),
    ("dashpot", {"c": dashpot_of(Body(), 0.3), "alpha": 0.5, "delta": 1.0}, OPENING, ["contact-dashpot"]),
]


@pytest.mark.long
@pytest.mark.parametrize(("method", "numbers", "of_run", "causes"), NAMED)
def test_a_method_is_named_by_six_digits(method, numbers, of_run, causes):
    case, answer = judged(method, numbers, **of_run)
    assert answer.causes == causes
    assert verdict(case, answer) == "right"


def test_two_splits_of_a_composite_scheme_are_one_in_locked_contact():
    """The roots of a step have 1 - q2 z and 1 - split z / 2 below: a split of 2 q2 exchanges them."""
    variant = Variant(0.25, 0.5, 1.0, "consistent", family="composite", split=0.7, spectral=0.3)
    other = companion_split(variant)
    assert companion_split(replace(variant, split=other)) == pytest.approx(0.7, rel=1e-12)
    rows = []
    for split in (0.7, other):
        rows.append(Run("composite", {"split": split, "r": 0.3}).history()[0])
    assert np.max(np.abs(rows[0] - rows[1])) < ROUNDINGS * np.max(np.abs(rows[0]))
    for rho_inf in (0.0, 0.6):
        usual = replace(variant, split=0.0, spectral=rho_inf)  # of equal matrices in both stages
        assert companion_split(usual) == pytest.approx(equal_split(rho_inf), rel=1e-12)
