"""Frequency responses: the numbers of an independent computation of the paper's block and bar."""

import pytest

from validation import load_scene, response

BLOCK = load_scene("figures-3-4").with_values({"time.step": 0.002})
PAPER = [  # Hz; mm and MPa: exact in time, dt = 2 ms with (1/2, 1), dt = 2 ms with (1/4, 1/2) and gg = 0.98
    ("dda", 52, (100.592776, 62.986511), (31.441911, 19.566325), (220.917269, 140.551930)),
    ("dda", 150, (1.899760, 4.112440), (1.136584, 1.896587), (1.041105, 15.419430)),
    ("bar", 52, (1829.342453, 1009.589564), (32.473854, 17.852683), (137.596784, 76.523901)),
    ("bar", 150, (3.127179, 4.683431), (1.248102, 0.887978), (0.730972, 2.454982)),
]
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 0.98}


def sizes(found):
    """Return the amplitudes in mm and MPa."""
    return 1e3 * abs(complex(found.displacement[0])), 1e-6 * abs(complex(found.contact_pressure[0]))


@pytest.mark.parametrize(("solver", "frequency", "exact", "constant", "average"), PAPER)
def test_the_papers_block_answers_as_an_independent_computation_does(
    solver,
    frequency,
    exact,
    constant,
    average,
):
    assert sizes(response(BLOCK, frequency, solver, exact=True)) == pytest.approx(exact, rel=2e-7)
    assert sizes(response(BLOCK, frequency, solver)) == pytest.approx(constant, rel=6e-7)
    assert sizes(response(BLOCK.with_values(AVERAGE), frequency, solver)) == pytest.approx(average, rel=6e-7)
