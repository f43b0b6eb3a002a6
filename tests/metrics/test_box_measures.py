"""What is measured on positions of boxes: a toy engine with known faults gives what its faults are worth."""

from types import SimpleNamespace

import numpy as np
import pytest

from validation.models.plane import measures
from validation.models.plane.boxes import boxes_of
from validation.models.plane.problems import box_problems
from validation.problems.judge import judge
from validation.runs.history import History

GAIN = "largest gain of energy"
CONTACT_TIME, PEAK = "time of contact", "peak force as reported"


def flat_engine(scene, parts=1, bounce=None):
    """Step one box that stays flat by symplectic Euler: velocities, impulses at the velocities, positions."""
    ground = boxes_of(scene)
    box = ground.boxes[0]
    e = ground.rebound if bounce is None else bounce
    step = scene.time.step / parts
    along, across = ground.pull
    x, y, _ = ground.starts[0]
    u, v = box.velocity
    rows = []
    for n in range(scene.time.steps * parts):
        u += along * step
        v += across * step
        impulse = 0.0
        if y + v * step < box.reach and v < 0:
            impulse = -v
            v = -e * v if -v > 2 * abs(across) * step else 0.0
        grip = ground.friction_coefficient * impulse
        u -= max(-grip, min(grip, u))
        x += u * step
        y += v * step
        if (n + 1) % parts == 0:
            rows.append((x, y))
    time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
    columns = np.array(rows).T
    return History(time, {"box.x": columns[0], "box.y": columns[1], "box.angle": np.zeros(len(time))})


def numbers(name, history, **values):
    """Return the numbers of an answer to a problem's scene, and their words, by name."""
    problem = box_problems()[name]
    scene = problem.scene().with_values(values)
    judged = judge(SimpleNamespace(name=name, scene=scene, numbers=problem.quantities(scene)), history)
    both = zip(judged.criteria, judged.quantities, strict=True)
    return {one.name: (number.value, one.status) for one, number in both}


def scene_of(name, **values):
    return box_problems()[name].scene().with_values(values)


@pytest.mark.parametrize("friction", [19.0, 22.0])
def test_a_box_on_a_slope_stands_or_slides(friction):
    values = {"plane.contact.friction": friction, "time.steps": 50}
    history = flat_engine(scene_of("standing", **values), parts=20)
    assert {word for _, word in numbers("standing", history, **values).values()} == {"PASS"}


@pytest.mark.parametrize(("bounce", "word"), [(0.5, "PASS"), (0.492, "PASS"), (0.488, "FAIL"), (0.512, "FAIL")])
def test_the_restitution_is_measured_from_positions(bounce, word):
    history = flat_engine(scene_of("restitution"), bounce=bounce)
    value, got = numbers("restitution", history)["restitution"]
    assert value == pytest.approx(bounce, rel=1e-9)
    assert got == word


def test_no_row_beside_an_impact_is_one_of_a_flight():
    """The impact of the exact motion may come anywhere between two rows; the energy of a flight never knows of it."""
    from validation.solvers.registry import solve

    for lift in np.linspace(0.9, 1.1, 23):
        thrown = {"plane.block.1.velocity": [0.3, -0.2], "plane.block.1.spin": round(float(lift) - 1, 2)}
        at = {"plane.block.1.at": [0.0, 0.25 + float(lift)]}
        scene = scene_of("bouncing", **thrown, **at, **{"time.steps": 200})
        history = solve(scene, "rigid-exact").history
        ground = boxes_of(scene)
        energy = measures.energies(history, ground)[measures.in_flight(history, ground)]
        np.testing.assert_allclose(energy, measures.first_energy(ground), rtol=1e-9)


@pytest.mark.parametrize(("bounce", "gain", "word"), [(1.0, 0.0, "PASS"), (1.02, 0.0404, "FAIL")])
def test_a_gain_of_energy_is_seen(bounce, gain, word):
    values = {"time.steps": 80}  # one impact
    history = flat_engine(scene_of("bouncing", **values), parts=64, bounce=bounce)
    found = numbers("bouncing", history, **values)[GAIN]
    assert found == (pytest.approx(gain, abs=3e-3), word)


def test_what_cannot_be_measured_fails_unless_it_is_optional():
    history = flat_engine(scene_of("impact"))
    standing = History(history.time, history.columns | {"box.y": np.full(len(history.time), 0.6)})
    found = numbers("impact", standing)
    assert found[CONTACT_TIME] == (None, "FAIL")
    assert PEAK not in found


def test_the_peak_between_rows():
    x = np.linspace(0, 1, 12)
    assert measures.peak(3 - 5 * (x - 0.4321) ** 2) == pytest.approx(3, rel=1e-12)
    assert measures.peak(x) == 1.0
    assert measures.peak(np.array([5.0, 1.0, 2.0])) == 5.0


def test_the_first_contact_is_timed_between_rows():
    def seconds(*gap):
        return measures.contact_time(History(np.arange(1.0, 1 + len(gap)), {}), np.array(gap))

    assert seconds(1.0, -1.0, -1.0, 3.0, -1.0) == pytest.approx(1.75)  # from 1.5 to 3.25
    assert seconds(1.0, 0.5, 0.1) is seconds(1.0, -1.0, -2.0) is None
    uneven = History(np.array([1.0, 2.0, 4.0, 8.0]), {})
    assert measures.contact_time(uneven, np.array([1.0, -1.0, -1.0, 3.0])) == pytest.approx(3.5)  # from 1.5 to 5
