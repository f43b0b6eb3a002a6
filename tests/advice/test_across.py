"""The adviser across schemes: of a block that opens only schemes are offered under which impacts gain nothing."""

from validation import advise_across, load_scene
from validation.advice import across


def test_a_block_that_opens_must_not_gain_unless_allowed(monkeypatch):
    monkeypatch.setattr(across, "LADDER", {})
    monkeypatch.setattr(across, "IMPACTS", across.IMPACTS[:1])
    scene = load_scene("unlocked-constant").expand()[0]
    assert advise_across(scene, 0.05).no_gain and not advise_across(scene, 0.05, no_gain=False).no_gain
    assert not advise_across(load_scene("figures-3-4").with_values({"time.step": 0.002}), 0.05).no_gain
