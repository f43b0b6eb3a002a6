"""Contact parameters of other programs: one description of each, for both directions, and the defaults."""

from __future__ import annotations

from dataclasses import dataclass

GRAVITY = 9.81  # m/s2
BOX2D_LIMIT = 0.125  # of the rate of substeps: the greatest hertz of a contact between moving bodies
BOX2D_STATIC = 2.0  # a contact with a static body has this many times the hertz
MUJOCO_STEPS = 2.0  # steps that timeconst must have
MUJOCO_IMPEDANCES = (0.0001, 0.9999)  # into which MuJoCo clips dmin and dmax
PYBULLET_SLOP = 1e-5  # m, by which PyBullet lets bodies overlap before a contact pushes


Settings = dict[str, float | tuple[float, ...]]


@dataclass(frozen=True)
class Parameter:
    """A number of a program, and what it is as spring and dashpot."""

    name: str
    unit: str
    meaning: str
    formula: str  # of the spring and the dashpot on an effective mass m
    default: tuple[float, ...] = ()  # of the program; empty where it has none


@dataclass(frozen=True)
class Program:
    """Contact of a program: its parameters, its step, and where that is written."""

    name: str
    title: str
    version: str  # with which the formulas were checked
    step: float | None  # s, as it comes: the one over which a contact is solved; None where a user must state one
    points: int  # contact points of a flat box on flat ground
    parameters: tuple[Parameter, ...]
    source: str

    def default(self, name: str) -> tuple[float, ...]:
        """Return the default of a parameter, of one number or of several."""
        return next(one.default for one in self.parameters if one.name == name)

    @property
    def defaults(self) -> Settings:
        """The parameters that have a default."""
        return {
            one.name: one.default if len(one.default) > 1 else one.default[0] for one in self.parameters if one.default
        }


PROGRAMS = {
    program.name: program
    for program in (
        Program(
            "box2d",
            "Box2D",
            "3.1.1 (pyb2d3 0.11.1)",
            1 / 240,
            2,
            (
                Parameter("hertz", "Hz", "contactHertz", "w = 2 pi hertz; twice that on a static body", (30.0,)),
                Parameter("damping_ratio", "", "contactDampingRatio", "zeta", (10.0,)),
            ),
            "b2MakeSoft, b2World_Step, b2SolveOverflowContacts and b2ApplyOverflowRestitution of Box2D's source",
        ),
        Program(
            "bullet",
            "Bullet",
            "of pybullet 3.2.7",
            None,
            4,
            (
                Parameter("erp", "", "erp", "erp = h k / (h k + c)"),
                Parameter("cfm", "m/(N s)", "cfm", "cfm = 1 / (h k + c)"),
            ),
            "btSequentialImpulseConstraintSolver::setupContactConstraint",
        ),
        Program(
            "pybullet",
            "PyBullet",
            "3.2.7",
            1 / 240,
            4,
            (
                Parameter("contact_stiffness", "N/m", "contactStiffness", "k of a contact point"),
                Parameter("contact_damping", "N s/m", "contactDamping", "c of a contact point"),
            ),
            "setupContactConstraint as of Bullet; btManifoldResult::calculateCombinedContactStiffness and -Damping",
        ),
        Program(
            "mujoco",
            "MuJoCo",
            "4.0.0",
            0.002,
            4,
            (
                Parameter("timeconst", "s", "solref[0]", "w = 1 / (timeconst dampratio) at d = dmax", (0.02,)),
                Parameter("dampratio", "", "solref[1]", "zeta at d = dmax", (1.0,)),
                Parameter("dmax", "", "solimp, dmin = dmax = d", "share 1 - d of the load"),
                Parameter(
                    "solimp", "", "solimp", "d(x) by dmin, dmax, width, midpoint, power", (0.9, 0.95, 0.001, 0.5, 2.0)
                ),
            ),
            "MuJoCo's documentation, Modeling, Solver parameters; getimpedance and mj_makeImpedance",
        ),
        Program(
            "yade",
            "Yade",
            "2023.02a",
            None,
            1,
            (
                Parameter("normal_stiffness", "N/m", "kn", "k"),
                Parameter("local_damping", "", "NewtonIntegrator.damping", "e^2 = (1 - alpha) / (1 + alpha)", (0.2,)),
            ),
            "Yade's documentation, Formulation: numerical damping, critical timestep; Ip2_FrictMat_FrictMat_FrictPhys",
        ),
        Program(
            "opensees",
            "OpenSees",
            "3.7.1 (openseespy 3.7.1.2)",
            None,
            2,
            (Parameter("penalty", "N/m", "penalty k_n", "k of a contact point"),),
            "OpenSees' documentation of the material ENT, the element zeroLengthContact and the integrator Newmark",
        ),
    )
}
SPRING = ("stiffness", "damping", "restitution")
PARAMETERS = {  # program -> its parameters, and those of the suite itself
    **{name: tuple(one.name for one in program.parameters) for name, program in PROGRAMS.items()},
    "spring": SPRING,
}
OPTIONAL = {"dmax", "damping", "restitution"}  # where a program has no default
