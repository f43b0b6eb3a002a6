"""The report is built from a results directory alone, whatever the verdicts are."""

from types import SimpleNamespace

import pytest
from matplotlib.figure import Figure
from oracles.made_cases import between, kept_study, made_case, made_group, made_row
from oracles.made_results import made_rows

from validation.errors import InputError
from validation.report import book
from validation.report.blocks import FigureBlock, Paragraph, Table, TableColumn
from validation.report.book import build, write_figures
from validation.report.chapters import answers as chapters_answers
from validation.report.chapters import gates as chapters_gates
from validation.report.chapters import ledger, summary
from validation.report.chapters import scene as chapters
from validation.report.chapters import text as chapters_text
from validation.report.chapters.data import groups_of_studies
from validation.report.front import front_pages
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene, parse_scene

MANY = load_scene("figures-3-4").with_values({"block.young": 2e9})
PNG = b"\x89PNG"
PRESSED = ((2e9, 5e6), (5e9, 2.5e6))


@pytest.fixture
def small(tmp_path):
    """Return one case without a sweep: a user's scene with a hostile title and an unknown solver."""
    data = load_scene("poisson").definition() | {
        "name": "my scene/1",
        "title": "#panic[no] *bold* $x$ @me",
        "sweep": {},
    }
    scene = parse_scene(data | {"run": {"solvers": ["dda", "theirs", "bar"]}}, "mine")
    results = Results(tmp_path / "results")
    kept_study(results, made_rows(scene), study="mine", title="My study")
    return results


def test_a_failed_build_leaves_the_old_report(small, tmp_path, monkeypatch):
    out = tmp_path / "report.pdf"
    out.write_bytes(b"old")

    monkeypatch.setattr(book, "chapter_blocks", lambda *_: [])

    def fail(*args, **kwargs):
        raise RuntimeError("failed")

    monkeypatch.setattr("typst.compile", fail)
    with pytest.raises(RuntimeError, match="failed"):
        build(small, out)
    assert out.read_bytes() == b"old"


def test_figures_are_written_as_svg_and_png(small, tmp_path, monkeypatch):
    heads = {"svg": b'<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>', "png": PNG}
    monkeypatch.setattr(Figure, "savefig", lambda self, stream, format, **options: stream.write(heads[format]))
    paths = write_figures(small, tmp_path / "new" / "out", ["mine"])
    assert sorted(p.name for p in paths) == [
        *("my-scene-1-drawing.png", "my-scene-1-drawing.svg", "my-scene-1-history.png", "my-scene-1-history.svg"),
        *("my-scene-1-lead.png", "my-scene-1-lead.svg", "my-scene-1-slide.png", "my-scene-1-slide.svg"),
    ]
    assert {(p.suffix, p.read_bytes()[:4]) for p in paths} == {(".png", PNG), (".svg", b"<?xm")}


def test_bad_requests_name_what_is_wrong(small, tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"mine.*got 'core'") as unknown:
        write_figures(small, tmp_path, ["core"])
    with pytest.raises(InputError) as empty:
        build(Results(tmp_path / "nowhere"), tmp_path / "r.pdf")
    with pytest.raises(InputError) as lost:
        build(small, tmp_path / "absent" / "r.pdf")
    sources = [error.value.source for error in (empty, lost)]
    assert unknown.value.field == "study" and sources == [tmp_path / "nowhere", tmp_path / "absent" / "r.pdf"]
    small.write_json("studies/old.json", {"study": "other"})
    monkeypatch.setattr(book, "chapter_blocks", lambda *_: [])
    monkeypatch.setattr(book, "write_document", lambda out, blocks: blocks(tmp_path))
    (callout,) = [block for block in build(small, tmp_path, ["old", "mine"]) if "'other'" in str(block)]
    assert callout.tone == "fail"
    for ask, place, words in ((build, "r", "'other'"), (write_figures, "results/rows.jsonl", "cannot be made")):
        with pytest.raises(InputError, match=words):
            ask(small, tmp_path / place, ["old"])
    with pytest.raises(ValueError, match=r"^rows: .*got 3$"):
        Table((TableColumn("a"), TableColumn("b")), (("1", "2", "3"),))


def test_a_scene_of_which_nothing_completed_has_words_and_no_empty_pictures(tmp_path, kept):
    scene = load_scene("figures-3-4").with_values({"time.step": 0.01})
    directory, ends = Results(tmp_path), (("dda", Outcome.OVERFLOW), ("bar", Outcome.REFUSED))
    rows = [made_row(name, {}, scene.name, outcome=end, notes=("step 7", "too long")) for name, end in ends]
    manifest = kept_study(directory, [(scene, row, None) for row in rows], study="mine")
    page = chapters.scene_chapter(directory, manifest, tmp_path)
    first = front_pages(None, groups_of_studies(directory, [manifest], drawn=False), directory.verdicts())
    assert not [b for b in (*page, *first) if isinstance(b, FigureBlock)]
    kept("nothing-completed", page)
    imprint, *others = first
    assert "dda-validation" in imprint.text and "article 7480937" not in imprint.text  # whose model is another
    assert others == []  # the page of the scene follows


def band(edges):
    return chapters_gates.band_cell(*edges)


def told(words):
    return chapters.gate_count([{"verdict": word} for word in words])


def taken(seconds):
    """Return what answers that took some seconds each are said to have taken together."""
    answers = [SimpleNamespace(seconds=one, history=True) for one in seconds]
    return chapters_answers._seconds(SimpleNamespace(answers=answers))


NUMBERS = [  # function, value, text
    (band, (5.0, 5.0), "5 … 5"), (band, (-0.0053065, -0.0053055), "−0.0053065 … −0.0053055"),
    (band, (0, 1e-12), "0 … 1×10⁻¹²"), (band, (344.561 - 3.4e-9, 344.561 + 3.4e-9), "344.561 ± 3.4×10⁻⁹"),
    (told, ["PASS"], "its one gate passes"), (told, ["FAIL"], "its one gate fails"),
    (taken, (1.204, 2.05), "3.3"), (taken, (None,), chapters_answers.DASH),
    (told, ["NOT RUN"], "its one gate did not run"), (told, ["FAIL", "PASS"], "1 of 2 gates fails"),
]  # fmt: skip


def test_numbers():
    for written, value, text in NUMBERS:
        assert written(value) == text


@pytest.mark.parametrize(
    ("scenes", "labels"),
    [
        (load_scene("figure-7").expand(), ["p = 1E", "p = 10E", "p = 100E"]),
        ([MANY.with_values({"time.steps": n}, label=True) for n in (10, 20)], ["steps = 10", "steps = 20"]),
        (
            [MANY.with_values({"contact.stiffness": p, "load.pressure": q}, label=True) for p, q in PRESSED],
            ["p = 1E, q = 5 MPa", "p = 2.5E, q = 2.5 MPa"],
        ),
    ],
)
def test_cases_are_labelled_in_the_symbols_of_the_text(scenes, labels):
    assert chapters_text.case_labels([scene.name for scene in scenes], scenes) == labels


def test_a_discount_is_told_as_it_is_stated(kept):
    stated = ({"time.gg": 0.9}, {"time.gg": 0.0}, {"time.gg_rate": 3.0}, {})
    scenes = [MANY.with_values({"time.step": 0.002, **values}) for values in stated]
    asked = [*([scene] for scene in scenes), scenes[:2]]
    kept("discounts", [Paragraph(summary._discount(one)) for one in asked])


def test_what_a_reference_is_worth_is_told(kept):
    told = []
    scene = MANY.with_values({"fem.elements": 2, "fem.degree": 1})
    for *solvers, reference in (["dda"], *(["dda", name] for name in ("continuum", "block-events", "bar", "fem"))):
        case = made_case(scene, {name: {} for name in (*solvers, reference)})
        pairs = [between(scene.name, solver, reference, displacement_l2=0.1) for solver in solvers]
        told.append(Paragraph(summary.reference_note(made_group(case, comparisons=pairs), case)))
    code = between(scene.name, "dda", "dda-textbook", displacement_l2=1e-7, pressure_l2=0.3)
    form = between(scene.name, "dda", "bar", displacement_l2=0.04, pressure_l2=0.03)
    for pairs in ([code], [form], [form, code]):
        told.append(Paragraph(ledger.headline([made_group(case, comparisons=pairs)])))
    told.append(Paragraph(chapters.conclusion(made_group(case, comparisons=[form | {"window": 0.0}]))))
    assert chapters.slide_figure(made_group(case)) is None
    kept("references", told)
