"""The part of the reference pack on contact that opens: whole, and right to the uncertainties that it states."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from oracles.pages import table

from validation import load_scene, solve
from validation.runs.files import read_csv
from validation.studies import opening
from validation.studies.contact.pack import write_contact_pack
from validation.studies.pack import slug

pytestmark = pytest.mark.long  # the motions themselves are gates
Numbers = dict[tuple[str, str, str], tuple[float, float]]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("pack")
    count = write_contact_pack(directory)
    assert count == len(table(directory / "contact/numbers.csv")) > 200
    return directory / "contact"


@pytest.fixture(scope="module")
def numbers(place: Path) -> Numbers:
    rows = table(place / "numbers.csv")
    return {(r["scene"], r["motion"], r["quantity"]): (float(r["value"]), float(r["uncertainty"])) for r in rows}


def test_the_numbers_are_those_of_the_independent_program(numbers: Numbers) -> None:
    """The bands of the gates on the exact motions are these numbers, to half a unit of their last digits."""
    step = {case.name: case.time.step for case in load_scene(opening.SCENE).expand()}
    compared = 0
    for gate in opening.OPENING.gates():
        kind = gate.pair[0].partition("-")[0].partition(" ")[0]
        quantity, _, part = gate.metric.partition(".")
        if gate.scene not in step or len(gate.pair) == 2:
            continue
        if part.isdigit():
            column = {"displacement": "displacement", "pressure": "contact_pressure"}[quantity]
            part = f"{column} at {step[gate.scene] * int(part)!r} s"
        value, uncertainty = numbers[slug(gate.scene), f"{kind}-events", part]
        assert gate.low - uncertainty <= value <= gate.high + uncertainty, gate.id
        compared += 1
    assert compared == 61


def test_every_number_states_an_uncertainty_of_its_size(numbers: Numbers) -> None:
    assert all(u >= 1e-13 * abs(value) for value, u in numbers.values())
    assert all(u <= 1e-11 * abs(value) for (_, _, what), (value, u) in numbers.items() if "pressure" not in what)


def test_impacts_state_their_restitution(numbers: Numbers) -> None:
    kept = {key[1]: value for key, (value, _) in numbers.items() if key[2] == "restitution" and "1e+09" in key[0]}
    assert kept == pytest.approx({"block-events": 0.930732420604, "bar-events": 0.975858485361}, abs=1e-11)
    assert not [key for key in numbers if key[2] == "restitution" and not key[0].startswith("impact")]


def test_the_map_holds_its_closed_forms(place: Path) -> None:
    rows = [{name: float(value) for name, value in row.items()} for row in table(place / "restitution.csv")]
    stiff = [row for row in rows if row["omega"] == math.inf]
    for row in stiff:
        if (row["alpha"], row["delta"]) == (0.5, 1.0):
            assert row["restitution"] == pytest.approx(abs(2 * row["theta"] - 1), abs=1e-12)
        if (row["alpha"], row["delta"]) == (0.25, 0.5):
            expected = max(3 - 8 * row["theta"], 4 * row["theta"] - 1)
            assert row["restitution"] == pytest.approx(expected, abs=1e-12)
    two = {row["delta"]: row["restitution"] for row in rows if row["omega"] == 2.0 and row["alpha"] in (0.5, 0.25)}
    assert two == pytest.approx({1.0: 1 / 3, 0.5: 1.0}, abs=1e-12)


def test_the_scenes_give_the_histories(place: Path) -> None:
    paths = sorted((place / "histories").iterdir())
    assert {path.name.split(".")[-2] for path in paths} == {"block-events", "bar-events"}
    for path in paths[::5]:
        stem, motion = path.name.removesuffix(".csv").rsplit(".", 1)
        scene = load_scene(place / "scenes" / f"{stem}.toml")
        kept, run = read_csv(path), solve(scene, motion)
        assert np.array_equal(kept.displacement, run.displacement), path
        assert (kept.columns["normal_force_m"] >= 0).all() and "gap_m" in kept.columns
    readme = (place / "README.md").read_text()
    assert all(word in readme for word in ("numbers.csv", "restitution.csv", "uncertainty", "theta"))
