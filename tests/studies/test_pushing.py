"""Two blocks on a slope and two wedges: closed forms against numbers of another program, and scenes that state them."""

import math

import pytest

from validation.models.plane.canon import wedges_of
from validation.scenes.scene import load_scene
from validation.studies.pushing.exact import Pushing, at, events

DEGREES = {angle: math.tan(math.radians(angle)) for angle in (10, 15, 25, 30, 40)}
BOTH = Pushing((5400, 2700), (DEGREES[15], DEGREES[25]), math.radians(30), 2e7, 0.0, (0.2, 0.0))
HELD = Pushing((5400, 2700), (DEGREES[10], DEGREES[40]), math.radians(30), 2e7, 0.05)
STOPS = Pushing((2700, 5400), (DEGREES[10], DEGREES[30]), math.radians(20), 2e6, 0.02)
# Instants and ends of a second program, which integrates the pieces with events.
PRINTED = [
    (BOTH, 0.5, [0.0313172229962155, 0.268678358997054, 0.299995581993269], (0.322924377818377, 0.32921985547486)),
    (
        HELD,
        1.0,
        [
            0.171322886721225,
            0.171836521670494,
            0.202859759169435,
            0.409980927335173,
            0.441517967543557,
            0.648639135709295,
            0.680176175917679,
            0.887297344083415,
            0.9188343842918,
        ],
        (0.888379557741295, 0.867161733893881),
    ),
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


@pytest.mark.parametrize(("problem", "until", "instants", "ways"), PRINTED, ids=["both slide", "held", "stops"])
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
