"""The numbers in the chapters of vibrations, waves, rocking, toppling, creep and impacts, from rows made by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.made_cases import between, lines_of, made_case, made_group

from validation.report.blocks import Table
from validation.runs.history import History
from validation.scenes.scene import load_scene
from validation.studies.creep import chapter as creeping
from validation.studies.creep import formulas as creep
from validation.studies.impacts import chapter as impacts
from validation.studies.rebound import chapter as rebound
from validation.studies.response import chapter as response
from validation.studies.rocking import chapter as rocking_chapter
from validation.studies.subblocks import chapter as subblocks
from validation.studies.toppling import chapter as toppling_chapter
from validation.studies.waves import chapter as waves
from validation.theory.rocking import rectangle

TIME = np.array([0.5, 1.0, 1.5, 2.0])


def history(**columns: Any) -> History:
    return History(TIME, {name: np.array(values, dtype=float) for name, values in columns.items()})


# ---- vibrations ---------------------------------------------------------------------------------------------------


def test_what_the_step_takes_of_a_resonance_is_told_in_millimetres_and_as_a_share() -> None:
    rows = {("response-exact", "dda at 52 Hz"): {"displacement": 0.1},
            ("response-constant", "dda at 52 Hz"): {"displacement": 0.025}}  # fmt: skip
    said = response.lead(rows)
    assert "with 25.0 mm instead of 100.0 mm: at dt = 2 ms the step has removed 75\u00a0% of it" in said
    assert response.lead({}) == ""


def test_amplitudes_stand_under_their_solver_and_quantity() -> None:
    rows = {("response-constant", f"{solver} at 20 Hz"): {"displacement": 1e-3 * n, "pressure": 1e6 * (n + 3)}
            for n, solver in enumerate(("bar", "dda", "fem"), start=1)}  # fmt: skip
    (row,) = response.amplitudes(rows).rows
    assert row[:2] == ("dt = 2 ms, (1/2, 1)", "20")
    assert [float(cell) for cell in row[2:]] == [2.0, 3.0, 1.0, 5.0, 6.0, 4.0]  # dda, fem, bar; mm, then MPa


def test_the_damping_that_a_step_hides_is_told_at_its_frequency() -> None:
    rows = {("response-damping", f"dda at {f} Hz"): {"damping.steps": 0.0156 * f} for f in (5, 10)}
    assert "steady ratios |Im W|/|W| = sin(ω dt/4) of 7.8\u00a0% at 5 Hz, 15.6\u00a0% at 10 Hz" in response.hidden(rows)


# ---- waves --------------------------------------------------------------------------------------------------------


def of_scene(name: str, **metrics: float) -> tuple[Any, dict[tuple[str, str], dict[str, float]]]:
    """Return the first case of a scene of waves and the row of its wave of ten blocks."""
    scene = load_scene(name).expand()[0]
    row = {key.replace("_", ".", 1): value for key, value in metrics.items()}
    return made_case(scene, {"dda": {}}), {(scene.name, "dda at 10 blocks"): row}


def test_waves_in_blocks_have_their_speed_error_in_per_cent_and_their_share() -> None:
    case, rows = of_scene("waves-discount", wave_speed_error=-0.0307, wave_left=0.25)
    (row,) = waves._others({"waves-discount": made_group(case)}, rows).rows
    assert row[4:] == ("10", "−3.070", "0.2500")
    assert row[2] == f"{case.scene.time.alpha:g}, {case.scene.time.delta:g}, {case.scene.time.discount:g}"


def test_glue_is_told_by_its_stiffness_over_that_of_a_block() -> None:
    case, rows = of_scene("waves-glue", wave_speed_error=0.0, wave_left=1.0)
    column = case.scene.column
    assert column is not None and column.glue is not None
    (layer,) = column.layer
    (row,) = waves._others({"waves-glue": made_group(case)}, rows).rows
    height = layer.thickness / layer.blocks
    assert float(row[1]) == pytest.approx(column.glue * height / column.modulus(layer), rel=5e-3)


def test_a_joint_tells_what_goes_through_what_comes_back_and_both() -> None:
    case, rows = of_scene("waves-joint", joint_transmitted=0.8, joint_reflected=0.6, joint_energy=1.0)
    (row,) = waves._joints({"waves-joint": made_group(case)}, rows).rows
    assert row[3:] == ("0.800000", "0.600000", "1.000000")


def test_a_base_tells_what_comes_back_in_per_cent_by_blocks() -> None:
    case, rows = of_scene("waves-base", base_reflected=0.0123)
    table = waves._base({"waves-base": made_group(case)}, rows)
    assert table.rows[0][2:] == ("1.230",) and table.columns[-1].title == "10"


def test_ten_blocks_a_wavelength_are_told_with_speed_and_amplitude() -> None:
    travel = waves.TravelledWaves(
        "(1/2, 1)", 0.5, np.array([8.0, 10.0]), np.array([0.05, 0.0167]), np.array([0.001, 0.009])
    )
    said = waves.lead([travel])
    assert "the wave is 1.67\u00a0% too fast" in said and "0.9\u00a0% of its amplitude is left" in said


def test_a_site_is_told_off_at_the_surface_by_the_displacement_and_at_the_base_by_the_stress() -> None:
    scene = load_scene("waves-site")
    apart = (between(scene.name, "dda", "layers", displacement_l2=0.14, pressure_l2=0.32),)
    said = waves._site_sentence([made_group(made_case(scene, {}), comparisons=apart)])
    assert "DDA is 14\u00a0% off at the surface and 32\u00a0% off on the base" in said


def test_measured_waves_and_closed_forms_have_speed_beside_what_is_left() -> None:
    case, rows = of_scene("waves-blocks", wave_speed_error=0.0167, wave_left=0.25)
    (travel,) = waves.travels({"waves-blocks": made_group(case)}, rows)
    assert (travel.scheme, list(travel.blocks), list(travel.speed), list(travel.amplitude)) == (
        "(1/2, 1)", [10.0], [0.0167], [0.25],
    )  # fmt: skip
    line = waves._curve({"scheme": "s", "courant": 0.5, "blocks": [8.0], "speed": [0.01], "left": [0.75]})
    assert (list(line.blocks), list(line.speed), list(line.amplitude)) == ([8.0], [0.01], [0.75])


def test_a_site_draws_the_exact_layers_once_and_dda_at_each_step(drawn: dict[str, Figure], tmp_path: Path) -> None:
    found = {}
    for n, name in enumerate(("waves-site", "waves-site-usual"), start=1):
        columns = {"displacement": [1e-3 * n] * 4, "contact_pressure": [1e3 * n] * 4}
        given = {solver: history(**columns) for solver in ("dda", "layers")}
        values = {"time.step": 0.002 * n, "time.alpha": 0.25 * n, "time.delta": 0.5 * n}
        found[name] = made_group(made_case(load_scene("waves-site").with_values(values), {}, given))
    waves._site(found, tmp_path)
    above, below = drawn["waves-site.svg"].axes
    for axes in (above, below):
        shown = [(color, float(y[0])) for color, _, y in lines_of(axes)]
        assert shown == [
            ("#999999", 1.0),
            (waves.COLORS["(1/4, 1/2)"], 1.0),
            (waves.COLORS["(1/2, 1)"], 2.0),
        ]  # mm, kPa
    assert [text.get_text().partition("\n")[0] for text in above.texts] == [
        "exact layers", "dda, dt = 0.002 s,", "dda, dt = 0.004 s,"]  # fmt: skip


# ---- rocking and toppling -----------------------------------------------------------------------------------------


def told_by_gates(scene: str, **values: float) -> tuple[Any, ...]:
    return tuple({"scene": scene, "metric": name.replace("_", " "), "value": v, "band": [0.5, 1.5]}
                 for name, v in values.items())  # fmt: skip


def test_a_swing_has_its_slenderness_tilt_period_rate_and_housners_rate() -> None:
    scene = load_scene("rocking-release").expand()[1]  # 2 m wide, 4 m high, 1 mrad
    group = made_group(made_case(scene, {}), verdicts=told_by_gates(scene.name, quarter_period=1.25, rate_ratio=0.75))
    (row,) = rocking_chapter.swing_table([group]).rows
    alpha = math.atan(0.5)
    housner = 1 - 1.5 * math.sin(alpha) ** 2
    assert [float(cell) for cell in row] == pytest.approx([2.0, 1e-3 / alpha, 1.25, 0.75, housner], rel=0.03)


def test_a_pulse_has_its_size_its_peak_and_its_time() -> None:
    scene = load_scene("rocking-pulse").expand()[0]
    group = made_group(made_case(scene, {}), verdicts=told_by_gates(scene.name, time=1.125, peak=0.875))
    (row,) = rocking_chapter.pulse_table([group]).rows
    assert row[1:] == ("0.875", "1.125") and 0.5 < float(row[0]) < 2


def test_tilts_are_over_the_first_tilt_and_over_the_tipping_angle() -> None:
    let_go = load_scene("rocking-release").expand()[0]
    tilt, block = math.radians(let_go.block.tilt), rectangle(let_go)
    turned = History(block.quarter_period(tilt) * TIME, {"rotation": -0.25 * tilt * np.arange(1, 5)})
    (line,) = rocking_chapter.swing_panel(made_group(made_case(let_go, {}, {"dda": turned}))).lines
    assert np.allclose(line.x, TIME[:3]) and np.allclose(line.y, [0.75, 0.5, 0.25])
    pushed = load_scene("rocking-pulse").expand()[0]
    leaning = history(rotation=rectangle(pushed).alpha * np.array([0.1, 0.5, 0.9, 0.4]))
    panel = rocking_chapter.pulse_panel(made_group(made_case(pushed, {}, {"dda": leaning})))
    assert np.allclose(panel.lines[0].y, [0.1, 0.5, 0.9, 0.4]) and panel.marks == {"": 0.36}


def test_a_fall_turns_downwards_and_first_order_rotation_grows_in_per_cent() -> None:
    fallen, grown = (made_group(made_case(load_scene(name).expand()[0], {}, {"dda": history(
        rotation=[-0.05, -0.1, -0.2, -0.3], area=area)}))
        for name, area in (("toppling-fall", [1.0] * 4), ("toppling-growth", [1.0, 1.001, 1.003, 1.005])))  # fmt: skip
    found = [replace(fallen, name="toppling-fall"), replace(grown, name="toppling-growth")]
    lines = {line.name: line.y for line in toppling_chapter.fall_panel(found).lines}
    assert np.allclose(lines["released"], [0.05, 0.1, 0.2, 0.3]) and np.isclose(lines["rigid"][-1], 0.3)
    areas = {line.name: line.y for line in toppling_chapter.area_panel(found).lines}
    assert np.allclose(areas["exact"], 0) and np.allclose(areas["first-order"], [0, 0.1, 0.3, 0.5])
    product = np.cumprod(1 + np.array([0.05, 0.05, 0.1, 0.1]) ** 2) - 1
    assert np.allclose(areas["product"], 100 * product)


# ---- sub-blocks -----------------------------------------------------------------------------------------------------


def test_sub_blocks_are_told_by_their_first_frequency_over_that_of_the_elements() -> None:
    metrics = {"mode1.frequency": 120.0, "mode1.damping": 0.05}
    elements = {"mode1.frequency": 100.0, "mode1.damping": 0.04}
    case = made_case(load_scene("rocking").expand()[0], {"dda": metrics, "fem": elements})
    (row,) = subblocks.rocking(made_group(case)).rows
    assert [float(cell) for cell in row[1:5]] == [120.0, 100.0, 0.05, 0.04] and row[5] == "20\u00a0%"
    low = made_case(case.scene, {"dda": {"mode1.frequency": 75.0}, "fem": elements})
    assert subblocks.rocking(made_group(low)).rows[0][5] == "−25\u00a0%"


# ---- creep and impacts --------------------------------------------------------------------------------------------


def test_creep_is_the_mean_slide_of_the_corners_over_the_time() -> None:
    slides = history(slide_m=[0, 1e-3, 2e-3, 3e-3], slide_n=[0, 2e-3, 4e-3, 5e-3])
    case = made_case(load_scene(creep.STIFFNESS).expand()[0], {}, {"dda": slides, "block-events": slides})
    assert creeping.speed(case, "dda") == pytest.approx(2e-3)  # 4 mm in 2 s
    assert creeping.slip(case) == pytest.approx(4e-3)
    across = creeping.across(case)
    assert np.allclose(across.y, 2.0)  # mm/s
    (row,) = next(b for b in creeping.by_stiffness({creep.STIFFNESS: made_group(case)}) if isinstance(b, Table)).rows
    assert [float(row[i]) for i in (2, 3)] == pytest.approx([2.0, 2.0])


def test_a_budget_of_contact_reads_across_as_its_heads_say() -> None:
    metrics = {"energy.switching_gain": 0.5, "energy.given": 4e3, "energy.lost_algorithmic": 1e3,
               "contact.peak_force": 3e6, "contact.penetration": 2e-3, "contact.open_share": 0.4,
               "horizon.time": 0.125}  # fmt: skip
    case = made_case(load_scene("contact-map-constant").expand()[0], {"dda": metrics})
    assert tuple(rebound.budget_cells(case)[2:]) == ("0.250", "−0.500", "3.00", "2.00", "40.0", "0.125")


def test_an_impact_has_its_instants_in_milliseconds_and_its_force_in_meganewtons() -> None:
    metrics = {"switches.first_closing": 0.5, "switches.first_opening": 0.75, "switches.second_closing": 0.875,
               "contact.restitution": 0.625, "contact.peak_force": 2.5e6, "contact.penetration": 4e-3}  # fmt: skip
    case = made_case(load_scene("drop").expand()[0], {"dda": metrics})
    (row,) = impacts.quantity_table(made_group(case)).rows
    assert [float(cell) for cell in row[2:]] == [500, 750, 875, 0.625, 2.5, 4]
