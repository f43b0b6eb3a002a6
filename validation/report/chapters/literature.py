"""The chapter of the study `literature`: what publications say of cures for DDA, each claim with its verdict."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from validation.report.blocks import Blocks, Heading, Paragraph
from validation.report.chapters.paper import CLAIMS, VERBS, WORDS, claims_table
from validation.runs.records import Manifest
from validation.runs.results import Results

UNDER_A_CONDITION = ("holds under a condition", "hold under a condition")


def chapter(results: Results, manifest: Manifest, directory: Path) -> Blocks:
    """Return the chapter: conclusion, register of claims, what was read of each source."""
    rows = {row["name"]: row["metrics"] for row in manifest.get("derived", []) if row["scene"] == CLAIMS}
    claims = manifest.get("data", {}).get("claims", [])
    blocks: Blocks = [Heading(manifest.get("title") or manifest["study"]), Paragraph(conclusion(rows), "lead")]
    blocks += [Heading("Claims", 2), claims_table(claims, rows, head="Claim, in our words")]
    blocks.append(Heading("Sources and tests", 2))
    for claim in claims:
        keys = ", ".join(f"@{key}" for key in claim["sources"])
        blocks.append(Paragraph(f"{claim['id']}: {keys}, {claim['read']}. Tested: {claim['tested']}."))
    return blocks


def conclusion(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the sentences on the register."""
    verbs = VERBS | {WORDS[1]: UNDER_A_CONDITION}
    count = Counter(WORDS.get(int(metrics.get("verdict", -1)), "not tested") for metrics in rows.values())
    parts = [f"{count[word]} {both[count[word] > 1]}" for word, both in verbs.items() if count[word]]
    return (
        f"Of {len(rows)} claims on schemes, contacts and boundaries that were tested, {', '.join(parts)}. "
        "Most were read as abstracts: the papers may carry the conditions that are missing there."
    )
