"""Masses on MuJoCo's slide joints, tendons that are springs, and the steps of a compiled model."""

import math
from collections.abc import Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from peers.packages import imported

RECIPE = "pip install mujoco==4.0.0"
FREE = 1e30  # m: a rest length, or a yield, that is never reached
MOST = 3_000_000  # sub-steps beyond which a scene is refused


@dataclass(frozen=True)
class Spring:
    """A fixed tendon with a spring; its length is the sum of factor times joint."""

    factors: Mapping[str, float]  # joint to its factor [-]
    stiffness: float  # N/m
    lower: float = 0.0  # rest length [m]
    pulls: bool = True  # whether it pulls above its rest length
    slips: bool = False  # whether it has a yield


@dataclass
class Network:
    """Masses on slide joints, springs between them, dampers against the ground, constant forces."""

    masses: dict[str, float]  # joint to its mass [kg]
    springs: list[Spring]
    damping: dict[str, float] = field(default_factory=dict)  # joint to its damper [N s/m]
    forces: dict[str, float] = field(default_factory=dict)  # joint to its constant force [N]

    def text(self, options):
        """Return the model in MuJoCo's XML."""
        return model_text(options, "".join(map(self._body, self.masses)), "".join(map(_tendon, self.springs)))

    def _body(self, name):
        damping = self.damping.get(name, 0.0)
        joint = f'<joint name="{name}" type="slide" axis="1 0 0" damping="{damping!r}"/>'
        return f'<body><inertial pos="0 0 0" mass="{self.masses[name]!r}" diaginertia="1 1 1"/>{joint}</body>'

    def vector(self, values):
        """Return values of joints in the order of the joints."""
        return np.array([values.get(name, 0.0) for name in self.masses])

    def frequency(self):
        """Return a bound of the greatest angular frequency with all springs at work, and of the dampers' rates [1/s].

        Gershgorin's for the symmetric M^(-1/2) K M^(-1/2).
        """
        names = {name: i for i, name in enumerate(self.masses)}
        m, total = self.vector(self.masses), np.zeros(len(names))
        for spring in self.springs:
            at = [names[name] for name in spring.factors]
            c = np.abs([*spring.factors.values()]) / np.sqrt(m[at])
            total[at] += spring.stiffness * c * c.sum()
        return max(math.sqrt(total.max()), float((self.vector(self.damping) / m).max()))


def model_text(options, world, tendons="", gravity="0 0 0", contact=""):
    """Return a model in MuJoCo's XML."""
    option = f'<option gravity="{gravity}" {options}><flag autoreset="disable"/></option>'
    return f"<mujoco>{option}<worldbody>{world}</worldbody><tendon>{tendons}</tendon>{contact}</mujoco>"


def _tendon(spring):
    terms = "".join(f'<joint joint="{name}" coef="{c!r}"/>' for name, c in spring.factors.items())
    plastic = f'springyield="{FREE!r}"' if spring.slips else ""
    return f'<fixed stiffness="{spring.stiffness!r}" springlength="0 0" {plastic}>{terms}</fixed>'


class March:
    """A compiled model, its state, and the steps that it makes.

    Raises
    ------
    NotImplementedError
        MuJoCo is not installed.
    """

    def __init__(self, text, network=None):
        self.mujoco = imported("mujoco", "MuJoCo", RECIPE)
        self.model = self.mujoco.MjModel.from_xml_string(text)
        for i, spring in enumerate(network.springs if network else []):  # not by XML, to which -1 means something else
            self.model.tendon_lengthspring[i] = spring.lower, spring.lower if spring.pulls else FREE
        self.data = self.mujoco.MjData(self.model)  # takes the rest lengths of springs that slip from the model
        if network is not None:
            self.data.qfrc_applied[:] = network.vector(network.forces)

    def look(self):
        """Compute what belongs to the present state: lengths, accelerations, forces of the contact."""
        self.mujoco.mj_forward(self.model, self.data)

    def start_between(self):
        """Set the velocities back by half a step: semi-implicit Euler from there is the leapfrog, of order two."""
        self.look()
        self.data.qvel[:] -= self.data.qacc * self.model.opt.timestep / 2

    def pressing(self):
        """Return the sum of the normal forces of the contacts in the present state [N]."""
        force, total = np.zeros(6), 0.0
        for number in range(self.data.ncon):
            self.mujoco.mj_contactForce(self.model, self.data, number, force)
            total += float(force[0])
        return total

    def rows(self, steps, each, report, drive=None):
        """Make `each` sub-steps before every row and return the rows; rows after a breakdown are NaN."""
        found = np.full((steps, len(report())), np.nan)
        with self.silent():
            for step in range(steps):
                self._advance(step * each, each, drive)
                if self.data.warning.number.any() or not np.isfinite(self.data.qpos).all():
                    break
                found[step] = report()
        return found

    def _advance(self, done, count, drive):
        if drive is None:
            self.mujoco.mj_step(self.model, self.data, count)
            return
        for number in range(done, done + count):
            drive(number)
            self.mujoco.mj_step(self.model, self.data)

    @contextmanager
    def silent(self):
        """Keep MuJoCo from writing a file of warnings where it is run; a breakdown is told by the rows."""
        before = self.mujoco.get_mju_user_warning()
        self.mujoco.set_mju_user_warning(lambda text: None)
        try:
            yield
        finally:
            self.mujoco.set_mju_user_warning(before)


def refuse(why, *, where):
    """Refuse a scene in words where something is so.

    Raises
    ------
    NotImplementedError
        It is.
    """
    if where:
        raise NotImplementedError(why)


def parts(frequency, step, steps, fine, coarse, many):
    """Return into how many sub-steps a step is cut: `fine` of w dt, coarser where that makes many."""
    each = max(math.ceil(step * frequency / fine), 1)
    each = max(min(each, many // steps), math.ceil(step * frequency / coarse), 1)
    refuse(f"it would take {each * steps} sub-steps, so stiff is the scene", where=each * steps > MOST)
    return each
