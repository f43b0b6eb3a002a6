"""Every gate of the study of columns is bitten: seeded faults in steps, solves, exact columns and exact bars."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from faults import seams
from faults.fault import Fault, of_first, told, with_scheme
from faults.kill_matrix import cases_of, check_kill_matrix

from validation.studies.columns.study import study

DDA, EVENTS, BARS = ("dda",), ("column-events",), ("bars-events",)
SHORT = ("columns-domino", "columns-settle[time.step=0.02", "columns-slips-steps[time.step=0.005")


def wrong_sign(sound: Callable[..., Any]) -> Callable[..., Any]:
    """Let a push at a block's foot move its top the other way."""

    def faulty(*given: Any, **named: Any) -> Any:
        numbers, blocks, joints = sound(*given, **named)
        return numbers, blocks, joints._replace(coupling=-joints.coupling)

    return faulty


def larger(factor: float) -> Callable[..., Callable[..., object]]:
    """Multiply what a column's history holds."""
    return told(lambda result: {"columns": {name: factor * x for name, x in result.columns.items()}})


def heavier(part: str, factor: float) -> Callable[..., Callable[..., object]]:
    """Multiply the density of blocks or bars."""
    return of_first(lambda p: {part: tuple(replace(one, density=factor * one.density) for one in getattr(p, part))})


def stronger(factor: float) -> Callable[..., Callable[..., object]]:
    """Multiply the strength of joints."""
    return of_first(
        lambda p: {"joints": tuple(one and replace(one, strength=factor * one.strength) for one in p.joints)}
    )


FAULTS = [
    Fault("blocks: coupling of the wrong sign", DDA, seams.CONTACT_EQUATIONS, wrong_sign),
    Fault("blocks: every solve counted twenty times", DDA, seams.CONTACT_COLUMN,
          told(lambda result: {"step_solves": 20 * result.step_solves})),
    Fault("blocks: histories 2 % high", DDA, seams.CONTACT_COLUMN, larger(1.02)),
    Fault("blocks: delta 10 % high", DDA, seams.CONTACT_COLUMN, with_scheme(1, delta=lambda delta: 1.1 * delta)),
    Fault("exact columns: blocks 1e-7 heavy", EVENTS, seams.EVENTS_COLUMN, heavier("blocks", 1 + 1e-7)),
    Fault("exact columns: blocks 2 % heavy", EVENTS, seams.EVENTS_COLUMN, heavier("blocks", 1.02)),
    Fault("exact bars: 1e-6 heavy", BARS, seams.EVENTS_BARS, heavier("bars", 1 + 1e-6)),
    Fault("exact bars: joints 5 % strong", BARS, seams.EVENTS_BARS, stronger(1.05)),
]  # fmt: skip


def check(words: tuple[str, ...], faults: list[Fault], tmp: Path, finished: Path) -> None:
    """Check the kill matrix of the gates on some scenes."""
    columns = study()
    gates = [gate for gate in columns.gates() if not words or any(word in gate.scene for word in words)]
    check_kill_matrix(columns, cases_of(columns, gates), gates, faults, tmp, finished)


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path: Path, finished_cases: Path) -> None:
    check((), FAULTS, tmp_path, finished_cases)


def test_gates_of_three_scenes_are_bitten(tmp_path: Path, finished_cases: Path) -> None:
    check(SHORT, FAULTS[:3], tmp_path, finished_cases)
