"""What `advise damping` says as plain data, with every number computed apart."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import typed

from validation.advice.spectra import ModeDamping, mode_damping, runs, steps_to
from validation.scenes.scene import load_scene

OPTIONS = ("--set", "time.gg=0.98")


def frequencies():
    """Both axial frequencies of the 2 m block at p = E = 1e9, from (v, ey)."""
    stiffness = np.array([[2e9, -2e9], [-2e9, 4e9 + 2e9]])
    return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(np.diag([10800.0, 3600.0]), stiffness)).real))


def of_scheme(omega, gg):
    """Return xi, |lambda| and w/w' - 1 under constant acceleration, from trace and determinant of a step."""
    beta = 1 + omega**2 / 2
    trace = 1 - omega**2 / (2 * beta) + gg * (1 - omega**2 / beta)
    roots = np.roots([1.0, -trace, gg * (1 - omega**2 / (2 * beta))])
    log = np.log(complex(roots[0]))
    return float(-log.real / abs(log)), float(np.abs(roots).max()), float(omega / abs(log) - 1)


def test_damping_as_plain_data_is_in_fractions_and_seconds(scene_file):
    found = json.loads(typed("advise", "damping", scene_file, *OPTIONS, "--json").stdout)
    w = frequencies()[0]
    xi, radius, elongation = of_scheme(0.002 * w, 0.98)
    own = of_scheme(0.002 * w, 1.0)[0]
    assert (found["scene"], found["step"], found["gg"]) == ("small", 0.002, 0.98)
    assert found["gg_rate"] == pytest.approx(-math.log(0.98) / 0.002)
    first = {name: value for name, value in found["modes"][0].items() if name not in ("name", "least_root")}
    assert first == pytest.approx({
        "frequency": w, "damping": xi, "spectral_radius": radius, "omega_dt": 0.002 * w, "algorithmic": own,
        "kinetic": xi - own, "period_elongation": elongation, "viscous": 0.0,
    })  # fmt: skip
    assert set(found["references"]) == {"fem", "bar"}
    bar = 1.0768740 / 2 * math.sqrt(1e9 / 2700)  # b tan b = 2, w = (b/2) sqrt(E/rho)
    expected = {"frequency": bar, "damping": of_scheme(0.002 * bar, 0.98)[0]}
    assert found["references"]["bar"] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("frequency", [10.0, 344.561, 3464.0, 4.055e6])
def test_what_a_scheme_does_not_damp_keeps_all_of_itself_and_never_rings_down(frequency):
    scene = load_scene("figures-3-4").with_values({"time.step": 2.2e-6, "time.alpha": 0.25, "time.delta": 0.5})
    mode = mode_damping(scene, "contact", frequency)
    assert mode.damping == 0.0 and mode.spectral_radius == 1.0
    assert steps_to(0.01, mode.spectral_radius) == math.inf


def test_what_has_no_damping_ratio_of_its_own_is_not_split():
    """At gg < 1 a mode may oscillate that without the discount has a root that is not positive."""
    mode = ModeDamping("contact", 1e3, 0.4, 0.6, 2.0, None, None, 0.1, -0.2)
    assert runs(mode) == "is damped at 40 % of critical, kinetic and algorithmic"
    assert runs(replace(mode, algorithmic=0.1, kinetic=0.3)).endswith("10 % algorithmic and 30 % kinetic")
    assert runs(replace(mode, algorithmic=0.4, kinetic=0.0)).endswith("all of it algorithmic")
