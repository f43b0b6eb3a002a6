"""Problems and submissions as plain data: JSON whose names carry the units, checked with pydantic."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.scenes.scene import Scene

PACK = "2.0"
"""Version of the pack; another one is refused. It changes with any problem's data."""
PROBLEM, SUBMISSION = "dda-validation problem", "dda-validation submission"
UNITS = {DISPLACEMENT: "m", "horizontal_displacement": "m", "rotation": "rad", PRESSURE: "Pa", "stress": "Pa"}
MEANINGS = {
    DISPLACEMENT: "vertical displacement of the centroid, upwards positive",
    "horizontal_displacement": "horizontal displacement of the centroid, towards +x, which is down a slope",
    "rotation": "rotation since t = 0, counter-clockwise positive",
    PRESSURE: "sum of the normal forces of the springs over the length of the base, compression positive",
    "stress": "stress at the {n}. of the heights, compression positive",
}
AT_HEIGHT = "displacement at the {n}. of the heights, upwards positive (of shear: across the column)"
Text = Annotated[str, Field(min_length=1, max_length=2000, pattern=r"\S")]


def unit(column: str) -> str:
    """Return the unit of a history's column."""
    return UNITS[kind(column)[0]]


def united(column: str) -> str:
    """Return a history's column as the pack names it, with its unit."""
    return f"{column}_{unit(column)}"


def kind(column: str) -> tuple[str, str]:
    """Return what a column is of, and the number of its height or nothing."""
    plain, _, number = column.rpartition("_")
    return (plain, number) if number.isdigit() else (column, "")


def meaning(column: str) -> str:
    """Return what a column means."""
    plain, number = kind(column)
    return (AT_HEIGHT if number and plain == DISPLACEMENT else MEANINGS[plain]).format(n=number)


class Data(BaseModel):
    """Plain data: immutable, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


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
    young_Pa: float
    poisson: float


class JointData(Data):
    """A spring across a column."""

    height_m: float
    stiffness_Pa_per_m: float


class BaseData(Data):
    """What a column stands on."""

    kind: Literal["rigid", "springs", "transmitting"]
    stiffness_Pa_per_m: float | None
    impedance_Pa_s_per_m: float | None = Field(description="Of the half-space below, density times wave speed.")


class InputData(Data):
    """What drives a column: a pulse."""

    at: Literal["base", "top"]
    shape: Literal["ricker", "half-sine"]
    velocity_m_per_s: float | None
    pressure_Pa: float | None
    frequency_Hz: float | None = Field(description="Of a Ricker pulse; its middle comes at 2 / frequency.")
    duration_s: float | None


class ColumnData(Data):
    """A column of layers from the base upwards, everything per unit of area; nothing strains sideways."""

    motion: Literal["pressure", "shear"]
    layers: tuple[LayerData, ...]
    joints: tuple[JointData, ...]
    base: BaseData
    heights_m: tuple[float, ...] = Field(description="Above the base, where displacements are asked for.")
    input: InputData


class SamplingData(Data):
    """The instants of an answer: step, 2 step, ... up to the last one; no program has to step so."""

    step_s: float
    count: int


class ColumnOfAnswer(Data):
    """A column that an answer holds, and the band of its error."""

    name: str
    meaning: str
    measure: str
    until_s: float
    low: float
    high: float
    reason: str


class ProblemData(Data):
    """A problem of the pack; its exact motion stands beside it."""

    format: Literal["dda-validation problem"] = "dda-validation problem"
    pack: Literal["2.0"] = "2.0"
    problem: str
    title: str
    asks: str
    block: BlockData | None
    contact: ContactData | None
    load: LoadData | None
    geometry: Literal["small", "large rotation"]
    column: ColumnData | None
    sampling: SamplingData
    answer: tuple[ColumnOfAnswer, ...]
    exact: str = Field(description="CSV file of the exact motion, beside this one's directory.")


class SubmissionData(Data):
    """What stands beside the table of a submission."""

    format: Literal["dda-validation submission"]
    pack: Literal["2.0"]
    problem: Text
    program: Text
    version: Text
    settings: Text = Field(description="Time step, integrator, contact model, damping: what another user would need.")
    who: Text
    not_reported: tuple[Text, ...] = Field((), description="Columns that the program cannot report.")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if len(set(self.not_reported)) < len(self.not_reported):
            raise ValueError(f"not_reported must not repeat a column, got {list(self.not_reported)}")
        return self


def block_data(scene: Scene) -> BlockData:
    """Return the block of a scene."""
    b = scene.block
    (left, low), (right, high) = b.outline[0], b.outline[2]
    return BlockData(
        width_m=right - left,
        height_m=high - low,
        density_kg_per_m3=b.density,
        young_Pa=b.young,
        poisson=b.poisson,
        hypothesis=b.hypothesis,
        velocity_m_per_s=b.velocity,
        tilt_deg=b.tilt,
    )


def contact_data(scene: Scene) -> ContactData:
    """Return the springs of a scene."""
    c = scene.contact
    return ContactData(
        law=c.law,
        normal_stiffness_N_per_m=c.stiffness,
        shear_stiffness_N_per_m=c.shear,
        friction_deg=c.friction,
        cohesion_Pa=c.cohesion,
        gap_m=c.gap,
    )


def load_data(scene: Scene) -> LoadData:
    """Return the loads of a scene."""
    q = scene.load
    return LoadData(
        pressure_Pa=q.pressure,
        eccentricity_m=q.eccentricity,
        traction_Pa=q.traction,
        gravity_m_per_s2=q.gravity,
        slope_deg=q.slope,
    )


def column_data(scene: Scene) -> ColumnData | None:
    """Return the column of a scene, if it has one."""
    c = scene.column
    if c is None:
        return None
    if c.law != "bonded" or c.base == "free":
        raise InputError("must be bonded in a problem", source=scene.name, field="column.law", value=repr(c.law))
    layers = [
        LayerData(thickness_m=one.thickness, density_kg_per_m3=one.density, young_Pa=one.young, poisson=one.poisson)
        for one in c.layer
    ]
    joints = [JointData(height_m=joint.height, stiffness_Pa_per_m=joint.stiffness) for joint in c.joint]
    base = BaseData(kind=c.base, stiffness_Pa_per_m=c.base_stiffness, impedance_Pa_s_per_m=c.impedance)
    return ColumnData(
        motion=c.motion,
        layers=tuple(layers),
        joints=tuple(joints),
        base=base,
        heights_m=c.heights,
        input=_input_data(scene),
    )


def _input_data(scene: Scene) -> InputData:
    """Return the pulse of a scene.

    Raises
    ------
    InputError
        A record drives it, which plain data do not hold.
    """
    drive = scene.input
    if drive.shape not in ("ricker", "half-sine"):
        raise InputError(
            "must be a Ricker pulse or a half-sine in a problem",
            source=scene.name,
            field="input.shape",
            value=drive.shape or "a record",
        )
    return InputData(
        at=drive.at,
        shape=drive.shape,
        velocity_m_per_s=drive.velocity,
        pressure_Pa=drive.pressure,
        frequency_Hz=drive.frequency,
        duration_s=drive.duration,
    )
