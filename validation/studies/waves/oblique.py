"""What a viscous base sends back: below blocks at normal incidence, and of plane waves at an angle on a half space."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.gates.gate import Gate
from validation.runs.row import Metrics
from validation.suite.bands import about, gate, half_unit, printed
from validation.theory.stepping import Complex, Stepping
from validation.theory.waves import Column, base_reflection

FACTS = "waves-facts"  # owner of the rows
SCHEMES = {"(1/2, 1)": (0.5, 1.0), "(1/4, 1/2)": (0.25, 0.5)}
COURANTS = (0.1, 0.5, 1.0)
NOTICED = 0.03  # share of the energy
ANGLES = (30.0, 45.0, 60.0, 75.0)
# By an independent program: |R| over c dt/h by scheme and blocks a wavelength, energy sent back over the angle.
REFLECTED = {
    ("(1/2, 1)", 10): ("0.011381", "0.039624", "0.078761"),
    ("(1/2, 1)", 20): ("0.004422", "0.019679", "0.039302"),
    ("(1/4, 1/2)", 10): ("0.008368", "0.008505", "0.008956"),
    ("(1/4, 1/2)", 20): ("0.002065", "0.002073", "0.002099"),
}
SENT_BACK = {"P": ("0.0003", "0.0039", "0.0359", "0.2027"), "S": ("0.0359", "0.0287", "0.1132", "0.3509")}
WIDTH = 0.005  # deg


def returned_energy(angle: float, wave: str, poisson: float = 0.25) -> float:
    """Return the share of energy that dashpots rho cP and rho cS on a half space send back of a plane wave.

    Parameters
    ----------
    angle
        Of incidence, from the normal [deg].
    wave
        "P" or "S" (in the plane).
    poisson
        Poisson's ratio.

    Notes
    -----
    Of a wave A d e^{iw(t - s x - q z)} the boundary z = 0 has sigma_zz + rho cP v_z = 0 and sigma_xz + rho cS v_x = 0,
    linear in the two waves that come back; flux normal to the boundary goes as c^2 q |A|^2.
    """
    speeds = {"S": 1.0, "P": math.sqrt((2 - 2 * poisson) / (1 - 2 * poisson))}
    slowness = math.sin(math.radians(angle)) / speeds[wave]
    normal = {name: np.sqrt(complex(1 / c**2 - slowness**2)) for name, c in speeds.items()}
    if normal["P"].imag > 0:  # a surface wave that dies out into the half space
        normal["P"] = -normal["P"]
    lame = speeds["P"] ** 2 - 2

    def defect(name: str, sign: int) -> Complex:
        """Return the two residuals of the boundary over i w, of a wave that runs to it (1) or from it (-1)."""
        q = sign * normal[name]
        direction = np.array([slowness, q]) if name == "P" else np.array([q, -slowness])
        x, z = speeds[name] * direction
        # the gradient over i w is -(s, q)
        stress = -np.array([lame * (slowness * x + q * z) + 2 * q * z, q * x + slowness * z])
        return np.asarray(stress + np.array([speeds["P"] * z, speeds["S"] * x]))

    back = np.linalg.solve(np.column_stack([defect("P", -1), defect("S", -1)]), -defect(wave, 1))
    flux = sum(abs(A) ** 2 * speeds[name] ** 2 * normal[name].real for A, name in zip(back, "PS", strict=True))
    return float(flux / (speeds[wave] ** 2 * normal[wave].real))


def reflections(finished: Finished) -> Metrics:
    """Return |R| of a base of the column's own impedance over blocks a wavelength, scheme and Courant number."""
    block = Column(height=1.0, density=1.0, modulus=1.0)  # so that c = 1
    numbers = {}
    for (scheme, blocks), courant in itertools.product(REFLECTED, COURANTS):
        omega = 2 * math.pi / blocks
        reflected = base_reflection(block, Stepping(courant, *SCHEMES[scheme]), omega, impedance=1.0)
        numbers[f"{blocks} blocks a wave, {scheme}, c dt/h = {courant:g}"] = float(np.abs(reflected))
    return numbers


def energies(finished: Finished) -> Metrics:
    """Return the energy sent back over the angle, and the angles at which it passes three per cent [deg]."""
    from scipy.optimize import brentq

    numbers = {}
    for wave, angle in itertools.product(SENT_BACK, (0.0, *ANGLES)):
        numbers[f"{wave} at {angle:g} deg"] = returned_energy(angle, wave)
    for wave, name, low, high in (
        ("P", "P from", 50.0, 70.0),
        ("S", "S from", 20.0, 32.0),
        ("S", "S to", 32.0, 40.0),
        ("S", "S again from", 40.0, 60.0),
    ):
        numbers[f"{name}, deg"] = brentq(_above_noticed, low, high, wave)
    return numbers


def _above_noticed(angle: float, wave: str) -> float:
    return returned_energy(angle, wave) - NOTICED


def derived() -> DerivedRows:
    """Return the rows."""
    return Derived(FACTS, "viscous base", (), reflections), Derived(FACTS, "oblique waves", (), energies)


def gates() -> Iterator[Gate]:
    """Yield the gates on numbers of an independent program, and on what is said of viscous boundaries."""
    independent = "an independent program: half a unit of its last digit"
    normal = (
        "at normal incidence less than 1 % comes back under average acceleration from ten blocks a wavelength on while "
        f"c dt/h is at most 1, where (1/2, 1) sends back up to 8 %; {independent}"
    )
    at_angle = (
        "dashpots rho cP and rho cS with Poisson's ratio 1/4, of which Bao, Hatzor and Huang (2012) speak, take all of "
        f"a wave that comes straight down only; {independent}"
    )
    for (scheme, blocks), texts in REFLECTED.items():
        for courant, text in zip(COURANTS, texts, strict=True):
            name = f"{blocks} blocks a wave, {scheme}, c dt/h = {courant:g}"
            yield printed(FACTS, "viscous base", name, float(text), half_unit(text), normal)
    for wave, shares in SENT_BACK.items():
        for angle, text in zip(ANGLES, shares, strict=True):
            metric = f"{wave} at {angle:g} deg"
            yield printed(FACTS, "oblique waves", metric, float(text), half_unit(text), at_angle)
        yield gate(FACTS, "oblique waves", f"{wave} at 0 deg", (0.0, 1e-12), f"{at_angle}; band: rounding")
    crossings = "three per cent of the energy come back of P from here on; of S in between, and again from 45.4 deg on"
    for name, angle in (("P from", 58.599), ("S from", 28.450), ("S to", 35.115), ("S again from", 45.417)):
        yield gate(FACTS, "oblique waves", f"{name}, deg", about(angle, WIDTH), f"{crossings}; band: its last digit")
