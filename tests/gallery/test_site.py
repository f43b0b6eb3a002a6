"""The gallery: written whole from a results directory, the same bytes every time, without a path or an address."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import get_args

import pytest
from conftest import SCENE, refused

from validation.engine import run_study
from validation.errors import InputError
from validation.gallery import pages, site
from validation.gallery.cases import readable
from validation.gallery.pages import Pages
from validation.report.blocks import Block, PageBreak
from validation.results import Results
from validation.suite.folders import scene_study

ROOT = Path(__file__).parents[2]
STATIC = ROOT / "validation/gallery/static"
FAILING = "fail<!--ing"  # a name that would open a comment in a script
HOSTILE = "</script><b>50 % & 'more'"
GATE = """
[run]
solvers = ["dda", "bar"]

[[gate]]
pair = ["dda", "bar"]
metric = "displacement.l2"
band = [{low}, 0.9]
reason = "{reason}"
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Return the results of a small scene with a hostile title, a gate that passes and one that fails."""
    place = tmp_path_factory.mktemp("secret-place")
    kept = Results(place / "results")
    for name, low, title in (("passing", 0.0, HOSTILE), (FAILING, 0.8, "plain")):
        text = SCENE.replace('"A small scene"', json.dumps(title)) + GATE.format(low=low, reason="because of h / c")
        (place / f"{name}.toml").write_text(text, encoding="utf-8")
        run_study(scene_study(str(place / f"{name}.toml")), kept)
    return kept


@pytest.fixture(scope="module")
def gallery(results: Results, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Return the files of the gallery by name."""
    out = tmp_path_factory.mktemp("gallery")
    assert site.build(results, out) == out / "index.html"
    return files(out)


def files(out: Path) -> dict[str, str]:
    return {path.name: path.read_text(encoding="utf-8") for path in sorted(out.iterdir())}


def data_of(page: str) -> list[dict]:
    found = re.findall(r'<script type="application/json" class="data">(.*?)</script>', page, re.S)
    assert not any("<" in text for text in found)
    return [json.loads(text) for text in found]


def test_a_page_for_each_study_scene_and_calculator(gallery: dict[str, str]) -> None:
    pages = {"study-passing", "study-fail---ing", "scene-passing", "scene-fail---ing", "index", "references"}
    pages |= {"damping", "adviser", "rebound", "wave", "schemes", "dashpot", "engines"}
    assert {f"{page}.html" for page in pages} | {*site.STATIC, site.NOTICE} == set(gallery)
    for name, text in gallery.items():
        for address in re.findall(r'(?:href|src)="([^"#]+)"', text) if name.endswith(".html") else ():
            assert address in gallery or address == "data:,", (name, address)
    assert "article 7480937" in gallery["index.html"] and 'id="feng2017"' in gallery["references.html"]


def test_pages_lead_to_the_documentation_where_it_lies_beside_them(results: Results) -> None:
    alone = Pages(results, [], []).index()
    beside = Pages(results, [], [], docs="..").index()
    assert "Documentation" not in alone and '<a href="../index.html">Documentation</a>' in beside


def test_no_page_asks_a_network_or_names_a_place(gallery: dict[str, str], results: Results) -> None:
    for name, text in gallery.items():
        if name.startswith("uPlot"):
            continue
        outside = set(re.findall(r"\w+://[^\s\"'<)]+", text)) - {
            "http://www.w3.org/2000/svg",
            "http://www.w3.org/1999/xlink",
        }
        assert outside <= ({"https://github.com/leeoniya/uPlot"} if name == site.NOTICE else set()), name
        assert str(results.directory.parent) not in text and "secret-place" not in text, name
    assert readable("in /home/me/here/scene.toml: p/E = 1 m/s, 5 kg/m³") == "in scene.toml: p/E = 1 m/s, 5 kg/m³"
    assert readable(r"C:\me\here\scene.toml") == "scene.toml"


def test_titles_of_users_stay_text(gallery: dict[str, str]) -> None:
    for name in ("index.html", "study-passing.html", "scene-passing.html"):
        assert "<b>50" not in gallery[name] and "&lt;b&gt;50" in gallery[name], name


def test_the_verdicts_of_the_results_are_in_the_tables(gallery: dict[str, str], results: Results) -> None:
    for study, file, word in (("passing", "passing", "PASS"), (FAILING, "fail---ing", "FAIL")):
        (verdict,) = results.verdicts(study)
        for page in (f"study-{file}.html", f"scene-{file}.html"):
            table = next(data for data in data_of(gallery[page]) if "words" in data)
            (row,) = table["rows"]
            assert [table["words"][i] for i in row[:4]] == [word, study, "dda – bar", "displacement.l2"]
            assert verdict["verdict"] == word and f'id="reason-{row[6] + 1}"' in gallery[page]
    assert "What fails" in gallery["index.html"] and "because of h / c" in gallery["index.html"]


def test_histories_and_colours_are_those_of_the_results(gallery: dict[str, str], results: Results) -> None:
    import numpy as np
    from gallery.samples import unpacked

    from validation.gallery.histories import STEPS
    from validation.solvers.registry import get_solver

    page = next(data for data in data_of(gallery["scene-passing.html"]) if "cases" in data)
    (case,) = page["cases"]
    for record in results.manifest("passing")["cases"]:
        line = get_solver(record["solver"]).line
        assert line is not None and page["solvers"][record["solver"]]["color"] == line.color
        history = results.history(record["key"])
        assert history is not None and case["whole"] and case["steps"] == len(history.time)
        for column, values in history.columns.items():
            shown = unpacked(*case["columns"][column][record["solver"]])
            assert np.abs(shown - values).max() <= 0.51 * np.ptp(values) / STEPS


@pytest.mark.long
def test_the_same_results_give_the_same_bytes(gallery: dict[str, str], results: Results, tmp_path: Path) -> None:
    site.build(results, tmp_path / "out")
    assert files(tmp_path / "out") == gallery


def test_an_earlier_gallery_is_replaced_as_a_whole(
    results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pages, "page_blocks", lambda *_: [])
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / site.NOTICE).write_text("an earlier gallery")
    (tmp_path / "out" / "scene-old.html").write_text("gone")
    told: list[tuple[int, int]] = []
    site.build(results, tmp_path / "out", lambda done, total, label: told.append((done, total)))
    assert told == [(0, 4), (1, 4), (2, 4), (3, 4)]
    assert "scene-old.html" not in files(tmp_path / "out") and "uPlot" in files(tmp_path / "out")[site.NOTICE]
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_an_earlier_gallery_stays_where_the_new_one_fails(
    results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> str:
        raise OSError(28, "No space left on device")

    (tmp_path / "out").mkdir()
    (tmp_path / "out" / site.NOTICE).write_text("an earlier gallery")
    monkeypatch.setattr(pages, "page_blocks", lambda *_: fail())
    with pytest.raises(InputError, match="cannot be written: No space left"):
        site.build(results, tmp_path / "out")
    assert files(tmp_path / "out") == {site.NOTICE: "an earlier gallery"}
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_bad_input_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    for out, said in (
        ("file", "must be a directory"),
        ("mine", "with other files"),
        ("new", "no study's results here"),
    ):
        assert said in refused("gallery", "--out", out, "--results", "nothing", cwd=tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"file", "mine"}


def test_every_kind_of_block_has_its_form(results: Results) -> None:
    template = (ROOT / "validation/gallery/templates/parts.html.j2").read_text(encoding="utf-8")
    kinds = {kind.__name__ for kind in get_args(Block)} - {PageBreak.__name__}
    assert kinds <= set(re.findall(r'b\.block == "(\w+)"', template))
    assert Pages(results, [], []).index()


def test_what_is_shipped_is_named_with_its_licence() -> None:
    assert {path.name for path in STATIC.iterdir()} == {*site.STATIC, site.NOTICE}
    notice = (STATIC / site.NOTICE).read_text(encoding="utf-8")
    version = re.search(r"uPlot \(v([\d.]+)\)", (STATIC / "uPlot.iife.min.js").read_text(encoding="utf-8"))
    assert version and f"uPlot {version[1]}" in notice
    assert "The MIT License" in notice and "Copyright (c) 2022 Leon Sorokin" in notice


def test_figures_are_well_formed_and_their_letters_drawn(gallery: dict[str, str]) -> None:
    assert 'Histories to zoom: <a href="scene-passing.html">' in gallery["study-passing.html"]
    figures = re.findall(r"<svg.*?</svg>", gallery["study-passing.html"], re.S)
    assert figures
    named = set(re.findall(r' id="([^"]+)"', gallery["study-passing.html"]))
    for text in figures:
        ET.fromstring(text)
        assert set(re.findall(r'href="#([^"]+)"', text)) | set(re.findall(r"url\(#([^)]+)\)", text)) <= named
