"""The study `literature`: claims of publications on schemes, contacts and boundaries, each put to a test."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from validation.engine.finished import Derived
from validation.gates.gate import Gate
from validation.studies.claims import Register, number_gates, read_claims
from validation.studies.declaration import Study
from validation.studies.literature import register

CHAPTER_FIELDS = ("id", "place", "says", "why", "condition", "sources", "read", "tested")  # of a claim
CLAIMS = read_claims(Path(__file__).with_name("claims.toml"), register.TESTS)
CLAIMS_OF_THE_LITERATURE = Register(
    study="literature",
    title="Claims of the literature",
    page="docs/literature.md",
    speaker="Claim",
    introduction="What publications say of time schemes, contacts and boundaries as cures for DDA, in our words, and "
    "what comes out of a test of ours. A claim is taken as it stands in what was read, most often an abstract: the "
    "paper itself may carry the condition that is missing here. The verdict follows from the measured numbers and is "
    "a gate of the study `literature`; this page is written by `dda-validate claims --of literature --out "
    "docs/literature.md`, and a test compares it with a fresh run. Numbers below 1e-12 are written as 0.",
    claims=CLAIMS,
)


def gates() -> tuple[Gate, ...]:
    """Return the gates on the verdicts of all claims, and on the numbers behind them."""
    return (*(claim.gate() for claim in CLAIMS), *number_gates(CLAIMS))


@functools.cache
def derived() -> tuple[Derived, ...]:
    """Return the rows of the register."""
    return tuple(claim.row() for claim in CLAIMS)


def data() -> Mapping[str, Any]:
    """Return the claims, for the chapter."""
    return {"claims": [{name: getattr(claim, name) for name in CHAPTER_FIELDS} for claim in CLAIMS]}


STUDY = Study(
    name="literature",
    title="Claims of the literature",
    purpose="What publications say of schemes, contacts and boundaries that are proposed for DDA, put to the test.",
    scenes=register.SCENES,
    gates=gates,
    derived=derived,
    data=data,
)
