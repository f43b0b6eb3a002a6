"""The command `response`: its table, its figures, what it says and what it refuses."""

from pathlib import Path

import numpy as np
import pytest
from conftest import refused, typed

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
        "response", *CASE, "--solver", "bar", "--from", "2", "--to", "180", "--points", "7", "--csv", str(path), *option
    )
    header, *_ = path.read_text().splitlines()
    assert header == "frequency,displacement,displacement_phase,contact_pressure,contact_pressure_phase"
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    assert np.array_equal(table, response(SCENE, np.linspace(2, 180, 7), "bar", exact).table())


def test_the_highest_peaks_are_printed_under_their_quantity_and_the_alias_is_noted_beyond_half_the_sampling() -> None:
    options = ["--from", "1", "--to", "200", "--points", "200"]
    lines = said("response", *CASE, *options).splitlines()
    for label, exact in (("as stepped", False), ("exact in time", True)):
        found = response(SCENE, np.linspace(1, 200, 200), "dda", exact)
        ((f, moved), *_), ((g, pressed), *_) = found.peaks("displacement"), found.peaks("contact_pressure")
        first = next(line for line in lines if line.startswith(label))
        assert first.split()[-4:] == [f"{value:.6g}" for value in (f, moved, g, pressed)]
    assert lines[1].split() == ["peak", "[Hz]", "displacement", "[m]", "peak", "[Hz]", "contact", "pressure", "[Pa]"]
    assert not [line for line in lines if line.startswith("note")]
    (note,) = [line for line in said("response", *CASE, "--to", "251", "--points", "2").splitlines() if "note" in line]
    assert "above 250 Hz, 1 / (2 dt)" in note


def test_the_least_ratio_of_a_step_is_told_in_per_cent_at_its_frequency_in_hertz() -> None:
    rows = [line.split() for line in said("rayleigh", "--dt", "0.01", "--gg", "0.99").splitlines()]
    (leading,) = [row[2:] for row in rows if row[:2] == ["leading", "order"]]
    a0, a1 = 2 * 0.01 / 1.99 / 0.01, 0.5 * 0.01
    least, at = 100 * np.sqrt(a0 * a1), np.sqrt(a0 / a1) / (2 * np.pi)
    assert [float(cell) for cell in leading] == pytest.approx([a0, a1, least, at], rel=1e-5)


@pytest.mark.long
def test_the_figure_is_written_in_each_kind_and_the_words_name_peaks_and_alias(tmp_path: Path) -> None:
    for ending in ("svg", "pdf", "png"):
        path = tmp_path / f"r.{ending}"
        text = said("response", *CASE, "--to", "300", "--points", "120", "--figure", str(path))
        assert path.stat().st_size > 5000
    assert (tmp_path / "r.pdf").read_bytes()[:4] == b"%PDF"
    assert "exact in time" in text
    assert "no step is run" in text
    assert "above 250 Hz, 1 / (2 dt), the steps see a load as its alias" in text
    assert "alias" not in said("response", *CASE, "--points", "5", "--log")


@pytest.mark.parametrize(
    ("options", "rule"),
    [
        (["--from", "10", "--to", "1"], "--from, --to: must be finite, not negative and in this order"),
        (["--from", "-1"], "--from, --to"),
        (["--from", "0", "--log"], "--from: must be greater than 0 with --log"),
        (["--figure", "r.txt"], "--figure: must end in .svg, .pdf, .png, got 'r.txt'"),
        (["--solver", "fenicsx"], "no frequency response is reported"),
    ],
)
def test_what_a_response_refuses(options: list[str], rule: str) -> None:
    assert rule in refused("response", *CASE, *options)


def test_rayleigh_translates_a_step_and_back(tmp_path: Path) -> None:
    text = said("rayleigh", "--dt", "0.01", "--from", "5", "--to", "20")
    words = [line.split() for line in text.splitlines()]
    assert "dt = 0.01 s, (alpha, delta) = (0.5, 1), gg = 1 hides the Rayleigh damping" in text
    assert ["leading", "order", "0", "0.005", "-", "-"] in words
    assert ["5", "7.8459", "7.854"] in words
    tables = said("rayleigh", *CASE, "--set", "damping.mass=3.0")
    assert "the scene's own damping tables, a0 = 3 1/s and a1 = 0 s, come on top" in tables
    adaptive = said("rayleigh", *CASE, "--set", "damping.kinetic=adaptive")
    assert "self-adaptive damping, which no a0 and a1 can express, comes on top" in adaptive
    assert "gg = 0.98 hides" in said("rayleigh", *CASE, "--gg", "0.98")
    path = tmp_path / "xi.svg"
    back = said("rayleigh", "--dt", "0.001", "--ratio", "5=0.05", "--ratio", "50=0.05", "--figure", str(path))
    assert "to leading order: dt = 0.000578745 s" in back
    assert "exactly at both frequencies: dt = 0.000578506 s" in back
    assert path.stat().st_size > 5000
    assert "dt = 0.004 s" in said("rayleigh", "--dt", "1", "--a1", "0.002")
    edge = said("rayleigh", "--dt", "1", "--ratio", "5=0.005", "--ratio", "50=0.05")
    assert "within 0.021 % at both frequencies: dt = 0.0006367" in edge
    none = said("rayleigh", "--dt", "1", "--ratio", "5=0.05", "--ratio", "50=0.5")
    assert "exactly: damping: no scheme" in none


def test_rayleigh_finds_the_scheme_of_ratios_that_none_has_to_leading_order() -> None:
    ratios = ("--ratio", "50=0.046", "--ratio", "100=0.989")
    text = said("rayleigh", "--dt", "1", "--alpha", "1", "--delta", "0.6", *ratios)
    assert "to leading order: none (damping: to leading order in w dt no scheme hides a negative mass part" in text
    assert "exactly at both frequencies: dt = 0.00199827 s" in text
    assert "no scheme with dt = 0.002 s" in refused("rayleigh", "--dt", "0.002", "--keep-dt", *ratios)
