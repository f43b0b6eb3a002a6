"""A column of layers as a chain of linear elements with consistent mass, per unit of area, for `siconos`."""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from peers.columns import NEAR, stretches

SHORTEST = 0.1  # rad of the pulse's highest frequency in a step, settings for accuracy
LEAST, MOST = 4, 20_000  # steps in one of the scene's, and of a run, that settings for accuracy choose
ELEMENTS = 200  # that settings for accuracy may choose; a dense matrix is solved in each step
Element = tuple[int, float, float]  # its lower node, whose upper one is the next, and the heights of both [m]


@dataclass(frozen=True)
class Chain:
    """M q'' + C q' + K q = F s(t), the first unknown left out where the base holds it."""

    M: np.ndarray  # mass, shape (nodes, nodes) [kg/m2]
    K: np.ndarray  # stiffness, shape (nodes, nodes) [Pa/m]
    C: np.ndarray  # the half-space's dashpot, shape (nodes, nodes) [Pa s/m]
    elements: list[Element]
    held: int  # number of nodes that the base holds, 0 or 1
    load: np.ndarray  # F, shape (nodes,)
    signal: np.ndarray  # mean of s in each step, shape (steps,)
    carried: np.ndarray  # displacement of the base that the unknowns are relative to, a row a step of the scene [m]
    parts: int  # steps in one of the scene's

    @classmethod
    def of(cls, scene, fine):
        """Return the chain of a scene's column.

        Raises
        ------
        NotImplementedError
            The column is glued, or has a joint at its top.
        """
        from validation.scenes.drive import motion_at

        c = scene.column
        parts = pulse_parts(scene) if fine else 1
        M, K, elements = assembled(c, math.sqrt(2) * scene.time.step / parts if fine else None)
        instants = scene.time.step / parts * np.arange(scene.time.steps * parts + 1.0)
        drive = motion_at(scene, instants)
        load, C, carried = np.zeros(len(M)), np.zeros(M.shape), np.zeros((scene.time.steps, 1))
        C[0, 0] = c.impedance or 0.0
        if scene.input.at == "top":
            load[-1], signal = -1.0, (drive.pressure[1:] + drive.pressure[:-1]) / 2
        elif c.impedance is not None:
            load[0], signal = 2 * c.impedance, (drive.velocity[1:] + drive.velocity[:-1]) / 2
        else:  # in a step the base's acceleration has this mean
            load, signal = -M.sum(axis=1), np.diff(drive.velocity) / np.diff(instants)
            carried = drive.displacement[parts::parts, None]
        return cls(M, K, C, elements, int(c.impedance is None), load, signal, carried, parts)

    def request(self):
        """Return what the program is given."""
        own = slice(self.held, None)
        square = {"M": self.M[own, own], "K": self.K[own, own], "C": self.C[own, own]}
        return {**square, "load": self.load[own], "signal": self.signal}

    def columns(self, heights, q):
        """Return the displacements of the top and of the heights."""
        full = np.hstack([np.zeros((len(q), self.held)), q]) + self.carried
        seen = {f"displacement_{i + 1}": full @ self.row_at(z) for i, z in enumerate(heights)}
        return {"displacement": full[:, -1], **seen}

    def row_at(self, height):
        """Return the row that interpolates at a height; where two elements meet, in the lower one."""
        node, low, high = next((one for one in self.elements if height <= one[2] * (1 + NEAR)), self.elements[-1])
        share, row = (height - low) / (high - low), np.zeros(len(self.M))
        row[node : node + 2] = 1 - share, share
        return row


def pulse_parts(scene):
    """Return the number of steps in one of the scene's that follow its pulse, or a record, by `ELEMENTS` at most."""
    drive = scene.input
    highest = 3 * drive.frequency if drive.frequency else 5 / drive.duration if drive.duration else 0.0  # Hz
    wanted = math.ceil(2 * math.pi * highest * scene.time.step / SHORTEST)
    affordable = int(math.sqrt(2) * scene.time.step * ELEMENTS / passing(scene.column))
    return max(1, min(max(LEAST, wanted), affordable, MOST // scene.time.steps))


def passing(c):
    """Return the time in which a wave passes the column [s]."""
    return sum(layer.thickness * math.sqrt(layer.density / c.modulus(layer)) for layer in c.layer)


def assembled(c, travel):
    """Return mass and stiffness of a column on its base's node, and the elements.

    `travel` is the time in which a wave passes an element [s]: sqrt(2) steps, at which the errors of a linear element
    with consistent mass and of the theta method with 1/2 cancel; None: the blocks of the scene are the elements.
    """
    if c.glue is not None:
        raise NotImplementedError("column.glue: springs between DDA's blocks, and the column here has none")
    if max((joint.height for joint in c.springs), default=0.0) > c.height * (1 - NEAR):
        raise NotImplementedError("column.joint: one at the top joins nothing")
    if travel is not None:
        travel = max(travel, passing(c) / ELEMENTS)
    elements = []
    parts = []  # lower node, a sixth of the mass, stiffness
    for one in stretches(c):
        if one.spring is not None:
            parts.append((len(parts), 0.0, one.spring))
        for a, b in itertools.pairwise(np.linspace(one.bottom, one.top, _count(one, travel) + 1).tolist()):
            elements.append((len(parts), a, b))
            parts.append((len(parts), one.layer.density * (b - a) / 6, one.modulus / (b - a)))
    M, K = np.zeros((len(parts) + 1,) * 2), np.zeros((len(parts) + 1,) * 2)
    for node, mass, stiffness in parts:
        M[node : node + 2, node : node + 2] += mass * np.array([[2.0, 1.0], [1.0, 2.0]])
        K[node : node + 2, node : node + 2] += stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return M, K, elements


def _count(one, travel):
    """Return the number of elements of a stretch."""
    if travel is None:
        return max(1, math.ceil(one.layer.blocks * one.length / one.layer.thickness - NEAR * one.layer.blocks))
    return max(1, math.ceil(one.passing / travel))
