"""The numbers of docs/methods.md."""

import math

from validation.theory import overshoot, rebound, stages
from validation.theory.stepping import Stepping

named = Stepping.named
average = Stepping(1.0, alpha=0.25, delta=0.5)
first, contact = 0.52409557, 8.6550857
cards = {
    "(1/2, 1)": Stepping(1.0, alpha=0.5, delta=1.0),
    "CH 0.8": named("chung-hulbert", rho_inf=0.8),
    "CH 0": named("chung-hulbert", rho_inf=0.0),
    "TR-BDF2": named("composite"),
}
percent = {name: round(100 * scheme.damping_ratio(first), 4) for name, scheme in cards.items()}
assert percent == {"(1/2, 1)": 12.5446, "CH 0.8": 0.0093, "CH 0": 3.809, "TR-BDF2": 0.0511}
assert not cards["(1/2, 1)"].oscillates(contact)  # real roots: the contact flips from step to step, damped to 0.893
assert round(cards["(1/2, 1)"].spectral_radius(contact), 3) == 0.893
assert round(100 * cards["CH 0.8"].damping_ratio(contact), 2) == 2.43

rigid = {
    name: rebound.rebound_statistics(rebound.spring_steps(scheme.stages, math.inf), count=2000)
    for name, scheme in {
        "(1/2, 1)": cards["(1/2, 1)"],
        "(1/4, 1/2)": average,
        "CH 0.8": cards["CH 0.8"],
        "HHT -0.1": named("hht", rho_inf=0.9 / 1.1),
        "Bathe 1/2": named("composite", split=0.5),
        "CH 0": cards["CH 0"],
    }.items()
}
greatest = {name: round(statistics.most, 2) for name, statistics in rigid.items()}
assert greatest == {"(1/2, 1)": 1.0, "(1/4, 1/2)": 3.0, "CH 0.8": 2.89, "HHT -0.1": 2.67, "Bathe 1/2": 2.0, "CH 0": 1.0}
assert round(rigid["CH 0.8"].mean_square, 2) == 3.15 and round(rigid["CH 0"].mean_square, 2) == 0.48

W = 3.0
assert math.isclose(overshoot.greatest_rise(stages.chung_hulbert(0.0), [W], [1.0]), W**6 / (16 * (2 + W**2) ** 2))
