"""OpenSees as a solver: a block of one strain, or a column, out of the program's own elements.

`opensees_models` has the models. Here stand how they are stepped and what they do not express.
"""

import math
import os

import numpy as np

from peers.opensees_models import NEAR, Plan, block, column, loads, parts
from peers.programs import ExternalProgram
from validation.scenes import features
from validation.solvers.columns.elements import ground_of

PACKAGE, RECIPE = "openseespy", "pip install openseespy==3.7.1.2"
RIGID = 1e-4  # strain by weight and impact up to which a block that turns is taken for rigid
COARSEST, FINER = 2, 4  # sub-steps in a step at first, and how many times more in the next round
ENOUGH = 1e-3  # relative change of a history by the last round
NOTHING = 1e-9  # of the greatest displacement: what a motion that symmetry forbids may be
MOST_WORK = 150_000  # sub-steps of a round, times what a mesh adds
FIRST = 1e-6  # of a sub-step: the first one, at whose end the acceleration is that of the loads
SMALL, ROUNDING = 1e-10, 1e-14  # of what springs give, and of a way: increment at which Newton's iteration ends
ITERATIONS = 30
MODEL = "tri31 and truss masses: exactly one strain; contact zeroLengthContactASDimplex; a column of trusses"


class NotConverged(RuntimeError):
    """The program's Newton iteration found no equilibrium."""


class OpenSees(ExternalProgram):
    """OpenSees, its sub-steps refined until the history stays."""

    program = "OpenSees"
    package = PACKAGE
    recipe = RECIPE
    model = MODEL
    handles = (
        features.RULES
        | {features.OFF_CENTRE, features.WEIGHT, features.UNILATERAL, features.FRICTION, features.SLOPE}
        | {features.ROTATION, features.COLUMN, features.DAMPING}
    )
    settings = f"Newmark 1/2, 1/4; sub-steps {FINER} times finer until the history changes by less than {ENOUGH:g}"

    def solve(self, scene):
        """Return the history of a scene, a column to its values at the steps.

        Raises
        ------
        NotImplementedError
            The program is not installed, or the model does not express the scene.
        NotConverged
            Newton's iteration found no equilibrium, in sub-steps however fine.
        """
        refuse(scene, self.handles)
        ops = program()
        try:
            return self.history(ops, scene)
        finally:
            ops.wipe()

    def history(self, ops, scene):
        """Return the history of the finest round, or of the first that hardly differs from the one before."""
        before = None
        failed = None
        for count in _counts(scene):
            try:
                found = stepped(ops, scene, Plan(count, chosen=True))
            except NotConverged as error:
                failed = error
                continue
            if before is not None and _alike(found, before, scene.run.columns):
                return found
            before = found
        if before is None:
            raise failed or NotConverged("OpenSees: no sub-step was tried")
        return before


class AsItComes(OpenSees):
    """OpenSees with what it takes where nothing is specified, at the scene's step."""

    settings = "Newmark 1/2, 1/4 from zero acceleration, Newton-Raphson; the step of the scene"

    def history(self, ops, scene):
        """Return the history at the scene's step."""
        return stepped(ops, scene, Plan(1, chosen=False))


# ---- the program --------------------------------------------------------------------------------------------------


def program():
    """Return the program's module, told to write nothing.

    Raises
    ------
    NotImplementedError
        It is not installed.
    """
    try:
        import openseespy.opensees as ops
    except (ImportError, RuntimeError) as error:  # its own loader raises the latter where a library is missing
        raise NotImplementedError(f"OpenSees is not installed: {RECIPE} ({error})") from None
    ops.logFile(os.devnull, "-noEcho")
    return ops


def _counts(scene):
    """Return the numbers of sub-steps that are tried, the first one however many steps there are."""
    count = COARSEST
    yield count
    while work(scene, Plan(count := count * FINER, chosen=True)) <= MOST_WORK:
        yield count


def work(scene, plan):
    """Return sub-steps, times what a mesh adds."""
    elements = 0 if scene.column is None else sum(part.elements for part in parts(scene, plan))
    return scene.time.steps * plan.count * (1 + elements / 50)


def _alike(one, other, names):
    nothing = NOTHING * max(np.linalg.norm(values) for name, values in one.items() if "displacement" in name)
    asked = [name for name in names if name in one]
    return all(np.linalg.norm(one[n] - other[n]) <= ENOUGH * np.linalg.norm(one[n]) + nothing for n in asked)


def stepped(ops, scene, plan):
    """Return the history of a scene by a plan.

    Raises
    ------
    NotConverged
        Newton's iteration found no equilibrium.
    """
    ops.wipe()
    look = block(ops, scene) if scene.column is None else column(ops, scene, plan)
    ops.test("NormDispIncr", tolerance(scene), ITERATIONS, 0)
    ops.system("BandGeneral" if scene.column is not None else "FullGeneral")
    if plan.chosen:
        ops.constraints("Plain")
        ops.numberer("RCM")
        ops.algorithm("Newton")
        ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    rows = list(_march(ops, scene, plan, look))
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def _march(ops, scene, plan, look):
    """Step; yield what is seen at the end of each step of the scene."""
    inner = scene.time.step / plan.count
    if plan.chosen:
        _analyze(ops, 1, FIRST * inner)
        if features.linear(scene):
            ops.algorithm("Linear", False, False, True)  # its matrix is factorized once
    for _ in range(scene.time.steps):
        _analyze(ops, plan.count, inner)
        yield look()


def tolerance(scene):
    """Return the increment at which Newton's iteration ends [m]; where all is linear, its first one is exact.

    It is small beside what the springs give, and no smaller than the rounding of the way on which a block may go.
    """
    if features.linear(scene):
        return 1.0
    mass, stiffness, velocity = scene.block.mass, scene.contact.stiffness, abs(scene.block.velocity)
    pushed = math.hypot(*np.sum(list(loads(scene).values()), axis=0))
    given = pushed / stiffness + velocity * math.sqrt(mass / stiffness)
    way = pushed / mass * scene.time.duration**2 + velocity * scene.time.duration
    return (SMALL * given + ROUNDING * way) or SMALL


def _analyze(ops, count, length):
    if ops.analyze(count, length) != 0:
        raise NotConverged(f"OpenSees: Newton's iteration did not converge after t = {ops.getTime():.6g} s")


# ---- what is not expressed ----------------------------------------------------------------------------------------


def refuse(scene, handles):
    """Refuse a scene of which a field would not be taken.

    What is DDA's own way to step or to find contact states is no part of a scene's physics and is not read:
    time.alpha, delta, start, contact.rule, solve_limit, cut.

    Raises
    ------
    NotImplementedError
        With the field and what it means.
    """
    if unknown := [name for name in features.of(scene) if name not in handles]:
        raise NotImplementedError(f"the model has no {', '.join(unknown)}")
    if (apart := features.clash(scene, features.DAMPING_APART)) is not None:
        raise NotImplementedError(apart)
    if scene.time.discount != 1:
        raise NotImplementedError("time.gg is the kinetic discount of DDA's scheme, which OpenSees does not have")
    for means in _reasons_of_column(scene) if scene.column is not None else _reasons_of_block(scene):
        raise NotImplementedError(means)


def _reasons_of_column(scene):
    if scene.column.glue is not None:
        yield "column.glue is between DDA's blocks, which a column of trusses does not have"
    ground_of(scene)  # refuses joints and heights that are none
    joints = [joint.height for joint in scene.column.joint]
    if any(abs(height - joint) <= NEAR * scene.column.height for height in scene.column.heights for joint in joints):
        yield "column.heights: where a joint is, two points move"
    if not any(name.startswith("displacement") for name in scene.run.columns):
        yield "run.columns: of a column, displacements alone are reported"


def _reasons_of_block(scene):
    b, q = scene.block, scene.load
    size = scene.block.rectangle
    if size is None:
        yield "block.vertices: the mass of the triangle's legs is that of an upright rectangle alone"
        return
    if b.poisson == 0.5:
        yield "block.poisson: the program's isotropic material is below 1/2"
    if scene.contact.cohesion:
        yield "contact.cohesion: the contact element has friction alone"
    if scene.run.geometry == "updated":
        if scene.run.rotation != "exact":
            yield "run.rotation: what turns with its bars turns exactly"
        if q.pressure or q.traction:
            yield "load.pressure, load.traction: on a block that turns, the weight alone is expressed"
        strain = b.density * abs(q.gravity) * size[1] / b.young + abs(b.velocity) * math.sqrt(b.density / b.young)
        if strain > RIGID:
            yield "block.young: a block that turns is expressed where weight and velocity leave it rigid"
