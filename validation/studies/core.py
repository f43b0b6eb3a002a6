"""The core study: the paper's scenes by DDA, finite elements and exact solutions, with its accuracy gates."""

from __future__ import annotations

from collections.abc import Iterator

from validation.gates.gate import Gate
from validation.scenes.scene import Scene
from validation.studies import core_damping
from validation.studies.bands import OTHER, OWN, about, cases, decimals, gate, near, printed
from validation.studies.declaration import Study
from validation.theory import spectra, statics

SCENES = (
    "figures-3-4",
    "figures-5-6",
    "figure-7",
    "figure-8",
    "figure-9",
    "model-form",
    "mesh-convergence",
    "poisson",
    "poisson-statics",
    "corner-springs",
)
EXACT_BAR = ("figures-3-4", "figures-5-6", "figure-7", "figure-8", "figure-9", "model-form")
FULL_MODEL = "figures-3-4[time.step=0.002]"

# Numbers of an independent computation outside this project, as printed there: half a unit of the last digit is
# their uncertainty and the band. Settling: scene -> steps of displacement and pressure.
SETTLING = {
    "figures-3-4[time.step=0.01]": (5, 7),
    "figures-3-4[time.step=0.002]": (44, 45),
    "figures-5-6[contact.stiffness=1e+10]": (22, 25),
    "figures-5-6[contact.stiffness=1e+11]": (21, 24),
}
MODEL_FORM = {  # dt -> relative L2 of DDA against the bar over 0.2 s, displacement and pressure, in percent
    "0.01": (0.81, 0.67),
    "0.002": (3.63, 4.03),
    "0.001": (8.97, 10.4),
    "0.0001": (63.6, 73.9),
}
WINDOWS = {0.02: 20.9, 0.1: 54.7}  # s -> relative L2 of the pressure at the shortest step, in percent
PEAKS = {"0.01": 0.90, "0.002": 2.62, "0.001": 4.73, "0.0001": 10.42}  # dt -> first peak of the pressure, in percent
FE_STATICS = {"1e+09": -9.871e-3, "1e+10": -5.306e-3, "1e+11": -4.840e-3}  # m, mu = 0.3, distributed foundation
CORNER_DRIFT = {4: -0.0212, 8: -0.0263, 16: -0.0310, 32: -0.0356, 64: -0.0402}  # m, linear elements, p = 1E
TENSION = (
    ("model-form[time.step=0.001,time.steps=200]", "dda", -0.435e6, 5e2),
    ("model-form[time.step=0.0001,time.steps=2000]", "bar", -1.18e6, 5e3),
)  # Pa, half a unit of the last digit


def gates() -> tuple[Gate, ...]:
    """Return all gates of the core study."""
    return (
        *gates_of_statics(),
        *settling(),
        *frequencies(),
        *damping(),
        *mesh(),
        *model_form(),
        *poisson(),
        *code(),
        *drift(),
        *core_damping.gates(SCENES),
    )


def gates_of_statics() -> Iterator[Gate]:
    """Yield the gates on equilibrium and on what the histories tend to."""
    metric = "displacement.static"
    why = "closed form of static equilibrium; the band is rounding: 1e4 eps, conditioning of the static system"
    for scene in cases("figures-5-6", "poisson-statics"):
        value = statics.static_displacement(scene)
        yield gate(scene, "dda", metric, near(value, 1e4 * spectra.EPS), why)
    why = "mu = 0: every mesh holds the linear static field; band: rounding of a sparse solution"
    for scene in cases("figures-5-6"):
        yield gate(scene, "fem", metric, near(statics.static_displacement(scene), 1e-9), why)
    why = "independent program, four digits: half a unit of the last"
    for scene in cases("poisson-statics"):
        yield printed(scene.name, ("fem",), metric, FE_STATICS[f"{scene.contact.stiffness:g}"], 5e-7, why)
    why = (
        "the contact pressure tends to q: what damping has left of the motion at the last step, exp(-xi w t), twice "
        "for the second mode"
    )
    for scene in cases("figures-3-4"):
        remaining_motion = spectra.remaining_motion(scene)
        yield gate(scene, "dda", "pressure.final", near(scene.load.pressure, 2 * remaining_motion + 1e-9), why)


def settling() -> Iterator[Gate]:
    """Yield the gates on settling steps, which are whole numbers."""
    why = "first step from which the value stays within 1 % of static; independent program, whole number"
    for name, steps in SETTLING.items():
        for quantity, count in zip(("displacement", "pressure"), steps, strict=True):
            yield gate(name, "dda", f"{quantity}.settling_step", (count, count), why, OTHER)


def frequencies() -> Iterator[Gate]:
    """Yield the gates on the first axial frequency: DDA, bar, elements, and the model form between them."""
    block = "root of the two-unknown frequency equation; band: rounding"
    elements = (
        "quadratic elements overestimate by the interpolation error's energy (spectra.mesh_frequency_error); "
        "a tenth for the next order, 2e-11 for the eigenvalue solver"
    )
    form = "model form, physics: one strain against a wave; ratio of the two closed forms"
    for scene in cases("figures-5-6"):
        w_dda = spectra.dda_frequency(scene)
        w_bar = spectra.bar_frequency(scene)
        error = spectra.mesh_frequency_error(scene)
        name = scene.name
        metric = "mode1.frequency"
        yield gate(name, "dda", metric, near(w_dda, 1e-12), block)
        yield gate(name, "bar", metric, near(w_bar, 1e-12), "b tan b = 2p/E; band: rounding")
        yield gate(name, ("fem", "bar"), metric, (0.9 * error - 2e-11, 1.1 * error + 2e-11), elements)
        yield gate(name, ("dda", "bar"), metric, near(w_dda / w_bar - 1, 1e-10), form)


def damping() -> Iterator[Gate]:
    """Yield the gates on the damping ratio of the first axial mode, from the operator and from the history."""
    operator = "trace and determinant of one step at the closed-form frequency; band: rounding of the logarithm"
    for scene in cases(*EXACT_BAR):
        frequency_of = {"dda": spectra.dda_frequency(scene), "bar": spectra.bar_frequency(scene)}
        for solver, frequency in frequency_of.items():
            value = spectra.damping_ratio(scene, frequency)
            if abs(spectra.roots(scene, frequency)[0].imag) >= 1e-6:
                yield gate(scene, solver, "mode1.damping", about(value, 1e-10 * abs(value) + 1e-12), operator)
    history = "matrix pencil on the displacement: the history holds the ratio that the operator has, to 1e-6"
    for scene in cases("figures-3-4", "figure-8", "figure-9"):
        value = spectra.damping_ratio(scene, spectra.dda_frequency(scene))
        if scene.time.step < 0.01:
            yield gate(scene, "dda", "mode1.measured_damping", about(value, 1e-6), history)


def mesh() -> Iterator[Gate]:
    """Yield the gates on finite elements against the bar, which they converge to."""
    why = (
        "quadratic elements, 32 a side, constant acceleration, dt >= 1e-3: the front is resolved and the error is of "
        "fourth order in h; two programs never agree to the last bit"
    )
    for scene in cases("figures-3-4", "figures-5-6"):
        for metric in ("displacement.max", "pressure.max"):
            yield gate(scene, ("fem", "bar"), metric, (1e-15, 1e-6), why)
    yield from dispersion()
    why = "one column of elements is exact where nothing depends on x; band: rounding of the full model"
    for metric in ("displacement.max", "pressure.max"):
        yield gate(FULL_MODEL, ("fem", "fem:full"), metric, (0, 1e-11), why)


def dispersion() -> Iterator[Gate]:
    """Yield the gates on the mesh error of weakly damped waves, which is that of the elements' dispersion."""
    for scene in cases("figure-7", "figure-8", "figure-9", "mesh-convergence"):
        if scene.time.alpha == 0.5 and scene.time.step >= 1e-3:
            continue  # the figure's constant acceleration: damped within the window, judged with Figures 3 to 6
        why = (
            f"spectra.mesh_error: every mode b turns (b/n)^4 / 1440 too fast, "
            f"{spectra.elements_per_front(scene):.3g} elements per c dt; the shapes' own error, of the next "
            "order, takes up to a quarter off"
        )
        for quantity, value in spectra.mesh_error(scene).items():
            yield gate(scene, ("fem", "bar"), f"{quantity}.l2", (0.75 * value, 1.1 * value), why)


def model_form() -> Iterator[Gate]:
    """Yield the gates on what a block with one strain cannot do, over a fixed window."""
    why = (
        "model form, physics, over 0.2 s: independent program, half a unit of its last digit; agreement grows with dt "
        "because both are damped"
    )
    for scene in cases("model-form"):
        percents = MODEL_FORM[f"{scene.time.step:g}"]
        for quantity, percent in zip(("displacement", "pressure"), percents, strict=True):
            half = decimals(percent)
            edges = (percent - half) / 100, (percent + half) / 100
            yield gate(scene, ("dda", "bar"), f"{quantity}.l2", edges, why, OTHER, half / 100, until=0.2)
    why = "first peak of the pressure, which no window changes: independent program, half a unit of its last digit"
    for scene in cases("model-form"):
        excess = PEAKS[f"{scene.time.step:g}"]
        yield printed(scene.name, ("dda", "bar"), "pressure.peak", excess / 100, 5e-5, why)
    why = (
        "a relative L2 difference is mostly one of phase where little is damped and grows with its window: independent "
        "program, half a unit of its last digit"
    )
    shortest = min(cases("model-form"), key=lambda scene: scene.time.step)
    for until, percent in WINDOWS.items():
        half = decimals(percent) / 100
        yield printed(shortest.name, ("dda", "bar"), "pressure.l2", percent / 100, half, why, until=until)
    why = "the locked contact carries tension: independent program, half a unit of its last digit"
    for name, solver, value, half in TENSION:
        yield printed(name, (solver,), "pressure.minimum", value, half, why)


def poisson() -> Iterator[Gate]:
    """Yield the gates at Poisson's ratio 0.25, where the finest mesh is the reference."""
    coarse, middle, fine = (scene.name for scene in cases("poisson"))
    why = (
        "distance from the finest mesh: it falls five to six times a halving, the corners' singular stress keeps it "
        "from sixteen; so the finest mesh is within a quarter of the middle one's distance"
    )
    for quantity, steps in (("displacement", (1.3e-4, 2.2e-5)), ("pressure", (2.4e-5, 4.4e-6))):
        for name, value in zip((coarse, middle), steps, strict=True):
            yield gate(name, ("fem", "fem"), f"{quantity}.l2", (value / 1.5, value * 1.5), why, OWN, against=fine)
    why = "model form, physics, at mu = 0.25: both meshes that are finer than four give this to its last digit"
    for quantity, percent in (("displacement", 2.753), ("pressure", 2.958)):
        edges = (percent - 0.01) / 100, (percent + 0.01) / 100
        yield gate(fine, ("dda", "fem"), f"{quantity}.l2", edges, why, OWN, 6e-6)


def code() -> Iterator[Gate]:
    """Yield the gates on the robust form against the printed recursion, which has the same solution at mu = 0."""
    why = (
        "same equations, rounding apart: 10 eps per step, times 1 + 2p/E lost in the spring force and 1/Omega^2 lost "
        "in the increment"
    )
    for scene in cases("figures-3-4", "figures-5-6", "figure-8", "figure-9"):
        for metric in ("displacement.max", "pressure.max"):
            yield gate(scene, ("dda", "dda-textbook"), metric, (0, rounding(scene)), why)


def rounding(scene: Scene) -> float:
    """Relative distance of two sound programs' histories for mu = 0: the band of `code`."""
    omega2 = (spectra.dda_frequency(scene) * scene.time.step) ** 2
    soft = 1 + 2 * scene.contact.stiffness / scene.block.young
    return 10 * spectra.EPS * scene.time.steps * soft * max(1.0, 1 / omega2)


def drift() -> Iterator[Gate]:
    """Yield the gates on corner point springs, whose answer drifts with log h and has no limit."""
    why = "no fine-mesh limit under point springs: independent program, three digits"
    for scene in cases("corner-springs"):
        value = CORNER_DRIFT[scene.fem.per_side]
        yield printed(scene.name, ("fem",), "displacement.static", value, 5e-5, why)


CORE = Study(
    name="core",
    title="The two-block model by DDA, finite elements and exact solutions",
    purpose="The paper's scenes, each by DDA, by a fine mesh on the same springs and by the exact bar, "
    "with the same Newmark parameters.",
    scenes=SCENES,
    extra=((FULL_MODEL, "fem:full"),),
    gates=gates,
    derived=lambda: core_damping.derived(SCENES),
)
