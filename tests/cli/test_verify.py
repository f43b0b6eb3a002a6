"""``verify`` and the options of the plug-in: what is handed on, and the status that follows."""

import json
import os
from types import SimpleNamespace

import pytest
from conftest import typed
from oracles.processes import answer_here

from validation.cli import verify as cli_verify
from validation.entry import plugin
from validation.gates.gate import Gate, Status, Verdict
from validation.report.blocks import Paragraph
from validation.suite import matrix


def verdict(status):
    return Verdict(Gate("small", ("dda", "bar"), "pressure.l2", 0.0, 0.5, "so"), 0.25, status)


@pytest.mark.parametrize(
    ("solver", "statuses", "code"),
    [
        ("dda", [Status.PASS, Status.NOT_RUN], 0),
        ("dda", [Status.PASS, Status.FAIL], 1),
        ("bar", [Status.NOT_RUN], 1),
        ("bar", [], 1),
    ],
)
def test_what_verifies_a_phenomenon_is_judged_beside_the_results_of_dda_alone(
    solver, statuses, code, tmp_path, monkeypatch
):
    calls = []

    def judged(shown, results, *more):
        calls.append((shown.name, results.directory == tmp_path / "r", *more[:2]))
        return [verdict(status) for status in statuses], ["mind the gap"]

    def shown_blocks(shown, verdicts, every):
        return [Paragraph(f"{shown.name} {len(verdicts)} {every}")]

    monkeypatch.setattr(matrix, "phenomenon", lambda name: SimpleNamespace(name=name, study="core"))
    monkeypatch.setattr(matrix, "verify", judged)
    words = ("verify", "ledge", "--solver", solver, "--results", tmp_path / "r", "--jobs", "3", "--json")
    done = typed(*words)
    assert (done.returncode, calls) == (code, [("ledge", solver == "dda", solver, 3)]), done.stderr
    assert [one["verdict"] for one in json.loads(done.stdout)] == [str(status) for status in statuses]
    monkeypatch.setattr(cli_verify, "default_jobs", lambda: 5)
    monkeypatch.setattr("validation.report.verification.verdict_blocks", shown_blocks)
    done = typed("verify", "ledge", "--solver", solver, "--results", tmp_path / "r", "--verbose")
    assert (done.returncode, done.stdout, calls[1][3]) == (code, f"ledge {len(statuses)} True\nmind the gap\n", 5)


def test_a_solver_of_a_user_has_the_limit_of_time_that_is_stated(monkeypatch):
    options = {}
    group = SimpleNamespace(addoption=lambda name, **rest: options.update({name: rest}))
    plugin.pytest_addoption(SimpleNamespace(getgroup=lambda *words: group))
    assert options["--dda-timeout"]["default"] == 60.0
    monkeypatch.setenv("DDA_VALIDATE_TIMEOUT", "1")
    answer_here(monkeypatch)
    marks = []
    for user, seconds in (("bar", 7.5), ("no such solver", 8.0), ("nowhere:solve", 9.0), ("json:nothing", 7.5)):
        values = {"--dda-solver": user, "--dda-timeout": seconds}
        config = SimpleNamespace(
            getoption=lambda name, default=None, values=values: values[name],
            addinivalue_line=lambda name, line: marks.append(name),
        )
        if user == "bar":
            plugin.pytest_configure(config)
        else:
            with pytest.raises(pytest.UsageError):
                plugin.pytest_configure(config)
    assert os.environ["DDA_VALIDATE_TIMEOUT"] == "7.5" and marks == ["markers"] * 4
    monkeypatch.setattr(plugin, "shadowed", lambda: "x is in the way")
    with pytest.raises(pytest.UsageError, match="x is in the way"):
        plugin.pytest_configure(config)


def test_what_the_gates_tell_of_a_users_solver_stands_at_the_end(monkeypatch):
    """Of the calls of gates alone, once, after everything else; a session that judged none is told."""
    own = "validation.suite.own_solver"
    monkeypatch.setattr(f"{own}.session.GateReport", SimpleNamespace)
    monkeypatch.setattr(f"{own}.block.block", lambda reports, every: [f"{len(reports)} {reports[0].value} {every}"])
    monkeypatch.setattr(f"{own}.block.wrapped", lambda lines: [*lines, "and more"])

    def report(when, outcome, name=plugin.STATEMENT):
        place = ("a/test_gates.py", 1, "x")
        told = [(name, json.dumps({"value": 1.5}))]
        node = f"a/{plugin.GATE}x]"
        return pytest.TestReport(node, place, {}, outcome, None, when, user_properties=told)

    assert plugin.pytest_report_teststatus(report("call", "failed")) == (plugin.FAILED, "F", "FAILED")
    for other in (report("call", "passed"), report("setup", "failed"), report("call", "failed", "theirs")):
        assert plugin.pytest_report_teststatus(other) is None

    def summary(*reports, user="mine:solve"):
        said = []
        reporter = SimpleNamespace(
            stats={"": [*reports, "no report"]}, write_line=said.append, write_sep=lambda *words: said.append(words)
        )
        options = {"--dda-solver": user, "verbose": 1}
        config = SimpleNamespace(
            getoption=lambda name, default=None: options[name],
            pluginmanager=SimpleNamespace(get_plugin=lambda name: reporter),
        )
        ending = plugin.pytest_terminal_summary(reporter, config)
        next(ending)
        assert said == []
        with pytest.raises(StopIteration):
            next(ending)
        return said

    two = (report("call", "passed"), report("call", "failed"), report("setup", "passed"))
    told = [("=", "mine:solve: what the gates tell"), "2 1.5 True", "and more"]
    assert summary(*two) == told
    assert summary(*two, user=None) == [] == summary(report("call", "passed", "theirs"))
    (alone,) = summary(report("setup", "skipped", "theirs"))
    assert alone.endswith("status 1")
