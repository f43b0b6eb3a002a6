"""The study of contact that opens: its gates hold, and each is bitten by a fault of the exact motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import fem_reference.events.bar_events
import fem_reference.events.block_events
from validation.engine.judge import evaluate
from validation.engine.run import finish
from validation.gates.gate import Status
from validation.runs.results import Results
from validation.studies.opening import OPENING, half_unit

FAULTS = {  # of the data by parts in 1e11 and less, which move every number by about as much
    "block: springs": ("block_events", {"stiffness": 1 + 4e-11}),
    "block: density": ("block_events", {"density": 1 + 4e-11}),
    "block: load": ("block_events", {"pressure": 1 + 4e-12}),
    "bar: springs": ("bar_events", {"base_stiffness": 1 + 1e-9}),
    "bar: density": ("bar_events", {"density": 1 + 4e-11}),
    "bar: load": ("bar_events", {"pressure": 1 + 4e-12}),
    "block: an open contact carries something": ("block_events", {}),
    "bar: an open contact carries something": ("bar_events", {}),
    "block: springs 1 % stiff": ("block_events", {"stiffness": 1.01}),
}


def pressed(found: Any) -> Any:
    """Return a history with 1e-3 Pa more on the contact."""
    return replace(found, contact_pressure=found.contact_pressure + 1e-3)


def faulty(changes: dict[str, float]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return a wrapper that solves for other data."""

    def wrap(sound: Callable[..., Any]) -> Callable[..., Any]:
        def solve(problem: Any, end: float) -> Any:
            motion = sound(replace(problem, **{n: getattr(problem, n) * f for n, f in changes.items()}), end)
            return motion if changes else SimpleNamespace(switches=motion.switches, at=lambda t: pressed(motion.at(t)))

        return solve

    return wrap


def failed(directory: Path) -> set[str]:
    finished = finish(OPENING.cases(), OPENING, Results(directory))
    return {gate.id for gate in OPENING.gates() if evaluate(gate, finished).status is not Status.PASS}


def test_every_gate_holds_and_is_bitten(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert not failed(tmp_path / "sound")
    bitten: set[str] = set()
    for name, (module, changes) in FAULTS.items():
        owner = getattr(fem_reference.events, module)
        with monkeypatch.context() as patch:
            patch.setattr(owner, owner.solve.__name__, faulty(changes)(owner.solve))
            killed = failed(tmp_path / name)
        assert killed, name
        bitten |= killed
    assert {gate.id for gate in OPENING.gates()} - bitten == set()


@pytest.mark.parametrize(
    ("value", "half"), [(-0.04033057058886, 5e-15), (3514046.36162, 5e-6), (-0.0052, 0.0), (1e7, 0.0)]
)
def test_the_uncertainty_of_a_printed_number_is_half_a_unit_of_its_last_digit(value: float, half: float) -> None:
    assert half_unit(value) == pytest.approx(half, rel=1e-9)
