"""Where one parameter cannot give the damping, the adviser says which settings give it."""

from typing import Any

import pytest

from validation.advice.advice import Advice, advise
from validation.advice.spectra import damping
from validation.scenes.scene import Scene, load_scene

BASE = load_scene("figures-3-4").with_values({"time.step": 0.002})


def answer(target: float, solve_for: str, **values: Any) -> tuple[Scene, Advice]:
    scene = BASE.with_values({f"time.{key}": value for key, value in values.items()})
    return scene, advise(scene, damping=target, solve_for=solve_for)


@pytest.mark.parametrize(
    ("target", "solve_for", "values", "words"),
    [
        (0.6, "dt", {}, "Change the discount instead: time.gg = "),
        (1e-4, "gg", {}, "Change the scheme instead: time.alpha = "),
        (0.05, "dt", {"alpha": 0.25, "delta": 0.5}, "Change the discount instead: time.gg = "),
        (0.05, "scheme", {"gg": 0.5}, "Change more than one: time.alpha = 0.25, time.delta = 0.5, time.gg = "),
        (0.05, "gg", {"gg": 0.5, "step": 1.0}, ", time.step = "),
        (0.05, "dt", {"gg": 0.0}, "Change more than one: "),
    ],
)
def test_what_is_named_instead_gives_the_target(target: float, solve_for: str, values: Any, words: str) -> None:
    scene, found = answer(target, solve_for, **values)
    assert not found.reachable and found.sentence.startswith("No ") and words in found.sentence
    assert found.instead is not None
    assert damping(scene.with_values(found.instead)).modes[0].damping == pytest.approx(target, rel=1e-6)


def test_what_can_be_had_is_not_told_to_be_changed() -> None:
    _, found = answer(0.05, "dt")
    assert found.reachable and found.instead is None and "Change" not in found.sentence


def test_a_scheme_that_damps_nothing_is_said_to() -> None:
    _, found = answer(0.05, "dt", alpha=0.25, delta=0.5)
    assert "the largest attainable value is 0 %, at any dt." in found.sentence
