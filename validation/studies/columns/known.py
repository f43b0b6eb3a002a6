"""Numbers of an independent program on columns whose contacts open or slip, as it printed them.

Blocks of one strain and rigid ones: Taylor series from switch to switch in 18 and in 30 digits, which agree to 1e-14
and better, confirmed by an event-driven integrator. Elastic bars: waves as polynomials times exponentials in 30 digits,
confirmed on a grid of characteristics.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Sample:
    """A column of a history at an instant."""

    scene: str
    solver: str
    column: str
    time: float  # [s]
    printed: str

    @property
    def value(self) -> float:
        """The number."""
        return float(self.printed)

    @property
    def half(self) -> float:
        """Half a unit of its last digit."""
        return half_unit(self.printed)


def half_unit(printed: str) -> float:
    """Return half a unit of the last digit of a number as it was printed."""
    digits, _, exponent = printed.lower().partition("e")
    return 0.5 * 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


def _samples(scene: str, solver: str, table: dict[float, dict[str, str]]) -> tuple[Sample, ...]:
    return tuple(
        Sample(scene, solver, f"{part}_{number}", time, printed)
        for time, parts in table.items()
        for part, numbers in parts.items()
        for number, printed in enumerate(numbers.split(), start=FIRST.get((scene, part), 1))
        if printed != "-"
    )


def ends(first: str, last: str) -> str:
    """Return the numbers of the first and the last of ten blocks or contacts."""
    return f"{first} {'- ' * 8}{last}"


# number of the first height of a scene whose force or slip is asked for: those of the blocks' middles come before
FIRST = {
    ("columns-drop-average", "force"): 6,
    ("columns-spall", "force"): 7,
    ("columns-weight", "force"): 11,
    ("columns-slips", "slip"): 3,
}
FINEST_DROP = "columns-drop-average[time.step=1e-05,time.steps=6000]"
FIRST[FINEST_DROP, "force"] = 6
EVENTS = "column-events"
BARS = "bars-events"
KNOWN: tuple[Sample, ...] = (
    *_samples(
        FINEST_DROP,
        EVENTS,
        {
            0.02: {
                "displacement": "-0.006606810475848 -0.008730975115492 -0.01023208826467 -0.01122366725667 "
                "-0.009448880020396",
                "force": "1606810.4758 1624164.6396 1001113.1492 491578.992",
            },
            0.04: {
                "displacement": "0.003189275887008 0.007476548946043 0.008767879795189 0.009669892357534 "
                "0.01705025512655"
            },
            0.06: {
                "displacement": "0.01074499902223 0.02156223743775 0.02493494560588 0.02665347708404 0.03962539027349"
            },
        },
    ),
    *_samples(
        "columns-spall",
        EVENTS,
        {
            0.01: {
                "displacement": "-0.0009942924468433 -0.002645196854866 -0.003649613067974 -0.00387598727646 "
                "-0.003721306803229 -0.003449320491917",
            },
            0.04: {
                "displacement": "0.00073232606541 0.00114052031804 0.00186496311179 0.00387759340405 0.01613556129194 "
                "0.02719081538383"
            },
        },
    ),
    *_samples(
        "columns-mass-ratio",
        EVENTS,
        {
            0.0105: {"displacement": "-0.005829582303792 -0.01082302026376"},
            0.02: {"displacement": "-0.01017872297875 -0.01994421045988"},
            0.03: {"displacement": "-0.01331442988 -0.02701654185475"},
        },
    ),
    *_samples(
        "columns-weight",
        EVENTS,
        {
            0.05: {
                "displacement": ends("-0.000241885998784", "-0.001340727532211"),
                "force": ends("241885.99878", "30913.124007"),
            },
            0.1: {
                "displacement": ends("-0.0004361966268446", "-0.002651420005761"),
                "force": ends("436196.62684", "51758.332095"),
            },
            0.2: {"displacement": ends("-0.00010796642793093", "0.00013837720125446")},
        },
    ),
    *_samples(
        "columns-shaken",
        EVENTS,
        {
            0.3: {"displacement": "0.05489230636082 0.05517145506688 0.05536737399945"},
            0.5: {"displacement": "0.04973820725492 0.05544569721784 0.05908339707847"},
            0.65: {"displacement": "-0.08370234214322 -0.09190361830169 -0.09208629666771"},
        },
    ),
    *_samples(
        "columns-slips",
        EVENTS,
        {
            0.1: {"displacement": "0.03781031680479 0.008360405802803"},
            0.4: {
                "displacement": "0.03817432077212 0.006960094591269",
                "slip": "-0.0239896443309 -0.00226009928592 -0.00115601241612 -0.00145104920254 -0.00239640243354",
            },
        },
    ),
    *_samples("columns-joints", BARS, {8.5: {"slip": "-0.21325709881936 -0.13408109261095 -0.37257488314931"}}),
)
# Final velocities of the six pieces of a spall: bars, and blocks of one strain exact in time [m/s]
BAR_PIECES = (0.000920591085702, 0.00151467684352, 0.00216542188847, 0.00292596405491, 0.116243920874, 1.95596132875)
BLOCK_PIECES = (0.0090, -0.0566, 0.0307, 0.3349, 0.8965, 1.5575)
# Final velocities of the four bars of a cradle [m/s]
CRADLE_BARS = (-0.0088908684872307, -0.006232130608299, 0.022724961596268, 0.99239803749926)
# Transmitted, reflected and absorbed parts of a sine at a rigid joint, by its strength over the stress of the wave
SLIPPING_JOINT = {
    0.1: (0.13838468871016, 0.87460131786345, 0.46467430822255),
    0.25: (0.33414439944606, 0.69406610969687, 0.637667433455),
    0.5: (0.62530170234517, 0.41594068912203, 0.66029623971133),
    0.75: (0.86122010225599, 0.17403243996044, 0.47750669661441),
    0.9: (0.96347064858805, 0.055207224415643, 0.26206196153131),
}
# Mean solves of the open-close iteration a step, by delta: w dt = 0.1, 0.5, 2 and 10
# (of the stack that comes to rest without damping alone: the others depend on how long it is run)
RESTING_SOLVES = {0.5: (1.166, 1.588, 2.118, 3.009)}
SHAKEN_SOLVES = {0.5: (1.156, 1.554, 2.033, 2.905), 1.0: (1.134, 1.319, 1.665, 2.803)}
# Residual slips of the lowest and the highest joint [m], as printed, by alpha, delta, gg and time step
RESIDUAL_SLIPS = {
    (0.5, 1.0, 1.0, 0.001): ("-23.765e-3", "-1.320e-3"),
    (0.5, 1.0, 1.0, 0.005): ("-22.386e-3", "2.107e-3"),
    (0.25, 0.5, 0.98, 0.001): ("-24.06e-3", "-1.71e-3"),
    (0.25, 0.5, 0.98, 0.0001): ("-17.92e-3", "-0.013e-3"),
}
# Seconds after which a stack of ten rests to a thousandth, by alpha, delta, gg and time step
SETTLED = {
    (0.5, 1.0, 1.0, 0.001): 3.097,
    (0.5, 1.0, 1.0, 0.005): 0.650,
    (0.5, 1.0, 1.0, 0.02): 0.260,
    (0.25, 0.5, 0.98, 0.001): 0.674,
    (0.25, 0.5, 0.98, 0.0002): 0.135,
}
