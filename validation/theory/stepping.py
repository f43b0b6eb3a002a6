r"""A time step of a scheme and what it makes of a harmonic motion.

With M A + C V + K D = F e^{iwt} taken at the steps, z = e^{iw dt} and gg times V at the start of each step,

    (z - gg) V = dt ((1 - gamma) + gamma z) A
    (z - 1) D  = gg dt V + dt^2 ((1/2 - beta) + beta z) A

are the corrector (7) and the predictor (6), beta = alpha and gamma = delta of Newmark's scheme. Generalised-alpha
schemes [Chung and Hulbert 1993] balance forces at a mean of the steps,

    ((1 - am) z + am) M A + ((1 - af) z + af) (K D - F) = 0.

Hence M A' = -W2 M D balances K D with the squared frequency

                      (z - 1)(z - gg) ((1 - am) z + am)
    W2 = - -----------------------------------------------------------------------------------------------,
           dt^2 ((1 - af) z + af) [gg ((1 - gamma) + gamma z) + (1/2 - beta + beta z)(z - gg)]

and the stepped system answers as the system that is exact in time does at a complex frequency: (K - W2 M) D = F. The
leapfrog, with V half a step behind, has W2 = -(z - 1)(z - gg) / (dt^2 z). Its factors of a free motion are the z of
W2 = w^2. A composite scheme [Bathe and Baig 2005; Noh and Bathe 2019] is a Runge-Kutta method on (x, v) of two solves,

    Rg = (1 + g s/2) / (1 - g s/2),   R(s) = (1 + q0 s + q1 s Rg) / (1 - q2 s),   s = i w dt,
    q1 = (r + 1) / (2 g (r - 1) + 4),   q0 = (g - 1) q1 + 1/2,   q2 = 1/2 - g q1,

whose step has the trace (1 + gg) Re R and the determinant gg |R|^2 where u = gg v enters the whole step; it has no W2,
since its first solve sees the load at a share g of the step.
Frequencies may be arrays; everything is in SI units.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.errors import InputError
from validation.scenes.scene import Scene
from validation.theory import stages
from validation.theory.stages import Stage, Stages

Complex = NDArray[np.complex128]
EPS = 2.0**-52
GENERALISED_ALPHA: dict[str, Callable[[float], Stages]] = {
    "chung-hulbert": stages.chung_hulbert,
    "hht": stages.hht,
    "wbz": stages.wbz,
}


class Composite(NamedTuple):
    """Numbers of a composite scheme: the trapezoidal rule over a share of the step, then three points."""

    split: float
    q0: float
    q1: float
    q2: float

    @classmethod
    def of(cls, first: Stage, second: Stage) -> Composite:
        """Return the numbers of two stages."""
        return cls(first.d_u, second.g_0, second.d_g, second.gamma)

    def growth(self, s: Complex) -> Complex:
        """Return R(s) of y' = y s / dt over a step."""
        half = self.split * s / 2
        middle = (1 + half) / (1 - half)
        return (1 + self.q0 * s + self.q1 * s * middle) / (1 - self.q2 * s)

    @property
    def fourth(self) -> float:
        """Return c4 of ln R = s + c3 s^3 + c4 s^4 + ..."""
        g, q0, q1, q2 = self
        above = (1.0, q0 + q1, q1 * g, q1 * g**2 / 2, q1 * g**3 / 4)
        r3, r4 = (sum(above[k] * q2 ** (n - k) for k in range(n + 1)) for n in (3, 4))
        return r4 - r3 + 1 / 8


@dataclass(frozen=True)
class Stepping:
    """A time step and the parameters of its scheme."""

    step: float  # dt [s]
    alpha: float = 0.5  # Newmark's; not a number of another scheme [-]
    delta: float = 1.0  # as alpha [-]
    gg: float = 1.0  # share of the velocity that a step starts with [-]
    rate: float | None = None  # of gg = exp(-rate dt), where the discount is stated so [1/s]
    implicit: bool = False  # the force of a contact fully implicit, average acceleration in the block
    scheme: str = "newmark"
    rho_inf: float | None = None  # spectral radius at infinite frequency [-]
    split: float | None = None  # share of the step that a composite scheme's first solve spans [-]

    @classmethod
    def of(cls, scene: Scene) -> Stepping:
        """Return the stepping of a scene."""
        t = scene.time
        if t.scheme != "newmark":
            return cls.named(t.scheme, t.step, t.discount, t.rho_inf, t.split, t.gg_rate)
        contact = scene.stated_contact
        is_implicit = contact is not None and contact.rule == "implicit"
        return cls(t.step, t.alpha, t.delta, t.discount, t.gg_rate, is_implicit)

    @classmethod
    def named(
        cls,
        scheme: str,
        step: float = 1.0,
        gg: float = 1.0,
        rho_inf: float | None = None,
        split: float | None = None,
        rate: float | None = None,
    ) -> Stepping:
        """Return the stepping of a scheme by its name, other than Newmark's."""
        if scheme == "composite":
            rho_inf = 0.0 if rho_inf is None else rho_inf
            split = stages.equal_split(rho_inf) if split is None else split
        return cls(step, math.nan, math.nan, gg, rate, scheme=scheme, rho_inf=rho_inf, split=split)

    def at(self, step: float) -> Stepping:
        """Return the scheme at another step; a discount stated as a rate stays one."""
        gg = self.gg if self.rate is None else math.exp(-self.rate * step)
        return replace(self, step=step, gg=gg)

    @property
    def stages(self) -> Stages:
        """The scheme as a table of numbers."""
        if self.scheme == "newmark":
            return stages.newmark(self.alpha, self.delta)
        if self.scheme == "leapfrog":
            return stages.LEAPFROG
        if self.scheme == "composite":
            return stages.composite(self._rho_inf, self.split)
        return GENERALISED_ALPHA[self.scheme](self._rho_inf)

    @property
    def one_stage(self) -> Stage | None:
        """Numbers of a scheme of one balance of forces a step; None of leapfrog and composite schemes."""
        if self.scheme in ("leapfrog", "composite"):
            return None
        (stage,) = self.stages
        return stage

    @property
    def composite(self) -> Composite:
        """Numbers of a composite scheme."""
        first, second = self.stages
        return Composite.of(first, second)

    @property
    def _rho_inf(self) -> float:
        if self.rho_inf is None:
            raise InputError(f"is required of {self.scheme}", field="rho_inf", value="nothing")
        return self.rho_inf

    @property
    def solves(self) -> int:
        """Solves of a step without contact that opens: none of an explicit scheme, two of a composite one."""
        return {"leapfrog": 0, "composite": 2}.get(self.scheme, 1)

    @property
    def has_contact_forces(self) -> bool:
        """Whether a contact has a force at the end of a step that its matrix holds: beta > 0."""
        numbers = self.one_stage
        return self.implicit or self.scheme == "composite" or (numbers is not None and numbers.beta > 0)

    @property
    def name(self) -> str:
        """Name and numbers of the scheme, without the step."""
        if self.scheme == "newmark":
            return f"(alpha, delta) = ({self.alpha:.6g}, {self.delta:.6g})"
        numbers = {"rho_inf": self.rho_inf, "split": self.split}
        stated = [f"{name} = {value:.6g}" for name, value in numbers.items() if value is not None]
        return f"{self.scheme} ({', '.join(stated)})" if stated else self.scheme

    @property
    def numbers(self) -> str:
        """The scheme as a sentence names it: Newmark's by alpha and delta, another by its name."""
        return f"alpha = {self.alpha:g}, delta = {self.delta:g}" if self.scheme == "newmark" else self.name

    @property
    def damps(self) -> bool:
        """Whether the scheme damps a free vibration without a discount."""
        if self.scheme == "newmark":
            return self.delta > 0.5
        return self.scheme != "leapfrog" and self._rho_inf < 1

    @property
    def spring_weight(self) -> float:
        """Weight of dt^2 K beside M in a step's matrix, alpha of Newmark's; the least of the stages."""
        return min(stage.beta * stage.equilibrium_weight for stage in self.stages)

    @property
    def words(self) -> str:
        """The numbers in words."""
        return f"dt = {self.step:.6g} s, {self.name}, gg = {self.gg:.9g}"

    # ---- vibration at a given frequency ----

    def squared_frequency(self, omega: ArrayLike) -> Complex:
        """Return W2 [1/s^2] at angular frequencies w [rad/s], A = -W2 D; InputError of composite schemes."""
        half = 0.5 * self.step * np.asarray(omega, float)
        turn = 2j * np.sin(half) * np.exp(1j * half)  # z - 1 without subtraction
        above = turn * ((1 - self.gg) + turn)  # (z - 1)(z - gg)
        if self.scheme == "leapfrog":
            return np.asarray(-above / (self.step**2 * (1 + turn)), complex)
        numbers = self._numbers("squared frequency")
        below = self._kinematics(numbers, turn)
        mean = (1 + (1 - numbers.am) * turn) / (1 + (1 - numbers.af) * turn)
        return np.asarray(-above * mean / (self.step**2 * below), complex)

    def velocity_factor(self, omega: ArrayLike) -> Complex:
        """Return S [1/s] of V = S D, which is i w in exact time: -W2 dt ((1 - gamma) + gamma z) / (z - gg).

        Of the leapfrog V is the mean of the half steps beside it. Raises InputError of composite schemes.
        """
        half = 0.5 * self.step * np.asarray(omega, float)
        turn = 2j * np.sin(half) * np.exp(1j * half)
        if self.scheme == "leapfrog":
            return np.asarray(turn * (2 + turn) / (2 * self.step * (1 + turn)), complex)
        numbers = self._numbers("velocity over displacement")
        return np.asarray(turn * (1 + numbers.gamma * turn) / (self.step * self._kinematics(numbers, turn)), complex)

    def _kinematics(self, numbers: Stage, turn: Complex) -> Complex:
        """Return gg ((1 - gamma) + gamma z) + (1/2 - beta + beta z)(z - gg) of z - 1."""
        ahead = (1 - self.gg) + turn
        return self.gg * (1 + numbers.gamma * turn) + (0.5 + numbers.beta * turn) * ahead

    def _numbers(self, quantity: str) -> Stage:
        numbers = self.one_stage
        if numbers is None:
            raise InputError(
                f"no {quantity} of all modes exists: its first solve sees the load within the step",
                field="time.scheme",
                value=self.scheme,
                advice="take its answer mode by mode",
            )
        return numbers

    # ---- free vibration ----

    def roots(self, omega_dt: float) -> Complex:
        """Return the factors z of a free motion over a step at W = w dt, the principal pair first.

        Principal is the complex pair; where all are real, the root of largest modulus comes first.
        """
        gg = self.gg
        if self.scheme == "composite":
            R = complex(self.composite.growth(np.asarray(1j * omega_dt)))
            # t^2 + (2 - trace) t + 1 - trace + det in t = z - 1
            polynomial = [1.0, 2 - (1 + gg) * R.real, 1 - (1 + gg) * R.real + gg * abs(R) ** 2]
        elif self.scheme == "leapfrog":
            square = omega_dt**2
            polynomial = [1.0, 1 - gg + square, square]
        else:
            numbers = self._numbers("polynomial")
            inertia = [1.0, 1 - gg, 0.0]
            stiffness = [numbers.beta, 0.5 + numbers.beta * (1 - gg) + gg * numbers.gamma, 0.5 * (1 - gg) + gg]
            if numbers.am != 0 or numbers.af != 0:  # else the third root is 0, of the factor z of both parts: Newmark's
                inertia = _with_zero(inertia, 1 - numbers.am)
                stiffness = _with_zero(stiffness, 1 - numbers.af)
            polynomial = [m + omega_dt**2 * k for m, k in zip(inertia, stiffness, strict=True)]
        turns = sorted(_zeros(polynomial), key=lambda turn: (turn.imag == 0, -round(abs(1 + turn), 14), -turn.imag))
        return 1 + np.array(turns, complex)

    def oscillates(self, omega_dt: float) -> bool:
        """Whether the principal roots are a complex pair."""
        return bool(abs(self.roots(omega_dt)[0].imag) > 0)

    def damping_ratio(self, omega_dt: float) -> float:
        """Return xi = -(l1 + l2) / (2 sqrt(l1 l2)), l = ln z of the principal pair; NaN where a root is not positive.

        Of a complex pair that is -Re ln z / |ln z|, of two positive roots at least 1.
        """
        first, second = self._logarithms(omega_dt)
        return -(first + second).real / (2 * math.sqrt(abs(first * second)))

    def period_error(self, omega_dt: float) -> float:
        """Return W / sqrt(l1 l2) - 1, of a complex pair W / |ln z| - 1; NaN where a root is not positive."""
        first, second = self._logarithms(omega_dt)
        return omega_dt / math.sqrt(abs(first * second)) - 1

    def _logarithms(self, omega_dt: float) -> tuple[complex, complex]:
        """Return ln z of the principal pair, not numbers where one is real and not positive."""
        first, second = (complex(z) for z in self.roots(omega_dt)[:2])
        if first.imag == 0 and min(first.real, second.real) <= 0:
            return complex(math.nan, math.nan), complex(math.nan, math.nan)
        return cmath.log(first), cmath.log(second)

    def spectral_radius(self, omega_dt: float) -> float:
        """Return the largest |z| of a step."""
        return float(np.max(np.abs(self.roots(omega_dt))))

    @property
    def critical_omega(self) -> float:
        """Largest stable w dt, infinite where every one is.

        Newmark's: a root passes -1 at W^2 = 2 (1 + gg) / [1/2 + gg (2 delta - 1/2) - 2 alpha (1 + gg)], and a pair
        leaves the unit circle at W^2 = (1 - gg) / [gg (1/2 - delta) - (1 - gg) alpha], where these are positive;
        leapfrog: W^2 = 2 (1 + gg). The other schemes are stable at every step.
        """
        if self.scheme == "leapfrog":
            return math.sqrt(2 * (1 + self.gg))
        if self.scheme != "newmark":
            return math.inf
        gg = self.gg
        limits = [math.inf]
        flipping = 0.5 + gg * (2 * self.delta - 0.5) - 2 * self.alpha * (1 + gg)
        growing = gg * (0.5 - self.delta) - (1 - gg) * self.alpha
        for above, below in ((2 * (1 + gg), flipping), (1 - gg, growing)):
            if below > EPS:
                limits.append(math.sqrt(above / below))
        return min(limits)

    @property
    def order(self) -> int:
        """Order of accuracy in free vibration without a discount."""
        return 1 if self.scheme == "newmark" and self.delta != 0.5 else 2

    def leading_damping(self, omega_dt: float) -> float:
        """Return the leading term of xi for small W, (1 - gg) / (2 W) of the discount included."""
        kinetic = (1 - self.gg) / (2 * omega_dt)
        if self.scheme == "composite":
            return kinetic - self.composite.fourth * omega_dt**3
        numbers = self.one_stage
        if numbers is None:
            return kinetic
        if self.scheme == "newmark":
            return kinetic + (self.delta - 0.5) / 2 * omega_dt
        return kinetic + (numbers.af - numbers.am) * (1 - numbers.am - numbers.af) ** 2 * omega_dt**3 / 8

    def rayleigh(self) -> tuple[float, float]:
        """Return (a0 [1/s], a1 [s]) of the Rayleigh damping that the step hides, in the limit w dt -> 0.

        a0 = 2 (1 - gg) / ((1 + gg) dt) is the kinetic part, -Im W2 / w there; a1 = (delta - 1/2) dt is Newmark's
        algorithmic one, for gg near 1. A free vibration loses a0 = -ln(gg) / dt, the same to second order in 1 - gg.
        The other schemes damp with the cube of the frequency, which no Rayleigh damping does: a1 = 0.
        """
        algorithmic = (self.delta - 0.5) * self.step if self.scheme == "newmark" else 0.0
        return 2 * (1 - self.gg) / ((1 + self.gg) * self.step), algorithmic


def _with_zero(polynomial: list[float], first: float) -> list[float]:
    """Return a polynomial times first t + 1."""
    return [first * number + before for number, before in zip([*polynomial, 0.0], [0.0, *polynomial], strict=True)]


def _zeros(polynomial: list[float]) -> list[complex]:
    """Return where a polynomial of second or third degree is zero."""
    if len(polynomial) > 3:
        return [complex(zero) for zero in np.roots(polynomial)]
    a, b, c = polynomial
    half = -b / a / 2
    product = c / a
    root = cmath.sqrt(half * half - product)
    if root.imag or half == 0:
        return [half + root, half - root]
    larger = half + math.copysign(root.real, half)  # the other one without a difference
    return [complex(larger), complex(product / larger)]
