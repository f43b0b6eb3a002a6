"""Every gate of the study of waves is bitten: seeded faults in blocks, springs, dashpot, steps and the exact layers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from faults import seams
from faults.fault import Fault, late, thousandth, times, with_scheme
from faults.kill_matrix import cases_of, check_kill_matrix

from validation.studies.waves.study import study

SHORT = ("waves-blocks[time.alpha=0.5,time.delta=1,time.step=0.001", "waves-glue[column.glue=2e+10")


def a_hair_more(prop: property) -> property:
    """Change a property by one in ten million."""
    return property(lambda self: prop.fget(self) * (1 + 1e-7))  # type: ignore[misc]


def deeper(sound: Callable[..., object]) -> Callable[..., object]:
    """Take a layer's depth one per cent too large."""
    return lambda modulus, density, depth, w2, state: sound(modulus, density, 1.01 * depth, w2, state)


def slower(sound: Callable[..., tuple[np.ndarray, np.ndarray]]) -> Callable[..., tuple[np.ndarray, np.ndarray]]:
    """Forget the kinetic discount in the displacement, of the two formulas that have it."""

    def faulty(scheme: object, D: np.ndarray, V: np.ndarray, A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        displaced, moving = sound(scheme, D, V, A)
        return displaced + (1 - scheme.gg) * scheme.step * V, moving  # type: ignore[attr-defined]

    return faulty


FAULTS = [
    Fault("blocks: inertia 1e-7 heavy", ("dda",), seams.COLUMN_INERTIA, times(1 + 1e-7)),
    Fault("blocks: stiffness 1e-7 high", ("dda",), seams.COLUMN_STIFFNESS, times(1 + 1e-7)),
    Fault("springs: 1e-6 stiff", ("dda",), seams.COLUMN_SPRINGS, times(1 + 1e-6)),
    Fault("springs: 0.1 % soft", ("dda",), seams.COLUMN_SPRINGS, times(0.999)),
    Fault("base: dashpot 1e-7 strong", ("dda",), seams.COLUMN_BASE, a_hair_more),
    Fault("steps: delta 0.1 % high in the matrix", ("dda",), seams.COLUMN_EFFECTIVE, with_scheme(0, delta=thousandth)),
    Fault("steps: delta 0.1 % high", ("dda",), seams.COLUMN_PREDICTORS, with_scheme(0, delta=thousandth)),
    Fault("steps: gg in one formula of two", ("dda",), seams.COLUMN_PREDICTORS, slower),
    Fault("steps: one late", ("dda",), seams.COLUMN_RUN, late),
    Fault("steps: 2 % high", ("dda",), seams.COLUMN_RUN, times(1.02)),
    Fault("fem: delta 0.1 % high", ("fem",), seams.FEM_VELOCITY, with_scheme(2, delta=thousandth)),
    Fault("fem: joints 1e-6 stiff", ("fem",), seams.LINE_SPRINGS, times(1 + 1e-6)),
    Fault("fem: one step late", ("fem",), seams.LINE_HISTORIES, late),
    Fault("fem: 2 % high", ("fem",), seams.LINE_HISTORIES, times(1.02)),
    Fault("layers: one per cent deep", ("layers",), seams.LAYERS_THROUGH, deeper),
]


def check(words: tuple[str, ...], faults: list[Fault], tmp: Path, finished: Path) -> None:
    """Check the kill matrix of the gates on some scenes."""
    waves = study()
    gates = [g for g in waves.gates() if not words or any(word in g.scene for word in words)]
    check_kill_matrix(waves, cases_of(waves, gates), gates, faults, tmp, finished)


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path: Path, finished_cases: Path) -> None:
    check((), FAULTS, tmp_path, finished_cases)


def test_gates_of_two_scenes_are_bitten(tmp_path: Path, finished_cases: Path) -> None:
    faults = [FAULTS[0], FAULTS[2], FAULTS[6]]
    check(SHORT, faults, tmp_path, finished_cases)
