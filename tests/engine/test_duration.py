"""How long a run is going to take: extrapolation from shorter ones, and of which runs there is one."""

import itertools

import pytest

from validation import load_scene
from validation.cli.printing.output import in_minutes
from validation.engine import duration
from validation.solvers.registry import get_solver

LONG = load_scene("field-opening").with_values({"time.steps": 6400})


@pytest.mark.parametrize(
    ("earlier", "later", "times", "seconds", "is_least"),
    [
        (1.0, 2.0, 8.0, 16.0, False),
        (1.0, 4.0, 4.0, 64.0, False),
        (3.0, 4.0, 4.0, 10.0, False),
        (2.0, 1.9, 4.0, 1.9, False),
        (1.0, 17.0, 8.0, 136.0, True),
    ],
    ids=["linear", "quadratic", "a fixed part of 2 s", "nothing but noise", "more switches set in"],
)
def test_a_run_takes_what_its_parts_say(
    earlier: float, later: float, times: float, seconds: float, is_least: bool
) -> None:
    assert duration.extrapolated(earlier, later, times) == duration.Prediction(pytest.approx(seconds), is_least)


@pytest.mark.parametrize(("cost", "seconds"), [(0.01, 64.0), (1e-5, None)])
def test_a_long_run_is_predicted_and_a_short_one_is_not(
    monkeypatch: pytest.MonkeyPatch, cost: float, seconds: float | None
) -> None:
    """With a clock that runs by `cost` a step."""
    steps: list[int] = []
    clock = itertools.count()

    def completed(solver: object, scene: object, full: bool) -> object:
        steps.append(scene.time.steps)  # type: ignore[attr-defined]
        return type("Run", (), {"outcome": duration.Outcome.COMPLETED})

    def now() -> float:
        return cost * steps[-1] if next(clock) % 2 else 0.0

    monkeypatch.setattr(duration, "completed", completed)
    monkeypatch.setattr(duration.time, "perf_counter", now)
    predicted = duration.predicted_duration(get_solver("fem"), LONG)
    assert predicted == (None if seconds is None else duration.Prediction(pytest.approx(seconds)))
    assert max(steps) <= LONG.time.steps / 4


@pytest.mark.parametrize(("seconds", "words"), [(36.4, "36 s"), (126.0, "2 m 6 s"), (59.7, "1 m 0 s")])
def test_durations_are_in_minutes_and_seconds(seconds: float, words: str) -> None:
    assert in_minutes(seconds) == words
