"""The loop over steps, compiled: the numbers of plain Python, and plain Python wherever it cannot be."""

import functools
import logging
import os
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.frictional import rubbing_model, shaken
from oracles.rolling import random_rolling
from oracles.unilateral_checks import DT, random_model

from dda import (
    Block,
    Material,
    Scheme,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    named_scheme,
    opening_subdivided,
    solve_opening_system,
    solve_unilateral,
)
from dda.contact import kernel
from dda.one_block import unilateral, unilateral_step
from dda.rotation.solution import solve_rolling
from dda.stepping import compiled, one_library

FIELDS = (
    "normal",
    "shear",
    "gap",
    "slide",
    "slip",
    "states",
    "velocity",
    "horizontal_velocity",
    "step_solves",
    "step_cuts",
)
SCHEMES = [Scheme(0.5, 1.0, 0.99, DT), Scheme(0.25, 0.5, 1.0, DT, "consistent"), Scheme(0.3025, 0.6, 0.97, DT)]


@pytest.fixture
def always(monkeypatch):
    """Compile, however short a history is."""
    pytest.importorskip("numba")
    monkeypatch.setattr(compiled, "WORTHWHILE_KEPT", 0.0)
    monkeypatch.setattr(compiled, "WORTHWHILE", 0.0)
    monkeypatch.setattr(compiled, "WORTHWHILE_ANEW", 0.0)


def pair(solve, monkeypatch):
    """Return the result of compiled code and that of plain Python."""
    fast = solve()
    with monkeypatch.context() as patch:
        patch.setattr(compiled, "is_worthwhile", lambda *given, **more: False)
        plain = solve()
    assert any(compiled.COMPILED in note for note in fast.notes) and any(compiled.PLAIN in note for note in plain.notes)
    return fast, plain


def check_same(fast, plain):
    for name in FIELDS:
        one, other = getattr(fast, name), getattr(plain, name)
        assert one.shape == other.shape
        assert np.max(np.abs(one - other), initial=0.0) <= 1e-14 * np.max(np.abs(other), initial=0.0), name
    for name, values in plain.energies.items():
        assert np.max(np.abs(values - fast.energies[name])) <= 1e-14 * max(
            map(np.max, map(np.abs, plain.energies.values()))
        )
    assert fast.outcome == plain.outcome and fast.factorisations == plain.factorisations


def models():
    """Return random blocks of every kind of contact and rule, each with a scheme and options."""
    for seed in range(12):
        model, options = rubbing_model(seed) if seed % 2 else random_model(seed), {}
        law = model.contact
        if seed in (4, 5):
            law = replace(law, stiffness=np.inf)
        if seed in (6, 7):
            law = replace(law, band=(1e-5, 0.0 if seed == 7 else 1e-6))
        if seed in (9, 11):
            law = replace(law, rules="lagged")
        motion = shaken(np.random.default_rng(seed)) if seed % 2 else None  # each kind of records compiles anew
        yield replace(model, contact=law, motion=motion), SCHEMES[seed % 3], options
    yield random_model(5, glued=True), Scheme(0.5, 1.0, 0.99, 8e-3), {}  # some steps are cut
    yield random_model(2, glued=False), replace(SCHEMES[1], start="zero"), {"rule": "energy-conserving"}
    yield rubbing_model(1), SCHEMES[1], {"rule": "implicit"}
    plain = random_model(2, glued=False)
    damped = replace(plain.contact, damping=0.2 * plain.contact.stiffness * 1e-4)
    yield replace(plain, contact=damped), SCHEMES[0], {}
    yield replace(plain, contact=damped), named_scheme("composite", step=DT), {}
    for name, values in (("chung-hulbert", {"rho_inf": 0.6}), ("leapfrog", {})):
        yield rubbing_model(1), named_scheme(name, step=DT / 10, gg=0.99, **values), {}
    yield plain, SCHEMES[0], {"rule": "augmented"}
    rigid = replace(plain.contact, stiffness=np.inf)
    yield replace(plain, contact=rigid), Scheme(0.25, 0.5, 0.99, DT), {"rule": "impact", "restitution": 0.3}


@pytest.mark.long
def test_one_block_is_the_same_compiled_and_plain(always, monkeypatch):
    for model, scheme, options in models():
        own = UnilateralOptions(energies=True, **options)
        check_same(*pair(functools.partial(solve_unilateral, model, scheme, 150, options=own), monkeypatch))


@pytest.mark.long
def test_sub_blocks_are_the_same_compiled_and_plain(always, monkeypatch):
    for seed in (1, 3):
        opening = opening_subdivided(rubbing_model(seed), 2, 1, 1e13)
        own = UnilateralOptions(energies=True)
        check_same(*pair(functools.partial(solve_opening_system, opening, SCHEMES[0], 40, options=own), monkeypatch))


@pytest.mark.long
def test_a_block_that_turns_is_the_same_compiled_and_plain(always, monkeypatch):
    for seed in (2, 3, 5, 9, 11):
        model, dt = random_rolling(seed)
        scheme = named_scheme("composite", step=dt, gg=0.99) if seed == 11 else Scheme(0.5, 1.0, 0.99, dt)
        check_same(*pair(functools.partial(solve_rolling, model, scheme, 80), monkeypatch))


def test_importing_costs_numpy_only_and_a_short_history_no_numba():
    code = (
        "import sys; from dda import *; "
        "others = {'scipy', 'skfem', 'matplotlib', 'validation', 'fem_reference'}; "
        "assert not others & set(sys.modules); "
        "b = Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0)); "
        "r = solve_unilateral(UnilateralModel(b, Unilateral(1e9), 5e6), Scheme(0.5, 1.0, 1.0, 1e-4), 100); "
        "assert 'plain Python' in r.notes[-1]; print('numba' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def loop(numbers, kept):
    """A loop that is quickly compiled."""
    for i in range(len(kept)):
        kept[i] = halved(numbers.size) + i


def halved(size):
    return size / FACTOR


FACTOR = 2.0


@pytest.fixture
def fresh(always, monkeypatch, tmp_path):
    """Forget what was compiled; keep code in a directory of this test."""
    monkeypatch.setattr(compiled, "loops", {})
    monkeypatch.setattr(compiled, "cache_directory", lambda: tmp_path)
    return tmp_path


class Numbers(kernel.NamedTuple):
    size: float


def ran(seconds=1.0):
    kept = np.zeros(3)
    how = compiled.run_loop(loop, (Numbers(5.0),), (), (kept,), seconds)[2]
    return how, kept.tolist()


def test_compiled_code_is_kept_and_read_again_and_made_anew_where_it_is_broken(fresh, monkeypatch):
    assert ran() == (compiled.COMPILED, [2.5, 3.5, 4.5])
    kept = {path: path.stat().st_mtime_ns for path in fresh.rglob("*.nb?")}
    assert len(kept) == 2
    monkeypatch.setattr(compiled, "loops", {})
    assert ran() == (compiled.COMPILED, [2.5, 3.5, 4.5])
    assert {path: path.stat().st_mtime_ns for path in fresh.rglob("*.nb?")} == kept
    for path in fresh.rglob("*.nb?"):
        path.write_bytes(b"nothing that numba knows")
    monkeypatch.setattr(compiled, "loops", {})
    assert ran() == (compiled.COMPILED, [2.5, 3.5, 4.5])


def test_without_a_place_for_the_cache_it_is_compiled_for_longer_histories(fresh, monkeypatch):
    monkeypatch.setattr(compiled, "cache_directory", lambda: None)
    monkeypatch.setattr(compiled, "WORTHWHILE_ANEW", 30.0)
    assert ran(20.0)[0] == compiled.PLAIN
    assert ran(40.0) == (compiled.COMPILED, [2.5, 3.5, 4.5])


def test_what_is_kept_is_read_for_shorter_histories_than_are_compiled(fresh, monkeypatch):
    monkeypatch.setattr(compiled, "WORTHWHILE_KEPT", 1.0)
    monkeypatch.setattr(compiled, "WORTHWHILE", 3.0)
    assert ran(2.0)[0] == compiled.PLAIN
    assert ran(4.0)[0] == compiled.COMPILED
    assert ran(2.0)[0] == compiled.COMPILED
    assert ran(0.5)[0] == compiled.PLAIN


def test_a_compilation_is_announced_and_code_that_was_kept_is_not(fresh, monkeypatch, caplog):
    class Elapsed(threading.Timer):
        """A timer whose interval is over at once: a real one is another thread, which may come too late."""

        def start(self):
            assert self.interval == compiled.MESSAGE_DELAY
            self.function(*self.args)

    monkeypatch.setattr(threading, "Timer", Elapsed)
    caplog.set_level(logging.WARNING, logger=compiled.logger.name)  # whatever other tests have made of it
    ran()
    assert [record.getMessage() for record in caplog.records] == ["compiling the loop over steps, once an install"]
    monkeypatch.setattr(compiled, "loops", {})
    ran()
    assert len(caplog.records) == 1


def test_a_hundred_thousand_steps_of_a_block_that_opens_are_compiled_on_the_first_run(monkeypatch):
    monkeypatch.setattr(compiled, "loops", {})
    monkeypatch.setattr(compiled, "is_kept", lambda loop, types: False)
    model = UnilateralModel(Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0)), Unilateral(1e9), 5e6)
    estimates = []

    class Estimated(Exception):
        pass

    def estimate(loop, records, series, rows, seconds, compile_time):
        estimates.append((loop, seconds, None, compile_time))
        raise Estimated

    monkeypatch.setattr(unilateral, "run_loop", estimate)
    rough = replace(model, contact=Unilateral(1e9, shear=4e8, friction=30.0))  # whose code takes longer to compile
    for block, steps in ((model, 20_000), (model, 100_000), (rough, 50_000), (rough, 150_000)):
        with pytest.raises(Estimated):
            solve_unilateral(block, SCHEMES[0], steps)
    monkeypatch.setattr(compiled, "cache_directory", lambda: Path())
    assert [compiled.is_worthwhile(*one) for one in estimates] == [False, True, False, True]
    monkeypatch.setattr(compiled, "cache_directory", lambda: None)
    assert not any(compiled.is_worthwhile(*one) for one in estimates)


def other_loop(numbers, kept):
    """A loop that calls what another one has had compiled."""
    for i in range(len(kept)):
        kept[i] = halved(numbers.size) - i


def test_two_loops_of_one_process_call_the_same_function(fresh):
    kept = np.zeros(3)
    assert ran()[0] == compiled.COMPILED
    assert compiled.run_loop(other_loop, (Numbers(5.0),), (), (kept,), 1.0)[2] == compiled.COMPILED
    assert kept.tolist() == [2.5, 1.5, 0.5]


def third(size):
    return size / 3.0


def loop_of_another_numba(numbers, kept):
    """A loop that calls what no other one does."""
    for i in range(len(kept)):
        kept[i] = third(numbers.size) + i


def test_another_numba_compiles_in_its_own_way(fresh, monkeypatch):
    monkeypatch.setattr(one_library, "one_library", lambda: 1 / 0)
    kept = np.zeros(2)
    assert compiled.run_loop(loop_of_another_numba, (Numbers(6.0),), (), (kept,), 1.0)[2] == compiled.COMPILED
    assert kept.tolist() == [2.0, 3.0]


class MoreNumbers(kernel.NamedTuple):
    size: float
    others: np.ndarray


def test_code_for_other_sizes_is_not_at_hand(fresh, monkeypatch):
    monkeypatch.setattr(compiled, "WORTHWHILE_KEPT", 1.0)
    monkeypatch.setattr(compiled, "WORTHWHILE", 3.0)
    assert ran(4.0)[0] == compiled.COMPILED
    for loops in (compiled.loops, {}):  # in this process, then in the cache alone
        monkeypatch.setattr(compiled, "loops", dict(loops))
        records = (MoreNumbers(5.0, np.ones(2)),)
        assert compiled.run_loop(loop, records, (), (np.zeros(3),), 2.0)[2] == compiled.PLAIN
        assert ran(2.0)[0] == compiled.COMPILED


@pytest.mark.parametrize("name", ["NUMBA_CACHE_DIR", "XDG_CACHE_HOME"])
def test_a_directory_that_cannot_be_written_is_none(monkeypatch, tmp_path, name):
    (tmp_path / "file").write_text("")
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv(name, str(tmp_path / "file" / "below"))
    assert compiled.cache_directory.__wrapped__() is None
    monkeypatch.setenv(name, str(tmp_path / "new"))
    assert compiled.cache_directory.__wrapped__() == tmp_path / "new" / "dda-validation"
    assert os.listdir(tmp_path) and not (tmp_path / "numba").exists()


def test_without_numba_the_plain_functions_run(fresh, monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    assert ran() == (compiled.PLAIN, [2.5, 3.5, 4.5])


def test_what_numba_cannot_compile_runs_plain(fresh, monkeypatch):
    monkeypatch.setattr(compiled, "compile_loop", lambda *given: 1 / 0)
    assert ran() == (compiled.PLAIN, [2.5, 3.5, 4.5])


def test_a_function_or_a_number_that_was_replaced_counts(fresh, monkeypatch):
    assert ran()[0] == compiled.COMPILED
    with monkeypatch.context() as patch:
        patch.setattr(sys.modules[__name__], "FACTOR", 5.0)
        assert ran() == (compiled.PLAIN, [1.0, 2.0, 3.0])
    with monkeypatch.context() as patch:
        patch.setattr(sys.modules[__name__], "halved", abs)
        assert ran() == (compiled.PLAIN, [5.0, 6.0, 7.0])
    assert ran()[0] == compiled.COMPILED


def test_a_seeded_fault_is_never_compiled_away(always, monkeypatch):
    monkeypatch.setattr(unilateral_step, "velocity_corrector", lambda stage, P, f, f_g, f1: stage.gg * P)
    model = replace(random_model(1), contact=Unilateral(1e9))
    assert compiled.PLAIN in solve_unilateral(model, SCHEMES[0], 3).notes[-1]
