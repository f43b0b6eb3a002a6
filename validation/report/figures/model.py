"""The drawing of the two-block model: block, springs, load and unknowns, by `model.json`."""

from __future__ import annotations

import json
from pathlib import Path

from matplotlib import patches
from matplotlib.figure import Figure

from validation.report.figures.curves import style_of
from validation.report.figures.histories import house_style

SHAPES = Path(__file__).with_name("model.json")  # lengths in mm
WIDTH = 72.0  # mm
HEIGHT = 62.0  # mm
ARROW = {"arrowstyle": "-|>,head_width=0.12,head_length=0.28", "lw": 0.8, "shrinkA": 0, "shrinkB": 0}


def model_figure(side: str, pressure: str) -> Figure:
    """Draw the model with the words of its side and load, such as "a = 2 m" and "q = 5 MPa"."""
    text = SHAPES.read_text("utf-8")
    for place, words in (("{side}", side), ("{pressure}", pressure), ("{dda}", style_of("dda").color)):
        text = text.replace(place, words)
    with house_style():
        figure = Figure(figsize=(WIDTH / 25.4, HEIGHT / 25.4))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(0.0, WIDTH), ylim=(0.0, HEIGHT))
        axes.set_axis_off()
        for shape in json.loads(text):
            kind = shape.pop("draw")
            place = shape.pop("at")
            if kind in ("Rectangle", "Arc"):
                axes.add_patch(getattr(patches, kind)(*place, **shape))
            elif kind == "arrow":
                start, end = place
                axes.annotate("", end, start, arrowprops=ARROW | shape, zorder=4)
            else:  # plot or text
                getattr(axes, kind)(*place, **shape)
    return figure
