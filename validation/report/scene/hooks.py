"""What `show` and the report ask of the kind of a scene before anything runs."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from validation.advice.plain import Line
from validation.scenes.keys import described, stated
from validation.scenes.kinds import Hooks
from validation.scenes.scene import Scene
from validation.theory.stepping import Stepping

SCHEMES = {
    (0.5, 1.0): "constant acceleration",
    (0.25, 0.5): "average acceleration",
    (1 / 6, 0.5): "linear acceleration",
    (0.0, 0.5): "central differences",
}
Numbers = Callable[[str, str], Sequence[float]]  # of a solver and a metric, those that the cases have
Rows = list[tuple[str, str]]  # lines of the drawing, and the words beside each


@dataclass(frozen=True)
class Number:
    """One derived number of a case."""

    name: str
    value: float
    unit: str  # "" of a ratio
    says: str


class ShowingHooks(Hooks):
    """The model of a scene in text, its numbers, and the limits that it lies beyond."""

    module = "showing"
    no_data: frozenset[str] = frozenset()  # keys that say nothing of such scenes
    first_mode = ""  # name of the number that is the frequency of the first mode

    def bodies(self, scene: Scene, varied: Collection[str]) -> Iterator[str]:
        """Yield what a scene is made of, without varied keys."""
        yield from ()

    def springs(self, scenes: Sequence[Scene], numbers: Numbers) -> str:
        """Return what the springs of some cases are and do, by metrics of their runs; nothing where none are told."""
        return ""

    def first_frequency(self, scene: Scene, of_run: float | None) -> float | None:
        """Return the first frequency of DDA's model [rad/s]: that of its run, or of a closed form."""
        return of_run

    def drawing(self, scene: Scene, width: int | None) -> tuple[int, Rows]:
        """Return how many characters the body is wide, and the drawing's lines with their words.

        `width` is that of a line in characters; None: any number.
        """
        tables = [table for name, table in scene.tables().items() if name in scene.kind.tables]
        return 0, [("", described(*entry)) for table in tables for entry in stated(table)]

    def stepping(self, scene: Scene) -> Iterator[Line]:
        """Yield the steps, the scheme and the damping."""
        t = scene.time
        scheme = Stepping.of(scene).name
        if t.scheme == "newmark":
            scheme = f"{SCHEMES.get((t.alpha, t.delta), 'Newmark')}, alpha = {t.alpha:.4g}, delta = {t.delta:g}"
        start = "from zero acceleration" if t.start == "zero" else "from the acceleration of the load"
        yield "steps", f"{t.steps} of dt = {t.step:g} s, {start}"
        discount = f"gg_rate = {t.gg_rate:g} 1/s" if t.gg_rate is not None else f"gg = {t.discount:g}"
        yield "scheme", f"{scheme}, {discount}"
        if scene.damping.present:
            yield "damping", f"C = a0 M + a1 K, a0 = {scene.damping.mass:g} 1/s, a1 = {scene.damping.stiffness:g} s"

    def numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield the derived numbers of a case."""
        yield from ()

    def remarks(self, scene: Scene, values: Mapping[str, float]) -> Iterator[str]:
        """Yield in words the limits that a case is beyond, by its numbers."""
        yield from ()
