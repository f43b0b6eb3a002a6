"""A loop and all that it calls, compiled by numba into one library of machine code.

By default numba gives each function a library of its own, which is optimised and made into machine code together with
all that it calls: more than half the time of compiling a loop of seventy functions goes into code that nobody runs.
A fifth of the rest goes into comparing options, thirty by thirty, a tenth into rewriting what no loop has.
"""

from __future__ import annotations

import functools
from typing import Any


def library_option() -> dict[str, Any]:
    """Return the option of numba, none where this numba is built in another way: it then compiles as it does."""
    try:
        return {"pipeline_class": one_library()}
    except Exception:
        return {}


@functools.cache
def one_library() -> Any:
    """Return a compiler for `numba.njit` that writes to its `library` what it compiles, to a new one where it is None.

    What has no entry from Python (the option `no_cpython_wrapper`) is no machine code before the whole library is.
    """
    from numba.core.codegen import JITCodeLibrary
    from numba.core.compiler import Compiler, Flags
    from numba.core.compiler_machinery import register_pass
    from numba.core.typed_passes import NativeLowering, NoPythonBackend, NopythonRewrites
    from numba.core.untyped_passes import InlineClosureLikes

    class Library(JITCodeLibrary):
        def add_linking_library(self, library: Any) -> None:
            """Link a library, but for this one."""
            if library is not self:
                super().add_linking_library(library)  # type: ignore[no-untyped-call]

    @register_pass(mutates_CFG=False, analysis_only=False)  # type: ignore[no-untyped-call]
    class Linkable(NoPythonBackend):
        """Give a function that Python does not call a name by which the others find it in the library."""

        _name = "linkable"

        def run_pass(self, state: Any) -> bool:
            names: list[object] = []
            name = names.append  # numba takes any function written in C, and each list has an `append` of its own
            state.targetctx.insert_user_function(name, state["cr"].fndesc, [state.library])
            state["cr"] = state["cr"]._replace(cfunc=name)
            return True

    class Options(Flags):
        """Options of a function, which are the same where those that were set are."""

        def __hash__(self) -> int:
            """Return how many are set."""
            return len(self._values)

        def __eq__(self, other: object) -> bool:
            """Tell whether the same ones are set alike."""
            return isinstance(other, Options) and self._values == other._values

    class OneLibrary(Compiler):
        library: Library | None = None

        def __init__(self, *arguments: Any) -> None:
            """Take a function, with its options as they are compared here."""
            super().__init__(*arguments)  # type: ignore[no-untyped-call]
            self.state.flags = Options(self.state.flags)  # type: ignore[no-untyped-call]

        def define_pipelines(self) -> Any:
            """Return the passes of numba, for the present library."""
            state = self.state
            if OneLibrary.library is None:
                library: Any = Library(state.targetctx.codegen(), "loop")  # type: ignore[no-untyped-call]
                library.enable_object_caching()
                OneLibrary.library = library
            state.library = OneLibrary.library
            (passes,) = super().define_pipelines()  # type: ignore[no-untyped-call]
            # no loop has a closure, nor an expression of whole arrays
            passes.passes = [each for each in passes.passes if each[0] not in (InlineClosureLikes, NopythonRewrites)]
            if state.flags.no_cpython_wrapper:
                state.flags.no_compile = True
                passes.add_pass_after(Linkable, NativeLowering)
            passes.finalize()
            return [passes]

    return OneLibrary
