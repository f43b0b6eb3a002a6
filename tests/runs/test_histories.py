"""Histories, their files and modes of a run."""

import numpy as np

from validation.runs.files import read_table, write_csv
from validation.runs.history import History
from validation.runs.modes import Mode, contact_index


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


def mode(share, *eigenvalues):
    first, second = eigenvalues or (1.0, 0.5)
    return Mode(1.0, 1.0, (complex(first), complex(second)), share)


def test_radius_and_contact_mode():
    assert mode(None, 0.3, -0.9).spectral_radius == 0.9 and mode(None, 0.6 + 0.8j, 0.1).spectral_radius == 1.0
    assert contact_index([mode(0.9), mode(0.1), mode(-0.4), mode(0.3)]) == 2
    assert contact_index([mode(0.9)]) is None and contact_index([mode(None), mode(0.1)]) is None
