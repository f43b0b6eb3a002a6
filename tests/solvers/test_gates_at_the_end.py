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


@pytest.mark.parametrize(("user", "when", "verbose"), [("mine:solve", "call", 0), ("mine:solve", "call", 1),
                                                     ("mine:solve", "setup", 0), (None, "call", 0)])  # fmt: skip
def test_what_gates_said_ends_what_pytest_writes_all_of_it_where_it_is_verbose(user, when, verbose, monkeypatch):
    """Nothing is told without a solver, or of what no gate said."""
    lines, asked = list[str](), list[Any]()
    told = [(plugin.STATEMENT, json.dumps(asdict(SAID))), ("other", "x")]
    report = pytest.TestReport("t", ("t", 1, "t"), {}, "passed", None, when, user_properties=told)
    reporter = SimpleNamespace(stats={"passed": [report], "": [object()]}, write_line=lines.append,
                               write_sep=lambda sign, text: lines.append(text))  # fmt: skip
    options = {"--dda-solver": user, "verbose": verbose}
    plugins = SimpleNamespace(get_plugin=lambda name: reporter)
    config = SimpleNamespace(getoption=lambda name, default=None: options.get(name, default), pluginmanager=plugins)
    monkeypatch.setattr(block, "block", lambda said, every: asked.append((said, every)) or ["first\n  second"])
    steps = plugin.pytest_terminal_summary(reporter, config)
    next(steps)
    assert next(steps, "done") == "done"
    is_told = user is not None and when == "call"
    assert asked == [([SAID], verbose > 0)] * is_told
    assert lines[1:] == ["first", "  second"] * is_told and len(lines) == 3 * is_told
