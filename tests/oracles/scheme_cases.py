"""Schemes by name with parameters, for tests of everything that steps."""

import pytest

from dda import named_scheme

CASES = (
    ("chung-hulbert", {"rho_inf": 0.8}),
    ("chung-hulbert", {"rho_inf": 0.0}),
    ("hht", {"rho_inf": 0.65}),
    ("wbz", {"rho_inf": 0.35}),
    ("leapfrog", {}),
    ("composite", {}),
    ("composite", {"rho_inf": 0.45}),
    ("composite", {"rho_inf": 0.3, "split": 0.4}),
)
IDS = [f"{name} {' '.join(f'{value:g}' for value in values.values())}".strip() for name, values in CASES]
every_scheme = pytest.mark.parametrize(("name", "values"), CASES, ids=IDS)
SHORT = CASES[0], *CASES[4::3]  # generalised-alpha, leapfrog, composite
few_schemes = pytest.mark.parametrize(
    ("name", "values"),
    [pytest.param(*case, marks=() if case in SHORT else pytest.mark.long) for case in CASES],
    ids=IDS,
)


def scheme_of(name, values, step, gg=1.0, start="consistent"):
    return named_scheme(name, step=step, gg=gg, start=start, **values)


def truth_of(values):
    """Return the parameters as the independent program takes them."""
    return {"rho": values.get("rho_inf", 0.0), "split": values.get("split")}
