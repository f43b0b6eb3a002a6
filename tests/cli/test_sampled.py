"""Gates for a disagreement are not proposed; modes are told where samples show an alias of them."""

from validation.advice.coarse import KINDS
from validation.cli.printing import tables


def compared(scene, value):
    return {"scene": scene, "solver": "dda", "reference": "fem", "metrics": {"displacement.l2": value}}


def test_a_gate_is_proposed_for_what_agrees():
    bands = {0.034: "0.04", 0.4999: "0.5", 0.0051: "0.006", 0.0: "0.1"}
    for value, band in bands.items():
        lines = list(tables._next([compared("s", value), compared("t", 0.01)], [], True))
        assert [line.split()[3].rstrip("]") for line in lines if "band" in line] == [band], lines
    for value in (0.5, 1.02, 1.5e47):
        assert "[[gate]]" not in "\n".join(tables._next([compared("s", value)], [], True))


def test_a_gate_is_proposed_for_a_scene_that_its_steps_resolve():
    """The first of several alarms of a scene is told, of the first scene; an alarm of another kind is none of steps."""
    told = [(KINDS[0], "s", "one"), (KINDS[0], "s", "two"), (KINDS[0], "t", "three"), ("tension", "u", "four")]
    alarms = [{"kind": kind, "scene": scene, "sentence": sentence} for kind, scene, sentence in told]
    coarse = " ".join(tables._next([compared("s", 0.1), compared("t", 0.1)], alarms, True))
    assert "one" in coarse and not any(word in coarse for word in ("two", "three", "[[gate]]"))
    assert "[0.0, 0.02]" in " ".join(tables._next([compared("s", 0.1), compared("u", 0.02)], alarms, True))
