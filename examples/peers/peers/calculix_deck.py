"""Input files of CalculiX (ccx), the program's run on one, and what it printed."""

import os
import re
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from peers.packages import command_of

RECIPE = "apt-get install calculix-ccx (Debian 12: 2.20-1)"
LIMIT, ALLOWANCE = 100.0, 0.02  # s, of a run and for each of its increments: some three times what they take
LATE = 1e-6  # of an instant, by which what is printed may miss it


class Stopped(RuntimeError):
    """CalculiX gave a run up."""


@dataclass
class Deck:
    """Lines of an input file: the model, its loads in the step, and what is printed."""

    step: float  # of the answer [s]
    steps: int
    sub: int = 1  # increments of a step
    updated: bool = False  # whether the geometry is that of the present
    model: list[str] = field(default_factory=list)
    loads: list[str] = field(default_factory=list)
    printed: list[int] = field(default_factory=list)  # nodes

    def text(self, accurate):
        """Return the input file, with the settings that were chosen or as the program comes."""
        times = row(self.step / self.sub, self.step * self.steps)
        lines = [*self.model, "*NSET,NSET=OUT", *map(str, self.printed)]
        lines += ["*STEP,INC=100000000" + (",NLGEOM" if self.updated else "")]
        if accurate:
            lines += ["*DYNAMIC,ALPHA=0.,DIRECT", times, "*CONTROLS,PARAMETERS=FIELD", "1e-6,1e-6,,,1e-6,1e-12"]
        else:
            lines += ["*DYNAMIC,DIRECT", times]
        printed = [f"*NODE PRINT,NSET=OUT,FREQUENCY={self.sub}", "U", "*END STEP", ""]
        return "\n".join([*lines, *self.loads, *printed])


def number(value):
    """Return a number in the twenty characters that ccx reads."""
    return f"{value:.12e}"


def row(*values):
    """Return a data line."""
    return ",".join(v if isinstance(v, str) else number(v) for v in values)


def node(name, x, y, z):
    """Return the data line of a node."""
    return row(str(name), x, y, z)


def amplitude(name, time, values):
    """Return the lines of an amplitude, which is linear between its instants and held beyond them."""
    rows = [row(t, v) for t, v in zip(time, values, strict=True)]
    return [f"*AMPLITUDE,NAME={name}", *rows]


def refuse(condition, what):
    """Say that a scene cannot be expressed.

    Raises
    ------
    NotImplementedError
        The condition holds.
    """
    if condition:
        raise NotImplementedError(what)


def program():
    """Return the command of CalculiX.

    Raises
    ------
    NotImplementedError
        It is not installed.
    """
    return command_of("ccx", "CalculiX (ccx)", RECIPE)


def version():
    """Return what the program says of its version, or that it is not installed."""
    try:
        said = subprocess.run([program(), "-v"], capture_output=True, text=True, check=False).stdout
    except NotImplementedError as error:
        return str(error)
    found = re.search(r"Version\s+(\S+)", said)
    return found.group(1) if found else "unknown"


def run(deck, accurate):
    """Run an input file on one core; return the displacements of the printed nodes, shape (steps, nodes, 3).

    Raises
    ------
    NotImplementedError
        The program is not installed.
    Stopped
        It ended before the last step, with what it says of it.
    RuntimeError
        It did not end.
    """
    alone = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_RESULTS": "1", "CCX_NPROC_STIFFNESS": "1"}
    with tempfile.TemporaryDirectory() as place:
        Path(place, "job.inp").write_text(deck.text(accurate), encoding="ascii")
        limit = LIMIT + ALLOWANCE * deck.steps * deck.sub
        try:
            command = [program(), "-i", "job"]
            ended = subprocess.run(command, cwd=place, env=alone, capture_output=True, check=False, timeout=limit)
        except subprocess.TimeoutExpired:
            raise RuntimeError(f"CalculiX did not end within {limit:g} s") from None
        printed = Path(place, "job.dat")
        text = printed.read_text(encoding="ascii", errors="replace") if printed.exists() else ""
    times, found = parsed(text, len(deck.printed))
    expected = deck.step * np.arange(1, deck.steps + 1)
    kept = times[: deck.steps]
    if len(kept) < deck.steps or np.any(np.abs(kept - expected) > LATE * expected + 1e-9 * deck.step):
        errors = re.findall(r"\*ERROR[^*]*", ended.stdout.decode("utf-8", "replace"))
        why = " ".join(errors[0].split()) if errors else "no instants as asked"
        reached = times[-1] if len(times) else 0.0
        raise Stopped(f"CalculiX ended at {reached:.6g} s of {expected[-1]:.6g} s: {why}")
    return found[: deck.steps]


def parsed(text, nodes):
    """Return the instants and displacements of a .dat file, shapes (instants,) and (instants, nodes, 3)."""
    text = re.sub(r"(?<=\d)([+-]\d{3})\b", r"E\1", text)  # Fortran's exponents of three digits
    times = [float(value) for value in re.findall(r"and time\s+(\S+)", text)]
    rows = [line.split()[1:] for line in text.splitlines() if re.match(r"\s+\d+\s+\S+\s+\S+\s+\S+\s*$", line)]
    whole = len(rows) // nodes
    return np.array(times[:whole]), np.array(rows[: whole * nodes], float).reshape(whole, nodes, 3)
