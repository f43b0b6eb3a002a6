"""A block over a plane base, and how its steps are made when it may turn by any angle."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dda.contact.kernel import at_rest
from dda.contact.unilateral import Unilateral
from dda.model.load import at_once, pressed_part
from dda.model.loaded import LoadedBlock
from dda.one_block.unilateral import check_iteration
from dda.rotation.body import EXACT, FIRST_ORDER, Body, body, directions, turned
from dda.rotation.step import RollingState, Setting
from dda.scheme.newmark import Scheme

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, init=False)
class RollingModel(LoadedBlock):
    """One convex block that slides, rocks, topples and rolls over the line of its base edge, prolonged both ways.

    Pressure and traction are dead loads: they keep size and direction and act on the material points of the top edge.

    Raises
    ------
    ValueError
        If a number is not finite, the outline is not convex, the contact has a band, the eccentricity leaves nothing
        of the top edge, or base and top are not two edges of the block.
    """

    contact: Unilateral  # at every corner of the outline
    tilt: float = 0.0  # counter-clockwise at t = 0, about the end of the base that stays down [rad]
    velocity: tuple[float, float] = (0.0, 0.0)  # of the centroid at t = 0, in x and y of the block's coordinates [m/s]
    spin: float = 0.0  # at t = 0, counter-clockwise [rad/s]

    def check(self) -> None:
        """Check the numbers and the edges."""
        super().check()
        at_once(self.load, "updated geometry")
        for name in ("tilt", "spin", "velocity"):
            if not np.all(np.isfinite(getattr(self, name))):
                raise ValueError(f"{name}: must be finite, got {getattr(self, name)!r}")
        if any(self.contact.band):
            raise ValueError(f"band: must be zero where the geometry is updated, got {self.contact.band!r}")
        _ = self.body

    @cached_property
    def body(self) -> Body:
        """Outline and matrices in the frame of the base."""
        return body(self.block, self.base)

    def setting(self, options: RollingOptions) -> Setting:
        """Return what stays the same from step to step."""
        where, dead = self._dead()
        weight = self.load.gravity * (self.body.to_base @ self.load.falling)
        return Setting(self.body, self.contact, weight, where, dead, options.rotation, options.solve_limit)

    def _dead(self) -> tuple[Array, Array]:
        """Return where the resultants of pressure and traction act, and these, along and across the base."""
        load, (start, end) = self.load, self.block.edge(self.top)
        pressed = pressed_part(start, end, load.eccentricity)
        edge_loads = ((pressed, load.pressure, (0.0, -1.0)), ((start, end), load.traction, (1.0, 0.0)))
        acting = [(ends, size, direction) for ends, size, direction in edge_loads if size]
        local = self.body.to_base
        where = [local @ (np.mean(ends, axis=0) - self.block.section.centroid) for ends, _, _ in acting]
        forces = [size * float(np.hypot(*(ends[1] - ends[0]))) * (local @ along) for ends, size, along in acting]
        return np.array(where).reshape(-1, 2), np.array(forces).reshape(-1, 2)

    def start(self, setting: Setting, scheme: Scheme) -> RollingState:
        """Return the state at t = 0: unstrained, without contact force, at the starting gap."""
        body = self.body
        Q = turned(self.tilt)
        touching = body.base if self.tilt == 0 else body.base[:1] if self.tilt > 0 else body.base[1:]
        down = body.xi[touching[0]]
        q = np.zeros(6)
        q[:2] = body.centroid + down - Q @ down + np.array([0.0, self.contact.gap])
        gap = (q[:2] + body.xi @ Q.T)[:, 1]
        gap[list(touching)] = self.contact.gap
        V = np.zeros(6)
        V[:2] = body.to_base @ self.velocity
        V[2] = self.spin
        A = np.zeros(6)
        if scheme.start == "consistent":
            push = np.zeros(6)
            push[:2] = body.M[0, 0] * setting.weight
            spin = np.array([-Q[1], Q[0]])
            across, up = np.zeros((2, 6))
            for (x, y), force in zip(setting.where, setting.dead, strict=True):
                directions(spin, Q, q, x, y, across, up)
                push += force[0] * across + force[1] * up
            A[:] = np.linalg.solve(body.M, push)
        return RollingState(q, Q, V, A, at_rest(gap))


@dataclass(frozen=True)
class RollingOptions:
    """How the steps are made.

    Raises
    ------
    ValueError
        If a value is out of its range.
    """

    rotation: str = EXACT  # or "first-order": the outline of a step moves by x - r y, y + r x, and grows
    solve_limit: int = 6  # solves of the open-close iteration before all states are tried
    cut: float = 0.3  # length of a cut step over that of the failed one

    def __post_init__(self) -> None:
        """Check the ranges."""
        if self.rotation not in (EXACT, FIRST_ORDER):
            raise ValueError(f"rotation: must be {EXACT!r} or {FIRST_ORDER!r}, got {self.rotation!r}")
        check_iteration(self.solve_limit, self.cut)
