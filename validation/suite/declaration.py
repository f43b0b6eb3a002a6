"""Studies as the suite declares them: the engine's, with alarms and damping budgets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from validation.advice.alarms import alarms
from validation.advice.budget import budgets
from validation.advice.hooks import AdviceHooks
from validation.engine import study
from validation.engine.finished import Finished
from validation.runs.records import Annotations
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Role
from validation.solvers.registry import role


def annotated(scenes: Sequence[Scene], finished: Finished) -> Annotations:
    """Return the alarms of finished cases, and the damping budgets of the scenes that the judged method ran."""
    judged = {scene: row for (scene, solver), row in finished.rows.items() if role(solver) is Role.JUDGED}
    run_scenes = [scene for scene in scenes if scene.name in judged]
    known = (scene for scene in run_scenes if AdviceHooks.of(scene).has_budget)
    return {
        "alarms": [alarm.record() for alarm in alarms(scenes, finished)],
        "budgets": list(budgets(filter(features.linear, known))),
    }


@dataclass(frozen=True)
class Study(study.Study):
    """A study whose cases are annotated with alarms and damping budgets."""

    annotate: Callable[[Sequence[Scene], Finished], Annotations] = annotated
