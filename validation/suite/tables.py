"""A study as a table, ``study.toml`` in its folder, beside ``formulas.py``, whose functions it names.

``[study]`` holds

    name, title, purpose    on the command line, heading and first sentence of the chapter
    phenomenon              what is verified; or several, each with (patterns of) the scenes that show it
    problems                of the pack that ask for it, each with its cases; by phenomenon where there are several
    order                   place in the report
    sources                 what the methods rest on, with keys of the bibliography
    scenes                  built-in scenes, or the function that returns scenes; those of the folder if absent
    gates, derived, data    functions that return further gates and rows, and what the chapter draws beside rows
    of_scene                the function that returns scenes and rows for a user's scene in place of the study's own

and further fields of a `Study`, of which ``extra`` and ``annotate`` may name functions too. ``[short]`` holds what
stands in place of these in a study of fewer cases, which is a study of its own.

An entry ``[[gate]]`` says what is judged, by which band, and why::

    [[gate]]
    scenes = ["figures-5-6"]              # scenes of the study or patterns of their names, or single cases
    pairs = [["dda"], ["fem", "bar"]]     # one solver or row, or a solver and its reference
    metrics = ["displacement.static"]
    band = [0.0, 1e-9]                    # or the name of a function
    reason = "why these edges"

``cases`` in place of ``scenes`` names a function that returns them, ``owners`` what are no cases but the owners of
derived rows. The function of a band takes the case, if there is one, and returns the edges, or edges by metric, of
which ``metrics`` picks some, or None where nothing is judged. ``value`` names a function whose value the reason holds,
as ``{:.3g}``.

Numbers that somebody printed stand by case and metric, ``numbers."CASE"."METRIC" = "1.250"``, or in a table of the
folder, ``numbers = "errors.csv"`` (`validation.suite.printed`): a text is rounded in its last digit, half a unit of
which is the half width of the band and the uncertainty of the reference; a number is exact. ``scale`` multiplies both,
``start`` is added to the value, ``half`` is there in place of the last digit, ``widen`` multiplies it in the band;
``rounding`` times the value, and ``slack``, widen the band alone, ``above`` its upper edge. Scale, start, slack and
above are numbers or functions of the case. All other keys are those of a `Gate`.

An entry ``[[row]]`` is a row that a function computes from each case, the ``histories`` of some solvers and the
``rows`` of some, of whose metrics it ``reads`` these; or without either from the case alone: closed forms that stand
beside the runs. Of ``sweeps`` in place of ``scenes`` it is one row of all cases, and the function takes a list of
these; of ``owners`` it is one without a case.
"""

from __future__ import annotations

import fnmatch
import itertools
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from validation.engine.finished import DerivedRows, derived_row
from validation.errors import InputError
from validation.gates.gate import Gate
from validation.runs.case_name import scene_of
from validation.runs.run import Outcome
from validation.scenes.scene import Scene, load_scene
from validation.suite.bands import OTHER, about, half_unit
from validation.suite.declaration import Study
from validation.suite.printed import printed_numbers

NOT_OF_A_STUDY = ("order", "phenomenon", "problems", "register", "sources", "of_scene")
FUNCTIONS = ("extra", "data", "annotate", "expects")  # that a field may name beside those of gates, rows and scenes


def declare(folder: Path, fields: Mapping[str, Any], formulas: Any = None) -> Study:
    """Return the study of a folder.

    `fields` is the table ``study`` of ``study.toml``, `formulas` the module of the functions that it names.
    """
    return StudyTable(folder, dict(fields), vars(formulas) if formulas else {}).study()


@dataclass(frozen=True)
class StudyTable:
    """The table of a study with the functions that it names."""

    folder: Path
    fields: Mapping[str, Any]
    formulas: Mapping[str, Any]  # functions by name

    def function(self, name: str) -> Any:
        """Return what ``formulas.py`` calls so.

        Raises
        ------
        InputError
            It has no such name.
        """
        if name not in self.formulas:
            raise InputError(f"names {name!r}, which formulas.py has not", source=self.folder / "study.toml")
        return self.formulas[name]

    @property
    def entries(self) -> dict[str, Any]:
        """The whole table, read anew: its entries are taken apart."""
        return tomllib.loads((self.folder / "study.toml").read_text(encoding="utf-8"))

    def study(self) -> Study:
        """Return the study."""
        declared = {key: value for key, value in self.fields.items() if key not in NOT_OF_A_STUDY}
        for key in FUNCTIONS:
            if isinstance(declared.get(key), str):
                declared[key] = self.function(declared[key])
        if callable(declared.get("extra")):
            declared["extra"] = declared["extra"]()
        for key in ("pairs", "extra"):
            if key in declared:
                declared[key] = tuple(map(tuple, declared[key]))
        if "measures" in declared:
            declared["measures"] = tuple(declared["measures"])
        if "expects" in declared and isinstance(self.fields["expects"], list):
            declared["expects"] = tuple(Outcome[name] for name in declared["expects"])
        # Who judges asks for them at every gate: bands are formulas, of seconds where a limit is searched.
        functions = {"gates": cache(self.gates), "derived": cache(self.derived)}
        return Study(**(declared | {"scenes": self.scenes()} | functions))

    def scenes(self) -> Sequence[str | Scene]:
        """Return the scenes, names of built-in ones or generated."""
        names = self.fields.get("scenes")
        if isinstance(names, str):
            return tuple(self.function(names)())
        return tuple(names or sorted(path.stem for path in (self.folder / "scenes").glob("*.toml")))

    def gates(self) -> tuple[Gate, ...]:
        """Return the gates: those of the function that the table names, and those of the table in its order."""
        declared = []
        for entry in self.entries.get("gate", ()):
            pairs = entry.pop("pairs")
            judged = self._printed(entry) if "numbers" in entry else self._banded(entry)
            for fields in judged:
                declared += [Gate(pair=tuple(pair), **(entry | fields)) for pair in pairs]
        return (*self._further("gates"), *declared)

    def derived(self) -> DerivedRows:
        """Return the derived rows: those of the table, and those of the function that it names."""
        declared = []
        for entry in self.entries.get("row", ()):
            read = {key: entry[key] for key in ("histories", "rows", "reads") if key in entry}
            compute = self.function(entry["compute"])
            for owner in entry.get("sweeps", ()):
                levels = self.named_cases([owner])
                declared.append(derived_row(owner, entry["name"], levels, compute, whole=True, **read))
            for owner in entry.get("owners", ()):
                declared.append(derived_row(owner, entry["name"], [], compute))
            for case in self.declared_cases(entry):
                declared.append(derived_row(case.name, entry["name"], [case], compute, **read))
        return (*declared, *self._further("derived"))

    def _further(self, field: str) -> Iterable[Any]:
        function = self.function(self.fields[field]) if field in self.fields else tuple
        return function()

    def _printed(self, entry: dict[str, Any]) -> Iterator[dict[str, Any]]:
        """Yield the fields of the gates on printed numbers; other keys are taken out."""
        numbers = entry.pop("numbers")
        given_half = entry.pop("half", None)
        rounding = entry.pop("rounding", 0.0)
        widen = entry.pop("widen", 1.0)
        terms = {"scale": 1.0, "start": 0.0, "slack": 0.0, "above": 0.0}
        terms |= {name: entry.pop(name) for name in terms if name in entry}
        if isinstance(numbers, str):
            numbers = printed_numbers(self.folder / numbers, entry, self.cases)
        for scene, texts in numbers.items():
            scale, start, slack, above = (self._at(scene, term) for term in terms.values())
            for metric, text in texts.items():
                value = start + scale * float(text)
                half = scale * (half_unit(text) if given_half is None else given_half)
                low, high = about(value, widen * half + rounding * abs(value) + slack)
                judged = {"scene": scene, "metric": metric, "low": low, "high": high + above}
                yield {"reference_kind": OTHER, "reference_uncertainty": half} | entry | judged

    def _at(self, scene: str, term: float | str) -> float:
        """Return a number, or the value of a function at a case."""
        if not isinstance(term, str):
            return term
        (case,) = self.named_cases([scene])
        return float(self.function(term)(case))

    def _banded(self, entry: dict[str, Any]) -> Iterator[dict[str, Any]]:
        """Yield the fields of the gates whose band is a formula or given."""
        band = entry.pop("band")
        metrics = entry.pop("metrics", ())
        value = entry.pop("value", None)
        subjects: list[tuple[str, tuple[Scene, ...]]]
        subjects = [(name, ()) for name in entry.pop("owners", ())]
        subjects += [(case.name, (case,)) for case in self.declared_cases(entry)]
        for scene, case in subjects:
            edges = self.function(band)(*case) if isinstance(band, str) else band
            if edges is None:
                continue
            by_metric = edges if isinstance(edges, dict) else dict.fromkeys(metrics, edges)
            judged_metrics = metrics or by_metric
            reason = entry["reason"] if value is None else entry["reason"].format(self.function(value)(*case))
            for metric in judged_metrics:
                low, high = by_metric[metric]
                yield {"scene": scene, "metric": metric, "low": low, "high": high, "reason": reason}

    def declared_cases(self, entry: dict[str, Any]) -> list[Scene]:
        """Return the cases that an entry names, and take them out of it."""
        if "cases" in entry:
            return list(self.function(entry.pop("cases"))())
        return self.named_cases(entry.pop("scenes", ()))

    @cached_property
    def cases(self) -> Mapping[str, tuple[Scene, ...]]:
        """The cases of each scene, by the scene's name."""
        scenes = [load_scene(declared) if isinstance(declared, str) else declared for declared in self.scenes()]
        return {scene.name: scene.expand() for scene in scenes}

    def named_cases(self, names: Iterable[str]) -> list[Scene]:
        """Return cases of the study: all of a scene or of a pattern of names, else the one of this name.

        Raises
        ------
        InputError
            There is none.
        """
        named: list[Scene] = []
        for name in names:
            scenes = fnmatch.filter(self.cases, scene_of(name))
            every = itertools.chain.from_iterable(self.cases[scene] for scene in scenes)
            of_name = [case for case in every if scene_of(name) == name or case.name == name]
            if not of_name:
                raise InputError(f"names {name!r}, which is no scene of it", source=self.folder / "study.toml")
            named += of_name
        return named
