"""The command ``show``: a scene before anything runs."""

from __future__ import annotations

import shlex

from validation.cli.app import JsonOption, SceneArgument, SetOption, app, print_warnings, stated_scene
from validation.cli.printing.output import echo_json


@app.command()
def show(scene: SceneArgument, assignments: SetOption = None, as_json: JsonOption = False) -> None:
    """Show a scene before anything runs: model, steps, wave speed, frequencies, w dt, and the limits of its step.

    Of a scene with a sweep each number is shown as its range over the cases.

    Example: [bold]dda-validate show figures-3-4[/bold] or [bold]dda-validate show my-scene.toml --set
    time.step=0.001[/bold]
    """
    from validation.cli.printing.output import print_blocks, terminal_width
    from validation.report.blocks import Heading, Paragraph
    from validation.report.scene.page import SceneDescription, as_data

    stated = stated_scene(scene, assignments)
    print_warnings(stated)
    if as_json:
        echo_json(as_data(stated))
        return
    title = Heading(f"{stated.name}: {stated.title or 'a scene'}")
    description = SceneDescription.of(stated).blocks(terminal_width())
    print_blocks([title, *description, Paragraph(f"next: dda-validate run {shlex.quote(scene)}")])
