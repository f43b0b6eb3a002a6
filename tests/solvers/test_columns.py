"""Scenes of columns: what they may state, who runs them, who refuses them, and that the three solvers agree."""

from pathlib import Path

import numpy as np
import pytest

from validation import InputError, load_scene, response, solve
from validation.advice.spectra import damping
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.scenes.scene import Scene, parse_scene

SITE = Path(__file__).with_name("site.toml").read_text(encoding="utf-8")
BASES = {
    "half-space": {},
    "jointed half-space": {"column.joint": [{"height": 0.0, "stiffness": 3e8}, {"height": 10.0, "stiffness": 1e8}]},
    "rigid": {"column.base": "rigid"},
    "springs": {"column.base": "springs", "column.base_stiffness": 4e8},
}
BASES_AND_ENDS = [
    pytest.param(base, top, marks=[pytest.mark.long] * (top is not bool(b % 2)))
    for b, base in enumerate(BASES)
    for top in (False, True)
]


@pytest.fixture
def site(tmp_path: Path) -> Scene:
    path = tmp_path / "site.toml"
    path.write_text(SITE)
    return load_scene(path)


def standing(site: Scene, base: str) -> Scene:
    """Return the site on another base."""
    data = site.definition()
    if base in ("rigid", "springs"):
        for key in ("base_density", "base_speed"):
            del data["column"][key]
    return parse_scene(data | {"column": data["column"] | {k[7:]: v for k, v in BASES[base].items()}}, base)


@pytest.mark.long
@pytest.mark.parametrize(("base", "top"), BASES_AND_ENDS)
def test_welded_blocks_are_linear_elements(site: Scene, base: str, top: bool) -> None:
    scene = standing(site, base).with_values({"time.alpha": 0.4, "time.delta": 0.7, "time.gg": 0.99})
    if top:
        drive = {"at": "top", "shape": "half-sine", "pressure": 1e6, "duration": 0.05}
        scene = parse_scene(scene.definition() | {"input": drive}, "top")
    histories = [solve(scene, solver).history for solver in ("dda", "fem")]
    for name in scene.run.columns:
        blocks, elements = (history.columns[name] for history in histories)
        assert np.abs(blocks - elements).max() <= 1e-11 * np.abs(elements).max() + 1e-300, name


# ---- vibrations -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("base", "top"), BASES_AND_ENDS)
def test_fine_columns_vibrate_as_the_exact_layers(site: Scene, base: str, top: bool) -> None:
    layers = [x.model_dump() | {"blocks": 40 * x.blocks} for x in site.column.layer]
    scene = standing(site, base).with_values({"column.layer": layers, "time.gg": 0.99})
    if top:
        given = {"at": "top", "shape": "ricker", "pressure": 1.0, "frequency": 4.0}
        scene = parse_scene(scene.definition() | {"input": given}, "top")
    frequency = [0.5, 2.0, 3.1]
    exact = response(scene, frequency, "layers").columns
    for solver in ("dda", "fem"):
        for name, values in response(scene, frequency, solver, exact=True).columns.items():
            assert np.abs(values - exact[name]).max() < 2e-4 * np.abs(exact[name]).max(), (solver, name)


# ---- what is refused ------------------------------------------------------------------------------------------------


def test_what_asks_for_a_block_refuses_a_column(site: Scene) -> None:
    with pytest.raises(InputError, match="site: damping takes scenes of a block only"):
        damping(site)
    with pytest.raises(InputError, match="site: compare takes scenes of a block, or of a column whose"):
        compare(site, Foreign(np.array([0.1]), {}))
    with pytest.raises(InputError, match="site: load: is needed for what is asked, got a scene of a column"):
        _ = site.load
    with pytest.raises(InputError, match="input: is needed for what is asked, got a scene of a block"):
        _ = load_scene("figures-3-4").input


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"column": {"motion": "love"}}, "column.motion: must be"),
        ({"column": {"base": "springs"}}, "base_density does not go with base = 'springs'"),
        ({"column": {"base_speed": 0.0}}, "column.base_speed: must be greater than 0"),
        ({"column": {"heights": [30.0]}}, "heights must be at most the column's height 18"),
        ({"column": {"joint": [{"height": 19.0, "stiffness": 1e9}]}}, "joint.height must be at most"),
        ({"column": {"layer": []}}, "column.layer: must"),
        ({"input": {"pressure": 1.0}}, "pressure does not go with ricker at the base"),
        ({"input": {"record": "a.csv"}}, "one of shape and record is required, got both"),
        ({"input": {"at": "top"}}, "pressure is required with ricker at the top"),
        ({"fem": {"foundation": "corner"}}, "fem: foundation does not go with column"),
        ({"load": {"pressure": 1.0}}, "load: does not go with column"),
    ],
)
def test_bad_columns_are_refused(site: Scene, change: dict[str, dict[str, object]], says: str) -> None:
    data = site.definition()
    for table, values in change.items():
        data[table] = data.get(table, {}) | values
    with pytest.raises(InputError, match=says):
        parse_scene(data, "site")


def test_a_joint_inside_a_block_is_refused_by_the_blocks(site: Scene) -> None:
    inside = site.with_values({"column.joint": [{"height": 9.9, "stiffness": 1e9}]})
    with pytest.raises(InputError, match="joints: must lie where blocks meet"):
        solve(inside, "dda")
    assert solve(inside, "fem").displacement.size == 500


def test_a_column_and_its_input_go_together(site: Scene) -> None:
    data = site.definition()
    del data["input"]
    with pytest.raises(InputError, match="input: is required, got nothing"):
        parse_scene(data, "site")
    block = load_scene("figures-3-4").definition()
    with pytest.raises(InputError, match="input: does not go without column"):
        parse_scene(block | {"input": site.definition()["input"]}, "block")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("time,displacement\n0,0\n1,1\n", "header must be time,velocity or time,acceleration"),
        ("time,velocity\n0,0\n", "at least two rows"),
        ("time,velocity\n0,0\n0,1\n", "time must increase"),
    ],
)
def test_bad_records_are_refused(site: Scene, tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "record.csv").write_text(text)
    scene = parse_scene(site.definition() | {"input": {"record": str(tmp_path / "record.csv")}}, "site")
    with pytest.raises(InputError, match=says):
        solve(scene, "dda")


def test_conditional_schemes_are_held_to_their_limit(site: Scene) -> None:
    for solver in ("dda", "fem"):
        with pytest.raises(InputError, match=r"time\.step: must not exceed"):
            solve(site.with_values({"time.alpha": 0.0}), solver)


@pytest.mark.parametrize("solver", ["dda", "fem", "layers", "column-events", "bars-events"])
@pytest.mark.parametrize("top", [0.3, (0.1 + 0.2) * (1 + 5e-10)])
def test_a_height_that_is_the_top_but_for_rounding_is_the_top(solver: str, top: float) -> None:
    layers = [{"thickness": 0.1, "density": 2000.0, "young": 1e8}, {"thickness": 0.2, "density": 2000.0, "young": 1e8}]
    column = {"motion": "pressure", "layer": layers, "heights": [top]}
    if solver.endswith("events"):
        column |= {"law": "unilateral", "stiffness": 1e9}
    scene = parse_scene(
        {
            "column": column,
            "input": {"shape": "half-sine", "velocity": 0.1, "duration": 1e-3},
            "time": {"step": 1e-5, "steps": 100, "alpha": 0.25, "delta": 0.5},
            "run": {"solvers": [solver], "columns": ["displacement", "displacement_1"]},
        },
        "top",
    )
    history = solve(scene, solver).history
    assert history is not None
    columns = history.columns
    np.testing.assert_allclose(columns["displacement_1"], columns["displacement"], atol=1e-15)
