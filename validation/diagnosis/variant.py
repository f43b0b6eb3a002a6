"""The data of an upright rectangle, and one way to compute its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

import dda
from validation.diagnosis.constants import SEEN
from validation.scenes import features
from validation.scenes.scene import Scene

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Family = Literal["newmark", "hht", "wbz", "chung-hulbert", "theta", "leapfrog", "symplectic-euler", "composite"]
ContactForm = Literal["springs", "mean gap", "dashpot", "implicit", "energy-conserving", "rigid", "impact"]
GRAVITY = 9.81  # given: m/s2
OPENING = features.SCHEMES | {features.UNILATERAL, features.DEAD_BAND, features.WEIGHT}  # of opening contact known here
AVERAGE_ACCELERATION = (0.25, 0.5)  # given: alpha and delta that a variant of another scheme has, without effect


@dataclass(frozen=True)
class Variant:
    """One way to compute a scene: a scheme, what a program adds, what was mistaken, and what is written of it.

    The numbers of families other than Newmark's follow from `spectral` (`validation.diagnosis.schemes`): alpha_f of
    HHT, theta of the theta scheme, rho_inf of the others.
    """

    alpha: float  # [-]
    delta: float  # [-]
    gg: float  # share of the velocity that a step starts with [-]
    start: Literal["zero", "consistent"] = "zero"
    softness: float = 0.0  # ln of the scene's spring stiffness over that in effect [-]
    tied: bool = True  # the shear springs share the softness
    sheared: float = 1.0  # stiffness of the shear springs alone, in addition [-]
    base: float = 0.0  # mass of the yielding base over that of the block; 0 is a spring in series [-]
    weight: float = 0.0  # own weight, as a share of 9.81 m/s2 [-]
    gravity: float = 1.0  # over the scene's [-]
    load: float = 1.0  # over the scene's [-]
    ramp: float = 0.0  # time in which the loads come on, linearly [s]
    density: float = 1.0  # over the scene's [-]
    young: float = 1.0  # Young's modulus over the scene's [-]
    poisson: float = 0.0  # added to the scene's Poisson's ratio [-]
    other_plane: bool = False  # plane strain for plane stress, or the reverse
    side: float = 1.0  # width and height over the scene's [-]
    tall: float = 1.0  # height alone, in addition [-]
    inertia: float = 1.0  # of the strains, over that of the rectangle [-]
    viscous: float = 0.0  # a0 of C = a0 M + a1 K [1/s]
    structural: float = 0.0  # a1 [s]
    updated: bool = False  # geometry follows the strain
    opens: bool = False  # the contact carries no tension
    band: float = 0.0  # penetration beyond which an open contact closes [m]
    reopening: float = 0.0  # gap beyond which a closed one opens, over the band [-]
    hold: float = 0.0  # gap beyond which it opens, in addition: the tension that it bears over its stiffness [m]
    lags: Literal["", "opening", "switching"] = ""  # a contact opens, or also closes, by the gap at the step's start
    reset: bool = False  # a closing contact is sheared from the start of the step on, not from where it touched
    # formulas in which gg stands: those by the new acceleration, or the paper's by the increment of the displacement
    discounted: Literal["both", "velocity", "displacement", "(6)", "(7)"] = "both"
    secant: bool = False  # the velocity at the end of a step is d/dt
    strain_load: float = 1.0  # share of the load in the row of ey [-]
    coupling: float = 1.0  # share of the springs' stiffness between v and ey [-]
    kept: Literal["both", "springs", "stress"] = "both"  # forces carried from step to step
    family: Family = "newmark"
    spectral: float = 0.0  # alpha_f of HHT, theta of the theta scheme, else rho_inf [-]
    split: float = 0.0  # share of the step at which a composite scheme is split; 0 is the usual one of its rho_inf [-]
    contact: ContactForm = "springs"
    dashpot: float = 0.0  # c / (2 sqrt(k m)) of the closed contact, k and m of springs and block [-]
    clipped: bool = True  # the dashpot does not pull
    restitution: float = 0.0  # of the impact law [-]
    parts: int = 1  # steps of the program in one of the scene's
    exact: bool = False  # no scheme: exact in time
    shift: float = 0.0  # steps by which the rows come late; 1/2 is the mean of two steps
    point: float = 0.0  # height of the reported point above the centroid, over half the block's height [-]
    late: float = 0.0  # the same as `shift`, of the pressure alone
    pressure_factor: float = 1.0  # reported over true pressure [-]
    displacement_factor: float = 1.0  # reported over true displacement [-]


@dataclass(frozen=True, eq=False)
class Histories:
    """Histories of all variants, one column each."""

    displacement: Array  # (steps, variants) of the centroid [m]
    pressure: Array  # (steps, variants), positive in compression [Pa]
    open: Flags  # (steps, variants), at the end of the step


@dataclass(frozen=True)
class Rectangle:
    """The data of a scene's upright rectangle on its two corner springs."""

    width: float  # a [m]
    height: float  # h [m]
    density: float  # [kg/m3]
    young: float  # [Pa]
    poisson: float  # [-]
    plane_strain: bool
    normal: float  # stiffness of both normal springs [N/m]
    shear: float  # stiffness of both shear springs [N/m]
    pressure: float  # q [Pa]
    gravity: float = 0.0  # of the scene [m/s2]

    @property
    def force(self) -> float:
        """Static force on the base [N]."""
        return self.width * (self.pressure + self.density * self.height * self.gravity)

    @cached_property
    def model(self) -> dda.TwoBlockModel:
        """The two-block model, whose matrices are those of every variant."""
        shear = max(self.shear, np.finfo(float).eps * self.normal)  # contact that opens may have none
        contact = dda.Contact(self.normal / 2, shear / 2)
        return dda.TwoBlockModel(self.block(), contact, self.pressure, gravity=self.gravity)

    def block(self) -> dda.Block:
        """Return the block."""
        hypothesis: Literal["plane strain", "plane stress"] = "plane strain" if self.plane_strain else "plane stress"
        material = dda.Material(self.density, self.young, self.poisson, hypothesis)
        return dda.Block.rectangle(self.width, self.height, material)

    @cached_property
    def static(self) -> float:
        """Static displacement of the centroid in the locked linear model [m]."""
        return dda.static(self.model)["displacement"]

    def elasticity(self, variants: Sequence[Variant]) -> Array:
        """Return the elasticity of each variant in (ey, ex) [Pa], shape (variants, 2, 2)."""
        units = [unit_elasticity(self.poisson + v.poisson, self.plane_strain != v.other_plane) for v in variants]
        young = self.young * np.array([v.young for v in variants])
        return np.asarray(young[:, None, None] * np.array(units))


@lru_cache(maxsize=512)
def unit_elasticity(poisson: float, plane_strain: bool) -> Array:
    """Return the elasticity in (ey, ex) over Young's modulus [-], Poisson's ratio held within what a material has."""
    most = 0.5 - SEEN  # a fit may try more
    mu = min(max(poisson, -most), most)
    C = dda.Material(1.0, 1.0, mu, "plane strain" if plane_strain else "plane stress").elasticity()
    return np.asarray(C[np.ix_([1, 0], [1, 0])])


# ---- of a scene ----


def rectangle_of(scene: Scene) -> Rectangle | None:
    """Return the data of a scene whose upright rectangle moves up and down only, else None."""
    b, c, load = scene.block, scene.contact, scene.load
    if not features.linear(scene) and not _opens_only(scene):
        return None
    vertical = load.eccentricity == load.traction == load.slope == 0 and load.base_motion is None
    if not (upright(scene) and vertical):
        return None
    (x0, y0), (x1, _), (_, y2), _ = b.outline
    springs = 2 * c.stiffness, 2 * c.shear
    material = b.density, b.young, b.poisson, b.hypothesis == "plane strain"
    return Rectangle(x1 - x0, y2 - y0, *material, *springs, load.pressure, load.gravity)


def upright(scene: Scene) -> bool:
    """Whether a scene's block is one upright rectangle on its lower edge."""
    return scene.block.rectangle is not None and scene.block.subdivide is None


def _opens_only(scene: Scene) -> bool:
    """Whether only contact that opens makes a scene nonlinear, closed and at rest at first."""
    closing, opening = scene.contact.band
    at_rest = scene.contact.gap == 0 and scene.block.velocity == 0
    return set(features.of(scene)) <= OPENING and at_rest and (closing > 0 or opening == 0)


def own_variant(scene: Scene) -> Variant:
    """Return the scene's own scheme and contact, nothing added."""
    closing, opening = scene.contact.band
    opens = scene.contact.law == "unilateral"
    ratio = opening / closing if closing else 0.0
    return replace(own_scheme(scene), opens=opens, band=closing, reopening=ratio, ramp=scene.load.ramp)


def own_scheme(scene: Scene) -> Variant:
    """Return the scene's own scheme, of a block or of a column."""
    t = scene.time
    alpha, delta = (t.alpha, t.delta) if t.scheme == "newmark" else AVERAGE_ACCELERATION
    spectral = t.rho_inf or 0.0
    if t.scheme == "hht":
        spectral = (1 - spectral) / (1 + spectral)
    return Variant(alpha, delta, t.discount, t.start, family=t.scheme, spectral=spectral, split=t.split or 0.0)
