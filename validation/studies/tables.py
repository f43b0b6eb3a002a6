"""A study as a table: ``NAME.toml`` beside the module ``NAME.py``, which has the formulas.

``[study]`` holds fields of a `Study`, such as its name, title, purpose and scenes.

An entry ``[[gate]]`` says what is judged, by which band, and why::

    [[gate]]
    scenes = ["figures-5-6"]              # built-in scenes, all their cases, or single cases
    pairs = [["dda"], ["fem", "bar"]]     # one solver or row, or a solver and its reference
    metrics = ["displacement.static"]
    band = [0.0, 1e-9]                    # or the name of a function of the module
    reason = "why these edges"

``cases`` in place of ``scenes`` names a function of the module that returns them, ``owners`` what are no cases but
the owners of derived rows. The function of a band takes the case, if there is one, and returns the edges, or edges by
metric, of which ``metrics`` picks some, or None where nothing is judged. ``value`` names a function whose value the
reason holds, as ``{:.3g}``.

Numbers that somebody printed stand by case and metric, ``numbers."CASE"."METRIC" = "1.250"``: a text is rounded in its
last digit, half a unit of which is the half width of the band and the uncertainty of the reference; a number is exact.
``scale`` multiplies both, ``start`` is added to the value, ``half`` is there in place of the last digit, ``widen``
multiplies it in the band; ``rounding`` times the value, and ``slack``, widen the band alone, ``above`` its upper edge.
Scale, start, slack and above are numbers or functions of the case. All other keys are those of a `Gate`.

An entry ``[[row]]`` is a row that a function of the module computes from each history of a solver.
"""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from validation.engine.finished import Derived, from_history
from validation.gates.gate import Gate
from validation.runs.case_name import scene_of
from validation.scenes.scene import Scene
from validation.studies.bands import OTHER, about, cases, half_unit
from validation.studies.declaration import Study


def read(module: str) -> dict[str, Any]:
    """Return the table beside a module."""
    path = Path(sys.modules[module].__file__ or "").with_suffix(".toml")
    return tomllib.loads(path.read_text(encoding="utf-8"))


def study(module: str, **fields: Any) -> Study:
    """Return the study of the table beside a module, with its gates and rows, and with further fields."""
    declared: dict[str, Any] = {"gates": lambda: gates(module), "derived": lambda: rows(module)}
    for name, value in read(module)["study"].items():
        declared[name] = value
        if name in ("measures", "scenes"):
            declared[name] = tuple(value)
        elif name in ("pairs", "extra"):
            declared[name] = tuple(tuple(pair) for pair in value)
    return Study(**(declared | fields))


def gates(module: str) -> tuple[Gate, ...]:
    """Return the gates of the table beside a module, in its order."""
    declared = []
    for entry in read(module)["gate"]:
        pairs = entry.pop("pairs")
        judged = _printed(entry, module) if "numbers" in entry else _banded(entry, module)
        for fields in judged:
            declared += [Gate(pair=tuple(pair), **(entry | fields)) for pair in pairs]
    return tuple(declared)


def _printed(entry: dict[str, Any], module: str) -> Iterator[dict[str, Any]]:
    """Yield the fields of the gates on printed numbers; keys that are no field of a gate are taken out."""
    numbers = entry.pop("numbers")
    given_half = entry.pop("half", None)
    rounding = entry.pop("rounding", 0.0)
    widen = entry.pop("widen", 1.0)
    terms = {"scale": 1.0, "start": 0.0, "slack": 0.0, "above": 0.0}
    terms |= {name: entry.pop(name) for name in terms if name in entry}
    for scene, texts in numbers.items():
        scale, start, slack, above = (_at(scene, term, module) for term in terms.values())
        for metric, text in texts.items():
            value = start + scale * float(text)
            half = scale * (half_unit(text) if given_half is None else given_half)
            low, high = about(value, widen * half + rounding * abs(value) + slack)
            judged = {"scene": scene, "metric": metric, "low": low, "high": high + above}
            yield {"reference_kind": OTHER, "reference_uncertainty": half} | entry | judged


def _at(scene: str, term: float | str, module: str) -> float:
    """Return a number, or the value of a function of the module at a case."""
    if not isinstance(term, str):
        return term
    (case,) = named_cases([scene])
    return float(vars(sys.modules[module])[term](case))


def _banded(entry: dict[str, Any], module: str) -> Iterator[dict[str, Any]]:
    """Yield the fields of the gates whose band is a formula or given."""
    band = entry.pop("band")
    metrics = entry.pop("metrics", ())
    value = entry.pop("value", None)
    formulas = vars(sys.modules[module])
    subjects: list[tuple[str, tuple[Scene, ...]]]
    subjects = [(name, ()) for name in entry.pop("owners", ())]
    subjects += [(case.name, (case,)) for case in declared_cases(entry, module)]
    for scene, case in subjects:
        edges = formulas[band](*case) if isinstance(band, str) else band
        if edges is None:
            continue
        by_metric = edges if isinstance(edges, dict) else dict.fromkeys(metrics, edges)
        judged_metrics = metrics or by_metric
        reason = entry["reason"] if value is None else entry["reason"].format(formulas[value](*case))
        for metric in judged_metrics:
            low, high = by_metric[metric]
            yield {"scene": scene, "metric": metric, "low": low, "high": high, "reason": reason}


def declared_cases(entry: dict[str, Any], module: str) -> list[Scene]:
    """Return the cases that an entry names, and take them out of it."""
    if "cases" in entry:
        return list(vars(sys.modules[module])[entry.pop("cases")]())
    return named_cases(entry.pop("scenes", ()))


def named_cases(names: Iterable[str]) -> list[Scene]:
    """Return the cases of built-in scenes, all of them or one, by its name."""
    named: list[Scene] = []
    for name in names:
        named += [case for case in cases(scene_of(name)) if name in (case.name, scene_of(name))]
    return named


def rows(module: str) -> tuple[Derived, ...]:
    """Return the rows of the table beside a module."""
    declared = []
    for entry in read(module).get("row", ()):
        compute = vars(sys.modules[module])[entry["compute"]]
        for case in declared_cases(entry, module):
            declared.append(from_history(case, entry["solver"], entry["name"], compute))
    return tuple(declared)
