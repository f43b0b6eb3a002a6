"""The rows derived from histories of columns, and their gates."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from validation.engine.finished import Derived, Finished, derived_row
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.row import Metrics
from validation.scenes.scene import Scene, load_scene
from validation.solvers.columns.names import column_of
from validation.studies.waves.measure import Guide, joint_parts
from validation.suite.bands import about, cases, fitted_order, gate, near, short
from validation.theory import waves

EXACT = 1e-10  # of k: what a measured wavenumber must keep
JOINT = 1e-9  # of |T| and |R|
COLUMNS = ("displacement_1", "displacement_2", "displacement_3")
CONSTANT = (0.5, 1.0)
AVERAGE = (0.25, 0.5)
BLOCKS = {1.0e-3: (10,), 5.0e-4: (10,), 2.5e-4: (8, 10, 20), 1.0e-4: (40, 100)}  # a wavelength, by the time step
OTHERS = {"waves-glue": (10,), "waves-discount": (20,), "waves-shear": (10, 16)}
BASE = (8, 10, 20, 40)
JOINTS = (  # blocks a wavelength, c dt/h, scheme
    (10, 0.5, AVERAGE),
    (20, 0.5, AVERAGE),
    (40, 0.5, AVERAGE),
    (160, 0.5, AVERAGE),
    (10, 0.5, CONSTANT),
    (20, 0.25, CONSTANT),
    (40, 0.1, CONSTANT),
)


COUNTS = sorted({*itertools.chain(*BLOCKS.values(), *OTHERS.values(), BASE), *(blocks for blocks, *_ in JOINTS)})


def row_name(solver: str, blocks: int) -> str:
    """Return the name of the derived row of a wave."""
    return f"{solver} at {blocks} blocks"


@dataclass(frozen=True)
class Wave:
    """One frequency of one case."""

    scene: Scene
    blocks: int  # a wavelength of the continuum
    solver: str = "dda"

    @property
    def name(self) -> str:
        """Name of its derived row."""
        return row_name(self.solver, self.blocks)

    @property
    def guide(self) -> Guide:
        """Its closed forms."""
        return Guide.of(self.scene, self.blocks)

    def row(self, compute: Callable[[Wave, History], Metrics]) -> Derived:
        """Return the derived row that a function of wave and history computes."""
        return derived_row(
            self.scene.name, self.name, [self.scene], lambda _, history: compute(self, history), [self.solver]
        )


@functools.cache
def travelling() -> tuple[Wave, ...]:
    """Return the waves of measured speed and loss."""
    waves_measured = []
    for case in cases("waves-blocks"):
        waves_measured += [Wave(case, blocks) for blocks in BLOCKS[case.time.step]]
        if case.time.step == 5.0e-4:
            waves_measured.append(Wave(case, 10, "fem"))
    for scene, counts in OTHERS.items():
        for case in cases(scene):
            waves_measured += [Wave(case, blocks) for blocks in counts]
    return tuple(waves_measured)


def travelled(wave: Wave, history: History) -> Metrics:
    """Return the error of the phase speed, and the share left after ten wavelengths."""
    speed, remaining_share = wave.guide.speed_error_and_share(wave.guide.measured(history, COLUMNS))
    return {"wave.speed_error": speed, "wave.left": remaining_share}


def travelling_gates() -> Iterator[Gate]:
    """Yield two gates a wave."""
    speed_reason = "closed form of glued affine blocks at the squared frequency of the scheme; band: 1e-10 of k"
    loss_reason = "the same, over ten wavelengths: 1e-10 of k is 63e-10 of what is left"
    for wave in travelling():
        speed, remaining_share = wave.guide.speed_error_and_share(wave.guide.wavenumber)
        name = wave.scene.name, (wave.name,)
        yield Gate(*name, "wave.speed_error", *about(speed, 1.5 * EXACT), speed_reason)
        yield Gate(*name, "wave.left", *near(remaining_share, 20 * np.pi * EXACT), loss_reason)


# ---- joints ----


@functools.cache
def jointed() -> tuple[Wave, ...]:
    """Return the waves on a joint of kj = rho c w, with the scene of each."""
    scene = load_scene("waves-joint")
    joint_waves = []
    for blocks, courant, (alpha, delta) in JOINTS:
        guide = Guide.of(scene, blocks)
        step = courant * guide.column.height / guide.speed
        pulse = 0.4 * guide.omega / (2 * np.pi)
        values = {
            "column.joint": [{"height": 12.0, "stiffness": guide.impedance * guide.omega}],
            "input.frequency": pulse,
            "time.step": step,
            "time.steps": int((4 / pulse + echoes(blocks, delta)) / step),
            "time.alpha": alpha,
            "time.delta": delta,
        }
        kind = "average" if (alpha, delta) == AVERAGE else "constant"
        case = scene.with_values(values).model_copy(update={"name": f"waves-joint-{blocks}-{kind}"})
        joint_waves.append(Wave(case, blocks))
        if (blocks, kind) == (20, "average"):
            joint_waves.append(Wave(case, blocks, "fem"))
    return tuple(joint_waves)


def echoes(blocks: int, delta: float) -> float:
    """Return how long echoes between joint and top are awaited [s]: few blocks a wavelength leak slowly."""
    return 1.6 if blocks <= 20 and delta == 0.5 else 0.6


def parted(wave: Wave, history: History) -> Metrics:
    """Return |T|, |R| and the sum of their squares."""
    T, R = joint_parts(wave.guide, wave.scene, history)
    return {"joint.transmitted": abs(T), "joint.reflected": abs(R), "joint.energy": abs(T) ** 2 + abs(R) ** 2}


def joint_gates() -> Iterator[Gate]:
    """Yield the gates on every joint."""
    discrete = "closed form of a joint between two columns of welded blocks; band: 1e-9"
    energy = "average acceleration takes no energy: what is not transmitted is reflected; band: 1e-9"
    for wave in jointed():
        guide = wave.guide
        name = (wave.scene.name, (wave.name,))
        W2 = guide.stepping.squared_frequency(guide.omega)
        T, R = waves.joint_in_column(guide.column, W2, column_of(wave.scene).joint[0].stiffness)
        yield Gate(*name, "joint.transmitted", *about(float(abs(T)), JOINT), discrete)
        yield Gate(*name, "joint.reflected", *about(float(abs(R)), JOINT), discrete)
        if wave.scene.time.delta == 0.5:
            yield Gate(*name, "joint.energy", *about(1.0, JOINT), energy)


def joint_order(finished: Finished) -> Metrics:
    """Return the signed order in 1/N at which |T| tends to the continuum."""
    errors_by_blocks = []
    for wave in averaged():
        T, _ = joint_parts(wave.guide, wave.scene, finished.needed_history(wave.scene.name, wave.solver))
        errors_by_blocks.append((wave.blocks, abs(T) - float(waves.joint_transmission(1.0))))
    blocks, errors = np.array(errors_by_blocks).T
    if np.any(errors <= 0):
        return {"joint.order": "undefined"}
    return {"joint.order": -fitted_order(blocks, errors)}


def averaged() -> list[Wave]:
    """Return the joints of one Courant number by DDA under average acceleration."""
    return [w for w in jointed() if w.solver == "dda" and w.scene.time.delta == 0.5]


def order_gate() -> Gate:
    """Return the gate on the order."""
    why = "blocks are linear elements and the scheme is of second order: 2; a tenth for the next order"
    return gate(averaged()[-1].scene, "order", "joint.order", (1.9, 2.1), why)


# ---- transmitting base ----


@functools.cache
def returned() -> tuple[Wave, ...]:
    """Return the waves that come down on a transmitting base."""
    return tuple(itertools.starmap(Wave, itertools.product(cases("waves-base"), BASE)))


def sent_back(wave: Wave, history: History) -> Metrics:
    """Return |R| of the base."""
    up, down = wave.guide.parts(history, COLUMNS[:2], column_of(wave.scene).heights)
    return {"base.reflected": abs(up / down)}


def base_gates() -> Iterator[Gate]:
    """Yield a gate a wave."""
    why = "closed form of a dashpot under a column of welded blocks, of whose own impedance it is; band: 1e-9"
    for wave in returned():
        guide = wave.guide
        R = waves.base_reflection(guide.column, guide.stepping, guide.omega, column_of(wave.scene).impedance or 0.0)
        yield gate(wave.scene, wave.name, "base.reflected", about(float(abs(R)), JOINT), why)


# ---- what the page draws ----


def curves() -> dict[str, list[dict[str, object]]]:
    """Return the closed forms of welded blocks by scheme and c dt/h, over blocks a wavelength."""
    drawn = []
    blocks = np.geomspace(7.5, 110, 60)
    for case in cases("waves-blocks"):
        guide = Guide.of(case, 10)
        omega = 2 * np.pi * guide.speed / (blocks * guide.column.height)
        k = guide.column.wavenumber(guide.stepping.squared_frequency(omega))
        remaining_share = np.exp(-np.abs(k.imag) * 10 * blocks * guide.column.height)
        scheme = "(1/2, 1)" if (case.time.alpha, case.time.delta) == CONSTANT else "(1/4, 1/2)"
        series = {"speed": omega / k.real / guide.speed - 1, "left": remaining_share, "blocks": blocks}
        values = {name: short(part) for name, part in series.items()}
        courant = round(guide.speed * case.time.step / guide.column.height, 6)
        drawn.append({"scheme": scheme, "courant": courant, **values})
    return {"curves": drawn}
