"""What holds of every solver of the registry, on every scene that it takes: a new solver is tested by its name alone.

The units of length, mass and time are free; what is asked for later does not change what came before; a linear motion
goes with its load; to ask again, for less, or without savings gives the same numbers.
"""

import numpy as np
import pytest
from conftest import thinned
from oracles.stated_scenes import KINDS, RECORD, SCENES, UNITS, asked, made, scaled

from validation import response
from validation.metrics.contact import imbalance
from validation.runs.run import Outcome
from validation.scenes.scene import parse_scene
from validation.solvers.contract import NotReported
from validation.solvers.opened import resultant_load
from validation.solvers.registry import BUILT_IN, get_solver

USUAL = ("displacement", "contact_pressure")
NOT_LINEAR = (
    *("opening in a ramp", "adaptive", "opening", "opening sub-blocks", "landing", "sliding", "lagged", "turning"),
    *("dashpots", "impact"),
    *("column that opens", "column that slips", "bars that open", "bars that slip"),
)
OF_CONTACTS = NOT_LINEAR[-4:]  # columns


def mirrored(scene, directory):
    """Return a scene seen from behind: what is at the right is at the left."""
    data = scene.definition()
    block, load = data["block"], data["load"]
    if "vertices" in block:  # again anticlockwise from the base on
        block["vertices"] = [[-x, y] for x, y in np.roll(block["vertices"][::-1], 2, axis=0)]
    for table, key in ((load, "traction"), (load, "slope"), (block, "tilt")):
        if key in table:
            table[key] = -table[key]
    if "base_motion" in load:
        load["base_motion"] = str(directory / "mirrored.csv")
        rows = np.array(RECORD) * (1, -1, 1)
        np.savetxt(load["base_motion"], rows, "%.17g", ",", header="time,x,y", comments="")
    return parse_scene(data, "mirrored")


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    """Return where the motions of bases are kept, so that equal scenes are equal."""
    return tmp_path_factory.mktemp("records")


RUNS = {}


def solved(solver, scene, full=False):
    """Return the columns of a run, made once; no test changes them."""
    key = (solver, repr(scene.definition()), full)
    if key not in RUNS:
        RUNS[key] = solved_afresh(solver, scene, full)
    return RUNS[key]


def solved_afresh(solver, scene, full=False):
    run = get_solver(solver).solve(scene, full=full)
    assert run.outcome is Outcome.COMPLETED and run.history is not None, run.notes
    assert list(run.history.time) == pytest.approx([scene.time.step * n for n in range(1, scene.time.steps + 1)])
    return run.history.columns


def static(solver, scene):
    """Return the static solution, nothing where none is reported."""
    try:
        return {name: np.array(value) for name, value in get_solver(solver).static(scene).items()}
    except NotReported:
        return {}


def assert_same(values, expected, rounding):
    """Compare columns, each over its largest value; one that is nothing beside the others may be anything as small."""
    assert values.keys() == expected.keys()
    for name, wanted in expected.items():
        assert np.abs(values[name] - wanted).max() <= rounding * np.abs(wanted).max(), name


TAKES = {solver: [name for name, scene in SCENES.items() if solver in scene["solvers"]] for solver in BUILT_IN}


def pairs(solver):
    """Return a solver with its scenes; FEniCSx is another program, which is started for few short tests."""
    marks = [pytest.mark.fenicsx, pytest.mark.long] if solver == "fenicsx" else []
    return [pytest.param(solver, name, id=f"{solver}-{name}", marks=marks) for name in TAKES[solver]]


EVERY = [pair for solver in BUILT_IN for pair in pairs(solver)]
LINEAR = [param for param in EVERY if param.values[1] not in NOT_LINEAR]
OF_BLOCKS = [param for param in EVERY if "column" not in SCENES[param.values[1]]]


def some(params, every):
    """Parametrise a test by all solvers and scenes of a list, every n-th of them in the short tests."""
    return pytest.mark.parametrize(("solver", "name"), thinned(params, every))


@pytest.mark.parametrize("solver", BUILT_IN)
def test_a_solver_takes_its_scenes_and_no_others(solver, records):
    adapter = get_solver(solver)
    assert [name for name in SCENES if adapter.refusal(made(name, records)) is None] == TAKES[solver]


@some(EVERY[3:] + EVERY[:3], 43)
def test_units_are_free(solver, name, records):
    scene = asked(solver, made(name, records))
    columns = solved(solver, scene)
    other = solved(solver, asked(solver, made(name, records, UNITS)))
    expected = {column: values * scaled(KINDS.get(column, "number"), UNITS) for column, values in columns.items()}
    assert_same(other, expected, 1e-9)


@some(EVERY[::2], 41)
def test_what_comes_later_changes_nothing(solver, name, records):
    scene = asked(solver, made(name, records))
    longer = solved(solver, scene.with_values({"time.steps": 3 * scene.time.steps}))
    beginning = {column: values[: scene.time.steps] for column, values in longer.items()}
    assert_same(solved(solver, scene), beginning, 1e-9)


@some(EVERY[3::2], 41)
def test_asked_again_for_one_column_it_gives_the_same(solver, name, records):
    scene = asked(solver, made(name, records))
    columns = solved(solver, scene)
    again = solved_afresh(solver, scene)
    assert all(np.array_equal(again[column], values) for column, values in columns.items())
    last = list(columns)[-1]
    assert_same(solved(solver, scene.with_values({"run.columns": [last]})), {last: columns[last]}, 1e-12)


@some([param for param in EVERY if param.values[0] in ("dda", "dda-textbook", "fem")], 7)
def test_without_savings_it_gives_the_same(solver, name, records):
    scene = asked(solver, made(name, records))
    assert_same(solved(solver, scene, full=True), solved(solver, scene), 1e-8)


@some(LINEAR, 11)
def test_a_linear_motion_goes_with_its_load(solver, name, records):
    """The negative of twice the load, the negative of twice the motion and of what it ends at; of no load none."""
    scene = asked(solver, made(name, records))
    other = asked(solver, made(name, records, load=-2.0))
    still = asked(solver, made(name, records, load=0.0))
    for answer in (solved, static):
        values = answer(solver, scene)
        assert all(np.any(values[column]) for column in values.keys() & set(USUAL))
        assert_same(answer(solver, other), {column: -2 * value for column, value in values.items()}, 1e-11)
        assert not any(np.any(value) for value in answer(solver, still).values())


@some(OF_BLOCKS, 11)
def test_left_is_the_mirror_image_of_right(solver, name, records):
    """Even are v, the pressure, a discount and what is counted, odd are u and the rotation."""
    even = (*USUAL, "discount", "solves", "cuts")
    scene = asked(solver, made(name, records))
    other = solved(solver, mirrored(scene, records))
    columns = solved(solver, scene)
    assert_same(other, {column: values if column in even else -values for column, values in columns.items()}, 1e-9)


OPENED = [param for param in EVERY if param.values[1] in NOT_LINEAR and param.values[1] != "adaptive"]


def carried(scene):
    """Return the mass [kg] and the resultant of pressure and weight [N] that a contact record balances."""
    if scene.column is None:
        return scene.block.mass, resultant_load(scene)
    mass = sum(layer.thickness * layer.density for layer in scene.column.layer)
    return mass, mass * scene.column.gravity


@some(OPENED[2:] + OPENED[:2], 9)
def test_what_a_contact_does_keeps_momentum_and_energy(solver, name, records):
    """Momentum: m (V - V0) and the loads' impulse are the contact's; energy: stored and lost are those of the start."""
    scene = asked(solver, made(name, records))
    prepared = get_solver(solver).prepare(scene)
    prepared.keeps_contact_record = True
    prepared.run()
    try:
        record = prepared.contact_record()
    except NotReported:
        assert solver == "bars-events"
        return
    mass, load = carried(scene)
    if name != "opening in a ramp":
        gained = mass * (record.velocity - record.start_velocity) + load * record.time
        assert gained == pytest.approx(record.impulse, abs=1e-9 * record.impulse.max())
    if "slip" not in name:  # whose force is that of friction
        assert record.force.min() >= 0
    assert record.penetration.min() >= 0 <= record.gap.min()
    if name not in ("dashpots", "impact"):  # let go before springs have come back; act on velocities alone
        assert not record.penetration[record.open_share == 1].any()
    if name == "landing" and record.rebounds is not None:
        speed = np.hypot(1.0, np.sqrt(2 * 9.81 * 0.005))  # of the fall through the gap; steps know it to g dt
        assert record.rebounds[0].closing == pytest.approx(speed, abs=9.81 * scene.time.step)
    assert record.open_share.min() >= 0 and record.open_share.max() <= 1
    if record.energies:
        assert imbalance(record) < 1e-11
        lost = {"dashpots": "dashpot", "impact": "impact"}.get(name)
        assert lost is None or record.energies[lost][-1] > 0


# A dashpot that begins with a jump of its force and an impact at the end of a step leave errors of no one order.
TRUTHS = [("block-events", name) for name in TAKES["block-events"] if name not in ("dashpots", "impact")]
TRUTHS += [("column-events", name) for name in OF_CONTACTS]
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}


@pytest.mark.parametrize(
    ("truth", "name", "scheme", "ratio"),
    thinned(((*truth, *scheme) for scheme in (({}, 2.0), (AVERAGE, 4.0)) for truth in TRUTHS), 9),
)
def test_steps_tend_to_the_exact_motion_by_their_order(truth, name, scheme, ratio, records):
    """Half the step leaves a half of the error of order one, a quarter of order two: in size, in sign, in every column.

    A switch lies between two steps, which leaves a tenth of the errors beside their order.
    """
    scene = asked(truth, made(name, records).with_values(scheme))
    exact = solved(truth, scene)
    errors = []
    for parts in (32, 64):
        finer = scene.with_values({"time.step": scene.time.step / parts, "time.steps": scene.time.steps * parts})
        columns = solved("dda", finer)
        errors.append({column: columns[column][parts - 1 :: parts] - values for column, values in exact.items()})
    for column, coarse in errors[0].items():
        fine = errors[1][column]
        if np.abs(fine).max() > 1e-12 * np.abs(exact[column]).max():
            assert (coarse @ fine) / (fine @ fine) == pytest.approx(ratio, rel=0.11), column


def test_a_damped_bar_answers_as_its_fine_mesh(records):
    scene = made("damped", records).with_values({"time.gg": 0.97, "fem.elements": 48})
    for frequency in (13.0, 60.0):
        bar, mesh = (response(scene, frequency, solver).columns for solver in ("bar", "fem"))
        for column in USUAL:
            assert bar[column] == pytest.approx(mesh[column], rel=1e-6), column
