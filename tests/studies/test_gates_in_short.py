"""Gates of each study on the first cases of its cheap scenes; `validation/test_gates.py` has all of them and is long.

A scene is here if its gates take less than some 0.3 s on one core, of a family of scenes its first ones, and of every
study at least one. Studies of FEniCSx alone start its processes, which takes seconds, and are long.

What the bands of all gates are, long ones included, is a number a study in `bands.toml`: the sum of the logarithms of
all edges, each with a weight of its own, so that an edge which changes by a few per cent shows. Why a band is what it
is stands in its reason; the number tells only that a formula has changed. `KEEP_PAGES=1` writes it anew.
"""

import math
import os
import tomllib
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from validation.gates.gate import Status
from validation.runs.case_name import scene_of
from validation.runs.results import Results
from validation.suite.folders import get_study, judged_studies
from validation.suite.own_solver.session import GateRuns

KEPT = Path(__file__).with_name("bands.toml")
ROUNDING, LARGEST = 1e-11, 1e30  # of an edge that counts
LONG = ("two-codes",)
SLOW = ("claims:C8:*", "claims:C14:*", "claims:C16:*")  # claims whose gates make histories of seconds
SHORT = {
    "beams": ("beams-squares",),
    "boxes": ("boxes-landing",),
    "columns": ("columns-domino", "columns-settle", "columns-slips-steps", "columns-solves-*"),
    "core": ("corner-springs", "mesh-*", "poisson*", "figure-[89]", "figures-5-6"),
    "cost": ("cost-dt-*", "cost-h-*"),
    "impacts": ("unlocked-other", "ansys-vm265"),
    "limits": ("*",),
    "meeting": ("meeting-land*", "meeting-drop*", "meeting-slope*", "meeting-stack*"),
    "methods": ("methods-*-average", "methods-*-ch-0.5", "methods-*-tr-bdf2", "methods-rigid-d*", "!methods-refined-*"),
    "opening": ("unlocked",),
    "paper": ("claims",),
    "patch": ("patch-two-*", "patch-irregular-*"),
    "plates": ("plates-disc",),
    "pushing": ("wedge-limit",),
    "rebound": ("rebound-*", "contact-map-[aci]*", "!contact-map-constant"),
    "response": ("response-*", "viscous"),
    "rocking": ("rocking-swing",),
    "slopes": ("slope-[dsfm]*",),
    "spin": ("spin-flight", "spin-stopping", "spin-turns"),
    "stability-small": ("*",),
    "standing": ("standing-truss-*", "standing-overhang", "standing-leaning", "standing-keystone"),
    "stiff-contact": ("*",),
    "subblocks": ("*", "!subblocks-rocking", "!subblocks-locking"),
    "toppling": ("*", "!toppling-threshold"),
    "touching": ("touching-[cmpg]*", "touching-half"),
    "waves": ("waves-joint-*", "waves-base", "waves-facts", "waves-shear"),
}


def test_every_study_is_here_or_long():
    assert {*SHORT, *LONG} == set(judged_studies())


@pytest.mark.parametrize("name", SHORT)
def test_gates_of_the_first_cases(name, finished_cases):
    runs = GateRuns(Results(finished_cases), studies=[name])
    first = {}
    failed = {}
    passed = 0
    for gate in get_study(name).gates():
        scene = scene_of(gate.scene)
        if not _is_short(scene, SHORT[name]) or any(fnmatchcase(gate.id, pattern) for pattern in SLOW):
            continue
        if first.setdefault(scene, gate.scene) != gate.scene:
            continue
        verdict = runs.verdict(name, gate)
        passed += verdict.status is Status.PASS
        if verdict.status is Status.FAIL:
            failed[gate.id] = (verdict.value, gate.low, gate.high, verdict.why)
    assert not failed and passed


def _is_short(scene, patterns):
    fitting = [pattern for pattern in patterns if fnmatchcase(scene, pattern.removeprefix("!"))]
    return bool(fitting) and not fitting[-1].startswith("!")


# ---- bands ----------------------------------------------------------------------------------------------------------


def number(study):
    """Return the number of a study: the sum of w log10(|edge| / ROUNDING), w from 1 to 2, with the sign of the edge."""
    total = 0.0
    edges = [edge for gate in get_study(study).gates() for edge in (gate.low, gate.high)]
    for order, edge in enumerate(edges):
        if abs(edge) > ROUNDING:
            weight = 1 + order * 0.6180339887 % 1
            total += math.copysign(weight * math.log10(min(abs(edge), LARGEST) / ROUNDING), edge)
    return total


def kept():
    return tomllib.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}


@pytest.mark.parametrize("study", judged_studies())
def test_bands_are_what_they_were(study):
    found = number(study)
    if os.environ.get("KEEP_PAGES"):
        lines = kept() | {study: round(found, 2)}
        KEPT.write_text("".join(f"{name} = {value}\n" for name, value in sorted(lines.items())), encoding="utf-8")
    assert found == pytest.approx(kept()[study], abs=0.03)
