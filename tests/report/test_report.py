"""The report is built from a results directory alone, whatever the verdicts are."""

from __future__ import annotations

import dataclasses
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from oracles.made_cases import between, kept_study, made_row

from validation.errors import InputError
from validation.gates.gate import Gate, Status, Verdict, judge
from validation.report import typesetting
from validation.report.appendix import provenance as appendix_provenance
from validation.report.blocks import (
    Beside,
    Callout,
    FigureBlock,
    Heading,
    PageBreak,
    Paragraph,
    Points,
    References,
    Table,
    TableColumn,
)
from validation.report.book import build, figures, ordered_studies
from validation.report.chapters import data as chapters_data
from validation.report.chapters import gates as chapters_gates
from validation.report.chapters import ledger as chapters_ledger
from validation.report.chapters import scene as chapters
from validation.report.chapters import text as chapters_text
from validation.report.front import pages as front
from validation.report.front.groups import groups_of_studies
from validation.report.typesetting import typeset
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene, parse_scene

CORE = ("figures-3-4", "figure-7", "figure-8", "poisson", "corner-springs")
FREQUENCY = {"dda": 344.561, "dda-textbook": 344.561, "fem": 327.682, "bar": 327.682, "continuum": 327.682}
CODE, MESH = 3.2e-13, 6.1e-9  # invented differences between solvers that agree


def synthetic(scene, solver):
    """Return a damped oscillation about the static value with the solver's frequency, as history and metrics."""
    time = scene.time.step * np.arange(1, scene.time.steps + 1)
    w = FREQUENCY[solver]
    xi = 0.0 if solver == "continuum" else min(0.3, 0.25 * w * scene.time.step)
    shape = 1 - np.exp(-xi * w * time) * np.cos(w * math.sqrt(1 - xi**2) * time)
    static = -0.010
    if scene.fem.foundation == "corner" and solver == "fem":
        static -= 0.005 * math.log2(scene.fem.per_side)
    scale = {"dda-textbook": 1 + CODE, "fem": 1 + MESH}.get(solver, 1.0)
    history = History(time, {"displacement": static * scale * shape, "contact_pressure": 5e6 * scale * shape})
    peak = {
        "displacement.peak": float(history.displacement.min()),
        "pressure.peak": float(history.contact_pressure.max()),
    }
    metrics = {
        "displacement.static": static,
        "pressure.static": 5e6,
        "pressure.minimum": -0.338e6,
        "displacement.settling_step": 44.0,
        "pressure.settling_step": "undefined",
        "mode1.frequency": w,
        "mode1.damping": xi,
        "mode1.numerical_frequency": w * (1 - xi),
        "mode1.spectral_radius": math.exp(-xi),
        "mode1.measured_damping": "not reported",
        "mode1.measured_frequency": w * (1 - xi),
        **peak,
    }
    return history, metrics


PROVENANCE = {
    "python": "3.11.0",
    "packages": {"numpy": "2.4.0", "scipy": "1.17.0"},
    "commit": "0123abc",
    "processor": "a processor",
    "cores": 2,
    "seeds": [],
    "date": "2024-01-01",
}


def l2(a, b):
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


def comparison(case, solver, reference, histories):
    a, b = histories[solver], histories[reference]
    errors = {
        "displacement_l2": l2(a.displacement, b.displacement),
        "pressure_l2": l2(a.contact_pressure, b.contact_pressure),
    }
    return between(case, solver, reference, **errors) | {"window": float(a.time[-1])}


def write_study(results, study, scenes, gates=(), title="The paper's scenes"):
    """Fill a results directory as the engine does, with synthetic data; dda-textbook is absent from figure-8."""
    cases, comparisons = [], []
    for case in [case for scene in scenes for case in scene.expand()]:
        histories = {}
        for solver in case.run.solvers:
            if solver == "dda-textbook" and case.name.startswith("figure-8"):
                left_out = {"outcome": Outcome.NOT_APPLICABLE, "notes": ("alpha must be above 0",)}
                cases.append((case, made_row(solver, {}, case.name, **left_out), None))
                continue
            histories[solver], metrics = synthetic(case, solver)
            spent = {"work": {"unknowns": 6, "steps": case.time.steps}, "seconds": {"setup": 0.001, "stepping": 0.01}}
            cases.append((case, made_row(solver, metrics, case.name, **spent), histories[solver]))
        order = [s for s in ("dda", "dda-textbook", "fem", "bar", "continuum") if s in histories]
        comparisons += [comparison(case.name, a, b, histories) for i, a in enumerate(order) for b in order[i + 1 :]]
    said = {"study": study, "title": title, "purpose": "Does the code say what the model says?"}
    kept_study(results, cases, comparisons, **said, provenance=PROVENANCE)
    results.write_verdicts(study, [verdict.record(study) for verdict in gates])
    return results


def verdict(scene, metric, value, low=0.03, high=0.04, **kwargs):
    gate = Gate(
        scene, ("dda", "bar"), metric, low, high, "the model form at this step, known from both sides", **kwargs
    )
    return judge(gate, value)


PASSES = verdict("figures-3-4[time.step=0.002]", "displacement.l2", 0.0363, until=0.2)
FAILS = verdict("figures-3-4[time.step=0.01]", "pressure.l2", 0.0567)
WAITS = Verdict(
    Gate(
        "figure-8[time.alpha=0.25,time.delta=0.5]",
        ("dda", "fenicsx"),
        "displacement.l2",
        0,
        1e-6,
        "another code",
        "other code",
        1e-9,
    ),
    None,
    Status.NOT_RUN,
    "fenicsx: dolfinx is not installed",
)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    directory = Results(tmp_path_factory.mktemp("results"))
    scenes = [load_scene(name) for name in CORE]
    return write_study(directory, "core", scenes, (PASSES, FAILS, WAITS))


@pytest.fixture
def small(tmp_path):
    """Return one case without a sweep: a user's scene with a hostile title and an unknown solver."""
    data = load_scene("poisson").definition() | {
        "name": "my scene/1",
        "title": "#panic[no] *bold* $x$ @me",
        "sweep": {},
    }
    FREQUENCY["theirs"] = 300.0
    data["run"] = {"solvers": ["dda", "theirs", "bar"]}
    return write_study(Results(tmp_path / "results"), "mine", [parse_scene(data, "mine")], title="My study")


def group_of(results, name):
    return next(g for g in chapters_data.case_groups(results, results.manifest("core")) if g.name == name)


def all_text(blocks):
    return json.dumps([vars(block) for block in blocks], default=vars, ensure_ascii=False)


@pytest.fixture
def no_solver(monkeypatch):
    """Let every import of a package of solvers fail, where a module asks for it when it is called."""
    packages = ("dda", "fem_reference", "skfem", "dolfinx")
    for name in {*packages, *(name for name in sys.modules if name.partition(".")[0] in packages)}:
        monkeypatch.setitem(sys.modules, name, None)


@pytest.mark.parametrize("which", ["small", pytest.param("results", marks=pytest.mark.long)])
def test_build_writes_one_pdf_and_nothing_else(which, request, tmp_path, no_solver):
    """Of the small one the title is text and never evaluated; no solver is imported."""
    results = request.getfixturevalue(which)
    (tmp_path / "out").mkdir()
    before = sorted(p.name for p in results.directory.rglob("*"))
    out = build(results, tmp_path / "out/report.pdf")
    assert out.read_bytes().startswith(b"%PDF-")
    assert out.stat().st_size > 10_000  # pages with figures, not empty ones
    assert [p.name for p in out.parent.iterdir()] == ["report.pdf"]
    assert sorted(p.name for p in results.directory.rglob("*")) == before


def test_a_failed_build_leaves_the_old_report(small, tmp_path, monkeypatch, drawn):
    out = tmp_path / "report.pdf"
    out.write_bytes(b"old")

    def fail(*args, **kwargs):
        raise RuntimeError("typesetting failed")

    monkeypatch.setattr(typesetting.typst, "compile", fail)
    with pytest.raises(RuntimeError, match="typesetting failed"):
        build(small, out)
    assert out.read_bytes() == b"old"


@pytest.mark.long
def test_the_report_imports_no_solver(small, tmp_path):
    code = (
        "import sys; from pathlib import Path; from validation.report.book import build\n"
        "from validation.runs.results import Results\n"
        "build(Results(sys.argv[1]), Path(sys.argv[2]))\n"
        "print([m for m in ('dda', 'fem_reference', 'skfem', 'dolfinx') if m in sys.modules])"
    )
    command = [sys.executable, "-c", code, str(small.directory), str(tmp_path / "r.pdf")]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(__file__).parents[2])
    assert done.stdout.strip() == "[]"


def front_of(results, studies, directory):
    return front.front_pages(groups_of_studies(results, studies), results.verdicts(), studies, directory)


def test_the_first_pages_count_verdicts_and_name_what_did_not_pass_with_value_band_and_reason(
    results, tmp_path, drawn, monkeypatch
):
    monkeypatch.setattr(front, "decisions", lambda *_: [Heading("Decision 1", 2)])
    blocks = front_of(results, ["core"], tmp_path)
    assert Callout("3 gates: 1 passed, 1 failed, 1 not run.", "fail") in blocks
    assert Callout("One gate fails.", "fail") in blocks
    table = next(b for b in blocks if isinstance(b, Table) and b.columns[0].title == "Verdict")
    assert table.rows == (
        ("FAIL", FAILS.gate.id, "0.0567", "0.03 … 0.04"),
        ("the model form at this step, known from both sides [exact]",),
        ("NOT RUN", WAITS.gate.id, "–", "0 … 1×10⁻⁶"),
        ("another code [other code ± 1×10⁻⁹] Fenicsx: dolfinx is not installed.",),
    )
    kinds = [type(b) for b in blocks]
    assert (
        kinds.index(PageBreak)
        < blocks.index(table)
        < next(i for i, b in enumerate(blocks) if isinstance(b, Heading) and b.text.startswith("Decision 1"))
    )  # on a page of its own, before the decisions


@pytest.mark.parametrize(
    ("scene", "part", "expected"),
    [
        ("figures-3-4", "code", CODE),
        ("figures-3-4", "mesh", MESH),
    ],
)
def test_ledger_takes_the_comparison_of_its_pair(results, scene, part, expected):
    group = group_of(results, scene)
    for case in group.cases:
        found = chapters_ledger.entry(group, case, part)
        assert found == (pytest.approx(expected, rel=1e-2),) * 2  # rounding of 1 + CODE


@pytest.mark.parametrize(("scene", "part"), [("figure-8", "code"), ("poisson", "mesh"), ("poisson", "model form")])
def test_a_pair_that_was_not_compared_has_no_part_of_the_ledger(results, scene, part):
    group = group_of(results, scene)
    assert chapters_ledger.entry(group, group.cases[0], part) == chapters_ledger.NOTHING
    assert chapters_ledger.part_values([group], part, 0) == []


def test_scene_page_names_every_outcome_other_than_completed(results):
    (callout,) = chapters.outcomes(group_of(results, "figure-8"))
    assert callout.text == (
        "dda-textbook at α = 0.25, δ = 0.5; α = 0.5, δ = 1: not applicable. "
        f"{Outcome.NOT_APPLICABLE.sentence} alpha must be above 0"
    )


def test_conclusion_of_a_scene_is_computed(results):
    group = group_of(results, "figures-3-4")
    text = chapters.conclusion(group)
    values = sorted(group.compared(case, "dda", "bar")["displacement.l2"] for case in group.cases)
    assert text.startswith(f"Against bar, dda differs by {chapters_text.percent(values[0])} to ")
    assert "1 of 2 gates fails" in text
    assert "down to −0.338 MPa in dda" in text
    assert "the difference falls as the damping grows" in text
    assert "damping grows" not in chapters.conclusion(group_of(results, "figure-8"))  # two cases are no trend


@pytest.mark.parametrize(
    ("band", "text"),
    [
        ((0.03, 0.04), "0.03 … 0.04"),
        ((5.0, 5.0), "5 … 5"),
        ((-0.0053065, -0.0053055), "−0.0053065 … −0.0053055"),
        ((0, 1e-12), "0 … 1×10⁻¹²"),
        ((344.561 - 3e-9, 344.561 + 3e-9), "344.561 ± 3×10⁻⁹"),
    ],
)
def test_a_band_shows_as_many_digits_as_tell_its_edges_apart(band, text):
    assert chapters_gates.band({"band": band}) == text


def test_damping_table_joins_solvers_that_read_alike_and_tells_what_is_undefined(results):
    table = chapters.damping_table(group_of(results, "figures-3-4"))
    row = dict(zip([(c.group, c.title) for c in table.columns], table.rows[0], strict=True))
    assert row["", "Case"] == "dt = 0.01 s"
    assert row["", "Solver"] == "dda, dda-textbook"  # whose numbers read alike
    assert row["", "ω₁ [rad/s]"] == "344.6"
    assert row["", "ξ₁ [%]"] == "30.000"
    assert row["Settling step", "displ."] == "44"
    assert row["Settling step", "press."] == "undef."
    assert row["Least pressure", "MPa"] == "−0.3380"
    assert [note.split(":")[0] for note in table.notes] == ["undef."]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (344.561, "344.6"),
        (0.0, "0"),
        (-0.01, "−0.01000"),
        (1.2344e-7, "1.234×10⁻⁷"),
        (5e6, "5.000×10⁶"),
        (123456.0, "123456"),
        (1 - 1e-12, "1.000"),
        (math.nan, "not a number"),
        (-math.inf, "−∞"),
    ],
)
def test_numbers(value, text):
    assert chapters_text.plain(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.0363, "3.63\u00a0%"), (43.7, "4370\u00a0%"), (2e-5, "2.0×10⁻⁵"), (0.0, "0\u00a0%")]
)
def test_percent(value, text):
    assert chapters_text.percent(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(1e-15, "<10⁻¹²"), (-1e-12, "<10⁻¹²"), (0.0, "<10⁻¹²"), (0, "as it is"), (2e-12, "as it is"), (1e-9, "as it is")],
)
def test_rounding_is_told_as_a_bound(value, text):
    assert chapters_text.bounded(value, "as it is") == text


@pytest.mark.parametrize(
    ("name", "labels"),
    [
        ("figures-3-4", ["dt = 0.01 s", "dt = 0.002 s", "dt = 0.001 s"]),
        ("figure-7", ["p = 1E", "p = 10E", "p = 100E"]),
        ("figure-8", ["α = 0.25, δ = 0.5", "α = 0.5, δ = 1"]),
        ("model-form", ["dt = 0.01 s", "dt = 0.002 s", "dt = 0.001 s", "dt = 0.0001 s"]),
    ],
)
def test_cases_are_labelled_in_the_symbols_of_the_text(name, labels):
    cases = load_scene(name).expand()
    assert chapters_text.case_labels([c.name for c in cases], cases) == labels


def test_labels_that_would_read_alike_keep_their_steps():
    scene = load_scene("figures-3-4").with_values({"time.step": 0.01})
    cases = [scene.with_values({"time.steps": n}, label=True) for n in (10, 20)]
    assert chapters_text.case_labels([c.name for c in cases], cases) == ["steps = 10", "steps = 20"]


def test_figures_are_written_as_svg_andpng_of(small, tmp_path):
    paths = figures("mine", small, tmp_path / "new" / "out")
    assert sorted(p.name for p in paths) == [
        "my-scene-1-history.png",
        "my-scene-1-history.svg",
    ]
    assert {p.read_bytes()[:4] for p in paths} == {b"\x89PNG", b"<?xm"}


def test_bad_requests_name_what_is_wrong(small, tmp_path):
    with pytest.raises(InputError, match=r"study: must be one of .*mine.*got 'core'"):
        figures("core", small, tmp_path)
    with pytest.raises(InputError, match="no study's results here"):
        build(Results(tmp_path / "nowhere"), tmp_path / "r.pdf")
    with pytest.raises(InputError, match="is not a directory"):
        build(small, tmp_path / "absent" / "r.pdf")
    with pytest.raises(ValueError, match="rows: must have 2 cells each, or one, got 3"):
        Table((TableColumn("a"), TableColumn("b")), (("1", "2", "3"),))


def test_provenance_says_versions_and_cost(results):
    blocks = appendix_provenance.provenance(results, ["core"])
    text = all_text(blocks)
    for words in ("numpy 2.4.0", "0123abc", "a processor"):
        assert words in text
    cost = blocks[-1]
    fem = next(row for row in cost.rows if row[0] == "fem")
    cases = sum(len(load_scene(name).expand()) for name in CORE)
    assert fem[1] == str(cases)
    assert float(fem[-1]) == pytest.approx(0.011 * cases, rel=1e-2)  # three digits are printed


def test_every_kind_of_block_is_set(tmp_path):
    blocks = [
        Heading("One"),
        Paragraph("text", "lead"),
        Callout("careful", "warn"),
        PageBreak(),
        Table((TableColumn("x", "decimal"), TableColumn("id", "id")), (("1.5", "a:b[c=d]"),)),
        Points((("One.", "This *is* #not markup"),)),
        Beside((Paragraph("left"),), (Callout("right", "rule"),), 0.4),
        References(),
    ]
    assert typeset(tmp_path, blocks).startswith(b"%PDF-")


def test_studies_stand_in_the_order_of_their_chapters(tmp_path):
    directory = Results(tmp_path)
    for study in ("zeta", "alpha", "toppling", "rocking", "opening", "core"):
        directory.write_json(f"studies/{study}.json", {"study": study})
    assert ordered_studies(directory) == ["core", "opening", "rocking", "toppling", "alpha", "zeta"]


def test_the_longest_window_of_a_pair_counts_in_either_order(results):
    group = group_of(results, "poisson")
    case = group.cases[0]
    said = [
        {"scene": case.name, "solver": "a", "reference": "b", "window": 0.1, "metrics": {"displacement.l2": 0.3}},
        {"scene": case.name, "solver": "b", "reference": "a", "window": 0.2, "metrics": {"displacement.l2": 0.4}},
        {"scene": "other", "solver": "a", "reference": "b", "window": 9.0, "metrics": {"displacement.l2": 0.5}},
    ]
    compared = dataclasses.replace(group, comparisons=tuple(said)).compared
    assert compared(case, "a", "b") == compared(case, "b", "a") == {"displacement.l2": 0.4}
    assert compared(case, "a", "c") is None


def test_a_scene_of_which_nothing_completed_has_words_and_no_empty_pictures(tmp_path):
    scene = load_scene("figures-3-4").with_values({"time.step": 0.01})
    directory, ends = Results(tmp_path), (("dda", Outcome.OVERFLOW), ("bar", Outcome.REFUSED))
    rows = [made_row(name, {}, scene.name, outcome=end, notes=("step 7", "too long")) for name, end in ends]
    manifest = kept_study(directory, [(scene, row, None) for row in rows], study="mine")
    page = chapters.scene_chapter(directory, manifest, tmp_path)
    first = front_of(directory, ["mine"], tmp_path)
    assert not [b for b in (*page, *first) if isinstance(b, FigureBlock)]
    said = [b.text for b in page if isinstance(b, Callout)]
    assert said[0] == f"dda: overflow. {Outcome.OVERFLOW.sentence} step 7; too long"
    assert said[1].startswith("bar: refused.")
    imprint, *others = first
    assert "article 7480937" in imprint.text
    assert others == [
        Paragraph("1 scene of mine: one chapter a study.", "lead"), Callout("No gate was judged.", "warn")
    ]  # fmt: skip
