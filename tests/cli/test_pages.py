"""What commands print, kept word by word: the one place for wordings. Numbers may differ where no digit is meant.

The numbers are computed apart beside the functions that they come from; here a page is only held to what it was. A page
that is changed on purpose is written anew by ``KEEP_PAGES=1 pytest tests/cli/test_pages.py``, and so is one of which
`pages.txt` holds no more than the command. It reads as a terminal does: ``$`` and the command, what it prints, its
status where that is not 0, nor 2 after an error; of a page that is like another one ``| grep -E`` keeps the lines that
are its own, and a last line how many it has, and what its numbers are together.
"""

import atexit
import json
import os
import re
import shlex
import shutil
import tempfile
from functools import cache
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from oracles.pages import NUMBER

PAGES = Path(__file__).with_name("pages.txt")
SECONDS = re.compile(r"[\d.]+(?=(?: s| +)?$)", re.M)  # of `run`, at the end of a line
COSTS = re.compile(r"^((?:static|slide|wave|impact|quake) .*?) +\S+ +\S+$", re.M)  # of `advise`: seconds by two solvers
WHOLE = re.compile(r"show|list|advise (?:damping|step|wave|response|contact)")  # whose numbers are no rounding
KEPT = dict(page.split("\n", 1) for page in re.split(r"(?:\A|\n)\$ ", PAGES.read_text(encoding="utf-8"))[1:])
SLOW = re.compile(
    r"advise (?:contact (?:unlocked-constant .*1e11|slope)|figures-3-4 .*--error 0|beams|waves-site|rigid-pile)"
    r"|compare figures-3-4 discount"
)
ORDERED = sorted(KEPT, key=lambda line: line.partition(" | ")[0])
COMMANDS = [(name, list(lines)) for name, lines in groupby(ORDERED, key=lambda line: line.split()[0])]

STEPS = 60
SCENE = """title = "My block"
[block]
side = 2.0
density = 2700.0
young = 1.0e9
[contact]
stiffness = 1.0e9
[load]
pressure = 5.0e6
[time]
step = 0.002
steps = 50
[fem]
elements = 4
[run]
solvers = ["dda", "fem", SOLVER]
"""
ONE_GATE = """[[gate]]
pair = [SOLVER, "dda"]
metric = "displacement.l2"
band = [0.0, 1e-6]
reason = "the same model and scheme"
"""
GATED = '[[gate]]\npair = ["{}"]\nmetric = "{}"\nband = [{}]\nreason = "r"\n'
BETWEEN = GATED.format('dda", "bar', "displacement.l2", "0, {}")
VERDICT = {"study": "s", "id": "a", "verdict": "PASS", "value": 0.5, "band": [0.25, 0.75], "reason": "why"}
NEW_VERDICTS = [VERDICT | {"verdict": "FAIL", "value": 0.875}, VERDICT | {"id": "b", "value": 0.4}]
REFUSED = {  # what is added to a scene of no tables [run], [[gate]]
    "unknown-solver": '[run]\nsolvers = ["dda", "sofa"]',
    "unknown-pair": GATED.format("sofa", "displacement.final", "0, 1"),
    "no-pair": GATED.format("dda", "displacement.l2", "0, 1"),
    "one-gate-twice": 2 * GATED.format("dda", "displacement.final", "0, 1"),
    "core": "",  # the name of a study
    "figure-8": "",  # the name of a built-in scene
}
BLOCKS = "[plane]\nyoung = inf\ndensity = 1e3\nblock = {}\n[time]\nstep = 0.01\nsteps = 20\n"
BROKEN = """import numpy as np
def raises(scene):
    raise ValueError("no step left")
def not_a_number(scene):
    return np.full(scene.time.steps, np.nan), np.zeros(scene.time.steps)
def exits(scene):
    raise SystemExit(3)
def short(scene):
    return np.zeros(3), np.zeros(3)
"""


def history(**values):
    """Return time, displacement and force of DDA on figures 3 and 4 at 2 ms, with some values of the scene changed."""
    from validation import load_scene, solve

    scene = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": STEPS, **values})
    columns = solve(scene, "dda").history.columns
    times = scene.time.step * np.arange(1, STEPS + 1)
    return np.stack([times, columns["displacement"], columns["contact_pressure"]])


@cache
def desk():
    """Return a folder with what a user has there: histories by programs with one slip each, scenes, broken solvers."""
    place = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, place)
    right = history()
    files = {
        "right": right,
        "signs": right * [[1], [-1], [1]],
        "milliseconds": right * [[1e3], [1], [1]],
        "from-zero": np.hstack([np.zeros((3, 1)), right]),
        "missing-rows": np.delete(right, [10, 11, 30], axis=1),
        "every-other": right[:, 1::2],
        "discount": history(**{"time.gg": 0.98}),
    }
    header = "time,displacement,contact_pressure"
    for name, rows in files.items():
        np.savetxt(place / f"{name}.csv", rows.T, "%.6g", ",", header=header, comments="")
    (place / "broken.py").write_text(BROKEN)
    (place / "mine.toml").write_text(SCENE.replace(", SOLVER", ""))
    (place / "latin.toml").write_bytes(b"title = '\xe9'")
    (place / "answers").mkdir()
    (place / "answers/locked.csv").touch()
    (place / "twin").mkdir()
    (place / "twin/mine.toml").write_text(SCENE.replace(", SOLVER", ""))
    (place / "gated.toml").write_text(SCENE.replace("SOLVER", '"bar"') + BETWEEN.format(1))
    (place / "strict.toml").write_text(SCENE.replace("SOLVER", '"bar"') + BETWEEN.format("1e-9"))
    (place / "before.json").write_text(json.dumps([VERDICT, VERDICT | {"id": "b"}]))
    (place / "after.json").write_text(json.dumps(NEW_VERDICTS))
    for name, more in REFUSED.items():
        (place / f"{name}.toml").write_text(SCENE.partition("[run]")[0] + more)
    for name, blocks in {"number": "3", "numbers": "[3]"}.items():
        (place / f"{name}-block.toml").write_text(BLOCKS.format(blocks))
    for name in ("raises", "not_a_number", "exits", "short"):
        (place / f"{name}.toml").write_text((SCENE + ONE_GATE).replace("SOLVER", f'"broken:{name}"'))
    return place


def page(line):
    """Return what a command line prints on output and error, and its status where that is not 0."""
    from conftest import typed
    from oracles.processes import answer_here
    from oracles.stand_ins import summed

    line, _, wanted = line.partition(" | grep -E ")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(desk())
        if "exits" not in line:
            answer_here(patch)
        done = typed(*shlex.split(line), cwd=desk())
    printed = done.stdout + done.stderr
    if line.startswith("run "):
        printed = SECONDS.sub("0", printed)
    if line.startswith("advise "):
        printed = COSTS.sub(r"\1 0 0", printed)
    lines = [text for text in printed.splitlines() if re.search(wanted.strip("'"), text)]
    if wanted and WHOLE.match(line) and not done.returncode:
        numbers = summed(map(float, NUMBER.findall(printed)))
        lines.append(f"[{len(printed.splitlines())} lines, {numbers:.2f}]")
    if done.returncode != 2 * any(text.startswith("error: ") for text in lines):
        lines.append(f"[exit {done.returncode}]")
    return "".join(f"{line}\n" for line in lines)


def check(lines):
    """Compare what command lines print with their pages, numbers to three digits."""
    for line in lines:
        kept, files = KEPT[line], sorted(desk().iterdir())
        printed = page(line)
        if os.environ.get("KEEP_PAGES"):
            KEPT[line] = kept = printed
            PAGES.write_text("\n".join(f"$ {one}\n{text}" for one, text in KEPT.items()), encoding="utf-8")
        assert not kept.startswith("error: ") or sorted(desk().iterdir()) == files, line
        assert NUMBER.sub("#", printed) == NUMBER.sub("#", kept), line
        numbers, stated = ([float(text) for text in NUMBER.findall(text)] for text in (printed, kept))
        assert numbers == pytest.approx(stated, rel=2e-3, abs=1e-9), line
        assert " lines, " not in kept or numbers[-1] == pytest.approx(stated[-1], abs=0.03), line


@pytest.mark.parametrize(("command", "lines"), COMMANDS)
def test_a_command_prints_what_it_did(command, lines):
    check(line for line in lines if not SLOW.match(line))


@pytest.mark.long
@pytest.mark.parametrize("line", [line for line in KEPT if SLOW.match(line)])
def test_a_command_that_takes_seconds_prints_what_it_did(line):
    check([line])
