"""Scenes of `tests/solvers/invariants.toml`, in any units and under any load; those of `answered.toml` as stated."""

import copy
import tomllib
from pathlib import Path

import numpy as np

from validation.scenes.scene import parse_scene
from validation.solvers.registry import get_solver

COLUMNS = ("displacement", "contact_pressure")
TIME = {"step": 2e-3, "steps": 12}
TABLES = tomllib.loads((Path(__file__).parents[1] / "solvers/invariants.toml").read_text(encoding="utf-8"))
SCENES = TABLES["scenes"]
ANSWERED = tomllib.loads((Path(__file__).parents[1] / "solvers/answered.toml").read_text(encoding="utf-8"))
STATED = SCENES | ANSWERED
RECORD = ((0.0, 7e-4, -9e-4), (0.011, -2e-3, 1e-3), (0.02, 3e-3, -2e-3), (0.05, -4e-4, 5e-4))  # s, m, m

# of a slice of unit thickness: how each kind of number goes with the units of length, mass and time, and which has it
EXPONENTS = TABLES["exponents"]
KINDS = {name: kind for kind, names in TABLES["kinds"].items() for name in names}
STIFFNESS = {"contact": "stress", "damping": "time", "column": "bedding"}  # N/m, a1 of the damping tables, Pa/m
UNITS = (2.0**-9, 2.0**-12, 2.0**-5)  # powers of two round nothing: an absolute tolerance shows, and nothing else does


def scaled(kind, units):
    return float(np.prod([unit**exponent for unit, exponent in zip(units, EXPONENTS[kind], strict=True)]))


def in_units(table, data, units):
    """Return a table of a scene with its numbers in other units."""
    if isinstance(data, list):
        return [in_units(table, entry, units) for entry in data]
    other = {}
    for key, value in data.items():
        kind = STIFFNESS[table] if key == "stiffness" else KINDS.get(key, "number")
        if key == "layer":
            other[key] = in_units(table, value, units)
        elif kind == "number":
            other[key] = value
        else:
            other[key] = (np.array(value) * scaled(kind, units)).tolist()
    return other


def made(name, directory, units=(1.0, 1.0, 1.0), load=1.0):
    """Return a scene of the table, its numbers in other units and its loads multiplied."""
    if name in ANSWERED:
        return parse_scene(copy.deepcopy(ANSWERED[name]), name)
    tables = {key: value for key, value in SCENES[name].items() if isinstance(value, dict)}
    tables["time"] = TIME | tables.get("time", {})
    data = {key: in_units(key, value, units) for key, value in tables.items()}
    drive = data["input"] if "input" in data else data["load"]
    for key in ("pressure", "traction", "gravity", "velocity"):
        if key in drive:
            drive[key] *= load
    if "base_motion" in drive:
        factors = (scaled("time", units), *[load * scaled("length", units)] * 2)
        rows = np.array(RECORD) * factors
        drive["base_motion"] = str(directory / f"{units[0]}-{load}.csv")
        np.savetxt(drive["base_motion"], rows, "%.17g", ",", header="time,x,y", comments="")
    data["run"] = {
        "columns": list(SCENES[name].get("columns", COLUMNS)),
        "geometry": SCENES[name].get("geometry", "small"),
    }
    return parse_scene({"name": name, **data, "fem": {"elements": 2}}, name)


def asked(solver, scene):
    """Return the scene with the columns that a solver has."""
    own = get_solver(solver).columns()
    return scene.with_values({"run.columns": [c for c in scene.run.columns if own is None or c in own]})
