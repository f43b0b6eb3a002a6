"""The part ``contact`` of ``advise``: when a block opens and lands, and which steps and springs would do better."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli.app import (
    NUMERICAL_FAILURE,
    PASSED,
    JsonOption,
    SceneArgument,
    SetOption,
    _progress,
    one_case,
    parts,
    refuse_bad_input,
)
from validation.cli.printing.output import broken, echo_answer
from validation.runs.progress import Progress

if TYPE_CHECKING:
    from validation.runs.row import Row
    from validation.scenes.scene import Scene


@parts.command()
def contact(
    scene: SceneArgument,
    penetration: Annotated[
        float | None, typer.Option("--penetration", help="Largest penetration, in m. (1e-4 if not stated)", min=1e-12)
    ] = None,
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Show when a block opens and lands, against the exact motions, and which springs keep a penetration.

    Example: [bold]dda-validate advise contact unlocked-constant --set time.step=0.001 --set time.steps=50[/bold]

    The contact must be unilateral; --set contact.law=unilateral unlocks a locked scene. Of a column whose contacts
    open or slip it says the solves of the open-close iteration, and which to allow: advise contact columns-weight
    """
    from validation.advice import contact_page
    from validation.advice.hooks import AdviceHooks
    from validation.scenes import features

    case = one_case(scene, assignments)
    bounds = AdviceHooks.of(case).contact_limits(case)
    if bounds is not None and penetration is not None:
        features.refuse_column(case, "advise contact with --penetration")
    scenes = contact_page.scenes(case) if bounds is None else contact_page.column_scenes(case)
    with _progress("contact") as progress:
        rows, absent = _rows(scenes, progress)
        if bounds is None:
            probe = _probe(scenes[contact_page.exact()], progress, len(scenes))
            data = contact_page.answer(case, rows, penetration, probe)
            lines = contact_page.page(case, data, absent)
        else:
            data = contact_page.column_answer(case, rows, bounds)
            lines = map(broken, contact_page.column_page(case, bounds, data, absent))
    echo_answer(data | {"absent": absent}, lines, as_json)
    return PASSED if contact_page.own() in rows else NUMERICAL_FAILURE


def _probe(scene: Scene, progress: Progress, before: int) -> Callable[[float], float | None]:
    """Return the function of p that says how deep the exact block goes [m]; each call of it is one more run."""
    from validation.advice.contact import RAISES
    from validation.advice.contact_page import exact
    from validation.engine.case import Case
    from validation.engine.measure import execute

    runs = count(before)

    def depth(stiffness: float) -> float | None:
        progress(next(runs), before + 1 + RAISES, f"at most; {exact()} on springs of {stiffness:.3g} N/m")
        row, _ = execute(Case(scene.with_values({"contact.stiffness": stiffness}), exact()), "", "contact")
        value = row.metrics.get("contact.penetration")
        return value if isinstance(value, float) else None

    return depth


def _rows(scenes: dict[str, Scene], progress: Progress) -> tuple[dict[str, Row], dict[str, str]]:
    """Return the rows of the runs that completed, and why the others have none.

    Raises
    ------
    InputError
        The judged method does not take the scene.
    """
    from validation.advice.contact import RAISES
    from validation.advice.contact_page import own
    from validation.engine.case import Case
    from validation.engine.measure import execute
    from validation.runs.run import Outcome

    rows = {}
    absent = {}
    for number, (name, scene) in enumerate(scenes.items()):
        progress(number, len(scenes) + 1 + RAISES, f"at most; {name}, {scene.time.steps} steps")
        row, _ = execute(Case(scene, name), "", "contact")
        if name == own():
            refuse_bad_input(scene.name, name, row)
        if row.outcome is Outcome.COMPLETED:
            rows[name] = row
        else:
            absent[name] = f"{row.outcome.sentence} {'; '.join(row.notes)}".strip()
    return rows, absent
