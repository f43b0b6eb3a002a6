"""The gallery in a real browser: formulas as in Python, calculators as the command line, keyboard, widths, dark, print.

Skipped by name where there is no Chromium or no Playwright; continuous integration installs both.
"""

from __future__ import annotations

import json
import math
import re
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SCENE, typed
from gallery.browser import absent, chromium

from dda.scheme import spectral
from fem_reference.events.restitution import ContactScheme, statistics
from validation.advice import rayleigh
from validation.advice.advice import SEARCHES
from validation.engine import run_study
from validation.gallery import site
from validation.gallery.calculators import CALCULATORS
from validation.results import Results
from validation.scenes.scene import Scene, load_scene
from validation.suite.folders import scene_study
from validation.theory import landing, restitution, spectra
from validation.theory.rebound import rebound_statistics, spring_steps
from validation.theory.stepping import Stepping
from validation.theory.waves import Column

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(absent() is not None, reason=f"the browser is NOT RUN: {absent()}"),
]
EQUAL = 1e-12
SETTINGS = 10
SCHEMES = ((0.5, 1.0), (0.25, 0.5), (0.5625, 1.0), (0.3025, 0.6), (0.4, 0.7))


@pytest.fixture(scope="module")
def gallery(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("site")
    swept = SCENE + '\n[run]\nsolvers = ["dda", "bar"]\n\n[sweep]\n"time.step" = [0.002, 0.001]\n'
    gates = "".join(
        f'\n[[gate]]\npair = ["{pair}"]\nmetric = "{metric}"\nband = {band}\nreason = "reason of {metric}"\n'
        for pair, metric, band in (("dda", "pressure.final", "[0, 1e9]"), ("bar", "displacement.peak", "[1, 2]"))
    )
    (place / "swept.toml").write_text(swept + gates)
    kept = Results(place / "results")
    run_study(scene_study(str(place / "swept.toml")), kept)
    return site.build(kept, place / "gallery").parent


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture
def opened(browser: Any, gallery: Path) -> Iterator[Callable[..., Any]]:
    """Return a function that opens a page from its file and holds it to say nothing and to ask no network."""
    said: list[str] = []
    contexts = []

    def open_page(name: str, width: int = 1400, **options: Any) -> Any:
        context = browser.new_context(viewport={"width": width, "height": 900}, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: said.append(f"{name}: {message.text}"))
        page.on("pageerror", lambda error: said.append(f"{name}: {error}"))
        page.on("request", lambda request: request.url.startswith(("file:", "data:")) or said.append(request.url))
        file, _, settings = name.partition("#")
        page.goto(f"{(gallery / file).as_uri()}#{settings}" if settings else (gallery / file).as_uri())
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert said == []


# ---- formulas -------------------------------------------------------------------------------------------------------


def random_settings() -> Iterator[dict[str, float]]:
    """Yield settings as an engineer might choose them."""
    random = np.random.default_rng(20)
    for i in range(SETTINGS):
        alpha, delta = SCHEMES[i % len(SCHEMES)]
        yield {
            "alpha": alpha,
            "delta": delta,
            "gg": 1.0 if i % 3 == 0 else float(random.uniform(0.9, 1.0)),
            "step": float(10 ** random.uniform(-4.5, -1.5)),
            "stiffness_ratio": float(10 ** random.uniform(-1, 3)),
            "side": float(random.uniform(0.5, 5)),
            "density": float(random.uniform(1500, 3000)),
            "young": float(10 ** random.uniform(8, 10.5)),
            "frequency": float(10 ** random.uniform(0, 2)),
            "wavelengths": float(random.uniform(1, 20)),
            "target": float(10 ** random.uniform(-2.5, -0.4)),
            "rho_inf": float(random.uniform(0.5, 1)),
        }


METHODS = ("newmark", "chung-hulbert", "hht", "wbz", "composite", "leapfrog")


def stepping_of(s: dict[str, Any]) -> Stepping:
    """Return the stepping of settings with a method."""
    if s["method"] == "newmark":
        return Stepping(s["step"], s["alpha"], s["delta"], s["gg"])
    return Stepping.named(s["method"], s["step"], s["gg"], None if s["method"] == "leapfrog" else s["rho_inf"])


def contact_settings() -> Iterator[dict[str, float]]:
    """Yield settings of one contact: of engines, and of a spring with a dashpot."""
    random = np.random.default_rng(32)
    for _ in range(SETTINGS):
        step = float(10 ** random.uniform(-4, -2))
        yield {
            "mass": float(10 ** random.uniform(0, 5)),
            "step": step,
            "hertz": float(10 ** random.uniform(0, 2)),
            "damping_ratio": float(random.uniform(0, 12)),
            "erp": float(random.uniform(0.05, 1)),
            "cfm": float(10 ** random.uniform(-9, -3)),
            "timeconst": float(random.uniform(2.1, 10) * step),
            "dampratio": float(random.uniform(0.2, 3)),
            "dmax": float(random.uniform(0.5, 0.99)),
            "stiffness": float(10 ** random.uniform(5, 10)),
            "e": float(random.uniform(0.01, 1)),
            "zeta": float(random.uniform(0, 3)),
            "rho_inf": float(random.uniform(0.5, 1)),
            "alpha": 0.3,
            "delta": 0.6,
        }


def scene_of(s: dict[str, float]) -> Scene:
    values = {f"time.{name}": s[name] for name in ("alpha", "delta", "gg", "step")}
    values |= {f"block.{name}": s[name] for name in ("side", "density", "young")}
    return load_scene("figures-3-4").with_values(values | {"contact.stiffness": s["stiffness_ratio"] * s["young"]})


def block_of(s: dict[str, float]) -> dict[str, float]:
    block = {name: s[name] for name in ("density", "young")}
    return block | {"width": s["side"], "height": s["side"], "stiffness": s["stiffness_ratio"] * s["young"]}


def agrees(shown: Any, expected: Any, scale: float = 0.0) -> None:
    """Hold numbers to 1e-12 of themselves, or of a scale; None in the page stands for no number."""
    if isinstance(expected, dict):
        assert shown.keys() == expected.keys()
        for name, value in expected.items():
            agrees(shown[name], value, scale)
    elif isinstance(expected, list | tuple):
        assert len(shown) == len(expected)
        for one, other in zip(shown, expected, strict=True):
            agrees(one, other, scale)
    elif expected is None or math.isnan(expected):
        assert shown is None or math.isnan(shown)
    else:
        assert shown == expected or abs(shown - expected) <= EQUAL * max(abs(expected), scale), (shown, expected)


@pytest.mark.parametrize("name", ["trace", "determinant", "spectral_radius", "damping_ratio", "period_elongation"])
def test_formulas_of_a_step(opened: Callable[..., Any], name: str) -> None:
    page = opened("damping.html")
    for s in random_settings():
        for omega in (1e-6, 0.01, 0.5, 2.0, 7.0, 1e6):
            given = [omega, s["alpha"], s["delta"], s["gg"]]
            scale = 1.0 if name == "period_elongation" else 0.0  # a difference from one
            agrees(page.evaluate(f"v => formulas.{name}(...v)", given), float(getattr(spectral, name)(*given)), scale)


def test_formulas_of_the_block(opened: Callable[..., Any]) -> None:
    page = opened("damping.html")
    for s in random_settings():
        scene, block = scene_of(s), block_of(s)
        agrees(page.evaluate("v => formulas.dda_frequency(v)", block), spectra.dda_frequency(scene))
        agrees(page.evaluate("v => formulas.contact_frequency(v)", block), spectra.contact_frequency(scene))
        agrees(page.evaluate("v => formulas.base_frequency(v)", block), landing.quarter_mass_frequency(scene))
        given = [s["alpha"], s["delta"], s["gg"]]
        agrees(page.evaluate("v => formulas.critical_omega(...v)", given), spectral.critical_omega(*given))


@pytest.mark.parametrize("solve_for", ["dt", "gg", "scheme"])
def test_formulas_of_the_adviser(opened: Callable[..., Any], solve_for: str) -> None:
    page = opened("adviser.html")
    limited = [s | {"alpha": 0.2, "delta": 0.6} for s in random_settings()]  # beyond a step the highest mode grows
    for s in (*random_settings(), *limited):
        scene = scene_of(s)
        first, other = spectra.dda_frequency(scene), spectra.contact_frequency(scene)
        search = SEARCHES[solve_for](scene, first, max(first, other))
        expected = sorted(map(search.value, search.solutions(s["target"])))
        found = page.evaluate(
            "([s, block, kind]) => formulas.advise(s, block, s.target, kind)", [s, block_of(s), solve_for]
        )
        if expected:
            agrees(found["values"], expected)
        if ends := search.ends():
            least, greatest = min(map(search.at, ends)), max(map(search.at, ends))
            agrees([found["reach"]["least"], found["reach"]["greatest"]], [least, greatest], scale=abs(greatest))


def test_formulas_of_a_wave(opened: Callable[..., Any]) -> None:
    page = opened("wave.html")
    for s in random_settings():
        stepping = Stepping(s["step"], s["alpha"], s["delta"], s["gg"])
        column = Column(s["side"], s["density"], s["young"])
        w2 = stepping.squared_frequency([2 * math.pi * s["frequency"]])[0]
        agrees(
            page.evaluate("s => formulas.squared_frequency(s, 2 * Math.PI * s.frequency)", s),
            [w2.real, w2.imag],
            abs(w2),
        )
        k = column.wavenumber([w2])[0]
        given = {"height": s["side"], "density": s["density"], "young": s["young"], "w2": [w2.real, w2.imag]}
        agrees(page.evaluate("v => formulas.wavenumber(v, v.w2)", given), [k.real, k.imag], abs(k))
        agrees(
            page.evaluate("s => formulas.ratio(s, s.frequency)", s),
            float(rayleigh.ratio(stepping, s["frequency"])),
            1.0,
        )
        left, speed = column.travelled(stepping, [2 * math.pi * s["frequency"]], distance=50.0)
        found = page.evaluate("([v, s]) => formulas.passage(v, s, s.frequency, 50)", [given, s])
        agrees([1 - found["loss"], found["speed_error"]], [float(left[0]), float(speed[0])], 1.0)


def test_formulas_of_a_rebound(opened: Callable[..., Any]) -> None:
    page = opened("rebound.html")
    for i, s in enumerate(random_settings()):
        omega = float(10 ** np.linspace(-1.5, 1.0, SETTINGS)[i])
        found = page.evaluate("([s, omega]) => formulas.impact_statistics(s, omega)", [s, omega])
        expected = statistics(ContactScheme(s["alpha"], s["delta"], s["gg"]), omega)
        names = {"mean": expected.mean, "low": expected.low, "high": expected.high, "energy": expected.mean_square}
        agrees(found, names, 1.0)


@pytest.mark.parametrize("method", METHODS)
def test_formulas_of_every_scheme(opened: Callable[..., Any], method: str) -> None:
    page = opened("damping.html")
    for s in random_settings():
        s |= {"method": method}
        stepping = stepping_of(s)
        for omega in (0.05, 0.5, 1.3, 4.0):
            # far beyond critical the roots of a step lie together, and lose digits
            if abs(stepping.roots(omega)[0].imag) > 1e-3:
                names = ("step_ratio", "step_radius", "step_elongation")
                shown = page.evaluate(f"v => [{', '.join(f'formulas.{name}(...v)' for name in names)}]", [s, omega])
                known = [stepping.damping_ratio(omega), stepping.spectral_radius(omega), stepping.period_error(omega)]
                assert shown == pytest.approx(known, rel=1e-10, abs=1e-12), (s, omega)
        if method != "composite":  # which has no squared frequency
            w2 = stepping.squared_frequency([2 * math.pi * s["frequency"]])[0]
            shown = page.evaluate("s => formulas.squared_frequency(s, 2 * Math.PI * s.frequency)", s)
            agrees(shown, [w2.real, w2.imag], abs(w2))
        limit = page.evaluate("s => formulas.step_limit(s)", s)
        agrees(limit, stepping.critical_omega)
        assert page.evaluate("s => formulas.solves(s)", s) == stepping.solves


@pytest.mark.parametrize("method", METHODS)
def test_rebounds_of_every_scheme(opened: Callable[..., Any], method: str) -> None:
    page = opened("rebound.html")
    for i, s in enumerate(random_settings()):
        s |= {"method": method}
        omega = float(10 ** np.linspace(-1, 0.2 if method == "leapfrog" else 2.0, SETTINGS)[i])
        zeta = 0.2 * (i % 3)
        if zeta:
            s["gg"] = 1.0
        known = rebound_statistics(spring_steps(stepping_of(s).stages, omega, s["gg"], zeta), s["gg"])
        names = {"mean": known.mean, "low": known.least, "high": known.most, "energy": known.mean_square}
        agrees(page.evaluate("([s, w, z]) => formulas.rebound_statistics(s, w, z)", [s, omega, zeta]), names, 10.0)


def test_formulas_of_a_dashpot(opened: Callable[..., Any]) -> None:
    page = opened("dashpot.html")
    for zeta in (0.0, 0.05, 0.3, 1.0, 1.5, 20.0):
        for clipped in (True, False):
            shown = page.evaluate("v => formulas.restitution(...v)", [zeta, clipped])
            agrees(shown, restitution.restitution(zeta, clipped))
    for e in (1.0, 0.9, 0.5, 0.01):
        agrees(page.evaluate("e => formulas.ratio_of_restitution(e)", e), restitution.damping_ratio(e))


# ---- calculators, as the command line --------------------------------------------------------------------------------


def set_page(page: Any, s: dict[str, float], **choices: str) -> dict[str, Any]:
    """Fill the form of a calculator and return its answer."""
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    for name, value in choices.items():
        page.select_option(f"#{name}", value)
    for field in page.locator("form input[type=number]").all():
        if field.is_visible():  # the others do not go with what is chosen
            field.fill(repr(s[field.get_attribute("name")]))
    found: dict[str, Any] = page.evaluate("document.querySelector('.calculator').answer.values")
    return found


def told(page: Any) -> Any:
    """Return what the command answers that the page names."""
    words = shlex.split(page.locator(".command").inner_text())
    done = typed(*words[1:], "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def allowed(s: dict[str, float]) -> dict[str, float]:
    """Return settings within the limits of the pages, with a step that every scheme takes."""
    return s | {"step": min(s["step"], 0.02)}


def test_the_damping_budget_is_that_of_the_command(opened: Callable[..., Any]) -> None:
    page = opened("damping.html")
    for s in map(allowed, random_settings()):
        shown, data = set_page(page, s), told(page)
        for mode in data["modes"]:
            own = shown["modes"][mode["name"]]
            agrees(own["frequency"], mode["frequency"])
            agrees(
                [own["damping"], own["algorithmic"], own["kinetic"]],
                [mode[n] for n in ("damping", "algorithmic", "kinetic")],
                1.0,
            )
            agrees(own["radius"], mode["spectral_radius"])


@pytest.mark.parametrize("method", METHODS[1:])
def test_the_damping_budget_of_another_scheme_is_that_of_the_command(opened: Callable[..., Any], method: str) -> None:
    page = opened("damping.html")
    s = next(random_settings()) | {"step": 1e-4, "gg": 1.0}
    shown, data = set_page(page, s, method=method), told(page)
    for mode in data["modes"]:
        own = shown["modes"][mode["name"]]
        assert [own["damping"], own["radius"]] == pytest.approx([mode["damping"], mode["spectral_radius"]], rel=1e-9)


@pytest.mark.parametrize("engine", ["box2d", "bullet", "mujoco", "spring"])
def test_contacts_of_engines_are_those_of_the_command(opened: Callable[..., Any], engine: str) -> None:
    page = opened("engines.html")
    for s in contact_settings():
        shown, data = set_page(page, s, engine=engine), told(page)
        for name in ("stiffness", "damping", "damping_ratio", "restitution", "rest_penetration", "determinant"):
            assert shown[name] == pytest.approx(data[name], rel=1e-9, abs=1e-14), (engine, name)
        forms = data["forms"]["box2d"] | data["forms"]["bullet"] | data["forms"].get("mujoco", {})
        for name in ("hertz", "erp", "cfm", "timeconst"):
            assert shown[name] == (pytest.approx(forms[name], rel=1e-9) if name in forms else None), (engine, name)


@pytest.mark.parametrize("given", ["restitution", "damping_ratio"])
def test_a_dashpot_is_that_of_the_command(opened: Callable[..., Any], given: str) -> None:
    page = opened("dashpot.html")
    for s in contact_settings():
        shown, data = set_page(page, s, solve_for=given), told(page)
        assert [shown["e"], shown["c"]] == pytest.approx([data["restitution"], data["damping"]], rel=1e-9, abs=1e-12)


def test_hidden_damping_of_all_schemes_is_that_of_theory(opened: Callable[..., Any]) -> None:
    page = opened("schemes.html")
    for s in map(allowed, random_settings()):
        shown = set_page(page, s)
        assert set(shown) == {"(1/2, 1)", "(1/4, 1/2)", "CH 0", "CH", "HHT", "WBZ", "composite", "leapfrog"}
        for name, method in (("CH", "chung-hulbert"), ("HHT", "hht"), ("WBZ", "wbz"), ("composite", "composite")):
            stepping = Stepping.named(method, s["step"], rho_inf=s["rho_inf"])
            for key, w in (("at", 2 * math.pi * s["frequency"]), ("first", spectra.dda_frequency(scene_of(s)))):
                known = stepping.damping_ratio(w * s["step"])
                assert shown[name][key] == (None if math.isnan(known) else pytest.approx(known, rel=1e-6, abs=1e-9))
            assert shown[name]["solves"] == pytest.approx(stepping.solves / s["step"])


@pytest.mark.parametrize("solve_for", ["dt", "gg", "scheme"])
def test_the_adviser_is_that_of_the_command(opened: Callable[..., Any], solve_for: str) -> None:
    page = opened("adviser.html")
    for s in map(allowed, random_settings()):
        shown = set_page(page, s, solve_for=solve_for)
        agrees(shown["values"], [solution["value"] for solution in told(page)["solutions"]])


def test_the_wave_loss_is_that_of_the_command(opened: Callable[..., Any]) -> None:
    page = opened("wave.html")
    for s in map(allowed, random_settings()):
        shown, present = set_page(page, s), told(page)["present"]
        names = ("loss", "delay", "damping")
        agrees([shown[n] for n in names], [present[n] for n in names], max(1.0, s["wavelengths"]))


def test_the_rebound_is_that_of_a_rigid_quarter_of_the_mass(opened: Callable[..., Any]) -> None:
    page = opened("rebound.html")
    for s in map(allowed, random_settings()):
        s["step"] = min(s["step"], 1e-3)  # fifty of which the exact bar follows in seconds
        shown, omega = set_page(page, s), landing.quarter_mass_frequency(scene_of(s)) * s["step"]
        agrees(shown["omega"], omega)
        if shown["statistics"] is not None:
            known = statistics(ContactScheme(s["alpha"], s["delta"], s["gg"]), omega)
            names = {"mean": known.mean, "low": known.low, "high": known.high, "energy": known.mean_square}
            agrees(shown["statistics"], names, 1.0)
        assert told(page)["needed"]["steps_now"] is not None


# ---- pages -----------------------------------------------------------------------------------------------------------

PAGES = ("index", "study-swept", "scene-swept", *(calculator.id for calculator in CALCULATORS))


@pytest.mark.parametrize("width", [400, 1400])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_fit_their_window_and_say_nothing(opened: Callable[..., Any], width: int, scheme: str) -> None:
    for name in PAGES:
        page = opened(f"{name}.html", width, color_scheme=scheme)
        assert page.evaluate("document.documentElement.scrollWidth") <= width, name
        for chart in page.locator(".chart").all():
            assert chart.locator("canvas").count() == 1, name
        text, ground = page.evaluate(
            "['color', 'backgroundColor'].map(n => getComputedStyle(document.documentElement)[n])"
        )
        assert (light(text) > light(ground)) == (scheme == "dark"), name


def light(color: str) -> int:
    return sum(map(int, re.findall(r"\d+", color)[:3]))


def test_every_control_is_reached_and_named(opened: Callable[..., Any]) -> None:
    for name in PAGES:
        page, met = opened(f"{name}.html"), []
        for _ in range(150):
            page.keyboard.press("Tab")
            here = page.evaluate(
                "(() => { const one = document.activeElement; if (one === document.body) return null;"
                " const label = one.labels && one.labels.length ? one.labels[0].textContent : '';"
                " return [one.tagName, (one.ariaLabel || label || one.textContent || '').trim()]; })()"
            )
            if here is None:
                break
            met.append(here)
        assert met and all(label for _, label in met), (name, met)
        assert met[0][1] == "Skip to the content"
        wanted = page.locator("input:visible, select:visible, button:visible, a[href]:visible").count()
        assert len(met) >= wanted, (name, len(met), wanted)


def test_a_slider_moves_by_keys_and_answers(opened: Callable[..., Any]) -> None:
    page = opened("damping.html")
    page.locator("[data-for=step]").focus()
    before = page.locator(".modes").inner_text()
    page.keyboard.press("ArrowRight")
    assert float(page.locator("#step").input_value()) > 0.002
    assert page.locator(".modes").inner_text() != before
    page.locator("#step").fill("-1")
    assert "must be from 1e-06 to 1" in page.locator(".wrong").inner_text()
    page.locator("button[type=reset]").click()
    page.wait_for_function("document.querySelector('.wrong').hidden")
    assert page.locator(".modes").inner_text() == before


def test_the_address_holds_the_settings_of_a_calculator(opened: Callable[..., Any]) -> None:
    page = opened("adviser.html")
    page.locator("#step").fill("0.003")
    page.select_option("#solve_for", "gg")
    assert page.url == page.evaluate("document.querySelector('.share').href")
    facts = page.locator(".facts").inner_text()
    sent = opened(f"adviser.html#{page.url.partition('#')[2]}")
    assert sent.locator("#step").input_value() == "0.003" and sent.locator("#solve_for").input_value() == "gg"
    assert sent.locator(".facts").inner_text() == facts
    foreign = opened("adviser.html#solve_for=luck&step=&alpha=x&no_such_name=1")
    assert foreign.locator(".wrong").is_hidden() and foreign.locator("#solve_for").input_value() == "dt"
    page.locator("button[type=reset]").click()
    page.wait_for_function("!location.hash")


def test_histories_show_values_and_zoom(opened: Callable[..., Any]) -> None:
    page = opened("scene-swept.html")
    chart = page.locator(".histories .chart")
    chart.focus()
    page.keyboard.press("ArrowRight")
    assert re.search(r"dda:?\s*−\d", chart.locator(".u-legend").inner_text())
    page.select_option("[name=case]", "1")
    page.select_option("[name=column]", "contact_pressure")
    box = chart.locator(".u-over").bounding_box()
    page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 50, steps=5)
    page.mouse.up()
    page.mouse.move(box["x"] + 1, box["y"] + 50)
    first = float(chart.locator(".u-legend .u-value").first.inner_text())
    assert 0.008 < first < 0.018  # a quarter of 0.05 s
    chart.focus()
    page.keyboard.press("0")
    page.mouse.move(box["x"] + 2, box["y"] + 50)
    page.wait_for_function("parseFloat(document.querySelector('.u-legend .u-value').textContent) < 0.003")


def test_verdicts_filter_and_lead_to_their_reasons(opened: Callable[..., Any]) -> None:
    page = opened("study-swept.html")
    rows, said = page.locator(".gates tbody tr"), page.locator("form.filter output")
    assert rows.count() == 4 and said.inner_text() == "4 of 4 gates"
    page.locator("[name=words]").fill("0.001 displacement")
    assert rows.count() == 1 and said.inner_text() == "1 of 4 gates"
    page.locator("[name=words]").fill("")
    page.locator("[value=FAIL]").uncheck()
    assert set(page.locator(".gates td:first-child").all_inner_texts()) == {"PASS"}
    rows.first.locator("a").click()
    assert "reason of pressure.final" in page.locator(".reasons li:target").inner_text()


def test_printed_pages_have_no_controls_and_all_verdicts(opened: Callable[..., Any]) -> None:
    page = opened("study-swept.html", 900, color_scheme="dark")
    page.emulate_media(media="print", color_scheme="dark")
    assert not page.locator("nav").is_visible() and not page.locator("form.filter").is_visible()
    assert light(page.evaluate("getComputedStyle(document.documentElement).color")) == 0
    assert page.locator(".gates tbody tr").count() == 4
    assert len(page.pdf()) > 10_000
    page = opened("scene-swept.html", 1400, color_scheme="dark")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")  # charts are drawn anew, on white and as wide as a page
    assert page.locator(".histories .uplot").bounding_box()["width"] <= 680
    dark = (
        "(() => { const c = document.querySelector('canvas');"
        " const all = c.getContext('2d').getImageData(0, 0, c.width, c.height);"
        " let n = 0; for (let i = 0; i < all.data.length; i += 4) n += all.data[i + 3] > 200 && all.data[i] < 60;"
        " return n; })()"
    )
    assert page.evaluate(dark) > 100  # the exact bar is black again
