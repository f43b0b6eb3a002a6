"""The site of results and its calculators; names of users on pages; every kind of block in every renderer."""

import json
import os
import re
import shlex
import shutil
import subprocess
import tomllib
from html import unescape
from html.parser import HTMLParser
from typing import get_args
from urllib.parse import urlencode

import numpy as np
import pytest
from conftest import SCENE, refused, typed
from oracles.made_cases import kept_study, made_row
from oracles.made_results import made_rows
from pypdf import PdfReader

from validation.errors import InputError
from validation.gates.gate import Gate, judge
from validation.report import blocks as kinds
from validation.report.blocks import Block, Callout, Heading, Link, Links, Listing, Paragraph, Points, table
from validation.report.book import build
from validation.report.figures import histories
from validation.report.render import pdf, terminal
from validation.report.render.html import page, readable
from validation.report.site import pages
from validation.results import Results
from validation.runs.history import History
from validation.scenes.scene import load_scene, parse_scene

REASON = "because of h / c"
FAILING = "fail<!--ing"  # a name that would open a comment in a script
EMPTY = '<svg xmlns="http://www.w3.org/2000/svg" width="9pt" height="9pt"/>'
HOSTILE = "</script><b>50 % & 'more' @feng2017"  # the key of a source cites nothing in a user's title
CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
browser = pytest.mark.skipif(not CHROMIUM, reason="the browser is NOT RUN: needs Chromium on the path or in CHROMIUM")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Return the results of a small scene with a hostile title, with a gate that passes and one that fails."""
    kept = Results(tmp_path_factory.mktemp("secret-place") / "results")
    for name, low, title in (("passing", 0.0, HOSTILE), (FAILING, 0.8, "plain")):
        scene = parse_scene(
            tomllib.loads(SCENE) | {"name": name, "title": title, "run": {"solvers": ["dda", "bar"]}}, name
        )
        kept_study(kept, made_rows(scene), study=name, title=title)
        gate = Gate(scene.name, ("dda", "bar"), "displacement.l2", low, 0.9, REASON)
        kept.write_verdicts(name, [judge(gate, 0.5).record(name)])
    return kept


def written_empty(figure, path):
    """Write an empty drawing; the bytes of a figure have a test of their own."""
    path.write_text(EMPTY)
    return path


@pytest.fixture(scope="module")
def site(results, tmp_path_factory):
    out = tmp_path_factory.mktemp("site")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(histories, "save", written_empty)
        assert pages.build(results, out, docs="..") == out / "index.html"
    return out


def texts(place):
    files = [path for path in sorted(place.rglob("*")) if path.is_file()]
    return {str(path.relative_to(place)): path.read_text(encoding="utf-8") for path in files}


def check_links(files):
    """Every address of every page, pictures included, is a file of the site or of the documentation around it."""
    for name, text in files.items():
        for address in re.findall(r'(?:href|src)="([^"#]+)', text) if name.endswith(".html") else ():
            assert address in files or address in ("data:,", "../index.html"), (name, address)


def test_a_page_for_each_study_and_scene_and_no_link_leads_nowhere(site):
    files = texts(site)
    names = {"study-passing", "study-fail---ing", "scene-passing", "scene-fail---ing", "index", "references"}
    assert {f"{name}.html" for name in (*names, "calculators")} == {name for name in files if name.endswith(".html")}
    check_links(files)
    pictures = re.findall(r'<img src="([^"]+)"', files["index.html"])
    scenes = ["scene-fail---ing/fail---ing-lead.svg", "scene-passing/passing-lead.svg"]
    studies = [picture.replace("scene-", "study-") for picture in scenes]
    assert sorted(pictures) == sorted(scenes + studies)
    assert "article 7480937" in files["index.html"] and 'id="feng2017"' in files["references.html"]
    assert all(words in files["index.html"] for words in ("FAIL", REASON, '"../index.html"'))
    titles = [unescape(re.search("<title>([^<]*)", text)[1]) for _, text in sorted(files.items()) if "<title>" in text]
    for word, stem in (("pass", "passing"), ("fail", "fail---ing")):
        judged = {name for name, text in files.items() if f'class="verdict {word}"' in text and name != "index.html"}
        assert judged == {f"study-{stem}.html", f"scene-{stem}.html"}
    assert titles[3:] == [f"{FAILING}: plain", f"passing: {HOSTILE}", "plain", HOSTILE]


def test_the_decisions_come_first_where_a_study_has_them(core_results, drawn, tmp_path, monkeypatch):
    for other in ("scene_page", "chapter_blocks"):
        monkeypatch.setattr(pages, other, lambda *_: [])
    monkeypatch.setattr(pages, "matrix", lambda verdicts: [Paragraph(f"of {len(verdicts)}")])
    pages.build(core_results, tmp_path / "site")
    files = texts(tmp_path / "site")
    index = files["index.html"]
    cards = re.findall(r'href="decisions.html#([^"]+)"><img src="decisions/decision-(\w+).svg"', index)
    assert [picture for _, picture in cards] == ["step", "springs", "discount"]
    assert all(f'id="{place}"' in files["decisions.html"] for place, _ in cards)
    assert index.index(cards[-1][0]) < index.index("study-core.html")
    assert "of 2" in files["verification.html"] and 'href="verification.html"' in index


def test_no_page_asks_a_network_or_names_a_place_and_titles_of_users_stay_text(site, results):
    for name, text in texts(site).items():
        outside = set(re.findall(r"\w+://[^\s\"'<)]+", text)) if name.endswith((".html", ".js", ".css")) else set()
        assert not outside, name
        assert str(results.directory.parent) not in text, name
    for place in ("/home/me/here/scene.toml", r"C:\me\here\scene.toml"):
        assert readable(f"{place}: p/E = 1 m/s, 5 kg/m³") == "scene.toml: p/E = 1 m/s, 5 kg/m³"
    for name in ("index.html", "study-passing.html", "scene-passing.html"):
        text = (site / name).read_text(encoding="utf-8")
        assert "<b>50" not in text and "&lt;b&gt;50" in text and "@feng2017" in text, name


def test_the_same_results_give_the_same_bytes_and_an_earlier_site_is_replaced_as_a_whole(
    results, tmp_path, monkeypatch
):
    """Pages without figures, whose bytes have a test of their own."""
    out = tmp_path / "out"
    out.mkdir()
    (out / pages.MARK).write_text("an earlier site")
    (out / "scene-old.html").write_text("gone")
    with monkeypatch.context() as patch:
        patch.setattr(pages, "scene_page", lambda *_: (_ for _ in ()).throw(OSError(28, "full")))
        with pytest.raises(InputError, match="full"):
            pages.build(results, out)
    assert set(texts(out)) == {pages.MARK, "scene-old.html"}
    monkeypatch.setattr(pages, "scene_page", lambda group, _: [Paragraph(group.title)])
    told = []
    for place in (out, tmp_path / "other"):
        pages.build(results, place, progress=lambda *given: told.append(given))
    assert told == [(number, 2, name) for number, name in enumerate((FAILING, "passing"))] * 2
    assert texts(out) == texts(tmp_path / "other") and "scene-passing.html" in texts(out)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other", "out"]


def test_bad_input_is_one_line(tmp_path):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    for out, named in (("file", "file: "), ("mine", "mine: "), ("new", "nothing: ")):
        assert refused("report", "--site", out, "--results", "nothing", cwd=tmp_path).startswith(f"error: {named}")
    assert refused("report", "--docs", "x", cwd=tmp_path).startswith("error: --docs: ")
    assert {path.name for path in tmp_path.iterdir()} == {"file", "mine"}


def test_no_two_pages_share_a_file_whatever_the_letters_case():
    names = pages.page_names("scene", ["Figure 7", "figure 7", "Figure/7", "..", "x" * 200])
    assert [*names.values()] == [
        "scene-Figure-7.html",
        "scene-figure-7-2.html",
        "scene-Figure-7-3.html",
        "scene-unnamed.html",
        f"scene-{'x' * 94}.html",
    ]


# ---- names of users -------------------------------------------------------------------------------------------------


def test_a_column_with_an_escape_code_and_a_title_with_a_key_cost_no_page(tmp_path, monkeypatch):
    monkeypatch.setattr(histories, "save", written_empty)
    scene = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 4})
    scene = scene.model_copy(update={"title": "After @feng2017"})
    columns = {"displacement": np.full(4, -0.01), "esc\x1b[31m": np.arange(4.0)}
    results = Results(tmp_path / "r")
    history = History(0.002 * np.arange(1, 5), columns)
    cases = [(scene, made_row("dda", {}, scene.name), history)]
    kept_study(results, cases, study="mine", title=scene.title)
    first = PdfReader(build(results, tmp_path / "r.pdf")).pages[0].extract_text()
    assert scene.title in first and "Warning" not in first and "Error" not in first


# ---- renderers ------------------------------------------------------------------------------------------------------


BLOCKS = [
    Heading("Top 1"),
    Paragraph("Lead 2 @kane1999", "lead"),
    Callout("Rule 3", "rule"),
    kinds.FigureBlock("f.svg", "Figure 4"),
    table(
        (kinds.TableColumn("Of 5", "verdict"), kinds.TableColumn("b", group="both")), [("PASS", "1.5")], "C 6", ("N 7",)
    ),
    Paragraph("Plain 8"),
    kinds.Beside((Paragraph("left 9"),), (kinds.FigureBlock("f.svg", ""),), 0.5),
    Callout("Framed 10", "warn"),
    Points((("First 11", "and more 12"),)),
    kinds.PageBreak(),
    Heading("Top 1", 2),
    Listing("+--+\n|  | 13"),
    Links((Link("a.html", "Title 14", "what 15"),)),
    kinds.References(),
]


def test_every_kind_of_block_has_its_form_in_every_renderer(kept_text, tmp_path):
    assert {type(block) for block in BLOCKS} == {*get_args(Block)}
    (tmp_path / "f.svg").write_text(EMPTY)
    (tmp_path / "r.pdf").write_bytes(pdf.typeset(tmp_path, BLOCKS))
    printed = " ".join(page.extract_text() for page in PdfReader(tmp_path / "r.pdf").pages)
    shown = " ".join(text for text, _ in terminal.lines(BLOCKS, 80))
    for number in ("Top 1", *map(str, range(2, 14)), "Title 14", "what 15"):
        assert number in printed, number
        assert number in shown or number == "4", number  # of a figure
    html = page("t", BLOCKS, file="a.html", name="site", menu=(("a.html", "A"), ("b.html", "B")), imprint="/x/y")
    body, _, sources = html.partition("<body>")[2].partition('<ul class="references">')
    bathe = sources.partition('"bathe2005">')[2].splitlines()[:2]
    kept_text("blocks", [*body.splitlines(), *bathe, str([*map(int, pdf.kept_with_next(BLOCKS))])])
    words, first, second = Paragraph("words"), Heading("a"), Heading("b", 2)
    others = [first, words, kinds.PageBreak(), words, words, BLOCKS[4], first, words, second, words, BLOCKS[11], words]
    assert [*map(int, pdf.kept_with_next(others))] == [0, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0]


def test_blocks_stand_apart_in_a_terminal_and_a_callout_close_to_what_it_is_of():
    blocks = [
        kinds.PageBreak(),
        Heading("A title"),
        Callout("mind", "warn"),
        Callout("it fails", "fail"),
        kinds.Beside((Paragraph("left"),), (Listing("one\n two"),), 0.5),
        Points((("Head.", "text"),)),
        table(("word", "number"), [("x", "1.5"), ("of both",)], "Of all", ("so",)),
        Links((Link("a.html", "Title", "what is there"),)),
    ]
    lines = [*terminal.lines(blocks, 40)]
    assert [line for line in lines if line[1]] == [("it fails", "FAIL")]
    assert [text.rstrip() for text, _ in lines] == [
        *("A title", "! mind", "it fails", "", "left", "", "one", " two", "", "Head. text", ""),
        *("Of all", "word  number", "x        1.5", "of both", "so", "", "a.html  Title  what is there"),
    ]


# ---- calculators ----------------------------------------------------------------------------------------------------


class Values(HTMLParser):
    """What a page of calculators has computed, and the commands that it names."""

    def __init__(self, text):
        super().__init__()
        self.values = {}
        self.commands = []
        self._in_command = False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if stated := attributes.get("data-values"):
            self.values = json.loads(stated)
        self._in_command = attributes.get("class") == "command"

    def handle_data(self, data):
        if self._in_command:
            self.commands.append(data)
            self._in_command = False


def computed(site, settings):
    """Return what the page computes of the settings in its address."""
    address = f"{(site / 'calculators.html').as_uri()}#{urlencode(settings)}"
    flags = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--dump-dom")
    done = subprocess.run([str(CHROMIUM), *flags, address], capture_output=True, text=True, timeout=60)
    return Values(done.stdout)


def answer(command):
    done = typed(*shlex.split(command)[1:], "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


SETTINGS = [  # a browser takes seconds for each
    {"solve_for": "dt", "alpha": 0.3025, "delta": 0.6, "gg": 0.98, "density": 2000, "target": 0.02},
    {"solve_for": "gg", "step": 3e-4, "alpha": 0.25, "delta": 0.5, "stiffness_ratio": 10, "target": 0.08},
    {"solve_for": "scheme", "step": 1e-3, "gg": 0.99, "young": 4e9, "side": 3, "target": 0.3},
]


@browser
@pytest.mark.long
@pytest.mark.parametrize("settings", SETTINGS, ids=str)
def test_the_calculators_answer_as_the_command_line(site, settings):
    shown = computed(site, settings)
    damping, advice = map(answer, shown.commands)
    for mode in damping["modes"]:
        own = shown.values["modes"][mode["name"]]
        for name in ("frequency", "damping", "algorithmic", "kinetic", "spectral_radius"):
            assert own[name] == pytest.approx(mode[name], rel=1e-11, abs=1e-12), name
    assert shown.values["values"] == pytest.approx([one["value"] for one in advice["solutions"]], rel=1e-10)
