"""The part ``contact`` of ``advise``: when a block opens and lands, and which steps and springs would do better."""

from __future__ import annotations

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
from validation.cli.printing.output import echo_answer

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
    from validation.advice.alarm import number
    from validation.advice.contact import RAISES
    from validation.advice.hooks import AdviceHooks
    from validation.engine.case import Case
    from validation.engine.measure import execute
    from validation.runs.run import Outcome
    from validation.scenes import features

    case = one_case(scene, assignments)
    bounds = AdviceHooks.of(case).contact_limits(case)
    if bounds is not None and penetration is not None:
        features.refuse_column(case, "advise contact with --penetration")
    scenes = contact_page.scenes(case, bounds)
    rows: dict[str, Row] = {}
    absent: dict[str, str] = {}
    runs = count()
    with _progress("contact") as progress:

        def row_of(solver: str, variant: Scene, words: str) -> Row:
            progress(next(runs), len(scenes) + 1 + RAISES, f"at most; {solver}{words}")
            row, _ = execute(Case(variant, solver), "", "contact")
            return row

        def depth(stiffness: float) -> float | None:
            """Return how deep the exact block goes on springs p [m]; each call is one more run."""
            solver = contact_page.exact()
            sprung = scenes[solver].with_values({"contact.stiffness": stiffness})
            return number(row_of(solver, sprung, f" on springs of {stiffness:.3g} N/m"), "contact.penetration")

        for name, variant in scenes.items():
            row = row_of(name, variant, f", {variant.time.steps} steps")
            if name == contact_page.own():
                refuse_bad_input(variant.name, name, row)
            if row.outcome is Outcome.COMPLETED:
                rows[name] = row
            else:
                absent[name] = f"{row.outcome.sentence} {'; '.join(row.notes)}".strip()
        data = contact_page.answer(case, rows, penetration, depth, bounds)
    echo_answer(data | {"absent": absent}, contact_page.page(case, data, absent, bounds), as_json)
    return PASSED if contact_page.own() in rows else NUMERICAL_FAILURE
