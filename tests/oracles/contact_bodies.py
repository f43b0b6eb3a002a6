"""The bodies of `dda` over contacts that open, for tests of what every one must obey, whatever its law and scheme.

A kind of body tells how a history of it is made and what is known of it without `dda`; `CASES` names bodies with their
laws, rules of contact and schemes. Another body is a kind and its cases.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dda import (
    COLUMNS,
    BaseMotion,
    Block,
    Load,
    Material,
    Scheme,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    named_scheme,
    opening_subdivided,
    solve_unilateral,
)
from dda.bodies.turning_block import RollingModel
from dda.march import run as made
from dda.march.compiled import run_loop
from dda.march.step import steps_by

DT = 3e-4


def random_model(seed, glued=None):
    """Return a block at random data: outline, material, loads, gap and speed; some are symmetric."""
    rng = np.random.default_rng(seed)
    a, h = rng.uniform(0.8, 2.5, 2)
    lean = rng.uniform(-0.3, 0.3) if seed % 3 == 0 else 0.0
    corners = [[0, 0], [a, 0], [a + lean, h], [lean, h * (1 + 0.2 * (seed % 3 == 0))]]
    young = 10 ** rng.uniform(8.5, 9.5)
    p = young * 10 ** rng.uniform(-0.5, 2)
    symmetric = seed % 3 == 1
    shear = (rng.uniform(0.2, 1.0) if (glued if glued is not None else seed % 2) else 0.0) * p
    return UnilateralModel(
        Block(corners, Material(rng.uniform(1500, 3000), young, rng.uniform(-0.2, 0.4))),
        Unilateral(p, shear, rng.uniform(0, 1e-3) * (seed % 4 == 0)),
        pressure=young * rng.uniform(1e-3, 5e-3),
        eccentricity=0.0 if symmetric else rng.uniform(-0.2, 0.2) * a,
        traction=0.0 if symmetric else young * rng.uniform(-1e-4, 1e-4),
        gravity=rng.uniform(0, 15),
        velocity=rng.uniform(-1.5, 1.0),
    )


def apart(values, others):
    """Return the greatest difference over the greatest of the other values."""
    return np.max(np.abs(values - others)) / max(np.max(np.abs(others)), 1e-300)


def size(result):
    """Return the greatest energy of a history [J]."""
    return max(np.max(np.abs(values)) for values in result.energies.values())


def rubbing_model(seed):
    """Return a random block whose corners rub: outline, loads, slope, friction and cohesion; some are symmetric."""
    rng, model = np.random.default_rng(1000 + seed), random_model(seed, glued=True)
    law = replace(model.contact, friction=rng.uniform(0.05, 1.0), cohesion=(seed % 5 == 2) * rng.uniform(0.0, 1e5))
    if seed % 3 == 1:
        return replace(model, contact=law)
    sideways = model.block.material.young * rng.uniform(-1e-3, 1e-3)
    return replace(model, contact=law, traction=sideways, slope=rng.uniform(-40, 40))


def shaken(rng, size=1e-3):
    """Return a base that moves to and fro in both directions."""
    moved = np.concatenate([[[0.0, 0.0]], np.cumsum(rng.uniform(-size, size, (20, 2)), axis=0)])
    return BaseMotion(np.linspace(0.0, 0.05, 21), moved)


@dataclass(frozen=True)
class Case:
    """A body, how it is stepped, and what is known of it."""

    kind: type
    model: Any
    scheme: Scheme
    options: dict[str, Any]
    steps: int

    @property
    def rule(self):
        """Rule of contact."""
        return self.options.get("rule", "newmark")

    def run(self, steps=None, model=None):
        """Return the history of so many steps, of another model."""
        return self.kind.solve(model or self.model, self.scheme, steps or self.steps, self.options)


def pressed_edge(model):
    """Return the length of the top edge, and of the part of it that is pressed [m]."""
    start, end = model.block.edge(model.top)
    length = float(np.hypot(*(end - start)))
    return length, length - 2 * abs(model.load.eccentricity)


def resultant(model):
    """Return the loads in x and y of the block's own coordinates [N]."""
    length, pressed = pressed_edge(model)
    weight = model.block.total_mass * np.array(model.load.acceleration)
    return np.array([model.load.traction * length, -model.load.pressure * pressed]) + weight


def mirrored_load(model):
    """Return block and load of the mirror image about x = 0; the base stays the first edge."""
    count = len(model.block.corners)
    order = [1, 0, *range(count - 1, 1, -1)]
    block = Block((model.block.corners * [-1, 1])[order], model.block.material)
    load = model.load
    motion = load.motion and BaseMotion(load.motion.time, load.motion.displacement * np.array([-1, 1]))
    turned = {name: -getattr(load, name) for name in ("eccentricity", "traction", "slope")}
    return order, {"block": block, "load": replace(load, motion=motion, **turned), "top": count - model.top}


class OneBlock:
    """A block whose corners M and N open: its base lies along x."""

    share = 1.0  # of the law of a corner in that of a contact
    rounding = 1.0  # over that of one block

    @staticmethod
    def solve(model, scheme, steps, options):
        return solve_unilateral(model, scheme, steps, COLUMNS, UnilateralOptions(energies=True, **options))

    @staticmethod
    def velocities(model, result):
        """Return the velocity of the centroid from t = 0 on, along and away from the base."""
        return np.array([[0.0, *result.horizontal_velocity], [model.velocity, *result.velocity]])

    @staticmethod
    def motion(result, step):
        """Return the modes from t = 0 on, and what they move in a step at their velocities."""
        return np.hsplit(result.history.motion[:, : 2 * result.unknowns], 2)

    @staticmethod
    def first_energy(model, result):
        return model.block.material.density * model.block.section.area * model.velocity**2 / 2

    @staticmethod
    def loads(model):
        return resultant(model)

    @staticmethod
    def base_at(model, time):
        return model.load.motion.at([time])[0]

    @staticmethod
    def mirrored(model):
        """Return the mirror image, and where its contacts are among those of the body."""
        _, changes = mirrored_load(model)
        return replace(model, **changes), [1, 0]

    @staticmethod
    def carried(model):
        """Return the block on a base that moves evenly, and with it."""
        motion = BaseMotion([0.0, 100.0], [[0.0, 0.0], [0.0, 30.0]])
        return replace(model, velocity=model.velocity + 0.3, motion=motion)

    @staticmethod
    def gap_rates(model, scheme, result):
        """Return w' from t = 0 on, (contacts, steps + 1)."""
        block = model.reduced
        n = len(block.shapes)
        return block.body.weight[: block.contacts] @ result.history.motion[:, n : 2 * n].T / scheme.step


class SubBlocks(OneBlock):
    """The block cut into six by glue that is 10,000 times as stiff as it; its contacts are the points of the base."""

    share = 1 / 3
    rounding = 10.0  # of the forces of seven joints beside those of the contacts

    @staticmethod
    def solve(model, scheme, steps, options):
        cut = opening_subdivided(model, 3, 2, 1e4 * model.block.material.young)
        return OneBlock.solve(cut, scheme, steps, options)

    @staticmethod
    def mirrored(model):
        return OneBlock.mirrored(model)[0], [*reversed(range(6))]


class TurningBlock:
    """A block that turns by any angle; its contacts are all corners, its axes those of the base."""

    share = 1.0
    rounding = 1.0

    @staticmethod
    def solve(model, scheme, steps, options):
        return solve_unilateral(model, scheme, steps, COLUMNS, UnilateralOptions(**options))

    @staticmethod
    def velocities(model, result):
        return result.motion.V[:, :2].T

    @staticmethod
    def motion(result, step):
        q, V = np.hsplit(result.history.motion[:, :12], 2)
        return q, step * V

    @staticmethod
    def first_energy(model, result):
        V = np.array([*(model.body.to_base @ model.velocity), model.spin, 0.0, 0.0, 0.0])
        return V @ model.body.M @ V / 2

    @staticmethod
    def loads(model):
        return model.body.to_base @ resultant(model)

    @staticmethod
    def base_at(model, time):
        return model.body.to_base @ model.load.motion.at([time])[0]

    @staticmethod
    def mirrored(model):
        order, changes = mirrored_load(model)
        thrown = {"tilt": -model.tilt, "spin": -model.spin, "velocity": (-model.velocity[0], model.velocity[1])}
        return replace(model, **changes, **thrown), order

    @staticmethod
    def carried(model):
        motion = BaseMotion([0.0, 100.0], [[0.0, 0.0], [40.0, 30.0]])
        velocity = (model.velocity[0] + 0.4, model.velocity[1] + 0.3)
        return replace(model, velocity=velocity, load=replace(model.load, motion=motion))


def convex(rng):
    """Return a random convex outline of three to seven corners."""
    while True:
        angles = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 8)))
        sides = np.diff([*angles, angles[0] + 2 * np.pi])
        if np.max(sides) < 2.9 and np.min(sides) > 0.25:
            return np.column_stack([np.cos(angles), 0.8 * np.sin(angles)]) * (1 + rng.random())


def random_rolling(seed):
    """Return a block thrown with a spin at a slope, frictionless, glued or rubbing, and a time step of 0.3 to 30 ms."""
    rng = np.random.default_rng(seed)
    material = Material(2700.0, 10 ** rng.uniform(8, 10), rng.uniform(0, 0.4))
    outline = convex(rng)
    if seed % 2:
        a, h = rng.uniform(1, 2), rng.uniform(1, 3)
        outline = [[0, 0], [a, 0], [a, h], [0, h]]
    p, kind = 10 ** rng.uniform(7.5, 10), seed % 3
    rubbing = {"friction": rng.uniform(0, 1.2), "cohesion": 1e3 * rng.random()} if kind == 2 else {}
    law = Unilateral(p, p / 2.5 if kind else 0.0, rng.random(), **rubbing)
    load = Load(rng.choice([0, 2e3]), 0.0, rng.choice([0, 5e3]), gravity=9.81, slope=rng.uniform(-40, 40))
    thrown = {"tilt": rng.uniform(-1, 1), "velocity": (rng.normal(), -rng.random()), "spin": 4 * rng.normal()}
    return RollingModel(Block(outline, material), law, load, **thrown), 10 ** rng.uniform(-3.5, -1.5)


# ---- cases ----

NEWMARK = [
    Scheme(0.5, 1.0, 1.0, DT),
    Scheme(0.25, 0.5, 1.0, DT, "consistent"),
    Scheme(0.3025, 0.6, 0.97, DT),
    Scheme(0.7, 0.8, 0.99, DT),
]
CONSTANT, AVERAGE = NEWMARK[:2]


def with_law(model, **changes):
    return replace(model, contact=replace(model.contact, **changes))


def landed(model):
    """Return the block as it meets its base, for short histories."""
    return replace(with_law(model, gap=0.0), velocity=-0.5)


def dashpots(seed):
    """Return a block on dashpots of a twentieth of the critical damping, three tenths, or more than it."""
    model = random_model(seed, glued=False)
    mass = model.block.material.density * model.block.section.area
    return with_law(model, damping=(0.05, 0.3, 1.2)[seed % 3] * math.sqrt(model.contact.stiffness * mass))


def on_shaken_base(model, seed):
    return replace(model, motion=shaken(np.random.default_rng(seed)))


def flat(model):
    return replace(model, tilt=0.0, spin=0.0)


def block_case(model, scheme, steps=40, **options):
    return Case(OneBlock, model, scheme, options, steps)


def turning_case(seed, scheme=None, steps=55, model=None, **options):
    """Return a thrown block: frictionless, bonded or rough by its seed."""
    made, dt = random_rolling(seed)
    made = with_law(made, gap=made.contact.gap / 100)  # it lands soon
    scheme = scheme or Scheme(0.5, 1.0, 0.98 if seed % 5 == 0 else 1.0, dt, "consistent" if seed % 2 else "zero")
    return Case(TurningBlock, model(made) if model else made, replace(scheme, step=max(dt, 4e-3)), options, steps)


def of_scheme(name, gg=0.99, **values):
    """Return a scheme by name, at a step that a stiff contact allows."""
    return named_scheme(name, step=DT / 10 if name == "leapfrog" else DT, gg=gg, **values)


STIFF = [1e14, 1e18, 1e22, math.inf]
CASES = {
    "frictionless": lambda seed: block_case(random_model(seed, glued=False), NEWMARK[seed % 4]),
    "bonded": lambda seed: block_case(random_model(seed, glued=True), NEWMARK[seed % 4]),
    "explicit": lambda seed: block_case(landed(random_model(seed)), Scheme(0.0, 0.5 + seed % 2 / 2, 0.97, 2e-6), 120),
    "rough": lambda seed: block_case(rubbing_model(seed), NEWMARK[seed % 4]),
    "rough at delta one": lambda seed: block_case(
        replace(rubbing_model(seed), ramp=0.01), replace(CONSTANT, step=1e-4 * 4.0 ** (seed % 4))
    ),
    "rough and shaken": lambda seed: block_case(on_shaken_base(rubbing_model(seed), seed), NEWMARK[(seed + 2) % 4]),
    "rough on a rigid stop": lambda seed: block_case(with_law(rubbing_model(seed), stiffness=math.inf), CONSTANT),
    "lagged": lambda seed: block_case(with_law(rubbing_model(seed), rules="lagged"), CONSTANT),
    "dead band": lambda seed: block_case(with_law(random_model(seed), band=(2e-4, 1e-4)), CONSTANT),
    "dashpot": lambda seed: block_case(dashpots(seed), NEWMARK[seed % 4]),
    "dashpot by two stages": lambda seed: block_case(dashpots(seed), of_scheme("composite")),
    "dashpot by averages": lambda seed: block_case(dashpots(seed), of_scheme("chung-hulbert", rho_inf=0.5)),
    "implicit": lambda seed: block_case(random_model(seed), replace(AVERAGE, step=DT / 3), 80, rule="implicit"),
    "implicit, rough": lambda seed: block_case(rubbing_model(seed), AVERAGE, rule="implicit"),
    "conserving": lambda seed: block_case(
        with_law(random_model(seed, glued=False), stiffness=[1e9, 1e11, 1e13, 1e16][seed % 4]),
        Scheme(0.25, 0.5, 1.0 if seed % 2 else 0.97, 1e-4 * 4.0 ** (seed % 3)),
        rule="energy-conserving",
    ),
    "augmented": lambda seed: block_case(
        random_model(seed, glued=False), NEWMARK[seed % 2], rule="augmented", steps=40
    ),
    "impact": lambda seed: block_case(
        with_law(random_model(seed, glued=False), stiffness=math.inf),
        Scheme(0.5625, 1.0, 0.99, DT, "consistent"),
        rule="impact",
        restitution=0.3,
    ),
    "rough and shaken by two stages": lambda seed: block_case(
        on_shaken_base(rubbing_model(seed), seed), of_scheme("composite", rho_inf=0.3, split=0.4)
    ),
    "rough by half steps": lambda seed: block_case(landed(rubbing_model(seed)), of_scheme("leapfrog")),
    "sub-blocks": lambda seed: Case(SubBlocks, random_model(seed), NEWMARK[seed % 4], {}, 25),
    "rough sub-blocks": lambda seed: Case(SubBlocks, rubbing_model(seed), NEWMARK[(seed + 1) % 4], {}, 25),
    # the short ones land on two corners
    "turning": lambda seed: turning_case(seed + 10),
    "turning on a rigid stop": lambda seed: turning_case(
        seed + 3, model=lambda one: flat(with_law(one, stiffness=math.inf))
    ),
    "turning and shaken": lambda seed: turning_case(seed + 8, model=lambda one: on_shaken_base(one, seed)),
    "turning by first order": lambda seed: turning_case(seed + 11, replace(CONSTANT, gg=0.98), rotation="first-order"),
    "turning by two stages": lambda seed: turning_case(
        seed + 7, named_scheme("composite", step=DT, gg=0.99), model=flat
    ),
}


# ---- other steps ----


def put_stage(patch, change):
    """Let histories be made of other stages: `change` of the one that it would take."""

    def run(loop, *given):
        held = dict(zip(loop.__code__.co_freevars, (cell.cell_contents for cell in loop.__closure__), strict=True))
        return run_loop(steps_by(**(held | {"make_stage": change(held["make_stage"])})), *given)

    patch.setattr(made, run_loop.__name__, run)
