"""The JSON Schemas of the pack: what the pack writes conforms, and what is infinite stands by name only."""

from __future__ import annotations

import json
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from validation.problems.bands import standard
from validation.problems.data import ANSWERS, PACK, SUBMISSION, AnswersData, ProblemData, SubmissionData
from validation.problems.pack import ANSWERS_TEMPLATE, TEMPLATE, problem_data
from validation.problems.problem import problem

OF_SUBMISSION = {"format": SUBMISSION, "pack": PACK, "problem": "locked", **TEMPLATE}
OF_ANSWERS = {"format": ANSWERS, "pack": PACK, **ANSWERS_TEMPLATE, "step_s": 1e-3}


def takes(model: type[BaseModel], value: Any) -> bool:
    try:
        model.model_validate_json(json.dumps(value))
    except ValidationError:
        return False
    return True


def exported(name: str) -> dict[str, Any]:
    asked = problem(name)
    found: dict[str, Any] = json.loads(problem_data(asked, standard(asked)).model_dump_json())
    return found


@pytest.mark.parametrize("name", ["locked", "column", "stack", "mass-ratio", "cradle", "joint"])
def test_what_the_pack_writes_conforms(name: str) -> None:
    assert takes(ProblemData, exported(name))
    assert takes(SubmissionData, OF_SUBMISSION) and takes(AnswersData, OF_ANSWERS)
    assert takes(AnswersData, OF_ANSWERS | {"step_s": {"locked": 1e-3}, "not_reported": {"locked": ["gap_2_m"]}})


def test_the_schema_names_what_is_infinite() -> None:
    kinds = ProblemData.model_json_schema()["$defs"]["ColumnContactData"]["properties"]["stiffness_Pa_per_m"]["anyOf"]
    assert {"const": "inf", "type": "string"} in kinds and {kind["type"] for kind in kinds} == {"number", "string"}
    data = exported("stack")
    for value, taken in (("inf", True), (1e9, True), ("infinite", False), ("-inf", False), (None, False)):
        contact = data["column"]["contacts"][0] | {"stiffness_Pa_per_m": value}
        assert takes(ProblemData, data | {"column": data["column"] | {"contacts": [contact]}}) is taken, value


@pytest.mark.parametrize(
    ("model", "data"), [(ProblemData, "locked"), (SubmissionData, OF_SUBMISSION), (AnswersData, OF_ANSWERS)]
)
def test_what_is_required_or_unknown_is_refused(model: type[BaseModel], data: Any) -> None:
    whole = exported(data) if isinstance(data, str) else data
    schema = model.model_json_schema()
    assert schema["additionalProperties"] is False and not takes(model, whole | {"unknown": 1})
    for name in schema["required"]:
        assert not takes(model, {key: value for key, value in whole.items() if key != name}), name
