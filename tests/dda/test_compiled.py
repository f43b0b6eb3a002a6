"""The loop over steps, compiled: the numbers of plain Python, and plain Python wherever it cannot be."""

import gc
import logging
import os
import sys
import threading
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from oracles.contact_bodies import CASES

from dda import Block, Material, Scheme, Unilateral, UnilateralModel
from dda.bodies import glued_step
from dda.bodies.opening_block import opening_block
from dda.contact.rows import laws_of
from dda.march import compiled, one_library, step

SHORT = compiled.SHORT  # before a short test keeps itself from compiling
EVERY_CODE = (
    *("rough and shaken by two stages", "dead band", "dashpot", "conserving", "augmented", "impact"),
    *("turning by two stages", "rough sub-blocks"),
)


@pytest.fixture
def always(monkeypatch):
    """Compile, however short a history is."""
    pytest.importorskip("numba")
    for name in ("SHORT", "LONG", "ANEW"):
        monkeypatch.setattr(compiled, name, 0)


@pytest.mark.long
@pytest.mark.parametrize("name", EVERY_CODE)
def test_a_body_is_the_same_compiled_and_plain(name, always, monkeypatch):
    case = CASES[name](3)
    fast = case.run()
    monkeypatch.setattr(compiled, "SHORT", 10**9)
    plain = case.run()
    assert compiled.COMPILED in fast.notes[-1] and compiled.PLAIN in plain.notes[-1]
    for field, values, others in zip(plain.history._fields, plain.history, fast.history, strict=True):
        scale = np.max(np.abs(values), axis=0, initial=0.0)
        assert np.all(np.abs(values - others) <= 1e-14 * scale), field
    assert fast.outcome == plain.outcome and fast.factorisations == plain.factorisations


def test_contacts_of_sub_blocks_are_found_from_records(monkeypatch, held):
    def code_for(function, records, steps):
        return function, tuple(compiled.as_record(part) for part in records)

    monkeypatch.setattr(glued_step, "code_for", code_for)
    held("rough sub-blocks", CASES["rough sub-blocks"](0).run())


class Numbers(NamedTuple):
    size: float


class MoreNumbers(NamedTuple):
    size: float
    others: np.ndarray


FACTOR = 2.0


def halved(size):
    return size / FACTOR


def loop(numbers, kept):
    """A loop that is quickly compiled."""
    for i in range(len(kept)):
        kept[i] = halved(numbers.size) + i


def third(size):
    return size / 3.0


def loop_of_another_numba(numbers, kept):
    """A loop that calls what no other one does."""
    for i in range(len(kept)):
        kept[i] = third(numbers.size) + i


class Weights(NamedTuple):
    first: int
    at: np.ndarray


class Series(NamedTuple):
    scale: float
    weights: Weights
    values: np.ndarray


def loop_of_series(series, kept):
    """A loop that moves a product of two arrays of any length from one to another."""
    for i in range(series.weights.first, len(series.values)):
        kept[i] = series.scale * series.weights.at[i][1] * series.values[i]
        series.values[i] = 0.0


@pytest.fixture
def fresh(always, monkeypatch, tmp_path):
    """Forget what was compiled; keep code in a directory of this test."""
    monkeypatch.setattr(compiled, "loops", {})
    monkeypatch.setattr(compiled, "made", Counter())
    monkeypatch.setattr(compiled, "cache_directory", lambda: tmp_path)
    return tmp_path


def ran(steps=1, loop=loop, numbers=None):
    """Return how a loop was run, and what it wrote."""
    kept = np.zeros(3)
    how = compiled.run_loop(loop, (numbers or Numbers(5.0),), (), (kept,), steps)[2]
    return how, kept.tolist()


RAN = (compiled.COMPILED, [2.5, 3.5, 4.5])


@pytest.mark.long
def test_compiled_code_is_kept_and_read_again_and_made_anew_where_it_is_broken(fresh, monkeypatch):
    assert ran() == RAN and gc.isenabled()
    kept = {path: path.stat().st_mtime_ns for path in fresh.rglob("*.nb?")}
    assert len(kept) == 2
    monkeypatch.setattr(compiled, "loops", {})
    assert ran() == RAN
    assert {path: path.stat().st_mtime_ns for path in fresh.rglob("*.nb?")} == kept
    for path in kept:
        path.write_bytes(b"nothing that numba knows")
    monkeypatch.setattr(compiled, "loops", {})
    assert ran() == RAN


def test_code_is_the_same_for_arrays_of_all_lengths_in_named_tuples(fresh):
    for n in (3, 5):
        at = np.arange(2.0 * n).reshape(n, 2)
        values = np.full(n, 3.0)
        kept = np.zeros(n)
        series = Series(2.0, Weights(1, at), values)
        assert compiled.as_structure(series).value is series  # so long the words of its arrays hold
        how = compiled.run_loop(loop_of_series, (), (series,), (kept,), 1)[2]
        assert how == compiled.COMPILED
        assert kept.tolist() == [0.0, *(6.0 * at[1:, 1])] and values.tolist() == [3.0] + (n - 1) * [0.0]
    assert len(compiled.loops) == 1


def test_steps_decide_what_is_compiled_what_is_read_and_what_is_made_each_time(monkeypatch):
    monkeypatch.setattr(compiled, "numba_version", lambda: "a version")
    monkeypatch.setattr(compiled, "SHORT", SHORT)
    steps = SHORT, compiled.LONG, compiled.ANEW
    assert steps[0] <= 2_000 and steps[1] <= 28_000 < steps[2]  # a slope of 28,000 steps is compiled
    monkeypatch.setattr(compiled, "loops", {})
    monkeypatch.setattr(compiled, "OFTEN", 10**9)
    for directory, kept, worthwhile in (
        ("somewhere", False, [False, False, True, True]),
        ("somewhere", True, [False, True, True, True]),
        (None, False, [False, False, False, True]),
    ):
        monkeypatch.setattr(compiled, "cache_directory", lambda directory=directory: directory)
        monkeypatch.setattr(compiled, "is_kept", lambda loop, types, kept=kept: kept)
        assert [compiled.is_worthwhile(loop, n, ()) for n in (steps[0] - 1, *steps)] == worthwhile


def test_what_is_kept_is_read_for_shorter_histories_of_the_same_sizes_than_are_compiled(fresh, monkeypatch):
    monkeypatch.setattr(compiled, "SHORT", 10)
    monkeypatch.setattr(compiled, "LONG", 30)
    assert [ran(steps)[0] == compiled.COMPILED for steps in (20, 40, 20, 5)] == [False, True, True, False]
    for loops in (compiled.loops, {}):  # in this process, then in the cache alone
        monkeypatch.setattr(compiled, "loops", dict(loops))
        assert ran(20, numbers=MoreNumbers(5.0, np.ones(2)))[0] == compiled.PLAIN
        assert ran(20) == RAN


def test_short_histories_pay_together_but_where_plain_python_is_asked_for(fresh, monkeypatch):
    monkeypatch.setattr(compiled, "SHORT", 10)
    monkeypatch.setattr(compiled, "LONG", 30)
    monkeypatch.setattr(compiled, "OFTEN", 2)
    # 20 steps of the loop to look for code, then 60 of the loop for these types to make it
    assert [ran(9)[0] == compiled.COMPILED for _ in range(9)] == [False] * 8 + [True]
    assert ran(9, numbers=MoreNumbers(5.0, np.ones(2)))[0] == compiled.PLAIN
    assert ran(1) == RAN and ran(0) == (compiled.PLAIN, RAN[1])


@pytest.mark.long
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


@pytest.mark.long
def test_another_numba_compiles_in_its_own_way(fresh, monkeypatch):
    monkeypatch.setattr(one_library, "one_library", lambda: 1 / 0)
    assert ran(loop=loop_of_another_numba, numbers=Numbers(6.0)) == (compiled.COMPILED, [2.0, 3.0, 4.0])


@pytest.mark.parametrize("name", ["NUMBA_CACHE_DIR", "XDG_CACHE_HOME"])
def test_a_directory_that_cannot_be_written_is_none(monkeypatch, tmp_path, name):
    (tmp_path / "file").write_text("")
    for other in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(other, raising=False)
    monkeypatch.setenv(name, str(tmp_path / "file" / "below"))
    assert compiled.cache_directory.__wrapped__() is None
    monkeypatch.setenv(name, str(tmp_path / "new"))
    assert compiled.cache_directory.__wrapped__() == tmp_path / "new" / "dda-validation"
    monkeypatch.delenv(name)
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    for platform, cache in (("linux", ".cache"), ("darwin", "Library/Caches"), ("win32", "AppData/Local")):
        monkeypatch.setattr(sys, "platform", platform)
        assert compiled.user_cache() == tmp_path / cache
    assert os.listdir(tmp_path) and not (tmp_path / "numba").exists()


def test_without_numba_and_where_it_fails_the_plain_functions_run(fresh, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "numba", None)
        assert ran() == (compiled.PLAIN, RAN[1])
    monkeypatch.setattr(compiled, "loops", {})
    monkeypatch.setattr(compiled, "compile_loop", lambda *given: 1 / 0)
    assert ran() == (compiled.PLAIN, RAN[1])


def test_a_function_or_a_number_that_was_replaced_counts(fresh, monkeypatch):
    assert ran() == RAN
    for name, value, numbers in (("FACTOR", 5.0, [1.0, 2.0, 3.0]), ("halved", abs, [5.0, 6.0, 7.0])):
        with monkeypatch.context() as patch:
            patch.setattr(sys.modules[__name__], name, value)
            assert ran() == (compiled.PLAIN, numbers)
    assert ran() == RAN


def test_a_seeded_fault_is_never_compiled_away(always, monkeypatch):
    monkeypatch.setattr(step, "move_rows", lambda body, x, out: None)
    assert compiled.PLAIN in CASES["frictionless"](1).run(3).notes[-1]


def check_record(record, value):
    for name, part in zip(value._fields, value, strict=True):
        if isinstance(part, tuple):
            check_record(record[name], part)
        else:
            assert np.array_equal(record[name], part), name
            assert record[name].dtype == (np.int64 if np.asarray(part).dtype.kind in "bi" else np.float64), name


def test_a_rule_of_contact_without_numbers_of_its_own_is_taken_by_compiled_code():
    block = opening_block(UnilateralModel(Block.rectangle(2.0, 1.0, Material(2500.0, 1e9, 0.2)), Unilateral(1e9)))
    laws = laws_of(Unilateral(1e9), contacts=block.contacts, rows=len(block.B), limit=6)
    march = step.march_of(block.body, laws, Scheme(0.5, 1.0, 1.0, 1e-3), np.zeros(len(block.B)))
    check_record(compiled.as_record(march), march)
