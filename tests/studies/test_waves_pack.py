"""The part of the reference pack on waves: numbers of an independent computation, scenes with their histories."""

import math
from pathlib import Path

import numpy as np
import pytest

from validation import load_scene, solve
from validation.runs.files import read_csv
from validation.studies.waves import pack

TRAVEL = [  # alpha, delta, gg, courant, blocks, glue; error of the speed and share left, to the digits of the source
    ((0.5, 1.0, 1.0, 0.25, 8, math.inf), 2.4860e-2, 0.056535),
    ((0.25, 0.5, 1.0, 1.0, 10, math.inf), -1.6599e-2, 1.0),
    ((0.5, 1.0, 1.0, 0.5, 10, 1.0), -2.8691e-1, 0.001071),
    ((0.5, 1.0, 1.0, 0.1, 100, math.inf), 1.6486e-4, 0.906062),
    ((0.25, 0.5, 0.99, 0.25, 20, math.inf), None, 0.018886548),
]


def test_tables_hold_the_numbers_of_an_independent_computation() -> None:
    names = ("alpha", "delta", "gg", "courant", "blocks", "glue")
    rows = {tuple(row[name] for name in names): row for row in pack.travel()}
    for key, speed, left in TRAVEL:
        assert rows[key]["left"] == pytest.approx(left, abs=6e-7)
        assert speed is None or rows[key]["speed_error"] == pytest.approx(speed, rel=6e-5)
    found = {(r["alpha"], r["courant"], r["blocks"], r["joint"]): r["transmitted"] for r in pack.joints()}
    assert found[0.25, 0.5, 10, 1.0] == pytest.approx(0.895981, abs=6e-7)
    assert found[0.5, 0.1, 40, 1.0] == pytest.approx(0.893212, abs=6e-7)
    back = {(r["alpha"], r["courant"], r["blocks"], r["impedance"]): r["reflected"] for r in pack.bases()}
    assert back[0.25, 0.1, 100, 2.0] == pytest.approx(1 / 3, rel=2e-3)  # (z - rho c) / (z + rho c)
    assert back[0.25, 0.1, 100, 1.0] < 1e-3


@pytest.mark.long
def test_the_pack_is_whole_and_its_scenes_give_its_histories(tmp_path: Path) -> None:
    count = pack.write_waves_pack(tmp_path)
    place = tmp_path / "waves"
    texts = [(place / f"{name}.csv").read_text().splitlines() for name in ("waves", "joints", "bases", "response")]
    assert count == sum(len(text) - 1 for text in texts) > 1000
    for path in sorted((place / "scenes").glob("*.toml")):
        scene = load_scene(path)
        for solver in ("dda", "layers") if scene.input.record else ("dda",):
            kept = read_csv(place / "histories" / f"{path.stem}.{solver}.csv")
            asked = scene.with_values({"run.columns": list(kept.columns)})
            for name, values in solve(asked, solver).history.columns.items():
                assert np.array_equal(values, kept.columns[name]), (path, name)
        assert str(tmp_path) not in path.read_text()
