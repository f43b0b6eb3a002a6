"""A user's solver, sound and broken in every way that the suite must name."""

import dda
from validation import History
from validation.runs.modes import Mode


def solve(scene):
    """Run the block, as any other program would."""
    print("whatever a solver prints goes nowhere near the answer")
    b, t = scene.block, scene.time
    material = dda.Material(b.density, b.young, b.poisson, b.hypothesis)
    contact = dda.Contact(scene.contact.stiffness, scene.contact.shear)
    model = dda.TwoBlockModel(dda.Block(b.outline, material), contact, scene.load.pressure, b.base, b.top)
    result = dda.solve(model, dda.Scheme(t.alpha, t.delta, t.discount, t.step, t.start), t.steps)
    return History(result.time, {"displacement": result.columns["displacement"]} | dict(result.columns))


def displacement_only(scene):
    return {"displacement": solve(scene).displacement}


class Reporting:
    """A solver that is a class and reports more."""

    def solve(self, scene):
        return solve(scene)

    def static(self, scene):
        return {"displacement": -0.01, "contact_pressure": 5e6}

    def modes(self, scene):
        return [Mode(317.0, 0.9, (0.3 + 0.2j, 0.3 - 0.2j))]
