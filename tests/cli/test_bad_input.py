"""Scene files, near valid and broken: one line of refusal or a scene, never a traceback, never a half-written file."""

import copy
import math
import tomllib

import pytest
from conftest import SCENE
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from validation import load_scene
from validation.engine.measure import completed
from validation.errors import InputError
from validation.runs.run import Outcome
from validation.scenes.scene import Scene, parse_scene
from validation.solvers.registry import get_solver

DATA = tomllib.loads(SCENE)
FIELDS = [(section, key) for section, table in DATA.items() if isinstance(table, dict) for key in table]
MORE = """
block.width block.height block.vertices block.base block.poisson block.hypothesis block.subdivide
contact.shear_stiffness load.eccentricity load.gravity load.base_motion time.alpha time.delta time.gg
time.gg_rate time.start time.allow_unstable fem.degree fem.mesh fem.foundation fem.patch_width run.solvers
run.columns sweep.time.step sweep.mode gate.pair .title .name block.colour .x
"""
numbers = st.one_of(
    st.floats(),
    st.integers(-(10**30), 10**30),
    st.sampled_from([0, -0.0, 1e-320, 1e308, -1, math.nan, math.inf, -math.inf, 10**400, 2**63, 2**63 - 1]),
)
# of every kind that printing or reading may stumble over; all of Unicode is a table that takes a second to build
LETTERS = "".join(map(chr, range(128)))
LETTERS += "\x85\xa0\xad\xe4\xb2\u0130\u0301\u03b1\u05d0\u0663\u200b\u202e\u2028\ufeff\ufffd\uffff\U0001f600"
leaves = st.one_of(numbers, st.booleans(), st.text(LETTERS, max_size=20), st.none())
values = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(LETTERS, max_size=8), inner, max_size=3),
    max_leaves=8,
)  # fmt: skip
QUICK = settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)


def one_line(error):
    text = str(error)
    assert "\n" not in text and len(text) < 2000


@QUICK
@given(
    st.dictionaries(
        st.sampled_from(FIELDS + [tuple(name.split(".", 1)) for name in MORE.split()]), values, min_size=1, max_size=4
    )
)
def test_any_value_anywhere_gives_a_scene_or_one_line(changes):
    data = copy.deepcopy(DATA)
    for (section, key), value in changes.items():
        table = data.setdefault(section, {}) if section else data
        if isinstance(table, dict):
            table[key] = value
    try:
        scene = parse_scene(data, "x.toml")
        cases = scene.expand() if scene.sweep else (scene,)
    except InputError as error:
        one_line(error)
        return
    assert all(isinstance(case, Scene) for case in cases)


positive = st.floats(min_value=1e-9, max_value=1e12)


@QUICK
@given(
    st.fixed_dictionaries(
        {
            "block.density": positive, "block.young": positive, "contact.stiffness": positive,
            "block.side": st.floats(1e-6, 1e6), "block.poisson": st.floats(-0.99, 0.5),
            "load.pressure": st.floats(-1e300, 1e300), "time.step": st.floats(1e-12, 1e6),
            "time.alpha": st.floats(0, 2), "time.delta": st.floats(0, 2), "time.gg": st.floats(0, 1),
            "time.allow_unstable": st.booleans(), "time.start": st.sampled_from(["zero", "consistent"]),
        }
    ),
    st.sampled_from(["dda", "dda-textbook", "bar"]),
)  # fmt: skip
def test_any_valid_scene_ends_by_name(values, solver):
    scene = parse_scene(DATA, "x.toml").with_values(values | {"time.steps": 12})
    run = completed(get_solver(solver), scene)
    assert run.outcome not in (Outcome.RAISED, Outcome.WRONG_SHAPE, Outcome.NOT_A_NUMBER), run.notes
    if run.outcome is Outcome.COMPLETED:
        assert all(math.isfinite(x) for x in (run.displacement.max(), run.contact_pressure.min()))


BROKEN = {
    "empty": b"",
    "duplicate key": SCENE.encode() + b'\n[block]\nside = 3.0\n',
    "deep lists": SCENE.encode() + b"\n[sweep]\n'time.step' = " + b"[" * 5000 + b"]" * 5000,
    "nested lists": SCENE.encode() + b"\n[sweep]\n'time.step' = " + b"[" * 150 + b"]" * 150,
    "deep tables": SCENE.encode() + b"\n[" + b".".join([b"a"] * 3000) + b"]\n",
    "huge integer": SCENE.replace("steps = 50", "steps = " + "9" * 5000).encode(),
    "oversized": SCENE.encode() + b"# " + b"x" * 1_000_000,
    "too many cases": f'{SCENE}[sweep]\n"time.step" = {[0.1] * 400}\n"time.gg" = {[0.5] * 400}\n'.encode(),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused_in_one_line(name, tmp_path):
    (tmp_path / "x.toml").write_bytes(BROKEN[name])
    with pytest.raises(InputError) as caught:
        load_scene(tmp_path / "x.toml").expand()
    one_line(caught.value)


def test_a_directory_and_a_missing_file_are_refused(tmp_path):
    (tmp_path / "d.toml").mkdir()
    for name in ("d.toml", "gone.toml", "a\0b.toml", "x" * 300 + ".toml"):
        with pytest.raises(InputError) as caught:
            load_scene(tmp_path / name)
        one_line(caught.value)
