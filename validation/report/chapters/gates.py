"""What a gate says: its value, its band and the reason of the band."""

from __future__ import annotations

from collections import Counter

from validation.metrics.catalogue import in_words, is_count, words_of
from validation.report.blocks import Blocks, Callout, Heading, Table, TableColumn, table
from validation.report.chapters.data import Verdicts
from validation.report.chapters.text import capital, cell
from validation.runs.numbers import bounded, short
from validation.runs.records import VerdictRecord
from validation.runs.row import Value

ORDER = {"FAIL": 0, "NOT RUN": 1, "PASS": 2}
NARROW = 7  # digits; a narrower band is written as middle and half width


def value_cell(value: Value, metric: str = "") -> str:
    """Return a value of a metric without needless zeros; a count that is none is 0."""
    if value == 0 and is_count(metric):
        return "0"
    return bounded(value, short(value)) if isinstance(value, int | float) else cell(in_words(metric, value))


def window(v: VerdictRecord) -> str:
    """Return the time up to which a gate compares, ``0.2s``, the end of its id; nothing for a whole run."""
    return v["id"].rpartition("@")[2] if "@" in v["id"] else ""


def measured(v: VerdictRecord) -> str:
    """Return in words what a gate bounds, and its window."""
    until = f" up to {window(v).removesuffix('s')}\u00a0s" if window(v) else ""
    return f"{words_of(v['metric'])}{until}"


def band_cell(low: float, high: float) -> str:
    """Return a band with as many digits as tell its edges apart."""
    size = max(abs(low), abs(high))
    digits = next((d for d in range(4, 16) if high - low > 3 * 10.0**-d * size), 16)
    if low != high and digits > NARROW:
        return f"{short((low + high) / 2, digits)} ± {short((high - low) / 2, 2)}"
    return f"{short(low, digits)} … {short(high, digits)}"


def reason(v: VerdictRecord) -> str:
    """Return why the band is what it is, the kind of reference, and what went wrong if anything did."""
    uncertainty = v.get("reference_uncertainty") or 0.0
    width = f" ± {short(uncertainty, 2)}" if uncertainty else ""
    why = f" {capital(v['why'])}." if v.get("why") else ""
    return f"{v['reason']} [{v['reference_kind']}{width}]{why}"


def verdict_line(verdicts: Verdicts) -> Callout:
    """Return the line of verdicts."""
    if not verdicts:
        return Callout("No gate was judged.", "warn")
    count = Counter(v["verdict"] for v in verdicts)
    gates = "gate" if len(verdicts) == 1 else "gates"
    text = f"{len(verdicts)} {gates}: {count['PASS']} passed, {count['FAIL']} failed, {count['NOT RUN']} not run."
    if count["FAIL"]:
        return Callout(text, "fail")
    return Callout(text, "warn" if count["NOT RUN"] else "pass")


def not_passed(verdicts: Verdicts) -> Blocks:
    """Return the gates that failed or did not run, with value, band and reason; nothing where all passed."""
    bad = sorted((v for v in verdicts if v["verdict"] != "PASS"), key=lambda v: ORDER[v["verdict"]])
    if not bad:
        return []
    blocks: Blocks = [Heading("Gates that did not pass", 2)]
    failures = sum(v["verdict"] == "FAIL" for v in bad)
    if failures:
        text = "One gate fails." if failures == 1 else f"{failures} gates fail."
        blocks.append(Callout(text, "fail"))
    return [*blocks, gate_table(bad)]


def gate_list(verdicts: Verdicts) -> Blocks:
    """Return all gates, failures first; nothing where nothing was judged."""
    if not verdicts:
        return []
    return [Heading("Gates", 2), gate_table(sorted(verdicts, key=lambda v: ORDER.get(v["verdict"], 0)))]


def gate_table(verdicts: Verdicts) -> Table:
    """Return gates with value and band, those of one reason above it."""
    rows_by_reason: dict[str, list[tuple[str, ...]]] = {}
    for v in verdicts:
        subject = f"{v['scene']}, {' against '.join(v['pair'])}: {measured(v)}"
        row = (v["verdict"], subject, value_cell(v["value"], v["metric"]), band_cell(*v["band"]))
        rows_by_reason.setdefault(reason(v), []).append(row)
    lines = []
    for why, rows in rows_by_reason.items():
        lines += [*rows, (why,)]
    return table((TableColumn("Verdict", "verdict"), TableColumn("Gate", "fill"), "Value", "Band"), lines, ruled=False)
