"""Schemes by name: a scheme is a function that returns its numbers, in a file of its own, and a line here."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable

from dda.scheme.composite import composite
from dda.scheme.generalised_alpha import chung_hulbert, hilber_hughes_taylor, wood_bossak_zienkiewicz
from dda.scheme.leapfrog import leapfrog
from dda.scheme.newmark import NEWMARK, Scheme, Start
from dda.scheme.stage import Table

TABLES: dict[str, Callable[..., Table]] = {
    "chung-hulbert": chung_hulbert,
    "hht": hilber_hughes_taylor,
    "wbz": wood_bossak_zienkiewicz,
    "leapfrog": leapfrog,
    "composite": composite,
}
SCHEMES: tuple[str, ...] = (NEWMARK, *TABLES)


def named_scheme(
    name: str,
    *,
    step: float,
    gg: float = 1.0,
    start: Start = "consistent",
    rho_inf: float | None = None,
    split: float | None = None,
) -> Scheme:
    """Return a scheme by its name; Newmark's is `dda.Scheme(alpha, delta, gg, step)`.

    Parameters
    ----------
    name : str
        Among `dda.SCHEMES`, but for "newmark".
    step : float
        dt [s].
    gg : float
        Share of the velocity that a whole step starts with [-].
    rho_inf : float, optional
        Spectral radius at infinite frequency [-], of all but the leapfrog.
    split : float, optional
        Where the first stage of "composite" ends, over the step [-].

    Raises
    ------
    ValueError
        If the name is unknown, a parameter is out of range, missing or not one of the scheme's.

    Examples
    --------
    >>> round(named_scheme("hht", step=1e-3, rho_inf=0.8).stages[0].af, 6)
    0.111111
    """
    if name not in TABLES:
        other = "; Newmark's is dda.Scheme(alpha, delta, ...)" if name == NEWMARK else ""
        raise ValueError(f"name: must be among {', '.join(TABLES)}, got {name!r}{other}")
    parameters = inspect.signature(TABLES[name]).parameters
    values: dict[str, float] = {}
    for field, value in (("rho_inf", rho_inf), ("split", split)):
        if value is None:
            if field in parameters and parameters[field].default is inspect.Parameter.empty:
                raise ValueError(f"{field}: must be given with {name}, got None")
            continue
        if field not in parameters:
            raise ValueError(f"{field}: does not go with {name}, got {value!r}")
        if not math.isfinite(value):
            raise ValueError(f"{field}: must be finite, got {value!r}")
        values[field] = float(value)
    table = TABLES[name](**values)
    last = table.stages[-1]
    return Scheme(last.alpha, last.delta, gg, step, start, name=name, table=table)
