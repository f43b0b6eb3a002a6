"""The theory of a time step: roots, leading terms, limits and responses of every scheme."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.staged import System, march

from validation.theory.schemes import CARDS
from validation.theory.stepping import Stepping

NAMED = Stepping.named
CONSTANT = Stepping(1.0, 0.5, 1.0)
AVERAGE = Stepping(1.0, 0.25, 0.5)
SCHEMES = {
    "(1/2, 1)": CONSTANT,
    "(1/4, 1/2)": AVERAGE,
    "(9/16, 1)": Stepping(1.0, 9 / 16, 1.0),
    "CH 0.8": NAMED("chung-hulbert", rho_inf=0.8),
    "CH 0.5": NAMED("chung-hulbert", rho_inf=0.5),
    "CH 0": NAMED("chung-hulbert", rho_inf=0.0),
    "HHT -0.1": NAMED("hht", rho_inf=0.9 / 1.1),
    "HHT -0.3": NAMED("hht", rho_inf=0.7 / 1.3),
    "WBZ 0.5": NAMED("wbz", rho_inf=0.5),
    "Bathe 1/2": NAMED("composite", split=0.5),
    "TR-BDF2": NAMED("composite"),
    "Bathe 0.5": NAMED("composite", rho_inf=0.5),
    "implicit Euler": Stepping(1.0, 1.0, 1.5),
    "leapfrog": NAMED("leapfrog"),
}
LEADING = {  # of xi / W^n and of the period error / W^2
    "(1/2, 1)": (1 / 4, 1 / 12),
    "(1/4, 1/2)": (0.0, 1 / 12),
    "(9/16, 1)": (1 / 4, 0.114583333),
    "CH 0.8": (0.000685871, 0.0879629630),
    "CH 0.5": (0.0185185185, 0.125),
    "CH 0": (0.5, 0.458333333),
    "HHT -0.1": (0.010125, 0.104583333),
    "HHT -0.3": (0.018375, 0.124583333),
    "WBZ 0.5": (0.0740740741, 0.180555556),
    "Bathe 1/2": (1 / 288, 1 / 24),
    "TR-BDF2": (0.00367965644, 0.0404401145),
    "Bathe 0.5": (0.00193304105, 0.029485756),
    "implicit Euler": (1 / 2, 5 / 24),
    "leapfrog": (0.0, -1 / 24),
}


def stepped(stepping, natural, steps):
    """Return x at t = 0, 1, ... of x'' + natural^2 x = 0 by the oracles' steps."""
    x = np.array([1.0 + 0j])
    system = System(np.eye(1), np.array([[natural**2]]), lambda t: np.zeros(1))
    numbers = (stepping.gg, stepping.rho_inf or 0.0, stepping.split)
    weights = (stepping.alpha, stepping.delta) if stepping.scheme == "newmark" else None
    return march(system, stepping.scheme, 1.0, steps, x, np.array([0.3 + 0j]), *numbers, weights=weights)[0][:, 0]


def test_the_roots_are_those_of_the_recursion_of_a_free_motion():
    for name, (gg, omega) in itertools.product(SCHEMES, [(1.0, 12.0), (0.97, 0.7)]):
        stepping = replace(SCHEMES[name], gg=gg)
        roots = stepping.roots(omega)
        x = stepped(stepping, omega, 12)[1:]  # leapfrog discounts from the second step on
        windows = np.lib.stride_tricks.sliding_window_view(x, len(roots) + 1)
        left = windows @ np.poly(roots)[::-1]
        scale = np.max(np.abs(windows), axis=1) * np.sum(np.abs(np.poly(roots)))
        assert np.all(np.abs(left) < 1e-9 * scale), (name, omega)
        assert stepping.spectral_radius(omega) == np.max(np.abs(roots))
        fewer = np.poly(roots[:-1])[::-1]
        assert abs(x[: len(fewer)] @ fewer) > 1e-12 * np.max(np.abs(x[: len(fewer)])), (name, "none is left over")


def test_leading_terms_are_the_limit_of_the_roots():
    omega = 0.02
    for name, (damping, period) in LEADING.items():
        stepping = SCHEMES[name]
        assert stepping.leading_damping(1.0) == pytest.approx(damping, rel=1e-6), name
        assert stepping.period_error(omega) == pytest.approx(period * omega**2, rel=0.01), name
        leading = stepping.leading_damping(omega)
        assert stepping.damping_ratio(omega) == pytest.approx(leading, rel=0.01, abs=1e-13), name
        discounted = replace(stepping, gg=1 - 1e-6)
        assert discounted.leading_damping(omega) - leading == pytest.approx(1e-6 / (2 * omega)), name


def test_the_velocity_of_the_leapfrog_is_the_mean_of_the_half_steps():
    stepping = Stepping.named("leapfrog", 0.03)
    assert stepping.velocity_factor([4.0, 31.0]) == pytest.approx(1j * np.sin([0.12, 0.93]) / 0.03, rel=1e-13)


def test_every_scheme_of_scenes_has_a_card_whose_order_and_solves_are_the_stepping_s():
    import dda
    import fem_reference

    assert tuple(CARDS) == dda.SCHEMES == fem_reference.SCHEMES
    for name, card in list(CARDS.items())[1:]:
        stepping = NAMED(name, rho_inf=None if name == "leapfrog" else 0.7)
        assert (str(stepping.order), stepping.solves) == (card["order"], card["solves"])


def test_the_weight_of_springs_beside_the_mass_is_that_of_the_matrix_of_a_step():
    weights = [
        ("(9/16, 1)", 9 / 16),
        ("CH 0.8", 1 / (1.8**2 * 1.2)),  # 1/((1 + r)^2 (2 - r))
        ("HHT -0.3", 1.3**2 / 4 * 0.7),  # (1 + e)^2 (1 - e)/4
        ("WBZ 0.5", 1 / (2 * 1.5)),  # 1/(2 (1 + r))
        ("Bathe 1/2", 1 / 16),  # of the first half, h^2/4; the second has 1/9
        ("TR-BDF2", (1 - math.sqrt(0.5)) ** 2),  # of both stages
        ("leapfrog", 0.0),
    ]
    for scheme, weight in weights:
        assert SCHEMES[scheme].spring_weight == pytest.approx(weight, rel=1e-14), scheme


def test_a_scheme_says_its_numbers_and_what_it_does():
    half = Stepping(2e-3, 0.375, 0.75, 0.98)
    chung, bathe = NAMED("chung-hulbert", rho_inf=0.37), NAMED("composite", rho_inf=0.25, split=0.4)
    assert (half.name, half.numbers) == ("(alpha, delta) = (0.375, 0.75)", "alpha = 0.375, delta = 0.75")
    assert half.words == "dt = 0.002 s, (alpha, delta) = (0.375, 0.75), gg = 0.98"
    assert [chung.name, bathe.name, NAMED("leapfrog").name] == [
        "chung-hulbert (rho_inf = 0.37)", "composite (rho_inf = 0.25, split = 0.4)", "leapfrog"
    ]  # fmt: skip
    assert chung.numbers == chung.name
    assert [NAMED("composite", rho_inf=rho).split for rho in (None, 0.25)] == pytest.approx([2 - 2**0.5, 0.55848156])
    assert Stepping(1.0, 0.0, 0.5, implicit=True).has_contact_forces
    assert NAMED("leapfrog").one_stage is None is bathe.one_stage and half.one_stage.beta == 0.375
    rated = Stepping(1e-3, 0.5, 1.0, 0.9, rate=3.0).at(0.02)
    assert (rated.step, rated.gg) == (0.02, pytest.approx(math.exp(-0.06))) and half.at(0.1).gg == 0.98
    assert half.rayleigh() == (pytest.approx(2 * 0.02 / (1.98 * 2e-3)), 0.25 * 2e-3) and chung.rayleigh()[1] == 0.0
    assert math.isnan(NAMED("leapfrog").damping_ratio(2.1)) and math.isnan(NAMED("leapfrog").period_error(2.1))
    for scheme, rho in (("chung-hulbert", 1.2), ("hht", 0.4), ("wbz", -0.1), ("wbz", None), ("composite", 1.01)):
        with pytest.raises(ValueError, match=r"rho_inf"):
            NAMED(scheme, rho_inf=rho).roots(1.0)
    for ask in (NAMED("composite", split=1.0).roots, bathe.velocity_factor):
        with pytest.raises(ValueError, match=r"split|time.scheme"):
            ask(1.0)
    assert half.oscillates(0.3) and not CONSTANT.oscillates(30.0)
