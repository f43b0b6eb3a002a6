"""The paper's block unlocked: exact motions against an independent program's numbers, DDA and elements against them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping

from validation.engine.finished import Derived, from_history
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.row import Value
from validation.scenes.scene import Scene, load_scene
from validation.studies.bands import about, gate, order_row
from validation.studies.declaration import Study

NAME = "opening"
SCENE = "unlocked"
KINDS = ("block", "bar")
INSTANTS = (3, 6, 9)  # wave transits a / c
# p/E -> block, bar: displacement [m] and contact pressure [Pa] at these instants, as an independent program printed
# them (modes in 40 digits, and polynomials times exponentials in 80, each confirmed by an event-driven integrator).
KNOWN = {
    0.1: (
        ((-0.04033057058886, 3514046.36162), (-0.10229735564167, 9315343.22438), (-0.094205442534319, 8945681.08903)),
        ((-0.040434436128232, 3296799.53964), (-0.10289879033026, 9552769.44911), (-0.095775969499755, 8469680.76381)),
    ),
    1.0: (
        ((-0.019624767959151, 13384420.7848), (0.00031590245481852, 0.0), (-0.019792101285884, 12124063.0636)),
        ((-0.020823334904607, 9816843.61111), (0.00098044250944556, 0.0), (-0.02038367296426, 12103775.169)),
    ),
    10.0: (
        ((-0.0048476533988349, 0.0), (-0.0088697687782978, 18266488.6556), (-0.0010994013033985, 0.0)),
        ((-0.0069999546000701, 1e7), (-0.010989504433439, 9999983.32155), (-0.0010677245716886, 3.5e-6)),
    ),
    100.0: (
        ((-0.003068644722673, 23168703.7452), (-0.0093443226036173, 0.0), (-0.0028873908199839, 37093254.2842)),
        ((-0.0052, 1e7), (-0.0101, 1e7), (-0.0046, 0.0)),
    ),
}
SWITCHES = {  # p/E -> first opening and first closing after t = 0 of block and bar [s]; None where there is none
    0.1: ((None, 0.0032525750597312), (None, None)),
    1.0: ((0.016134552097502, 0.0032525750597312), (0.017964507628979, 0.021939461028721)),
    10.0: ((0.0047189535282337, 0.0032525750597312), (0.016553410872793, 0.017011534630142)),
    100.0: ((0.0036444191050135, 0.0032525750597312), (0.016443850139919, 0.016489662515654)),
}
SHORT = 6  # digits from which on a number of this program is rounded; one with fewer is exact
PRINTED = "an independent program; band: half a unit of its last digit, and 1e-12 of the value for rounding"


def cases() -> dict[float, Scene]:
    """Return the cases of the scene by p/E."""
    return {case.contact.stiffness / case.block.young: case for case in load_scene(SCENE).expand()}


BLOCK = ("dda", "block-events")
REFINED = {  # scene -> what converges to what, the step or mesh width that is refined, and the order
    "unlocked-constant": (BLOCK, "time.step", 1.0),
    "unlocked-average": (BLOCK, "time.step", 2.0),
    "unlocked-average-zero": (BLOCK, "time.step", 1.0),
    "unlocked-mesh": (("fem", "bar"), "fem.elements", -4.0),
}
NEXT = 0.1  # of an order: what the next order adds over four halvings, seen as the drift of the local orders
LEDGER = "unlocked-ledger"
MODEL_FORM = {  # p/E -> relative L2 of the exact block against the exact bar over 250 steps of 0.2 ms, as printed
    1.0: (0.182, 0.267),
    10.0: (0.200, 0.904),
    100.0: (0.321, 1.893),
}
SECOND_CODE = ((f"{LEDGER}[contact.stiffness=1e+09]", "fenicsx"),)


def derived() -> tuple[Derived, ...]:
    """Return the rows that are computed from finished cases."""
    pairs = itertools.product(cases().values(), KINDS)
    sampled = [from_history(case, f"{kind}-events", f"{kind} samples", samples) for case, kind in pairs]
    return (*sampled, *(order_row(name, solvers, key) for name, (solvers, key, _) in REFINED.items()))


def samples(case: Scene, history: History) -> Mapping[str, Value]:
    """Return displacement and contact pressure at the instants."""
    values: dict[str, Value] = {}
    for n in INSTANTS:
        values[f"displacement.{n}"] = float(history.displacement[n - 1])
        values[f"pressure.{n}"] = float(history.contact_pressure[n - 1])
    return values


def gates() -> tuple[Gate, ...]:
    """Return all gates of the study."""
    return (*value_gates(), *switch_gates(), *order_gates(), *form_gates())


def value_gates() -> Iterator[Gate]:
    """Yield the gates on displacement and contact pressure at the instants."""
    for ratio, case in cases().items():
        for kind, rows in zip(KINDS, KNOWN[ratio], strict=True):
            for n, (displacement, pressure) in zip(INSTANTS, rows, strict=True):
                yield _near(case, kind, f"displacement.{n}", displacement, 0.0)
                yield _near(case, kind, f"pressure.{n}", pressure, front(case))


def order_gates() -> Iterator[Gate]:
    """Yield the gates on the order of DDA in the step and of elements in the mesh, through openings and landings."""
    for name, (_, key, value) in REFINED.items():
        kind = "of the scheme in smooth motion" if key == "time.step" else "of quadratic elements, as errors over n"
        reason = f"order {value:g} {kind}, kept through switches; {NEXT:g} for the next order"
        yield gate(name, "order", "displacement", about(value, NEXT), reason)


def form_gates() -> Iterator[Gate]:
    """Yield the gates on the model form, exact in time: one strain against a wave."""
    why = "model form, physics: an independent program on the same instants, half a unit of its last digit"
    for case in load_scene(LEDGER).expand():
        printed = MODEL_FORM[case.contact.stiffness / case.block.young]
        for quantity, value in zip(("displacement", "pressure"), printed, strict=True):
            edges = about(value, 5e-4)
            yield gate(case, ("block-events", "bar-events"), f"{quantity}.l2", edges, why, "other code", 5e-4)


def _near(case: Scene, kind: str, metric: str, value: float, least: float) -> Gate:
    half = half_unit(value) + 1e-12 * abs(value) + least
    reason = PRINTED + (", and the ulp of the instant at a front" if least else "")
    return gate(case, f"{kind} samples", metric, about(value, half), reason, "other code", half_unit(value))


def half_unit(value: float) -> float:
    """Return half a unit of the last digit of a number as it is printed, 0 for one that is exact."""
    mantissa, _, exponent = repr(value).partition("e")
    digits = mantissa.partition(".")[2].rstrip("0")
    rounded = len(mantissa.replace(".", "").strip("-0")) >= SHORT or bool(exponent)
    return 0.5 * 10.0 ** (int(exponent or 0) - len(digits)) if digits and rounded else 0.0


def front(case: Scene) -> float:
    """Return the pressure that a front can bring in a few ulps of the last instant [Pa].

    The contact pressure changes by at most 2 q in a time 1 / kappa, kappa = 2 p / (a rho c) [1/s].
    """
    b = case.block
    kappa = 2 * case.contact.stiffness / (b.base_length * math.sqrt(b.young * b.density))
    return 4 * math.ulp(case.time.duration) * 2 * case.load.pressure * kappa


def switch_gates() -> Iterator[Gate]:
    """Yield the gates on the first opening and closing."""
    for ratio, case in cases().items():
        for kind, times in zip(KINDS, SWITCHES[ratio], strict=True):
            for part, value in zip(("first_opening", "first_closing"), times, strict=True):
                if value is not None and value < case.time.duration:
                    half = half_unit(value) + 1e-12 * value
                    edges = about(value, half)
                    yield gate(case, f"{kind}-events", f"switches.{part}", edges, PRINTED, "other code")


OPENING = Study(
    NAME,
    "Contact that opens: exact motions of the block and of the bar",
    "The same block on springs that carry no tension: when it leaves the ground, when it lands, and what it carries.",
    [SCENE, *REFINED, LEDGER],
    extra=SECOND_CODE,
    gates=gates,
    derived=derived,
)
