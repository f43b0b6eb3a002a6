"""The closed forms of steady vibrations: an independent computation's numbers, equilibrium, and limits."""

import numpy as np
import pytest

from validation import load_scene
from validation.theory import vibration
from validation.theory.statics import static_displacement
from validation.theory.stepping import Stepping

BLOCK = load_scene("figures-3-4").with_values({"time.step": 0.002})
W = 2 * np.pi * np.array([20.0, 52.0, 80.0, 150.0])
MODELS = {"block": vibration.block, "bar": vibration.bar}
PAPER = {  # mm and MPa at 20, 52, 80 and 150 Hz
    ("block", True): ((11.557512, 100.592776, 9.196829, 1.899760), (5.985548, 62.986511, 7.547915, 4.112440)),
    ("bar", True): ((11.833857, 1829.342453, 8.670163, 3.127179), (6.001957, 1009.589564, 5.529513, 4.683431)),
    ("block", False): ((11.545937, 31.441911, 7.181528, 1.136584), (5.978494, 19.566325, 5.746814, 1.896587)),
    ("bar", False): ((11.819792, 32.473854, 6.934957, 1.248102), (5.994367, 17.852683, 4.308803, 0.887978)),
}


@pytest.mark.parametrize(("model", "exact"), PAPER)
def test_the_papers_block_answers_as_an_independent_computation_does(model, exact):
    found = MODELS[model](BLOCK, W**2 if exact else Stepping.of(BLOCK).squared_frequency(W))
    displacement, pressure = PAPER[model, exact]
    assert 1e3 * abs(found.displacement) == pytest.approx(displacement, rel=6e-7)
    assert 1e-6 * abs(found.contact_pressure) == pytest.approx(pressure, rel=6e-7)


def test_slow_vibrations_are_statics_and_the_block_keeps_its_momentum():
    slow = [model(BLOCK, [1e-4]) for model in MODELS.values()]
    for found in (*slow, vibration.elements(BLOCK, [1e-4], 4)):
        assert found.displacement == pytest.approx(static_displacement(BLOCK), rel=1e-7)
        assert found.contact_pressure == pytest.approx(BLOCK.load.pressure, rel=1e-7)
    m, w2 = 2700.0 * 4.0, Stepping.of(BLOCK).squared_frequency(W)
    pressed, moved = vibration.block(BLOCK, w2), vibration.block(BLOCK, w2, base=True)
    assert np.allclose(-w2 * m * pressed.displacement, 2 * (pressed.contact_pressure - 5e6), rtol=1e-10)
    assert np.allclose(-w2 * m * moved.displacement, 2 * moved.contact_pressure, rtol=1e-10)


def test_elements_tend_to_the_bar_at_second_order_and_bands_grow_at_a_resonance():
    w2 = Stepping.of(BLOCK).squared_frequency(W)
    exact = vibration.bar(BLOCK, w2).displacement
    off = [abs(vibration.elements(BLOCK, w2, count).displacement / exact - 1) for count in (32, 64)]
    assert np.allclose(off[0] / off[1], 4, rtol=0.02)
    for model in MODELS.values():
        bands = model(BLOCK, W**2).band
        assert bands[1] > 5 * bands[0] and bands[1] < 1e-10
