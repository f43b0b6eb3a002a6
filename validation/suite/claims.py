"""The register of claims: what the paper says, how that is tested, what comes out.

A claim is data of a file ``claims.toml`` and a test: the cases that it needs, the numbers measured on them. It is
*confirmed* where all bands of the statement as printed hold, *confirmed under a condition* where only those with the
condition hold, and *refuted* otherwise. The expected verdict is a gate of the register's study.
"""

from __future__ import annotations

import enum
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import starmap
from pathlib import Path
from typing import Any

import numpy as np

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.engine.judge import HORIZON
from validation.gates.gate import Gate
from validation.metrics.catalogue import SOLO
from validation.metrics.columns import settling_step
from validation.metrics.values import QUANTITIES
from validation.runs.history import Array
from validation.runs.row import Metrics, Value
from validation.scenes.scene import Scene
from validation.suite.bands import about, cases, gate

REGISTER = "claims"  # the name under which gates find the register's rows
READ = tuple(metric for metric in SOLO if metric != HORIZON)  # what claims may read: no two codes are compared
Needs = tuple[tuple[str, str], ...]


class Finding(enum.IntEnum):
    """What comes out of a test of a claim."""

    REFUTED = 0
    CONDITIONAL = 1
    CONFIRMED = 2

    @property
    def words(self) -> str:
        """The verdict in words."""
        return ("refuted", "confirmed under a condition", "confirmed")[self]


@dataclass(frozen=True)
class Band:
    """A band for a measured number, both edges inside."""

    number: str
    low: float
    high: float

    def holds(self, numbers: Mapping[str, float]) -> bool:
        """Whether the number was measured and lies inside."""
        return self.low <= numbers.get(self.number, np.nan) <= self.high


class Evidence:
    """The finished cases, as the measures of claims read them."""

    def __init__(self, finished: Finished) -> None:
        self.finished = finished

    def number(self, case: str, metric: str, solver: str = "dda") -> float:
        """Return a metric of a case; NaN where it is no number."""
        value = self.finished.rows[case, solver].metrics.get(metric)
        return float(value) if isinstance(value, float | int) else np.nan

    def scaled(self, case: str, quantity: str) -> Array:
        """Return a history over its static value."""
        history = self.finished.history(case, "dda")
        if history is None:
            return np.zeros(0)
        return history.columns[QUANTITIES[quantity]] / self.number(case, f"{quantity}.static")

    def settles(self, case: str, quantity: str, tolerance: float = 0.01) -> float:
        """Return the first step from which a quantity stays within a tolerance of static; NaN if never."""
        step = settling_step(self.scaled(case, quantity), 1.0, tolerance)
        return step if isinstance(step, float) else np.nan


Measure = Callable[[Evidence], dict[str, float]]
Tests = dict[str, tuple[Iterable[str | tuple[str, str]], Measure]]
"""By a claim's id: the cases that it needs, of DDA where no solver is named, and what it measures."""


@dataclass(frozen=True)
class Claim:
    """One statement and its test."""

    id: str
    place: str  # in the paper
    says: str  # in our words
    needs: Needs  # case and solver of each run
    measure: Measure
    expected: Finding
    why: str  # the verdict is expected, in one sentence
    printed: tuple[Band, ...]  # hold if the statement holds as printed
    condition: str = ""  # under which it holds
    conditional: tuple[Band, ...] = ()  # hold then
    numbers: tuple[tuple[str, float, float], ...] = ()  # name, value, half a unit of its last digit, by another code
    misprint: bool = False  # a slip of print in an equation or a number, which no curve or conclusion hangs on

    def finding(self, numbers: Mapping[str, float]) -> Finding:
        """Return the verdict on measured numbers."""
        if all(band.holds(numbers) for band in self.printed):
            return Finding.CONFIRMED
        holds = bool(self.conditional) and all(band.holds(numbers) for band in self.conditional)
        return Finding.CONDITIONAL if holds else Finding.REFUTED

    def row(self) -> Derived:
        """Return the derived row of the verdict and the measured numbers."""
        return Derived(REGISTER, self.id, self.needs, self._compute, READ)

    def _compute(self, finished: Finished) -> Metrics:
        numbers = self.measure(Evidence(finished))
        values = {k: _plain(v) for k, v in numbers.items()}
        return {"verdict": float(self.finding(numbers))} | values

    def gate(self) -> Gate:
        """Return the gate that holds the verdict to the expected one."""
        reason = f"expected verdict: {self.expected.words}, since {self.why}"
        return Gate(REGISTER, (self.id,), "verdict", float(self.expected), float(self.expected), reason)


def _plain(number: float) -> Value:
    """Return a number as JSON keeps it; a count stays an integer, whose zero is no rounding."""
    if not np.isfinite(number):
        return "undefined"
    return number if isinstance(number, int) else float(number)


def whole(number: float) -> float:
    """Return a count of steps as an integer; NaN, where there is none, as it is."""
    return int(number) if np.isfinite(number) else number


def named(*scenes: str) -> dict[str, Scene]:
    """Return cases of built-in scenes by name."""
    return {case.name: case for case in cases(*scenes)}


def read_claims(path: Path, tests: Tests) -> tuple[Claim, ...]:
    """Return the claims of a file with their tests."""
    findings = {finding.words: finding for finding in Finding}
    claims = []
    for entry in tomllib.loads(path.read_text(encoding="utf-8"))["claim"]:
        names, measure = tests[entry["id"]]
        claim = entry | {
            "needs": tuple((need, "dda") if isinstance(need, str) else need for need in names),
            "measure": measure,
            "expected": findings[entry["expected"]],
            "printed": tuple(starmap(Band, entry["printed"])),
            "conditional": tuple(starmap(Band, entry.get("conditional", ()))),
            "numbers": tuple(entry.get("numbers", ())),
        }
        claims.append(Claim(**claim))
    return tuple(claims)


# ---- the page ----


@dataclass(frozen=True)
class Register:
    """A register of claims."""

    study: str
    title: str
    page: str  # in the documentation
    introduction: str
    claims: tuple[Claim, ...]

    def gates(self) -> tuple[Gate, ...]:
        """Return the gates on the verdicts, and on numbers that an independent program gives."""
        gates = [claim.gate() for claim in self.claims]
        for claim in self.claims:
            for number, value, half in claim.numbers:
                reason = f"independent program: {'half a unit of its last digit' if half else 'whole number'}"
                gates.append(gate(REGISTER, claim.id, number, about(value, half), reason, uncertainty=half))
        return tuple(gates)

    def rows(self) -> DerivedRows:
        """Return the rows of the register."""
        return tuple(claim.row() for claim in self.claims)

    def words(self) -> dict[str, Any]:
        """Return what each claim says, why it has its verdict, on which condition, and which are misprints."""
        return {
            "statement": {claim.id: f"{claim.says} ({claim.place})" for claim in self.claims},
            "why": {claim.id: f"{claim.why[:1].upper()}{claim.why[1:]}." for claim in self.claims},
            "condition": {claim.id: f" Condition: {claim.condition}." for claim in self.claims},
            "statements": [claim.id for claim in self.claims if claim.id.startswith("C")],
            "slips": [claim.id for claim in self.claims if claim.id.startswith("S")],
            "misprints": [claim.id for claim in self.claims if claim.misprint],
        }


def entries(register: Register, rows: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return the claims with their verdicts and measured numbers as plain data."""
    measured = {row["name"]: row["metrics"] for row in rows}
    listed = []
    for claim in register.claims:
        numbers = dict(measured.get(claim.id, {}))
        verdict = numbers.pop("verdict", None)
        fields = {name: getattr(claim, name) for name in ("id", "says", "place")}
        outcome = {
            "verdict": None if verdict is None else Finding(int(verdict)).words,
            "expected": claim.expected.words,
            "condition": claim.condition,
            "why": claim.why,
            "numbers": numbers,
        }
        listed.append(fields | outcome)
    return listed


def page(register: Register, rows: Iterable[Mapping[str, Any]]) -> str:
    """Return a register as a Markdown page, from its study's derived rows."""
    parts = [f"# {register.title}", register.introduction]
    for entry in entries(register, rows):
        condition = f" ({entry['condition']})" if entry["verdict"] == Finding.CONDITIONAL.words else ""
        parts += [
            f"## {entry['id']}: {entry['verdict']}{condition}",
            f"*{entry['says']}* ({entry['place']}): {entry['why']}.",
        ]
    return "\n\n".join(parts) + "\n"
