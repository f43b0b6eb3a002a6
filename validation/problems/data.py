"""Problems and answers as plain data: JSON whose names carry the units, checked with pydantic."""

from __future__ import annotations

import re
from typing import Annotated, Any, Final, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from validation.runs.text import printable

PACK: Final = "5.1"
"""Version of the pack, see `validation.problems.packs` for what changes it."""
ANSWERS: Final = "dda-validation answers 1"  # the number is the version of the layout of a folder of answers
Text = Annotated[str, Field(min_length=1, max_length=2000, pattern=r"\S"), AfterValidator(printable)]


def folder_name(text: str) -> str:
    """Return a text as the name of a folder: small letters, digits, points, plus and minus signs; of others nothing."""
    return re.sub(r"[^a-z0-9.+]+", "-", text.lower()).strip("-.")


def _names_a_folder(text: str) -> str:
    if not folder_name(text):
        raise ValueError("must hold a letter or digit of ASCII, for the name of its folder")
    return text


Name = Annotated[Text, AfterValidator(_names_a_folder)]
PackVersion = Annotated[str, Field(pattern=r"^[0-9]+\.[0-9]+$", description="Version of the pack that is answered.")]
Step = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]


class Data(BaseModel):
    """Plain data: immutable, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class NumberData(Data):
    """A number of an answer to a problem of blocks in the plane, and the band in which it passes."""

    name: str
    unit: str
    exact: float
    low: float
    high: float
    reason: str


class SamplingData(Data):
    """The instants of an answer: step, 2 step, ... up to the last one; no program has to step so."""

    step_s: float
    count: int


class ColumnOfAnswer(Data):
    """A column that an answer holds, and the band of its error; null where an answer is judged by numbers."""

    name: str
    meaning: str
    measure: str | None = None
    until_s: float | None = None
    low: float | None = None
    high: float | None = None
    reason: str | None = None


class ProblemData(Data):
    """A problem of the pack; its exact motion stands beside it."""

    format: Literal["dda-validation problem"] = "dda-validation problem"
    pack: Literal["5.1"] = PACK
    problem: str
    digest: str = Field(description="Of the data and the instants; another one is another question.")
    title: str
    asks: str
    scene: dict[str, Any] = Field(description='Its tables; names end in their units; "inf" stands for infinity.')
    sampling: SamplingData
    answer: tuple[ColumnOfAnswer, ...]
    numbers: tuple[NumberData, ...] = Field((), description="What is measured on an answer of blocks in the plane.")
    exact: str | None = Field(description="CSV file of the exact motion, beside this one's directory; null: none.")


class AnswersData(Data):
    """What stands beside the tables of a folder of answers: one program, one version, one choice of settings.

    The table of a problem is `PROBLEM.csv`; a problem without a table is not answered.
    """

    format: Literal["dda-validation answers 1"]
    pack: PackVersion
    program: Name
    version: Name = Field(description="Of the program.")
    settings_name: Annotated[str, Field(max_length=60, pattern=r"^[a-z0-9][a-z0-9.+-]*$")] = Field(
        description="Name of the folder of these settings, such as default or fine-step."
    )
    settings: Text = Field(description="The settings in words: what another user would need to repeat them.")
    scheme: Text = Field(description="Time scheme, or event-driven.")
    step_s: Step | dict[str, Step] | None = Field(
        description="Time step of the program; an object where it differs by problem; null where there is none."
    )
    contact_model: Text = Field(description="Penalty springs, impulses, complementarity, ... and their parameters.")
    processor: Text
    who: Text
    licence: Text = Field(description="Of the answers, by which others may publish them, such as CC-BY-4.0.")
    link: Annotated[str, Field(max_length=2000, pattern=r"^https?://\S+$")] | None = Field(
        None, description="To the program or to the input files."
    )
    not_reported: dict[str, tuple[Text, ...]] = Field(
        {}, description="Columns that the program cannot report, by problem."
    )

    def step_of(self, problem: str) -> float | None:
        """Return the program's time step on a problem [s], None where it has none or states none."""
        return self.step_s.get(problem) if isinstance(self.step_s, dict) else self.step_s
