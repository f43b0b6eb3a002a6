"""ntdda as a solver: two histories that it wrote, for the scenes they are of; of polygons the program itself."""

from pathlib import Path
from typing import ClassVar

from peers import ntdda_live
from validation.diagnosis.reading import read
from validation.scenes import features
from validation.scenes.scene import load_scene

PLACE = Path("docs") / "examples" / "ntdda"  # in the repository, which has one copy of them
# Its scene beside a history, and what that says otherwise: the contacts of the program do not pull.
PRESSED = ("ntdda-p1E-dt2ms_meas.m", "scene.toml", {"contact.law": "unilateral"})
ON_SLOPE = ("ntdda-phi22-slope20-dt2ms_meas.m", "slope.toml", {})
# How DDA steps and iterates is in the data; Poisson's ratio is 0 in them, and shear springs are idle without a slope.
UNREAD = {
    "scheme", "alpha", "delta", "rho_inf", "split", "start", "allow_unstable", "steps",
    "rule", "rules", "solve_limit", "cut", "penetration", "hypothesis",
}  # fmt: skip
GIVEN_ONCE = {
    "side",
    "width",
    "height",
    "vertices",
    "gg",
    "gg_rate",
    "shear_stiffness",
}  # in `facts` as one value


class Histories:
    """The two histories of ntdda that the repository has; blocks in the plane by the program, where it is on PATH."""

    handles = frozenset(
        feature.name for feature in features.FEATURES
    )  # each field is compared: what differs is refused
    about: ClassVar = {
        "program": "ntdda (Berkeley line of DDA, in C)",
        "version": "not stated in its files",
        "recipe": "its histories are in docs/examples/ntdda; of blocks in the plane a command ntdda on PATH",
        "model": "two blocks, the lower one held by 21 stiff points; geometry anew at every step; own weight added",
        "settings": "those of the runs: 2 ms, constant acceleration with alpha = 1/2, delta = 1",
    }

    def solve(self, scene):
        """Return the first rows of the history whose problem the scene poses, or what the program answers.

        Raises
        ------
        NotImplementedError
            There is none, or the histories are not here; the program is not, or cannot express the scene.
        """
        if scene.kind.name == "plane":
            return ntdda_live.solve(scene)
        if scene.kind.name != "block":
            raise NotImplementedError(f"a history is data: those here are of a block, not of {scene.kind_in_words}")
        file, beside, otherwise = ON_SLOPE if scene.load.gravity else PRESSED
        own = load_scene(directory() / beside).with_values(otherwise)
        written_for = facts(own)
        for field, value in facts(scene).items():
            if value != written_for[field]:
                its, asked = (f"{x:g}" if isinstance(x, float) else x for x in (written_for[field], value))
                raise NotImplementedError(f"a history is data: it was written for {field} = {its}, not {asked}")
        found = read(directory() / file)
        steps = scene.time.steps
        if steps > len(found.time):
            raise NotImplementedError(f"a history is data: it was written for {len(found.time)} steps, not {steps}")
        columns = {"displacement": found.displacement, "horizontal_displacement": found.sideways}
        return {name: values[:steps] for name, values in columns.items() if values is not None}


def directory():
    """Return where the histories are.

    Raises
    ------
    NotImplementedError
        The adapter was installed away from its repository.
    """
    found = Path(__file__).resolve().parents[3] / PLACE
    if not found.is_dir():
        raise NotImplementedError("the histories are in docs/examples/ntdda of the repository")
    return found


def facts(scene):
    """Return what the motion of a block depends on, by field."""
    tables = {name: getattr(scene, name) for name in ("block", "contact", "load", "time", "damping")}
    found = {
        f"{name}.{key}": value
        for name, table in tables.items()
        for key, value in table.model_dump(by_alias=True).items()
        if key not in UNREAD | GIVEN_ONCE
    }
    shear = scene.contact.shear if scene.load.gravity else None
    one = {"block.outline": scene.block.outline, "contact.shear_stiffness": shear, "time.gg": scene.time.discount}
    return found | one | {"run.geometry": scene.run.geometry}
