"""The part of the reference pack on contact that slips: whole, and right to the uncertainties that it states."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from oracles.pages import table

from validation import load_scene, solve
from validation.runs.files import read_csv
from validation.runs.modes import Switch
from validation.studies.contact import slipping_pack
from validation.studies.contact.slipping_pack import CASES, HALF, slipping_cases, write_slipping_pack

pytestmark = pytest.mark.long  # the motions themselves are tested in the short set
# As an independent program printed them: an event-driven integrator at two tolerances, twelve digits.
SWITCHES = {
    "glued": "N closes 0.00239892830043, M closes 0.00407094907289, N opens 0.0162914098796, M opens 0.0163443864827, "
    "N closes 0.0189476329529",
    "off-centre": "N closes 0.00239892830043, M closes 0.00407094907289, M slips 0.00745377531356, "
    "M sticks 0.00793488628924, M slips 0.0157425143698, N slips 0.0159420213648, N opens 0.0163181298089, "
    "M opens 0.0163241226119",
    "sideways": "N closes 0.00283945305465, M closes 0.00386752417274, M slips 0.00601093182843, "
    "M sticks 0.00703740618764, M slips 0.00938196465955, M opens 0.0124246870787",
    "incline": "M slips 0.0117360653442, N slips 0.014596773248, M opens 0.01461062328, N opens 0.0186019905401, "
    "M closes 0.0193636210678",
}
AT_THE_END = {
    "glued": (5.3825976780e-4, -1.262046085987e-2, -2.464006670949e-3),
    "off-centre": (-3.680080923643e-4, -1.251962754476e-2, -1.923369471946e-3),
    "sideways": (5.135338437750e-2, -8.977369811162e-3, -1.753606771872e-2),
    "incline": (8.660335668094e-4, -9.241387969921e-5, -5.024326498383e-5),
}
CREEP = {0.1: 1.790e-3, 0.2: 3.732e-3, 0.3: 5.532e-3, 0.4: 7.394e-3}  # m


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("pack")
    count = write_slipping_pack(directory)
    names = ("numbers", "enclosures", "newmark", "rocking")
    assert count == sum(len(table(directory / f"friction/{name}.csv")) for name in names) > 150
    return directory / "friction"


@pytest.fixture(scope="module")
def numbers(place: Path) -> dict[str, dict[str, tuple[float, float]]]:
    found: dict[str, dict[str, tuple[float, float]]] = {name: {} for name in CASES}
    for row in table(place / "numbers.csv"):
        found[row["scene"]][row["quantity"]] = float(row["value"]), float(row["uncertainty"])
    return found


def test_every_switch_is_enclosed(place: Path) -> None:
    rows = table(place / "enclosures.csv")
    assert {row["scene"] for row in rows} == set(CASES)
    for row in rows:
        assert 0 < float(row["radius"]) < 1e-25
    for name, printed in SWITCHES.items():
        known = [one.split() for one in printed.split(", ")]
        first = [row for row in rows if row["scene"] == name and float(row["midpoint"]) > 1e-4][: len(known)]
        assert [[row["corner"], row["kind"]] for row in first] == [one[:2] for one in known]
        assert [float(row["midpoint"]) for row in first] == pytest.approx([float(one[2]) for one in known], abs=6e-14)


def test_switches_and_values_are_those_of_the_independent_program(
    numbers: dict[str, dict[str, tuple[float, float]]],
) -> None:
    for name, said in SWITCHES.items():
        for n, (corner, kind, time) in enumerate((one.split() for one in said.split(", ")), start=1):
            value, uncertainty = numbers[name][f"switch {n}: {corner} {kind}"]
            # half a unit of the last of twelve digits, and what that integration is good for
            assert abs(value - float(time)) <= uncertainty + 6e-14
        end = max((key for key in numbers[name] if key.startswith("rotation")), key=len).split(" at ")[1]
        for column, expected in zip(
            ("horizontal_displacement", "displacement", "rotation"), AT_THE_END[name], strict=True
        ):
            assert numbers[name][f"{column} at {end}"][0] == pytest.approx(expected, rel=5e-11)


def test_stable_blocks_creep_as_an_independent_program_found(
    numbers: dict[str, dict[str, tuple[float, float]]],
) -> None:
    mean = {name: shifts(rows) for name, rows in numbers.items() if name.startswith("creep")}
    assert mean["creep"] == pytest.approx(CREEP, abs=6e-7)
    for name, rate in (("creep-low-friction", 27.3e-3), ("creep-stiff-shear", 20.6e-3)):
        assert (mean[name][0.4] - mean[name][0.1]) / 0.3 == pytest.approx(rate, abs=5e-5)


def shifts(rows: dict[str, tuple[float, float]]) -> dict[float, float]:
    """The mean slide by the instant."""
    said = {
        key.removeprefix("mean slide at "): value for key, (value, _) in rows.items() if key.startswith("mean slide")
    }
    return {float(time.removesuffix(" s")): value for time, value in said.items()}


def test_every_number_states_an_uncertainty_of_its_size(numbers: dict[str, dict[str, tuple[float, float]]]) -> None:
    for rows in numbers.values():
        assert all(0 < u < 1e-10 * abs(value) + 1e-12 for value, u in rows.values())


def test_the_scenes_give_the_histories(place: Path) -> None:
    for scene in slipping_cases():
        assert (place / "histories" / f"{scene.name}.block-events.csv").is_file()
    scene = load_scene(place / "scenes/incline.toml").with_values({"run.columns": ["displacement", "slide_m"]})
    again = solve(scene, "block-events").history
    assert np.array_equal(
        again.columns["slide_m"], read_csv(place / "histories/incline.block-events.csv").columns["slide_m"]
    )


def test_rigid_blocks(place: Path) -> None:
    for row in table(place / "newmark.csv"):
        assert abs(float(row["slide"])) <= float(row["slip"]) + 1e-12
        assert row["two_way"] == "1" or float(row["slide"]) == pytest.approx(float(row["slip"]))
    small = [
        row
        for row in table(place / "rocking.csv")
        if row["quantity"] == "quarter period [s]" and float(row["at"]) < 1e-3
    ]
    for row in small:  # sqrt(2 tilt I / (m g a / 2)), I / m = (a^2 + h^2) / 3, but for the tilt over alpha
        a, h, tilt = (float(row[name]) for name in ("width", "height", "at"))
        assert float(row["value"]) == pytest.approx(math.sqrt(4 * tilt * (a * a + h * h) / 3 / (9.81 * a)), rel=2e-3)
    assert len(small) == 3
    assert 26.56 < HALF < 26.57
    readme = (place / "README.md").read_text()
    assert all(word in readme for word in ("numbers.csv", "newmark.csv", "rocking.csv", "uncertainties", "creep"))


@pytest.mark.parametrize(
    ("opens", "slips", "word"),
    [(True, None, "opens"), (False, None, "closes"), (None, True, "slips"), (None, False, "sticks")],
)
def test_a_switch_is_called_by_what_its_corner_begins_to_do(opens: bool | None, slips: bool | None, word: str) -> None:
    assert slipping_pack.kind(Switch(0.1, "first", opens, slips)) == word
