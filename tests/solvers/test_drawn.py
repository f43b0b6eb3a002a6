"""Scenes and frames as they are drawn, and what is remarked on scenes: numbers, kept in `drawn.toml`.

`KEEP_PAGES=1` writes the file anew.
"""

import zlib
from pathlib import Path

import meshio
import numpy as np
from matplotlib.figure import Figure
from oracles.stand_ins import assert_kept, history, numbers_in, summed
from oracles.stated_scenes import STATED, made

from validation.models.plane import fields
from validation.models.plane.generators import (
    ArchSection,
    ColumnsSection,
    RandomSection,
    SlopeSection,
    StackSection,
    WallSection,
)
from validation.models.plane.problems import box_problems, canon_problems
from validation.report.figures.drawing import FigureHooks
from validation.report.scene.hooks import ShowingHooks
from validation.scenes.scene import load_scene

KEPT = Path(__file__).with_name("drawn.toml")
DRAWN = (
    "landing",
    "sliding",
    "turning",
    "opening sub-blocks",
    "shaken",
    "lateral",
    "column that slips",
    "bars that open",
)
STATED_WHOLE = ("held by cohesion", "layers on springs", "struck layers", "row of cells", "subblocks-triangles")
OF_PLANE = ("standing-truss-load", "pushing-held", "patch-strip", "boxes-pile", "rigid-shaken")
MOVED = ("pushing-held", "row of cells")
VALUES = [  # what remarks on a block are made of: on both sides of what decides them
    {"least root": -0.9, "e least": 0.2, "e most": 0.9, "e own": 0.5, "tan b": 0.5, "tan phi": 0.3, "w/h": 0.2},
    {"dt seen": 1e-9, "e least": 0.7, "e most": 0.7, "e own": 0.2, "tan b": 0.1, "tan phi": 0.3, "w/h": 0.2},
]


def drawn(axes):
    """Yield the coordinates and the words of what axes show."""
    for artist in (*axes.lines, *axes.patches, *axes.texts, axes.title, axes.yaxis.label):
        yield artist.get_zorder()
        yield from [getattr(artist, name)() for name in ("get_linewidth", "get_fontsize") if hasattr(artist, name)]
        if hasattr(artist, "get_xydata"):
            yield from np.ravel(artist.get_xydata()).tolist()
        elif hasattr(artist, "get_xy") and not hasattr(artist, "get_width"):
            yield from np.ravel(artist.get_xy()).tolist()
        if hasattr(artist, "xyann"):
            yield from np.ravel([artist.xy, artist.xyann]).tolist()
            if artist.arrow_patch is not None:
                yield from (artist.arrow_patch.get_linewidth(), *artist.arrow_patch.get_edgecolor())
        if hasattr(artist, "get_text"):
            yield float(zlib.crc32(artist.get_text().encode()))
    yield axes.yaxis.get_tick_params().get("labelleft", True)
    yield from np.ravel([axes.get_xlim(), axes.get_ylim()]).tolist()


def written(scene, directory):
    """Yield the numbers in files of the fields of a motion: the last step, and each so many."""
    for file in (directory / "fields.vtu", directory / "fields.xdmf"):
        fields.write_fields(file, scene.plane.assembly, history(scene))
    mesh = meshio.read(directory / "fields.vtu")
    yield from numbers_in([mesh.points.tolist(), mesh.cells_dict["triangle"].tolist()])
    states = [(0.0, mesh.point_data, mesh.cell_data)]
    with meshio.xdmf.TimeSeriesReader(directory / "fields.xdmf") as reader:
        reader.read_points_cells()
        states += [reader.read_data(number) for number in range(reader.num_steps)]
    for time, *of_state in states:
        yield time
        for data in of_state:
            for key in sorted(data):
                yield from np.ravel(data[key]).tolist()


def numbers(name, directory):
    scene = made(name, directory) if name in STATED else load_scene(name).expand()[0]
    axes = Figure().add_subplot()
    FigureHooks.of(scene).draw(axes, scene)
    remarks = [remark for values in VALUES for remark in ShowingHooks.of(scene).remarks(scene, values)]
    found = {name: summed([*drawn(axes), *remarks])}
    if name in MOVED:
        steps = (0, scene.time.steps - 1)
        figure = FigureHooks.of(scene).frames(scene, history(scene), steps, "dda", 30.0)
        found[f"{name}, fields"] = summed(written(scene, directory))
        found[f"{name}, frames"] = summed(number for frame in figure.axes for number in drawn(frame))
    return found


GENERATED = (  # tables that draw several blocks
    ArchSection(name="arch", radius=3.0, thickness=0.7, voussoirs=3, opening=110.0, chords=2),
    ColumnsSection(name="columns", width=0.7, heights=(1.1, 1.9), dip=13.0, rise=0.3, base=0.6),
    SlopeSection(
        **{"name": "slope", "angle": 17.0, "length": 5.0, "base": 0.4, "at": (0.2, 0.9), "turned": 4.0},
        **{"rectangles": ((1.1, 0.6), (0.9, 0.8)), "noses": (0.1, 0.2), "gaps": (0.3, 0.4)},
        **{"sinks": (0.01, 0.02), "speeds": (0.5, 0.7)},
    ),
    RandomSection(name="stones", count=3, seed=5, radii=(0.4, 0.6), corners=(3, 4), across=2),
    StackSection(name="stack", count=2, rectangle=(2.1, 0.5), gap=0.1, offsets=(0.3, -0.1)),
    WallSection(name="wall", rows=3, bricks=2, rectangle=(1.1, 0.4)),
)


def test_generators_draw_blocks_as_before():
    found = {}
    for section in GENERATED:
        numbers = [number for block in section.blocks() for number in numbers_in(block.model_dump(exclude_none=True))]
        found[section.name] = summed(numbers)
    assert_kept(KEPT, "generated", found)


def flown(scene):
    """Return a history in which all blocks fly freely, until the last row."""
    course = history(scene)
    for block in scene.plane.assembly.blocks:
        parts = zip(("x", "y", "angle"), (*block.centroid, block.angle), (*block.velocity, block.spin), strict=True)
        for (part, start, rate), pull in zip(parts, (*scene.plane.gravity, 0.0), strict=True):
            place = start + rate * course.time + pull * course.time**2 / 2
            place[-1] += 0.3
            course.columns[f"{block.name}.{part}"] = place
    return course


@np.errstate(all="ignore")
def test_problems_of_blocks_are_posed_and_measured_as_before():
    """Made anew, the first case and the last one, on histories that did not take place."""
    found = {}
    for name, posed in {**box_problems.__wrapped__(), **canon_problems.__wrapped__()}.items():
        if name == "spinning":  # whose motion is integrated
            continue
        numbers = []
        for case in {posed.cases[0].label: posed.cases[0], posed.cases[-1].label: posed.cases[-1]}.values():
            scene = posed.scene(case)
            if name in box_problems():
                places = {f"plane.block.{n}.at": [b.at[0] + 0.37, b.at[1]] for n, b in enumerate(scene.plane.block)}
                scene = scene.with_values(places)
            for number in (case.quantities or posed.quantities)(scene):
                numbers += [number.exact, number.low, number.high, number.scale]
                numbers += [number.measure(course) for course in (history(scene), flown(scene))]
        found[name] = summed(numbers)
    assert_kept(KEPT, "problems", found)


def test_scenes_are_drawn_and_remarked_on_as_before(tmp_path, monkeypatch):
    monkeypatch.setattr(fields, "FRAMES", 5)
    found = {}
    for name in (*DRAWN, *STATED_WHOLE, *OF_PLANE):
        found |= numbers(name, tmp_path)
    assert_kept(KEPT, "drawn", found)
