"""The gates of the short tests: some of every scene and of every kind, of cases that there are."""

from conftest import LONG_GATES, SHORT_CASES, parts_of, short_gates

from validation.studies.own_solver.gates import gates

CASES = ("p=1,dt=1", "p=1,dt=2", "p=2,dt=1", "p=2,dt=2", "p=3,dt=2")


def test_every_scene_and_every_kind_of_gate_has_a_short_one() -> None:
    kinds = {(scene, kind) for scene, _, kind in map(parts_of, gates()) if not LONG_GATES.match(f"{scene}:{kind}")}
    short = short_gates([*gates()])
    assert {(scene, kind) for scene, _, kind in map(parts_of, short)} == kinds
    cases = {(scene, values) for scene, values, _ in map(parts_of, gates())}
    assert {(scene, values) for scene, some in SHORT_CASES.items() for values in some} <= cases


def test_cases_that_have_every_value_and_every_kind_are_short() -> None:
    names = [f"s[{case}]:dda:peak" for case in CASES]
    assert short_gates(names) == {names[0], names[3], names[4]}
    rare = "s[p=2,dt=1]:dda-fem(s[p=1,dt=1]):l2@0.2s"
    assert parts_of(rare) == ("s", "p=2,dt=1", "dda-fem:l2@0.2s")
    assert short_gates([*names, rare]) == {names[1], names[2], rare, names[4]}
    assert short_gates(["alone:dda:peak"]) == {"alone:dda:peak"}
