"""The scenes that the first pages speak of, looked up in whatever studies a results directory holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from validation.report.chapters.data import CaseGroup, CaseResults, Groups, case_groups
from validation.report.front.closed import ratio_of
from validation.runs.results import Results
from validation.scenes import features
from validation.scenes.scene import Scene

PAPER = "figures-3-4"


def groups_of_studies(results: Results, studies: Sequence[str]) -> dict[str, CaseGroup]:
    """Return the scenes of all studies by name, each as the first study has it, without histories."""
    groups: dict[str, CaseGroup] = {}
    for study in studies:
        for group in case_groups(results, results.manifest(study), drawn=False):
            groups.setdefault(group.name, group)
    return groups


def paper_scene(groups: Groups) -> Scene | None:
    """Return the paper's block as the results have it; None where DDA finished none that the closed forms are for."""
    group = groups.get(PAPER)
    if group is None or not any("dda" in case.rows and case.rows["dda"].metrics for case in group.cases):
        return None
    scene = group.cases[0].scene
    block = scene.stated_block
    has_closed_forms = block is not None and block.vertices is None and block.poisson == 0 and features.linear(scene)
    return scene if has_closed_forms else None


def case_where(group: CaseGroup | None, fits: Callable[[Scene], bool]) -> CaseResults | None:
    """Return the first case of a group whose scene fits."""
    return next((case for case in group.cases if fits(case.scene)), None) if group else None


def at_ratio(ratio: float, alpha: float | None = None) -> Callable[[Scene], bool]:
    """Return the question whether a scene has this p/E, and this alpha if one is named."""
    return lambda scene: abs(ratio_of(scene) / ratio - 1) < 1e-9 and alpha in (None, scene.time.alpha)


def by_step(group: CaseGroup | None) -> list[CaseResults]:
    """Return the cases of a group from the longest step to the shortest."""
    return sorted(group.cases, key=lambda case: -case.scene.time.step) if group else []
