"""Problems and submissions as plain data: JSON whose names carry the units, checked with pydantic."""

from __future__ import annotations

import math
import re
from typing import Annotated, Any, Final, Literal, Self

from pydantic import BaseModel, ConfigDict, Field

from validation.errors import InputError
from validation.runs.columns import kind_of, split, unit_of
from validation.scenes.rigid import RigidSection
from validation.scenes.scene import Scene

PACK: Final = "3.1"
"""Version of the pack, see `validation.problems.packs` for what changes it."""
PROBLEM, SUBMISSION = "dda-validation problem", "dda-validation submission"
ANSWERS: Final = "dda-validation answers 1"  # the number is the version of the layout of a folder of answers
INFINITE: Literal["inf"] = "inf"  # for which JSON has no number
OrInfinite = Annotated[float, Field(allow_inf_nan=False)] | Literal["inf"]
UNIT_OF_NAME = re.compile(r"_(m|kg_per_m3|Pa|m_per_s2?|deg|N_per_m|Pa_per_m|Pa_s_per_m|Hz|s)$")
Text = Annotated[str, Field(min_length=1, max_length=2000, pattern=r"\S")]
PackVersion = Annotated[str, Field(pattern=r"^[0-9]+\.[0-9]+$", description="Version of the pack that is answered.")]
Step = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]


def united(column: str) -> str:
    """Return a history's column as the pack names it, with its unit; a number of rigid boxes has its own name."""
    unit = unit_of(column)
    return f"{column}_{in_names(unit)}" if unit else column


def in_names(symbol: str) -> str:
    """Return a unit as names carry it, m_per_s of m/s."""
    return symbol.replace("/", "_per_")


def meaning(column: str) -> str:
    """Return what a column of a problem means."""
    kind = kind_of(column)
    return "" if kind is None else kind.meaning.format(n=split(column)[1])


class Data(BaseModel):
    """Plain data: immutable, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def of(cls, source: object, **others: Any) -> Self:
        """Return the data whose names without their units are attributes of a source, and others by their names."""
        values: dict[str, Any] = dict(others)
        for name in cls.model_fields:
            plain = UNIT_OF_NAME.sub("", name)
            if name not in values and hasattr(source, plain):
                value = getattr(source, plain)
                values[name] = INFINITE if value == math.inf else value
        return cls(**values)


class BlockData(Data):
    """A rectangle of unit thickness with its lower left corner at the origin."""

    width_m: float
    height_m: float
    thickness_m: float = 1.0
    density_kg_per_m3: float
    young_Pa: float
    poisson: float
    hypothesis: Literal["plane stress", "plane strain"]
    velocity_m_per_s: float = Field(description="At t = 0, upwards positive.")
    tilt_deg: float = Field(description="At t = 0, counter-clockwise about the lower corner that stays down.")


class ContactData(Data):
    """Springs under the two lower corners."""

    law: Literal["locked", "unilateral"] = Field(description="Unilateral springs push and do not pull.")
    normal_stiffness_N_per_m: float = Field(description="Of each of the two springs.")
    shear_stiffness_N_per_m: float = Field(description="The same, along the base.")
    friction_deg: float | None = Field(description="Angle of friction; null: a closed corner never slips.")
    cohesion_Pa: float
    gap_m: float = Field(description="Between the base and the springs at t = 0.")


class LoadData(Data):
    """Loads that act from t = 0 on."""

    pressure_Pa: float = Field(description="Downwards on the top edge.")
    eccentricity_m: float
    traction_Pa: float = Field(description="Towards +x on the top edge.")
    gravity_m_per_s2: float
    slope_deg: float = Field(description="Gravity is turned to g (sin, -cos) in x and y.")


class LayerData(Data):
    """A layer of a column."""

    thickness_m: float
    density_kg_per_m3: float
    young_Pa: OrInfinite = Field(
        description='"inf": all between two contacts is one rigid body; a number: all between two contacts is one '
        "elastic bar, through which waves run."
    )
    poisson: float
    velocity_m_per_s: float = Field(description="At t = 0, upwards positive (of shear: across the column).")


class JointData(Data):
    """A spring across a column, which pulls and pushes and does not slip."""

    height_m: float
    stiffness_Pa_per_m: float


class ColumnContactData(Data):
    """A contact across a column, per unit of area.

    Of pressure: its force is stiffness times closure, and nothing while it is open. Of shear: its force is stiffness
    times (sliding less slip), and slip grows where the force would be more than the strength.
    """

    height_m: float
    stiffness_Pa_per_m: OrInfinite = Field(description='"inf": a rigid stop, or a joint that sticks until it slips.')
    gap_m: float = Field(description="At t = 0; of pressure.")
    strength_Pa: float | None = Field(description="Greatest shear stress, fixed; null: it does not slip.")


class BaseData(Data):
    """What a column stands on."""

    kind: Literal["rigid", "springs", "transmitting", "free"] = Field(description="Free: nothing is below it.")
    stiffness_Pa_per_m: float | None
    impedance_Pa_s_per_m: float | None = Field(description="Of the half-space below, density times wave speed.")


class InputData(Data):
    """What drives a column: a pulse, or a wave from t = 0 on."""

    at: Literal["base", "top"]
    shape: Literal["ricker", "half-sine", "triangle", "sine", "cosine"] = Field(
        description="Of the velocity at the base (above a transmitting base: of the wave that comes up), or of the "
        "pressure on the top. Triangle: from its greatest value at t = 0 to nothing."
    )
    velocity_m_per_s: float | None
    pressure_Pa: float | None
    frequency_Hz: float | None = Field(
        description="Of a sine or cosine; of a Ricker pulse, whose middle comes at 2 / frequency."
    )
    duration_s: float | None = Field(description="Of a half-sine or triangle.")


class ColumnData(Data):
    """A column of layers from the base upwards, everything per unit of area; nothing strains sideways."""

    motion: Literal["pressure", "shear"]
    law: Literal["bonded", "unilateral", "frictional"] = Field(
        description="Bonded: nothing opens or slips; unilateral: the contacts carry no tension; frictional: they slip."
    )
    layers: tuple[LayerData, ...]
    joints: tuple[JointData, ...] = Field(description="Of a bonded column.")
    contacts: tuple[ColumnContactData, ...] = Field(
        description="From the base upwards, of any other column; where there is none its parts move alike."
    )
    gravity_m_per_s2: float = Field(description="Downwards, of pressure.")
    settled: bool = Field(
        description="Whether it is at rest under its weight at t = 0, displacements being those since its parts were "
        "unstrained with the gaps stated; else it is unstrained at t = 0, and the weight acts from then on."
    )
    base: BaseData
    heights_m: tuple[float, ...] = Field(description="Above the base, where the answer is asked for.")
    input: InputData | None = Field(description="Null: weight and velocities alone move it.")


class BoxData(Data):
    """A rigid box of unit depth."""

    width_m: float
    height_m: float
    density_kg_per_m3: float
    x_m: float = Field(description="Of the centre at t = 0, along the ground.")
    y_m: float = Field(description="Of the centre at t = 0, above the ground.")
    angle_rad: float = Field(description="At t = 0, counter-clockwise.")
    velocity_x_m_per_s: float = Field(description="Of the centre at t = 0, along the ground.")
    velocity_y_m_per_s: float = Field(description="Of the centre at t = 0, upwards.")
    spin_rad_per_s: float = Field(description="At t = 0, counter-clockwise.")


class RigidData(Data):
    """Rigid boxes on a plane, which is level in its own frame; on a slope gravity is turned to g (sin, -cos)."""

    boxes: tuple[BoxData, ...] = Field(description="On each other, the first one on the ground.")
    gravity_m_per_s2: float
    slope_deg: float = Field(description="Down towards +x.")
    friction_deg: float = Field(description="Angle of Coulomb friction of every contact; 0: frictionless.")
    restitution: float = Field(description="Newton's, of every contact: rebound over approach speed.")
    stiffness_N_per_m: float | None = Field(
        description="Of the contact of a box with the ground; null: rigid, or the program's own."
    )
    base_amplitude_m: float = Field(description="A of the ground's motion A (1 - cos(2 pi f t)) along itself.")
    base_frequency_Hz: float = Field(description="f of that motion.")


class NumberData(Data):
    """A number of an answer to a problem of rigid boxes, and the band in which it passes."""

    name: str
    unit: str
    exact: float
    low: float
    high: float
    reason: str


class SamplingData(Data):
    """The instants of an answer: step, 2 step, ... up to the last one; no program has to step so."""

    step_s: float
    count: int


class ColumnOfAnswer(Data):
    """A column that an answer holds, and the band of its error; null where an answer is judged by numbers."""

    name: str
    meaning: str
    measure: str | None = None
    until_s: float | None = None
    low: float | None = None
    high: float | None = None
    reason: str | None = None


class ProblemData(Data):
    """A problem of the pack; its exact motion stands beside it."""

    format: Literal["dda-validation problem"] = "dda-validation problem"
    pack: Literal["3.1"] = PACK
    problem: str
    digest: str = Field(description="Of the data and the instants; another one is another question.")
    title: str
    asks: str
    block: BlockData | None
    contact: ContactData | None
    load: LoadData | None
    geometry: Literal["small", "large rotation"]
    column: ColumnData | None
    rigid: RigidData | None = None
    sampling: SamplingData
    answer: tuple[ColumnOfAnswer, ...]
    numbers: tuple[NumberData, ...] = Field((), description="What is measured on an answer of rigid boxes.")
    exact: str | None = Field(description="CSV file of the exact motion, beside this one's directory; null: none.")


class SubmissionData(Data):
    """What stands beside the table of a submission."""

    format: Literal["dda-validation submission"]
    pack: PackVersion
    problem: Text
    program: Text
    version: Text
    settings: Text = Field(description="Time step, integrator, contact model, damping: what another user would need.")
    who: Text
    not_reported: tuple[Text, ...] = Field((), description="Columns that the program cannot report.")


class AnswersData(Data):
    """What stands beside the tables of a folder of answers: one program, one version, one choice of settings.

    The table of a problem is `PROBLEM.csv`; a problem without a table is not answered.
    """

    format: Literal["dda-validation answers 1"]
    pack: PackVersion
    program: Text
    version: Text = Field(description="Of the program.")
    settings_name: Annotated[str, Field(max_length=60, pattern=r"^[a-z0-9][a-z0-9.+-]*$")] = Field(
        description="Name of the folder of these settings, such as default or fine-step."
    )
    settings: Text = Field(description="The settings in words: what another user would need to repeat them.")
    scheme: Text = Field(description="Time scheme, or event-driven.")
    step_s: Step | dict[str, Step] | None = Field(
        description="Time step of the program; an object where it differs by problem; null where there is none."
    )
    contact_model: Text = Field(description="Penalty springs, impulses, complementarity, ... and their parameters.")
    processor: Text
    who: Text
    licence: Text = Field(description="Of the answers, by which others may publish them, such as CC-BY-4.0.")
    link: Annotated[str, Field(max_length=2000, pattern=r"^https?://\S+$")] | None = Field(
        None, description="To the program or to the input files."
    )
    not_reported: dict[str, tuple[Text, ...]] = Field(
        {}, description="Columns that the program cannot report, by problem."
    )

    def step_of(self, problem: str) -> float | None:
        """Return the program's time step on a problem [s], None where it has none or states none."""
        return self.step_s.get(problem) if isinstance(self.step_s, dict) else self.step_s


def block_data(scene: Scene) -> BlockData:
    """Return the block of a scene."""
    (left, low), (right, high) = scene.block.outline[0], scene.block.outline[2]
    return BlockData.of(scene.block, width_m=right - left, height_m=high - low, thickness_m=1.0)


def contact_data(scene: Scene) -> ContactData:
    """Return the springs of a scene."""
    c = scene.contact
    return ContactData.of(c, normal_stiffness_N_per_m=c.stiffness, shear_stiffness_N_per_m=c.shear)


def load_data(scene: Scene) -> LoadData:
    """Return the loads of a scene."""
    return LoadData.of(scene.load)


def rigid_data(rigid: RigidSection) -> RigidData:
    """Return rigid boxes on a plane, each where it is at t = 0."""
    boxes = []
    for box, (x, y, angle) in zip(rigid.box, rigid.starts, strict=True):
        velocity_x, velocity_y = box.velocity
        boxes.append(
            BoxData.of(
                box,
                x_m=x,
                y_m=y,
                angle_rad=angle,
                velocity_x_m_per_s=velocity_x,
                velocity_y_m_per_s=velocity_y,
                spin_rad_per_s=box.spin,
            )
        )
    return RigidData.of(rigid, boxes=tuple(boxes))


def column_data(scene: Scene) -> ColumnData | None:
    """Return the column of a scene, if it has one.

    Raises
    ------
    InputError
        A record drives it, which plain data do not hold.
    """
    c = scene.column
    if c is None:
        return None
    contacts = []
    for contact in c.contacts:  # friction is the strength that it amounts to
        strength = None if math.isinf(contact.strength) else contact.strength
        contacts.append(ColumnContactData.of(contact, strength_Pa=strength))
    base = BaseData.of(c, kind=c.base, stiffness_Pa_per_m=c.base_stiffness)
    if c.base == "springs" and c.law != "bonded":  # springs that open or slip are the lowest of the contacts
        base = BaseData(kind="rigid", stiffness_Pa_per_m=None, impedance_Pa_s_per_m=None)
    drive = scene.stated_input
    if drive is not None and drive.shape is None:
        raise InputError(
            "must be a shape in a problem, whose data hold no record",
            source=scene.name,
            field="input.shape",
            value="a record",
        )
    return ColumnData.of(
        c,
        layers=tuple(map(LayerData.of, c.layer)),
        joints=tuple(map(JointData.of, c.joint)) if c.law == "bonded" else (),
        contacts=tuple(contacts),
        gravity_m_per_s2=c.gravity if c.law == "unilateral" else 0.0,
        base=base,
        input=None if drive is None else InputData.of(drive),
    )
