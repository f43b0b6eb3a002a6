"""Histories that would take hours to judge are refused in one line that names the rule and the value."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from faults import seams

from validation.diagnosis.reading import MOST_STEPS, Foreign, read, steppings
from validation.errors import InputError

STEP = 0.002  # s


def at_steps(*numbers: float) -> Foreign:
    return Foreign(STEP * np.array(numbers), -np.ones(len(numbers)))


def written(path: Path, rows: int) -> Path:
    with path.open("w") as stream:
        stream.write("time,displacement\n")
        stream.writelines(f"{STEP * i!r},-0.001\n" for i in range(rows + 1))
    return path


FAR = {
    "1e+06": at_steps(1, 2, 3, 4, 999_999),
    "one more": at_steps(1, 2, 3, 4, MOST_STEPS + 1),
    "beyond whole numbers": at_steps(1, 2, 3, 4, 1e19),
    "beyond its square": at_steps(1, 2, 3, 4, 1e80),
    # every row a step of the program, the first one after two million of them
    "late": Foreign(7e-5 * (2_000_000 + np.arange(5.0)), -np.ones(5)),
}


@pytest.mark.parametrize("name", FAR)
def test_rows_too_many_steps_apart_are_refused(name: str) -> None:
    with pytest.raises(InputError, match=r"must end within 10000 steps of (0.002|7e-05) s, got step \d+$") as caught:
        steppings(FAR[name], 7e-5 if name == "late" else STEP)
    assert caught.value.field == "time"


def test_as_many_steps_as_are_allowed_are_taken() -> None:
    assert steppings(at_steps(1, 2, 3, 4, MOST_STEPS), STEP)[0].rows[-1] == MOST_STEPS - 1


def test_uniform_rows_far_apart_are_the_program_s_own_steps() -> None:
    """A scene with a tiny step, a program with a large one: two hundred steps, not two million."""
    found = steppings(Foreign(0.02 * np.arange(1, 201), -np.ones(200)), 1e-6)
    assert [len(s.steps) for s in found] == [200]


def test_too_many_rows_are_refused_before_they_are_parsed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read(written(tmp_path / "most.csv", MOST_STEPS))
    path = written(tmp_path / "more.csv", 3 * MOST_STEPS)
    parsed = []
    seams.READING_NUMBERS.put(monkeypatch, lambda row: parsed.append(row) or [0.0, 0.0])
    with pytest.raises(InputError, match=r"more.csv: must hold at most 10000 rows, got 30002; cut it, or keep"):
        read(path)
    assert not parsed


def test_a_measured_point_of_so_many_rows_is_refused_too(tmp_path: Path) -> None:
    path = tmp_path / "long.m"
    rows = "\n".join(f"{i} {STEP * i} {STEP} 0 1 0.001 0 -0.5 0.5" for i in range(1, 2 * MOST_STEPS))
    path.write_text(f"measpoint1 = [\n{rows}\n];\n")
    with pytest.raises(InputError, match="must hold at most 10000 rows, got 19999"):
        read(path)
