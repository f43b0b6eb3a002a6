"""A user's solver, sound and broken in every way that the suite must name."""

import os
import subprocess
import sys
import time

import numpy as np

import dda
from validation import History


def solve(scene):
    """Run the block, as any other program would."""
    print("whatever a solver prints goes nowhere near the answer")
    b, t = scene.block, scene.time
    material = dda.Material(b.density, b.young, b.poisson, b.hypothesis)
    contact = dda.Contact(scene.contact.stiffness, scene.contact.shear)
    model = dda.TwoBlockModel(dda.Block(b.outline, material), contact, scene.load.pressure, b.base, b.top)
    result = dda.solve(model, dda.Scheme(t.alpha, t.delta, t.discount, t.step, t.start), t.steps)
    return History(result.time, {"displacement": result.columns["displacement"]} | dict(result.columns))


def slack(scene):
    history = solve(scene)
    return dict(history.columns) | {"displacement": 1.002 * history.displacement}


def table(scene):
    return np.column_stack([solve(scene).displacement, solve(scene).contact_pressure])


def displacement_only(scene):
    return {"displacement": solve(scene).displacement}


def pressure_only(scene):
    return {"contact_pressure": solve(scene).contact_pressure}


def raises(scene):
    raise ZeroDivisionError("division by zero")


def exits(scene):
    sys.exit(3)


def crashes(scene):
    os.write(2, b"segmentation fault\n")
    os._exit(139)


def hangs(scene):
    subprocess.run([sys.executable, "-c", "import time; time.sleep(60)"], check=True)
    time.sleep(60)


def nothing(scene):
    return None


def not_a_number(scene):
    values = solve(scene).displacement.copy()
    values[3] = np.nan
    return values, solve(scene).contact_pressure


def short(scene):
    return [values[:-1] for values in solve(scene).columns.values()]


def with_step_zero(scene):
    return [np.append(0.0, values) for values in solve(scene).columns.values()]


def late(scene):
    history = solve(scene)
    return history.time + scene.time.step, history.displacement, history.contact_pressure


class Reporting:
    """A solver that is a class and reports more."""

    def solve(self, scene):
        return solve(scene)

    def static(self, scene):
        return {"displacement": -0.01, "contact_pressure": 5e6}
