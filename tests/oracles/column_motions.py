"""Columns whose contacts open or slip, with numbers of an independent program as it printed them.

Taylor series with polynomial roots in 18 and in 30 digits, which agree to 1e-16, confirmed by DOP853 restarted at its
events. A switch is "joint kind time", the kind O (opens), C (closes), + or - (slips), K (sticks again).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from decimal import Decimal

from fem_reference.events import column_drive as drives
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnProblem

RIGID = math.inf


@dataclass(frozen=True)
class KnownColumn:
    """A column and what is known of its motion."""

    problem: ColumnProblem
    end: float  # [s]
    switches: str  # the first ones
    count: int | None = None  # of all switches
    last: str = ""  # the last ones
    # instant, what of the history, then a number for each block (joint), "-" where none was printed
    values: tuple[tuple[float, str, str], ...] = field(default=())


def blocks(count, density, modulus, velocity=0.0, height=1.0):
    """Equal blocks."""
    return (ColumnBlock(height, density, modulus, velocity),) * count


def kind_of(kind, sign):
    """The letter of a switch."""
    return {"opens": "O", "closes": "C", "sticks": "K", "slips": "+" if sign > 0 else "-"}[kind]


def half_unit(printed):
    """Half a unit of the last printed digit."""
    number = Decimal(printed)
    return Decimal(1).scaleb(number.as_tuple().exponent) / 2


def strengths(weights, degrees):
    """Friction times the static normal stress."""
    return [math.tan(math.radians(degrees)) * weight for weight in weights]


SHAKING = 4 * math.pi
AMPLITUDE = 1.5 * 9.81 / SHAKING**2
LATER_SPEED = 0.004 * 10 * math.pi
ABOVE = [2 * 2000 * 9.81 * (6 - j) for j in range(6)]
CRADLE_END = "-0.1322794847097 -0.07532916980257 -0.03101082901403 0.2962177501414 0.9424017333849"

COLUMNS = {
    "A1": KnownColumn(
        ColumnProblem(blocks(2, 2500, 1e9, -1.0), (ColumnJoint(2e9, 0.01), ColumnJoint(1e9, 0.001)), gravity=9.81),
        0.06,
        "0C 0.009552424562332, 1C 0.01213613824065, 0O 0.01362021850623, 0C 0.0139260896418, 1O 0.01689623611225, "
        "1C 0.01910311441025, 0O 0.01939531236661, 1O 0.02003160953006, 1C 0.02134798051768, 1O 0.02268678854268, "
        "1C 0.02410776688888, 1O 0.0249211224511",
        12,
        values=(
            (0.015, "displacement", "-0.01071826096353 -0.01441536573354"),
            (0.015, "force", "607710.89238 1792617.0609"),
            (0.025, "displacement", "-0.004039667819667 -0.004743589124096"),
            (0.04, "displacement", "0.008074626541482 0.01092205296678"),
            (0.04, "velocity", "0.7340446240766 0.970801139392"),
        ),
    ),
    "A2": KnownColumn(
        ColumnProblem(
            blocks(5, 2500, RIGID, -1.0),
            (ColumnJoint(1e9, 0.005), *[ColumnJoint(1e9, 0.0005)] * 4),
            gravity=9.81,
        ),
        0.06,
        "0C 0.004883044570423, 1C 0.006857923489238, 2C 0.008876381084515, 3C 0.01084629414441, 4C 0.01278339325187, "
        "4O 0.01740307824917, 3O 0.02067044617663, 2O 0.02368107222053, 0O 0.02508510927488, 1O 0.02533752386824",
        10,
        values=(
            (
                0.02,
                "displacement",
                "-0.006606810475848 -0.008730975115492 -0.01023208826467 -0.01122366725667 -0.009448880020396",
            ),
            (0.02, "force", "1606810.4758 1624164.6396 1001113.1492 491578.992 0"),
            (
                0.04,
                "displacement",
                "0.003189275887008 0.007476548946043 0.008767879795189 0.009669892357534 0.01705025512655",
            ),
            (
                0.06,
                "displacement",
                "0.01074499902223 0.02156223743775 0.02493494560588 0.02665347708404 0.03962539027349",
            ),
            (0.06, "velocity", "0.279686156761 0.6061844245853 0.7102532905343 0.7510792363255 1.030656757347"),
        ),
    ),
    "A3": KnownColumn(
        ColumnProblem(
            blocks(6, 2500, 1e9),
            (ColumnJoint(1e10),) * 6,
            gravity=9.81,
            at_rest=True,
            pressure=drives.half_sine(2e6, 0.004),
        ),
        0.04,
        "5O 0.0002356577374692, 5C 0.001963257273858, 4O 0.002101816727392, 4C 0.003543880594322, "
        "3O 0.003705444055875, 5O 0.004934391660548, 3C 0.005079443759941, 2O 0.005230681676214, 5C 0.00584414615268, "
        "5O 0.006323996177477, 4O 0.006491047653762, 2C 0.006682221287495, 1O 0.006832813300186, 4C 0.007245716826514, "
        "4O 0.007852924498749, 0O 0.008085842110748, 1C 0.008203765255586, 3O 0.008264767995048, 3C 0.008442601526942, "
        "3O 0.009204422046507, 2O 0.009818823201604, 0C 0.009881662575385",
        106,
        values=(
            (
                0.01,
                "displacement",
                "-0.0009942924468433 -0.002645196854866 -0.003649613067974 -0.00387598727646 -0.003721306803229 "
                "-0.003449320491917",
            ),
            (0.01, "force", "1663076.7652 2019967.5251 0 0 0 0"),
            (
                0.025,
                "displacement",
                # the second was printed ...714: 0.56 of its last digit above, within its program's bracket (2e-14)
                "0.00059856017372 0.00052609524713 0.00048153835611 0.00110723458103 0.00356550526092 0.00536527018712",
            ),
            (
                0.04,
                "displacement",
                "0.00073232606541 0.00114052031804 0.00186496311179 0.00387759340405 0.01613556129194 0.02719081538383",
            ),
        ),
    ),
    "A4": KnownColumn(
        ColumnProblem(
            (ColumnBlock(0.1, 2500, RIGID, -1.0), ColumnBlock(10.0, 25000, RIGID, -1.0)),
            (ColumnJoint(1e9, 0.001),) * 2,
            gravity=9.81,
        ),
        0.03,
        "0C 0.0009951425359887, 1C 0.002265091570402, 0O 0.002629640866531, 0C 0.002955660086226",
        4,
        values=(
            (0.0105, "displacement", "-0.005829582303792 -0.01082302026376"),
            (0.0105, "force", "4829582.3038 3993437.96"),
            (0.02, "displacement", "-0.01017872297875 -0.01994421045988"),
            (0.03, "displacement", "-0.01331442988 -0.02701654185475"),
            (0.03, "velocity", "-1.564685134011 -0.5262339909032"),
        ),
    ),
    "A5": KnownColumn(
        ColumnProblem(blocks(10, 2500, RIGID), (ColumnJoint(1e9),) * 10, gravity=9.81),
        0.2,
        "9O 0.05339434671512, 8O 0.05387135665277, 6O 0.05915943443432, 7O 0.05966301671615, 6C 0.06075198395203, "
        "4O 0.06206197120647, 4C 0.06329919894969, 5O 0.06411337910225, 6O 0.06526288831454, 5C 0.06594985494307, "
        "5O 0.07033835067855, 5C 0.07197349461669, 6C 0.07538356090808, 7C 0.07922164835533, 8C 0.08153822913336, "
        "9C 0.08679082038293",
        59,  # "62" beside the numbers, which cannot be: all joints close at 0, and three of them are open at the end
        values=(
            (0.05, "force", "241885.99878 - - - - - - - - 30913.124007"),
            (0.05, "displacement", "-0.000241885998784 - - - - - - - - -0.001340727532211"),
            (0.1, "force", "436196.62684 - - - - - - - - 51758.332095"),
            (0.1, "displacement", "-0.0004361966268446 - - - - - - - - -0.002651420005761"),
            (0.2, "displacement", "-0.00010796642793093 - - - - - - - - 0.00013837720125446"),
        ),
    ),
    "A6": KnownColumn(
        ColumnProblem(
            blocks(3, 2500, 1e8, -AMPLITUDE * SHAKING),
            (ColumnJoint(1e8),) * 3,
            gravity=9.81,
            at_rest=True,
            base_motion=drives.integrated(drives.sine(-AMPLITUDE * SHAKING, 2.0, quarters=1)),
        ),
        1.0,
        "2O 0.2884185916487, 1O 0.2894973943897, 0O 0.2919232407186, 0C 0.5926076180049, 1C 0.6041640489858, "
        "2C 0.6132101526336, 2O 0.6270768666076, 2C 0.6356419391684, 1O 0.6369921492983, 1C 0.6431566021454, "
        "0O 0.6460171130559, 2O 0.6472330680538",
        37,
        values=(
            (0.3, "displacement", "0.05489230636082 0.05517145506688 0.05536737399945"),
            (0.5, "displacement", "0.04973820725492 0.05544569721784 0.05908339707847"),
            (0.65, "displacement", "-0.08370234214322 -0.09190361830169 -0.09208629666771"),
            (0.65, "force", "0 559046.37873 0"),
        ),
    ),
    "A7": KnownColumn(
        ColumnProblem(
            (*blocks(1, 2500, RIGID, 1.0), *blocks(4, 2500, RIGID)), (None, *[ColumnJoint(1e9)] * 4), base="free"
        ),
        0.02,
        "1O 0.004060065864752, 2O 0.006300859180211, 3O 0.008139563797189, 4O 0.00898524933539",
        4,
        values=((0.01, "velocity", CRADLE_END),),
    ),
    "A8": KnownColumn(
        ColumnProblem(
            (
                ColumnBlock(0.5, 2600, 3e9, -2.0),
                ColumnBlock(1.0, 2400, 1e9, -2.0),
                ColumnBlock(2.0, 2000, 5e8, -2.0),
                ColumnBlock(0.8, 2700, 2e9, -2.0),
            ),
            (ColumnJoint(4e9, 0.002), ColumnJoint(2e9, 0.0003), ColumnJoint(1e9, 0.0002), ColumnJoint(3e9, 0.0001)),
            gravity=9.81,
        ),
        0.05,
        "0C 0.0009975594562593, 1C 0.001826204217584, 2C 0.00381590369528, 0O 0.006220918214768, 0C 0.007081418445442, "
        "1O 0.007702490890077, 1C 0.007935379758382, 3C 0.007964603724338, 0O 0.00915550614946, 0C 0.009420049138802",
        30,
        "3O 0.02267188037109, 1O 0.02295473394711",
        values=(
            (0.05, "displacement", "0.01648849799093 0.03774289485277 0.05575324838637 0.07643618678455"),
            (0.05, "velocity", "0.3657343078984 1.15723170612 1.688731180854 2.469539064854"),
        ),
    ),
    "S1": KnownColumn(
        ColumnProblem(
            blocks(6, 2000, 2e8, height=2.0),
            (None, *[ColumnJoint(1e9, strength=s) for s in strengths(ABOVE[1:], 30.0)]),
            law="frictional",
            base="transmitting",
            impedance=2200 * 600.0,
            base_motion=drives.integrated(drives.half_sine(0.6, 0.05)),
        ),
        0.4,
        "1- 0.01008000877453, 2- 0.0158570463041, 5- 0.01748918365745, 5K 0.0178435100858, 3- 0.02112535842778, "
        "5+ 0.02326306765855, 4- 0.02459462616486, 5K 0.02790408786709, 5- 0.02942449122, 1K 0.04703261624849, "
        "2K 0.05473642572922",
        32,
        "5+ 0.1177030476501, 5K 0.1229828824992",
        values=(
            (
                0.1,
                "displacement",
                "0.03781031680479 0.01452090984371 0.01294699406085 0.01242841782965 0.01114072186316 "
                "0.008360405802803",
            ),
            (
                0.4,
                "displacement",
                "0.03817432077212 0.01419732135455 0.01194783587378 0.01080085289231 0.009353967732387 "
                "0.006960094591269",
            ),
            (
                0.4,
                "slip",
                "- -0.0239896443309 -0.00226009928592 -0.00115601241612 -0.00145104920254 -0.00239640243354",
            ),
        ),
    ),
    "S2": KnownColumn(
        ColumnProblem(
            blocks(6, 2000, 2e8, height=2.0),
            (
                None,
                ColumnJoint(1e10),
                ColumnJoint(1e10),
                ColumnJoint(1e9, strength=1e5),
                ColumnJoint(1e10),
                ColumnJoint(1e10),
            ),
            law="frictional",
            base="transmitting",
            impedance=2000 * math.sqrt(1e5),
            base_motion=drives.integrated(drives.half_sine(0.5, 0.05)),
        ),
        0.4,
        "3- 0.02400486368064, 3K 0.0595538645585, 3+ 0.06994991042837, 3K 0.07638813009495, 3+ 0.08563241378001, "
        "3K 0.09761025584141, 3+ 0.1013776817487, 3K 0.1024250411144",
        8,
        values=(
            (0.05, "displacement", "0.01720274822009 - - - - 0.002934989773856"),
            (0.4, "slip", "- - - -0.0150593288608 - -"),
        ),
    ),
    "S3": KnownColumn(
        ColumnProblem(
            blocks(4, 2500, RIGID, LATER_SPEED),
            tuple(ColumnJoint(5e8, strength=s) for s in (3e4, 2e4, 1.2e4, 5e3)),
            law="frictional",
            base_motion=drives.integrated(drives.sine(LATER_SPEED, 5.0, quarters=1)),
        ),
        0.5,
        "3+ 0.01811786308784, 2+ 0.01998144845654, 1+ 0.02118283035453, 0+ 0.02299005784232, 0K 0.02538930044859, "
        "0+ 0.03631738370039, 0K 0.05534324440138, 1K 0.09291778568577, 2K 0.1051054000787, 3K 0.1235194159938, "
        "3- 0.1263695182999",
        46,
        values=(
            (0.1, "slip", "2.04290562138e-5 0.00098223938151 0.00137624922616 0.00271358302747"),
            (0.25, "displacement", "0.00409179201875 0.004223236721786 0.004481946923429 0.00553559592065"),
        ),
    ),
}
