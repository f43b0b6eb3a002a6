"""The numbers of docs/waves.md."""

import numpy as np

from dda.scheme import spectral
from validation import load_scene, response
from validation.theory import vibration
from validation.theory.stepping import Stepping
from validation.theory.waves import Column, base_reflection

w = 2 * np.pi * np.array([5.0, 10.0, 20.0])
W = np.sqrt(Stepping(step=0.01, alpha=0.5, delta=1.0).squared_frequency(w))
steady = -W.imag / abs(W)
assert np.allclose(steady, np.sin(w * 0.01 / 4))
assert np.allclose(100 * steady, [7.846, 15.643, 30.902], atol=5e-4)  # per cent

free = spectral.damping_ratio(w * 0.01, 0.5, 1.0)
assert np.allclose(100 * free, [7.728, 14.775, 25.545], atol=5e-4)

scene = load_scene("figures-3-4").with_values({"time.step": 0.002})
stepped = response(scene, [20.0, 52.0], "dda")
exact = response(scene, [20.0, 52.0], "dda", exact=True)
assert np.allclose(abs(stepped.displacement), [11.545937e-3, 31.441911e-3])  # complex amplitudes, m
assert np.allclose(abs(exact.displacement), [11.557512e-3, 100.592776e-3])

closed = vibration.block(scene, Stepping.of(scene).squared_frequency(2 * np.pi * np.array([20.0, 52.0])))
assert np.all(abs(stepped.displacement / closed.displacement - 1) <= closed.band)

blocks = Column(height=1.0, density=1.0, modulus=1.0)
for alpha, delta, speed, left in ((0.5, 1.0, 1.6724e-2, 0.008969), (0.25, 0.5, 7.8893e-3, 1.0)):
    arrives, error = blocks.travelled(Stepping(0.5, alpha, delta), 2 * np.pi / 10, distance=100.0)
    assert np.isclose(arrives, left, atol=1e-6) and np.isclose(error, speed, rtol=1e-4)

for c_dt, expected in (
    (0.5, (0.0085, 0.0396)),
    (1.0, (0.0090, 0.0788)),
    (2.0, (0.0112, 0.1643)),
    (3.0, (0.0182, 0.2690)),
):
    for (alpha, delta), R in zip(((0.25, 0.5), (0.5, 1.0)), expected, strict=True):
        back = abs(base_reflection(blocks, Stepping(c_dt, alpha, delta), 2 * np.pi / 10, impedance=1.0))
        assert np.isclose(back, R, atol=5e-5)

mass, stiffness = Stepping(0.01, 0.5, 1.0, gg=0.99).rayleigh()
assert np.isclose(mass, 2 * 0.01 / 1.99 / 0.01) and np.isclose(stiffness, 0.005)
