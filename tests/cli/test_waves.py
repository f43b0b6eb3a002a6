"""The command `response`: its table, its figures, what it says and what it refuses."""

from pathlib import Path

import numpy as np
import pytest
from conftest import typed

from validation import load_scene, response

CASE = ["figures-3-4", "--set", "time.step=0.002"]
SCENE = load_scene("figures-3-4").with_values({"time.step": 0.002})


def said(*arguments: str) -> str:
    done = typed(*arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(("option", "exact"), [([], False), (["--exact"], True)])
def test_the_table_of_a_response_is_that_of_the_function(tmp_path: Path, option: list[str], exact: bool) -> None:
    path = tmp_path / "r.csv"
    said(
        "advise",
        "response",
        *CASE,
        "--solver",
        "bar",
        "--from",
        "2",
        "--to",
        "180",
        "--points",
        "7",
        "--csv",
        str(path),
        *option,
    )
    header, *_ = path.read_text().splitlines()
    assert header == "frequency,displacement,displacement_phase,contact_pressure,contact_pressure_phase"
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    assert np.array_equal(table, response(SCENE, np.linspace(2, 180, 7), "bar", exact).table())


@pytest.mark.long
def test_the_figure_is_written_in_each_kind_and_the_words_name_peaks_and_alias(tmp_path: Path) -> None:
    for ending in ("svg", "pdf", "png"):
        path = tmp_path / f"r.{ending}"
        text = said("advise", "response", *CASE, "--to", "300", "--points", "120", "--figure", str(path))
        assert path.stat().st_size > 5000
    assert (tmp_path / "r.pdf").read_bytes()[:4] == b"%PDF"
    assert "exact in time" in text
    assert "no step is run" in text
    assert "above 250 Hz, 1 / (2 dt), the steps see a load as its alias" in text
    assert "alias" not in said("advise", "response", *CASE, "--points", "5", "--log")
