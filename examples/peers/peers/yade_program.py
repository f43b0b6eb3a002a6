"""The script that the program `yade` runs: rigid bodies, bonds and a floor, from a file, moved by its own engines.

It knows nothing of scenes; `peers.yade_bodies` writes what it reads. The loop is the usual one of Yade's manual. Forces
of the script and its look at the motion come between the contact forces and the step, where both are of one instant.
"""

import json
import math

REQUEST, ANSWER = "request.json", "answer.json"
HELD = 1e30  # N: adhesion of what never breaks
WIDE = 1e6  # m: half of the floor's edges


class Program:
    """Bodies and bonds of a request in the program."""

    def __init__(self, request, yade):
        self.yade, self.omega, self.request = yade, yade.O, request
        self.drive, self.dt = request["drive"], request["dt"]
        self.below = 0.0  # force of the half-space on the first body [N]
        self.rows = {"x": [], "y": [], "turn": [], "force": []}
        self._materials()
        self.floor = self._add_floor()
        self.bodies = [self._add(body) for body in request["bodies"]]
        self.upright = [self.omega.bodies[number].state.ori.conjugate() for number, _ in self.bodies]
        self._engines()
        self.bonds = self._bind_all()

    def _materials(self):
        """Make the materials of what carries a body's mass, of points and floor, and of bonds."""
        yade, floor = self.yade, self.request["floor"]
        more = {}
        self.cohesion = 0.0  # Pa, which the program multiplies by the square of the radius
        if floor is not None:
            radius = max(p["radius"] for body in self.request["bodies"] for p in body["points"] if p["touches"])
            self.cohesion = floor["cohesion"] / radius**2
            # of two equal materials and radii kn is young times radius, and ks is kn times poisson
            more = {"young": floor["normal"] / radius, "poisson": floor["shear"] / floor["normal"]}
            more |= {"frictionAngle": floor["friction"]}
        sticky = floor is not None and (floor["holds"] or floor["cohesion"] > 0)
        point = yade.CohFrictMat(density=1e-12, label="point", fragile=False, **more) if sticky else None
        self.omega.materials.append(yade.FrictMat(density=1e12, label="mass"))
        self.omega.materials.append(point or yade.FrictMat(density=1e-12, label="point", **more))
        self.omega.materials.append(yade.CohFrictMat(density=1e-12, label="bond"))

    def _add_floor(self):
        """Add the floor, a box whose upper face is far wider than anything moves."""
        floor = self.request["floor"]
        if floor is None:
            return None
        at, size = (0, floor["height"] - 1, 0), (WIDE, 1, WIDE)
        return int(self.omega.bodies.append(self.yade.utils.box(at, size, fixed=True, material="point", mask=1)))

    def _add(self, body):
        """Add a body as a clump whose mass and inertia are given; return its number and those of its points.

        A heavy sphere that meets nothing puts the clump's centre where it is to be; its weight is then overwritten.
        """
        sphere, (x, y), m = self.yade.utils.sphere, body["at"], body["mass"]
        parts = [sphere((x, y, 0), 1.0, material="mass", mask=0)]
        for point in body["points"]:
            at, kind = (x + point["at"][0], y + point["at"][1], 0), "point" if point["touches"] else "bond"
            parts.append(sphere(at, point["radius"], material=kind, mask=int(point["touches"])))
        number, members = self.omega.bodies.appendClumped(parts, discretization=0)
        one, turns = self.omega.bodies[number], body["inertia"] > 0
        one.state.mass, one.aspherical = m, False
        one.state.inertia = self.yade.Vector3(1, 1, 1) * (body["inertia"] or 1.0)
        one.state.blockedDOFs = "xyzXYZ" if body["fixed"] else "zXY" if turns else "zXYZ"
        late = self.dt / 2 * self.request["staggered"] * (not body["fixed"])
        (gx, gy), (fx, fy) = self.request["gravity"], body["force"]
        one.state.vel = (-late * (gx + fx / m), body["velocity"] - late * (gy + fy / m), 0)
        one.state.angVel = (0, 0, -late * body["torque"] / body["inertia"] if turns else 0)
        self.omega.forces.setPermF(number, (fx, fy, 0))
        self.omega.forces.setPermT(number, (0, 0, body["torque"]))
        return number, sorted(members)[1:]

    def _engines(self):
        """Set the loop."""
        yade, period = self.yade, 1 if self.drive is not None else self.request["cut"]
        sticky = yade.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(
            setCohesionOnNewContacts=True,
            normalCohesion=yade.MatchMaker(algo="val", val=0.0),
            shearCohesion=yade.MatchMaker(algo="val", val=self.cohesion),
        )
        self.omega.dt = self.dt
        self.omega.engines = [
            yade.ForceResetter(),
            yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), yade.Bo1_Box_Aabb()]),
            yade.InteractionLoop(
                [yade.Ig2_Sphere_Sphere_ScGeom6D(), yade.Ig2_Box_Sphere_ScGeom6D()],
                [yade.Ip2_FrictMat_FrictMat_FrictPhys(), sticky],
                [yade.Law2_ScGeom_FrictPhys_CundallStrack(), yade.Law2_ScGeom6D_CohFrictPhys_CohesionMoment()],
            ),
            yade.PyRunner(command="PROGRAM.before_the_step()", iterPeriod=period, initRun=True),
            yade.NewtonIntegrator(damping=self.request["damping"], gravity=(*self.request["gravity"], 0)),
        ]

    def _bind_all(self):
        """Make the bonds between bodies, and those to a floor that holds."""
        bonds = []
        for bond in self.request["bonds"]:
            one, other = (self.bodies[i][1][k] for i, k in zip(bond["bodies"], bond["points"], strict=True))
            bonds.append(self._bind(one, other, bond))
        if self.floor is not None and self.request["floor"]["holds"]:
            for body in self.omega.bodies:
                if body.mask == 1 and body.isClumpMember:
                    self._bind(self.floor, body.id, self.request["floor"])
        return bonds

    def _bind(self, one, other, springs):
        """Make a bond that holds, unstrained as it stands, and set its stiffnesses."""
        made = self.yade.utils.createInteraction(one, other)
        made.phys.kn, made.phys.ks, made.phys.unp = springs["normal"], springs["shear"], made.geom.penetrationDepth
        made.phys.normalAdhesion = made.phys.shearAdhesion = HELD
        if bending := springs.get("bending"):
            made.phys.momentRotationLaw, made.phys.kr, made.phys.maxRollPl = True, bending, -1.0
        return made

    def before_the_step(self):
        """Apply the drive at this instant, and look at the motion where a step of the scene ends."""
        step = self.omega.iter
        if self.drive is not None:
            self._push(step)
        if step % self.request["cut"] == 0:
            self._look()

    def _push(self, step):
        """Press on the last body; move the first one, or act on it as the half-space below does.

        The dashpot takes the mean of the velocities before and after the step, as it is of second order then.
        """
        drive, axis, first = self.drive, self.drive["axis"], self.bodies[0][0]
        self._act(self.bodies[-1][0], drive["top"][step])
        state = self.omega.bodies[first].state
        if drive["ground"]:
            rate = (drive["ground"][step + 1] - drive["ground"][step]) / self.dt
            state.vel = self.yade.Vector3(*(rate if i == axis else 0.0 for i in range(3)))
            return
        z, coming, half = drive["impedance"], drive["incident"][step], self.dt / (2 * state.mass)
        velocity = (state.vel[axis] + half * (2 * z * coming - self._pull(axis))) / (1 + half * z)
        self.below = z * (2 * coming - velocity)
        self._act(first, self.below)

    def _act(self, number, force):
        """Add a force along the axis of the drive for this step."""
        self.omega.forces.addF(number, [force if i == self.drive["axis"] else 0.0 for i in range(3)])

    def _pull(self, axis):
        """Return the force of the lowest bond on what is above it [N]."""
        phys = self.bonds[0].phys
        return float(phys.normalForce[axis] + phys.shearForce[axis])

    def _look(self):
        """Keep a row of the motion."""
        states = [self.omega.bodies[number].state for number, _ in self.bodies]
        self.rows["x"].append([state.pos[0] for state in states])
        self.rows["y"].append([state.pos[1] for state in states])
        turned = [state.ori * upright for state, upright in zip(states, self.upright, strict=True)]
        self.rows["turn"].append([2 * math.atan2(q[2], q[3]) for q in turned])
        self.rows["force"].append(self._standing())

    def _standing(self):
        """Return the force on what stands on the floor, or on the half-space or the ground below the first body [N]."""
        if self.drive is not None:
            return self.below if self.drive["impedance"] else self._pull(self.drive["axis"])
        pairs = self.omega.interactions.withBody(self.floor) if self.floor is not None else ()
        return sum(float(pair.phys.normalForce[1]) for pair in pairs if pair.isReal)

    def run(self):
        """Move everything and return the rows, the state at t = 0 first."""
        self.omega.run(self.request["cut"] * self.request["steps"] + 1, True)
        return self.rows


if __name__ == "__main__":
    import yade as program

    with open(REQUEST) as file:
        PROGRAM = Program(json.load(file), program)
    with open(ANSWER, "w") as file:
        json.dump(PROGRAM.run(), file)
