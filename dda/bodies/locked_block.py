"""Histories of the two-block model by the robust Newmark step.

They are blocked (`dda.scheme.blocked`) unless the scheme grows or every saving is off; the notes say which.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np

from dda.bodies.gap_form import GapForm, ModalForm, modal_form
from dda.bodies.two_block import TwoBlockModel, carried
from dda.model.arrays import Array
from dda.model.checks import check_damping, check_share
from dda.model.load import at_once, load_share
from dda.result.result import Result, bound_overflow, check_request, linear_result, step_times
from dda.scheme.adaptive import adapted_modes
from dda.scheme.blocked import blocked_modes, why_stepped
from dda.scheme.newmark import Scheme, stepped_modes

ADAPTIVE_COLUMNS = ("discount", "kinetic_damping_loss")  # of self-adaptive damping


def solve(
    model: TwoBlockModel,
    scheme: Scheme,
    steps: int,
    columns: Sequence[str] = ("displacement", "contact_pressure"),
    full: bool = False,
    floor: float | None = None,
) -> Result:
    """Step the two-block model from rest and return the asked columns.

    The model is linear: it is solved, mode by mode, for a load of 1 Pa and the columns are
    multiplied by the load, so that no load, however large, overflows within. An unstable
    scheme is run as asked; a column is infinite from its first overflow on.

    The error is a few roundings of the modes' contributions. A triangle's contact pressure is a
    small difference of these as long as every mode has hardly begun to move (steps * w dt << 1),
    because its base does not feel the load at once; there its error is small beside the load only.

    Parameters
    ----------
    columns : sequence of str
        Any of `dda.COLUMNS`; of self-adaptive damping also "discount" (that each step starts with) and
        "kinetic_damping_loss" (energy taken up to the end of a step, J per metre of thickness).
    full : bool
        Keep all six unknowns, also those that the load cannot reach, and step.
    floor : float, optional
        Least discount, 0 to 1, of self-adaptive damping (`dda.scheme.adaptive`); with 1 nothing is damped. None: the
        scheme's own discount.

    Raises
    ------
    ValueError
        If the number of steps is not positive, a column is unknown, or the discount is adaptive and the scheme has a
        damping of its own or the base moves.
    """
    names = [name for name in columns if floor is None or name not in ADAPTIVE_COLUMNS]
    check_request(steps, names)
    check_damping(scheme.damped, model.load.motion is not None)
    if floor is not None:
        _check_adaptive(model, scheme, floor)
    began = perf_counter()
    form = model.equations if full else model.reached
    size = model.load_size
    damping = {}
    with np.errstate(all="ignore"):
        modal = modal_form(form)
        rows = np.array([form.observers[name] @ modal.shapes for name in names]).reshape(-1, len(modal.load))
        stepped = _why_stepped(model, scheme, modal, full, floor)
        ready = perf_counter()
        if floor is not None:
            adapted = adapted_modes(scheme, modal.frequencies, modal.load, steps, floor)
            observed = rows @ adapted.modes
            damping = dict(zip(ADAPTIVE_COLUMNS, (adapted.discount, adapted.loss * size * size), strict=True))
        elif model.load.ramp:
            shares = np.array([load_share(model.load.ramp, instant) for instant in scheme.instants(steps).tolist()])
            observed = rows @ stepped_modes(scheme, modal.frequencies, modal.load, steps, shares)
        else:
            observed = modal_histories(scheme, modal, rows, steps, blocked=stepped is None)
        observed *= size
        motion = model.load.motion
        if motion is not None:  # what the base causes: its own displacement, and that of the block from it
            moved = modal.translation, motion.at(scheme.instants(steps))
            histories = stepped_modes(scheme, modal.frequencies, 0 * modal.load, steps, moved=moved)
            base_columns = carried(motion, step_times(scheme, steps), names)
            own = np.array([base_columns.get(name, np.zeros(steps)) for name in names])
            bound_overflow(observed, size)
            observed += rows @ histories + own
            size = 1.0
    result = linear_result(
        scheme,
        (began, ready),
        names,
        observed,
        size,
        unknowns=len(form.unknowns),
        nonzeros=int(np.count_nonzero(form.M)),
        factorisations=1,
        solves=steps * len(scheme.stages) if stepped else 0,
        notes=(*_savings(form), f"stepped: {stepped}" if stepped else "blocked"),
    )
    every = result.columns | damping
    return replace(result, columns={name: every[name] for name in columns})


def _check_adaptive(model: TwoBlockModel, scheme: Scheme, floor: float) -> None:
    check_share(floor=floor)
    at_once(model.load, "self-adaptive damping")
    if scheme.table is not None:
        raise ValueError(f"scheme: self-adaptive damping goes with newmark only, got {scheme.name!r}")
    if scheme.gg != 1:
        raise ValueError(f"gg: must be 1 where the discount is adaptive, got {scheme.gg!r}")
    if scheme.damped or model.load.motion is not None:
        excluded = "viscous damping" if scheme.damped else "a base of prescribed motion"
        raise ValueError(f"adaptive discount: excludes viscous damping and a base of prescribed motion, got {excluded}")


def _why_stepped(model: TwoBlockModel, scheme: Scheme, modal: ModalForm, full: bool, floor: float | None) -> str | None:
    """Return why the history is stepped, in words; None where it is blocked."""
    if floor is not None:
        return f"self-adaptive damping, discount at least {floor:g}"
    if full:
        return "all savings off"
    if model.load.ramp:
        return "the load rises in a ramp"
    return "the base moves" if model.load.motion is not None else why_stepped(scheme, modal.frequencies)


def modal_histories(scheme: Scheme, modal: ModalForm, rows: Array, steps: int, blocked: bool) -> Array:
    """Return the columns of every step from rest under 1 Pa, (columns, steps); `rows` observe the modes."""
    if not blocked:
        return rows @ stepped_modes(scheme, modal.frequencies, modal.load, steps)
    static = modal.load / modal.frequencies / modal.frequencies
    return blocked_modes(scheme, modal.frequencies, rows * static, steps)


def _savings(form: GapForm) -> tuple[str, ...]:
    """Say which unknowns were kept if not all of them."""
    if len(form.unknowns) == 6:
        return ()
    return (f"{len(form.unknowns)} of 6 unknowns kept: {', '.join(form.unknowns)}",)
