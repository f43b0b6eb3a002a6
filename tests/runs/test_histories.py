"""Histories, their files and modes of a run."""

import numpy as np

from validation.runs.files import read_table, write_csv
from validation.runs.history import History


def test_a_history_is_written_to_the_last_bit(tmp_path):
    rng = np.random.default_rng(0)
    history = History(
        np.arange(1.0, 9.0) / 3, {"displacement": rng.standard_normal(8) * 1e-7, "rotation": 1 / rng.random(8)}
    )
    write_csv(history, tmp_path / "h.csv")
    names, rows = read_table(tmp_path / "h.csv")
    assert names == ["time", "displacement", "rotation"]
    assert np.array_equal(rows.T, [history.time, *history.columns.values()])
    assert (tmp_path / "h.csv").read_text().startswith("time,displacement,rotation\n")
