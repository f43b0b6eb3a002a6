"""Long loops over steps, compiled by numba where it is installed; the same functions run as plain Python otherwise.

A loop and the functions that it calls are written once, in numbers and arrays `a[i][j]` that may be lists as well:
plain Python is several times faster on these. numba is imported only where a history is long enough to pay for it.
Compiled code is kept between processes in a directory of the user's cache, by the sources that it was made of; where
that cannot be written, where numba is missing or does not know this Python, the plain functions run. The numbers are
the same: nothing is reordered or fused.

Compiling takes 5 to 25 seconds, six times what the shortest history that is compiled takes in plain Python. It is
paid once an install, and whoever runs one such history runs more: from then on 1e5 steps of a block that opens take
0.02 s, where plain Python takes two seconds and more. Where code cannot be kept every process would pay, and only
histories are compiled that take longer than that.

Compiled code stands for the very functions that it was made of. Where one of them, or a constant of theirs, has been
replaced since, the plain functions run.
"""

from __future__ import annotations

import functools
import hashlib
import logging
import os
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np

from dda.stepping.one_library import library_option

Loop = Callable[..., Any]

WORTHWHILE_KEPT = 0.8  # seconds of plain Python from which a loop is read from the cache, which takes about as long
WORTHWHILE = 1.0  # the same from which the smallest loop is compiled and kept: 1e5 steps of a block that opens
WORTHWHILE_ANEW = 30.0  # the same where compiled code cannot be kept
MESSAGE_DELAY = 2.0  # seconds of compiling before it is said
PLAIN = "plain Python"
COMPILED = "compiled"

loops: dict[tuple[Loop, object], tuple[list[Use], Loop | None]] = {}  # by loop and types
_jitable: set[FunctionType] = set()
logger = logging.getLogger("dda")


def run_loop(
    loop: Loop,
    records: tuple[Any, ...],
    series: tuple[Any, ...],
    rows: tuple[Any, ...],
    seconds: float,
    compile_time: float = 1.0,
) -> tuple[Any, tuple[Any, ...], str]:
    """Run a loop over steps; return what it returns, the records that it left, and whether it was compiled, in words.

    Parameters
    ----------
    loop
        The plain function. It takes all that follows, in this order.
    records
        Named tuples of numbers and of arrays of always the same sizes; it works on copies. What a loop does only where
        one is not None is not compiled where it is.
    series
        Named tuples of arrays of any length, which it reads, or None.
    rows
        Arrays that it fills, and numbers.
    seconds
        About how long the plain function takes.
    compile_time
        How long it takes to compile, over what the smallest loop takes, that of contacts which slide freely.
    """
    with np.errstate(all="ignore"):
        if seconds >= WORTHWHILE_KEPT:
            converted = tuple(as_record(part) for part in records)
            arguments = (*converted, *series, *rows)
            worthwhile = is_worthwhile(loop, seconds, types_of(arguments), compile_time)
            machine_code = compiled(loop, arguments) if worthwhile else None
            if machine_code is not None:
                return machine_code(*arguments), converted, COMPILED
        converted = tuple(as_lists(part) for part in records)
        return loop(*converted, *(as_lists(part) for part in series), *rows), converted, PLAIN


class Compilable:
    """A function of records that is called at every step of a loop that is not compiled itself.

    Parameters
    ----------
    function
        The plain function, of named tuples and numbers.
    seconds
        About how long all its calls take in plain Python.
    compile_time
        How long it takes to compile, over what the smallest loop takes.
    """

    def __init__(self, function: Loop, seconds: float, compile_time: float) -> None:
        self.function = function
        self.records = is_worthwhile(function, seconds, compile_time=compile_time)
        self.how = PLAIN

    def room(self, value: Any) -> Any:
        """Return a named tuple in the form in which the function may write it."""
        return as_record(value) if self.records else as_lists(value)

    def __call__(self, *arguments: Any) -> Any:
        """Call the function, compiled or not."""
        converted = [self._converted(argument) for argument in arguments]
        if self.records:
            machine_code = compiled(self.function, tuple(converted))
            if machine_code is not None:
                self.how = COMPILED
                return machine_code(*converted)
        return self.function(*converted)

    def _converted(self, argument: Any) -> Any:
        arrays = isinstance(argument, tuple) and any(isinstance(part, np.ndarray) for part in argument)
        numbers = self.records and isinstance(argument, tuple)
        return self.room(argument) if arrays or numbers else argument


def types_of(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return what compiled code is made for: the types of its arguments, with the sizes of all arrays of records."""
    return tuple(getattr(argument, "dtype", type(argument)) for argument in arguments)


def is_worthwhile(loop: Loop, seconds: float, types: tuple[Any, ...] | None = None, compile_time: float = 1.0) -> bool:
    """Tell whether plain Python takes so long that compiled code pays: at hand, to be kept, or to be made each time.

    Parameters
    ----------
    types
        Those of the arguments; None where they are not known yet, and code for any counts as at hand.
    compile_time
        How long it takes to compile, over what the smallest loop takes.
    """
    if seconds < WORTHWHILE_KEPT:  # and nothing is looked for, nor made, in the user's cache
        return False
    if seconds < compile_time * WORTHWHILE:
        at_hand = [known for compiled_loop, known in loops if compiled_loop is loop]
        return types in at_hand or (types is None and bool(at_hand)) or is_kept(loop, types)
    return seconds >= WORTHWHILE_ANEW or cache_directory() is not None


def is_kept(loop: Loop, types: tuple[Any, ...] | None) -> bool:
    """Tell whether the user's cache holds a loop as its sources are now, for these types or for any."""
    from importlib.metadata import PackageNotFoundError, version  # fifty modules, which `import dda` does not load

    directory = cache_directory()
    try:
        numba_version = version("numba")
    except PackageNotFoundError:
        return False
    if directory is None:
        return False
    kept = directory / _digest(functions_of(loop), numba_version)
    return any((kept if types is None else kept / _types_digest(types)).rglob("*.nbi"))


def as_lists(value: Any) -> Any:
    """Return arrays as lists, also within named tuples."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return type(value)(*(as_lists(part) for part in value))  # a named tuple
    return value


def as_record(value: Any) -> Any:
    """Return a named tuple as a record of NumPy: one block of memory, however many arrays there are; None is None."""
    if value is None:
        return None
    record = np.recarray(1, dtype=_type_of(value))
    _fill(record.view(np.ndarray), value)
    return record[0]


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


def compiled(loop: Loop, arguments: tuple[Any, ...]) -> Loop | None:
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


def _compile(loop: Loop, functions: list[FunctionType], arguments: tuple[Any, ...]) -> Loop | None:
    """Return the compiled loop, or None where numba, this Python or this machine cannot make it."""
    try:
        import numba
        from numba.extending import register_jitable
    except Exception:  # not installed, or not for this Python
        return None
    direct = called_by(functions[0])
    for function in functions:
        if function is not loop and function not in _jitable:
            # what the loop itself calls takes whole histories, whose arrays are not to be passed on at every step;
            # and nobody else calls any of these: they have no entry from Python or C
            options = {**library_option(), "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
            register_jitable(forceinline=function in direct, **options)(function)
            _jitable.add(function)
    directory = cache_directory()
    if directory is not None:
        directory = directory / _digest(functions, numba.__version__) / _types_digest(types_of(arguments))
    message = "compiling the loop over steps, " + ("once an install" if directory else "which no directory can keep")
    timer = threading.Timer(MESSAGE_DELAY, logger.warning, [message])
    timer.daemon = True
    if not is_kept(loop, types_of(arguments)):
        timer.start()
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


def compile_loop(numba: Any, loop: Loop, types: tuple[Any, ...], directory: Path | None) -> Loop:
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


def _digest(functions: list[FunctionType], version: str) -> str:
    """Return what changes with the sources of functions, with numba and with Python."""
    digest = hashlib.sha256(f"{version} {sys.version}".encode())
    for name in sorted({function.__code__.co_filename for function in functions}):
        digest.update(Path(name).read_bytes())
    return digest.hexdigest()[:16]


def _types_digest(types: tuple[Any, ...]) -> str:
    """Return what changes with the types of arguments."""
    return hashlib.sha256(repr(types).encode()).hexdigest()[:16]


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
