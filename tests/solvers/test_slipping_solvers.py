"""The exact motion with friction as a solver: where it cannot go on."""

from oracles.stated_scenes import made

from fem_reference.events import block_events
from fem_reference.events.switches import NoContactStateError
from validation.runs.run import Outcome
from validation.solvers.registry import get_solver


def test_a_motion_that_cannot_go_on_is_a_named_outcome(tmp_path, monkeypatch):
    def stuck(*_args):
        raise NoContactStateError("no state of the corners agrees with the motion at 0.5 s")

    monkeypatch.setattr(block_events, block_events.solve.__name__, stuck)
    run = get_solver("block-events").prepare(made("sliding", tmp_path)).run()
    assert run.outcome is Outcome.NO_CONTACT_STATE
    assert run.history is None
    assert "at 0.5 s" in run.notes[0]
