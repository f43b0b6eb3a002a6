"""Where one parameter cannot give the damping, the adviser says which settings give it."""

import math
from typing import Any

import pytest

from validation.advice.advice import Advice, advise
from validation.advice.alternatives import alternative
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


class Found:
    """A search over a step, by its logarithm, that has found these steps."""

    def __init__(self, *steps: float) -> None:
        self.steps = steps

    def solutions(self, target: float) -> list[float]:
        return [math.log(step) for step in self.steps]

    def value(self, s: float) -> float:
        return math.exp(s)

    def settings(self, s: float) -> dict[str, float]:
        return {"time.step": math.exp(s)}


@pytest.mark.parametrize(("steps", "kept"), [((0.0015, 0.02), 0.0015), ((0.0001, 0.003), 0.003)])
def test_of_two_steps_that_do_the_one_that_changes_less_is_named(steps: tuple[float, float], kept: float) -> None:
    makes: Any = {"dt": lambda scene: Found(*steps), "gg": lambda scene: Found(), "scheme": lambda scene: Found()}
    settings, words = alternative(BASE, "gg", 0.05, makes, 344.6)
    assert settings == {"time.step": pytest.approx(kept)}
    assert words == f"Change the time step instead: time.step = {kept:g} gives it (--solve-for dt)."


def test_of_two_discounts_under_average_acceleration_the_gentler_is_named() -> None:
    class Discounts(Found):
        def solutions(self, target: float) -> list[float]:
            return [-0.5, -0.99]  # less the discount: a search runs from gg = 1 on

        def settings(self, s: float) -> dict[str, float]:
            return {"time.gg": -s}

    def over_gg(scene: Scene) -> Any:
        return Discounts() if scene.time.delta == 0.5 else Found()

    makes: Any = {"dt": lambda scene: Found(), "gg": over_gg, "scheme": lambda scene: Found()}
    settings, _ = alternative(BASE, "dt", 0.05, makes, 344.6)
    assert settings == {"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 0.99}


def test_what_can_be_had_is_not_told_to_be_changed() -> None:
    _, found = answer(0.05, "dt")
    assert found.reachable and found.instead is None and "Change" not in found.sentence


def test_a_scheme_that_damps_nothing_is_said_to() -> None:
    _, found = answer(0.05, "dt", alpha=0.25, delta=0.5)
    assert "the largest attainable value is 0 %, at any dt." in found.sentence
