"""The reference pack: what an author of a DDA code in any language needs to check it without this package."""

from __future__ import annotations

import csv
import io
import itertools
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.engine.measure import completed
from validation.errors import InputError
from validation.gates.gate import Gate
from validation.runs.files import write_atomically, write_csv
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver
from validation.studies.catalogue import get_study

STUDY = "core"
JUDGED = "dda"
ALSO_DDA = ("dda-textbook",)  # bands against another form of the same code say nothing to a third one
SAME_MODEL = 1e-6  # of the maximum: the corrected recursion in double precision keeps this in every scene of the pack
OWN = ("displacement.max", "pressure.max")  # a code against the exact history of the same model
LEFT_OUT = ("name", "sweep", "gate", "run")  # of a scene: what says which cases and solvers are run
FIELDS = ("scene", "metric", "low", "high", "reference", "until", "reference_kind", "reason", "id")


@dataclass(frozen=True)
class Written:
    """How much a pack holds."""

    scenes: int
    histories: int
    bands: int


def check_place(directory: Path) -> None:
    """Refuse a place whose files are not those of a pack, which is replaced as a whole.

    Raises
    ------
    InputError
        It is a file, or a directory of other files.
    """
    if directory.exists() and not directory.is_dir():
        raise InputError("must be a directory", source=directory, value="a file")
    readme = directory / "README.md"
    if not directory.is_dir() or not any(directory.iterdir()):
        return
    title = readme_of(__file__).splitlines()[0].encode()
    if not readme.is_file() or not readme.read_bytes().startswith(title):
        raise InputError(
            "must be a new or empty directory or an earlier pack", source=directory, value="one with other files"
        )


def write_pack(directory: Path) -> Written:
    """Write the pack into a directory, which is made.

    Raises
    ------
    InputError
        The directory cannot be made or written.
    """
    study = get_study(STUDY)
    cases = {case.scene.name: case.scene for case in study.cases() if case.solver == JUDGED}
    gates = [gate for gate in study.gates() if gate.pair[0] == JUDGED and not set(gate.pair) & set(ALSO_DDA)]
    part = Part(directory)
    for scene in cases.values():
        part.add_scene(scene)
    required_histories = dict.fromkeys(
        [(name, JUDGED) for name in cases] + [(gate.against or gate.scene, gate.pair[-1]) for gate in gates]
    )
    for name, solver in required_histories:
        part.add_history(name, solver, history_of(cases[name], solver))
    bands = [*itertools.starmap(own_band, itertools.product(cases.values(), OWN)), *map(band, gates)]
    part.add_table("bands", bands)
    part.add_text("bands.json", json.dumps(bands, indent=1) + "\n")
    part.add_readme(__file__)
    return Written(len(cases), len(required_histories), len(bands))


class Part:
    """A part of a pack in a directory of its own: scenes, histories, tables and texts.

    Raises
    ------
    InputError
        The directory cannot be made or written.
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        for name in ("scenes", "histories"):
            try:
                (directory / name).mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InputError(
                    f"cannot be made: {error.strerror}", source=directory / name, advice="choose another place"
                ) from None

    def add_scene(self, scene: Scene) -> None:
        """Write a single case as a scene file."""
        self.add_text(f"scenes/{slug(scene.name)}.toml", as_toml(scene))

    def add_history(self, name: str, solver: str, history: History) -> None:
        """Write the history of a case."""
        write_csv(history, self.directory / "histories" / history_file(name, solver))

    def add_table(self, name: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """Write rows of the same columns as CSV, with all digits of their floats."""
        text = io.StringIO(newline="")
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        self.add_text(f"{name}.csv", text.getvalue())

    def add_readme(self, module: str) -> None:
        """Write the README of the part that a module writes."""
        self.add_text("README.md", readme_of(module))

    def add_text(self, name: str, text: str) -> None:
        """Write a text file whole or not at all."""
        write_atomically(self.directory / name, lambda stream: stream.write(text.encode()))


def number(scene: Scene, quantity: str, value: float, unit: str, uncertainty: float, **identity: str) -> dict[str, Any]:
    """Return a single number of a scene as a row of a pack, its uncertainty to two digits."""
    row = {"scene": slug(scene.name), **identity, "quantity": quantity, "value": value, "unit": unit}
    return row | {"uncertainty": two_digits(uncertainty)}


def two_digits(value: float) -> float:
    """Return an uncertainty as it is written."""
    return float(f"{value:.1e}")


def readme_of(module: str) -> str:
    """Return the README of the part of a pack that a module writes: the file beside it, ``pack.md`` of ``pack.py``."""
    return Path(module).with_suffix(".md").read_text(encoding="utf-8")


def slug(name: str) -> str:
    """Return a case's name as a file's."""
    return re.sub(r"[^\w.+-]+", "_", name).strip("_")


def history_file(name: str, solver: str) -> str:
    """Return the name of a history's file."""
    return f"{slug(name)}.{solver}.csv"


def own_band(scene: Scene, metric: str) -> dict[str, Any]:
    """Return the band of a code against the same model's own history."""
    why = "same model, same scheme: what is left is the rounding of the recursion in double precision"
    gate = Gate(scene.name, (JUDGED, JUDGED), metric, 0.0, SAME_MODEL, why)
    return band(gate) | {"id": f"{scene.name}:{JUDGED}:{metric}"}


def band(gate: Gate) -> dict[str, Any]:
    """Return a gate as a row of the pack."""
    reference = history_file(gate.against or gate.scene, gate.pair[1]) if len(gate.pair) == 2 else None
    row = {name: getattr(gate, name, None) for name in FIELDS}
    return row | {"scene": slug(gate.scene), "reference": reference}


def as_toml(scene: Scene) -> str:
    """Return a single case as a scene file."""
    lines = []
    sections = []
    for key, value in scene.definition().items():
        if isinstance(value, dict) and key not in LEFT_OUT:
            sections += ["", f"[{key}]", *map(_line, value.items())]
        elif key not in LEFT_OUT:
            lines.append(_line((key, value)))
    return "\n".join([*lines, *sections]) + "\n"


def _line(item: tuple[str, Any]) -> str:
    """Return a key and its value in TOML."""
    return f"{item[0]} = {_value(item[1])}"


def _value(value: Any) -> str:
    """Return a value in TOML, which writes numbers, words and lists as JSON does; tables stand in their line."""
    if isinstance(value, dict):
        return f"{{ {', '.join(map(_line, value.items()))} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    return json.dumps(value, ensure_ascii=False)


def history_of(scene: Scene, solver: str) -> History:
    """Return the history of a run that completes.

    Raises
    ------
    InputError
        It does not.
    """
    run: Run = completed(get_solver(solver), scene)
    if run.outcome is not Outcome.COMPLETED or run.history is None:
        raise InputError(f"{scene.name} {solver}: {run.outcome.sentence} {'; '.join(run.notes)}")
    return run.history
