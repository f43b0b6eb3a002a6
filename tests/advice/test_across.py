"""The adviser across schemes: each offer has the damping, what is said of it holds, and the order is what is asked."""

import pytest
from conftest import thinned

from validation import InputError, advise_across, damping, load_scene
from validation.advice.across import GAIN, STEPS

LOCKED = load_scene("figures-3-4").with_values({"time.step": 0.002})


@pytest.fixture(scope="module")
def five():
    return advise_across(LOCKED, damping=0.05, frequency=5.0, no_gain=True)


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


def test_the_recommended_gain_nothing_and_resolve_the_frequency(five):
    assert five.offers[0].name == "chung-hulbert (rho_inf = 0)" and five.offers[1].name == "Newmark (0.5, 1)"
    for offer in five.offers[:2]:
        assert not offer.gains and offer.greatest_rebound <= 1 + GAIN and offer.gg == 1
        assert 1 / (5.0 * offer.step) >= STEPS
    assert "nothing gained on contact" in five.sentence
    free = advise_across(LOCKED, damping=0.05, frequency=5.0, no_gain=False)
    assert {offer.name for offer in free.offers} == {offer.name for offer in five.offers}


def test_a_block_that_opens_must_not_gain_unless_allowed():
    scene = load_scene("unlocked-constant").expand()[0]
    assert advise_across(scene, 0.05).no_gain and not advise_across(scene, 0.05, no_gain=False).no_gain
    assert not advise_across(LOCKED, 0.05).no_gain


@pytest.mark.parametrize(
    ("values", "field"),
    [({"damping": 5.0}, "damping"), ({"damping": 0.0}, "damping"), ({"damping": 0.05, "frequency": -1.0}, "frequency")],
)
def test_what_is_refused(values, field):
    with pytest.raises(InputError) as error:
        advise_across(LOCKED, **values)
    assert error.value.field == field
