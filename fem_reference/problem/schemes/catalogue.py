"""The schemes by their names: another one is a file of numbers beside this one, and a line here."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from fem_reference.problem.problem import Scheme
from fem_reference.problem.schemes.composite import composite
from fem_reference.problem.schemes.generalised_alpha import LAGS, generalised_alpha
from fem_reference.problem.schemes.leapfrog import leapfrog
from fem_reference.problem.stages import StageTable

TABLES: dict[str, Callable[[float | None, float | None], StageTable]] = {
    **{name: partial(generalised_alpha, name) for name in LAGS},
    "leapfrog": leapfrog,
    "composite": composite,
}
"""What makes the table of a scheme of its rho_inf and split, None where they are not given."""
SCHEMES = ("newmark", *TABLES)
"""Names of all schemes."""


def named_scheme(
    name: str,
    *,
    step: float,
    gg: float = 1.0,
    start: str = "consistent",
    rho_inf: float | None = None,
    split: float | None = None,
) -> Scheme:
    """A scheme by its name.

    Parameters
    ----------
    name
        Among `SCHEMES`, but for ``"newmark"``, which is `Scheme` with its alpha and delta.
    step
        Time step dt [s].
    gg
        Factor on the velocity at the start of each step, 0 to 1.
    start
        ``"consistent"``, M A0 = F, or ``"zero"``, A0 = 0.
    rho_inf
        Radius for infinitely fast modes, of generalised-alpha (needed) and of the composite scheme (0 if None).
    split
        Where the first stage of the composite scheme ends, over the step.

    Raises
    ------
    ValueError
        For an unknown name, or a value out of its range or not of the scheme.

    Examples
    --------
    >>> scheme = named_scheme("chung-hulbert", rho_inf=0.8, step=1e-3)
    >>> round(scheme.stages[0].af, 6)
    0.444444
    """
    if name not in TABLES:
        raise ValueError(
            f"name: must be one of {tuple(TABLES)}, or Scheme(alpha, delta, ...) for 'newmark', got {name!r}"
        )
    return Scheme(math.nan, math.nan, gg, step, start, table=TABLES[name](rho_inf, split))
