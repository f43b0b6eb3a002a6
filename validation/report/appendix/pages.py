"""The appendix as a whole."""

from __future__ import annotations

from collections.abc import Sequence

from validation.report.appendix.gates import gate_table
from validation.report.appendix.glossary import glossary
from validation.report.appendix.provenance import parameter_table, provenance
from validation.report.blocks import Blocks, Heading, References
from validation.report.chapters.alarms import alarm_lines
from validation.report.chapters.data import Groups, Verdicts
from validation.report.verification import matrix
from validation.runs.results import Results


def appendix(
    results: Results, groups: Groups, verdicts: Verdicts, studies: Sequence[str], gates: bool = False
) -> Blocks:
    """Return words, alarms, parameters, provenance and references; of gates, if asked for, what they verify too."""
    alarms = [*alarm_lines(groups)] if len(groups) > 1 else []  # of one scene on its own page
    return [
        Heading("Appendix"),
        *glossary(),
        *([Heading("Alarms", 2), *alarms] if alarms else []),
        *parameter_table(groups),
        *provenance(results, studies),
        *([*matrix(verdicts), *gate_table(verdicts)] if gates else ()),
        References(),
    ]
