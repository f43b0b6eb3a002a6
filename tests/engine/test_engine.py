"""The engine: every case once, kept, resumed, judged; failures by name."""

import math
import multiprocessing
import os
import signal
import sys
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.made_cases import between, kept_study, made_history, made_row, study

from validation.engine import case as case_module
from validation.engine import cluster, measure
from validation.engine import executor as executor_module
from validation.engine import judge as judge_module
from validation.engine.case import Case
from validation.engine.executor import Pending
from validation.engine.finished import Finished
from validation.engine.judge import _ordered, evaluate
from validation.engine.measure import completed, execute
from validation.engine.measured import JudgedStudy, complaints, covers, missing_gates, unjudged
from validation.engine.run import finish, run_study
from validation.engine.study import Study
from validation.engine.table import lines, tidy
from validation.errors import InputError
from validation.gates.gate import Gate, Status, Verdict, rounded
from validation.metrics.values import NOT_REPORTED
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.run import Outcome, Run
from validation.solvers import memory
from validation.solvers.contract import Solver
from validation.solvers.registry import BUILT_IN


def test_a_column_that_a_solver_lacks_is_not_reported_and_the_others_are(scene, tmp_path):
    columns = ["displacement", "contact_pressure", "rotation"]
    results = Results(tmp_path)
    run_study(study(scene.with_values({"run.columns": columns})), results)
    rows = {row.solver: row for row in results.rows().values()}
    kept = {solver: set(results.history(row.key).columns) for solver, row in rows.items()}
    assert kept == {"dda": set(columns), "bar": {"displacement", "contact_pressure"}}
    assert rows["bar"].outcome is Outcome.COMPLETED and rows["bar"].notes[-1].endswith(": rotation")


def test_a_study_of_timings_takes_timed_rows_again_and_no_others(scene, tmp_path):
    results, seen = Results(tmp_path), []
    for timed in (False, True, True):
        run_study(study(scene, timed=timed), results, progress=lambda done, total, label: seen.append(label))
    assert len(seen) == 4
    assert [("lines" in row.work, "seconds.spread" in row.metrics) for row in results.rows().values()] == [
        *([(False, False)] * 2), *([(True, True)] * 2)]  # fmt: skip


def test_lines_that_an_action_executes_are_counted():
    def action():
        first = 1
        return first

    before = sys.gettrace()
    assert measure.lines_of(action) == measure.lines_of(action) == 2 and sys.gettrace() is before


def test_processes_threads_and_one_process_give_the_same_rows(scene, tmp_path):
    kept = []
    with ThreadPoolExecutor(2) as pool:
        for name, options in (("serial", {}), ("processes", {"jobs": 2}), ("threads", {"executor": pool})):
            results = Results(tmp_path / name)
            run_study(study(scene), results, **options)
            kept.append({key: (row.metrics, row.work) for key, row in results.rows().items()})
    assert kept[0] == kept[1] == kept[2]


def test_a_key_depends_on_what_the_solver_reads_and_on_nothing_else(scene):
    other_mesh = scene.with_values({"fem.elements": 8})
    other_step = scene.with_values({"time.step": 0.001})
    assert Case(scene, "dda").key() == Case(other_mesh, "dda").key()
    assert Case(scene, "fem").key() != Case(other_mesh, "fem").key()
    assert Case(scene, "dda").key() != Case(other_step, "dda").key()
    columns = ["displacement", "contact_pressure"]
    ordered, reverse = (scene.with_values({"run.columns": names}) for names in (columns, columns[::-1]))
    assert Case(ordered, "dda").key() == Case(reverse, "dda").key()
    assert Case(scene, "dda").key() != Case(scene, "dda:full").key() == Case(scene, "dda", True).key()
    assert Case(scene, "dda").key() != Case(scene, "dda-textbook").key()
    names = [Case(scene, solver, ranks=ranks).make_solver().name for solver in ("fenicsx", "dda") for ranks in (1, 2)]
    assert names == ["fenicsx", "fenicsx:2", "dda", "dda"]
    assert Case(scene, "fenicsx").make_solver().name == "fenicsx" and Case(scene, "dda").ranks == 1


class Broken(Solver):
    """A solver that is broken in one way."""

    name = "broken"

    def __init__(self, way):
        self.way = way

    def applicable(self, scene):
        return "it is broken" if self.way == "inapplicable" else None

    def solve(self, scene, full=False, fields=None):
        n = scene.time.steps
        if self.way == "raise":
            raise ZeroDivisionError("division by zero")
        if self.way == "refuse":
            raise InputError("small: time.step: no")
        values = np.zeros(n - 1 if self.way == "short" else n)
        values[3:] = {"nan": np.nan, "inf": np.inf}.get(self.way, 1.0)
        columns = dict.fromkeys(scene.run.columns, values)
        history = History(scene.time.step * np.arange(1, n + 1), columns)
        return Run(Outcome.COMPLETED, history, estimate=float("nan"))


@pytest.mark.parametrize(
    ("way", "outcome", "words"),
    [
        ("raise", Outcome.RAISED, "ZeroDivisionError: division by zero"),
        ("refuse", Outcome.REFUSED, "small: time.step: no"),
        ("short", Outcome.WRONG_SHAPE, "has shape (49,), not (50,)"),
        ("nan", Outcome.NOT_A_NUMBER, "displacement at step 4"),
        ("inf", Outcome.OVERFLOW, "displacement at step 4"),
        ("inapplicable", Outcome.NOT_APPLICABLE, "it is broken"),
    ],
)
def test_a_failure_is_a_named_outcome(scene, tmp_path, monkeypatch, way, outcome, words):
    run = completed(Broken(way), scene)
    assert run.outcome is outcome
    assert words in run.notes[-1]
    assert outcome.sentence.endswith(".")
    monkeypatch.setattr(Case, "make_solver", lambda self: Broken(way))
    row, history = execute(Case(scene, "dda"), "key", "test")
    assert (history, row.metrics) == (None, {})
    broken = Study("test", "t", "p", [scene], ("dda",), gates=study(scene).gates)
    verdict = run_study(broken, Results(tmp_path))[0]
    assert verdict.status is (Status.NOT_RUN if way == "inapplicable" else Status.FAIL)
    assert words in verdict.why


class Beside(Broken):
    """A sound history; the static solution and the choice of scenes are broken."""

    def static(self, scene):
        raise RuntimeError("singular")

    def applicable(self, scene):
        raise IndexError(self.way)


def test_what_fails_beside_a_sound_history_is_not_reported(scene, monkeypatch):
    assert completed(Beside("x"), scene).notes == ("IndexError: x",)
    monkeypatch.setattr(Case, "make_solver", lambda self: Beside("x"))
    monkeypatch.setattr(Beside, "applicable", Broken.applicable)
    row, history = execute(Case(scene, "dda"), "key", "test")
    assert row.outcome is Outcome.COMPLETED and history is not None, row.notes
    assert row.estimate is None and row.line(), "a row is JSON, which knows no NaN"
    assert row.metrics["displacement.static"] == NOT_REPORTED
    assert row.notes[-1].startswith("static ") and row.notes[-1].endswith(": RuntimeError: singular")


class Deadly(Broken):
    """A solver that takes its process down for one of the scenes, until it is mended."""

    def solve(self, scene, full=False, fields=None):
        if scene.time.step == 0.2 and not Path(self.way).exists():
            os._exit(9)
        return super().solve(scene, full, fields)


@pytest.mark.skipif(multiprocessing.get_start_method() != "fork", reason="workers inherit the patched solver by fork")
def test_a_case_that_kills_its_worker_is_a_row_and_is_tried_again(scene, tmp_path, monkeypatch):
    mended = tmp_path / "mended"
    monkeypatch.setattr(Case, "make_solver", lambda self: Deadly(str(mended)))
    swept = scene.model_copy(update={"sweep": {"time.step": [0.1, 0.2, 0.3]}})
    cases = Study("test", "t", "p", [swept], ("dda",)).cases()
    outcomes = []
    for _ in range(2):
        rows = finish(cases, study(scene), Results(tmp_path / "r"), jobs=2).rows
        outcomes.append([row.outcome for row in rows.values()])
        mended.touch()
    died = [Outcome.COMPLETED, Outcome.RAISED, Outcome.COMPLETED]
    assert outcomes == [died, [Outcome.COMPLETED] * 3]


def test_a_solver_compared_with_itself_fails(scene, tmp_path):
    results = Results(tmp_path)
    done = finish(study(scene).cases(), study(scene), results)
    gate = Gate(scene.name, ("dda", "dda"), "displacement.l2", 0, 1, "r")
    assert evaluate(gate, done).status is Status.FAIL


def test_other_values_are_rounded_to_digits():
    assert [rounded(value) for value in (0.0363249, -3.2e-14, 0.0)] == [0.03632, -1e-13, 0.0]


def test_every_comparison_goes_to_a_later_solver_in_the_order_of_references():
    names = {"dda", "fem", "bar", "continuum"}
    assert list(_ordered(names | {"mine"})) == ["mine", "dda", "fem", "bar", "continuum"]
    assert _ordered(BUILT_IN)[:2] == ["dda", "dda-textbook"]


def test_the_numbers_of_a_study_are_one_table(scene, tmp_path):
    swept = scene.model_copy(update={"name": "small[time.step=0.1]"})
    row = made_row(
        "dda", {"displacement.final": -0.5}, swept.name, work={"solves": 7}, seconds={"setup": 0.25}, estimate=1e-9
    )
    pair = between(swept.name, "dda", "bar", displacement_l2=0.125)
    derived = [{"scene": "small", "name": "ratio", "metrics": {"a": None}}]
    manifest = kept_study(Results(tmp_path), [(swept, row, None)], [pair], derived=derived)
    rows = list(tidy(Results(tmp_path), manifest))
    assert [(one.metric, one.value, one.unit) for one in rows] == [
        ("outcome", "completed", ""),
        ("displacement.final", -0.5, "m"),
        ("work.solves", 7, ""),
        ("seconds.setup", 0.25, "s"),
        ("estimate", 1e-9, ""),
        ("displacement.l2", 0.125, rows[5].unit),
        ("a", None, ""),
    ]
    assert [one.case for one in rows] == 6 * [swept.name] + [""] and {one.scene for one in rows} == {"small"}
    assert (rows[5].reference, rows[5].window, rows[0].window) == ("bar", 1.0, None)
    table = lines(rows)
    assert [line["time.step"] for line in table] == 6 * ["0.1"] + [""] and table[6]["value"] == table[0]["window"] == ""


def test_what_a_run_has_left_unmeasured_is_told(scene):
    gates = [Gate(scene.name, (solver,), "m", 0.0, 1.0, "r") for solver in ("dda", "bar")]
    made = Study("made", "t", "p", [scene], ("dda",), gates=lambda: tuple(gates), expects=(Outcome.OVERFLOW,))
    ends = {"dda": Outcome.RAISED, "bar": Outcome.TIMEOUT, "fem": Outcome.OVERFLOW, "layers": Outcome.REFUSED}
    verdicts = [Verdict(gates[0], None, Status.NOT_RUN, "w"), Verdict(gates[1], 0.5, Status.PASS, "")]
    bad = JudgedStudy(made, verdicts[:1], {("small", solver): end for solver, end in ends.items()})
    good = JudgedStudy(made, verdicts[1:], {("small", "dda"): Outcome.COMPLETED, ("small", "bar"): Outcome.NOT_RUN})
    none = JudgedStudy(made, [], {("small", "dda"): Outcome.UNSTABLE})
    assert [bad.refused, good.refused, bad.failed] == [True, False, [("small", "dda"), ("small", "bar")]]
    first, second, third = complaints([bad, good, none])
    assert first.endswith(": small dda and 1 more") and "no case" in second and " 1 gates " in third
    assert [one.partition(":")[0] for one in unjudged([bad, none])] == ["made"]
    assert "1 of 1" in next(missing_gates([bad, good], ["dda"])) and not [*missing_gates([bad, good], ["bar"])]
    assert [*missing_gates([good], ["layers"])] and covers("fem", "fem:full") and covers("fenicsx", "fenicsx:2")
    assert not covers("fem", "fenicsx") and not covers("bar", "bar-events")


def test_sources_of_users_are_the_first_that_a_worker_finds(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", ["a", "b"])
    worker = SimpleNamespace(local_directory=tmp_path)
    for _ in range(2):
        cluster.place_sources({"ours/deep/part.py": b"A = 1"}, worker)
    assert len(sys.path) == 3 and (Path(sys.path[0]) / "ours/deep/part.py").read_bytes() == b"A = 1"


# ---- what fails beside the solvers ----------------------------------------------------------------------------------


def test_what_fails_beside_a_solver_is_a_row(scene, monkeypatch):
    case = Case(scene, "dda")
    pending = Pending(case, case.key(), "study")
    assert pending.memory() > 0
    monkeypatch.setattr(measure, measure._executed.__name__, lambda *given: 1 / 0)
    row, history = pending.run()
    assert (row.outcome, history) == (Outcome.RAISED, None)
    assert (row.key, row.scene, row.solver, row.study) == (pending.key, "small", "dda", "study")
    assert row.notes == ("ZeroDivisionError: division by zero",)
    monkeypatch.setattr(memory, "needed", lambda *given: 1 / 0)
    assert pending.memory() == 0.0
    monkeypatch.setattr(Case, "key", lambda self: "another")
    assert "other sources" in pending.run()[0].notes[0]
    monkeypatch.setattr(Case, "key", lambda self: 1 / 0)
    assert pending.run()[0].notes == row.notes


class Closed(Broken):
    """A solver whose file is out of reach."""

    def solve(self, scene, full=False, fields=None):
        raise PermissionError(13, "Permission denied")


def test_a_file_that_cannot_be_written_is_refused_and_any_other_is_the_solver_s_own_failure(scene, tmp_path):
    assert measure.attempt(Closed("x"), scene, False)[1].outcome is Outcome.RAISED
    run = measure.attempt(Closed("x"), scene, False, fields=tmp_path / "f.vtu")[1]
    assert run.outcome is Outcome.REFUSED and run.notes == ("--fields: cannot be written: Permission denied",)


def test_files_and_sources_that_cannot_be_read_have_no_key(scene, monkeypatch):
    with pytest.raises(InputError) as error:
        Case(scene.with_values({"load.base_motion": "nowhere.csv"}), "dda").key()
    assert str(error.value.source) == "nowhere.csv"
    with pytest.raises(InputError) as error:
        case_module.source_digest("no_such_module")
    assert error.value.source == "no_such_module"
    monkeypatch.setattr(case_module, "LIBRARIES", ("numpy", "no-such-library"))
    assert case_module.library_versions.__wrapped__()["no-such-library"] == "not installed"


def test_a_pair_without_histories_has_no_value_and_numbers_without_meaning_are_undefined(tmp_path, monkeypatch):
    gate = Gate("s", ("dda", "bar"), "displacement.l2", 0, 1, "r", until=0.15)
    rows = {("s", solver): made_row(solver, {}, "s") for solver in gate.pair}
    assert evaluate(gate, Finished(rows, Results(tmp_path))).value is None
    for solver, size in (("dda", 1.0), ("bar", 2.0)):
        Results(tmp_path).append(rows["s", solver], made_history(0.1, [size, size]))
    verdict = evaluate(gate, Finished(rows, Results(tmp_path)))
    assert (verdict.value, verdict.why) == (pytest.approx(0.5), "")
    monkeypatch.setattr(judge_module, "pair", lambda *given: 1 / 0)
    assert evaluate(gate, Finished(rows, Results(tmp_path))).value == "undefined"


def test_a_scheduler_is_asked_for_its_executor_and_a_worker_for_its_memory(monkeypatch):
    told = []

    class Client:
        def __init__(self, address, timeout):
            if address == "nowhere":
                raise OSError("nobody")

        def __enter__(self):
            return self

        def __exit__(self, *error):
            told.append("closed")

        def get_executor(self, pure):
            return f"pure: {pure}"

    def nobody():
        raise ValueError

    fake = SimpleNamespace(Client=Client, get_worker=nobody)
    monkeypatch.setitem(sys.modules, "distributed", fake)
    with cluster.executor("somewhere") as executor:
        assert executor == "pure: False"
    assert told == ["closed"]
    with pytest.raises(InputError) as error, cluster.executor("nowhere"):
        pass
    assert error.value.field == "--scheduler"
    assert cluster.worker_memory() == math.inf
    for limit, bytes_of_case in ((12e9, 3e9), (0, math.inf)):
        manager = SimpleNamespace(memory_limit=limit)
        worker = SimpleNamespace(memory_manager=manager, state=SimpleNamespace(nthreads=4))
        monkeypatch.setattr(fake, "get_worker", lambda worker=worker: worker)
        assert cluster.worker_memory() == bytes_of_case


def test_a_worker_is_made_for_its_parent_and_ends_with_it(monkeypatch):
    """Nothing of this process is changed: what would be is noted."""
    noted = []
    monkeypatch.setattr(executor_module, "limit_process", lambda: noted.append("one thread"))
    monkeypatch.setattr(executor_module.signal, "signal", lambda *given: noted.append(given))
    monkeypatch.setattr(executor_module.ctypes, "CDLL", lambda name: SimpleNamespace())
    monkeypatch.setattr(executor_module, "solver_logs", list)
    thread = SimpleNamespace(start=lambda: noted.append("begun"))
    monkeypatch.setattr(executor_module.threading, "Thread", lambda target, args, daemon: noted.append(args) or thread)
    executor_module._initialize_worker(7, 40)
    ends = [(signal.SIGINT, signal.SIG_IGN), (signal.SIGTERM, signal.SIG_DFL), (signal.SIGHUP, signal.SIG_DFL)]
    assert noted == ["one thread", *ends, (7,), "begun"]
    parents = iter([7, 7, 7, 1])
    monkeypatch.setattr(executor_module.os, "getppid", lambda: next(parents))
    monkeypatch.setattr(executor_module, "PARENT_CHECK_INTERVAL", 0.0)
    monkeypatch.setattr(executor_module.os, os._exit.__name__, sys.exit)
    for parent, left in ((7, []), (8, [9])):
        with pytest.raises(SystemExit) as end:
            executor_module._end_with_parent(parent)
        assert end.value.code == 1 and [*parents] == left
        parents = iter([7, 9])


def test_a_pool_that_is_interrupted_is_not_waited_for(monkeypatch):
    done = []
    process = SimpleNamespace(terminate=lambda: done.append("terminated"))
    pool = SimpleNamespace(_processes={1: process}, shutdown=lambda **how: done.append(how))
    monkeypatch.setattr(executor_module, "ProcessPoolExecutor", lambda *given, **more: pool)
    with pytest.raises(KeyboardInterrupt), executor_module._pool(2):
        raise KeyboardInterrupt
    with executor_module._pool(2):
        pass
    both = [{"wait": wait, "cancel_futures": True} for wait in (False, True)]
    assert done == ["terminated", *both]


def test_a_cluster_that_loses_a_case_runs_it_here_and_one_that_breaks_it_tells_so(scene, monkeypatch):
    monkeypatch.setattr(executor_module, "run_in_own_process", lambda task: ("alone", task.key))

    class Broken(Executor):
        def submit(self, function, /, *given):
            future = Future()
            lost = function.__self__.key == "lost"
            future.set_exception(BrokenExecutor() if lost else ValueError("no pickle"))
            return future

    tasks = [Pending(Case(scene, "dda"), key, "study") for key in ("lost", "broken")]
    found = [*executor_module.executed(tasks, executor=Broken())]
    assert ("alone", "lost") in found
    (row,) = (one[0] for one in found if one[0] != "alone")
    assert (row.key, row.notes) == ("broken", ("ValueError: no pickle",))
