"""What starts first: the command, and the solver that pytest is given."""

import os
import signal
from types import SimpleNamespace

import pytest
from faults import seams

from validation import cli
from validation.entry import command, plugin
from validation.errors import InputError
from validation.runs import threads
from validation.solvers import registry
from validation.solvers.user import UserSolver


def test_the_command_runs_on_one_thread_and_not_beside_a_folder_in_its_way(monkeypatch, capsys):
    done = []
    monkeypatch.setattr(signal, "signal", lambda *given: done.append(given))
    monkeypatch.setattr(threads, "limit_process", lambda: done.append("one thread"))
    monkeypatch.setattr(cli, "main", lambda: done.append("runs"))
    monkeypatch.setattr(signal, "getsignal", lambda number: signal.default_int_handler)
    monkeypatch.setattr(command, "shadowed", lambda: None)
    command.main()
    assert done == [(signal.SIGINT, signal.SIG_DFL), "one thread", "runs"]
    monkeypatch.setattr(signal, "getsignal", lambda number: signal.SIG_IGN)
    monkeypatch.setattr(command, "shadowed", lambda: "IN THE WAY")
    with pytest.raises(SystemExit) as ended:
        command.main()
    assert (ended.value.code, capsys.readouterr().err, len(done)) == (2, "error: IN THE WAY\n", 3)


def test_a_solver_that_does_not_load_is_refused_before_any_gate(monkeypatch):
    user = UserSolver.__new__(UserSolver)
    monkeypatch.setattr(registry, "get_solver", lambda name: user if name == "mine:solve" else SimpleNamespace())
    monkeypatch.setattr(UserSolver, "check_module", lambda solver: None)
    monkeypatch.setattr(UserSolver, "load_error", lambda solver: None)
    assert plugin._check_loads("dda") is None and plugin._check_loads("mine:solve") is None
    monkeypatch.setattr(UserSolver, "load_error", lambda solver: "WHY")
    with pytest.raises(pytest.UsageError, match=r"mine:solve.*WHY"):
        plugin._check_loads("mine:solve")

    def fails(solver):
        raise InputError("NO MODULE")

    monkeypatch.setattr(UserSolver, "check_module", fails)
    with pytest.raises(pytest.UsageError, match="NO MODULE"):
        plugin._check_loads("mine:solve")


def test_pytest_is_given_a_solver_and_a_time_limit(monkeypatch):
    lines = []
    loaded = []
    seams.LOADED_SOLVER.put(monkeypatch, loaded.append)
    monkeypatch.setattr(plugin, "shadowed", lambda: None)

    def config(user, **fields):
        options = {"--dda-solver": user, "--dda-timeout": 7.5}
        names = SimpleNamespace(addinivalue_line=lambda name, line: lines.append((name, line.partition(":")[0])))
        return SimpleNamespace(**vars(names), getoption=lambda name, default=None: options.get(name, default), **fields)

    plugin.pytest_configure(config(None))
    assert (lines, loaded) == ([("markers", "validation")], [])
    monkeypatch.setenv("DDA_VALIDATE_TIMEOUT", "1")
    plugin.pytest_configure(config("dda"))
    plugin.pytest_configure(config("mine:solve", workerinput={}))
    assert loaded == ["dda"] and os.environ["DDA_VALIDATE_TIMEOUT"] == "7.5"
    for user, sentence in (("no solver", None), ("dda", "IN THE WAY")):
        monkeypatch.setattr(plugin, "shadowed", lambda sentence=sentence: sentence)
        with pytest.raises(pytest.UsageError, match=sentence or user):
            plugin.pytest_configure(config(user))


def test_gates_that_fail_are_counted_apart_and_none_judged_is_told():
    stated = [(plugin.STATEMENT, "{}")]
    for failed, when, properties, counted in (
        (True, "call", stated, True),
        (False, "call", stated, False),
        (True, "setup", stated, False),
        (True, "call", [("other", "{}")], False),
    ):
        report = SimpleNamespace(failed=failed, when=when, user_properties=properties)
        assert plugin.pytest_report_teststatus(report) == ((plugin.FAILED, "F", "FAILED") if counted else None)

    def judged_nothing(*outcomes, gate=True, **fields):
        name = "x/test_gates.py::test_gate[a]" if gate else "x.py::test"
        stats = {"": [pytest.TestReport(name, ("", 0, ""), {}, outcome, None, when) for outcome, when in outcomes]}
        manager = SimpleNamespace(get_plugin=lambda name: SimpleNamespace(stats=stats))
        return plugin._judged_nothing(SimpleNamespace(pluginmanager=manager, **fields))

    skipped = ("skipped", "call")
    assert judged_nothing(skipped) and judged_nothing(skipped, ("passed", "setup"))
    assert not judged_nothing(skipped, ("passed", "call")) and not judged_nothing(skipped, ("failed", "setup"))
    assert not judged_nothing() and not judged_nothing(skipped, gate=False)
    assert not judged_nothing(skipped, workerinput={})
