"""The command ``show``: a scene before anything runs."""

from __future__ import annotations

from validation.cli.app import JsonOption, SceneArgument, SetOption, app, print_warnings, stated_scene
from validation.cli.printing.output import echo, echo_json


@app.command()
def show(scene: SceneArgument, assignments: SetOption = None, as_json: JsonOption = False) -> None:
    """Show a scene before anything runs: model, steps, wave speed, frequencies, w dt, and the limits of its step.

    Of a scene with a sweep each number is shown as its range over the cases.

    Example: [bold]dda-validate show figures-3-4[/bold] or [bold]dda-validate show my-scene.toml --set
    time.step=0.001[/bold]
    """
    from validation.cli.printing import scene_page
    from validation.cli.printing.output import terminal_width

    stated = stated_scene(scene, assignments)
    print_warnings(stated)
    if as_json:
        echo_json(scene_page.as_data(stated))
    else:
        echo("\n".join(scene_page.page(stated, scene, terminal_width())))
