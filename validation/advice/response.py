"""Frequency responses of scenes: what a solver answers to a load that vibrates, without running a step."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.advice.spectra import checked
from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, ArrayPair, Complex
from validation.runs.threads import one_thread
from validation.scenes import features
from validation.scenes.keys import is_fulfilled
from validation.scenes.scene import Scene
from validation.solvers.contract import NotReported, Solver

ROUNDING = 1e-12  # of an amplitude that is real
POINTS_A_ZOOM = 17  # in the range in which a peak is followed, which is then an eighth
NARROW = 1e-9  # width of that range over frequency in the end: a bounded peak then has all digits that are printed
GROWTH = 100.0  # of a pole's amplitude meanwhile, at least; that of a bounded peak is within the first range
SAME = 1e-6  # of frequencies that two brackets have led to
HEADER = ("frequency", DISPLACEMENT, f"{DISPLACEMENT}_phase", PRESSURE, f"{PRESSURE}_phase")  # Hz, m, rad, Pa, rad


Answer = Callable[[Array], Mapping[str, Complex]]


class Peak(NamedTuple):
    """A peak of an amplitude over frequency."""

    frequency: float  # [Hz]
    amplitude: float  # [m, Pa, or those per m], infinite where nothing damps the vibration

    @property
    def is_bounded(self) -> bool:
        """Whether something damps the vibration."""
        return math.isfinite(self.amplitude)


@dataclass(frozen=True)
class Response:
    """What is left of a motion when transients have gone: Re(amplitude e^{2 pi i f t}).

    Under the scene's loads the amplitudes are in m and Pa. Where the base moves they are those of its motion alone,
    per metre of its displacement: 1 and Pa/m.
    """

    scene: str
    solver: str
    exact: bool  # exact in time, else as the scene's scheme steps it
    base: bool  # per metre of base motion, else under the scene's loads
    frequency: Array  # f [Hz]
    columns: Mapping[str, Complex]  # complex amplitude of each column
    answer: Answer = field(repr=False, compare=False)  # the same columns at other frequencies

    @property
    def displacement(self) -> Complex:
        """Complex amplitude of the displacement [m, or m per m]."""
        return self.columns[DISPLACEMENT]

    @property
    def contact_pressure(self) -> Complex:
        """Complex amplitude of the contact pressure [Pa, or Pa per m]."""
        return self.columns[PRESSURE]

    def table(self) -> Array:
        """Return the columns of `HEADER`: frequency, and amplitude and phase of each column, one row a frequency."""
        return np.column_stack([self.frequency, *polar(self.displacement), *polar(self.contact_pressure)])

    def peaks(self, column: str) -> list[Peak]:
        """Return the peaks inside the range, unbounded ones first by frequency, then the others from the highest down.

        The listed frequencies only bracket them: each is followed between them until frequency and amplitude are those
        of the model. Where nothing damps a vibration that the load reaches, the amplitude passes from one infinity to
        the other at its natural frequency.
        """
        values = self.columns[column]
        size = np.abs(values)
        # without damping a change of sign may hide a resonance of which neither end is a maximum
        is_pole = _are_real(values[:-1]) & _are_real(values[1:]) & (values.real[:-1] * values.real[1:] < 0)
        local = 1 + np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:]))
        brackets = [*zip(local - 1, local + 1, strict=True), *((i, i + 1) for i in np.flatnonzero(is_pole))]
        peaks: list[Peak] = []
        for low, high in brackets:
            peak = self._follow(column, float(self.frequency[low]), float(self.frequency[high]))
            if peak is not None and not any(math.isclose(peak[0], other[0], rel_tol=SAME) for other in peaks):
                peaks.append(peak)
        return sorted(peaks, key=lambda peak: (peak.is_bounded, -peak.amplitude if peak.is_bounded else peak.frequency))

    def _follow(self, column: str, low: float, high: float) -> Peak | None:
        """Return the peak between two frequencies; None where the amplitude is highest at an end."""
        ends = (low, high)
        sizes = []
        while True:
            frequency = np.linspace(low, high, POINTS_A_ZOOM)
            values = self.answer(frequency)[column]
            size = np.where(np.isfinite(values), np.abs(values), np.inf)
            highest = int(np.argmax(size))
            sizes.append(float(size[highest]))
            if len(sizes) == 1:
                undamped = np.mean(_are_real(values)) > 0.5  # next to a pole the imaginary rounding grows too
            beside = slice(max(highest - 1, 0), highest + 2)
            low, high = frequency[beside][[0, -1]]
            if high - low <= NARROW * high:
                break
        if not ends[0] < frequency[highest] < ends[1]:
            return None
        # At a pole, a real amplitude changes its sign and grows as 1 / |f - f0|; a bounded one has converged.
        is_pole = undamped and np.ptp(np.sign(values.real[beside])) == 2 and sizes[-1] > GROWTH * sizes[0]
        return Peak(float(frequency[highest]), math.inf if is_pole else sizes[-1])


def _are_real(values: Complex) -> NDArray[np.bool_]:
    """Whether amplitudes have no imaginary part but rounding."""
    return np.abs(values.imag) <= ROUNDING * np.abs(values)


def polar(amplitude: Complex) -> ArrayPair:
    """Return modulus, and phase before the load's in (-pi, pi] [rad], zero where nothing moves.

    An imaginary part that is rounding counts as none, so that the phase of what nothing damps is 0 or pi.
    """
    size = np.abs(amplitude)
    across = np.where(np.abs(amplitude.imag) <= ROUNDING * size, 0.0, amplitude.imag)
    return size, np.arctan2(across, amplitude.real)


@one_thread()
def response(scene: Scene, frequencies: ArrayLike, solver: str | Solver, exact: bool = False) -> Response:
    """Return the frequency response of a linear scene.

    With the scheme's complex squared frequency W2 (`validation.theory.stepping`) it solves (K - W2 M) D = F; nothing is
    stepped.

    Parameters
    ----------
    scene
        A scene without a sweep; its loads vibrate in phase, with the amplitudes that it gives them. Where its base
        moves, the response is to that alone, per metre along its direction. A column answers per metre of its base or
        of the wave that comes up through a transmitting base, or under the pressure on its top.
    frequencies
        Frequencies f [Hz], not negative. Above 1 / (2 dt), half the sampling frequency, the steps see a load's alias.
    solver
        A solver that reports a frequency response: dda, fem, bar, continuum, or a user's.
    exact
        As the solver's model answers in continuous time; a discount gg keeps its rate -ln(gg) / dt.

    Raises
    ------
    InputError
        The scene is not linear or has a sweep, the solver refuses it or reports no frequency response, the time step
        is unstable, or a frequency is out of range.

    Examples
    --------
    >>> from validation import load_scene, response
    >>> scene = load_scene("figures-3-4").with_values({"time.step": 0.002})
    >>> steady = response(scene, [20.0, 52.0], "dda")
    >>> [round(1e3 * abs(complex(v)), 6) for v in steady.displacement]
    [11.545937, 31.441911]
    """
    f = _checked(frequencies)
    check_scene(scene)
    tables = scene.tables()
    if is_fulfilled('column.base = "transmitting"', "", tables) and not np.all(f > 0):
        raise InputError(
            "must be above 0 on a transmitting base, which has no static stiffness",
            source=scene.name,
            field="frequencies",
            value="0",
        )
    chosen = checked(solver, scene) if isinstance(solver, str) else solver
    if reason := chosen.refusal(scene):
        raise InputError(f"solver {chosen.name} does not apply: {reason}", source=scene.name)
    prepared = chosen.prepare(scene)

    def answer(at: Array) -> Mapping[str, Complex]:
        amplitudes = prepared.response(at, exact)
        return {name: amplitudes[name] for name in (DISPLACEMENT, PRESSURE)}

    try:
        columns = answer(f)
    except NotReported as error:
        raise InputError(f"solver {chosen.name}: {error}", source=scene.name) from None
    base = any(is_fulfilled(stated, "", tables) for stated in ('input.at = "base"', "load.base_motion"))
    return Response(scene.name, chosen.name, exact, base, f, columns, answer)


def check_scene(scene: Scene) -> None:
    """Refuse a scene with a sweep, or one that is not linear."""
    features.refuse_sweep(scene)
    features.refuse_nonlinear(scene, "a frequency response exists")


def _checked(frequencies: ArrayLike) -> Array:
    """Return frequencies as an array, or refuse them."""
    f = np.atleast_1d(np.asarray(frequencies, float))
    if f.ndim != 1 or f.size == 0:
        raise InputError("must be a list of numbers", field="frequencies", value=f"shape {f.shape}")
    wrong = f[~(np.isfinite(f) & (f >= 0))]
    if wrong.size:
        raise InputError("must be finite and not negative", field="frequencies", value=f"{wrong[0]:g}")
    return f
