"""A formula in the place of the runs of a scene: two swings on springs in series, with the errors of a scheme."""

import math

import numpy as np

from validation.runs.history import History

BEGUN = {"zero": 0.0, "consistent": 0.1}  # share of a step by which a start is early
FINE = 3e-4  # s


def motion(scene, values=(), exact=False):
    """Return the motion of a scene with other values; an exact one, and one at fine steps, has no errors of its scheme.

    The pressure has a part of the block's own, without its springs.
    """
    values = dict(values)

    def of(key):
        section, _, entry = key.partition(".")
        return values.get(key, getattr(getattr(scene, section), entry, 0.0))

    step = of("time.step")
    time = step * np.arange(1, of("time.steps") + 1)
    spring = 2 / (1 / of("contact.stiffness") + 1 / of("block.young"))
    lost = -math.log(values.get("time.gg", 1.0)) / step + 5.0 * (of("contact.law") != "locked")
    swings = []
    for stiffness in (spring, 7 * of("block.young")):
        rate = math.sqrt(stiffness / of("block.density") / 4)
        decay = lost + of("damping.mass") / 2 + of("damping.stiffness") * rate**2 / 2
        swung = time
        if not exact and step > FINE:
            decay += (of("time.delta") - 0.5) * rate**2 * step / 2
            swung = time * (1 - of("time.alpha") * (rate * step) ** 2 / 6) + BEGUN[of("time.start")] * step
        swings.append(1 - np.exp(-decay * time) * np.cos(rate * swung))
    load = of("load.pressure") * (1 + of("load.gravity") / 50)
    return History(
        time, {"displacement": -8 * load / spring * swings[0], "contact_pressure": load * (swings[0] + swings[1] / 4)}
    )
