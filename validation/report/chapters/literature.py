"""The chapter of the study `literature`: what publications say of cures for DDA, each claim with its verdict."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from validation.report.blocks import Blocks, Heading, Paragraph
from validation.report.chapters.paper import CLAIMS, VERBS, WORDS, counted_verdicts, measured_of, reason_of, verdict_of
from validation.runs.records import Manifest
from validation.runs.results import Results

UNDER_A_CONDITION = ("holds under a condition", "hold under a condition")


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: conclusion, and every claim."""
    rows = {row["name"]: row["metrics"] for row in manifest.get("derived", []) if row["scene"] == CLAIMS}
    claims = manifest.get("data", {}).get("claims", [])
    blocks: Blocks = [Heading(manifest.get("title") or manifest["study"]), Paragraph(conclusion(rows), "lead")]
    for claim in claims:
        blocks += claim_blocks(claim, rows.get(claim["id"], {}))
    return blocks


def claim_blocks(claim: Mapping[str, Any], metrics: Mapping[str, Any]) -> Blocks:
    """Return verdict, claim, reason, and in small print its sources, the test and what it measured."""
    word = verdict_of(metrics)
    keys = ", ".join(f"@{key}" for key in claim["sources"])
    return [
        Heading(f"{claim['id']}: {word}", 3),
        Paragraph(f"{claim['says']} ({claim['place']}) {reason_of(claim, word)}"),
        Paragraph(f"{keys}, {claim['read']}. Tested: {claim['tested']}. Measured: {measured_of(metrics)}.", "small"),
    ]


def conclusion(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the sentences on the register."""
    parts = counted_verdicts(rows, VERBS | {WORDS[1]: UNDER_A_CONDITION})
    return (
        f"Of {len(rows)} claims on schemes, contacts and boundaries that were tested, {parts}. "
        "Most were read as abstracts: the papers may carry the conditions that are missing there."
    )
