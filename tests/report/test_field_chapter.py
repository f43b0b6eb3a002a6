"""The chapter of the judged field: every word and number of a cell reaches the page, and nothing else does."""

from __future__ import annotations

from dataclasses import replace

from validation.report.blocks import Table as Shown
from validation.report.chapters.data import spoken_of
from validation.studies.field import chapter
from validation.studies.field.chapter import counted
from validation.studies.field.marks import absent_of, installed_of
from validation.studies.field.table import FAIL, NOT_APPLICABLE, NOT_RUN, PARTIAL, PASS, Cell, ProblemLine, ProgramLine
from validation.studies.field.table import FieldTable as Field

PROBLEMS = tuple(ProblemLine(name, f"field-{name}", name, f"What of {name}?") for name in ("locked", "rocking"))
PROGRAMS = (
    ProgramLine("dda", "DDA by habit", "", "suite", True, {"model": "one strain", "settings": "alpha = 1/2"}),
    ProgramLine("one", "One", "pip install one", "chosen", True, {"version": "1.5", "model": "m", "settings": "s"}),
    ProgramLine("one-default", "One, as it comes", "", "default", True, {}),
    ProgramLine("two", "Two", "pip install two", "chosen", False, {}),
)
SAYS = "the solver says that it is not made for this scene: "


def cells() -> dict[tuple[str, str], Cell]:
    found = [
        Cell("locked", "dda", FAIL, FAIL, "numerical damping", "displacement", 0.5128, 0.0574, 0.006, 0.5),
        Cell("rocking", "dda", PASS, PASS, "", "rotation", 3.2e-6, 0.0146, 0.4, 0.25),
        Cell("locked", "one", PASS, PASS, "", "displacement", 0.00123, 0.0574, 0.1, 1.5),
        Cell("rocking", "one", NOT_APPLICABLE, NOT_APPLICABLE, reason=f"{SAYS}it does not turn"),
        Cell("locked", "one-default", FAIL, FAIL, "not explained", "displacement", 12.0, 0.0574, 0.0123456, 1.0),
        Cell("rocking", "one-default", FAIL, FAIL, "wrong units: mm?"),
        Cell("locked", "two", NOT_RUN, NOT_RUN, reason="not installed: pip install two"),
        Cell("rocking", "two", NOT_RUN, NOT_RUN, reason="not installed: pip install two"),
    ]
    return {(cell.problem, cell.program): cell for cell in found}


FIELD = Field(PROBLEMS, PROGRAMS, cells())


def by_problem(field: Field) -> Shown:
    return chapter.by_problem(field, installed_of(field, field.programs))


def failures(field: Field) -> Shown:
    return chapter.failures(field, installed_of(field, field.programs))


def absent(field: Field) -> Shown:
    return absent_of(field, installed_of(field, field.programs))


def programs(field: Field) -> Shown:
    return chapter.programs(installed_of(field, field.programs))


def test_the_table_has_a_cell_for_every_program_that_ran() -> None:
    table = by_problem(FIELD)
    assert [column.title for column in table.columns] == ["Program", "locked", "rocking", "Time [s]"]
    assert table.rows == (
        ("allowed [%]", "5.7", "1.5", ""),
        ("DDA by habit", "FAIL 51", "PASS < 0.001", "0.75"),
        ("One", "PASS 0.12", "n. a.", "1.5"),
        ("One, as it comes", "FAIL > 1000", "FAIL", "1"),
    )
    assert [column.kind for column in table.columns] == ["text", "outcome", "outcome", "decimal"]
    assert table.notes[-1] == "Not installed: Two."


def test_what_is_allowed_is_the_band_that_decides_most_often() -> None:
    other = cells() | {("locked", "two"): Cell("locked", "two", FAIL, FAIL, "damped", "rotation", 0.5, 0.02, 0.1, 1.0)}
    assert by_problem(Field(PROBLEMS, PROGRAMS, other)).rows[0] == ("allowed [%]", "5.7", "1.5", "")
    other["locked", "two"] = replace(other["locked", "two"], band=0.2)  # neither the smallest nor the largest
    assert by_problem(Field(PROBLEMS, PROGRAMS, other)).rows[0] == ("allowed [%]", "5.7", "1.5", "")


def test_causes_and_reasons_stand_with_program_and_problems() -> None:
    assert failures(FIELD).rows == (
        ("DDA by habit", "locked", "numerical damping"),
        ("One, as it comes", "locked (0.0123 s)", "not explained"),
        ("", "rocking", "wrong units: mm?"),
    )
    assert "at half the step" in failures(FIELD).notes[0]
    assert absent(FIELD).rows == (("One", "rocking", "it does not turn"),)
    alike = {key: cell if cell.verdict != FAIL else Cell(*key, FAIL, FAIL, "damped") for key, cell in cells().items()}
    told = failures(Field(PROBLEMS, PROGRAMS, alike))
    assert ("One, as it comes", "all", "damped") in told.rows and not told.notes


def test_a_run_that_raised_an_error_is_told_without_its_place() -> None:
    raised = Cell("rocking", "one", NOT_RUN, NOT_RUN, reason="Stopped: no balance at t = 0 s (a/b.py:21, in _step)")
    found = Field(PROBLEMS, PROGRAMS, cells() | {("rocking", "one"): raised})
    assert absent(found).rows == (("One", "rocking", "no answer: Stopped: no balance at t = 0 s"),)


def test_pages_speak_of_the_scenes_that_cells_are_of() -> None:
    own = {"title": "", "solver": "dda", "key": "", "definition": {}}
    records = [own | {"scene": name} for name in ("a", "a changed")]
    runs = {"a dda": [["a", "dda"], "judged dda"]}
    assert [r["scene"] for r in spoken_of({"study": "field", "cases": records, "data": {"runs": runs}})] == ["a"]
    assert spoken_of({"study": "mine", "cases": records}) == records
    assert spoken_of({"study": "field", "cases": records, "data": {"runs": "damaged"}}) == records


def test_programs_say_what_they_are() -> None:
    table: Shown = programs(FIELD)
    assert table.rows[1] == ("One", "1.5", "m", "s")
    one, beside = ({"program": "One", "version": "1.5", "model": "m", "settings": s} for s in ("fine", "as it comes"))
    alike = (replace(PROGRAMS[1], about=one), replace(PROGRAMS[2], about=beside))
    assert programs(Field(PROBLEMS, alike, cells())).rows == (
        ("One", "1.5", "m", "fine"),
        ("One, as it comes", "", "the same", "as it comes"),
    )
    assert [row[0] for row in table.rows] == ["DDA by habit", "One", "One, as it comes"]
    stranger = (alike[0], replace(alike[1], about=beside | {"program": "Other", "version": "7"}))
    assert programs(Field(PROBLEMS, stranger, cells())).rows[1] == ("One, as it comes", "7", "m", "as it comes")


def test_the_sentence_counts_other_peoples_programs_only() -> None:
    assert counted(FIELD) == (
        "Other programs: 1, with 3 answers to 2 problems. Of these 1 pass and 2 fail, 1 of them with a cause that is "
        "certain."
    )
    late = cells() | {("rocking", "one"): Cell("rocking", "one", FAIL, FAIL, "late", "rotation", 0.5, 0.1, 0.1, 1.0)}
    assert "1 pass and 3 fail, 2 of them with a cause" in counted(Field(PROBLEMS, PROGRAMS, late))
    alone = Field(PROBLEMS, PROGRAMS[:1], {key: cell for key, cell in cells().items() if key[1] == "dda"})
    assert counted(alone).startswith("No other program is installed here")


def test_a_program_that_gave_no_answer_is_installed_all_the_same() -> None:
    """Each of its runs raised; it is not told to be missing, and why it has no answer is."""
    raised = {
        key: c if key[1] != "one" else Cell(*key, NOT_RUN, NOT_RUN, reason="raised") for key, c in cells().items()
    }
    field = Field(PROBLEMS, PROGRAMS, raised)
    assert ("One", "–", "–", "–") in by_problem(field).rows
    assert by_problem(field).notes[-1] == "Not installed: Two."
    away = {
        k: c if k[1] != "one" else Cell(*k, NOT_RUN, NOT_RUN, reason="it is not installed") for k, c in raised.items()
    }
    assert by_problem(Field(PROBLEMS, PROGRAMS, away)).notes[-1] == "Not installed: One, Two."


def test_a_program_whose_adapter_refuses_a_problem_before_it_looks_for_it_is_missing_all_the_same() -> None:
    """As Siconos as it comes: two problems are not applicable, of the rest it says that it is not installed."""
    missing = Cell("locked", "one", NOT_RUN, NOT_RUN, reason="Siconos is not installed: apt-get")
    refused = Cell("rocking", "one", NOT_APPLICABLE, NOT_APPLICABLE, reason="no stiffness")
    away = cells() | {("locked", "one"): missing, ("rocking", "one"): refused}
    assert by_problem(Field(PROBLEMS, PROGRAMS, away)).notes[-1] == "Not installed: One, Two."
    for other in (replace(missing, reason="raised"), replace(missing, verdict=PASS, reason="")):
        found = Field(PROBLEMS, PROGRAMS, away | {("locked", "one"): other})
        assert by_problem(found).notes[-1] == "Not installed: Two."


def test_an_answer_that_withholds_a_column_passes_in_part() -> None:
    partial = Cell("locked", "one", PARTIAL, "PARTIAL: ...", "", "displacement", 0.00123, 0.0574, 0.1, 1.5)
    found = Field(PROBLEMS, PROGRAMS, cells() | {("locked", "one"): partial})
    assert by_problem(found).rows[2] == ("One", "PARTIAL 0.12", "n. a.", "1.5")
    assert "Of these 0 pass and 1 in part (a column is withheld) and 2 fail" in counted(found)
