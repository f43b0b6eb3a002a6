"""Closed forms of the studies against other programs: impacts, plates, blocks that spin, slide or are pushed."""

import math

import numpy as np
import pytest

from validation.models.plane.canon import wedges_of
from validation.models.plane.glued import PlateSection
from validation.scenes.scene import load_scene
from validation.studies.beams.formulas import bending_ratio
from validation.studies.impacts import formulas as impacts
from validation.studies.plates.closed import disc_centre, disc_widening, hole_displacement
from validation.studies.pushing.exact import Pushing, at, events
from validation.suite.bands import cases
from validation.theory.spinning import Slide, Spinning

# ---- impacts -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("ratio", "known"), [(10, 2.0839173495), (100, 2.00839173495)])
def test_the_closed_form_of_a_release_is_that_of_the_independent_program(ratio, known):
    """At p/E = 10 and 100 the impacts of the bar are stiff: e^(-2 F) is left out."""
    (case,) = (case for case in cases("impact") if case.contact.stiffness == ratio * case.block.young)
    assert impacts.release(case) / impacts.transit(case) == pytest.approx(known, abs=1e-11)


# ---- plates and glued beams -----------------------------------------------------------------------------------------

PLATE = PlateSection(hole=1.0, radius=4.0, tension=1e6, cells=8)


def test_a_hole_and_a_disc_are_as_another_program_has_them():
    assert hole_displacement(3.0, 0.3, 1e6, 2e9, 0.2) == pytest.approx(0.0015 * (1 + 2 * math.cos(0.6)))
    assert PLATE.stresses(np.array([[0.0, 1.0], [1.0, 0.0]])) == pytest.approx(
        np.array([[3e6, 0.0, 0.0], [0.0, -1e6, 0.0]]), abs=1e-6
    )
    pressure = 1e6 / (2 * math.pi / 8)
    assert disc_centre(pressure, math.pi / 8) == pytest.approx((254849.282066966, -891469.054434547), rel=1e-12)


def test_a_disc_under_a_pressure_all_round_and_without_poisson_shrinks_as_it_must():
    assert disc_widening(1e6, math.pi / 2, 1e9, 0.25) == pytest.approx(-1e6 * (1 - 0.25) / 1e9, rel=1e-6)


@pytest.mark.parametrize(("n", "glue", "ratio"), [
    (4, 2.0, 1.81914893617), (8, 2.0, 1.07487539647), (8, 20.0, 4.30646296355),
    (3, 20.0, 21.0021786492), (4, 0.856117, 1.0), (8, 1.702458, 1.0), (16, 3.355015, 1.0),
])  # fmt: skip
def test_the_bending_stiffness_of_squares_is_that_of_an_independent_program(n, glue, ratio):
    assert bending_ratio(n, glue) == pytest.approx(ratio, rel=2e-6)


# ---- blocks that spin, and blocks on a ledge ------------------------------------------------------------------------

SQUARE = Spinning(2.0, 2.0, 2700.0, 1e8, 0.25, 20.0)
RECTANGLE = Spinning(1.9, 0.7, 2300.0, 6e8, 0.27, 31.0)
SWING = 0.0162591742724599694  # s


def test_a_square_swings_as_its_equation_of_one_unknown_has_it():
    half, whole = (SQUARE.at(np.array([time])) for time in (SWING / 2, SWING))
    assert half["ex"] == pytest.approx(0.00535691683443636, abs=1e-13)
    assert whole["ex"] == pytest.approx(0.0, abs=1e-13) and whole["gxy"] == pytest.approx(0.0, abs=1e-13)
    assert whole["angle"] == pytest.approx(0.323451928308864315, abs=1e-12)
    assert SQUARE.steady_strain == pytest.approx(0.00267842049503542, abs=1e-16)
    assert SQUARE.momentum == 144000


def test_a_rectangle_swings_by_the_polar_decomposition_of_its_motion():
    """Another program, which takes U and Q and Biot's stress apart."""
    moved = RECTANGLE.at(np.array([0.0047]))
    printed = {"ex": 0.00142572961894, "ey": -0.00043815827200, "gxy": 7.0472482971e-5, "angle": 0.145349803762614}
    assert {name: values[0] for name, values in moved.items()} == pytest.approx(printed, abs=2e-13)
    assert RECTANGLE.momentum == pytest.approx(32399.9083333333)


def test_a_rigid_block_tips_as_two_other_programs_have_it():
    rough = Slide(2.0, 1.0, 0.3, -1.5, 3.0)
    assert rough.tips == pytest.approx((0.670541516162, 1.026596317936), abs=1e-12)
    assert rough.turn(0.93) == pytest.approx(0.05450298, abs=5e-9)
    slow = Slide(1.3, 0.8, 0.21, -0.9, 2.9, 7.3)
    assert slow.tips == pytest.approx((0.30615303453, 2.43066739806), rel=1e-11)
    assert slow.turn(slow.tips[0] + 0.35) == pytest.approx(0.2494816879, abs=1e-9)
    smooth = Slide(2.0, 1.0, 0.0, -1.5, 0.5)
    assert smooth.tips == pytest.approx((3.0, 0.5))
    assert smooth.turn(3.829836472302) == pytest.approx(0.729337582516, abs=1e-11)
    stops = Slide(2.0, 1.0, 0.5, -1.5, 3.5)
    assert stops.tips is None and stops.turn(9.0) == 0.0
    assert stops.start + stops.stopping_distance == pytest.approx(-0.251274209990, abs=1e-12)
    with pytest.raises(ValueError, match="time"):
        rough.turn(0.94)  # the slide ends at 0.936 s


# ---- two blocks on a slope, and two wedges --------------------------------------------------------------------------

DEGREES = {angle: math.tan(math.radians(angle)) for angle in (10, 15, 25, 30)}
BOTH = Pushing((5400, 2700), (DEGREES[15], DEGREES[25]), math.radians(30), 2e7, 0.0, (0.2, 0.0))
STOPS = Pushing((2700, 5400), (DEGREES[10], DEGREES[30]), math.radians(20), 2e6, 0.02)
# Instants and ends of a second program, which integrates the pieces with events.
PRINTED = [
    (BOTH, 0.5, [0.0313172229962155, 0.268678358997054, 0.299995581993269], (0.322924377818377, 0.32921985547486)),
    (
        STOPS,
        0.8,
        [
            0.152067395054312,
            0.171945736411111,
            0.220211713863907,
            0.281148355146109,
            0.309217987299274,
            0.326106595548864,
            0.34168827064491,
            0.398344046725976,
            0.415689304999241,
            0.567406871293581,
        ],
        (0.0371789841702834, 0.0122318274830986),
    ),
]


@pytest.mark.parametrize(("problem", "until", "instants", "ways"), PRINTED, ids=["both slide", "stops"])
def test_the_pieces_give_the_events_and_the_ends_of_another_program(problem, until, instants, ways):
    assert [time for time, _ in events(problem, until)] == pytest.approx(instants, abs=1e-9)
    assert at(problem, until)[:2] == pytest.approx(ways, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("wedge-smooth", (2.90635693350331, 1.89698976319831, 350357.357515639, 1148495.855, 895355.775)),
        ("wedge-rough", (2.68944777998732, 1.75541236813698, 347800.184281387, 1107116.996, 956194.692)),
    ],
)
def test_wedges_move_as_another_program_has_them(name, printed):
    motion = wedges_of(load_scene(name).expand()[0]).motion()
    assert tuple(motion.values()) == pytest.approx(printed, rel=1e-9)


@pytest.mark.parametrize(
    ("below", "between", "printed"),
    [
        (35.0, 0.0, 1.07247267236957),
        (35.0, 20.0, 1.16335645885845),
        (35.0, 35.0, 1.24437551772442),
        (20.0, 0.0, 0.557474903518597),
        (20.0, 10.0, 0.601539427962898),
    ],
)
def test_factors_of_safety_are_those_of_another_program(below, between, printed):
    changes = {
        "plane.contact": [{"stiffness": 1e9, "friction": below}],
        "plane.pair": [[{"blocks": ["passive", "active"], "friction": between}]],
    }
    (case,) = load_scene("wedge-limit").model_copy(update={"sweep": changes}).expand()
    assert wedges_of(case).factor_of_safety == pytest.approx(printed, rel=1e-12)
