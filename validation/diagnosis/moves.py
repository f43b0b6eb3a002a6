"""The candidate changes of `moves.toml`: ways to put a cause into the scene's own computation."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from validation.diagnosis.constants import ARITHMETIC, DISCOUNTS, SLIGHT, UNITS
from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.fits.target import Target
from validation.diagnosis.schemes import EXPLICIT, SHARED
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Variant


@dataclass(frozen=True, eq=False)
class Move:
    """One way to put a cause into a computation."""

    id: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    free: tuple[str, ...] = ()  # numbers that a fit finds
    starts: Sequence[float] = ()  # of the first of them


MORE_UNITS = (1e-6, *UNITS, 1e6)  # given: factors of data in other units
FACTORS = np.geomspace(1 / 30, 30.0, 24).tolist()  # to begin from, a third apart: the nearest two are fitted
SHARES = np.linspace(0.05, 0.95, 19).tolist()  # of what is between nothing and all of it
STARTS: dict[str, list[float]] = {
    "by hand": FACTORS,
    "factors": [*FACTORS, *MORE_UNITS],
    "softnesses": [SLIGHT, *np.log([*FACTORS, *MORE_UNITS]).tolist()],
    "shares": SHARES[::3],
    "restitutions": SHARES,
    "discounts": list(DISCOUNTS),
}
AVERAGE_ACCELERATION: dict[str, Any] = {"alpha": 0.25, "delta": 0.5, "start": "consistent"}
CONSTANT_ACCELERATION: dict[str, Any] = {"alpha": 0.5, "delta": 1.0, "start": "zero"}
PLAIN_CONTACT: dict[str, Any] = {
    "family": "newmark",
    "spectral": 0.0,
    "band": 0.0,
    "reopening": 0.0,
}  # of methods with their own force
FINE_BANDS = np.geomspace(1e-4, 2.0, 130).tolist()  # over the static displacement; between closings of successive steps
OPENING_TENSION = "opening-tension"
OF_NTDDA = 1e-3  # given: gap that opens over the penetration that closes, in ntdda and its relatives
REOPENINGS = (0.0, OF_NTDDA, 1.0)  # the same, as programs have it
TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


def moves(target: Target, scene: Variant) -> list[Move]:
    """Return every way in which causes of the catalogue may be in a history."""
    met = _conditions(target, scene)
    options = _options(target, scene)
    step = np.mean(target.steps)
    starts_by_name = STARTS | {"times": (step * np.array(FACTORS)).tolist()}
    candidates = []
    for row in (*TABLE["integrator"], *TABLE["output"], *TABLE["model"], *TABLE["contact"]):
        if not met[row.get("when", "")]:
            continue
        variations = [row.get("with", {})]
        for name in row.get("for", []):
            of_family = [{"spectral": number} for number in SHARED.get(variations[0].get("family"), ())]
            choices = of_family if name == "shared" else options[name]
            variations = [changes | choice for changes in variations for choice in choices]
        for name, values in row.get("each", {}).items():
            variations = [changes | {name: value} for changes in variations for value in values]
        starts = row.get("starts", [])
        starts = starts_by_name[starts] if isinstance(starts, str) else starts
        candidates += [Move(row["cause"], changes, tuple(row.get("free", [])), starts) for changes in variations]
    return [*candidates, *dead_bands(target, scene, FINE_BANDS[::3])]


def _conditions(target: Target, scene: Variant) -> dict[str, bool]:
    """Return what a row of the table may ask for.

    Unequal steps, and blocks with a Poisson's ratio on contact that opens, are tried with Newmark's schemes only. A
    history that never pulls is the same with a contact that opens.
    """
    has_equal_steps = float(np.ptp(target.steps)) <= ARITHMETIC * float(target.steps[0])
    has_poisson = bool(target.column.poisson)
    is_newmark = scene.family == "newmark"
    is_pulled = not scene.opens and pulls(target, scene)
    return {
        "": True,
        "locked": not scene.opens,
        "locked newmark": not scene.opens and is_newmark,
        "locked, equal steps": not scene.opens and has_equal_steps,
        "opens": scene.opens,
        "opens, no poisson": scene.opens and not has_poisson,
        "pulls": is_pulled,
        "pulls with poisson": is_pulled and has_poisson,
        "pressure": target.pressure is not None,
        "gravity": bool(target.column.gravity),
        "poisson": has_poisson,
        "no poisson": not has_poisson,
        "discounted": scene.gg < 1,
        "discounted newmark": scene.gg < 1 and is_newmark and scene.alpha > 0,
        "interchangeable": is_newmark and scene.alpha != scene.delta,
        "started": has_start(scene),
        "weighted": is_newmark and scene.delta not in (0.5, 1.0),
        "other schemes": has_equal_steps and not (scene.opens and has_poisson),
    }


def _options(target: Target, scene: Variant) -> dict[str, list[dict[str, Any]]]:
    """Return fields of a variant that go with a scene, by the names that the table has for them."""
    scene_pair = (scene.alpha, scene.delta) if scene.family == "newmark" else None
    scene_scheme = {"alpha": scene.alpha, "delta": scene.delta, "start": scene.start}
    named = [{"alpha": a, "delta": d, "family": "newmark"} for a, d in NAMED.values() if (a, d) != scene_pair]
    other_start = "zero" if scene.start == "consistent" else "consistent"
    pairs = dict.fromkeys(
        [*([scene_pair] if scene_pair else []), NAMED["average acceleration"], NAMED["constant acceleration"]]
    )
    of_contact = [*([scene_scheme] if scene_pair else []), AVERAGE_ACCELERATION, CONSTANT_ACCELERATION]
    return {
        "start": [{"start": scene.start}, {"start": other_start}],
        "other start": [{"start": other_start}],
        "named": named,
        "unnamed": [{"alpha": a, "delta": d, "family": "newmark"} for a, d in pairs],
        "interchanged": [{"alpha": scene.delta, "delta": scene.alpha}],
        "swapped weights": [{"delta": 1 - scene.delta}],
        "discount": [{"gg": gg} for gg in (scene.gg**2, math.sqrt(scene.gg), 1.0)],
        "form": [{"contact": name} for name in ("springs", "mean gap")] if scene.opens else [{}],
        "no poisson": [{"poisson": -target.column.poisson}],
        "ramp start": [{"start": start} for start in dict.fromkeys(("zero", scene.start))],
        "average acceleration": [PLAIN_CONTACT | AVERAGE_ACCELERATION],
        "scheme of contact": [
            PLAIN_CONTACT | scheme for i, scheme in enumerate(of_contact) if scheme not in of_contact[:i]
        ],
    }


def has_start(v: Variant) -> bool:
    """Whether a scheme starts from an acceleration that may be zero or consistent."""
    return v.family not in EXPLICIT and not (v.family == "theta" and v.spectral == 1)


def dead_bands(target: Target, scene: Variant, shares: Sequence[float]) -> Iterator[Move]:
    """Yield dead bands and tensions that a contact bears; none where the contact never pulls.

    Bands are shares of the static displacement, tensions of the static pressure.
    """
    if not (scene.opens or pulls(target, scene)):
        return
    opens = {} if scene.opens else {"opens": True}
    size = abs(target.column.static)
    penetration = abs(target.column.force) / target.column.normal
    for share in shares:
        for part in REOPENINGS:
            yield Move("dead-band", {**opens, "band": share * size, "reopening": part})
        yield Move(OPENING_TENSION, {**opens, "hold": share * penetration, "band": 0.0, "reopening": 0.0})


def pulls(target: Target, variant: Variant) -> bool:
    """Whether the contact of a variant is in tension in some step, if it carries any."""
    pressure = histories(target.column, [variant], target.steps).pressure[:, 0]
    return bool(np.any(pressure < -ARITHMETIC * np.max(np.abs(pressure))))
