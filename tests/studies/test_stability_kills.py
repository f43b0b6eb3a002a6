"""The gates on digits, growth and stiff contacts are bitten by seeded faults, and their chapters are written."""

from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from conftest import beside
from faults import seams
from faults.fault import Fault, late, thousandth, times, with_scheme
from faults.kill_matrix import check_kill_matrix

import dda
from dda.one_block.natural_modes import ModalForm
from validation.engine.run import run_study
from validation.gates.gate import Status
from validation.report.book import build, figures
from validation.report.chapters.registry import CHAPTERS
from validation.studies.catalogue import get_study


def printed_recursion(sound):
    """Swap the robust form for the textbook one."""
    return lambda model, scheme, steps, columns, full=False: dda.solve_textbook(model, scheme, steps, columns)


def robust_form(sound):
    """Swap the textbook form for the robust one."""
    return lambda model, scheme, steps, columns: dda.solve(model, scheme, steps, columns)


def unscaled_modes(sound):
    """Find the modes by a general solver, which scales nothing."""

    def faulty(form):
        squares, shapes = scipy.linalg.eigh(np.diag(form.K), form.M)
        return ModalForm(np.sqrt(np.abs(squares)), shapes, shapes.T @ form.F, shapes.T @ form.M @ form.R)

    return faulty


def offset(sound):
    def faulty(observed, pressure):
        observed += 1e-6
        return ()

    return faulty


FAULTS = [
    Fault("dda: the printed recursion", ("dda",), seams.DDA_SOLVE, printed_recursion),
    Fault("dda: modes by a general solver", ("dda",), seams.DDA_MODES, unscaled_modes),
    Fault("dda: load 2e-9 high", ("dda",), seams.DDA_LOAD, times(1 + 2e-9)),
    Fault("dda: delta 0.1 % high", ("dda",), seams.DDA_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("dda: an offset", ("dda",), seams.DDA_OVERFLOW, offset),
    Fault("dda-textbook: the robust form", ("dda-textbook",), seams.DDA_TEXTBOOK, robust_form),
]


CONTACT_FAULTS = [
    Fault("dda: delta 0.1 % high", ("dda",), seams.DDA_VELOCITY, with_scheme(0, delta=thousandth)),
    Fault("dda: one step late", ("dda",), seams.DDA_HISTORIES, late),
    Fault("dda: an offset", ("dda",), seams.DDA_OVERFLOW, offset),
]


def of_degree(degree):
    """Build every mesh of one degree."""
    return lambda sound: lambda mesh, asked: sound(mesh, degree)


LIMIT_FAULTS = [
    Fault("dda: delta 1e-6 high", ("dda",), seams.DDA_VELOCITY, with_scheme(0, delta=lambda d: d + 1e-6)),
    Fault("fem: always linear", ("fem",), seams.FEM_BASIS, of_degree(1)),
    Fault("fem: always quadratic", ("fem",), seams.FEM_BASIS, of_degree(2)),
]


KILLS = {"stability-small": FAULTS, "stiff-contact": CONTACT_FAULTS, "limits": LIMIT_FAULTS}


@pytest.mark.long
@pytest.mark.parametrize("name", KILLS)
def test_every_gate_is_bitten_and_every_fault_is_seen(name: str, tmp_path: Path, finished_cases: Path) -> None:
    study = get_study(name)
    check_kill_matrix(study, study.cases(), study.gates(), KILLS[name], tmp_path, finished_cases)


@pytest.mark.long
@pytest.mark.parametrize("name", KILLS)
def test_every_gate_passes_and_the_chapter_is_written(name: str, tmp_path: Path, finished_cases: Path) -> None:
    results = beside(finished_cases, tmp_path / "results")
    assert {verdict.status for verdict in run_study(get_study(name), results)} == {Status.PASS}
    if name not in CHAPTERS:
        return
    assert build(results, tmp_path / "report.pdf").stat().st_size > 20_000
    assert all(path.exists() for path in figures(name, results, tmp_path / "figures"))
