"""The restitution map of a penalty contact: its lines."""

import pytest

from fem_reference.events.restitution import ContactScheme, branches, restitution


@pytest.mark.parametrize(
    ("alpha", "delta", "gg", "omega"), [(0.5, 1.0, 0.3, 0.3), (0.3025, 0.6, 0.9, 1.7), (0.5625, 1.0, 1.0, 3.1)]
)
def test_lines_of_the_restitution_are_the_steps_of_one_impact(alpha, delta, gg, omega):
    """The first stays on its base for ever: it has no speed left. Steps of unit length in plain numbers."""
    scheme = ContactScheme(alpha, delta, gg)
    lines = branches(scheme, omega)
    assert [line.low for line in lines] == [0.0, *(line.high for line in lines[:-1])] and lines[-1].high == gg
    for theta in (0.07 * gg, 0.41 * gg, 0.83 * gg):
        reached = -theta  # by the end of the step without contact
        v = -1.0
        a = 0.0
        for _ in range(2000):
            if reached >= 0:
                break
            before = a
            a = -(omega**2) * reached / (1 + alpha * omega**2)
            v = gg * v + (1 - delta) * before + delta * a
            reached = reached + alpha * a + gg * v + (0.5 - alpha) * a
        expected = gg * v + (1 - delta) * a if reached >= 0 else 0.0
        assert restitution(scheme, omega, theta) == pytest.approx(expected, rel=1e-9, abs=1e-15), theta
