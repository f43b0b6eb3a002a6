"""A column of layers in CalculiX: a stack of solid elements that is guided sideways."""

import itertools
from dataclasses import dataclass

import numpy as np

from peers.calculix_deck import Deck, amplitude, node, number, refuse, row
from peers.columns import NEAR, Stretch, stretches

ELEMENTS = 60  # shared among the parts of a column by the time that a wave takes through them
FEWEST = 2  # elements of a part, whose three levels give the stress at its ends
SECTION = ((0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0))  # m, of 1 m2: x and z of the nodes of a level
COLUMNS = ("displacement", "contact_pressure", "displacement_", "stress_")


@dataclass(frozen=True)
class Part:
    """A stretch of a column and the numbers of its levels from below."""

    stretch: Stretch
    levels: tuple[int, ...]


def check_column(scene):
    """Return the column of a scene that can be expressed."""
    column = scene.column
    refuse(column is None, "a column is needed")
    joints = [joint.height for joint in column.joint]
    refuse(scene.time.discount != 1, "the discount gg on velocities is a damping that CalculiX does not have")
    refuse(column.glue is not None, "glue is DDA's own springs between the blocks of a layer, and no layer is made of")
    refuse(any(h >= column.height * (1 - NEAR) for h in joints), "a joint on the top of the column carries nothing")
    transmits = column.base == "transmitting" and any(h <= column.height * NEAR for h in joints)
    refuse(transmits, "a joint on a transmitting base leaves a point without mass, which CalculiX cannot start")
    refuse(not any(name.startswith(COLUMNS) for name in scene.run.columns), "none of the columns asked for is reported")
    return column


def parts_of(column):
    """Cut a column at its layers, joints and observed heights."""
    cut = stretches(column, column.heights)
    passing = sum(stretch.passing for stretch in cut)
    parts = []
    last = 0
    for stretch in cut:
        first = last + 1 if stretch.spring is not None or not parts else last
        last = first + max(FEWEST, round(ELEMENTS * stretch.passing / passing))
        parts.append(Part(stretch, tuple(range(first, last + 1))))
    return parts


def _nodes(level):
    return [4 * level + k for k in range(1, 5)]


def column_deck(scene, sub):
    """Return the model of a column and what drives it."""
    from validation.scenes.drive import motion_at

    column, t = check_column(scene), scene.time
    parts, dof = parts_of(column), 2 if column.motion == "pressure" else 1
    levels = [level for part in parts for level in part.levels]
    deck = Deck(t.step, t.steps, sub, printed=[_nodes(level)[0] for level in sorted(set(levels))])
    _stack(parts, deck)
    instants = t.step / sub * np.arange(t.steps * sub + 1)
    drive = motion_at(scene, instants)
    deck.model += ["*BOUNDARY", *(f"STACK,{fixed},{fixed}" for fixed in (1, 2, 3) if fixed != dof)]
    _base(column, parts, deck, dof, instants, drive)
    if scene.input.at == "top":
        deck.model += amplitude("TOP", instants, drive.pressure)
        deck.loads += ["*CLOAD,AMPLITUDE=TOP", *(f"{n},{dof},-0.25" for n in _nodes(parts[-1].levels[-1]))]
    return deck


def _stack(parts, deck):
    """Add nodes, elements and materials."""
    deck.model += ["*NODE,NSET=STACK"]
    placed = {}
    for part in parts:
        ends = part.stretch.bottom, part.stretch.top
        placed |= zip(part.levels, np.linspace(*ends, len(part.levels)), strict=True)
    for level, height in placed.items():
        deck.model += [node(n, x, height, z) for n, (x, z) in zip(_nodes(level), SECTION, strict=True)]
    for number_, part in enumerate(parts):
        deck.model += [f"*ELEMENT,TYPE=C3D8,ELSET=PART{number_}"]
        for low, high in itertools.pairwise(part.levels):
            deck.model += [",".join(map(str, [low, *_nodes(low), *_nodes(high)]))]
        layer = part.stretch.layer
        deck.model += [f"*MATERIAL,NAME=ROCK{number_}", "*ELASTIC", row(layer.young, layer.poisson)]
        deck.model += ["*DENSITY", number(layer.density), f"*SOLID SECTION,ELSET=PART{number_},MATERIAL=ROCK{number_}"]
    deck.model += ["*ELSET,ELSET=ALL", *(f"PART{k}" for k in range(len(parts)))]


def _base(column, parts, deck, dof, instants, drive):
    """Add the base and the joints, and what comes in through the base."""
    lowest, element = _nodes(parts[0].levels[0]), parts[-1].levels[-1] + 4
    deck.model += ["*NODE,NSET=FEET"]
    shift = (0.0, -1.0) if dof == 2 else (-1.0, 0.0)
    deck.model += [node(n, x + shift[0], shift[1], z) for n, (x, z) in zip(_nodes(0), SECTION, strict=True)]
    for k, part in enumerate(parts):
        if part.stretch.spring is not None:
            below = _nodes(parts[k - 1].levels[-1] if k else 0)
            deck.model += [f"*ELEMENT,TYPE=SPRING2,ELSET=JOINT{k}"]
            for upper, lower in zip(_nodes(part.levels[0]), below, strict=True):
                element += 1
                deck.model += [f"{element},{upper},{lower}"]
            deck.model += [f"*SPRING,ELSET=JOINT{k}", f"{dof},{dof}", number(part.stretch.spring / 4)]
    still = [f"FEET,{fixed},{fixed}" for fixed in (1, 2, 3)]
    if column.impedance is not None:
        _transmit(column.impedance, lowest, element, deck, dof, instants, drive)
    elif parts[0].stretch.spring is not None:
        still.pop(dof - 1)
        deck.model += amplitude("FOOT", instants, drive.displacement)
        deck.loads += ["*BOUNDARY,AMPLITUDE=FOOT", f"FEET,{dof},{dof},1."]
    else:
        still += [f"{n},{dof},{dof}" for n in lowest]
        deck.model += amplitude("SHAKE", instants, acceleration(instants, drive.displacement))
        deck.loads += ["*DLOAD,AMPLITUDE=SHAKE", "ALL,GRAV,1.," + ("0.,-1.,0." if dof == 2 else "-1.,0.,0.")]
    deck.model += ["*BOUNDARY", *still]


def _transmit(impedance, lowest, element, deck, dof, instants, drive):
    """Put dashpots under the column, and the load of the wave that comes up."""
    deck.model += ["*ELEMENT,TYPE=DASHPOTA,ELSET=DASH"]
    deck.model += [f"{element + n},{low},{n}" for low, n in zip(lowest, _nodes(0), strict=True)]
    deck.model += ["*DASHPOT,ELSET=DASH", "", number(impedance / 4)]
    deck.model += amplitude("WAVE", instants, 2 * impedance * drive.velocity)
    deck.loads += ["*CLOAD,AMPLITUDE=WAVE", *(f"{n},{dof},0.25" for n in lowest)]


def acceleration(instants, moved):
    """Return an acceleration whose trapezoids keep the momentum of a base that moves from rest, jumps included."""
    dt = instants[1]
    inner = (moved[2:] - 2 * moved[1:-1] + moved[:-2]) / dt**2
    return np.concatenate([[2 * (moved[1] - moved[0]) / dt**2], inner, inner[-1:]])


def column_columns(scene, found):
    """Return the columns of a column from the displacements of its levels, shape (steps, levels, 3)."""
    from validation.scenes.drive import motion_at

    column = check_column(scene)
    parts, t = parts_of(column), scene.time
    u = found[:, :, 1 if column.motion == "pressure" else 0]
    drive = motion_at(scene, t.step * np.arange(1, t.steps + 1))
    if column.impedance is None and parts[0].stretch.spring is None:  # seen from the base
        u = u + drive.displacement[:, None]
    first = parts[0].levels[0]
    columns = {"displacement": u[:, -1], "contact_pressure": _stress(parts[0], u, first, below=False)}
    for k, height in enumerate(column.heights, start=1):
        part = next(p for p in parts if p.stretch.top >= height - NEAR * column.height)
        below = height > NEAR * column.height
        columns[f"displacement_{k}"] = u[:, part.levels[-1 if below else 0] - first]
        columns[f"stress_{k}"] = _stress(part, u, first, below)
    return {name: values for name, values in columns.items() if name in scene.run.columns}


def _stress(part, u, first, below):
    """Return the stress at the upper or lower end of a part from its three levels there [Pa], compression positive."""
    h = part.stretch.length / (len(part.levels) - 1)
    a, b, c = (part.levels[k] - first for k in ((-1, -2, -3) if below else (0, 1, 2)))
    slope = (3 * u[:, a] - 4 * u[:, b] + u[:, c]) / (2 * h)
    return part.stretch.modulus * (-slope if below else slope)
