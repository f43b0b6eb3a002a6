"""A box on the ground by Moreau's time steps: impulses at the corners that touch, by sweeps of Gauss and Seidel."""

import math

import numpy as np

from validation.models.plane.boxes import boxes_of

ABOUT = {
    "program": "impulses",
    "version": "1.0",
    "recipe": "pip install my_package",
    "model": "rigid box, Newton's restitution and Coulomb's friction at each corner",
    "settings": "step 1/1000 s; sweeps until no impulse changes by 1e-12 of the momentum",
}


class Impulses:
    """One box; impulses until none changes any more."""

    handles = frozenset({"blocks in the plane", "blocks that move"})
    about = ABOUT
    own_step = 1e-3  # s

    def solve(self, scene):
        """Return the columns of a scene: pose and normal force of the box at each row."""
        try:
            ground = boxes_of(scene)
        except ValueError as error:
            raise NotImplementedError(str(error)) from None
        if len(ground.boxes) > 1 or ground.stiffness is not None:
            raise NotImplementedError("one box on rigid ground only")
        box = ground.boxes[0]
        per_row = math.ceil(scene.time.step / self.own_step - 1e-9)
        dt = scene.time.step / per_row
        inverse_mass = 1 / np.array([box.mass, box.mass, box.inertia])
        half_sides = np.array([box.width, box.height]) / 2
        corners = half_sides * [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        pose = np.array([box.x, box.y, box.angle])
        velocity = np.array([*box.velocity, box.spin])
        rows = []
        for row in range(scene.time.steps):
            for part in range(per_row):
                time = (row * per_row + part) * dt
                pose = pose + dt / 2 * velocity
                arms = corners @ [
                    (math.cos(pose[2]), math.sin(pose[2])),
                    (-math.sin(pose[2]), math.cos(pose[2])),
                ]
                touching = arms[pose[1] + arms[:, 1] <= 0]
                velocity, force = self._step(ground, inverse_mass, velocity, touching, dt, ground.base(time + dt)[1])
                pose = pose + dt / 2 * velocity
            rows.append((*pose, force))
        return dict(zip(ground.columns, np.array(rows).T, strict=True))

    def _step(self, ground, inverse_mass, before, touching, dt, base_velocity):
        velocity = before + dt * np.array([*ground.pull, 0.0])
        impulses = np.zeros((len(touching), 2))
        tolerance = 1e-12 * abs(velocity).max() / inverse_mass[0]
        change = math.inf
        while change > tolerance:
            change = 0.0
            for corner, (x, y) in enumerate(touching):
                for axis, direction in ((1, np.array([0.0, 1.0, x])), (0, np.array([1.0, 0.0, -y]))):
                    excess = direction @ velocity
                    if axis == 1:
                        excess += ground.rebound * min(direction @ before, 0.0)
                        low, high = 0.0, math.inf
                    else:
                        excess -= base_velocity
                        high = ground.friction_coefficient * impulses[corner, 1]
                        low = -high
                    wanted = impulses[corner, axis] - excess / (direction**2 @ inverse_mass)
                    added = min(max(wanted, low), high) - impulses[corner, axis]
                    impulses[corner, axis] += added
                    velocity = velocity + inverse_mass * direction * added
                    change = max(change, abs(added))
        return velocity, impulses[:, 1].sum() / dt
