"""`list WORD`: one line for each metric, study, scene and solver."""

import pytest
from conftest import typed

from validation.cli.printing import output
from validation.metrics.catalogue import CATALOGUE
from validation.scenes.keys import keys_of, range_of
from validation.scenes.scene import load_scene, scene_names, tables_of_scenes
from validation.solvers import registry
from validation.solvers.registry import solver_names
from validation.suite.folders import get_study, study_names


def listed(word):
    done = typed("list", word)
    assert done.returncode == 0 and not done.stderr
    return done.stdout.splitlines()


def test_a_solver_of_another_package_is_listed_with_its_target(monkeypatch):
    monkeypatch.setattr(registry, "entry_points", lambda: {"theirs": "their_package.adapter:solve"})
    last = listed("solvers")[-1].split()
    assert last == ["theirs", "other", "their_package.adapter:solve", "decides", "itself"]


def test_scenes_and_studies_have_a_count_and_a_title(monkeypatch):
    monkeypatch.setattr("validation.scenes.scene.scene_names", lambda: ["figures-3-4"])
    monkeypatch.setattr("validation.suite.folders.study_names", lambda: ["response"])
    scene = load_scene("figures-3-4")
    study = get_study("response")
    words = ["figures-3-4", "3", *", ".join(scene.run.solvers).split(), *scene.title.split()]
    assert [line.split() for line in listed("scenes")[1:]] == [words]
    assert [line.split() for line in listed("studies")[1:]] == [["response", "3", *study.title.split()]]


@pytest.mark.parametrize(
    "word", ["keys", "metrics", "schemes", "solvers", *(pytest.param(word, marks=pytest.mark.long) for word in
                                                        ("scenes", "studies"))]
)  # fmt: skip
def test_lists_fit_a_terminal(word, monkeypatch):
    monkeypatch.setattr(output, "terminal_width", lambda: 80)
    assert max(map(len, listed(word))) <= 80


def test_the_plain_list_fits_a_screen_and_counts_what_the_others_hold(monkeypatch):
    monkeypatch.setattr(output, "terminal_width", lambda: 80)
    printed = typed("list").stdout.splitlines()
    assert max(map(len, printed)) <= 80 and len(printed) <= 24
    heads = [line.split(maxsplit=2) for line in printed if line and not line.startswith(" ")]  # the others go on
    counts = {name: int(count) for name, count, *_ in heads[:6]}
    known = {"studies": study_names(), "scenes": scene_names(), "solvers": solver_names(), "metrics": CATALOGUE}
    assert {name: counts[name] for name in known} == {name: len(names) for name, names in known.items()}


def test_a_verdict_has_its_colour_where_colours_are_seen(monkeypatch, capsys):
    lines = [("FAIL it", "FAIL"), ("1 FAIL", "FAIL"), ("it", "")]
    output.print_lines(lines)
    assert capsys.readouterr().out == "FAIL it\n1 FAIL\nit\n"
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm-256color")
    output.print_lines(lines)
    red, end = "\x1b[1;31m", "\x1b[0m"
    assert capsys.readouterr().out == f"{red}FAIL{end} it\n{red}1 FAIL{end}\nit\n"


def test_a_page_of_advice_keeps_its_lines_in_a_terminal(monkeypatch):
    monkeypatch.setattr(output, "terminal_width", lambda: 60)
    page = typed("advise", "damping", "figures-3-4", "--set", "time.step=0.002").stdout.splitlines()
    assert len(page) == 13 and 60 >= max(map(len, page[:5])) > 50


@pytest.mark.parametrize("place", [place for place in tables_of_scenes() if place != "gate"])
def test_what_a_key_goes_with_is_a_key_and_one_of_its_words(place):
    for name, _, key in keys_of(tables_of_scenes()[place]):
        for requirement in key.needs:
            field, _, words = requirement.partition(" = ")
            section, _, partner = field.rpartition(".")
            ranges = {name: range_of(field) for name, field, _ in keys_of(tables_of_scenes()[section or place])}
            assert partner in ranges, (name, requirement)
            assert set(words.split(" or ")) <= {"", *ranges[partner].split(" or ")}, (name, requirement)
