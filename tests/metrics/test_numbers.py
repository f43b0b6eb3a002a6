"""Every metric of a made run is what it was: `numbers.txt`, at eight digits. `KEEP_PAGES=1` writes it anew."""

import math
from pathlib import Path

import numpy as np
import pytest
from oracles.kept_numbers import hold

from validation.metrics import poles
from validation.metrics.catalogue import ALL, PAIRS, pair, solo
from validation.metrics.measurable import Measurable
from validation.runs.contact import LOST, LOST_AT_IMPACTS, STORED, ContactRecord, Rebound
from validation.runs.history import History
from validation.runs.modes import Mode, Switch

N = np.arange(1.0, 91.0)
TIME = 0.25 * N
SWING = 2.0 + 1.3 * 0.97**N * np.cos(0.4 * N) + 0.2 * 0.95**N * np.cos(1.1 * N)


def numbers(values):
    return [value if isinstance(value, float) else math.nan for value in values]


def run_numbers():
    pressure = 3.0 - 4.0 * 0.96**N * np.cos(0.5 * N)
    states = {name: (N // step) % 3 for name, step in (("state_m", 7), ("state_n", 11))}
    history = History(TIME, {"displacement": SWING, "contact_pressure": pressure, **states})
    shadow = History(TIME, {"displacement": SWING + 1e-6 * (N > 47), "contact_pressure": pressure})
    names = (*STORED, *LOST, *LOST_AT_IMPACTS)
    record = ContactRecord(
        time=TIME,
        force=np.maximum(pressure, 0.0),
        impulse=np.cumsum(np.maximum(pressure, 0.0)),
        penetration=np.maximum(-pressure, 0.0) / 7,
        gap=np.maximum(SWING - 2.0, 0.0),
        open_share=(N % 5) / 5,
        start_velocity=-1.3,
        start_energy=9.0,
        input_energy=11.0,
        velocity=np.sin(0.4 * N) - 0.3,
        rebounds=(Rebound(1.3, 0.7), Rebound(1.7, None), Rebound(0.9, 0.8)),
        energies={name: 0.01 * (k + 1) * N + k * np.cos(0.3 * N) for k, name in enumerate(names)},
        solves=1.0 + (N % 13 == 0) + 7 * (N == 50),
        cuts=1.0 * (N % 31 == 0),
        slip=0.01 * N**1.5,
    )
    modes = (Mode(1.6, 0.8, (0.9 + 0.37j, 0.9 - 0.37j), 0.3), Mode(4.0, 0.2, (-0.9 + 0j, 0.4 + 0j), -0.9))
    diagnostics = {"predicted_radius": 0.97, "spectral_radius": 0.96, "condition_number": 13.0, "largest_omega": 1.7}
    made = Measurable(
        history,
        0.25,
        {"displacement": 2.1, "contact_pressure": 2.9, "stress": 0.7},
        modes,
        diagnostics=diagnostics,
        switches=tuple(Switch(0.3 * k**1.3, "MN"[k % 2], k % 3 > 0) for k in range(1, 9)),
        contact=record,
        shadow=lambda: shadow,
    )
    measures = {metric.measure for metric in ALL.values()}
    yield "run", numbers(solo(made, measures).values())
    other = History(TIME[:80], {name: 1.1 * values[:80] - 0.3 for name, values in history.columns.items()})
    yield "pairs", numbers(pair(name, history, other, {"displacement.static": 5.0}) for name in PAIRS)
    noise = np.random.default_rng(7).normal(size=90)
    for signal in (SWING, SWING + 1e-3 * noise, SWING + noise, 0.9**N + 0.1 * 0.98**N * np.cos(0.4 * N)):
        found = poles.swing(signal, 0.25)
        yield "swing", found.static or 0.0, found.samples, vars(found.pole)
        yield "poles", *(vars(pole) for pole in poles.poles(signal - 2.0, 0.25))


@pytest.mark.parametrize("part", ["run_numbers"])
def test_metrics_are_what_they_were(part):
    hold(Path(__file__).with_name("numbers.txt"), {part: run_numbers}, part)
