"""The adviser across schemes: each offer has the damping, what is said of it holds, and the order is what is asked."""

from validation import advise_across, load_scene

LOCKED = load_scene("figures-3-4").with_values({"time.step": 0.002})


def test_a_block_that_opens_must_not_gain_unless_allowed():
    scene = load_scene("unlocked-constant").expand()[0]
    assert advise_across(scene, 0.05).no_gain and not advise_across(scene, 0.05, no_gain=False).no_gain
    assert not advise_across(LOCKED, 0.05).no_gain
