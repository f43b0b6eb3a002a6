"""The numbers of slopes, creep, rebound and two codes, each in its place, from rows and histories made by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.made_cases import made_case, made_group, made_row

from validation.report.blocks import Callout, Table
from validation.report.chapters.data import CaseGroup
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.studies.creep import chapter as creeping
from validation.studies.creep import formulas as creep
from validation.studies.rebound import chapter as rebound
from validation.studies.response import chapter as response
from validation.studies.slopes import chapter as sliding
from validation.studies.slopes import formulas as study
from validation.studies.toppling import chapter as toppling_chapter
from validation.studies.two_codes import chapter as two_codes
from validation.theory import friction

PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 100})


def slid(last: float) -> History:
    """Return a history of two corners that slide by a way [m] in a second."""
    time = np.linspace(0.01, 1.0, 100)
    return History(time, {"slide_m": last * time, "slide_n": last * time})


def ways(name: str, of: Any) -> CaseGroup:
    """Return the cases of a scene, each with the way [m] that a function of it gives."""
    cases = [made_case(scene, {}, {"dda": slid(way)}) for scene in load_scene(name).expand() if (way := of(scene))]
    return made_group(*cases)


# ---- creep --------------------------------------------------------------------------------------------------------


def stepped() -> CaseGroup:
    return ways(creep.STEPS, lambda scene: 0.125e-3 if scene.time.delta == 1 else 8e-3)


def test_slip_by_step_has_constant_before_average_and_the_program_last() -> None:
    rows = {row[0]: row[1:] for row in creeping.by_step({creep.STEPS: stepped()}).rows}
    assert rows["2.00"] == ("0.125", "8.00", "–", "2.20") and rows["10.0"][-1] == "1.00"


def test_slip_over_the_step_is_in_millimetres_for_dda_and_for_the_program(
    drawn: dict[str, Figure], tmp_path: Path
) -> None:
    creeping.over_time_and_step({creep.STEPS: stepped()}, tmp_path)
    _, right = drawn["creep.svg"].axes
    shown = {line.get_label(): line for line in right.lines}
    program = shown["an established program"]
    assert list(program.get_xdata()) == pytest.approx([1e3 * step for step in sorted(creep.PROGRAM)])
    assert list(program.get_ydata()) == pytest.approx([499, 5.2, 2.2, 1.0])
    assert set(np.round(shown["(1/2, 1), consistent"].get_ydata(), 9)) == {0.125}


def test_a_block_stops_under_constant_acceleration_and_with_gg_in_columns_of_their_own() -> None:
    damped = ways(creep.DAMPED, lambda scene: 0.25e-3 if scene.time.discount < 1 else 0.5e-3)
    found = {creep.STIFFNESS: ways(creep.STIFFNESS, lambda scene: 3e-3), creep.DAMPED: damped}
    (table,) = [block for block in creeping.by_stiffness(found) if isinstance(block, Table)]
    assert {row[3:] for row in table.rows} == {("3.00", "0.500", "0.250")}  # (1/4, 1/2) [mm/s], then [mm]


# ---- sliding ------------------------------------------------------------------------------------------------------


def test_a_run_behind_the_closed_form_is_told_with_its_sign() -> None:
    scene = load_scene(study.SLIDING).expand()[0]
    free = float(friction.free_motion(scene, friction.sliding_acceleration(scene))[0][-1])
    moved = {"dda": {"horizontal.final": free - 25e-6}, "fem": {"horizontal.final": 2.0}}
    assert sliding.run_outs([made_case(scene, moved)]).rows[0][-2:] == ("−25.00", "2.00000")


def test_a_base_that_shakes_has_the_rigid_slide_dda_s_the_difference_and_what_is_allowed() -> None:
    case = made_case(load_scene(study.SHAKEN).expand()[0], {})
    own: Any = {"slide": {"band": [0.0495, 0.0505], "value": 0.0501}, "largest difference": {"value": 0.25e-3}}
    _, table = sliding.shaking([(case, own)])
    assert isinstance(table, Table)
    (row,) = table.rows
    assert [row[0], *map(float, row[3:])] == ["2 Hz", 50.0, 50.1, 0.25, 0.5]


def test_what_is_judged_of_a_shaken_base_is_what_stands_beside_the_rigid_block() -> None:
    case = made_case(load_scene(study.SHAKEN).expand()[0], {})
    verdicts = [{"scene": case.name, "pair": pair, "metric": metric, "value": len(pair)}
                for pair in ([study.RIGID], ["dda", "bar"]) for metric in ("slide", "largest difference")]  # fmt: skip
    ((found, own),) = sliding.judged(made_group(case, verdicts=tuple(verdicts)))
    assert found is case and {v["value"] for v in own.values()} == {1}
    assert sliding.judged(made_group(case, verdicts=tuple(verdicts[1:]))) == []


# ---- toppling -----------------------------------------------------------------------------------------------------


def test_a_fall_has_its_number_before_the_edges_of_its_band() -> None:
    case = made_case(load_scene("toppling-static").expand()[0], {})
    verdicts = ({"scene": case.name, "metric": "turned", "value": 0.5, "band": [0.25, 0.75]},)
    table = toppling_chapter.fall_table([replace(made_group(case, verdicts=verdicts), name="toppling-static")])
    assert table.rows == (("static", "greatest turn [rad]", "0.5", "0.25", "0.75"),)


# ---- rebound ------------------------------------------------------------------------------------------------------


def mapped() -> CaseGroup:
    """Return two cases of a map, of which each is the worse in one number."""
    numbers = ((0.5, 3.0, 12.0), (0.125, 7.0, 4.0))  # energy gained, most solves, switches
    cases = []
    for scene, (rise, most, count) in zip(load_scene("contact-map-average").expand(), numbers, strict=False):
        own = {"energy.rise": rise, "contact.most_solves": most, "switches.count": count, "contact.mean_solves": 1.5}
        cases.append(made_case(scene, {"dda": own}))
    return replace(made_group(*cases), name="contact-map-average")


def test_a_map_of_contact_is_concluded_by_its_largest_gain_and_its_most_solves() -> None:
    said = rebound.conclusion([mapped()])
    assert "gains up to 0.5 times the energy given and needs at most 7 solves a step" in said


def test_switches_are_told_over_those_of_the_exact_motion() -> None:
    group = mapped()
    assert rebound._switches_over_exact(group.cases[0], {rebound.ratio(group.cases[0]): 8.0}) == 1.5
    assert rebound._switches_over_exact(group.cases[0], {}) is None


# ---- the block and its vibration ----------------------------------------------------------------------------------


def test_a_code_that_is_not_there_is_named_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    absent = made_row("fenicsx", {}, outcome=Outcome.NOT_RUN, notes=("dolfinx is missing",))
    cases = [made_case(PAPER, {"fenicsx": absent}, label="one") for _ in range(2)]
    monkeypatch.setattr(two_codes, "case_groups", lambda *_: [made_group(case) for case in cases])
    blocks = two_codes.chapter(Results(tmp_path), {"study": "two-codes"}, tmp_path)
    (said,) = [block.text for block in blocks if isinstance(block, Callout)]
    assert said.startswith("fenicsx at one: not run.") and said.endswith("dolfinx is missing")


@pytest.mark.parametrize(
    ("solver", "exact", "dashed"), [("dda", True, True), ("dda", False, False), ("bar", True, False)]
)
def test_only_dda_s_answer_that_is_exact_in_time_is_dashed(solver: str, exact: bool, dashed: bool) -> None:
    told = {"name": "n", "solver": solver, "exact": exact, "columns": {"displacement": ([1.0], [2.0])}}
    curve = response._response_curve([5.0], told)
    assert (curve.dashed, curve.columns["displacement"]) == (dashed, (1.0, 2.0))
