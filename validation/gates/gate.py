"""Gates: a band for a metric of a pair of solvers, with its reason; verdicts are what comes out."""

from __future__ import annotations

import enum
import math
import sys
from dataclasses import dataclass

from validation.runs.numbers import ROUNDING, significant
from validation.runs.records import VerdictRecord
from validation.runs.row import Value

NIL = 1e-6  # of the upper edge: a lower one at which two programs differ at all
LARGEST = sys.float_info.max
KINDS = ("exact", "bound", "other code", "own last value")  # of a reference; a bound says which side a value lies on
NOISE = 1e-9  # relative: what thousands of steps make of rounding, which differs from processor to processor


class Status(enum.StrEnum):
    """What is said of an answer, of what is judged on it, or by a gate: the words of all verdicts."""

    PASS = "PASS"
    FAIL = "FAIL"
    NOT_RUN = "NOT RUN"
    PARTIAL = "PARTIAL"  # of an answer: what it reports passes, but it withholds a column that the problem asks for
    NOT_REPORTED = "not reported"
    NOT_JUDGED = "not judged"
    NOT_APPLICABLE = "not applicable"
    NOT_ANSWERED = "not answered"
    STALE = "stale"  # it answers an earlier pack, in which the problem was another


@dataclass(frozen=True)
class Gate:
    """A two-sided band for one metric of one case.

    Attributes
    ----------
    scene
        Name of the case, the swept values included.
    pair
        Solver and reference; a single solver where the metric is compared with a number only.
        A metric of one run, given a pair, is compared as value / reference - 1.
    low, high
        Edges of the band, both inside.
    reason
        Why these edges; where they come from a formula, the formula.
    reference_kind
        One of `KINDS`.
    reference_uncertainty
        In the metric's own unit; a narrower band is refused.
    until
        Length of the time window [s]; the whole history where None.
    against
        Case of the reference where it is not `scene` itself (another mesh, another step).
    """

    scene: str
    pair: tuple[str, ...]
    metric: str
    low: float
    high: float
    reason: str
    reference_kind: str = "exact"
    reference_uncertainty: float = 0.0
    until: float | None = None
    against: str | None = None

    def __post_init__(self) -> None:
        if not self.low <= self.high:
            raise ValueError(f"{self.id}: band must be [low, high] with low <= high, got [{self.low}, {self.high}]")
        if self.high - self.low < self.reference_uncertainty:
            raise ValueError(
                f"{self.id}: band must not be tighter than the reference's uncertainty "
                f"{self.reference_uncertainty:g}, got width {self.high - self.low:g}"
            )
        if self.reference_kind not in KINDS:
            rule = f"reference_kind must be one of {', '.join(KINDS)}"
            raise ValueError(f"{self.id}: {rule}, got {self.reference_kind!r}")
        if not self.reason:
            raise ValueError(f"{self.id}: reason must be given, got nothing")

    @property
    def cases(self) -> list[tuple[str, str]]:
        """Case and solver (or name of a derived row) of each side of the pair."""
        names = [(self.scene, self.pair[0])]
        return [*names, (self.against or self.scene, self.pair[1])] if len(self.pair) == 2 else names

    @property
    def target(self) -> float:
        """Middle of the band; zero, as of errors, where that is inside or all but inside."""
        of_error = self.high >= 0 and self.low <= NIL * self.high
        return 0.0 if of_error else (self.low + self.high) / 2

    @property
    def tolerance(self) -> float:
        """How far from the target a value may be, relative to it where it is not zero."""
        widest = max(self.high - self.target, self.target - self.low)
        return widest / (abs(self.target) or 1.0)

    def margin(self, value: float) -> float | None:
        """Return the share of the way from the target to the edge that a value leaves, negative outside the band.

        None where that says nothing: the edge is the target or nowhere, or the tolerance is rounding.
        """
        way = (self.high if value >= self.target else self.low) - self.target
        if self.tolerance < NOISE or way == 0 or math.isinf(way):
            return None
        return 1 - (value - self.target) / way

    @property
    def id(self) -> str:
        """Stable id: scene, pair, metric and window."""
        window = "" if self.until is None else f"@{self.until:g}s"
        other = "" if self.against is None else f"({self.against})"
        return f"{self.scene}:{'-'.join(self.pair)}{other}:{self.metric}{window}"


@dataclass(frozen=True)
class Verdict:
    """What a gate said of a value; `value` is a number, "undefined", "not reported" or None (nothing measured)."""

    gate: Gate
    value: Value
    status: Status
    why: str = ""

    def record(self, study: str) -> VerdictRecord:
        """Return the verdict as plain data, rounded well above the last bits."""
        g = self.gate
        value = settled(self.value) if isinstance(self.value, float) else self.value
        margin = g.margin(self.value) if isinstance(self.value, float) else None
        return {
            "id": g.id,
            "study": study,
            "scene": g.scene,
            "pair": list(g.pair),
            "metric": g.metric,
            "value": value,
            "margin": None if margin is None else round(margin, 3),
            "band": [_edge(g.low), _edge(g.high)],
            "verdict": str(self.status),
            "reason": g.reason,
            "why": self.why,
            "reference_kind": g.reference_kind,
            "reference_uncertainty": g.reference_uncertainty,
            "alarms": [],
        }


def _edge(value: float) -> float:
    """Return an edge of a band as JSON takes it, without last bits, which depend on the processor."""
    return max(-LARGEST, min(LARGEST, significant(value, 12)))


def judge(gate: Gate, value: Value) -> Verdict:
    """Judge a value: inside the band passes; outside, undefined, absent or not a number fails."""
    if isinstance(value, str) or value is None or math.isnan(value):
        word = value if isinstance(value, str) else None
        return Verdict(gate, word, Status.FAIL, "there is no value to judge")
    inside = gate.low <= value <= gate.high
    return Verdict(gate, float(value), Status.PASS if inside else Status.FAIL)


def settled(value: float) -> float:
    """Round as `rounded` does; what is rounding is zero, alike on every processor."""
    return 0.0 if abs(value) <= ROUNDING else rounded(value)


def rounded(value: float, digits: int = 4) -> float:
    """Round well above the last bits: fewer digits for small values, below 1e-12 the next power of ten."""
    if value == 0 or not math.isfinite(value):
        return value if math.isfinite(value) else math.copysign(LARGEST, value)
    if abs(value) < 1e-12:
        return math.copysign(10.0 ** math.ceil(math.log10(abs(value))), value)
    return float(f"{value:.{(digits if abs(value) >= 1e-9 else 2) - 1}e}")
