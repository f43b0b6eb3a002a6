"""Every number that a command prints, with its unit: computed apart, or kept by hand in a results directory."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import typed
from made_cases import between, kept_study, line_in, made_history, made_row
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from validation import advice, cli_damping, cli_tables, cli_verdicts, figures, load_scene, solve
from validation.chapters_curves import style_of
from validation.claims import page
from validation.gates import Gate, judge
from validation.history import Outcome, read_csv
from validation.paper import CLAIMS
from validation.results import Results
from validation.spectra import Damping, ModeDamping, parts, runs, sentence
from validation.verdicts import changes, markdown

OPTIONS = ("--set", "time.gg=0.98")
CASE = load_scene("figures-3-4").with_values(
    {"time.step": 0.002, "time.steps": 50, "time.gg": 0.98, "fem.elements": 4, "fem.degree": 1}
)


def frequencies() -> np.ndarray:
    """Both axial frequencies of the 2 m block at p = E = 1e9, from (v, ey)."""
    stiffness = np.array([[2e9, -2e9], [-2e9, 4e9 + 2e9]])
    return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(np.diag([10800.0, 3600.0]), stiffness)).real))


def of_scheme(omega: float, gg: float) -> tuple[float, float, float]:
    """Return xi, |lambda| and w/w' - 1 under constant acceleration, from trace and determinant of a step."""
    beta = 1 + omega**2 / 2
    trace = 1 - omega**2 / (2 * beta) + gg * (1 - omega**2 / beta)
    roots = np.roots([1.0, -trace, gg * (1 - omega**2 / (2 * beta))])
    log = np.log(complex(roots[0]))
    return float(-log.real / abs(log)), float(np.abs(roots).max()), float(omega / abs(log) - 1)


# ---- damping ------------------------------------------------------------------------------------------------------


def test_damping_prints_each_mode_in_per_cent_and_radians_a_second(scene_file: Path) -> None:
    lines = typed("damping", scene_file, *OPTIONS).stdout.splitlines()
    w = frequencies()[0]
    xi, radius, elongation = of_scheme(0.002 * w, 0.98)
    own = of_scheme(0.002 * w, 1.0)[0]
    rate = -math.log(0.98) / 0.002
    assert lines[0] == (
        f"At dt = 0.002 s the first axial mode ({w:.4g} rad/s) is damped at {100 * xi:.3g} % of critical, "
        f"{100 * own:.3g} % algorithmic and {100 * (xi - own):.3g} % kinetic; {lines[0].partition('; ')[2]}"
    )
    assert lines[2] == f"gg = 0.98 per step, c = {rate:.4g} 1/s"
    heads = re.split(r"\s{2,}", lines[3])
    assert heads == ["mode", "w [rad/s]", "w dt", "xi [%]", "algorithmic", "kinetic", "|lambda|", "w/w' - 1"]
    shown = dict(zip(heads, re.split(r"\s{2,}", lines[4]), strict=True))
    numbers = [float(shown[name]) for name in heads[1:]]
    assert shown["mode"] == "first axial"
    wanted = [w, 0.002 * w, 100 * xi, 100 * own, 100 * (xi - own), radius, elongation]
    assert numbers == pytest.approx(wanted, rel=2e-3)  # three digits are printed
    assert float(re.split(r"\s{2,}", lines[5])[1]) == pytest.approx(frequencies()[1], rel=1e-5)


def test_damping_prints_the_first_modes_of_the_references(scene_file: Path) -> None:
    """Of the bar b tan b = 2, b = 1.0769, w = (b/2) sqrt(E/rho)."""
    lines = typed("damping", scene_file, *OPTIONS).stdout.splitlines()
    (bar,) = [re.split(r"\s{2,}", line) for line in lines if line.startswith("bar, first")]
    w = 1.0768740 / 2 * math.sqrt(1e9 / 2700)
    assert [float(bar[1]), float(bar[2])] == pytest.approx([w, 100 * of_scheme(0.002 * w, 0.98)[0]], rel=1e-3)


def mode(**changes: Any) -> ModeDamping:
    values = {"name": "first axial", "frequency": 300.0, "damping": 0.05, "spectral_radius": 0.875, "omega_dt": 0.6,
              "algorithmic": 0.04, "kinetic": 0.01, "period_elongation": 0.1, "least_root": 0.1}  # fmt: skip
    return ModeDamping(**(values | changes))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "is damped at 5 % of critical, 4 % algorithmic and 1 % kinetic"),
        ({"kinetic": 0.0}, "is damped at 5 % of critical, all of it algorithmic"),
        ({"algorithmic": 0.0}, "is damped at 5 % of critical, all of it kinetic"),
        ({"damping": 1.5}, "is overdamped at 150 % of critical, 4 % algorithmic and 1 % kinetic"),
        ({"least_root": -0.95, "omega_dt": 7.25}, "flips sign every step and keeps 87.5 % of itself per step "
         "(w dt = 7.25)"),
        ({"damping": None}, "has no damping ratio (a root is not positive) and keeps 87.5 % of itself per step"),
        ({"spectral_radius": 1.25}, "grows by 1.25 per step"),
        ({"damping": 0.0, "spectral_radius": 1.0}, "is not damped"),
    ],
)  # fmt: skip
def test_a_mode_is_told_in_words_with_its_numbers(changes: dict[str, Any], words: str) -> None:
    assert runs(mode(**changes)) == words
    assert parts(mode(algorithmic=None)) == "kinetic and algorithmic"
    contact = mode(name="contact", least_root=-0.95, omega_dt=7.25)
    assert sentence(CASE, [mode(**changes), mode(name="mode 2"), contact]) == (
        f"At dt = 0.002 s the first axial mode (300 rad/s) {words}; the contact mode {runs(contact)}."
    )


def test_what_is_not_known_of_a_mode_is_a_dash(capsys: pytest.CaptureFixture[str]) -> None:
    found = Damping("s", 0.002, 0.0, None, (mode(damping=None, period_elongation=None),), {}, "It is so.")
    cli_damping._print_damping(found)
    lines = capsys.readouterr().out.splitlines()
    assert lines[2] == "gg = 0 per step"
    assert re.split(r"\s{2,}", lines[4])[3:] == ["-", "4", "1", "0.875", "-"]


# ---- advise -------------------------------------------------------------------------------------------------------


def test_advise_prints_ratio_settling_and_errors_of_what_it_advises(scene_file: Path) -> None:
    done = typed("advise", scene_file, "--damping", "0.05").stdout
    facts = dict(re.findall(r"^  (\S.*?)  +(.*)$", done, re.MULTILINE))
    (step,) = (float(text) for text in re.findall(r"time.step = (\S+)", done))
    assert of_scheme(step * frequencies()[0], 1.0)[0] == pytest.approx(0.05, rel=1e-6)
    assert float(facts["damping ratio"].removesuffix(" %")) == pytest.approx(5.0, rel=1e-6)
    settled = re.fullmatch(r"(\d+) steps = (\S+) s \(from the history\)", facts["displacement settles"])
    assert settled and float(settled[2]) == pytest.approx(int(settled[1]) * step, rel=1e-3)
    steps = round(0.1 / step)  # the scene's 50 steps of 2 ms
    case = load_scene(scene_file).with_values({"time.step": step, "time.steps": steps})
    for name in ("fem", "continuum"):
        told = re.fullmatch(r"displacement (\S+) %, pressure (\S+) % over (\S+) s \(relative L2\)",
                            facts[f"differs from {name} by"])  # fmt: skip
        assert told
        a, b = solve(case, "dda"), solve(case, name)
        want = [100 * np.linalg.norm(x - y) / np.linalg.norm(y) for x, y in
                ((a.displacement, b.displacement), (a.contact_pressure, b.contact_pressure))]  # fmt: skip
        assert [float(told[i]) for i in (1, 2, 3)] == pytest.approx([*want, steps * step], rel=1e-2)


def solution(**changes: Any) -> advice.Solution:
    values = {"value": 0.003, "damping": 0.05, "settling_steps": 40, "settling_seconds": 0.12,
              "settling_from": "envelope", "alpha": 0.6, "delta": 1.1, "step": 0.003, "gg": 0.97, "gg_rate": 10.15,
              "settings": {"time.step": 0.003}, "contact": None}  # fmt: skip
    return advice.Solution(**(values | changes))


def test_facts_of_a_solution_are_told_with_their_units() -> None:
    flipping = mode(name="contact", least_root=-0.95, omega_dt=7.25)
    error = {"window": 0.4, "fem": {"displacement": 0.0123, "pressure": 0.045}, "continuum": {"not applicable": "so"}}
    assert cli_damping._facts(solution(contact=flipping), error) == [
        ("  damping ratio", "5 %"),
        ("  discount", "gg = 0.97 per step, c = 10.15 1/s"),
        ("  displacement settles", "40 steps = 0.12 s (from the envelope)"),
        ("  contact mode", runs(flipping)),
        ("  differs from fem by", "displacement 1.23 %, pressure 4.5 % over 0.4 s (relative L2)"),
        ("  differs from continuum by", "so"),
    ]
    never = cli_damping._facts(solution(settling_steps=None, settling_seconds=None), {})
    assert never[2] == ("  displacement settles", "never (from the envelope)")


@pytest.mark.parametrize(
    ("solve_for", "words"),
    [
        ("dt", "Set dt = 0.003 s: the first axial mode of the DDA block is then damped at 5 % of critical and the "
         "displacement settles within 40 steps (0.12 s); gg = 0.98 acts per step, so that refining dt at this gg does "
         "not converge."),
        ("gg", "Set gg = 0.003 per step (c = 10.15 1/s): the first axial mode of the DDA block is then damped at 5 % "
         "of critical and the displacement settles within 40 steps (0.12 s); this gg belongs to dt = 0.003 s, at "
         "another dt keep the rate c."),
        ("scheme", "Set delta = 0.003, alpha = 0.6: the first axial mode of the DDA block is then damped at 5 % of "
         "critical and the displacement settles within 40 steps (0.12 s)."),
    ],
)  # fmt: skip
def test_the_advice_in_one_sentence(solve_for: str, words: str) -> None:
    assert advice._sentence(CASE, solve_for, 0.05, [solution()], (None, None, None, None)) == words


def test_the_advice_names_the_solution_whose_contact_flips() -> None:
    flipping = mode(name="contact", least_root=-0.95, omega_dt=7.25)
    found = [solution(), solution(value=0.009, contact=flipping, settling_steps=9, settling_seconds=0.081)]
    text = advice._sentence(CASE, "dt", 0.05, found, (None, None, None, None))
    assert text.startswith("Set dt = 0.003 s or dt = 0.009 s: ") and "by each of them" in text
    assert "within 40 steps (0.12 s) or 9 steps (0.081 s), but the contact mode flips sign" in text
    assert "per step (w dt = 7.25) at dt = 0.009 s; gg" in text


@pytest.mark.parametrize(
    ("target", "words"),
    [
        (0.5, "at 50 % of critical: the greatest that can be reached is 30 %, at dt = 0.02 s."),
        (0.01, "at 1 % of critical: the least that can be reached is 2 %, at dt = 0.001 s."),
    ],
)
def test_what_is_out_of_reach_is_told_with_where_the_end_is(target: float, words: str) -> None:
    assert advice._sentence(CASE, "dt", target, [], (0.02, 0.001, 0.3, 0.02)).endswith(words)


# ---- solve and run ------------------------------------------------------------------------------------------------


def test_solve_prints_the_last_values_and_the_duration(scene_file: Path, tmp_path: Path) -> None:
    done = typed("solve", scene_file, "--solver", "bar", "--csv", tmp_path / "h.csv")
    history = read_csv(tmp_path / "h.csv")
    assert done.stdout.startswith(
        f"small bar: 50 steps to t = 0.1 s; last: displacement {history.displacement[-1]:.6g}, "
        f"contact_pressure {history.contact_pressure[-1]:.6g}; "
    )
    assert history.time[-1] == pytest.approx(0.1) and history.displacement[-1] != history.displacement[0]


def test_the_table_of_a_run_shows_value_band_and_seconds_of_its_own_gate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    results, scene = Results(tmp_path), load_scene("figures-3-4").with_values({"time.step": 0.002}, label=True)
    rows = [made_row("dda", {}, scene.name, seconds={"setup": 1.25, "stepping": 2.5}),
            made_row("bar", {}, scene.name, seconds={"a": 7.0}, outcome=Outcome.OVERFLOW, notes=("at 3",))]  # fmt: skip
    alarms = [{"kind": kind, "scene": name, "sentence": said} for kind, name, said in
              (("hidden tension", "a", "x"), ("hidden tension", "a", "y"), ("hidden tension", "b", "z"),
               ("contact ringing", "a", "w"), ("fixed discount", "c", "dt is varied"))]  # fmt: skip
    kept_study(results, [(scene, row, None) for row in rows], alarms=alarms)
    gate = Gate(scene.name, ("dda", "bar"), "displacement.l2", 0.031, 0.042, "the reason", until=0.2)
    cli_tables.print_verdicts([judge(gate, 0.0512), judge(gate, 0.04)], results, ["made"])
    lines = capsys.readouterr().out.splitlines()
    shown = [line.split() for line in lines if line.strip().startswith("figures-3-4[")]
    middle = ["dda", "|", "bar", "displacement.l2@0.2s"]
    assert [row[1:] for row in shown] == [
        [*middle, "0.0512", "0.031", "..", "0.042", "FAIL", "3.75"],
        [*middle, "0.04", "0.031", "..", "0.042", "PASS", "3.75"],
    ]
    assert lines[-1] == "1 PASS, 1 FAIL, 0 NOT RUN" and f"FAIL: {gate.id}: the reason" in " ".join(lines)
    cli_tables.print_alarms(results, ["made"])
    told = capsys.readouterr()
    assert told.out == "alarms: hidden tension in 2 cases, contact ringing in 1 case (see the report)\n"
    assert told.err == "warning: c: dt is varied\n"
    assert cli_tables.print_failures(results, ["made"]) is False
    assert capsys.readouterr().out == f"{scene.name} bar: overflow: {Outcome.OVERFLOW.sentence} at 3\n"


# ---- verdicts side by side ----------------------------------------------------------------------------------------


def verdict(name: str, word: str, value: object, study: str = "s") -> dict[str, Any]:
    return {"study": study, "id": name, "verdict": word, "value": value, "band": [0.25, 0.75], "reason": "why"}


OLD = [verdict("a", "PASS", 0.5), verdict("b", "FAIL", 0.125), verdict("c", "PASS", 0.3)]
NEW = [verdict("a", "FAIL", 0.875), verdict("b", "FAIL", 0.1), OLD[2], verdict("d", "NOT RUN", None, "t")]


def test_a_summary_shows_counts_values_bands_and_what_changed_from_and_to() -> None:
    lines = markdown(NEW, changes(OLD, NEW[:3])).splitlines()
    assert lines[0] == "## dda-validation: 1 PASS, 2 FAIL, 1 NOT RUN"
    assert lines[2] == "| study | PASS | FAIL | NOT RUN |"
    assert lines[4:6] == ["| s | 1 | 2 | 0 |", "| t | 0 | 0 | 1 |"]
    assert "| gate | value | band | why |" in lines and "| `a` | 0.875 | 0.25 .. 0.75 | why |" in lines
    assert "| `d` | - | 0.25 .. 0.75 | why |" in lines
    assert lines[-4:] == [
        "| change | gate | verdict | value |",
        "|---|---|---|---|",
        "| worse | `a` | PASS → FAIL | 0.5 → 0.875 |",
        "| value | `b` | FAIL | 0.125 → 0.1 |",
    ]


def test_differences_are_printed_as_before_and_after(capsys: pytest.CaptureFixture[str]) -> None:
    cli_verdicts._print_changes(changes(OLD, NEW[:3]))
    lines = [line.split() for line in capsys.readouterr().out.splitlines() if line.strip()]
    assert lines[0] == ["change", "study", "gate", "before", "after"]
    assert lines[2:4] == [
        ["worse", "s", "a", "PASS", "0.5", "FAIL", "0.875"],
        ["value", "s", "b", "FAIL", "0.125", "FAIL", "0.1"],
    ]
    assert " ".join(lines[-1]) == "2 gates differ: 1 worse, 1 value"


# ---- rows and plot ------------------------------------------------------------------------------------------------


@pytest.fixture
def made(tmp_path: Path) -> Results:
    """Return three steps of DDA and one of the bar, with work, seconds and differences from the bar."""
    results, cases, pairs = Results(tmp_path / "results"), [], []
    for k, step in enumerate((0.01, 0.002, 0.001)):
        scene = load_scene("figures-3-4").with_values({"time.step": step}, label=True)
        row = made_row("dda", {"pressure.peak": 6e6 + k}, scene.name, work={"solves": 10**k},
                       seconds={"setup": 0.5, "stepping": 1.0 + k})  # fmt: skip
        cases.append((scene, row, made_history(step, np.ones(3))))
        pairs.append(between(scene.name, "dda", "bar", displacement_l2=0.1 * (3 - k), pressure_l2=0.0))
    cases.append((scene, made_row("bar", {}, scene.name, seconds={"setup": 9.0}), None))
    kept_study(results, cases, pairs)
    return results


def test_rows_are_written_under_their_names(made: Results, tmp_path: Path) -> None:
    done = typed("rows", "made", "--csv", tmp_path / "a.csv", "--results", made.directory)
    with (tmp_path / "a.csv").open(newline="") as stream:
        lines = list(csv.DictReader(stream))
    assert done.stdout == f"wrote {tmp_path / 'a.csv'}: 4 rows, {len(lines[0])} columns\n"
    names = ("solver", "work.solves", "seconds.total", "pressure.peak", "bar:displacement.l2")
    assert [tuple(line[name] for name in names) for line in lines] == [
        ("dda", "1", "1.5", "6000000.0", repr(0.1 * 3)),
        ("dda", "10", "2.5", "6000001.0", "0.2"),
        ("dda", "100", "3.5", "6000002.0", "0.1"),
        ("bar", "", "9.0", "", ""),
    ]


def test_plot_draws_x_over_y_and_leaves_out_what_is_not_positive(
    made: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    caught: list[Figure] = []
    monkeypatch.setattr(figures, "save", lambda figure, path: caught.append(figure) or path)
    columns = ("--x", "work.solves", "--y", "bar:displacement.l2")
    assert typed("plot", "made", *columns, "--out", tmp_path / "a.svg", "--results", made.directory).returncode == 0
    (axes,) = caught[0].axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("work.solves", "bar:displacement.l2")
    x, y = line_in(axes, to_hex(style_of("figures-3-4 dda").color))
    assert (list(x), list(y)) == ([1, 10, 100], pytest.approx([0.3, 0.2, 0.1]))
    nothing = typed("plot", "made", "--y", "bar:pressure.l2", "--results", made.directory)
    assert nothing.returncode == 2 and "must be columns with positive numbers" in nothing.stderr


# ---- claims -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rest", [3e-15, -8e-14, 0.0])
def test_the_page_of_claims_says_zero_of_what_rounding_leaves_and_is_the_same_everywhere(rest: float) -> None:
    numbers = {"verdict": 2.0, "rest": rest, "share": 0.0123456, "other": "undefined", "small": 3.456e-11}
    text = page(CLAIMS[:1], [{"name": CLAIMS[0].id, "metrics": numbers}])
    assert f"## {CLAIMS[0].id}: confirmed\n" in text
    assert "**Measured:** rest 0; share 0.01235; other undefined; small 3.5e-11." in text


def test_claims_are_listed_with_their_verdicts(tmp_path: Path) -> None:
    derived = [{"scene": "claims", "name": name, "metrics": {"verdict": verdict}} for name, verdict in
               (("C1", 2.0), ("C2", 0.0), ("C6", 1.0))]  # fmt: skip
    Results(tmp_path).write_json("studies/paper.json", {"study": "paper", "derived": derived})
    lines = {line.split()[0]: line for line in typed("claims", "--results", tmp_path).stdout.splitlines()}
    words = {name: line[5:32].strip() for name, line in lines.items()}
    assert [words[name] for name in ("C1", "C2", "C6", "C3")] == [
        "confirmed", "refuted", "confirmed under a condition", "not run",
    ]  # fmt: skip
