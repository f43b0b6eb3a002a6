"""What pytest writes at its end of a user's solver: from the gates' own reports, all of them where it is asked."""

import json
from dataclasses import asdict
from types import SimpleNamespace
from typing import Any

import pytest

from validation.entry import plugin
from validation.suite.own_solver import block
from validation.suite.own_solver.session import GateReport

SAID = GateReport(
    "g", "core", "s", 40, "statics", "displacement.static", "PASS", 1.0, 0.9, 1.1, "", "completed", "k", "r"
)


def ended(monkeypatch, user, verbose, when="call"):
    """Return the lines that pytest writes and what the block was asked."""
    lines, asked = list[str](), list[Any]()
    told = [(plugin.STATEMENT, json.dumps(asdict(SAID))), ("other", "x")]
    report = pytest.TestReport("t", ("t", 1, "t"), {}, "passed", None, when, user_properties=told)
    reporter = SimpleNamespace(stats={"passed": [report], "": [object()]}, write_line=lines.append,
                               write_sep=lambda sign, text: lines.append(text))  # fmt: skip
    options = {"--dda-solver": user, "verbose": verbose}
    plugins = SimpleNamespace(get_plugin=lambda name: reporter)
    config = SimpleNamespace(getoption=lambda name, default=None: options.get(name, default), pluginmanager=plugins)

    def written(said, every):
        asked.append((said, every))
        return ["first\n  second"]

    monkeypatch.setattr(block, "block", written)
    steps = plugin.pytest_terminal_summary(reporter, config)
    next(steps)
    assert next(steps, "done") == "done"
    return lines, asked


@pytest.mark.parametrize(("verbose", "every"), [(-1, False), (0, False), (1, True)])
def test_every_gate_is_told_where_pytest_is_verbose(monkeypatch, verbose, every):
    lines, asked = ended(monkeypatch, "mine:solve", verbose)
    assert asked == [([SAID], every)]
    assert lines == ["mine:solve: what the gates tell", "first", "  second"]


def test_nothing_is_told_without_a_solver_or_of_what_no_gate_said(monkeypatch):
    assert ended(monkeypatch, None, 0) == ended(monkeypatch, "mine:solve", 0, "setup") == ([], [])
