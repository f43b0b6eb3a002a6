"""The claim C19 of the register: what is said of viscous damping beside the algorithmic one."""

from __future__ import annotations

from validation.studies.paper.claims import Band, Claim, Evidence, Finding, by_dda, named

CASES = named("viscous")
CONSTANT, AVERAGE = ([name for name, s in CASES.items() if s.time.delta == delta] for delta in (1, 0.5))
ALIKE = 1.05  # greatest over least damping that counts as independent of the step


def independent(e: Evidence) -> dict[str, float]:
    """Return the damping of the first mode over the steps, under constant and under average acceleration."""
    values: dict[str, float] = {}
    for word, cases in (("(1/2, 1)", CONSTANT), ("(1/4, 1/2)", AVERAGE)):
        ratios = [e.number(case, "mode1.damping") for case in cases]
        for case, xi in zip(cases, ratios, strict=True):
            values[f"xi at dt = {CASES[case].time.step:g}, {word}"] = xi
        values[f"xi, greatest over least, {word}"] = max(ratios) / min(ratios)
    return values


VISCOUS = (
    Claim(
        "C19",
        "not in the paper: said where DDA is damped viscously",
        "Viscous damping makes the result independent of the time step.",
        by_dda(CASES),
        independent,
        (Band("xi, greatest over least, (1/2, 1)", 1, ALIKE),),
        Finding.CONDITIONAL,
        "it adds to the algorithmic damping and does not take its place: with constant acceleration 5 % of viscous "
        "damping become four times as much at dt = 0.002 s",
        "with average acceleration, which has no damping of its own, up to w dt = 0.35",
        (Band("xi, greatest over least, (1/4, 1/2)", 1, ALIKE),),
    ),
)
