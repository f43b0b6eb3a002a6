"""The adviser across schemes: each offer has the damping, what is said of it holds, and the order is what is asked."""

import pytest
from conftest import thinned

from validation import advise_across, damping, load_scene

LOCKED = load_scene("figures-3-4").with_values({"time.step": 0.002})


@pytest.mark.long
@pytest.mark.parametrize("values", [{}, {"time.scheme": "wbz", "time.rho_inf": 0.3}])
@pytest.mark.parametrize(("target", "frequency"), thinned([(0.05, None), (0.02, 31.0), (0.2, 90.0)], 3))
def test_an_offer_is_what_the_solver_then_has(values, target, frequency):
    scene = LOCKED.with_values(values)
    advice = advise_across(scene, target, frequency)
    assert len(advice.offers) > 4
    for offer in advice.offers:
        assert offer.damping == pytest.approx(target, rel=1e-9)
        first = damping(scene.with_values(offer.settings)).modes[0]
        assert first.damping == pytest.approx(offer.first_mode, rel=1e-6), offer.name
        if frequency is None:
            assert first.damping == pytest.approx(target, rel=1e-6), offer.name


def test_a_block_that_opens_must_not_gain_unless_allowed():
    scene = load_scene("unlocked-constant").expand()[0]
    assert advise_across(scene, 0.05).no_gain and not advise_across(scene, 0.05, no_gain=False).no_gain
    assert not advise_across(LOCKED, 0.05).no_gain
