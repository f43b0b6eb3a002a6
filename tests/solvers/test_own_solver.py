"""A user's solver through the gates: the block at the end says what is right, what is wrong and where to look."""

import functools
import re
import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import thinned
from oracles.pages import write_my_solver
from oracles.processes import answer_here

from validation.engine.measure import completed
from validation.entry import plugin
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.solvers import user
from validation.solvers.processes.worker import WorkerHangs
from validation.solvers.registry import get_solver
from validation.suite.folders import get_study
from validation.suite.own_solver import block as block_module
from validation.suite.own_solver import block_data, gates
from validation.suite.own_solver import session as session_module
from validation.suite.own_solver.block import block, first
from validation.suite.own_solver.history import AT_REST, root
from validation.suite.own_solver.session import GateReport, Session
from validation.theory import spectra

ROOT = Path(__file__).parents[2]
ORACLES = ROOT / "tests/oracles"
HERE = Path(__file__).parent
APPLYING = gates.applying
TABLES = tomllib.loads((HERE / "own_solver.toml").read_text(encoding="utf-8"))
START = ("figure-8[time.start=zero]", "figure-8[time.start=consistent]", "figure-8[time.start=consistent,time.gg=0.95]")
FIGURES = (*START, "figures-5-6[contact.stiffness=1e+09]", "figures-3-4[time.step=0.002]")


@functools.cache
def few_gates():
    """Return the gates for a user's solver, were three studies all that there are."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gates, "judged_studies", lambda: ["limits", "stability-small", "subblocks"])
        return APPLYING.__wrapped__()


@pytest.fixture
def oracles(monkeypatch):
    monkeypatch.syspath_prepend(str(ORACLES))
    monkeypatch.setattr(gates, "applying", few_gates)
    answer_here(monkeypatch)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Return where runs of the suite's own solvers are kept for the next test."""
    return Results(tmp_path_factory.mktemp("results"))


@pytest.fixture(scope="module")
def reports_of(results):
    """Return what the gates on some scenes say of a solver, or those of start and data, each once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ORACLES))
        answer_here(patch)

        @functools.cache
        def reports_of(solver, scenes=None):
            patch.setattr(gates, "applying", APPLYING if scenes == FIGURES else few_gates)
            session = Session(f"six_unknowns:{solver}", results)
            return [session.judge(name)[1] for name in names_of(scenes)]

        yield reports_of


def names_of(scenes=None):
    every = gates.applying().items()
    return [name for name, (study, gate) in every if (gate.scene in scenes if scenes else study == gates.START.name)]


def failed(reports):
    return [report for report in reports if report.status == "FAIL"]


def test_gates_are_those_on_two_blocks_and_on_the_start():
    """Of the three studies one is of unstable steps and one of sub-blocks."""
    scenes = {gate.scene.partition("[")[0] for study, gate in few_gates().values() if study != gates.START.name}
    assert scenes == {"long-run"} and few_gates().keys() >= {gate.id for gate in gates.START.gates()}


# ---- slips ----------------------------------------------------------------------------------------------------------

WARNINGS = ("identical", "not repeatable")
COPIES = """
import numpy as np
import six_unknowns
from validation import solve as suite

def textbook(scene):
    return suite(scene, "dda-textbook").history

def noisy(scene):
    return tuple(x * (1 + 0.02 * np.random.default_rng().standard_normal(x.shape)) for x in six_unknowns.sound(scene))
"""


@pytest.mark.usefixtures("oracles")
@pytest.mark.parametrize(
    ("solver", "same_as", "warned"),
    [
        ("copies:textbook", {"dda-textbook"}, ["identical"]),
        ("copies:noisy", set(), ["not repeatable"]),
        ("six_unknowns:sound", set(), []),
    ],
)
def test_a_solver_of_the_suite_and_one_that_does_not_repeat_are_told(
    solver, same_as, warned, results, tmp_path, monkeypatch
):
    (tmp_path / "copies.py").write_text(COPIES)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(block_module, "compare", lambda *given: SimpleNamespace(sentence="a sentence", causes=[]))
    session = Session(solver, results)
    told = [session.judge(name)[1] for name in names_of(START[:1])]
    assert {name for t in told for name in t.same_as.split()} == same_as
    assert {t.group for t in told} >= {"start", "digits", "pressure"}
    assert {0.01 < t.apart < 0.1 for t in told} == {solver == "copies:noisy"}
    headings = [text.partition(":")[0].strip() for text in block(told)]
    assert [heading for heading in WARNINGS if heading in headings] == warned


def test_the_suites_own_dda_passes_in_its_own_place(tmp_path, monkeypatch):
    gate = next(gate for gate in get_study("core").gates() if gate.metric == "displacement.static")
    monkeypatch.setattr(gates, "applying", lambda: {gate.id: ("core", gate)})
    monkeypatch.setattr(session_module, "judged_studies", lambda: ["core"])
    assert Session("dda", Results(tmp_path)).judge(gate.id)[1].status == "PASS"


AUTHORS = TABLES["authors"]
THREE = (*START[:2], block_data.scenes()[0].name)


@pytest.mark.parametrize("author", thinned(AUTHORS, 4))
def test_what_an_author_can_do_wrong_is_said_once(author, reports_of):
    reports = reports_of(author, THREE)
    ending, scenes = AUTHORS[author]
    assert len({report.scene for report in reports if report.outcome == ending}) == scenes
    assert {report.outcome for report in reports} <= {ending, "completed"}
    assert sum(line.startswith(f"\n{ending}: ") for line in block(reports)) == 1


@pytest.mark.usefixtures("oracles")
def test_a_solver_that_hangs_is_not_tried_in_every_scene(tmp_path, monkeypatch):
    def ask(*request):
        raise WorkerHangs

    monkeypatch.setattr(user, "ask", ask)
    monkeypatch.setattr(Session, "parts", frozenset())
    session = Session("six_unknowns:sound", Results(tmp_path))
    judged = [session.judge(name) for name in names_of(THREE)]
    assert {verdict.gate.pair[1:] for verdict, _ in judged} == {(), ("dda-textbook",)}
    assert [row.outcome for row in session.rows.values()] == 2 * [Outcome.TIMEOUT]
    assert {report.status for _, report in judged if not report.outcome} == {"NOT RUN"}


@pytest.mark.long
def test_the_solver_of_the_page_passes_every_gate(tmp_path, monkeypatch):
    write_my_solver(tmp_path)
    answer_here(monkeypatch)
    monkeypatch.setattr(gates, "applying", APPLYING)
    monkeypatch.syspath_prepend(str(tmp_path))
    session = Session("my_solver:solve", Results(tmp_path / "results"))
    reports = [session.judge(name)[1] for name in gates.applying()]
    assert not [report.id for report in reports if report.status == "FAIL"]
    assert {report.group for report in reports if report.status == "PASS"} == {*gates.GROUPS, gates.BLOCK_DATA}


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
    for x in (np.zeros(200), np.ones(9)):
        assert root(scene, History(x, {"displacement": x})) is None


@pytest.mark.parametrize(
    ("pair", "metric", "lacks"),
    [
        (("dda",), "energy.drift", "modes"),
        (("dda",), "pressure.static", "static"),
        (("dda", "fem"), "mode1.damping", "modes"),
        *(
            (("dda",), name, None)
            for name in ("mode1.damping", "mode1.frequency", "displacement.static", "pressure.max")
        ),
    ],
)
def test_what_the_solver_does_not_report_is_not_run(pair, metric, lacks):
    scene, gate = load_scene("figure-8").expand()[0], Gate("s", pair, metric, 0, 1, "r")
    assert gates.lacking(gate, scene, set()) == lacks
    assert gates.lacking(gate, scene, {lacks}) is None


@pytest.mark.usefixtures("oracles")
def test_the_scene_of_a_million_steps_is_not_run_for_a_history_alone(tmp_path):
    session = Session("six_unknowns:sound", Results(tmp_path))
    names = [name for name in few_gates() if name.startswith("long-run")]
    assert names and {session.judge(name)[0].status for name in names} == {"NOT RUN"}
    assert not session.rows


# ---- authors --------------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("oracles")
def test_a_scene_that_is_not_for_the_solver_is_not_run(scene):
    run = completed(get_solver("six_unknowns:sound"), scene.with_values({"load.gravity": 9.81}))
    assert run.outcome is Outcome.NOT_APPLICABLE


# ---- the block ------------------------------------------------------------------------------------------------------

SOUND = GateReport(
    "id", "core", "s1", 200, "statics", "displacement.final", "PASS", 1.0, 0.9, 1.1, "", "completed", "k", "r"
)
RAISED = replace(SOUND, status="FAIL", value=None, why="E: step 3 (f.py:7, in g)", outcome="raised")
FAILED = replace(SOUND, status="FAIL", value=2.0, results="/nowhere")
BLOCKS = {  # what gates have said; `blocks.txt` holds what is printed of it, word by word
    "endings": [
        *(replace(RAISED, scene=f"s{n % 5}") for n in range(20)),
        replace(RAISED, why="E: step 4 (f.py:7, in g)"),
        replace(RAISED, why="E: step 3 (f.py:9, in h)"),
        *(replace(RAISED, scene=f"s{n}", why="wrong units: mm?", outcome="wrong units") for n in range(65)),
    ],
    "values": [replace(FAILED, scene=FIGURES[-1], value=value) for value in (1.1 + 1e-9, "undefined")],
}
KEPT = dict(
    text.split("\n", 1) for text in re.split(r"(?:\A|\n)== ", (HERE / "blocks.txt").read_text(encoding="utf-8"))[1:]
)


@pytest.mark.parametrize("name", BLOCKS)
def test_the_block_is_as_it_was(name):
    assert "\n".join(block(BLOCKS[name])) + "\n" == KEPT[name].removesuffix("\n") + "\n"


@pytest.mark.parametrize(("causes", "lines"), [(["start"], 2), (["unexplained"], 2), ([], 1), (None, 1)])
def test_what_compare_says_ends_the_block(causes, lines, monkeypatch):
    scene = gates.starts()[0]
    report = replace(FAILED, scene=scene.name, study="own-solver")
    x = np.ones(scene.time.steps)
    monkeypatch.setattr(Results, "history", lambda self, key: History(x, {"displacement": x}))

    def compare(*given):
        if causes is None:
            raise ZeroDivisionError("a sentence")
        return SimpleNamespace(sentence="a sentence", causes=causes)

    monkeypatch.setattr(block_module, "compare", compare)
    shown = block([report])
    (at,) = (n for n, line in enumerate(shown) if line.startswith(f"\ncompare, {scene.name}"))
    assert shown[at + 1].endswith("a sentence") and len(shown[at + 1 : -1]) == lines
    assert ("start" in shown[at + lines]) is (causes == ["start"])


# ---- data of the block ----------------------------------------------------------------------------------------------

WHAT_IS_MISREAD = TABLES["misread"]


@pytest.mark.long
@pytest.mark.parametrize("solver", WHAT_IS_MISREAD)
def test_a_datum_that_a_solver_misreads_is_named(solver, reports_of):
    told = reports_of(solver)
    scenes, misread = WHAT_IS_MISREAD[solver].values()
    data = block_data.datum_of()
    assert {t.group for t in failed(told)} <= {gates.BLOCK_DATA} and first(told, failed(told)) == []
    assert [data[t.scene].words for t in failed(told) if t.metric == AT_REST] == scenes
    lines = "\n".join(block(told)).split("\n")
    wrong = [line.removeprefix("wrong:  block data - ") for line in lines if line.startswith("wrong:")]
    assert len(wrong) == len(misread) and all(map(str.startswith, wrong, misread)), wrong
    assert not [line for line in lines if line.startswith("compare, ")]  # whose causes are those of other scenes
    assert all(kind in lines[-1] for kind in gates.KINDS if kind not in [datum.words for datum in data.values()])


SLIPS_OF_THE_SCHEME = TABLES["slips"]


@pytest.mark.long
@pytest.mark.parametrize("slip", SLIPS_OF_THE_SCHEME)
def test_a_slip_of_the_scheme_leaves_the_data_of_the_block_alone(slip, reports_of):
    told = reports_of(slip)
    assert not [t for t in told if t.metric == AT_REST and t.status != "PASS"]
    assert not [line for line in block(told) if line.startswith(f"wrong:  {gates.BLOCK_DATA}")]
    assert first(told, failed(told)) == [SLIPS_OF_THE_SCHEME[slip]]


@pytest.mark.long
@pytest.mark.parametrize(("slip", "group"), [("double_density", "frequency"), ("half_springs", "statics")])
def test_a_slip_lies_in_the_first_group_that_fails(slip, group, reports_of, monkeypatch):
    """What docs/judge.md shows is the block of twice the density."""
    told = reports_of(slip, FIGURES)
    assert first(told, failed(told)) == [group]
    if slip == "double_density":
        monkeypatch.setattr(block_module, "compare", lambda *given: SimpleNamespace(sentence="a sentence", causes=[]))
        page = (ROOT / "docs/judge.md").read_text(encoding="utf-8")
        (lines,) = re.findall(r"^```text\n(right:.*?)^```$", page, re.M | re.S)
        assert lines in "\n".join(block(told))


@pytest.mark.parametrize("is_discount_judged", [False, True])
def test_a_discount_is_suspected_where_no_other_scene_has_one(is_discount_judged):
    """The scenes of the data are damped by gg: a discount that is applied twice shows in them alone."""
    rectangle = block_data.scenes()[0].name
    of_data = replace(
        FAILED, scene=rectangle, study="own-solver", group=gates.BLOCK_DATA, metric="displacement.max", results="r"
    )
    others = [
        replace(SOUND, scene=scene.name, study="own-solver", group="digits", metric="displacement.max")
        for scene in gates.starts()
        if is_discount_judged or scene.time.discount == 1
    ]
    (line,) = [line for line in block([of_data, *others]) if "the moment of inertia" in line]
    assert ("gg" in line) is not is_discount_judged
