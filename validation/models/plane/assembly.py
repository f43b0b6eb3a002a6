"""A scene of blocks in the plane with all names resolved, checked before anything runs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from pydantic import ValidationError

from validation.models.plane import geometry
from validation.models.plane.blocks import PlacedBlock, PlaneBlockSection, thickness
from validation.models.plane.contents import PlaneContents
from validation.models.plane.geometry import Segment
from validation.models.plane.history import POSE, RESERVED
from validation.models.plane.joints import PlaneContactSection
from validation.scenes.unknown import did_you_mean

OVERLAP = 0.01  # of the thinner block: deeper, and no compression of springs at the start explains it
Members = Mapping[str, Sequence[int]]
TOUCHING = 1e-6  # of the thinner block: nearer blocks touch, and nearer edges are one


class StatedContact(NamedTuple):
    """A corner of a block that may press on an edge of another one, by their numbers."""

    block: int
    corner: int
    on: int
    edge: int
    springs: PlaneContactSection


class Bond(NamedTuple):
    """Glue at both ends of a part of an edge that two blocks share."""

    first: int
    second: int
    edge: Segment  # [m]
    stiffness: float  # N/m, of the normal spring at an end
    shear: float  # N/m


class BlockLoad(NamedTuple):
    """A force on a block [N], or a traction on a part of its edge [Pa]."""

    block: int
    vector: tuple[float, float]
    place: tuple[float, float] | None  # [m]; None: at the centroid, or along the edge
    edge: Segment | None  # [m]
    ramp: float  # s


@dataclass(frozen=True)
class Assembly:
    """Blocks, what joins them and what drives them, by the numbers of the blocks."""

    blocks: tuple[PlacedBlock, ...]
    members: Members  # the blocks of each name: its own, those it is cut into, or generates
    springs: PlaneContactSection | None  # of pairs that state none
    springs_of_pairs: dict[tuple[int, int], PlaneContactSection]
    contacts: tuple[StatedContact, ...] = ()
    bonds: tuple[Bond, ...] = ()
    loads: tuple[BlockLoad, ...] = ()

    def springs_between(self, first: int, second: int) -> PlaneContactSection | None:
        """Return the springs of corners between two blocks, None where nothing touches."""
        return self.springs_of_pairs.get((min(first, second), max(first, second)), self.springs)

    @property
    def all_springs(self) -> list[PlaneContactSection]:
        """Return the springs of all pairs of blocks."""
        return [*self.springs_of_pairs.values(), *([self.springs] if self.springs else [])]

    @property
    def moving(self) -> list[PlacedBlock]:
        """Return the blocks that are neither fixed nor driven."""
        return [block for block in self.blocks if not block.held]

    @property
    def thinnest(self) -> float:
        """Return the least thickness of a block that moves [m]."""
        return min(block.thickness for block in self.moving)

    @property
    def pose_columns(self) -> tuple[str, ...]:
        """Return the columns of a history if the scene does not say: the poses of what may move."""
        return tuple(f"{block.name}.{part}" for block in self.moving for part in POSE)


def placed_blocks(plane: PlaneContents) -> tuple[tuple[PlacedBlock, ...], Members]:
    """Return the blocks where they are at t = 0, and the numbers of each name; a ValueError if two blocks share one."""
    blocks: list[PlacedBlock] = []
    members: dict[str, list[int]] = {}
    for name, group, section in _sections(plane):
        for block in section.placed(plane, name):
            for meant in {block.name, name, group}:
                members.setdefault(meant, []).append(len(blocks))
            blocks.append(block)
    names = [block.name for block in blocks]
    if reserved := {*RESERVED} & {*members}:
        raise ValueError(f"block: must not be called {' or '.join(RESERVED)}, as columns are, got {min(reserved)!r}")
    if len(set(names)) < len(names):
        repeated = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"block: names must differ, got {repeated!r} twice")
    return tuple(blocks), members


def _sections(plane: PlaneContents) -> Iterator[tuple[str, str, PlaneBlockSection]]:
    """Yield the name of each block, that of its generator or its own, and its table."""
    for number, block in enumerate(plane.block, start=1):
        name = block.name or f"block_{number}"
        yield name, name, block
    for generator in plane.generators:
        for block in generator.blocks():
            yield block.name, generator.name, block


def assembled(plane: PlaneContents) -> Assembly:
    """Return a scene of moving blocks with its names resolved.

    Raises
    ------
    ValueError
        "field: rule, got value": a name is no block's, blocks overlap, a bond joins what does not touch, a corner is
        not in front of its edge, a block touches nothing and nothing moves it, or springs are so soft that a block
        falls through another one.
    """
    blocks, members = placed_blocks(plane)
    assembly = Assembly(blocks, members, plane.contact, {})
    for number, pair in enumerate(plane.pair):
        if plane.contact is None:
            raise ValueError("contact: is required with pair, got none")
        try:
            springs = pair.over(plane.contact)
        except ValidationError as error:
            raise ValueError(f"pair.{number}: {error.errors()[0]['ctx']['error']}") from None
        first, second = (_named(members, name, f"pair.{number}.blocks") for name in pair.blocks)
        pairs = [(min(i, j), max(i, j)) for i, j in itertools.product(first, second) if i != j]
        if not pairs:
            raise ValueError(f"pair.{number}.blocks: must name two blocks, got {pair.blocks[0]!r} twice")
        assembly.springs_of_pairs.update(dict.fromkeys(pairs, springs))
    bonds = tuple(_bonds(plane, assembly))
    loads = tuple(_loads(plane, assembly))
    return replace(assembly, contacts=tuple(_contacts(plane, assembly)), bonds=bonds, loads=loads)


def _named(members: Members, name: str, field: str) -> Sequence[int]:
    if name not in members:
        question = did_you_mean(name, members)
        raise ValueError(f"{field}: must name a block, got {name!r}{f'; {question}' if question else ''}")
    return members[name]


def _one(members: Members, name: str, field: str) -> int:
    """Return the number of the one block that a name means."""
    numbers = _named(members, name, field)
    if len(numbers) > 1:
        raise ValueError(f"{field}: must name one block, got {name!r} of {len(numbers)}")
    return numbers[0]


def _bonds(plane: PlaneContents, assembly: Assembly) -> Iterator[Bond]:
    """Yield the stated bonds, and the glue of blocks that are cut."""
    blocks = assembly.blocks
    members = assembly.members
    for number, bond in enumerate(plane.bond):
        firsts, seconds = (_named(members, name, f"bond.{number}.blocks") for name in bond.blocks)
        if all(blocks[i].held for i in (*firsts, *seconds)):
            raise ValueError(f"bond.{number}.blocks: one of two must move, got {' and '.join(bond.blocks)}")
        bonds = [
            Bond(i, j, edge, bond.stiffness, bond.shear)
            for i, j in itertools.product(firsts, seconds)
            if not (blocks[i].held and blocks[j].held)
            for edge in _shared_edges(blocks, i, j)
        ]
        if not bonds:
            raise ValueError(f"bond.{number}: must join blocks that share an edge, got {' and '.join(bond.blocks)}")
        yield from bonds
    for number, section in enumerate(plane.block):
        if section.subdivide is None:
            continue
        parts = members[section.name or f"block_{number + 1}"]
        young = blocks[parts[0]].young
        if math.isinf(young):
            raise ValueError(f"block.{number}: subdivide goes with a finite young, got inf")
        outlines = [blocks[part].vertices for part in parts]
        reach = np.full(len(parts), TOUCHING * min(map(thickness, outlines)))
        for i, j in geometry.near_pairs(outlines, reach):
            for edge in _shared_edges(blocks, parts[i], parts[j]):
                yield Bond(parts[i], parts[j], edge, plane.glue * young, plane.glue * young)


def _shared_edges(blocks: Sequence[PlacedBlock], first: int, second: int) -> list[Segment]:
    one, other = blocks[first].vertices, blocks[second].vertices
    return list(geometry.shared_edges(one, other, TOUCHING * min(thickness(one), thickness(other))))


def _loads(plane: PlaneContents, assembly: Assembly) -> Iterator[BlockLoad]:
    blocks = assembly.blocks
    members = assembly.members
    for number, load in enumerate(plane.load):
        field = f"load.{number}"
        named = range(len(blocks)) if load.block is None else _named(members, load.block, f"{field}.block")
        if load.edge is None:
            yield BlockLoad(_one(members, str(load.block), f"{field}.block"), load.vector, load.at, None, load.ramp)
            continue
        parts = [
            BlockLoad(block, load.vector, None, part, load.ramp)
            for block in named
            for part in _edge_parts(blocks[block], load.edge)
        ]
        if not parts:
            raise ValueError(f"{field}.edge: must lie on the outline of a block, got {list(map(list, load.edge))}")
        yield from parts


def _edge_parts(block: PlacedBlock, edge: Segment) -> Iterator[Segment]:
    """Yield the parts of a line that are edges of a block, in either direction."""
    tolerance = TOUCHING * block.thickness
    start, end = np.array(edge)
    across = tolerance * np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
    for side in (across, -across):  # a strip along the line, on one side of it and on the other
        strip = (start, end, end + side, start + side) if side is across else (end, start, start + side, end + side)
        corners = tuple((float(x), float(y)) for x, y in strip)
        for part in geometry.shared_edges(block.vertices, corners, tolerance / 2):
            if math.dist(*part) > 2 * tolerance:  # not the strip's short sides, which lie on joints of its neighbours
                yield part


def _contacts(plane: PlaneContents, assembly: Assembly) -> Iterator[StatedContact]:
    for number, touch in enumerate(plane.touch):
        field = f"touch.{number}"
        block = _one(assembly.members, touch.block, f"{field}.block")
        on = _one(assembly.members, touch.on, f"{field}.on")
        pair = assembly.blocks[block], assembly.blocks[on]
        outline, other = (one.vertices for one in pair)
        for key, index, one in zip(("corner", "edge"), (touch.corner, touch.edge), pair, strict=True):
            if index >= (count := len(one.vertices)):
                raise ValueError(f"{field}.{key}: must be from 0 to {count - 1} of {one.name}, got {index}")
        if block == on:
            raise ValueError(f"{field}.on: must be another block, got {touch.on!r}")
        if all(one.held for one in pair):
            raise ValueError(f"{field}: one of two blocks must move, got {touch.block} and {touch.on}")
        share, outside = geometry.corner_on_edge(outline[touch.corner], other, touch.edge)
        size = min(thickness(outline), thickness(other))
        place = f"corner {touch.corner} of {touch.block}"
        if not -TOUCHING <= share <= 1 + TOUCHING:
            raise ValueError(
                f"{field}: {place} must be in front of edge {touch.edge} of {touch.on}, got {share:.3g} of its length"
            )
        if not -OVERLAP * size <= outside <= size:
            bounds = f"between {-OVERLAP * size:.3g} and {size:.3g} m outside of {touch.on}"
            raise ValueError(f"{field}: {place} must be {bounds}, got {outside:.3g} m")
        springs = assembly.springs_between(block, on)
        if springs is not None:
            yield StatedContact(block, touch.corner, on, touch.edge, springs)


def check(plane: PlaneContents, assembly: Assembly) -> None:
    """Check that blocks lie apart, that nothing rests for ever on nothing, and that springs hold what comes.

    What does not is a ValueError, "field: rule, got value".
    """
    blocks = assembly.blocks
    if all(block.held for block in blocks):
        raise ValueError(f"block: one at least must move, got {len(blocks)} that are fixed or driven")
    sizes = np.array([block.thickness for block in blocks])
    joined = {number for bond in assembly.bonds for number in (bond.first, bond.second)}
    joined |= {number for contact in assembly.contacts for number in (contact.block, contact.on)}
    if not assembly.contacts:
        outlines = [block.vertices for block in blocks]
        for i, j in geometry.near_pairs(outlines, TOUCHING * sizes):
            size = min(sizes[i], sizes[j])
            depth = geometry.overlap(outlines[i], outlines[j])
            if depth > OVERLAP * size and not (blocks[i].held and blocks[j].held):
                raise ValueError(f"block: {blocks[i].name} and {blocks[j].name} must not overlap, got {depth:.3g} m")
            if depth > 0 or geometry.gap(outlines[i], outlines[j]) <= TOUCHING * size:
                joined |= {i, j}
    loaded = {load.block for load in assembly.loads}
    weighty = any(plane.gravity)
    for number, block in enumerate(blocks):
        if block.held or number in joined:
            continue
        if assembly.contacts or (assembly.bonds and assembly.springs is None):
            raise ValueError(f"block: {block.name} must be in a touch or a bond as others are, got neither")
        if not (weighty or number in loaded or block.spin or any(block.velocity)):
            raise ValueError(f"block: {block.name} touches nothing and nothing moves it, got no load and no velocity")
    for number, block in enumerate(blocks):
        if not block.held and assembly.springs is not None:
            _check_springs(plane, assembly, number, float(sizes[number]))


def _check_springs(plane: PlaneContents, assembly: Assembly, number: int, size: float) -> None:
    """Refuse springs that a block's weight, or the energy of its velocity, presses through."""
    block = assembly.blocks[number]
    pairs = [springs for pair, springs in assembly.springs_of_pairs.items() if number in pair]
    stiffness = min(springs.stiffness for springs in (*pairs, assembly.springs) if springs is not None)
    softest = [f"pair.{k}" for k, pair in enumerate(plane.pair) if pair.stiffness == stiffness] or ["contact"]
    mass = block.mass
    for cause, depth in (
        ("weight", mass * math.hypot(*plane.gravity) / stiffness),
        ("velocity", math.hypot(*block.velocity) * math.sqrt(mass / stiffness)),
    ):
        if depth > size:
            raise ValueError(
                f"{softest[0]}.stiffness: must stop {block.name}, which is {size:.3g} m thick, and {stiffness:g} N/m "
                f"lets its {cause} through, got {depth:.3g} m"
            )
