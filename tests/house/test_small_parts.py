"""Small parts that no other test looks into: notes and counts of a run, memory, outlines, sections, closed forms."""

from __future__ import annotations

import copy
import math
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import SCENE
from scipy.linalg import eigh

from fem_reference.exact.bar import applicable
from validation.errors import InputError
from validation.runs.files import read_csv, write_csv
from validation.runs.history import History
from validation.runs.modes import Mode, contact_index
from validation.scenes.outline import check_polygon, convex_quadrilateral
from validation.scenes.record import read_record
from validation.scenes.scene import Scene, load_scene, parse_scene
from validation.scenes.tables import BlockSection, LoadSection
from validation.solvers import memory
from validation.solvers.dda import SubBlocks, model_of
from validation.solvers.fem import problem_of
from validation.solvers.registry import get_solver
from validation.solvers.translation import tension_note, to_run
from validation.theory import spectra as expected
from validation.theory import statics

PENTAGON = [[0.0, 0.0], [3.0, 0.0], [4.0, 2.0], [2.0, 3.0], [-1.0, 2.0]]


@pytest.fixture
def scene(scene_file: Path) -> Scene:
    return load_scene(scene_file)


def scene_of(**changes: object) -> Scene:
    data = copy.deepcopy(tomllib.loads(SCENE))
    for name, value in changes.items():
        section, _, key = name.partition("__")
        data.setdefault(section, {})[key] = value
    return parse_scene(data, "x.toml")


def block(**changes: object) -> BlockSection:
    return BlockSection(**({"density": 2700.0, "young": 1e9} | changes))  # type: ignore[arg-type]


# ---- runs ---------------------------------------------------------------------------------------------------------


def test_a_run_keeps_every_count_second_and_note_of_a_solver_under_its_name(scene: Scene) -> None:
    time = np.array([0.1, 0.2])
    columns = {"displacement": np.array([-1.0, -2.0]), "contact_pressure": np.array([3.0, 4.0]), "rotation": time}
    result = SimpleNamespace(
        time=time, columns=columns, unknowns=2, nonzeros=3, factorisations=5, solves=7, notes=("own",),
        setup_seconds=11.0, stepping_seconds=13.0, estimate=17.0,
    )  # fmt: skip
    run = to_run(scene, result, ("first",))
    assert dict(run.work) == {"unknowns": 2, "nonzeros": 3, "factorisations": 5, "solves": 7, "steps": 50}
    assert dict(run.seconds) == {"setup": 11.0, "stepping": 13.0}
    assert (run.notes, run.estimate) == (("first", "own"), 17.0)
    assert run.history is not None and set(run.history.columns) == {"displacement", "contact_pressure"}
    del result.estimate
    assert to_run(scene, result).estimate is None


def test_tension_is_reported_at_its_worst_instant() -> None:
    time = 0.5 * np.arange(1, 6)
    history = History(time, {"contact_pressure": np.array([1.0, -2.0, 5.0, -7.5e3, -3.0])})
    assert tension_note(history) == ("the locked contact carries tension: -7500 Pa at t = 2 s",)
    assert tension_note(History(time, {"contact_pressure": np.array([0.0, 1.0, 2.0, 3.0, 0.0])})) == ()
    assert tension_note(History(time, {"displacement": -time})) == ()
    assert tension_note(History(time, {"contact_pressure": np.array([1.0, -2.0, np.nan, 0.0, 0.0])})) == ()


def test_a_history_until_an_instant_has_its_step_however_it_is_rounded() -> None:
    history = History(0.1 * np.arange(1, 11), {"displacement": np.arange(10.0)})  # 0.1 * 3 is above 0.3
    for end, count in ((0.3, 3), (0.6, 6), (0.65, 6), (0.05, 0), (2.0, 10)):
        until = history.until(end)
        assert len(until.time) == len(until.displacement) == count


def test_a_history_is_written_to_the_last_bit(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    history = History(
        np.arange(1.0, 9.0) / 3, {"displacement": rng.standard_normal(8) * 1e-7, "rotation": 1 / rng.random(8)}
    )
    write_csv(history, tmp_path / "h.csv")
    read = read_csv(tmp_path / "h.csv")
    assert np.array_equal(read.time, history.time) and list(read.columns) == ["displacement", "rotation"]
    assert all(np.array_equal(read.columns[name], values) for name, values in history.columns.items())
    assert (tmp_path / "h.csv").read_text().startswith("time,displacement,rotation\n")


def mode(share: float | None, *eigenvalues: complex) -> Mode:
    first, second = eigenvalues or (1.0, 0.5)
    return Mode(1.0, 1.0, (complex(first), complex(second)), share)


def test_radius_and_contact_mode() -> None:
    assert mode(None, 0.3, -0.9).spectral_radius == 0.9 and mode(None, 0.6 + 0.8j, 0.1).spectral_radius == 1.0
    assert contact_index([mode(0.9), mode(0.1), mode(-0.4), mode(0.3)]) == 2
    assert contact_index([mode(0.9)]) is None and contact_index([mode(None), mode(0.1)]) is None


def test_a_record_that_goes_back_is_named_by_its_instants(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("time,x\n0,0\n5,1\n3,2\n9,3\n")
    with pytest.raises(InputError, match="time must increase from row to row, got 3 after 5"):
        read_record(tmp_path / "r.csv")


# ---- memory -------------------------------------------------------------------------------------------------------


def bytes_of(solver: str = "fem", **changes: object) -> float:
    return memory.needed(scene_of(**changes), get_solver(solver))[0]


def test_memory_of_a_history_grows_by_its_columns_and_steps() -> None:
    """A number has 8 bytes and stands in at least one copy: columns count alike, and so do steps."""
    names = ["displacement", "contact_pressure", "rotation", "horizontal_displacement"]
    sizes = [bytes_of("dda", run__columns=names[:n], time__steps=10**6) for n in (1, 2, 3, 4)]
    steps = np.diff(sizes)
    assert steps.min() >= 8e6 and np.ptp(steps) == 0
    assert bytes_of("dda", time__steps=2 * 10**6) == pytest.approx(2 * bytes_of("dda", time__steps=10**6), rel=1e-12)


@pytest.mark.parametrize("solver", ["fem", "fem-60", "fenicsx", "fenicsx:2"])
def test_memory_of_a_mesh_grows_by_its_unknowns(solver: str) -> None:
    """2 (n d + 1)^2 unknowns, a little more than in proportion: the factor fills."""
    sizes = {
        (n, d): bytes_of(solver, fem__elements=n, fem__degree=d, block__poisson=0.3)
        for n, d in ((100, 1), (100, 2), (200, 1))
    }
    assert sizes[100, 2] == pytest.approx(sizes[200, 1], rel=0.02)
    assert 3.9 < sizes[200, 1] / sizes[100, 1] < 4.6
    assert sizes[200, 1] > 2 * 201**2 * 1000  # element matrices, indices and a factor are more than that


@pytest.mark.parametrize(
    ("solver", "changes", "column"),
    [
        ("fem", {}, True),
        ("fem", {"load__traction": 1.0}, False),
        ("fem", {"load__eccentricity": 0.1}, False),
        ("fem", {"load__base_motion": "quake.csv"}, False),
        ("fem", {"fem__foundation": "corner"}, False),
        ("fem", {"fem__cells": "triangles"}, False),
        ("fem", {"block__poisson": 0.1}, False),
        ("fenicsx", {}, False),
        ("fenicsx:4", {}, False),
    ],
    ids=str,
)
def test_memory_of_one_column_is_asked_only_where_one_column_will_do(
    solver: str, changes: dict[str, object], column: bool
) -> None:
    size = bytes_of(solver, **({"fem__elements": 300, "fem__degree": 1, "time__steps": 1} | changes))
    assert size < 1e7 if column else size > 2 * 301**2 * 1000


def test_memory_of_sub_blocks() -> None:
    """Six unknowns each, dense matrices; a square cut in two is twice as many."""
    squares = bytes_of("dda", block__subdivide=[30, 20], time__steps=1)
    triangles = bytes_of("dda", block__subdivide=[30, 20], block__pattern="triangles", time__steps=1)
    assert squares >= 8 * 3600**2 and triangles == pytest.approx(4 * squares, rel=1e-3)


def test_memory_that_is_there_is_what_the_system_says() -> None:
    meminfo = Path("/proc/meminfo")
    if not meminfo.exists():
        pytest.skip("the system does not say")
    lines = dict(line.split(":") for line in meminfo.read_text().splitlines())
    assert memory.available() == pytest.approx(1024 * int(lines["MemAvailable"].split()[0]), rel=0.3)


# ---- outlines and sections ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("vertices", "words"),
    [
        (((0, 0), (2, 0), (2, 1), (2, 0.5), (0, 2)), "cross themselves, got edges 1 and 2"),
        (((0, 0), (1, 0), (1.5, 1), (2, 0)), "cross themselves, got edges 0 and 3"),  # back over the first one
        (((0, 0), (1, 0), (2, 0)), "cross themselves"),
        (((0, 0), (0, 2), (1, 2), (1, 0)), "must run counter-clockwise"),
        (((0, 0), (4, 0), (4, 2), (2, 0), (0, 2)), "cross themselves"),  # a corner touches the base
    ],
)
def test_outlines_that_are_none(vertices: tuple[tuple[float, float], ...], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        check_polygon(vertices, 0, 1)


@pytest.mark.parametrize(
    "vertices",
    [
        tuple(map(tuple, PENTAGON)),
        ((0, 0), (3, 0), (3, 3), (2, 1), (1, 1), (0, 3)),  # a notch whose floor is in line with no edge
        ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (2, 2), (2, 3), (0, 3)),  # upright edges in one line that do not meet
        ((0, 0), (1, 0), (2, 0), (2, 1), (0, 1)),  # a vertex within a straight edge
    ],
    ids=["pentagon", "notch", "C", "straight"],
)
def test_outlines_that_are_sound(vertices: tuple[tuple[float, float], ...]) -> None:
    check_polygon(vertices, 0, 2)


@pytest.mark.parametrize(
    ("vertices", "convex"),
    [
        (((0, 0), (2, 0), (1.5, 1), (0, 1)), True),
        (((0, 0), (1, 0), (2, 0), (1, 1)), False),  # a straight corner
        (((0, 0), (2, 0), (0.5, 0.5), (0, 2)), False),
        (((0, 1), (1, 1), (1, 0), (0, 0)), False),  # clockwise
        (((0, 0), (2, 0), (1, 2)), False),
        (tuple(map(tuple, PENTAGON)), False),
    ],
)
def test_what_can_be_cut_into_sub_blocks(vertices: tuple[tuple[float, float], ...], convex: bool) -> None:
    assert convex_quadrilateral(vertices) is convex


def test_outline_edges_and_base_of_a_block() -> None:
    wide = block(width=3.0, height=0.5)
    assert wide.outline == ((0, 0), (3, 0), (3, 0.5), (0, 0.5)) and wide.base_length == 3.0
    five = block(vertices=PENTAGON, base=4, top=1)
    assert five.edge(4) == ((-1.0, 2.0), (0.0, 0.0)) and five.edge(3) == ((2.0, 3.0), (-1.0, 2.0))
    assert five.base_length == pytest.approx(math.sqrt(5))


@pytest.mark.parametrize(
    "changes", [{"eccentricity": 0.1}, {"traction": 1.0}, {"gravity": 1.0}, {"base_motion": "r.csv"}], ids=str
)
def test_a_centred_pressure_is_all_there_is(changes: dict[str, object]) -> None:
    assert LoadSection(pressure=1.0).centred
    assert not LoadSection(pressure=1.0, **changes).centred  # type: ignore[arg-type]


@pytest.mark.parametrize("changes", [{"traction": 1.0}, {"gravity": 1.0}, {"eccentricity": 0.1}], ids=str)
def test_the_bar_takes_a_centred_pressure_alone(tmp_path: Path, changes: dict[str, float]) -> None:
    def problem(**load: object):  # type: ignore[no-untyped-def]
        return problem_of(scene_of(**{f"load__{name}": value for name, value in load.items()}))

    assert applicable(problem()) is None
    assert "centred pressure only" in (applicable(problem(**changes)) or "")
    (tmp_path / "r.csv").write_text("time,y\n0,0\n1,1\n")
    assert "centred pressure only" in (applicable(problem(base_motion=str(tmp_path / "r.csv"))) or "")


# ---- the scene reaches the solvers --------------------------------------------------------------------------------


def test_a_scene_s_data_reach_the_block_the_glue_and_the_mesh() -> None:
    scene = scene_of(block__young=3e9, contact__shear_stiffness=4e8, block__subdivide=[3, 2], block__glue_ratio=20.0)
    model = model_of(scene)
    assert (model.contact.normal, model.contact.shear) == (1e9, 4e8)
    system = SubBlocks(scene, False).system
    assert system is not None and len(system.blocks) == 6
    lowest = {round(float(b.corners[:, 0].min()), 12) for b in system.blocks}
    assert len(lowest) == 3  # three along the base, two upwards
    inner = [joint for joint in system.joints if joint.second != -1]
    assert {(joint.normal, joint.shear) for joint in inner} == {(6e10, 6e10)}
    cut = SubBlocks(scene_of(block__subdivide=[3, 2], block__pattern="triangles"), False).system
    assert cut is not None and len(cut.blocks) == 12
    problem = problem_of(scene_of(contact__shear_stiffness=4e8, fem__cells="triangles"))
    assert (problem.stiffness, problem.shear_stiffness, problem.cells) == (1e9, 4e8, "triangles")


def test_modes_of_the_block_say_what_contact_pressure_they_carry() -> None:
    """Of a static pressure all modes together carry the whole."""
    modes = get_solver("dda").modes(scene_of())
    assert sum(m.contact_share or 0.0 for m in modes) == pytest.approx(1.0, rel=1e-12)
    assert sum(m.share for m in modes) == pytest.approx(1.0, rel=1e-12)
    assert contact_index(modes) == 1


def test_the_step_limit_is_that_of_the_highest_mode() -> None:
    """Central differences: 2 / w2 of the block's second mode, from det K / det M = w1^2 w2^2."""
    a, p, E, m = 2.0, 1e9, 1e9, 2700.0 * 4
    K = np.array([[2 * p, -p * a], [-p * a, E * a * a + p * a * a / 2]])
    limit = 2 / math.sqrt(eigh(K, m * np.diag([1, a * a / 12]), eigvals_only=True)[-1])
    below, above = (scene_of(time__alpha=0.0, time__delta=0.5, time__step=limit * f) for f in (0.999, 1.001))
    assert get_solver("dda").solve(below).history is not None
    with pytest.raises(InputError, match=r"time\.step: must not exceed"):
        get_solver("dda").solve(above)


# ---- closed forms of the gates ------------------------------------------------------------------------------------

OBLONG = {"block.width": 0.7, "block.height": 3.1, "contact.stiffness": 4e8, "block.young": 6e8}


@pytest.fixture
def oblong(scene: Scene) -> Scene:
    return scene.with_values(OBLONG)


def two_unknowns(scene: Scene) -> np.ndarray:
    """Return the frequencies of (v, ey): the springs' stretch is v - h ey / 2."""
    w, h = statics.size(scene)
    m, p, E = scene.block.density * w * h, scene.contact.stiffness, scene.block.young
    K = np.array([[2 * p, -p * h], [-p * h, E * w * h + p * h * h / 2]])
    return np.sqrt(eigh(K, m * np.diag([1, h * h / 12]), eigvals_only=True))


def test_both_frequencies_of_an_oblong_block(oblong: Scene) -> None:
    first, second = two_unknowns(oblong)
    assert expected.dda_frequency(oblong) == pytest.approx(first, rel=1e-12)
    assert expected.contact_frequency(oblong) == pytest.approx(second, rel=1e-12)


@pytest.mark.parametrize(
    ("alpha", "delta", "gg", "limit"),
    [
        (0.0, 0.5, 1.0, 2.0),  # central differences
        (1 / 6, 0.5, 1.0, 2 * math.sqrt(3)),  # linear acceleration
        (1 / 12, 0.5, 1.0, math.sqrt(6)),  # Fox-Goodwin
        (0.0, 0.7, 1.0, 1 / math.sqrt(0.35)),
        (0.0, 0.7, 0.9, math.sqrt(3.8 / (0.5 + 0.9 * 0.9))),
        (0.25, 0.5, 1.0, math.inf),
        (0.5, 1.0, 0.95, math.inf),
    ],
)
def test_the_limit_of_a_scheme_is_where_a_root_passes_minus_one(
    scene: Scene, alpha: float, delta: float, gg: float, limit: float
) -> None:
    case = scene.with_values({"time.alpha": alpha, "time.delta": delta, "time.gg": gg})
    assert expected.critical_omega(case) == pytest.approx(limit, rel=1e-12)
    if math.isfinite(limit):
        for factor, stable in ((0.9999, True), (1.0001, False)):
            frequency = factor * limit / case.time.step
            assert (expected.spectral_radius(case, frequency) <= 1 + 1e-12) is stable


def test_what_damping_has_left_at_the_last_step(oblong: Scene) -> None:
    case = oblong.with_values({"time.steps": 7, "time.gg": 0.9})
    radii = []
    for w in two_unknowns(case):
        h = (w * case.time.step) ** 2 / (1 + 0.5 * (w * case.time.step) ** 2)
        radii.append(np.max(np.abs(np.roots([1, -(1 - h / 2 + 0.9 * (1 - h)), 0.9 * (1 - h / 2)]))))
    assert expected.remaining_motion(case) == pytest.approx(max(radii) ** 7, rel=1e-10)


def bar_matrices(scene: Scene, n: int, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Return M and K of n linear or quadratic bar elements on the base spring 2 p."""
    w, h = statics.size(scene)
    rho, E, length = scene.block.density, scene.block.young, h / n
    if degree == 1:
        mass, stiff = np.array([[2, 1], [1, 2]]) / 6, np.array([[1, -1], [-1, 1]])
    else:
        mass = np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) / 30
        stiff = np.array([[7, -8, 1], [-8, 16, -8], [1, -8, 7]]) / 3
    M, K = np.zeros((2, degree * n + 1, degree * n + 1))
    for i in range(n):
        part = slice(degree * i, degree * (i + 1) + 1)
        M[part, part] += rho * w * length * mass
        K[part, part] += E * w / length * stiff
    K[0, 0] += 2 * scene.contact.stiffness
    return M, K


@pytest.mark.parametrize(("degree", "n", "band"), [(1, 20, 0.02), (2, 6, 0.05)])
def test_elements_overestimate_the_first_frequency_as_predicted(
    oblong: Scene, degree: int, n: int, band: float
) -> None:
    """The leading term of the error; the next one is (b / n)^2 of it."""
    case = oblong.with_values({"fem.elements": n, "fem.degree": degree})
    M, K = bar_matrices(case, n, degree)
    error = math.sqrt(eigh(K, M, eigvals_only=True)[0]) / expected.bar_frequency(case) - 1
    assert expected.mesh_frequency_error(case) == pytest.approx(error, rel=band)


def test_elements_that_the_front_passes_in_a_step(oblong: Scene) -> None:
    """It is c dt n / h with c = sqrt(E / rho)."""
    case = oblong.with_values({"fem.elements": 12})
    assert expected.elements_per_front(case) == pytest.approx(math.sqrt(6e8 / 2700) * 0.002 * 12 / 3.1, rel=1e-12)


def test_modes_and_shares_of_the_bar(oblong: Scene) -> None:
    w, h = statics.size(oblong)
    b = expected.bar_modes(oblong, 4000)
    ratio = 2 * 4e8 * h / (6e8 * w)
    assert np.abs(b[:50] * np.tan(b[:50]) / ratio - 1).max() <= 1e-11
    assert np.all((b > np.pi * np.arange(4000)) & (b < np.pi * (np.arange(4000) + 0.5)))
    # static values: the displacement's shares fall as 1 / b^2, the pressure's alternate as 1 / b
    assert expected.bar_shares(oblong, "displacement", b).sum() == pytest.approx(1.0, abs=1e-4)
    pressure = np.cumsum(expected.bar_shares(oblong, "contact_pressure", b))
    assert (pressure[-1] + pressure[-2]) / 2 == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("start", ["zero", "consistent"])
def test_the_response_of_a_mode_is_the_scheme_s(scene: Scene, start: str) -> None:
    case = scene.with_values({"time.alpha": 0.3, "time.delta": 0.6, "time.gg": 0.97, "time.start": start})
    omega, t = np.array([0.1, 1.0, 7.0]), case.time
    found = expected.bar_response(case, omega)
    D, V = np.zeros(3), np.zeros(3)
    A = omega**2 if start == "consistent" else np.zeros(3)
    for n in range(t.steps):
        ahead = D + t.discount * V + (0.5 - t.alpha) * A
        new = omega**2 * (1 - ahead) / (1 + t.alpha * omega**2)
        D = ahead + t.alpha * new
        V, A = t.discount * V + (1 - t.delta) * A + t.delta * new, new
        np.testing.assert_allclose(found[n], D, rtol=0, atol=1e-12)


@pytest.mark.parametrize("quantity", ["displacement", "pressure"])
@pytest.mark.parametrize("name", ["figure-8[time.alpha=0.25,time.delta=0.5]", "figure-9[time.gg=0.95]"])
def test_the_predicted_error_of_quadratic_elements_is_theirs(name: str, quantity: str) -> None:
    """Own quadratic elements, mode by mode, against the bar, where motion lasts and its phase is what is wrong.

    The prediction has the leading term of each mode alone, and not the error of its share.
    """
    case = next(case for case in load_scene(name.partition("[")[0]).expand() if case.name == name)
    n, t = case.fem.per_side, case.time
    M, K = bar_matrices(case, n, 2)
    squares, shapes = eigh(K, M)
    w, h = statics.size(case)
    F = np.zeros(len(M))
    F[-1] = -case.load.pressure * w
    row = np.zeros(len(M))
    if quantity == "displacement":
        row[n] = 1.0  # 2 n + 1 nodes: the middle one
    else:
        row[0] = -2 * case.contact.stiffness / w
    weights = (row @ shapes) * (shapes.T @ F) / squares
    mesh = expected.bar_response(case, np.sqrt(squares) * t.step) @ weights
    b = expected.bar_modes(case, 40 * n)
    static = row @ np.linalg.solve(K, F)
    shares = expected.bar_shares(case, quantity, b)
    speed = math.sqrt(case.block.young / case.block.density)
    bar = static * (expected.bar_response(case, b / h * speed * t.step) @ shares + (1 - shares.sum()))
    error = np.linalg.norm(mesh - bar) / np.linalg.norm(bar)
    assert expected.mesh_error(case)[quantity] == pytest.approx(error, rel=0.2)
