"""Seeded faults: what stands in a seam of solver code is replaced for a run; production code has no switch."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from decimal import Decimal
from typing import Any

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


def with_scheme(position: int, **changes: Callable[[float], float]) -> Callable[..., Callable[..., object]]:
    """Hand a function a changed scheme, or a stage, whose weights of accelerations still add up to what they did."""

    def wrap(sound: Callable[..., object]) -> Callable[..., object]:
        def faulty(*arguments: object, **named: object) -> object:
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


def of_one_kind(change: Callable[[float], float], number: float) -> object:
    """Return what a change makes of a number; of a decimal one again a decimal one, which goes with no doubles."""
    return Decimal(change(float(number))) if isinstance(number, Decimal) else change(number)


def times(factor: float) -> Callable[..., Callable[..., object]]:
    """Multiply what a function returns."""
    return lambda sound: lambda *a, **k: factor * sound(*a, **k)


def first_times(factor: float) -> Callable[..., Callable[..., object]]:
    """Multiply the first argument of a function."""
    return lambda sound: lambda first, *a, **k: sound(first * factor, *a, **k)


def late(sound: Callable[..., np.ndarray]) -> Callable[..., np.ndarray]:
    """Report every step one step late, along the axis of steps."""

    def faulty(*a: object, **k: object) -> np.ndarray:
        found = sound(*a, **k)
        axis = int(np.argmax(found.shape))
        shifted = np.roll(found, 1, axis=axis)
        np.moveaxis(shifted, axis, 0)[0] = 0.0
        return shifted

    return faulty


def told(change: Callable[..., dict[str, object]]) -> Callable[..., Callable[..., object]]:
    """Change fields of what a function returns, a dataclass, or what that makes when it is asked for."""

    def wrap(sound: Callable[..., object]) -> Callable[..., object]:
        def faulty(*a: object, **k: object) -> object:
            found = sound(*a, **k)
            return changed(found, change(found))

        return faulty

    return wrap


def changed(found: Any, values: Mapping[str, object]) -> Any:
    """Return a dataclass with other values of its fields and properties."""
    stored = {one.name for one in fields(found)} & values.keys()
    other = replace(found, **{name: values[name] for name in stored})
    made = {name: value for name, value in values.items() if name not in stored}
    assert all(hasattr(found, name) for name in made), f"{type(found).__name__} has no {sorted(made)}"
    object.__setattr__(other, "__class__", type(type(found).__name__, (type(found),), made))
    return other


def of_first(change: Callable[..., dict[str, object]]) -> Callable[..., Callable[..., object]]:
    """Change fields of the first argument of a function, such as a model or a problem, a dataclass."""
    return lambda sound: lambda first, *a, **k: sound(replace(first, **change(first)), *a, **k)


def scaled(**factors: float) -> Callable[..., Callable[..., object]]:
    """Multiply fields of the first argument of a function."""
    return of_first(lambda first: {name: getattr(first, name) * factor for name, factor in factors.items()})


def energy_changed(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Callable[..., Callable[..., object]]:
    """Change one of the energies that a function returns, where they are kept."""
    return told(lambda found: {"energies": found.energies and found.energies | {name: change(found.energies[name])}})


def soft_springs(factor: float) -> Callable[..., Callable[..., object]]:
    """Change the stiffness of the contact springs of the DDA model."""

    def wrap(sound: Callable[..., object]) -> Callable[..., object]:
        def faulty(material: object, contact: object, area: float, a: float) -> object:
            changed = replace(contact, stiffness=contact.stiffness * factor)
            return sound(material, changed, area, a)

        return faulty

    return wrap


def no_discount(position: int) -> Callable[..., Callable[..., object]]:
    return with_scheme(position, gg=lambda gg: 1.0)


def undiscounted(position: int) -> Callable[..., Callable[..., object]]:
    """Hand a function the discount one."""

    def wrap(sound: Callable[..., object]) -> Callable[..., object]:
        def faulty(*arguments: object) -> object:
            return sound(*arguments[:position], 1.0, *arguments[position + 1 :])

        return faulty

    return wrap


def thousandth(delta: float) -> float:
    return 1.001 * delta


def no_damping(delta: float) -> float:
    return 0.501 if delta == 0.5 else 0.5


def swapped(start: str) -> str:
    return "zero" if start == "consistent" else "consistent"
