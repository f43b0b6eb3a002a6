"""The answer to whose history it is: what `compare`, `judge`, `field` and the plug-in's block show."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.fit import Interval
from validation.diagnosis.readings import Slip
from validation.runs.history import Array

WRITTEN = (  # by `--json`
    *("sentence", "causes", "values", "intervals", "slips", "remedy", "unexplained", "nearest", "alike", "departure"),
    *("opened", "scheme", "model", "evidence"),
)


@dataclass(frozen=True, eq=False)
class Answer:
    """The answer to `compare`; `as_dict` is what ``--json`` prints."""

    sentence: str
    causes: list[str]
    scheme: dict[str, Any]  # alpha, delta, gg; of another scheme than Newmark's its name and numbers
    departure: Departure | None
    notes: tuple[str, ...] = ()
    opened: tuple[int, int] | None = None  # first step and last
    told: dict[str, Interval] = field(default_factory=dict)  # alpha, delta, gg and what was free with them
    untold: list[dict[str, float]] = field(default_factory=list)
    misfit: float = 0.0  # of the best explanation, relative L2 [-]
    curves: dict[str, tuple[Array, Array]] = field(default_factory=dict)  # name to time [s] and displacement [m]
    values: dict[str, float] = field(default_factory=dict)  # id to number
    unexplained: float = 0.0  # share of the difference that is left [-]
    nearest: dict[str, Any] | None = None  # where nothing explains it
    alike: list[dict[str, Any]] = field(default_factory=list)  # causes that give the same rows
    evidence: tuple[Stage, ...] = ()
    pressures: dict[str, Array] = field(default_factory=dict)  # name to pressure at the times of `curves` [Pa]
    slips: tuple[Slip, ...] = ()  # of sign and unit, column by column
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict)  # of `values`, 95 %
    remedy: str = ""  # the options by which it is read without `slips`, or with its columns in their places
    model: str = ""  # the solver that explains it, where it is not the scene's

    @property
    def departs(self) -> bool:
        """Whether the history is another one than the scene itself gives, for whatever reason."""
        return bool(self.causes or self.model)

    def as_dict(self) -> dict[str, Any]:
        """Return plain data."""
        written: dict[str, Any] = {
            "intervals": {name: list(ends) for name, ends in self.intervals.items()},
            "slips": [asdict(slip) for slip in self.slips],
            "departure": self.departure and asdict(self.departure),
            "opened": self.opened and list(self.opened),
            "evidence": [stage.as_dict() for stage in self.evidence],
        }
        return {name: written.get(name, getattr(self, name)) for name in WRITTEN}
