"""The numbers of docs/stacks.md."""

from validation.theory.columns import far_face_step, greatest_solves, lowest_frequency, ring_down
from validation.theory.stepping import Stepping

assert greatest_solves(10) == 11
w1 = lowest_frequency(stiffness=1e9, mass=2500.0, blocks=10)
assert abs(ring_down(w1, Stepping(step=20e-3, alpha=0.5, delta=1.0)) - 0.2696) < 1e-4
assert abs(far_face_step(speed=1000.0, height=1.0, alpha=0.5) - 5.774e-4) < 1e-7
