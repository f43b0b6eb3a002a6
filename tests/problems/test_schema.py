"""The JSON Schemas of the pack: what they take pydantic takes, and what the pack writes conforms to them."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Mapping
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from validation.problems.bands import standard
from validation.problems.data import ANSWERS, PACK, SUBMISSION, AnswersData, ProblemData, SubmissionData
from validation.problems.pack import ANSWERS_TEMPLATE, TEMPLATE, problem_data
from validation.problems.problem import problem

JSON = dict[str, Any]
TYPES: dict[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "number": (int, float),
    "integer": (int,),
    "null": (type(None),),
    "boolean": (bool,),
}
SILENT = {"title", "description", "default", "$defs"}  # keywords that refuse nothing


def takes(schema: Mapping[str, Any], value: Any, root: Mapping[str, Any]) -> bool:
    """Whether a JSON Schema takes a value, by the keywords that pydantic writes; another keyword is an error."""
    return all(_holds(keyword, rule, value, schema, root) for keyword, rule in schema.items() if keyword not in SILENT)


def _holds(keyword: str, rule: Any, value: Any, schema: Mapping[str, Any], root: Mapping[str, Any]) -> bool:
    fields = value if isinstance(value, dict) else {}
    known = schema.get("properties", {})
    checks: dict[str, Callable[[], bool]] = {
        "$ref": lambda: takes(root["$defs"][rule.rpartition("/")[2]], value, root),
        "anyOf": lambda: any(takes(one, value, root) for one in rule),
        "type": lambda: isinstance(value, TYPES[rule]) and isinstance(value, bool) is (rule == "boolean"),
        "const": lambda: value == rule,
        "enum": lambda: value in rule,
        "required": lambda: set(rule) <= set(fields),
        "properties": lambda: all(takes(known[name], part, root) for name, part in fields.items() if name in known),
        "additionalProperties": lambda: _others_taken(rule, {k: v for k, v in fields.items() if k not in known}, root),
        "exclusiveMinimum": lambda: not isinstance(value, int | float) or value > rule,
        "items": lambda: not isinstance(value, list) or all(takes(rule, part, root) for part in value),
        "minLength": lambda: not isinstance(value, str) or len(value) >= rule,
        "maxLength": lambda: not isinstance(value, str) or len(value) <= rule,
        "pattern": lambda: not isinstance(value, str) or bool(re.search(rule, value)),
    }
    return checks[keyword]()


def _others_taken(rule: Any, others: JSON, root: Mapping[str, Any]) -> bool:
    """Whether properties that a schema does not name are taken: all, none, or those that a schema of theirs takes."""
    return all(takes(rule, part, root) for part in others.values()) if isinstance(rule, dict) else rule or not others


def pydantic_takes(model: type[BaseModel], value: Any) -> bool:
    try:
        model.model_validate_json(json.dumps(value))
    except ValidationError:
        return False
    return True


def exported(name: str) -> JSON:
    asked = problem(name)
    found: JSON = json.loads(problem_data(asked, standard(asked)).model_dump_json())
    return found


VALUES = (..., None, [], "", "words", 1.5, True, {"unknown": 1}, "x" * 20_000)


def submission() -> JSON:
    return {"format": SUBMISSION, "pack": PACK, "problem": "locked", **TEMPLATE}


def answers() -> JSON:
    return {"format": ANSWERS, "pack": PACK, **ANSWERS_TEMPLATE, "step_s": 1e-3}


@pytest.mark.parametrize("name", ["locked", "column", "stack", "mass-ratio", "cradle", "joint"])
def test_what_the_pack_writes_conforms(name: str) -> None:
    schema, data = ProblemData.model_json_schema(), exported(name)
    assert takes(schema, data, schema) and pydantic_takes(ProblemData, data)
    schema = SubmissionData.model_json_schema()
    assert takes(schema, submission(), schema) and pydantic_takes(SubmissionData, submission())
    schema = AnswersData.model_json_schema()
    assert takes(schema, answers(), schema) and pydantic_takes(AnswersData, answers())


def places(data: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the path of every value in plain data."""
    parts = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    found = [at] if at else []
    for key, part in parts:
        found += places(part, (*at, key))
    return found


def changed(data: JSON, at: tuple[Any, ...], value: Any) -> JSON:
    """Return data with another value at a place, copied on the way there only; `...` takes it away."""
    found = copy.copy(data)
    if len(at) > 1:
        found[at[0]] = changed(data[at[0]], at[1:], value)
    elif value is ...:
        del found[at[0]]
    else:
        found[at[0]] = value
    return found


def test_the_schema_takes_infinite_data_by_name_only() -> None:
    schema, data = ProblemData.model_json_schema(), exported("stack")
    at = ("column", "contacts")
    for value, taken in (("inf", True), (1e9, True), ("infinite", False), ("-inf", False), (None, False)):
        contact = data["column"]["contacts"][0] | {"stiffness_Pa_per_m": value}
        other = changed(data, at, [contact])
        assert takes(schema, other, schema) is pydantic_takes(ProblemData, other) is taken, value


@pytest.mark.parametrize("model", [ProblemData, SubmissionData, AnswersData])
def test_schema_and_pydantic_say_the_same_of_changed_data(model: type[BaseModel]) -> None:
    """Pydantic alone takes true for the number one; all else both take or both refuse."""
    schema = model.model_json_schema()
    told: set[bool] = set()
    documents = {
        ProblemData: (exported("locked"), exported("column"), exported("stack")),
        SubmissionData: (submission(),),
        AnswersData: (answers(), answers() | {"step_s": {"locked": 1e-3}, "not_reported": {"locked": ["gap_2_m"]}}),
    }
    for data in documents[model]:
        for at in places(data):
            for value in VALUES:
                other = changed(data, at, value)
                by_schema, by_pydantic = takes(schema, other, schema), pydantic_takes(model, other)
                told.add(by_schema)
                assert by_pydantic or not by_schema, (at, value)
                assert by_schema or not by_pydantic or value is True, (at, value)
    assert told == {True, False}
