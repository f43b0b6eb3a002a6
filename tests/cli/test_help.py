"""Every command's help page has an example; its options exist, and it runs as it stands."""

import itertools
import re
import shlex
import threading

import numpy as np
import pytest
import typer
from conftest import SCENE, beside, refused, typed
from oracles.answers import answered
from oracles.pages import ROOT, write_my_solver

from validation import load_scene, solve
from validation.cli import app as command_line
from validation.cli import entry
from validation.cli.entry import GROUPS, app
from validation.errors import InputError

GROUP = typer.main.get_command(app).commands
PARTS = {f"advise {name}": part for name, part in GROUP["advise"].commands.items()}
COMMANDS = GROUP | {name: part for name, part in PARTS.items() if name != "advise everything"}
COMMANDS["advise"] = PARTS["advise everything"]  # which is what no part by name is
FAIL = [["judge", "my_solver:solve", "locked"]]  # by the damping of the scheme that the scene names
# A study is timed for minutes and a committed file rewritten; whole studies, packs and sites have tests of their own.
UNTRIED = {"record", "claims", "export-pack"}


def examples(name):
    """Return the words of each command line that stands as an example on a help page."""
    lines = re.findall(r"\[bold\](.*?)\[/bold\]", COMMANDS[name].help, re.S)
    parts = [part for line in lines for part in " ".join(line.split()).split("&&")]
    return [shlex.split(part)[1:] for part in parts]


def command_of(words):
    """Return the command, or the part of one, that a command line begins with."""
    part = " ".join(words[:2])
    return part if part in COMMANDS else words[0]


def test_every_command_has_an_example_a_page_and_a_group():
    for name, command in COMMANDS.items():
        assert name in {command_of(words) for words in examples(name)}, name
        assert (ROOT / command.epilog.removeprefix("Page: ")).is_relative_to(ROOT / "docs"), name
    assert sorted(itertools.chain.from_iterable(GROUPS.values())) == sorted(GROUP)
    page = typed("--help").stdout
    assert all(group in page for group in GROUPS)


def test_the_page_of_a_wheel_stands_below_its_environment(tmp_path, monkeypatch):
    page = tmp_path / "share/doc/dda-validation/judge.md"
    page.parent.mkdir(parents=True)
    page.touch()
    monkeypatch.setattr(entry, "__file__", str(tmp_path / "lib/site-packages/validation/cli/entry.py"))
    assert entry.page_of("judge") == page.resolve()


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(set(COMMANDS) - UNTRIED))
def test_examples_run_as_they_stand(name, tmp_path, finished_cases, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "reports").mkdir()
    beside(finished_cases, tmp_path / "reports/results")
    (tmp_path / "my-scene.toml").write_text(SCENE)
    write_my_solver(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    answered(tmp_path / "answers", 1.001)
    run = solve(load_scene("figures-3-4").with_values({"time.step": 0.002}), "dda")
    table = np.column_stack([run.time, -1000 * run.displacement])  # millimetres, downwards
    np.savetxt(tmp_path / "theirs.csv", table, delimiter=",", header="t,uy", comments="", fmt="%.17g")
    figures = [["run", "figures-3-4"]]
    first = {"report": figures, "diff": figures}
    for words in (*first.get(name, []), *examples(name)):
        if words[0] == "diff":
            (tmp_path / "main").mkdir()
            (tmp_path / "main/verdicts.json").write_bytes((tmp_path / "reports/results/verdicts.json").read_bytes())
        done = typed(*words, cwd=tmp_path)
        assert done.returncode == (words in FAIL), f"{words}\n{done.stdout}{done.stderr}"


def test_what_takes_long_shows_a_bar(tmp_path, monkeypatch):
    """The bar starts while the first piece of work is still busy."""
    started = threading.Event()
    stopped = []

    def work(*arguments, **options):
        raise InputError("shown" if started.wait(60) else "no bar")

    monkeypatch.setattr(command_line, "PROGRESS_DELAY", 0.0)

    def start(bar):
        bar.live._started = True
        started.set()

    monkeypatch.setattr("rich.progress.Progress.start", start)
    monkeypatch.setattr("rich.progress.Progress.stop", lambda bar: stopped.append((bar.live.is_started, bar.disable)))
    monkeypatch.setattr("validation.problems.pack.write_pack", work)
    assert typed("export-pack", "pack", cwd=tmp_path).stderr == "error: shown\n"
    assert stopped == [(True, True)]  # of no terminal it is not drawn
    monkeypatch.setattr("validation.problems.pack.write_pack", lambda *arguments: 7)
    assert re.fullmatch(r"wrote pack: 7 [a-z ]+\n", typed("export-pack", "pack", cwd=tmp_path).stdout)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/notes").write_text("mine")
    assert refused("export-pack", "mine", cwd=tmp_path).startswith("error: mine: ")
