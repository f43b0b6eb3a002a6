"""The claim C19 of the register: what is said of viscous damping beside the algorithmic one."""

from __future__ import annotations

from validation.suite.claims import Evidence, Tests, named

CASES = named("viscous")
CONSTANT, AVERAGE = ([name for name, s in CASES.items() if s.time.delta == delta] for delta in (1, 0.5))


def independent(e: Evidence) -> dict[str, float]:
    """Return the damping of the first mode over the steps, under constant and under average acceleration."""
    values: dict[str, float] = {}
    for word, cases in (("(1/2, 1)", CONSTANT), ("(1/4, 1/2)", AVERAGE)):
        ratios = [e.number(case, "mode1.damping") for case in cases]
        for case, xi in zip(cases, ratios, strict=True):
            values[f"xi at dt = {CASES[case].time.step:g}, {word}"] = xi
        values[f"xi, greatest over least, {word}"] = max(ratios) / min(ratios)
    return values


TESTS: Tests = {"C19": (CASES, independent)}
