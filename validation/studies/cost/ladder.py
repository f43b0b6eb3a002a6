"""How a block is solved by many methods, each of them refined, and what their errors are measured in.

**Window.** The errors are those of `PERIODS` periods of the first mode from the instant at which the block stands on
its springs: longer, every scheme and every model is out of phase with the exact motion, and no error tells a good one.
The first frequency is the smaller root of det(K - w^2 M) = 0 of one strain on its springs (`one_strain`), k = 2 p::

    K = [[k, -k H / 2], [-k H / 2, k H^2 / 4 + E W H]]        M = m diag(1, H^2 / 12)

which is within some percent of every other model's.

**Norm.** A load that acts in full at once sends a front through the block. The displacement then has kinks and modes
whose amplitudes fall with 1 / w^2 only. Under average acceleration each lags by w^3 dt^2 t / 12, up to the whole of it
at w = (dt^2 t)^(-1/3): the sum of the squares up to there and beyond falls with dt, not dt^2. No load rises at once. By
linearity the answer to a load that rises evenly over a time r is the running mean over r of the answer to the sudden
one, and that to a load that rises as an S over 2 r the mean of this mean::

    x_r(t) = 1/r integral of x from t - r to t        amplitudes times sin(w r / 2) / (w r / 2), squared

which takes two more powers of w off the amplitudes: the squares of the lags, w^-2, have a sum, and the order of the
scheme shows in full. The contact force on springs far stiffer than the block, whose amplitudes fall with 1 / w, keeps
dt^(5/3). The error is the relative L2 difference of these means, histories being straight lines between their steps,
and r = H / c: the load rises while a wave goes up and down, below which nobody asks for a block's answer. Where contact
opens the means of the force are of the momentum that it gives, and the norm is the same.

**Reference.** The exact motion of the bar where there is one (Poisson's ratio 0, a centred pressure, or weight on
contact that opens), else the finest of the linear elements. Its uncertainty by Richardson is a third of the distance to
half as many steps and elements, for the order 2.
"""

from __future__ import annotations

import functools
import math
import operator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from validation.errors import InputError
from validation.runs.beside import table_beside
from validation.runs.history import ArrayPair
from validation.scenes import features
from validation.scenes.scene import Scene, parse_scene

PERIODS = 1.5  # of the first mode, that are compared
TRANSITS = 1.0  # H / c, over which histories are averaged, twice
FINEST = 512  # steps a period of a reference
MOST_PERIODS = 20.0  # of a window, the fall of the block counted
RIGID = 1e6  # E W / H, in place of an infinite stiffness
LEVEL_OF_CHOICES = 32  # steps a period
CUTS = {"few": 4, "many": 16}  # sub-blocks upwards
SQUARE_CUTS = {"few": 3, "many": 6}  # along both sides, where the motion is not that of a column


@dataclass(frozen=True)
class Method:
    """A solver with its scheme, refined."""

    id: str  # of scenes
    label: str  # of tables and figures
    solver: str
    time: dict[str, Any]  # the scheme, as the table of a scene states it
    levels: tuple[int, ...]  # steps a period
    fem: dict[str, Any] = field(default_factory=dict)
    per_element: int = 0  # steps a period for each element along a side
    cut: str = ""  # which of the subdivisions, if any
    scaled: dict[str, float] = field(default_factory=dict)  # factors on values of the block
    is_choice: bool = False  # stands beside a method with one choice changed


@functools.cache
def methods() -> tuple[Method, ...]:
    """Return the methods, and at the end those with one choice changed."""
    table = table_beside(__file__, "methods.toml")
    schemes = table["schemes"]
    listed = [Method(time=schemes[row.pop("scheme")], **row) for row in table["method"]]
    for choice in table["choice"]:
        time = schemes["average"] | choice.pop("time", {})
        levels = choice.pop("levels", (LEVEL_OF_CHOICES,))
        listed.append(Method(solver="dda", time=time, levels=levels, cut="few", is_choice=True, **choice))
    return tuple(listed)


def one_strain(scene: Scene) -> ArrayPair:
    """Return mass and stiffness of a block of one strain on closed springs, for displacement and strain."""
    height = scene.block.extent[1]
    k = min(2 * scene.contact.stiffness, RIGID * scene.block.young * scene.block.base_length / height)
    gap = np.array([1.0, -height / 2])
    elastic = scene.block.young * scene.block.base_length * height
    return scene.block.mass * np.diag([1.0, height**2 / 12]), k * np.outer(gap, gap) + np.diag([0.0, elastic])


def first_period(scene: Scene) -> float:
    """Return the period of the first mode of one strain on its springs [s]."""
    mass, stiffness = one_strain(scene)
    return 2 * math.pi / math.sqrt(min(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real))


def landing(scene: Scene) -> float:
    """Return when the block stands on its springs [s].

    Raises
    ------
    InputError
        It never comes down.
    """
    acceleration = scene.load.gravity + scene.load.pressure * scene.block.base_length / scene.block.mass
    speed = scene.block.velocity
    gap = scene.contact.gap
    if gap == 0 and speed <= 0:
        return 0.0
    if acceleration > 0:
        return (speed + math.sqrt(speed**2 + 2 * acceleration * gap)) / acceleration
    if acceleration == 0 and speed < 0:
        return gap / -speed
    raise InputError("must come down on its springs", source=scene.name, field="block", value="one that leaves them")


@dataclass(frozen=True)
class Ladder:
    """A block with the window in which it is solved."""

    base: Scene
    period: float  # the first [s]
    window: float  # simulated time [s]
    mean: float  # time of the running mean [s]

    @classmethod
    def of(cls, base: Scene) -> Ladder:
        """Return the ladder of a block.

        Raises
        ------
        InputError
            The scene is of no block, its base moves, or the block turns or does not come down in time.
        """
        features.refuse_column(base, "cost", "--scene")
        fixed = {
            "run.geometry": "small",
            "contact.rule": "newmark",
            "damping.kinetic": "constant",
            "load.base_motion": None,
        }
        for key, value in fixed.items():  # what not every method is made for
            stated = operator.attrgetter(key)(base)
            if stated != value:
                rule = "must be absent" if value is None else f"must be {value!r}"
                raise InputError(rule, source=base.name, field=key, value=repr(stated))
        period = first_period(base)
        window = landing(base) + PERIODS * period
        if window > MOST_PERIODS * period:
            rule = f"must land within {MOST_PERIODS:g} periods of {period:.3g} s"
            raise InputError(rule, source=base.name, field="contact.gap", value=f"{window / period:.3g} periods")
        speed = math.sqrt(base.block.young / base.block.density)
        return cls(base, period, window, TRANSITS * base.block.extent[1] / speed)

    @property
    def features(self) -> set[str]:
        """The features of the block, without scheme and sub-blocks."""
        return set(features.of(self.base)) - features.SCHEMES - {features.SUB_BLOCKS}

    @property
    def is_column(self) -> bool:
        """Whether nothing depends on x: the block goes up and down, and gets shorter."""
        others = self.features - {features.UNILATERAL, features.WEIGHT, *features.COURSES}
        return not others and self.base.block.poisson == 0 and self.base.block.rectangle is not None

    @property
    def reference(self) -> Method:
        """The method of reference; of elements there is a second one of half as many."""
        exact = ""
        if self.is_column and not self.features:
            exact = "continuum"
        elif self.is_column and features.UNILATERAL in self.features and not self.features & features.COURSES:
            exact = "bar-events"
        time = {"alpha": 0.25, "delta": 0.5, "start": "consistent"}
        if exact:
            return Method("reference", "exact motion", exact, time, (FINEST,))
        levels = (FINEST // 2, FINEST) if self.is_column or features.linear(self.base) else (FINEST // 4, FINEST // 2)
        per_element = FINEST // 64 if self.is_column else FINEST // 32
        return Method("reference", "finest mesh", "fem", time, levels, {"degree": 1}, per_element)

    def steps(self, level: int) -> int:
        """Return the steps of a level."""
        return max(1, round(level * self.window / self.period))

    def scene(self, method: Method) -> Scene:
        """Return the scene of a method, its levels as a sweep."""
        definition = self.base.definition()
        tables = {}
        for name in ("block", "contact", "fem"):
            tables[name] = dict(definition.get(name, {}))
        tables["fem"] = {key: value for key, value in tables["fem"].items() if key not in ("mesh", "elements")}
        tables["fem"] |= method.fem
        for key in ("subdivide", "pattern", "glue_ratio"):
            tables["block"].pop(key, None)
        if method.cut:
            n = CUTS[method.cut] if self.is_column else SQUARE_CUTS[method.cut]
            tables["block"]["subdivide"] = [1 if self.is_column else n, n]
        for key, factor in method.scaled.items():
            section, _, name = key.partition(".")
            tables[section][name] *= factor
        counts = [self.steps(level) for level in method.levels]
        sweep = {"mode": "zip", "time.steps": counts}
        sweep["time.step"] = [float(f"{self.window / count:.6g}") for count in counts]  # names hold them
        if method.per_element:
            sweep["fem.elements"] = [level // method.per_element for level in method.levels]
        data = definition | tables | {"time": {"step": 1.0, "steps": 1, **method.time}, "sweep": sweep, "gate": []}
        name = f"{self.base.name}-{method.id}"
        data |= {"name": name, "title": f"{self.base.title}: {method.label}", "run": {"solvers": [method.solver]}}
        return parse_scene(data, name)

    def scenes(self) -> tuple[Scene, ...]:
        """Return the scenes of all methods and of the reference."""
        return tuple(self.scene(method) for method in (*methods(), self.reference))
