"""A user's solver through the gates: the block at the end says what is right, what is wrong and where to look."""

import os
import re
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import SCENE, thinned
from oracles.pages import write_my_solver
from oracles.processes import answer_here

from validation.engine.measure import completed
from validation.entry import plugin
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene, parse_scene
from validation.solvers import user
from validation.solvers.processes.user_worker import place_of
from validation.solvers.processes.worker import WorkerHangs
from validation.solvers.registry import get_solver
from validation.solvers.user import VARIABLE
from validation.suite.own_solver import block as block_module
from validation.suite.own_solver import block_data, gates
from validation.suite.own_solver.block import block, first, outside
from validation.suite.own_solver.history import AT_REST, root
from validation.suite.own_solver.session import GateReport, Session
from validation.theory import spectra

ROOT = Path(__file__).parents[2]
ORACLES = ROOT / "tests/oracles"
SLIPS = {  # of tests/oracles/six_unknowns.py: groups that the fault lies in, groups that are right
    "delta_missing": (["damping"], ["statics", "frequency", "start"]),
    "half_springs": (["statics"], []),
    "zero_start": (["start"], ["statics", "frequency", "damping"]),
    "consistent_start": (["start"], ["statics", "frequency", "damping"]),
    "late_pressure": (["pressure"], ["statics", "frequency", "damping", "start", "digits"]),
    "double_density": (["frequency"], ["statics"]),
}


# ---- slips ----------------------------------------------------------------------------------------------------------


def through_the_gates(solver, where, *options):
    """Run the gates on a solver as a user does, and return what pytest says."""
    command = [sys.executable, "-m", "pytest", "--pyargs", "validation", "-m", "validation", "-q", "-rN"]
    done = subprocess.run(
        [*command, "-p", "no:cacheprovider", "--dda-solver", solver, *options],
        capture_output=True,
        text=True,
        timeout=500,
        cwd=where,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    return done.stdout + done.stderr


COPIES = """
import numpy as np
import six_unknowns
from validation import solve as suite

def dda(scene):
    return suite(scene, "dda").history

def textbook(scene):
    return suite(scene, "dda-textbook").history

def noisy(scene):
    return tuple(x * (1 + 0.02 * np.random.default_rng().standard_normal(x.shape)) for x in six_unknowns.sound(scene))
"""


@pytest.mark.parametrize(
    ("solver", "same_as", "line"),
    [
        ("copies:dda", {"dda"}, "\nidentical: bit for bit the histories of the suite's own dda in 1 of 1 scenes"),
        ("copies:textbook", {"dda-textbook"}, "\nidentical: bit for bit the histories of the suite's own dda-textbook"),
        ("copies:noisy", set(), "\nnot repeatable: two runs of figure-8[time.start=zero] differ by "),
        ("six_unknowns:sound", set(), ""),
    ],
)
def test_a_solver_of_the_suite_and_one_that_does_not_repeat_are_told(solver, same_as, line, tmp_path, monkeypatch):
    (tmp_path / "copies.py").write_text(COPIES)
    monkeypatch.syspath_prepend(str(ORACLES))
    monkeypatch.syspath_prepend(str(tmp_path))
    answer_here(monkeypatch)
    monkeypatch.setattr(block_module, "compare", lambda *given: SimpleNamespace(sentence="a sentence", causes=[]))
    session = Session(solver, Results(tmp_path / "results"))
    names = [name for name, (_, gate) in gates.applying().items() if gate.scene == "figure-8[time.start=zero]"]
    told = [session.judge(name)[1] for name in names]
    assert {name for t in told for name in t.same_as.split()} == same_as
    assert all(t.repeated for t in told)
    assert {0.01 < t.apart < 0.1 for t in told} == {solver == "copies:noisy"}
    warnings = [text for text in block(told) if text.startswith(("\nidentical", "\nnot repeatable"))]
    assert [text[: len(line)] for text in warnings] == ([line] if line else [])


def page():
    return (ROOT / "docs/judge.md").read_text(encoding="utf-8")


@pytest.mark.long
def test_the_page_shows_the_block_of_twice_the_density():
    lines = re.search(r"^```text\n(right:.*?)^```$", page(), re.M | re.S)
    assert lines and lines[1] in through_the_gates("six_unknowns:double_density", ORACLES)


BUSY = """
import time
import my_solver

def solve(scene):
    began = time.perf_counter()
    found = my_solver.solve(scene)
    time.sleep(4 * (time.perf_counter() - began))
    return found
"""


@pytest.mark.long
def test_the_solver_of_the_page_passes_every_gate_on_a_machine_five_times_as_slow(tmp_path):
    write_my_solver(tmp_path)
    (tmp_path / "busy.py").write_text(BUSY)
    shown = through_the_gates("busy:solve", tmp_path)
    table = re.findall(r"^(\w+) +(\d+) +(\d+) +(\d+) +(\d+)   ", shown, re.M)
    assert [row[0] for row in table] == list(gates.GROUPS)
    assert all(int(row[1]) > 0 and row[2] == row[3] == "0" for row in table), shown
    assert "wrong:" not in shown and "block data: right with a rectangle that is no square\n" in shown


AUTHORS = {  # of tests/oracles/six_unknowns.py: what the block says once
    "raises_in_one_scene": r"^raised: ZeroDivisionError: no step left \(six_unknowns\.py:\d+, in raise_it\)\n",
    "not_a_number": r"^not a number: displacement at step 4\n  \d+ gates: ",
    "short": r"^wrong shape: displacement has shape \(\d+,\), not \(\d+,\)\n",
    "millimetres": r"^wrong units: displacement is 1000 times what is expected in SI, mm\?\n",
    "prints": r"^right:  statics, frequency, damping, start, digits, pressure\n",
    "hangs": r"^timeout: no history within 6 s, the time limit for 200 steps\n",
}


@pytest.mark.long
@pytest.mark.parametrize("author", AUTHORS)
def test_what_an_author_can_do_wrong_is_said_once(author):
    shown = through_the_gates(
        f"six_unknowns:{author}", ORACLES, "-k", "figure", *["--dda-timeout=5"] * (author == "hangs")
    )
    assert len(re.findall(AUTHORS[author], shown, re.M)) == 1, shown
    assert "not tried, since 2 scenes" in shown if author == "hangs" else "not tried" not in shown


def test_a_word_that_names_no_solver_is_refused():
    options = SimpleNamespace(addinivalue_line=lambda *_: None, getoption=lambda *_: "my_solver.py")
    with pytest.raises(pytest.UsageError, match=r"^--dda-solver: must be module:attribute, or a name"):
        plugin.pytest_configure(options)


@pytest.mark.long
def test_a_solver_that_cannot_be_loaded_is_refused_before_anything_runs(tmp_path):
    shown = through_the_gates("nope:solve", tmp_path)
    assert "ERROR: --dda-solver: solver: must be a module that Python finds, got 'nope:solve'" in shown
    assert "failed" not in shown


def gate_report(outcome, when="call"):
    node = "validation/test_gates.py::test_gate[a]"
    return pytest.TestReport(node, (node, 0, node), {}, outcome, None, when)


@pytest.mark.parametrize(
    ("reports", "status"),
    [
        ([gate_report("skipped"), gate_report("skipped")], pytest.ExitCode.TESTS_FAILED),
        ([gate_report("passed", "setup"), gate_report("skipped")], pytest.ExitCode.TESTS_FAILED),
        ([gate_report("skipped"), gate_report("passed")], pytest.ExitCode.OK),
        ([], pytest.ExitCode.OK),  # tests of somebody's own, which are no gates
    ],
)
def test_a_session_that_judged_nothing_fails(reports, status):
    reporter = SimpleNamespace(stats={"": reports})
    config = SimpleNamespace(pluginmanager=SimpleNamespace(get_plugin=lambda _: reporter))
    session = SimpleNamespace(config=config, exitstatus=pytest.ExitCode.OK)
    plugin.pytest_sessionfinish(session, session.exitstatus)
    assert session.exitstatus == status


@pytest.mark.long
def test_a_report_of_junit_brings_no_warnings(tmp_path):
    (tmp_path / "short.py").write_text("def solve(scene):\n    return [0.0], [0.0]\n")
    shown = through_the_gates("short:solve", tmp_path, "--junitxml=j.xml", "-k", "figures-3-4 and settling", "-n0")
    assert "warning" not in shown
    assert "dda-validation" in (tmp_path / "j.xml").read_text()


# ---- what a history shows -------------------------------------------------------------------------------------------


def swinging(scene, steps, noise=0.0):
    """Return -0.01 + sum of both modes' powers, as the step's roots in closed form make it, with noise."""
    n, x = np.arange(1, steps + 1), np.full(steps, -0.01)
    frequencies = spectra.dda_frequency(scene), spectra.contact_frequency(scene)
    for share, frequency in zip((0.009, 0.001), frequencies, strict=True):
        x = x + share * np.real(spectra.roots(scene, frequency)[0] ** n)
    x = x * (1 + noise * np.sin(1e3 * n**2))
    return History(scene.time.step * n, {"displacement": x})


def test_what_is_no_sum_of_two_modes_shows_none():
    scene = load_scene("figure-8").with_values({"time.alpha": 0.25, "time.delta": 0.5})
    assert root(scene, swinging(scene, 200, 0.01)) is None
    for x in (np.zeros(200), np.full(200, np.inf), np.ones(9)):
        assert root(scene, History(x, {"displacement": x})) is None


def test_what_the_solver_does_not_report_is_not_run():
    scene, gate = load_scene("figure-8").expand()[0], Gate("s", ("dda",), "energy.drift", 0, 1, "r")
    assert gates.lacking(gate, scene, {"static"}) == "modes" and gates.lacking(gate, scene, {"modes"}) is None
    gate = replace(gate, metric="pressure.static")
    assert gates.lacking(gate, scene, {"modes"}) == "static" and gates.lacking(gate, scene, {"static"}) is None
    for metric in ("mode1.damping", "mode1.frequency", "displacement.static", "pressure.max"):
        assert gates.lacking(replace(gate, metric=metric), scene, set()) is None
    assert gates.lacking(replace(gate, pair=("dda", "fem"), metric="mode1.damping"), scene, set()) == "modes"


def test_the_scene_of_a_million_steps_is_not_run_for_a_history_alone(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ORACLES))
    answer_here(monkeypatch)
    session = Session("six_unknowns:sound", Results(tmp_path))
    names = [name for name in gates.applying() if name.startswith("long-run")]
    assert names and {session.judge(name)[0].why for name in names} == {"the solver does not report modes(scene)"}
    assert not session.rows


# ---- authors --------------------------------------------------------------------------------------------------------


@pytest.fixture
def scene(scene_file, monkeypatch):
    monkeypatch.syspath_prepend(str(ORACLES))
    monkeypatch.chdir(ORACLES)
    answer_here(monkeypatch)
    return load_scene(scene_file)


def test_an_error_is_told_with_file_and_line_of_the_authors_own_code(scene):
    run = completed(get_solver("six_unknowns:raises"), scene)
    lines = (ORACLES / "six_unknowns.py").read_text().splitlines()
    number = 1 + next(
        n for n, line in enumerate(lines) if "np.linalg.solve(np.zeros" in line
    )  # which raises inside numpy
    assert run.notes == (f"LinAlgError: Singular matrix (six_unknowns.py:{number}, in raises)",)
    assert place_of(ValueError("of nobody's code"), ORACLES) == ""


def test_a_scene_that_is_not_for_the_solver_is_not_run(scene):
    run = completed(get_solver("six_unknowns:sound"), scene.with_values({"load.gravity": 9.81}))
    assert (
        run.outcome is Outcome.NOT_APPLICABLE and "a rectangle on springs that pull, under a pressure" in run.notes[0]
    )


def test_the_time_limit_grows_with_the_steps(monkeypatch):
    """20 steps have 0.1 s beside what is set, and 6000 have 30 s."""
    limits = []

    def ask(command, environment, request, limit):
        limits.append(limit)
        raise WorkerHangs

    monkeypatch.setattr(user, "ask", ask)
    monkeypatch.setenv(VARIABLE, "7")
    small, solver = parse_scene(tomllib.loads(SCENE), "small"), get_solver("sleepy:solve")
    runs = [completed(solver, small.with_values({"time.steps": steps})) for steps in (20, 6000)]
    assert limits == pytest.approx([7.1, 37.0]) and {run.outcome for run in runs} == {Outcome.TIMEOUT}


# ---- the block ------------------------------------------------------------------------------------------------------

SOUND = GateReport(
    "id", "core", "s1", 200, "statics", "displacement.final", "PASS", 1.0, 0.9, 1.1, "", "completed", "k", "r"
)


def of(**values):
    return replace(SOUND, **values)


def test_an_ending_is_told_once_with_its_scenes():
    raised = [
        of(scene=f"s{n % 5}", status="FAIL", value=None, why="E: step 3 (f.py:7, in g)", outcome="raised")
        for n in range(20)
    ]
    raised += [replace(raised[0], why="E: step 4 (f.py:7, in g)"), replace(raised[0], why="E: step 3 (f.py:9, in h)")]
    lines = block(raised)
    assert [line for line in lines if "f.py" in line] == [
        "\nraised: E: step 3 (f.py:7, in g)",
        "\nraised: E: step 3 (f.py:9, in h)",
    ]
    assert "  21 gates: s0, s1, s2 and 2 more scenes" in lines
    units = [
        of(scene=f"s{n}", status="FAIL", value=None, why="wrong units: mm?", outcome="wrong units") for n in range(65)
    ]
    assert "\n".join(block(units)).count("wrong units") == 1


def test_what_is_not_run_is_neither_right_nor_wrong():
    lines = block([SOUND, of(group="damping", status="NOT RUN", value=None, why="no modes", outcome="")])
    assert "\nright:  statics" in lines and "  1 gate: no modes" in lines
    assert not [line for line in lines if line.startswith("wrong")]


def test_failing_gates_are_counted_beyond_the_first_few():
    failed = [of(status="FAIL", value=2.0 + n, scene=f"s{n}") for n in range(5)]
    some, every = ("\n".join(block([replace(t, results="/nowhere") for t in failed], every=e)) for e in (False, True))
    assert some.count("is outside") == 3 and "and 2 more (-v lists them)" in some
    assert every.count("is outside") == 5


def test_a_value_is_seen_outside_its_band():
    assert outside(of(value=1.1 + 1e-9)).startswith("displacement.final = 1.100000001 is outside [0.9, 1.1")
    assert outside(of(value="undefined")) == "displacement.final is undefined; the band is [0.9, 1.1]"


@pytest.mark.parametrize(
    ("causes", "said"), [(["start"], "causes: start"), (["unexplained"], "not explained: "), ([], "a sentence")]
)
def test_what_compare_says_ends_the_block(causes, said, monkeypatch):
    scene = gates.starts()[0]
    failed = of(scene=scene.name, study="own-solver", status="FAIL", value=2.0)
    x = np.ones(scene.time.steps)
    monkeypatch.setattr(Results, "history", lambda self, key: History(x, {"displacement": x}))
    monkeypatch.setattr(block_module, "compare", lambda *given: SimpleNamespace(sentence="a sentence", causes=causes))
    lines = block([failed])
    assert "\ncompare, figure-8[time.start=zero] (200 steps)" in lines and lines[-2].startswith(f"  {said}")
    monkeypatch.setattr(block_module, "compare", lambda *given: 1 / 0)
    assert block([failed])[-2] == "  nothing can be said: division by zero"


# ---- data of the block ----------------------------------------------------------------------------------------------


def told_by(solver, results, study="own-solver"):
    """Return what the gates on the start and on data of the block say of a solver."""
    session = Session(solver, Results(results))
    return [session.judge(name)[1] for name, (owner, _) in gates.applying().items() if owner == study]


@pytest.fixture(autouse=True)
def oracles(monkeypatch):
    monkeypatch.syspath_prepend(str(ORACLES))


WHAT_IS_MISREAD = {  # of tests/oracles/six_unknowns.py: scenes that fail where they rest, what is named
    "sound": ([], []),
    "plane_stress": (["plane strain"], ["plane stress is assumed"]),
    "plane_strain": (["Poisson's ratio", "shear springs of their own stiffness"], ["plane strain is assumed"]),
    "interchanged": (["a rectangle that is no square"], ["width and height are interchanged"]),
    "squared": (["a rectangle that is no square"], ["the width is taken for the height"]),
    "without_poisson": (
        ["Poisson's ratio", "plane strain", "shear springs of their own stiffness"],
        ["block.poisson is not read"],
    ),
    "one_stiffness": (["shear springs of their own stiffness"], ["contact.shear_stiffness is not read"]),
    "without_shear": (
        ["Poisson's ratio", "plane strain", "shear springs of their own stiffness"],
        ["there are no shear springs"],
    ),
    "central": (["an off-centre load"], ["load.eccentricity is not read"]),
    "without_poisson_and_central": (
        ["Poisson's ratio", "plane strain", "shear springs of their own stiffness", "an off-centre load"],
        ["block.poisson is not read", "load.eccentricity is not read"],
    ),
    "turned_plane": (["plane strain"], ["plane strain: rests at "]),  # no misreading that is known
}


@pytest.mark.parametrize("solver", thinned(WHAT_IS_MISREAD, 8))
def test_a_datum_that_a_solver_misreads_is_named(solver, tmp_path, monkeypatch):
    answer_here(monkeypatch)
    told = told_by(f"six_unknowns:{solver}", tmp_path)
    failed = [t for t in told if t.status == "FAIL"]
    scenes, misread = WHAT_IS_MISREAD[solver]
    data = block_data.datum_of()
    assert {t.group for t in failed} <= {gates.BLOCK_DATA} and first(told, failed) == []
    assert [data[t.scene].words for t in failed if t.metric == AT_REST] == scenes
    lines = "\n".join(block(told)).split("\n")
    wrong = [line.removeprefix("wrong:  block data - ") for line in lines if line.startswith("wrong:")]
    assert len(wrong) == len(misread) and all(map(str.startswith, wrong, misread)), wrong
    assert not [line for line in lines if line.startswith("compare, ")]  # whose causes are those of other scenes
    assert lines[-1].startswith("no gate saw: an outline that is no rectangle, a shear load, gravity, ")


SLIPS_OF_THE_SCHEME = ("gg_twice", "delta_missing", "zero_start", "consistent_start", "late_pressure")


@pytest.mark.long
@pytest.mark.parametrize("slip", thinned(SLIPS_OF_THE_SCHEME, 5))
def test_a_slip_of_the_scheme_leaves_the_data_of_the_block_alone(slip, tmp_path, monkeypatch):
    answer_here(monkeypatch)
    told = told_by(f"six_unknowns:{slip}", tmp_path)
    assert not [t for t in told if t.metric == AT_REST and t.status != "PASS"]
    assert not [line for line in block(told) if line.startswith(f"wrong:  {gates.BLOCK_DATA}")]
    wrong, _ = SLIPS.get(slip, (["damping"], []))
    assert first(told, [t for t in told if t.status == "FAIL"]) == wrong


@pytest.mark.parametrize("is_discount_judged", [False, True])
def test_a_discount_is_suspected_where_no_other_scene_has_one(is_discount_judged):
    """The scenes of the data are damped by gg: a discount that is applied twice shows in them alone."""
    rectangle = block_data.scenes()[0].name
    failed = of(scene=rectangle, study="own-solver", group=gates.BLOCK_DATA, metric="displacement.max", status="FAIL")
    others = [
        of(scene=scene.name, study="own-solver", group="digits", metric="displacement.max")
        for scene in gates.starts()
        if is_discount_judged or scene.time.discount == 1
    ]
    (line,) = [line for line in block([failed, *others]) if "the moment of inertia" in line]
    assert ("gg" in line) is not is_discount_judged


def test_wrong_statics_of_the_square_are_looked_for_first():
    at = block_data.scenes()[0]
    failed = of(scene=at.name, study="own-solver", group=gates.BLOCK_DATA, metric=AT_REST, status="FAIL", value=-1.0)
    lines = block([of(status="FAIL", value=2.0, results="/nowhere"), replace(failed, results="/nowhere")])
    assert [line.split(" - ")[0] for line in lines if line.startswith("wrong:")] == ["wrong:  statics"]
    assert f"        {gates.BLOCK_DATA}: may follow from it, look again when it is right" in lines


def test_a_scheme_that_does_not_damp_hides_a_misread_datum_but_makes_none_up(tmp_path, monkeypatch):
    answer_here(monkeypatch)
    told = told_by("six_unknowns:undamped", tmp_path)
    assert not [t for t in told if t.metric == AT_REST and t.status != "PASS"]
