"""The chapter of the study `literature`: every claim with its verdict, its sources and how much of them was read."""

from __future__ import annotations

import json
import re
from pathlib import Path

from validation.report.blocks import Heading, Paragraph
from validation.report.chapters.literature import chapter, conclusion
from validation.report.references import references
from validation.runs.results import Results
from validation.studies.claims import REGISTER, Finding
from validation.studies.literature.study import CLAIMS, STUDY


def test_the_chapter_lists_claims_sources_and_tests(tmp_path: Path) -> None:
    rows = [
        {"scene": REGISTER, "name": claim.id, "metrics": {"verdict": float(claim.expected), "a number": 0.5}}
        for claim in CLAIMS
    ]
    data = json.loads(json.dumps(dict(STUDY.data())))
    manifest = {"study": "literature", "title": STUDY.title, "derived": rows, "data": data}
    blocks = chapter(Results(tmp_path), manifest, tmp_path)  # type: ignore[arg-type]
    heads = [block.text.partition(":")[0] for block in blocks if isinstance(block, Heading) and block.level == 3]
    assert heads == [claim.id for claim in CLAIMS]
    measured = [block.text for block in blocks if isinstance(block, Paragraph) and block.tone == "small"]
    assert len(measured) == len(CLAIMS)
    assert all("Measured: a number 0.5." in text for text in measured)
    text = " ".join(block.text for block in blocks if isinstance(block, Paragraph))
    cited = set(re.findall(r"@([a-z]+\d{4})", text))
    assert cited == {key for claim in CLAIMS for key in claim.sources} <= set(references())
    assert all(claim.tested in text and claim.read in text for claim in CLAIMS)


def test_the_conclusion_counts_verdicts() -> None:
    verdicts = {claim.id: {"verdict": float(claim.expected)} for claim in CLAIMS}
    conditional = sum(claim.expected is Finding.CONDITIONAL for claim in CLAIMS)
    assert f"Of {len(CLAIMS)} claims" in conclusion(verdicts)
    assert "1 is refuted" in conclusion(verdicts) or conditional == len(CLAIMS)
    assert f"{conditional} hold under a condition" in conclusion(verdicts)
