"""A frequency beyond pi / dt is named an alias wherever it would be shown as the mode's own."""

import math
import re
from dataclasses import replace

import pytest
from conftest import typed

from validation.advice.spectra import damping
from validation.metrics.measurable import Measurable
from validation.metrics.modes import first_axial, measured
from validation.metrics.values import ALIAS
from validation.report.chapters.text import cell, word_notes
from validation.runs.modes import Mode
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver, solve


def figure(step, gg=1.0):
    return load_scene("figures-3-4").with_values({"time.step": step, "time.gg": gg, "time.steps": 60})


def seen(scene, solver):
    prepared = get_solver(solver).prepare(scene)
    history = solve(scene, solver).history
    return Measurable(history, scene.time.step, prepared.static(), prepared.modes())


@pytest.mark.parametrize("gg", [1.0, pytest.param(0.9, marks=pytest.mark.long)])
def test_the_continuums_frequency_beyond_nyquist_is_an_alias_and_its_damping_is_not(gg):
    m = seen(figure(0.01, gg), "continuum")
    w, c = m.modes[0].frequency, -math.log(gg) / 0.01
    assert w * m.step > math.pi
    assert first_axial(m, "numerical_frequency") == measured(m, "frequency") == measured(m, "damping") == ALIAS
    slow = Mode(9.0, 1.0, (0.6 + 0.3j, 0.6 - 0.3j))
    assert measured(replace(m, modes=(*m.modes[:1], slow)), "damping") == ALIAS
    assert first_axial(m, "frequency") == w
    assert first_axial(m, "damping") == pytest.approx(c / (2 * w), rel=1e-12, abs=1e-15)
    folded = abs(complex(-c / 2, 2 * math.pi / m.step - math.sqrt(w**2 - c**2 / 4)))
    assert m.modes[0].alias(m.step) == pytest.approx(folded, rel=1e-12)


def test_damping_and_the_reports_tables_say_so(tmp_path):
    assert damping(figure(0.01)).alias is None  # nothing of references was asked for
    shown, fine = (
        typed("advise", "damping", "figures-3-4", "--set", f"time.step={step}", cwd=tmp_path).stdout
        for step in (0.01, 0.002)
    )
    (line,) = (line for line in shown.splitlines() if line.startswith("alias"))
    assert re.findall(r"\d+\.\d+", line) == ["327.682", "314.159", "300.636"]
    assert "alias" not in fine
    assert cell(ALIAS) == "alias" and "beyond π/Δt" in word_notes([ALIAS])[0]
