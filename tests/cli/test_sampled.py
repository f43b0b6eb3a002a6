"""Frequencies that the steps do not sample, ratios in per cent, and gates for a disagreement are not answered."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import SCENE, refused, typed

from validation import advise, load_scene
from validation.advice.wave_advice import advise_wave
from validation.cli.printing import tables
from validation.errors import InputError

STEP = ("--set", "time.step=0.002")


@pytest.mark.parametrize("frequency", [251.0, 260.0, 1000.0])
def test_a_wave_that_the_steps_do_not_sample_is_refused_with_the_limit(frequency: float) -> None:
    said = refused("advise", "figures-3-4", *STEP, "--fmax", frequency)
    assert "--fmax: must be at most 250 Hz, 1 / (2 dt) of the time step 0.002 s" in said


def test_a_wave_of_two_steps_a_period_is_answered() -> None:
    scene = load_scene("figures-3-4").with_values({"time.step": 0.002})
    assert advise_wave(scene, 250.0, 0.1).frequency == 250.0


def test_a_range_that_the_step_does_not_sample_is_refused() -> None:
    assert "--to: must be at most 50 Hz" in refused("rayleigh", "--dt", "0.01", "--from", "1", "--to", "80")
    refused("rayleigh", "--dt", "0.01", "--delta", "1", "--keep-dt", "--ratio", "5=0.02", "--ratio", "80=0.05")


def test_what_the_steps_show_of_an_alias_is_no_peak() -> None:
    done = typed("response", "figures-3-4", "--set", "time.step=0.02", "--to", "200", "--points", "4000")
    peaks = [float(line.split()[2]) for line in done.stdout.splitlines() if line.startswith("as stepped")]
    assert peaks
    assert max(peaks) <= 25.0
    assert "above 25 Hz" in done.stdout


def test_a_ratio_in_per_cent_is_refused_with_what_was_meant() -> None:
    said = refused("advise", "figures-3-4", *STEP, "--damping", "5")
    assert "from 0 to 2, where 1 is critical, got 5; 5 % is 0.05" in said
    with pytest.raises(InputError):
        advise(load_scene("figures-3-4").with_values({"time.step": 0.002}), damping=2.1)


@pytest.mark.parametrize(("value", "proposed"), [(0.034, True), (0.49, True), (1.02, False), (1.5e47, False)])
def test_a_gate_is_proposed_for_what_agrees(value: float, proposed: bool) -> None:
    record = {"scene": "s", "solver": "dda", "reference": "fem", "metrics": {"displacement.l2": value}}
    text = "\n".join(tables._next([record], True))  # type: ignore[list-item]
    assert ("[[gate]]" in text) is proposed


def test_a_pair_that_agrees_is_proposed_before_one_that_does_not(tmp_path: Path) -> None:
    scene = tmp_path / "s.toml"
    scene.write_text(SCENE + '[run]\nsolvers = ["dda", "bar"]\n')
    done = typed("run", scene, "--results", tmp_path / "r")
    assert "[[gate]]" in done.stdout
