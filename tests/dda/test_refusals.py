"""What `dda` refuses, each by its field: the table `refusals.toml`, and how what is asked is made of its rows."""

import re
import tomllib
from copy import deepcopy
from dataclasses import fields, replace
from pathlib import Path

import numpy as np

import dda
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.column_history import ColumnOptions, solve_column
from dda.bodies.column_march import Drive
from dda.bodies.turning_block import RollingModel

ROCK = dda.Material(2700.0, 1e9, 0.0)
SQUARE = dda.Block.rectangle(2.0, 2.0, ROCK)
LAW = {"stiffness": 1e9}
MODELS = {
    "locked": dda.TwoBlockModel(SQUARE, dda.Contact(1e9), 5e6),
    "opening": dda.UnilateralModel(SQUARE, dda.Unilateral(**LAW), 5e6, eccentricity=0.3),
    "turning": RollingModel(SQUARE, dda.Unilateral(**LAW)),
}
MODELS |= dict.fromkeys(("textbook", "pieces"), MODELS["locked"])
MODELS |= {"sub-blocks": replace(MODELS["opening"], eccentricity=0.0)}
SCHEMES = {
    "average": dda.Scheme(0.25, 0.5, 1.0, 1e-3, "consistent"),
    "constant": dda.Scheme(0.5, 1.0, 1.0, 1e-3),
    "explicit": dda.Scheme(0.0, 0.5, 1.0, 1e-4),
    "hht": dda.named_scheme("hht", step=1e-3, rho_inf=0.8),
    "composite": dda.named_scheme("composite", step=1e-3),
    "leapfrog": dda.named_scheme("leapfrog", step=1e-3),
}
MADE = {  # of what stands in a row
    "contact": lambda law: dda.Unilateral(**LAW | law),
    "block": lambda vertices: dda.Block(vertices, ROCK),
    "load": lambda numbers: dda.Load(**numbers),
    "motion": lambda places: dda.BaseMotion([0.0, 1.0], places),
}


def model(name, given):
    return replace(MODELS[name], **{key: MADE.get(key, lambda value: value)(value) for key, value in given.items()})


def taken(given, names):
    """Return what a row gives of some names, and leave the rest."""
    return {name: given.pop(name) for name in names if name in given}


def scheme_of(given):
    chosen = SCHEMES[given.pop("scheme", "average")]
    return replace(chosen, **taken(given, ("mass_damping", "stiffness_damping")))


def history(of="opening", steps=3, columns=("displacement",), **given):
    scheme = scheme_of(given)
    options = taken(given, [field.name for field in fields(dda.UnilateralOptions)])
    if options.get("rule") == "impact":
        options["restitution"] = 0.5
    more = taken(given, ["floor"])
    body = model(of, given)
    if of == "locked":
        return dda.solve(body, scheme, steps, columns, **more)
    if of == "pieces":
        return dda.solve_system(dda.subdivided(body, 1, 1, 1e9), scheme, steps, columns)
    if of == "textbook":
        return dda.solve_textbook(body, scheme, steps)
    if of == "sub-blocks":
        body = dda.opening_subdivided(body, 2, 1, 1e12)
    return dda.solve_unilateral(body, scheme, steps, columns, dda.UnilateralOptions(**options))


def cut(columns=2, rows=2, glue=1e9, pattern="squares", **given):
    return dda.subdivided(model("locked", given), columns, rows, glue, pattern)


def response(along, moved=None, wide=False):
    """Return what a block, or sub-blocks in a wide matrix, answer to a base that moves to some place, or does not."""
    motion = moved and dda.BaseMotion([1.0], [moved])
    block = replace(MODELS["locked"], load=dda.Load(motion=motion))
    body = dda.subdivided(block, 8, 8, 1e11) if wide else block
    return dda.response(body, SCHEMES["constant"], [7.0], along=along)


def joint(**given):
    return dda.Joint(**{"first": 0, "second": 1, "start": (0, 0), "end": (1, 0), "normal": 1.0, "shear": 1.0} | given)


def glued(glue=4e9, observed=((2.0, 0.0), (2.0, 1.0)), tractions=(), **loads):
    blocks = [dda.Block([(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)], ROCK) for x in (0, 1)]
    pulls = [dda.Traction(*map(tuple, ends), (3e6, 0.0)) for ends in tractions]
    body = dda.GluedBlocks(dda.glued_blocks(blocks, glue, tractions=pulls, **loads))
    return body.rest, body.observer(*map(tuple, observed))


def layer(**given):
    return Layer(**{"thickness": 1.0, "density": 2500.0, "young": 1e9} | given)


def spring(**given):
    return Spring(**{"height": 0.0, "stiffness": 1e9} | given)


def column(layer_of=layer, layer=None, joints=(), **given):
    layers = [] if layer is False else [layer_of(**layer or {})]
    return Column(layers, joints=[spring(**one) for one in joints], **given)


def column_history(columns=("displacement",), heights=(), settled=False, **given):
    law = "bonded" if "impedance" in given else "unilateral"
    scheme = scheme_of(given)
    options = ColumnOptions(settled=settled)
    return solve_column(column(law=law, **given), scheme, Drive(*np.zeros((4, 2))), columns, heights, options)


def plane_block(vertices=((0, 0), (1, 0), (1, 1), (0, 1)), density=1000.0, **given):
    return dda.PlaneBlock(vertices, density, **given)


def plane_springs(stiffness=1e8, **given):
    return dda.ContactSprings(stiffness, **given)


BLOCKS = {
    "base": plane_block(((0, -1), (1, -1), (1, 0), (0, 0)), fixed=True, name="base"),
    "upper": plane_block(name="upper"),
    "sunk": plane_block(((0, -0.1), (1, -0.1), (1, 1), (0, 1))),
}


def plane(blocks=("base", "upper"), contacts=(), bonds=(), loads=(), steps=1, **given):
    scheme = scheme_of(given)
    model = dda.PlaneModel(
        [BLOCKS[name] for name in blocks],
        [dda.CornerOnEdge(*numbers, plane_springs(np.inf)) for numbers in contacts],
        bonds=[dda.EdgeBond(*ends, 0.5, 0.5) for ends in bonds],
        loads=[dda.PlaneLoad(**{"block": 1, "force": (1.0, 0.0)} | load) for load in loads],
    )
    return dda.solve_plane(model, scheme, steps, **given)


ASKED = {
    "polygon": lambda vertices: dda.Block(vertices, ROCK),
    "material": lambda **given: dda.Material(**{"density": 1.0, "young": 1.0, "poisson": 0.2} | given),
    "springs": dda.Contact,
    "scheme": lambda **given: dda.Scheme(**{"alpha": 0.5, "delta": 1.0, "gg": 1.0, "step": 1.0} | given),
    "named": lambda **given: dda.named_scheme(**{"step": 1e-3} | given),
    "law": lambda **given: MADE["contact"](given),
    "options": dda.UnilateralOptions,
    "system": lambda joint=0, observed=None: dda.BlockSystem([SQUARE], [globals()["joint"]()] * joint, observed),
    "column_options": ColumnOptions,
} | {part.__name__: part for part in (history, cut, joint, glued, layer, spring, column, column_history)}
ASKED |= {part.__name__: part for part in (response, plane_block, plane_springs, plane)}
TABLE = tomllib.loads(Path(__file__).with_name("refusals.toml").read_text())
ROWS = [(asked, refusal, given) for asked, part in TABLE.items() for refusal in part for given in part[refusal]]


def test_what_does_not_go_together_is_refused_by_field():
    for asked, refusal, given in deepcopy(ROWS):
        try:
            model(asked, given) if asked in MODELS else ASKED[asked](**given)
        except ValueError as error:
            begins = f"{refusal}{'' if ':' in refusal else ': '}"
            assert re.match(begins, str(error)), (asked, refusal, given)
        else:
            assert refusal == "taken", (asked, given)
