"""Histories of other programs: what is read, and what is refused in one line."""

from pathlib import Path

import numpy as np
import pytest
from faults import seams

from validation.diagnosis import reading
from validation.diagnosis.reading import MOST_STEPS, OURS, Foreign, read, steppings
from validation.errors import InputError
from validation.solvers.history_table import HeaderNames

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "ntdda" / "ntdda-p1E-dt2ms_meas.m"


def written(tmp_path, text):
    path = tmp_path / "h.csv"
    path.write_text(text)
    return path


def test_the_measured_point_of_ntdda(tmp_path):
    found = read(EXAMPLE)
    assert len(found.time) == 200
    assert found.displacement[0] == -1.839377e-03
    assert found.displacement[-1] == -1.008814e-02
    np.testing.assert_allclose(found.steps, 0.002)
    up = np.array([0.1, -0.2, -0.3, 0.15, -0.4])
    aside = np.array([0.03, 0.05, -0.02, 0.01, 0.2])
    dt = np.array([0.5, 0.4, 0.6, 0.3, 0.7])
    rates = [np.diff(way, prepend=0.0) / dt for way in (aside, up)]
    n = np.arange(1, 6)
    for sizes, rows in ((np.abs(up), n), (np.abs(up), n[[0, 1, 3, 4]]), (np.hypot(up, aside), n)):
        table = np.array([n, np.cumsum(dt), dt, 7 + aside, 5 + up, sizes, *rates, 0 * n]).T[rows - 1]
        point = "\n".join(" ".join(map(repr, row)) for row in table.tolist())
        given = read(written(tmp_path, f"measpoint1 = [\n{point}\n];"))
        assert given.displacement == pytest.approx(up[rows - 1]) and given.sideways == pytest.approx(aside[rows - 1])
        assert given.steps is None or len(rows) == 5


def test_a_point_is_picked_by_name(tmp_path):
    text = EXAMPLE.read_text()
    both = tmp_path / "both.m"
    both.write_text(text + text.replace("measpoint1", "measpoint2").replace("1.839377e-03", "1.839900e-03"))
    assert read(both, HeaderNames({"displacement": "measpoint2"})).displacement[0] == -1.8399e-3
    with pytest.raises(InputError, match=r"'measpoint3'; .* measpoint1, measpoint2"):
        read(both, HeaderNames({"displacement": "measpoint3"}))


@pytest.mark.parametrize("separator", [";", " "])
def test_a_table_with_other_names_units_and_sign(tmp_path, separator):
    rows = [("t", "uy", "sig"), (0, 0, 0), (2, 1.5, 0.5), (4, 2.5, 1), (6, 3, 2), (8, 3.5, 2.5)]
    text = "# made elsewhere\n" + "\n".join(separator.join(map(str, row)) for row in rows)
    scale = "time=1e-3,displacement=-1e-3,contact_pressure=1e6"

    def called(names, factors=scale):
        return HeaderNames.typed(names, factors, OURS)

    found = read(written(tmp_path, text), called("time=T,displacement=uy,contact_pressure=3"))
    np.testing.assert_allclose(found.time, [0.002, 0.004, 0.006, 0.008])
    np.testing.assert_allclose(found.displacement, [-0.0015, -0.0025, -0.003, -0.0035])
    np.testing.assert_allclose(found.pressure, [0.5e6, 1e6, 2e6, 2.5e6])
    assert len(found.notes) == 1  # the row at t = 0 is ignored
    header = text.replace("t" + separator + "uy", separator.join(["time_ms", "displacement_mm"]), 1)
    of_header = read(written(tmp_path, header), called("contact_pressure=3", ""))
    without = written(tmp_path, "\n".join(text.splitlines()[2:]))
    by_number = read(without, called("time=1,displacement=2,contact_pressure=3"))
    assert by_number.displacement == pytest.approx(found.displacement)
    assert of_header.time == pytest.approx(found.time) and of_header.displacement == pytest.approx(-found.displacement)


@pytest.mark.parametrize(
    ("text", "field", "value"),
    [
        ("", None, "an empty file"),
        ("time,displacement\n1,2\n2,3\n3,4\n", None, 3),
        ("time,uy\n1,2\n2,3\n3,4\n4,5\n", "header", "time, uy"),
        ("time,displacement\n1,2\n1,3\n3,4\n4,5\n", "time", "1 in row 2"),
        ("time,displacement\n1,2\n2,nan\n3,4\n4,5\n", "displacement", "nan"),
        ("time,displacement\n1,2\n2,3\n3,4\n4,1e300\n", "displacement", "1e300"),
        ("time,displacement\n1,2\n2,3,4\n3,4\n4,5\n", None, 3),
        ("measpoint1=[\n1 2 3\n4 5 6\n];", "header", "numbers"),
    ],
)
def test_a_file_that_is_no_history(tmp_path, text, field, value):
    with pytest.raises(InputError, match=r"h\.csv") as error:
        read(written(tmp_path, text))
    assert (error.value.field, error.value.value) == (field, value)
    assert "2,3,4" not in text or str(error.value.source).endswith("h.csv:3:4")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("text", ["uy", "displacement=", "force=f", "displacement=nan", "displacement=0"])
def test_options_that_say_nothing(text):
    with pytest.raises(InputError, match="--"):
        HeaderNames.typed(*((None, text) if "=n" in text or "=0" in text else (text, None)), OURS)


def test_a_program_s_own_steps_may_begin_late():
    foreign = Foreign(0.0007 * np.arange(5, 13), np.ones(8))
    (rows,) = (one.rows for one in steppings(foreign, 0.002) if " 5" in one.note)
    np.testing.assert_array_equal(rows, np.arange(4, 12))


STEP = 0.002  # s


def at_steps(*numbers):
    return Foreign(STEP * np.array(numbers), -np.ones(len(numbers)))


FAR = {
    "1e+06": at_steps(1, 2, 3, 4, 999_999),
    "one more": at_steps(1, 2, 3, 4, MOST_STEPS + 1),
    "beyond whole numbers": at_steps(1, 2, 3, 4, 1e19),
    "beyond its square": at_steps(1, 2, 3, 4, 1e80),
    # every row a step of the program, the first one after two million of them
    "late": Foreign(7e-5 * (2_000_000 + np.arange(5.0)), -np.ones(5)),
}


@pytest.mark.parametrize("name", FAR)
def test_rows_too_many_steps_apart_are_refused(name):
    with pytest.raises(InputError, match=r" 10000 .*, got step \d+$") as caught:
        steppings(FAR[name], 7e-5 if name == "late" else STEP)
    assert caught.value.field == "time"


def test_as_many_steps_as_are_allowed_are_taken():
    assert steppings(at_steps(1, 2, 3, 4, MOST_STEPS), STEP)[0].rows[-1] == MOST_STEPS - 1


def test_too_many_rows_are_refused_before_they_are_parsed(tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "MOST_STEPS", 100)
    rows = "".join(f"{STEP * i!r},-0.001\n" for i in range(301))
    table, point = tmp_path / "table.csv", tmp_path / "point.m"
    table.write_text("time,displacement\n" + "".join(rows.splitlines(keepends=True)[:101]))
    assert len(read(table).time) == 100
    table.write_text("time,displacement\n" + rows)
    point.write_text("measpoint1 = [\n" + 199 * f"1 {STEP} {STEP} 0 1 0.001 0 -0.5 0.5\n" + "];\n")
    parsed = []
    seams.READING_COLUMNS.put(monkeypatch, lambda *rows: parsed.append(rows))
    for path, value in ((table, 302), (point, 199)):
        with pytest.raises(InputError, match=path.name) as refusal:
            read(path)
        assert refusal.value.value == value
    assert not parsed


def test_decimal_commas_beside_semicolons_are_read(tmp_path):
    path = written(tmp_path, "time;displacement\n0,1;-1,5e-3\n0,2;-2e-3\n0,3;-2,5e-3\n0,4;-3e-3\n")
    assert np.array_equal(read(path).displacement, [-1.5e-3, -2e-3, -2.5e-3, -3e-3])


def test_times_in_milliseconds_of_every_second_row_are_in_another_unit():
    (one,) = steppings(Foreign(4.0 * np.arange(1, 9), np.ones(8)), 0.002)
    assert (one.factor, one.rows.tolist()) == (1e3, list(range(1, 17, 2)))
