"""The methods that the study compares: what a scene sets for each, and its name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory import rebound, stages
from validation.theory.stepping import Stepping


@dataclass(frozen=True, eq=False)
class Method:
    """A time scheme with its numbers, or a contact method."""

    id: str  # of scenes and gates
    label: str  # of tables and figures
    values: Mapping[str, Any]  # of a scene; the start is consistent
    group: str  # "Newmark", "generalised-alpha", "composite", "explicit" or "contact"
    gains: bool  # whether contact that opens and closes can give energy

    def scene(self, base: Scene, values: Mapping[str, Any]) -> Scene:
        """Return a scene with this method and other values, without its sweep."""
        still = base.model_copy(update={"sweep": {}})
        return still.with_values({"time.start": "consistent", **values, **self.values})

    @property
    def solves(self) -> int:
        """Solves of a step without open-close iteration, evaluations of the force where there are none."""
        return 2 if self.values.get("time.scheme") == "composite" else 1

    @property
    def order(self) -> int:
        """Order in the step where contact opens and closes."""
        return 1 if self.values.get("contact.rule") == "implicit" else self.stepping.order

    def step_of_impact(self, omega: float | Array) -> rebound.Advance:
        """Return the step of a rigid mass on a spring, W = sqrt(k/m) dt."""
        rule = self.values.get("contact.rule")
        if rule == "energy-conserving":
            return rebound.conserving_steps(omega)
        if rule == "implicit":  # a rigid mass has nothing but the contact's force
            return rebound.spring_steps(stages.newmark(0.5, 1.0), omega)
        return rebound.spring_steps(self.stepping.stages, omega)

    @property
    def stepping(self) -> Stepping:
        """The scheme at the step 1."""
        scheme = self.values.get("time.scheme", "newmark")
        if scheme == "newmark":
            return Stepping(1.0, self.values["time.alpha"], self.values["time.delta"])
        return Stepping.named(scheme, rho_inf=self.values.get("time.rho_inf"), split=self.values.get("time.split"))


def _named(scheme: str, **numbers: float) -> dict[str, Any]:
    return {"time.scheme": scheme} | {f"time.{name}": value for name, value in numbers.items()}


def _newmark(alpha: float, delta: float) -> dict[str, Any]:
    return {"time.scheme": "newmark", "time.alpha": alpha, "time.delta": delta}


METHODS = (
    Method("constant", "(1/2, 1)", _newmark(0.5, 1.0), "Newmark", False),
    Method("average", "(1/4, 1/2)", _newmark(0.25, 0.5), "Newmark", True),
    Method("nine-sixteenths", "(9/16, 1)", _newmark(0.5625, 1.0), "Newmark", False),
    # from A0 = 0, in which case its history is implicit Euler's too
    Method("implicit-euler", "implicit Euler", {**_newmark(1.0, 1.5), "time.start": "zero"}, "Newmark", False),
    Method("ch-0.8", "CH 0.8", _named("chung-hulbert", rho_inf=0.8), "generalised-alpha", True),
    Method("ch-0.5", "CH 0.5", _named("chung-hulbert", rho_inf=0.5), "generalised-alpha", True),
    Method("ch-0", "CH 0", _named("chung-hulbert", rho_inf=0.0), "generalised-alpha", False),
    Method("hht-0.1", "HHT −0.1", _named("hht", rho_inf=0.9 / 1.1), "generalised-alpha", True),
    Method("wbz-0.5", "WBZ 0.5", _named("wbz", rho_inf=0.5), "generalised-alpha", True),
    Method("bathe-half", "Bathe 1/2", _named("composite", rho_inf=0.0, split=0.5), "composite", True),
    Method("tr-bdf2", "TR-BDF2", _named("composite", rho_inf=0.0), "composite", True),
    Method("bathe-0.5", "Bathe ρ∞ = 0.5", _named("composite", rho_inf=0.5), "composite", True),
    Method("leapfrog", "leapfrog", _named("leapfrog"), "explicit", True),
    Method("kane", "Kane", {**_newmark(0.25, 0.5), "contact.rule": "implicit"}, "contact", False),
    Method(
        "conserving",
        "Armero–Petocz",
        {**_newmark(0.25, 0.5), "contact.rule": "energy-conserving", "contact.shear_stiffness": 0.0},
        "contact",
        False,
    ),
)
SCHEMES = tuple(method for method in METHODS if method.group != "contact")  # what a locked contact tells apart


def method(identifier: str) -> Method:
    """Return a method by its id."""
    return next(one for one in METHODS if one.id == identifier)
