"""The verification matrix as blocks: each phenomenon with what decides it, who passes, and what is missing.

Of the gates with one reason the tightest stands for all of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from validation.gates.gate import NOISE, Gate, Status, Verdict
from validation.metrics.catalogue import words_of
from validation.report.blocks import Blocks, Heading, Listing, Paragraph, Table, TableColumn, table
from validation.report.chapters.gates import band_cell, value_cell
from validation.report.chapters.text import some
from validation.report.references import named
from validation.runs.numbers import DASH, decimal, power, short, significant
from validation.runs.records import VerdictRecord
from validation.runs.row import Value
from validation.runs.texts import Texts
from validation.solvers.registry import is_solver
from validation.suite.matrix import JUDGED, Phenomenon, phenomena

TEXTS = Texts(__file__)
LINES = 4  # of a phenomenon, each with a reason of its own; `dda-validate verify` prints all
NAMES = 2  # of scenes and of metrics, before how many more there are


@dataclass(frozen=True)
class Standing:
    """What came out of the gates of a phenomenon."""

    # by solver how many gates it passes, of how many that judge it
    passed: Mapping[str, Sequence[int]] = field(default_factory=dict)
    # by id the value of each gate that decides, and its margin
    values: Mapping[str, tuple[Value, float | None]] = field(default_factory=dict)
    # by program how many of the problems that ask for it, cases counted, it passes, of how many that it answered
    others: Mapping[str, Sequence[int]] = field(default_factory=dict)


Standings = Sequence[tuple[Phenomenon, Standing]]


def standing(shown: Phenomenon, verdicts: Iterable[VerdictRecord]) -> Standing:
    """Return what verdicts say of a phenomenon, without gates that did not run."""
    of_study = {v["id"]: v for v in verdicts if v["study"] == shown.study and v["verdict"] != Status.NOT_RUN}
    passes: dict[str, list[bool]] = {JUDGED: []}
    for gate in shown.gates:
        for solver in judged_solvers(shown, gate) if gate.id in of_study else ():
            passes.setdefault(solver, []).append(of_study[gate.id]["verdict"] == Status.PASS)
    values = {}
    for gate in map(decisive, shown.lines()[:LINES]):
        if gate.id in of_study:
            values[gate.id] = of_study[gate.id]["value"], of_study[gate.id].get("margin")
    return Standing({solver: (sum(every), len(every)) for solver, every in passes.items() if every}, values)


def judged_solvers(shown: Phenomenon, gate: Gate) -> Collection[str]:
    """Return whom a gate judges: `JUDGED` where it is needed, else the first of a pair, or the owner of a row."""
    solvers = shown.solvers(gate)
    if JUDGED in solvers:
        return [JUDGED]
    return [gate.pair[0]] if is_solver(gate.pair[0]) else sorted(filter(is_solver, solvers))


def decisive(gates: Sequence[Gate]) -> Gate:
    """Return the gate of least tolerance, the first of those alike but for rounding."""
    return min(gates, key=lambda gate: significant(gate.tolerance, 3))


# ---- tables ----


def standings(verdicts: Sequence[VerdictRecord]) -> Standings:
    """Return the phenomena with verdicts, each with what came out."""
    listed = [(shown, standing(shown, verdicts)) for shown in phenomena(v["study"] for v in verdicts)]
    return [(shown, stands) for shown, stands in listed if stands.passed]


def truth_counts(shown: Phenomenon) -> str:
    """Return the number of gates of a phenomenon by kind of truth."""
    kinds = Counter(gate.reference_kind for gate in shown.gates)
    return ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))


def phenomenon_table(listed: Standings) -> Table:
    """Return a row for each phenomenon: its study, its gates by the kind of truth, who passes how many of them.

    Where other programs have answered, what these pass of the problems that ask for it stands beside it.
    """
    rows = [
        (shown.name, shown.study, truth_counts(shown), _tally(stands.passed), _tally(stands.others))
        for shown, stands in listed
    ]
    heads = ("Phenomenon", "Study", "Gates by truth", "Passed", "Problems, by others")
    width = len(heads) if any(stands.others for _, stands in listed) else len(heads) - 1
    return table(heads[:width], [row[:width] for row in rows])


def _tally(passed: Mapping[str, Sequence[int]]) -> str:
    return ", ".join(f"{name} {good}/{judged}" for name, (good, judged) in passed.items())


def matrix_table(listed: Standings) -> Table:
    """Return what decides each phenomenon: its name and its sources as remarks, then a row a reason."""
    rows: list[tuple[str, ...]] = []
    for shown, stands in listed:
        rows += [(shown.name,), (TEXTS.text("remark", study=shown.study, sources=shown.sources),)]
        rows += [_row(gates, stands) for gates in shown.lines()[:LINES] if decisive(gates).id in stands.values]
    measured, truth = (TableColumn(title, "fill") for title in ("Measured", "Truth, and why this band"))
    return table((measured, truth, "Band", "Value", "Margin"), rows, TEXTS.text("caption"), dense=True)


def _row(gates: Sequence[Gate], stands: Standing) -> tuple[str, ...]:
    gate = decisive(gates)
    value, margin = stands.values[gate.id]
    metrics = some((words_of(one.metric) for one in gates), NAMES)
    scenes = some((one.scene.partition("[")[0] for one in gates), NAMES)
    pair = " against ".join(gate.pair)
    count = f" ({len(gates)} gates)" if len(gates) > 1 else ""
    cells = (f"{scenes}, {pair}: {metrics}{count}", truth_cell(gate), band_of(gate))
    return (*cells, noted_value(gate, value), margin_cell(margin))


def truth_cell(gate: Gate) -> str:
    """Return the kind of a gate's truth with its uncertainty, and the band's reason."""
    width = f" ± {short(gate.reference_uncertainty, 2)}" if gate.reference_uncertainty else ""
    return f"{gate.reference_kind}{width}: {gate.reason}"


def band_of(gate: Gate) -> str:
    """Return the band of a gate, alike on every processor: one of rounding has digits in its middle alone."""
    if gate.target and gate.low < gate.high and gate.tolerance < NOISE:
        return f"{short(gate.target, 6)} ± rounding"
    return f"{short(gate.low, 2)} … {short(gate.high, 2)}" if not gate.target else band_cell(gate.low, gate.high)


def noted_value(gate: Gate, value: Value) -> str:
    """Return the value of a gate, alike on every processor: of rounding that it is below the noise."""
    if isinstance(value, float) and abs(value) < NOISE and gate.low < gate.high:
        return f"<{power(NOISE, 1)}"
    return "0" if value == 0 else value_cell(value, gate.metric)


def margin_cell(margin: float | None) -> str:
    """Return a margin in per cent of the way from target to edge, or a dash."""
    return DASH if margin is None else f"{decimal(100 * margin, 0)} %"


def missing_table() -> Table:
    """Return what DDA was validated on elsewhere and not here, with the reason."""
    rows = [tuple(line.split(" | ")) for line in TEXTS.text("missing").splitlines()]
    return table(("Missing", "Why"), rows, TEXTS.text("missing_caption"))


def matrix(verdicts: Sequence[VerdictRecord]) -> Blocks:
    """Return the matrix of verdicts, and what is missing; nothing where they are of no study of the suite."""
    listed = standings(verdicts)
    if not listed:
        return []
    return [Heading("What is verified", 2), phenomenon_table(listed), matrix_table(listed), missing_table()]


def verdict_blocks(shown: Phenomenon, verdicts: Sequence[Verdict], every: bool) -> Blocks:
    """Return what came out of a run: by reason the tightest gate and those that did not pass, or all."""
    by_id = {verdict.gate.id: verdict for verdict in verdicts}
    rows = []
    for gates in shown.lines():
        judged = [by_id[gate.id] for gate in gates if gate.id in by_id]
        tightest = decisive([verdict.gate for verdict in judged]) if judged else None
        for verdict in judged:
            if every or verdict.gate is tightest or verdict.status is not Status.PASS:
                rows.append(_verdict_row(verdict))
        many = "" if len(judged) == 1 else f" ({len(judged)} gates)"
        rows += [(f"{truth_cell(gates[0])}{many}",)] if judged else []
    tally = Counter(verdict.status for verdict in verdicts)
    counted = ", ".join(f"{tally[status]} {status}" for status in (Status.PASS, Status.FAIL, Status.NOT_RUN))
    heads = (TableColumn("verdict", "verdict"), "measured", "value", "band", "margin")
    head = f"{shown.name} (study {shown.study})\nsources: {named(shown.sources)}"
    return [Listing(head), table(heads, rows, ruled=False), Paragraph(counted)]


def _verdict_row(verdict: Verdict) -> tuple[str, ...]:
    gate = verdict.gate
    margin = gate.margin(verdict.value) if isinstance(verdict.value, float) else None
    until = "" if gate.until is None else f" up to {gate.until:g} s"
    measured = f"{gate.scene}, {' against '.join(gate.pair)}: {words_of(gate.metric)}{until}"
    value = verdict.why or DASH
    if verdict.status is not Status.NOT_RUN and verdict.value is not None:
        value = noted_value(gate, verdict.value)
    return str(verdict.status), measured, value, band_of(gate), margin_cell(margin)
