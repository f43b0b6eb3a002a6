"""Seeded faults: what stands in a seam of solver code is replaced for a run; production code has no switch."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from decimal import Decimal

import numpy as np
from faults.seams import Seam

from dda.scheme.stage import Stage
from fem_reference.problem.stages import Stage as ElementStage


@dataclass(frozen=True)
class Fault:
    """A seeded fault: which solvers it reaches, the seam it enters by, and what it makes of the sound function."""

    name: str
    solvers: tuple[str, ...]
    seam: Seam
    replacement: Callable[[Callable[..., object]], object]


def with_scheme(position, **changes):
    """Hand a function a changed scheme, or a stage, whose weights of accelerations still add up to what they did."""

    def wrap(sound):
        def faulty(*arguments, **named):
            scheme = arguments[position]
            values = {name: of_one_kind(change, getattr(scheme, name)) for name, change in changes.items()}
            for weight in {"delta", "gamma"} & set(values):
                if isinstance(scheme, Stage | ElementStage):
                    values["g_0"] = scheme.g_0 + getattr(scheme, weight) - values[weight]  # type: ignore[operator]
            is_stage = isinstance(scheme, Stage | ElementStage)
            changed = scheme._replace(**values) if is_stage else replace(scheme, **values)
            return sound(*arguments[:position], changed, *arguments[position + 1 :], **named)

        return faulty

    return wrap


def of_one_kind(change, number):
    """Return what a change makes of a number; of a decimal one again a decimal one, which goes with no doubles."""
    return Decimal(change(float(number))) if isinstance(number, Decimal) else change(number)


def times(factor):
    """Multiply what a function returns."""
    return lambda sound: lambda *a, **k: factor * sound(*a, **k)


def first_times(factor):
    """Multiply the first argument of a function."""
    return lambda sound: lambda first, *a, **k: sound(first * factor, *a, **k)


def late(sound):
    """Report every step one step late, along the axis of steps."""

    def faulty(*a, **k):
        found = sound(*a, **k)
        axis = int(np.argmax(found.shape))
        shifted = np.roll(found, 1, axis=axis)
        np.moveaxis(shifted, axis, 0)[0] = 0.0
        return shifted

    return faulty


def told(change):
    """Change fields of what a function returns, or what a dataclass makes when it is asked for."""

    def wrap(sound):
        def faulty(*a, **k):
            found = sound(*a, **k)
            return changed(found, change(found))

        return faulty

    return wrap


def changed(found, values):
    """Return a dataclass with other values of its fields and properties, or a named tuple with other fields."""
    if isinstance(found, tuple):
        return found._replace(**values)
    stored = {one.name for one in fields(found)} & values.keys()
    other = replace(found, **{name: values[name] for name in stored})
    made = {name: value for name, value in values.items() if name not in stored}
    assert all(hasattr(found, name) for name in made), f"{type(found).__name__} has no {sorted(made)}"
    object.__setattr__(other, "__class__", type(type(found).__name__, (type(found),), made))
    return other


def of_first(change):
    """Change fields of the first argument of a function, such as a model or a problem, a dataclass."""
    return lambda sound: lambda first, *a, **k: sound(replace(first, **change(first)), *a, **k)


def scaled(**factors):
    """Multiply fields of the first argument of a function."""
    return of_first(lambda first: {name: getattr(first, name) * factor for name, factor in factors.items()})


def larger(factor):
    """Multiply the columns of a history."""
    return told(lambda result: {"columns": {name: factor * x for name, x in result.columns.items()}})


def of_fields(**changes):
    """Change fields of the first argument of a function, each by a function of its value."""
    return of_first(lambda first: changed_fields(first, changes))


def returned(**changes):
    """Change fields of what a function returns, each by a function of its value."""
    return told(lambda found: changed_fields(found, changes))


def changed_fields(record, changes):
    return {name: change(getattr(record, name)) for name, change in changes.items()}


def energy_changed(name, change):
    """Change one of the energies that a function returns, where they are kept."""
    return told(lambda found: {"energies": found.energies and found.energies | {name: change(found.energies[name])}})


def soft_springs(factor):
    """Change the stiffness of the contact springs of the DDA model."""

    def wrap(sound):
        def faulty(material, contact, area, a):
            changed = replace(contact, stiffness=contact.stiffness * factor)
            return sound(material, changed, area, a)

        return faulty

    return wrap


def no_discount(position):
    return with_scheme(position, gg=lambda gg: 1.0)


def undiscounted(position):
    """Hand a function the discount one."""

    def wrap(sound):
        def faulty(*arguments):
            return sound(*arguments[:position], 1.0, *arguments[position + 1 :])

        return faulty

    return wrap


def thousandth(delta):
    return 1.001 * delta


def no_damping(delta):
    return 0.501 if delta == 0.5 else 0.5


def swapped(start):
    return "zero" if start == "consistent" else "consistent"
