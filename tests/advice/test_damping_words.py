"""What `advise damping` says as plain data, with every number computed apart."""

from dataclasses import replace

from validation.advice.spectra import ModeDamping, runs


def test_what_has_no_damping_ratio_of_its_own_is_not_split():
    """At gg < 1 a mode may oscillate that without the discount has a root that is not positive."""
    mode = ModeDamping("contact", 1e3, 0.4, 0.6, 2.0, None, None, 0.1, -0.2)
    assert runs(mode) == "is damped at 40 % of critical, kinetic and algorithmic"
    assert runs(replace(mode, algorithmic=0.1, kinetic=0.3)).endswith("10 % algorithmic and 30 % kinetic")
    assert runs(replace(mode, algorithmic=0.4, kinetic=0.0)).endswith("all of it algorithmic")
