"""Long loops over steps, compiled by numba where it is installed; the same functions run as plain Python otherwise.

A loop and the functions that it calls are written once, in numbers and arrays `a[i][j]` that may be lists as well:
plain Python is several times faster on these. Compiled code takes records, one block of memory each: loops over these
take 0.1 us a step where loops over named tuples of arrays take 4. Where arrays have any length, a record holds where
they are (`dda.march.structure`).

Compiling takes some seconds, once an install: a history of `LONG` steps pays for it, and where compiled code is at hand
one of `SHORT` steps pays for reading it. Histories of fewer steps pay when a process has made `OFTEN` times as many
steps by the same loop: who has waited as long as compiling takes is likely to go on. Code is kept between processes in
a directory of the user's cache, by the sources that it was made of; where nothing can be kept, every process would pay,
and only `ANEW` steps are compiled. Where numba is missing, or does not know this Python, the plain functions run. The
numbers are the same: nothing is reordered or fused.

Compiled code stands for the very functions that it was made of. Where one of them, or a constant of theirs, has been
replaced since, the plain functions run.
"""

from __future__ import annotations

import functools
import gc
import hashlib
import logging
import os
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np

from dda.march.one_library import library_option
from dda.march.structure import Structure

Loop = Callable[..., Any]
Parts = tuple[Any, ...]

SHORT = 2_000  # steps from which a loop is run compiled where its code is at hand
LONG = 20_000  # the same from which it is compiled and kept
ANEW = 1_000_000  # the same from which it is compiled where code cannot be kept
OFTEN = 10  # times as many steps of all histories of a process pay: they have taken as long as their code takes
INLINED = 100  # functions of a loop up to which calls of the upper ones are replaced by what they call: 89 of one that
# turns, 126 of blocks in the plane, which compile a fifth longer with it and are no faster
MESSAGE_DELAY = 2.0  # seconds of compiling before it is said
PLAIN = "plain Python"
COMPILED = "compiled"

loops: dict[tuple[Loop, object], tuple[list[Use], Loop | None]] = {}  # by loop and types
made: Counter[object] = Counter()  # steps in this process, by loop, and by loop and types where there are many
_jitable: set[FunctionType] = set()
logger = logging.getLogger("dda")


def run_loop(
    loop: Loop,
    records: Parts,
    series: Parts,
    rows: Parts,
    steps: int,
    in_arrays: Loop | None = None,
) -> tuple[Any, Parts, str]:
    """Run a loop over steps; return what it returns, the records and series that it left, and how it ran, in words.

    Parameters
    ----------
    loop
        The plain function. It takes all that follows, in this order.
    records
        Named tuples of numbers and of arrays of always the same sizes; it works on copies.
    series
        Named tuples of arrays of any length; compiled code works on them, plain Python on copies.
    rows
        Arrays that it fills, or named tuples of these, and numbers.
    steps
        How many steps it makes.
    in_arrays
        What does the same by whole arrays, and takes the place of plain Python on lists; without records.
    """
    with np.errstate(all="ignore"):
        ready = code_for(loop, records, steps, (*series, *rows))
        if ready is not None:
            machine_code, arguments = ready
            return machine_code(*arguments), (*arguments[: len(records)], *series), COMPILED
        if in_arrays is not None:
            return in_arrays(*series, *rows), series, PLAIN
        left = tuple(as_lists(part) for part in (*records, *series))
        return loop(*left, *rows), left, PLAIN


def code_for(function: Loop, records: Parts, steps: int, structures: Parts = ()) -> tuple[Loop, Parts] | None:
    """Return the compiled code of a loop, or of a function that one in plain Python calls at every step; its arguments.

    None where it is not worthwhile, or cannot be made.

    Parameters
    ----------
    function
        The plain function.
    records, structures
        What it takes: named tuples of arrays of always the same sizes, and what follows them.
    steps
        How many steps it makes, or steps of one block that take as long.
    """
    if not paying_steps(function, steps):
        return None
    arguments = (*(as_record(part) for part in records), *(as_structure(part) for part in structures))
    machine_code = compiled(function, arguments) if is_worthwhile(function, steps, types_of(arguments)) else None
    return None if machine_code is None else (machine_code, arguments)


def types_of(arguments: Parts) -> Parts:
    """Return what compiled code is made for: the types of its arguments, with the sizes of all arrays of records."""
    return tuple(getattr(argument, "dtype", type(argument)) for argument in arguments)


def paying_steps(key: object, steps: int) -> int:
    """Count the steps of a history; return them, or those of the whole process over `OFTEN` where these are more.

    None pay where they are fewer than `SHORT`, nor where numba is not installed: then nothing is made ready for
    compiled code, nor looked for in the user's cache.

    Parameters
    ----------
    key
        What they are counted for: a loop, or a loop and types.
    steps
        Zero where plain Python is asked for.
    """
    made[key] += steps
    paying = max(steps, made[key] // OFTEN) if steps else 0
    return paying if paying >= SHORT and numba_version() else 0


def is_worthwhile(loop: Loop, steps: int, types: Parts) -> bool:
    """Tell whether so many steps pay for compiled code: at hand, to be kept, or to be made each time."""
    paying = paying_steps((loop, types), steps)
    if paying >= LONG:
        return paying >= ANEW or cache_directory() is not None
    return (loop, types) in loops or (paying > 0 and is_kept(loop, types))


def is_kept(loop: Loop, types: Parts) -> bool:
    """Tell whether the user's cache holds a loop as its sources are now, for these types."""
    directory = code_directory(functions_of(loop), types)
    return directory is not None and any(directory.rglob("*.nbi"))


def as_lists(value: Any, known: dict[int, Any] | None = None) -> Any:
    """Return arrays as lists: one that stands in several places is one list.

    Named tuples are made objects of the same fields, which plain Python reads three times as fast.
    """
    lists = {} if known is None else known
    if isinstance(value, np.ndarray):
        return lists.setdefault(id(value), value.tolist())
    if not isinstance(value, tuple):
        return value
    fields = with_slots(type(value))()
    for name, part in zip(fields.__slots__, value, strict=True):
        setattr(fields, name, as_lists(part, lists))
    return fields


# a class with the fields of a named tuple
with_slots = functools.cache(lambda kind: type(kind.__name__, (), {"__slots__": kind._fields}))


def as_record(value: Any) -> Any:
    """Return a named tuple as a record of NumPy: one block of memory, however many arrays there are; None is None."""
    if value is None:
        return None
    record = np.recarray(1, dtype=_type_of(value))
    _fill(record.view(np.ndarray), value)
    return record[0]


def as_structure(value: Any) -> Any:
    """Return a named tuple as a record of pointers, anything else as it is."""
    return Structure(value) if isinstance(value, tuple) else value


def _type_of(value: Any) -> Any:
    """Return the type of NumPy for a named tuple, an array or a number."""
    if isinstance(value, tuple):
        fields = zip(value._fields, value, strict=True)  # type: ignore[attr-defined]
        return np.dtype((np.record, [(name, _type_of(part)) for name, part in fields]))
    array = np.asarray(value)
    return np.dtype((np.int64 if array.dtype.kind in "bi" else np.float64, array.shape))


def _fill(records: Any, value: Any) -> None:
    for name, part in zip(value._fields, value, strict=True):
        if isinstance(part, tuple):
            _fill(records[name], part)
        else:
            records[name][0] = part


def compiled(loop: Loop, arguments: Parts) -> Loop | None:
    """Return the compiled loop for such arguments, or None where the plain one is to run."""
    key = loop, types_of(arguments)
    if key not in loops:
        functions = functions_of(loop)
        uses = [use for function in functions for use in uses_of(function)]
        if any(_is_foreign(part, loop) for part in [*functions, *(use.value for use in uses)]):
            return None
        loops[key] = uses, _compile(loop, functions, arguments)
    uses, machine_code = loops[key]
    unchanged = all(use.names.get(use.name) is use.value for use in uses)
    return machine_code if unchanged else None


def _is_foreign(value: object, loop: Loop) -> bool:
    """Tell whether a function comes from elsewhere than the package of the loop: nobody knows what it holds."""
    if not callable(value) or isinstance(value, type):
        return False
    package = loop.__module__.partition(".")[0]
    return not isinstance(value, FunctionType) or value.__module__.partition(".")[0] != package


class Use(NamedTuple):
    """A function or a constant that compiled code was made of, and where it is looked up."""

    names: dict[str, Any]
    name: str
    value: object


def uses_of(function: FunctionType) -> Iterator[Use]:
    """Yield the functions and constants that a function looks up by name."""
    for name in function.__code__.co_names:
        value = function.__globals__.get(name)
        if callable(value) or isinstance(value, int | float | tuple):
            yield Use(function.__globals__, name, value)


def called_by(function: FunctionType) -> list[object]:
    """Return what a function holds in its closure, and what it looks up by name."""
    return [cell.cell_contents for cell in function.__closure__ or ()] + [use.value for use in uses_of(function)]


def functions_of(loop: Loop) -> list[FunctionType]:
    """Return a function of this package and all that it calls."""
    functions: list[FunctionType] = []
    waiting: list[object] = [loop]
    while waiting:
        function = waiting.pop()
        if isinstance(function, FunctionType) and function not in functions:
            functions.append(function)
            waiting += called_by(function)
    return functions


def _compile(loop: Loop, functions: list[FunctionType], arguments: Parts) -> Loop | None:
    """Return the compiled loop, or None where numba, this Python or this machine cannot make it."""
    try:
        import numba
        from numba.extending import register_jitable
    except Exception:  # not installed, or not for this Python
        return None
    # a small loop is faster with what it calls, and with what these call, in its place; of a large one, as that of
    # blocks in the plane, it would be written again and again
    called = called_by(functions[0]) if len(functions) <= INLINED else []
    inner = called + [part for function in functions if function in called for part in called_by(function)]
    # nobody else calls any of these: they have no entry from Python or C
    options = {**library_option(), "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    for function in functions:
        if function is not loop and function not in _jitable:
            register_jitable(forceinline=function in inner, **options)(function)
            _jitable.add(function)
    directory = code_directory(functions, types_of(arguments))
    message = "compiling the loop over steps, " + ("once an install" if directory else "which no directory can keep")
    timer = threading.Timer(MESSAGE_DELAY, logger.warning, [message])
    timer.daemon = True
    if not is_kept(loop, types_of(arguments)):
        timer.start()
    collects = gc.isenabled()
    gc.disable()  # a compiler makes millions of objects and few circles: looking for these takes a tenth of its time
    try:
        for place in dict.fromkeys((directory, None)):
            try:
                types = tuple(numba.typeof(argument) for argument in arguments)  # type: ignore[no-untyped-call]
                return compile_loop(numba, loop, types, place)
            except Exception:  # a broken or locked cache, then a compiler that does not know what plain Python knows
                continue
        return None
    finally:
        timer.cancel()
        if collects:
            gc.enable()


def compile_loop(numba: Any, loop: Loop, types: Parts, directory: Path | None) -> Loop:
    """Return the compiled loop; raise whatever numba raises."""
    before = numba.config.CACHE_DIR
    # nothing is allocated in a loop: without the counting of references a call costs what it does
    options = {**library_option(), "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
    try:
        if directory is not None:
            numba.config.CACHE_DIR = str(directory)
        dispatcher: Any = numba.njit(cache=directory is not None, **options)(loop)
    finally:
        numba.config.CACHE_DIR = before
    if pipeline := options.get("pipeline_class"):
        pipeline.library = None
    dispatcher.compile(types)
    machine_code: Loop = dispatcher
    return machine_code


def code_directory(functions: list[FunctionType], types: Parts) -> Path | None:
    """Return the directory in which the code of functions for these types is kept; None where it cannot be."""
    directory = cache_directory()
    if directory is None:
        return None
    digest = _digest(tuple(sorted({function.__code__.co_filename for function in functions})))
    return directory / digest / hashlib.sha256(repr(types).encode()).hexdigest()[:16]


@functools.cache
def numba_version() -> str | None:
    """Return the version of numba; None where it is not installed."""
    from importlib.metadata import PackageNotFoundError, version  # fifty modules, which `import dda` does not load

    try:
        return version("numba")
    except PackageNotFoundError:
        return None


@functools.cache
def _digest(sources: tuple[str, ...]) -> str:
    """Return what changes with sources, with numba and with Python."""
    digest = hashlib.sha256(f"{numba_version()} {sys.version}".encode())
    for name in sources:
        digest.update(Path(name).read_bytes())
    return digest.hexdigest()[:16]


@functools.cache
def cache_directory() -> Path | None:
    """Return the directory of the user's cache for compiled code, or None where it cannot be written."""
    try:
        directory = user_cache() / "dda-validation"
        directory.mkdir(parents=True, exist_ok=True)
        return directory if os.access(directory, os.W_OK) else None
    except (OSError, RuntimeError):  # no home, or a full disk
        return None


def user_cache() -> Path:
    """Return the directory in which this system's programs keep what they can make again."""
    if directory := os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME"):
        return Path(directory)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    return Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")
