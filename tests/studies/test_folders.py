"""A study is one folder: one that is added is run, judged and told, one that is taken away leaves the others whole."""

import sys
from pathlib import Path

import pytest
from conftest import typed

import validation.studies
from validation.engine import run_study
from validation.errors import InputError
from validation.gates import Status
from validation.report.blocks import Paragraph
from validation.report.chapters.registry import chapter_of
from validation.report.chapters.scene import scene_chapter
from validation.results import Results
from validation.runs.case_name import scene_of
from validation.scenes.places import LIBRARY, scene_files
from validation.scenes.scene import load_scene
from validation.suite.folders import get_study, scene_study, study_folders, study_names

HERE = Path(str(validation.studies.__file__)).parent
STUDY = """
[study]
name = "added-study"
title = "An added study"
purpose = "Is it found?"
phenomenon = "none"
order = 55
pairs = [["dda", "bar"]]
derived = "twice"
[[gate]]
scenes = ["added-scene"]
pairs = [["dda"]]
metrics = ["displacement.static"]
band = "settled"
reason = "closed form"
[[gate]]
scene = "added-scene"
numbers = "numbers.csv"
by = ["time.step"]
metrics = ["displacement.static"]
pairs = [["dda"]]

reason = "printed"
[[gate]]
owners = ["added-scene"]
pairs = [["twice"]]
metrics = ["static"]
band = [-1.0, 0.0]
reason = "downwards"
"""
NUMBERS = """# static displacement [m]
time.step=0.002, time.step=0.001
-0.0100,         -0.0100
"""
SCENE = """
block = { side = 2.0, density = 2700.0, young = 1e9 }
contact = { stiffness = 1e9 }
load = { pressure = 5e6 }
time = { step = 0.002, steps = 20 }
run = { solvers = ["dda", "bar"] }
sweep = { "time.step" = [0.002, 0.001] }
"""
FORMULAS = """
from validation.engine.finished import Derived
from validation.suite.bands import cases, near
from validation.theory.statics import static_displacement

def settled(case):
    return near(static_displacement(case), 1e-9)

def twice():
    (name, _) = (case.name for case in cases("added-scene"))
    def compute(finished):
        return {"static": 2 * finished.rows[name, "dda"].metrics["displacement.static"]}
    return [Derived("added-scene", "twice", ((name, "dda"),), compute)]
"""
CHAPTER = """
from validation.report.blocks import Heading, Paragraph

def chapter(results, manifest, directory):
    return [Heading("Added"), Paragraph("Found by its folder.")]
"""


@pytest.fixture
def added(tmp_path, monkeypatch):
    """A package of studies elsewhere, of one folder, beside those of the suite."""
    folder = tmp_path / "package" / "added"
    (folder / "scenes").mkdir(parents=True)
    files = {"study.toml": STUDY, "numbers.csv": NUMBERS, "formulas.py": FORMULAS, "scenes/added-scene.toml": SCENE}
    for name, text in (files | {"chapter.py": CHAPTER}).items():
        (folder / name).write_text(text)
    monkeypatch.setattr(validation.studies, "__path__", [*validation.studies.__path__, str(folder.parent)])
    yield folder
    for name in [name for name in sys.modules if name.startswith("validation.studies.added")]:
        del sys.modules[name]


@pytest.mark.long
def test_a_folder_that_is_added_is_run_judged_and_told(added, tmp_path, monkeypatch):
    names = study_names()
    assert names[names.index("paper") + 1] == "added-study"
    assert not [name for name in sys.modules if name.startswith("validation.studies.added")]  # nothing is imported
    assert "added-study" in typed("list", "studies").stdout and "added-scene" in typed("list", "scenes").stdout
    results = Results(tmp_path / "results")
    assert [verdict.status for verdict in run_study(get_study("added-study"), results)] == [Status.PASS] * 5
    blocks = chapter_of("added-study")(results, results.whole("added-study"), tmp_path)
    assert Paragraph("Found by its folder.") in blocks
    monkeypatch.setattr(validation.studies, "__path__", [str(HERE)])  # and is taken away: its results tell themselves
    assert "added-study" not in study_names() and "added-scene" not in scene_files()
    assert chapter_of("added-study") is scene_chapter


def test_no_study_stands_on_what_is_of_another_alone():
    """One that is taken away leaves the others whole; contracts of imports hold that no module needs it."""
    files = scene_files()
    for name, folder in study_folders().items():
        for scene in get_study(name).scenes:
            directory = files[scene_of(scene)].parent if isinstance(scene, str) else LIBRARY
            assert directory in (LIBRARY, folder.path / "scenes"), (name, scene)
    assert load_scene("mesh-convergence").title


def test_a_built_in_scene_has_what_its_studies_judge_of_it():
    name = "contact-map-constant"
    rebound = get_study("rebound")
    alone = scene_study(name)
    assert alone.title == load_scene(name).title
    assert set(alone.extra) == {case for case in rebound.extra if scene_of(case[0]) == name} != set()
    assert set(alone.gates()) == {gate for gate in rebound.gates() if scene_of(gate.scene) == name} != set()
    assert [row.scene for row in alone.derived()] == [r.scene for r in rebound.derived() if scene_of(r.scene) == name]
    other = scene_study(name, {"block.density": 1.0})
    assert not [*other.extra, *other.gates(), *other.derived()]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("order = 55", "", "study.toml: study.order: is required"),
        ("order = 55", "order = ", "must be TOML"),
        ('band = "settled"', 'band = "setled"', "names 'setled', which formulas.py has not"),
        ('derived = "twice"', 'derived = "thrice"', "names 'thrice', which formulas.py has not"),
    ],
)
def test_a_table_that_cannot_be_read_is_named(old, new, words, added):
    (added / "study.toml").write_text(STUDY.replace(old, new))
    with pytest.raises(InputError, match=words):
        study = get_study("added-study")
        [study.gates(), study.derived()]


@pytest.mark.parametrize(("file", "old", "new"), [("study.toml", "added-study", "core"), ("scenes", "", "figures-3-4")])
def test_two_of_one_name_are_refused(file, old, new, added):
    if old:
        (added / file).write_text(STUDY.replace(old, new))
    else:
        (added / file / f"{new}.toml").write_text(SCENE)
    with pytest.raises(InputError, match="must not have the name of the"):
        [study_names(), scene_files()]
