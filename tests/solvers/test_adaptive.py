"""Self-adaptive kinetic damping: the rule, its energies, its rest, and who refuses it."""

import pytest

import dda
import fem_reference
from validation import advise, damping, load_scene, response
from validation.advice.wave_advice import advise_wave
from validation.diagnosis.judgement import compare
from validation.errors import InputError
from validation.solvers.dda import model_of
from validation.solvers.fem import problem_of

COLUMNS = ("displacement", "contact_pressure", "discount", "kinetic_damping_loss")
STEPPED = {"time.step": 5e-4, "time.steps": 150, "run.columns": COLUMNS}
PLAIN = load_scene("figures-3-4").with_values(STEPPED | {"fem.elements": 3})
BLOCK = PLAIN.with_values({"damping.kinetic": "adaptive"})


def test_who_needs_a_linear_motion_refuses_it() -> None:
    asks = (
        lambda: damping(BLOCK),
        lambda: response(BLOCK, [1.0], "fem"),
        lambda: advise(BLOCK, 0.05),
        lambda: advise_wave(BLOCK, 5.0, 0.1),
        lambda: compare(BLOCK, None),  # type: ignore[arg-type]
    )
    for ask in asks:
        with pytest.raises(InputError, match="self-adaptive damping"):
            ask()


def test_settings_that_do_not_go_together_are_refused() -> None:
    for values, named in (({"time.gg": 0.9}, "time: gg"), ({"damping.floor": 1.5}, "damping.floor")):
        with pytest.raises(InputError, match=named):
            BLOCK.with_values(values)
    with pytest.raises(InputError, match="floor goes with"):
        PLAIN.with_values({"damping.floor": 0.5})
    block, mesh = model_of(PLAIN), problem_of(PLAIN)
    for scheme in ((0.5, 1.0, 0.9, 1e-3), (0.5, 1.0, 1.0, 1e-3, "zero", 1.0)):
        with pytest.raises(ValueError, match="adapt"):
            dda.solve(block, dda.Scheme(*scheme), 3, floor=0.0)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="adapt"):
            fem_reference.solve_adaptive(mesh, fem_reference.Scheme(*scheme), 3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="floor"):
        dda.solve(block, dda.Scheme(0.5, 1.0, 1.0, 1e-3), 3, floor=-0.1)
    with pytest.raises(ValueError, match="floor"):
        fem_reference.solve_adaptive(mesh, fem_reference.Scheme(0.5, 1.0, 1.0, 1e-3), 3, floor=-0.1)
