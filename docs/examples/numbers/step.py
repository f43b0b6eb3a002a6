"""The numbers of docs/step.md."""

import numpy as np

from dda import Block, Material, Scheme, Unilateral, UnilateralModel
from dda.bodies.opening_block import opening_block, start_of
from dda.contact.rows import laws_of
from dda.march.run import run
from dda.march.step import course_of, march_of
from dda.scheme.stage import Stage, Table

trapezoid = Block([(0, 0), (3, 0), (2.2, 1.5), (0.5, 1.5)], Material(2500.0, 2e9, 0.2))
corners = Unilateral(1e9, gap=1e-3)
model = UnilateralModel(trapezoid, corners, gravity=9.81, velocity=-0.5)
scheme = Scheme(0.5, 1.0, 1.0, 1e-4)
block = opening_block(model)
laws = laws_of(corners, contacts=2, rows=2, limit=6)
start = start_of(block, scheme, corners.gap, model.velocity)
ran = run(march_of(block.body, laws, scheme, start.rows.opening), start, course_of(None, 0.0), steps=500)
gaps = ran.history.opening
assert gaps[0, 0] == 1e-3 and gaps.min() < 0 < gaps[-1].max()

damped = laws._replace(retardation=2e-4)
rebound = run(march_of(block.body, damped, scheme, start.rows.opening), start, course_of(None, 0.0), steps=500)
assert abs(rebound.history.force).max() > 0

glue = laws._replace(opens=np.zeros(2, int), lower=np.full(2, -1e5), upper=np.full(2, 1e5))
held = start_of(block, scheme, 0.0, model.velocity)
yielded = run(march_of(block.body, glue, scheme, held.rows.opening), held, course_of(None, 0.0), steps=500)
assert abs(yielded.history.force).max() <= 1e5 * (1 + 1e-12)

theta = 0.6
stage = Stage(alpha=theta**2, delta=2 * theta - 0.5, e_0=0.5 - theta**2, g_0=1.5 - 2 * theta)
histories = []
for table in (Table((stage,)), None):
    scheme = Scheme(stage.alpha, stage.delta, 1.0, 1e-4, name="theta" if table else "newmark", table=table)
    start = start_of(block, scheme, corners.gap, model.velocity)
    march = march_of(block.body, laws, scheme, start.rows.opening)
    histories.append(run(march, start, course_of(None, 0.0), steps=500).history.opening)
assert np.allclose(*histories, rtol=0, atol=1e-12)
