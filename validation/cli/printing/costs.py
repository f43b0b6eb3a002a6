"""What `run` says before it begins: values that were probably not meant, and how long a long run is."""

from __future__ import annotations

from collections.abc import Sequence

from validation.cli.app import print_warnings
from validation.cli.printing.output import echo
from validation.studies.catalogue import STUDIES
from validation.studies.declaration import Study

# Seconds of a study over those of `core` on the same two processors, nothing restored: only their order of size counts.
COSTS = {
    "core": 1.0,
    "two-codes": 1.5,
    "paper": 0.9,
    "literature": 0.4,
    "limits": 0.3,
    "stiff-contact": 0.3,
    "stability-small": 0.6,
    "stability": 5.5,
    "subblocks": 2.1,
    "opening": 4.3,
    "rebound": 1.1,
    "impacts": 0.8,
    "methods": 2.0,
    "slopes": 1.2,
    "creep": 3.9,
    "rocking": 0.2,
    "toppling": 0.1,
    "waves": 0.3,
    "columns": 5.0,
    "response": 0.1,
    "work-precision": 0.8,
    "field": 1.2,
    "engines": 1.2,
}
LONG = 5.0  # times `core` from which on a run announces its length
SECONDS = 20.0  # of `core`, for the example


def print_before_run(studies: Sequence[Study], quiet: bool) -> None:
    """Print on standard error the warnings of users' scenes and, unless quiet, the length of a long run."""
    for study in studies:
        if study.name not in STUDIES:  # the suite's own studies are extreme on purpose
            for scene in study.scenes:
                if not isinstance(scene, str):
                    print_warnings(scene)
    sentence = announcement([study.name for study in studies])
    if sentence is not None and not quiet:
        echo(sentence, err=True)


def announcement(studies: Sequence[str]) -> str | None:
    """Return a sentence on a long run of some studies; None for a short one, or one of scenes alone."""
    timed = [name for name in studies if name in COSTS]
    total = sum(COSTS[name] for name in timed)
    if total < LONG:
        return None
    longest = max(timed, key=lambda name: COSTS[name])
    name = timed[0] if len(timed) == 1 else f"{len(timed)} studies"
    share = f"; {longest} is {100 * COSTS[longest] / total:.0f} % of it" if len(timed) > 1 else ""
    return (
        f"{name}: {total:.0f} times the work of core, about {total * SECONDS / 60:.0f} min where core takes "
        f"{SECONDS:.0f} s{share}. Finished cases are kept and not run again"
    )
