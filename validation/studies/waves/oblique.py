"""What a viscous base sends back: below blocks at normal incidence, and of oblique plane waves on a half space."""

from __future__ import annotations

import itertools
import math

import numpy as np

from validation.runs.row import Metrics
from validation.theory.stepping import Complex, Stepping
from validation.theory.waves import Column, base_reflection

SCHEMES = {"(1/2, 1)": (0.5, 1.0), "(1/4, 1/2)": (0.25, 0.5)}
COURANTS = (0.1, 0.5, 1.0)
NOTICED = 0.03  # share of the energy
ANGLES = (0.0, 30.0, 45.0, 60.0, 75.0)


def returned_energy(angle: float, wave: str, poisson: float = 0.25) -> float:
    """Return the share of energy that dashpots rho cP and rho cS on a half space send back of a plane wave.

    `angle` of incidence is from the normal [deg], `wave` "P" or "S" (in the plane). Of a wave A d e^{iw(t - s x - q z)}
    the boundary z = 0 has sigma_zz + rho cP v_z = 0 and sigma_xz + rho cS v_x = 0, linear in the two waves that come
    back; flux normal to the boundary goes as c^2 q |A|^2. Beyond the critical angle a P wave has an imaginary q, of
    whose sign |A| is independent.
    """
    speeds = {"S": 1.0, "P": math.sqrt((2 - 2 * poisson) / (1 - 2 * poisson))}
    slowness = math.sin(math.radians(angle)) / speeds[wave]
    normal = {name: np.sqrt(complex(1 / c**2 - slowness**2)) for name, c in speeds.items()}
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


def reflections() -> Metrics:
    """Return |R| of a base of the column's own impedance over blocks a wavelength, scheme and Courant number."""
    block = Column(height=1.0, density=1.0, modulus=1.0)  # so that c = 1
    numbers = {}
    for scheme, blocks, courant in itertools.product(SCHEMES, (10, 20), COURANTS):
        omega = 2 * math.pi / blocks
        reflected = base_reflection(block, Stepping(courant, *SCHEMES[scheme]), omega, impedance=1.0)
        numbers[f"{blocks} blocks a wave, {scheme}, c dt/h = {courant:g}"] = float(np.abs(reflected))
    return numbers


def energies() -> Metrics:
    """Return the energy sent back over the angle, and the angles of three per cent [deg]."""
    from scipy.optimize import brentq

    numbers = {}
    for wave, angle in itertools.product("PS", ANGLES):
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
