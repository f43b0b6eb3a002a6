"""The command `response`: its table, its figures, what it says and what it refuses."""

import numpy as np
import pytest
from conftest import typed

from validation import load_scene, response

CASE = ["figures-3-4", "--set", "time.step=0.002"]
SCENE = load_scene("figures-3-4").with_values({"time.step": 0.002})


def said(*arguments):
    done = typed(*arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(("option", "exact"), [([], False), (["--exact"], True)])
def test_the_table_of_a_response_is_that_of_the_function(tmp_path, option, exact):
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
