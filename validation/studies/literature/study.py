"""The study `literature`: claims of publications on schemes, contacts and boundaries, each put to a test."""

from __future__ import annotations

from pathlib import Path

from validation.studies.claims import Register, read_claims
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


STUDY = Study(
    name="literature",
    title="Claims of the literature",
    purpose="What publications say of schemes, contacts and boundaries that are proposed for DDA, put to the test.",
    scenes=register.SCENES,
    gates=CLAIMS_OF_THE_LITERATURE.gates,
    derived=CLAIMS_OF_THE_LITERATURE.rows,
    data=lambda: CLAIMS_OF_THE_LITERATURE.data(*CHAPTER_FIELDS),
)
