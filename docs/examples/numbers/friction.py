"""The numbers of docs/friction.md."""

import numpy as np

from validation import load_scene, solve
from validation.theory import friction

scene = load_scene("slope-sliding").expand()[1]  # 28.9 degrees under 15 degrees of friction, 2 ms
run = solve(scene, "dda").history
slide = run.columns["horizontal_displacement"] + friction.coefficient(scene) * run.displacement
free, _ = friction.free_motion(scene, friction.sliding_acceleration(scene))
assert np.max(np.abs(slide - free)) < 1e-10 * free[-1]
assert abs(friction.run_out(scene, 1.0) - 1.219885) < 1e-6  # m
assert abs(run.columns["horizontal_displacement"][-1] - free[-1] - 1.864e-5) < 1e-8  # tan(phi) x settlement
assert abs(friction.threshold_angle(scene) - 15) < 1e-12  # deg

distances = {}
for gg, step in ((0.98, 0.01), (0.98, 0.001), (0.99, 0.01), (0.99, 0.001)):
    changes = {"time.gg": gg, "time.step": step, "time.steps": round(1 / step), "time.start": "consistent"}
    case = scene.with_values(changes)
    distance, _ = friction.free_motion(case, friction.sliding_acceleration(case))
    distances[gg, step] = (round(friction.drag_rate(case), 2), round(float(distance[-1]), 3))
assert list(distances.values()) == [(2.02, 0.689), (20.2, 0.115), (1.01, 0.896), (10.05, 0.219)]
