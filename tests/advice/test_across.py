"""The adviser across schemes: of a block that opens only schemes are offered under which impacts gain nothing."""

import math

import pytest

from validation import advise_across, load_scene
from validation.advice import across
from validation.advice.spectra import dda_modes
from validation.advice.words import say
from validation.theory.stepping import Stepping

PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002})


@pytest.mark.parametrize(
    ("stepping", "fears"),
    [
        (Stepping(2e-3, 0.25, 0.5), {"rings", "gains"}),
        (Stepping(2e-3, 0.25, 0.5, 0.95), {"rings", "drags", "gains"}),
        (Stepping(1e-2, 0.25, 0.5, 0.8), {"drags", "gains", "period too long", "few steps"}),
        (Stepping(2e-3, 0.5, 1.0), {"damps the first mode"}),
        (Stepping.named("chung-hulbert", 6e-3, rho_inf=0.0), {"raises", "damps the first mode", "period too long"}),
    ],
    ids=["average", "discounted", "long steps", "constant", "Chung-Hulbert"],
)
def test_what_is_to_be_feared_of_a_scheme_is_told_with_its_number(stepping, fears, monkeypatch):
    monkeypatch.setattr(across, "IMPACTS", (1.5, 1e5))
    modes = dda_modes(PAPER)
    omega = 100.0
    offer = across._offer(PAPER, omega, modes, 5 * modes[0].frequency, 3.0 / stepping.step, stepping)
    stated = PAPER.with_values(offer.settings).time
    assert [stated.scheme, stated.step, stated.discount] == [stepping.scheme, stepping.step, stepping.gg]
    assert offer.settings.get("time.rho_inf") == stepping.rho_inf
    words = {
        "drag": -math.log(stepping.gg) / stepping.step,
        "late": abs(offer.period_error),
        "steps": 2 * math.pi / (omega * stepping.step),
    }
    names = ("gains", "gains elsewhere", "raises", "rings", "drags", "no oscillation", "damps the first mode")
    names += ("period too long", "period too short", "few steps")
    assert {name for name in names if say(name, offer, **words) in offer.fears} == fears
    assert len(offer.fears) == len(fears)
    assert ("gg = 0" in offer.name) == (stepping.gg != 1)


def test_a_block_that_opens_must_not_gain_unless_allowed(monkeypatch):
    monkeypatch.setattr(across, "LADDER", {})
    monkeypatch.setattr(across, "IMPACTS", across.IMPACTS[:1])
    scene = load_scene("unlocked-constant").expand()[0]
    assert advise_across(scene, 0.05).no_gain and not advise_across(scene, 0.05, no_gain=False).no_gain
    closed = advise_across(PAPER, 0.05)
    assert not closed.no_gain
    assert closed.frequency == pytest.approx(dda_modes(PAPER)[0].frequency / (2 * math.pi))
    present = [offer for offer in closed.offers if offer.step == PAPER.time.step and offer.gg == 1]
    assert present and all(offer.damping == pytest.approx(0.05) for offer in present)
