"""The chapter of the judged field: every word and number of a cell reaches the page, and nothing else does."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from validation.report.blocks import Paragraph
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


def changed(*others: Cell) -> Field:
    """Return the field with other cells in their places."""
    return Field(PROBLEMS, PROGRAMS, cells() | {(cell.problem, cell.program): cell for cell in others})


def test_the_chapter_says_what_cells_hold_and_nothing_else(kept: Any) -> None:
    """The band that decides most often, causes alike, errors raised, programs that are missing or withhold a column."""
    rotated = Cell("locked", "two", FAIL, FAIL, "damped", "rotation", 0.5, 0.02, 0.1, 1.0)
    alike = [Cell(*key, FAIL, FAIL, "damped") for key, cell in cells().items() if cell.verdict == FAIL]
    place = "Stopped: no balance at t = 0 s (a/b.py:21, in _step)"
    raised = [Cell(name, "one", NOT_RUN, NOT_RUN, reason=place) for name in ("locked", "rocking")]
    words = ("One is not installed: apt-get", "it is not installed")
    away = [replace(cell, reason=reason) for cell, reason in zip(raised, words, strict=True)]
    refused = Cell("rocking", "one", NOT_APPLICABLE, NOT_APPLICABLE, reason="no stiffness")
    partial = Cell("locked", "one", PARTIAL, "PARTIAL: ...", "", "displacement", 0.00123, 0.0574, 0.1, 1.5)
    late = Cell("rocking", "one", FAIL, FAIL, "late", "rotation", 0.5, 0.1, 0.1, 1.0)
    alone = Field(PROBLEMS, PROGRAMS[:1], {key: cell for key, cell in cells().items() if key[1] == "dda"})
    one, beside = ({"program": "One", "version": "1.5", "model": "m", "settings": s} for s in ("fine", "as it comes"))
    same = (replace(PROGRAMS[1], about=one), replace(PROGRAMS[2], about=beside))
    stranger = (same[0], replace(same[1], about=beside | {"program": "Other", "version": "7"}))
    kept("field", [table(FIELD) for table in (by_problem, failures, absent, programs)])
    missing = (
        changed(*raised),
        changed(*away),
        changed(away[0], refused),
        changed(raised[0], refused),
        changed(replace(away[0], verdict=PASS, reason=""), refused),
    )
    lines = [(0, changed(rotated)), (0, changed(replace(rotated, band=0.2)))]
    lines += [(2, changed(*raised)), (2, changed(partial))]
    kept("field-variants", [
        failures(changed(*alike)),
        absent(changed(*raised)),
        *(programs(Field(PROBLEMS, of, cells())) for of in (same, stranger)),
        *(Paragraph(counted(field)) for field in (FIELD, changed(late), changed(partial), alone)),
        *(Paragraph(by_problem(field).notes[-1]) for field in missing),
        *(Paragraph(", ".join(by_problem(field).rows[row])) for row, field in lines),
    ])  # fmt: skip


def test_pages_speak_of_the_scenes_that_cells_are_of() -> None:
    own = {"title": "", "solver": "dda", "key": "", "definition": {}}
    records = [own | {"scene": name} for name in ("a", "a changed")]
    runs = {"a dda": [["a", "dda"], "judged dda"]}
    assert [r["scene"] for r in spoken_of({"study": "field", "cases": records, "data": {"runs": runs}})] == ["a"]
    assert spoken_of({"study": "mine", "cases": records}) == records
    assert spoken_of({"study": "field", "cases": records, "data": {"runs": "damaged"}}) == records
