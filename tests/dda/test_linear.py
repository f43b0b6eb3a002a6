"""What every linear body must obey at rest, by its modes and under steady vibrations."""

from dataclasses import replace

import numpy as np
import pytest

import dda
from dda import BaseMotion, Block, Contact, Load, Material, Scheme, TwoBlockModel
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.column_equations import equations
from dda.bodies.column_history import solve_column
from dda.bodies.column_march import Drive
from dda.linear import elimination, krylov

SCHEME = Scheme(0.5, 1.0, 1.0, 1e-3)
MOVED = BaseMotion([0.0, 1.0], [[0.0, 0.0], [0.03, -0.02]])
LOAD = Load(pressure=2e6, traction=3e5, eccentricity=0.1, gravity=9.81, slope=8.0)


def block(load=LOAD):
    outline = [(0, 0), (2, 0), (1.8, 1.4), (0.1, 1.5)]
    return TwoBlockModel(Block(outline, Material(2700.0, 1e9, 0.2)), Contact(3e9, 1e9), load)


def sub_blocks(load=LOAD):
    return dda.subdivided(block(load), 2, 2, 1e11)


def column(load=LOAD):
    layers = [Layer(3.0, 2500.0, 2e9, 0.2, 3), Layer(2.0, 2000.0, 5e8, 0.3, 2)]
    return equations(Column(layers, "pressure", None, [Spring(0.0, 4e9), Spring(3.0, 2e9)]))


def welded(load=LOAD):
    return equations(replace(column().column, joints=[Spring(3.0, 2e9)]))


PLANE = [block, sub_blocks]


@pytest.mark.parametrize("body", PLANE)
def test_a_base_at_its_last_position_carries_the_static_solution(body):
    rest = dda.static(body())
    moved = dda.static(body(replace(LOAD, motion=MOVED)))
    shift = {"horizontal_displacement": 0.03, "displacement": -0.02}
    for name, value in rest.items():
        assert moved[name] == pytest.approx(value + shift.get(name, 0.0), rel=1e-9, abs=1e-12), name


def test_the_static_solution_is_that_of_the_matrices_in_the_plane():
    rest = dda.static(block())
    del rest["contact_pressure"]
    D = np.linalg.solve(block().stiffness, block().force)
    assert D[[1, 0, 2, 3, 4, 5]] == pytest.approx([*rest.values()], rel=1e-9)


@pytest.mark.parametrize("body", PLANE)
def test_the_modes_share_the_static_solution_and_end_below_the_highest_frequency(body, held, monkeypatch):
    found = dda.modes(body(), SCHEME, count=40)
    assert sum(mode.share for mode in found) == pytest.approx(1.0, rel=1e-9)
    rest = dda.static(body())
    held(f"at rest {body.__name__}", {**rest, "modes": np.array([(mode.frequency, mode.share) for mode in found])})
    pressure = rest["contact_pressure"]
    size = body().load_size
    assert sum(mode.contact_share for mode in found) * size == pytest.approx(pressure, rel=1e-9)
    for most in (elimination.DENSE, 0):
        monkeypatch.setattr(elimination, "DENSE", most)
        assert max(mode.frequency for mode in found) == pytest.approx(dda.highest_frequency(body()), rel=1e-9)


@pytest.mark.parametrize("body", [sub_blocks, column, welded])
def test_a_wide_matrix_is_answered_in_a_small_space_as_a_narrow_one_by_elimination(body, monkeypatch, held):
    scheme = replace(SCHEME, gg=0.97, step=2e-3)
    for along in (None, (0.3, 1.0)):
        narrow = dda.response(body(replace(LOAD, motion=MOVED)), scheme, [0.0, 3.0, 41.0], along=along)
        held(f"response {body.__name__} {along}", narrow)
        with monkeypatch.context() as patch:
            patch.setattr(elimination, "BAND", -1)
            patch.setattr(krylov, "AT_A_TIME", 2)
            small = dda.response(body(replace(LOAD, motion=MOVED)), scheme, [0.0, 3.0, 41.0], along=along)
            patch.setattr(krylov, "LARGEST", 2)  # which resolves none
            whole = dda.response(body(replace(LOAD, motion=MOVED)), scheme, [0.0, 3.0, 41.0], along=along)
        averaged = dda.named_scheme("chung-hulbert", step=2e-3, gg=0.97, rho_inf=0.4)
        held(
            f"by averages {body.__name__} {along}",
            dda.response(body(replace(LOAD, motion=MOVED)), averaged, [3.0, 41.0], along=along),
        )
        for name, values in narrow.items():
            largest = np.abs(values).max()
            assert small[name] == pytest.approx(values, rel=1e-8, abs=1e-9 * largest), name
            assert whole[name] == pytest.approx(values, rel=1e-8, abs=1e-9 * largest), name


@pytest.mark.parametrize(
    ("impedance", "glue", "joints"),
    [(3e5, 4e8, [Spring(1.0, 2e8)]), (None, None, [])],
)
def test_a_column_is_stepped_to_its_response(impedance, glue, joints, held):
    """Under a pressure that vibrates, and on a base that does."""
    w = 2 * np.pi * 20.0
    scheme = Scheme(0.6, 1.0, 0.93, 4e-4)
    layers = [Layer(1.0, 2000.0, 5e7), Layer(0.7, 2500.0, 8e7)]
    body = Column(layers, glue=glue, joints=joints, impedance=impedance)
    t = scheme.instants(550)
    sine = np.array([np.sin(w * t), w * np.cos(w * t), -w * w * np.sin(w * t)])
    for along, drive in ((None, Drive(*(0 * sine), np.sin(w * t))), ((1.0, 0.0), Drive(*sine, 0 * t))):
        stepped = solve_column(body, scheme, drive)
        held(f"column {impedance} {len(joints)} {along}", stepped)
        for name, (amplitude,) in dda.response(equations(body), scheme, [20.0], along=along).items():
            expected = (amplitude * np.exp(1j * w * stepped.time)).imag
            rest = (stepped.columns[name] - expected)[-125:]
            rest -= np.mean(rest)  # on a dashpot alone a column stays where its start has brought it
            assert np.max(np.abs(rest)) < 1e-7 * abs(amplitude), (name, along)
