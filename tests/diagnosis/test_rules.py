"""Rules of the diagnosis over tables of cases on both sides of their limits, as numbers kept in `numbers.toml`."""

import itertools
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.few_moves import FEW
from oracles.kept_answers import said
from oracles.stand_ins import assert_kept, share, summed

from validation import load_scene
from validation.diagnosis import (
    causes,
    contact_force,
    evidence,
    families,
    one_change,
    readings,
    schemes,
    search,
    stepping,
)
from validation.diagnosis.evidence import Departure
from validation.diagnosis.fits import bar
from validation.diagnosis.fits.fit import NAMED, NUMBERS, _side, bounds, is_factor, named
from validation.diagnosis.fits.target import Target
from validation.diagnosis.moves import OF_NTDDA, Move, moves
from validation.diagnosis.numbers import CandidateChange, fixed
from validation.diagnosis.one_change import Fitted
from validation.diagnosis.reading import Foreign, Stepping, steppings
from validation.diagnosis.readings import Slip
from validation.diagnosis.scene_keys import assignments
from validation.diagnosis.search import Explanation, Verdict
from validation.diagnosis.variant import Rectangle, Variant, own_variant, rectangle_of

KEPT = Path(__file__).with_name("numbers.toml")
BLOCK = Rectangle(2.0, 1.5, 2700.0, 1e9, 0.0, False, 2e9, 1.5e9, 5e6)
OWN = Variant(0.5, 1.0, 0.99)
SCENE = load_scene("figures-3-4")
N = np.arange(1, 9)
STEPS = np.full(40, 5e-4)
IDS = ("gg", "scheme", "hht", "contact-dashpot", "springs-factor", "own-weight", "viscous-damping", "dead-band")

MOVES = [
    *(Move("gg", {"gg": 1.0}), Move("scheme", {}, ("alpha", "delta"), (0.3,)), *FEW),
    *(Move("start", {"start": "consistent"}), Move("hht", {"family": "hht", "spectral": 0.2})),
    Move("generalised-alpha", {"family": "chung-hulbert"}, ("spectral",), (0.5, 0.9)),
    *(Move("load-factor", {"load": 0.8}), Move("young-factor", {}, ("young",), (1.3,))),
    Move("reported-point", {"point": 1.0}),
    Move("dead-band", {"opens": True, "band": 1e-3, "reopening": OF_NTDDA}),
]

LIMITS = [*MOVES[-5:], Move("dead-band", {}, ("band",)), Move("opening-tension", {"opens": True}, ("hold",))]


def departures():
    """Yield first rows and manners of departures, and growths."""
    for rows in (5, 24, 45):
        t = np.arange(1, rows + 1) / rows
        swing = np.exp(-2 * t) * np.cos(9 * t)
        expected = swing - 1
        late = np.cos(9.2 * t) * np.exp(-2 * t)
        for change in (0.04 * t**0, 0.1 * swing, -0.3 * t * swing, late - swing, 0 * t, 9e-4 * t, 2.2e-3 * t):
            for noise in (0.0, 4e-4):
                yield asdict(evidence.measured(expected, expected + change, 3 * np.arange(rows) + 2, noise))
        manners = (0.04 * t**0, 0.1 * swing, -0.3 * t * swing, late - swing, 0.01 * np.gradient(swing, t))
        for first, second, part in itertools.product(manners, manners, (0.2, 0.4, 0.6)):
            yield evidence.measured(expected, expected + part * first - (1 - part) * second, np.arange(rows), 0.0).kind
        for factor in (1.0, 1.3, 2.5):
            grows = factor ** np.arange(float(rows))
            yield evidence.growth(grows, 0 * t + 1), evidence.growth(grows, 50 * t), evidence.growth(0 * t, 0 * t)
            yield asdict(evidence.unbounded(0 * t + 1, grows, np.arange(rows)))
    single_rows = [("displacement", 7, 0.03), ("contact_pressure", 4, 0.2)]
    for departure in (None, Departure(3, "phase"), Departure(4, "phase"), Departure(9, "phase")):
        yield asdict(evidence.earlier(departure, single_rows))
    for numbers in ((1.0, 1.0), (1.0, 1.0009), (1.0, 1.0011), (-4e-4, 4e-4), (-2.0, 1e-7), (3.0, None), (2e-3, 0.0)):
        for name in ("statics", "damping"):
            yield asdict(evidence._beside(name, "is", "m", *numbers, 1e-3))


def motions():
    """Yield where histories come to rest, and how they swing, beside others."""
    n = np.arange(1.0, 181.0)
    steps = np.full(180, 2e-3)
    columns = [s * (1 - np.exp(-c * n) * np.cos(w * n)) for s, c, w in ((3.0, 0.01, 0.21), (3.1, 0.02, 0.23))]
    for every, changing in ((1, steps), (3, steps), (3, steps * (1 + 1e-3 * (n > 90)))):
        rows = np.arange(every - 1, 180, every)
        for chosen in (rows, rows[1:], np.delete(rows, 7)):
            target = Target(BLOCK, changing, chosen, columns[0][None, chosen])
            yield [[stage.name, stage.agrees, stage.numbers] for stage in evidence._motion(target, columns[1][chosen])]


def digits():
    """Yield units of last digits, and what is left of rows."""
    for values in ([5.0, 3.0], [0.05, 0.012, 100.0], [1 / 3, 2.0], [-250.0, 1e-30], [1e22, 0.0], [0.5]):
        yield bar.last_digits(np.array(values)).tolist()
    draw = np.random.default_rng(3).standard_normal(48)
    for height in np.linspace(0, 3, 120):
        yield bar.white(draw + height * np.sin(0.3 * np.arange(48)))
    for count in (3, 7, 8, 15, 16, 20, 47, 48):
        yield bar.white(draw[:count]), bar.noise(draw[:count]), bar.spread_of_most(draw[:count])
        yield search.Fit.independent.fget(SimpleNamespace(residual=np.cumsum(draw[:count])))
    for rounding, spread in ((0.0, 0.2), (0.3, 0.0), (0.3, 0.2)):
        of_rows = bar.Bar(np.full(48, rounding), 2e6, 5.0, spread, np.arange(48) != 7)
        yield of_rows.allowed, of_rows.deviation()
        constant = [x + 0 * draw for x in (0.15, 0.16, 0)]
        for remainder in (*constant, 0.1 * draw, 0.2 * np.sin(0.2 * np.arange(48)), 0.3 * draw):
            for further in (0.0, 0.055, 0.065, 1.15, 1.25):
                rows = remainder + further * (np.arange(48) == 20)
                yield of_rows.holds(rows), of_rows.outlying(rows).tolist(), of_rows.deviation(rows)
    yield bar.noise(0 * draw), bar.noise(draw / np.max(np.abs(draw))), bar.white(0 * draw)
    yield bar.Bar.of(np.array([3.0, 0.0, -4.0]), None), bar.Bar.of(np.zeros(3), None)


def decisions():
    """Yield what explanations score, whether they stand out, and of which several causes are made."""
    target = Target(BLOCK, np.full(30, 2e-3), np.arange(30), np.ones((1, 30)))
    by_id = {move.id: move for move in moves(target, OWN)} | {"dead-band": Move("dead-band", {}, ("band",))}
    draw = np.random.default_rng(5).standard_normal(30)
    for first in IDS:
        for second in ("", "density-factor", "geometry-updated"):
            several = tuple(by_id[name] for name in (first, second) if name)
            free = tuple(name for move in several for name in move.free)
            for misfit in (3e-6, 1.2e-3, 1.2e-2, 0.2):
                fit = SimpleNamespace(free=free, misfit=misfit, residual=misfit * draw, variant=OWN)
                explanation = Explanation(several, fit)
                yield search._stands_out(target, SimpleNamespace(misfit=0.9), explanation)
                yield search.score(target, np.full((1, 30), 2e-3), explanation)
            fit.variant = replace(OWN, band=1e-3, reopening=1e-3, shift=1.0)
            yield search.score(target, np.full((1, 30), 2e-3), explanation)
            yield search._together(several), search._starts(OWN, several)
    for scene in (OWN, replace(OWN, gg=1.0, start="consistent", opens=True)):
        alone = [Explanation((by_id["density-factor"],), SimpleNamespace(variant=replace(OWN, density=1.7)))]
        for move in search._few(target, scene, alone):
            yield move.id, dict(move.changes), move.free, [*move.starts]


def aliases():
    """Yield by which name a scheme of several names is called, and which these are."""
    ids = ("theta", "start", "hht gg", "wbz gg", "wbz", "gg", "hht density-factor", "symplectic-euler", "")
    target = Target(BLOCK, np.full(30, 2e-3), np.arange(30), np.ones((1, 30)))
    for free in ((), ("gg",), ("gg", "spectral")):
        several = []
        for number, names in enumerate(ids):
            fit = SimpleNamespace(free=free, variant=replace(OWN, gg=0.9 + number / 100))
            several.append(Explanation(tuple(map(Move, names.split())), fit))
        for alike in (True, False):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(search, "same_program", lambda target, *both, alike=alike: alike and both[0] == both[1])
                for best in several:
                    one, names = search._canonical(target, best, several)
                    yield one.ids, [*names], str(search._scheme_alone(best))


def forces():
    """Yield forces of contact that opens, by the signs of both gaps."""
    start, free = np.array([*itertools.product((-2e-3, 0.0, 1e-3), (-3e-3, -1e-5, 0.0, 2e-3, 9e-3))]).T
    for method in ("impact", "energy-conserving", "rigid", "implicit", "dashpot"):
        for dashpot, clipped in ((0.0, True), (7e5, True), (7e5, False)):
            contact = contact_force.Contact(3e8, dashpot, 0.4, np.array(clipped), 2e-9, 5e-7)
            gaps = contact_force.Gaps(start, 0.7 * start - 3e-4, free, 1e-3 - 0.2 * free)
            with np.errstate(invalid="ignore"):  # of two gaps of nothing
                yield [part.tolist() for part in contact_force.force_of(method, contact, gaps)]


ODD = {"softness": 0.3, "tied": False, "weight": 0.4, "gravity": 0.3, "load": 0.7, "ramp": 0.03, "density": 0.8}
ODD |= {"young": 0.7, "poisson": 0.1, "other_plane": True, "side": 1.2, "tall": 0.8, "inertia": 0.6, "viscous": 9.0}
ODD |= {"structural": 3e-4, "updated": True, "band": 1e-3, "hold": 2e-4, "lags": "opening", "reset": True, "parts": 2}
ODD |= {"discounted": "(7)", "secant": True, "strain_load": 0.6, "coupling": 0.7, "kept": "springs", "exact": True}
ODD |= {"shift": 0.5, "point": -0.4, "late": 1.0, "pressure_factor": 0.9, "displacement_factor": 1.1}


def variants():
    """Yield histories of variants with one odd number each, in contact that holds or opens, on a base, of a scheme."""
    block = replace(BLOCK, poisson=0.2, gravity=9.81)
    opens = {"opens": True}
    mean_gap = {"family": "hht", "spectral": 0.2, "contact": "mean gap"}
    for about in ({}, opens, opens | {"base": 3.0, "softness": 0.2}, opens | mean_gap):
        run = stepping.histories(
            block, [replace(OWN, **about, **{k: v}) for k, v in ODD.items() if k not in about], STEPS
        )
        for columns in (run.displacement, run.pressure, run.open):
            yield np.linalg.norm(columns, axis=0).tolist()


class World:
    """Fits by chance, which names and a number decide."""

    def __init__(self, patch, number):
        self.number = number
        self.fits = []
        accepted = (0.0, 0.004, 0.02, 0.08, 0.4, 0.9)[number % 6]
        patch.setattr(search, "fit", lambda target, starts, rounds=8: [self.fit(*start) for start in starts])
        patch.setattr(search, "fit_one", lambda target, variant: self.fit(variant, ()))
        patch.setattr(search, "fitted", self.fitted)
        patch.setattr(
            search, "accepted", lambda target, own, one: self.share("accepted", one) < max(accepted, one.more)
        )
        patch.setattr(search, "is_determined", lambda target, own, one: self.share("number", one.fit) < 0.8)
        patch.setattr(search, "score", lambda target, deviations, one: 25 * self.share("score", one.fit, *one.ids))
        patch.setattr(search, "same_program", lambda target, *both: share(*map(str, both)) < 0.5)
        patch.setattr(search, "benign_springs", lambda column, v: v.softness < 0.25)
        patch.setattr(search, "moves", lambda *given: MOVES)
        tensions = [Move("opening-tension", {"opens": True, "hold": 0.1 * i}) for i in range(1, 12)]
        patch.setattr(search, "dead_bands", lambda target, own, shares: tensions)

    def share(self, word, one, *ids):
        changes = [f"{name}={value}" for name, value in vars(one.variant).items() if value != getattr(OWN, name)]
        return share(word, str(self.number), *changes, *one.free, *ids)

    def fit(self, variant, free):
        one = SimpleNamespace(variant=variant, free=free, more=0.2 * (variant.base == 0))
        one.misfit = 0.5 * self.share("misfit", one) ** 3
        one.residual = np.full(30, one.misfit)
        self.fits.append(one.misfit)
        return one

    def fitted(self, target, scene, combos):
        explanations = []
        for combo in combos:
            free = tuple(name for move in combo for name in move.free)
            one = self.fit(search._starts(scene, combo)[-1], free)
            one.more = 0.0
            explanations.append(Explanation(combo, one))
        return sorted(explanations, key=lambda one: one.fit.misfit)


def searches():
    """Yield what is decided of candidates that are fitted by chance, and what has been fitted."""
    values = np.sin(np.arange(1.0, 31.0))
    target = Target(BLOCK, np.full(30, 2e-3), np.arange(30), values[None])
    for number in range(24):
        scene = replace(OWN, opens=number % 4 == 3)
        with pytest.MonkeyPatch.context() as patch:
            world = World(patch, number)
            verdict = search.simple(target, scene)
            if not verdict.explains:
                verdict = search.twofold(target, scene, verdict)
            several = (verdict.alike, verdict.single, verdict.aliases, verdict.others)
            yield verdict.best.ids, verdict.best.fit.misfit, verdict.explained, verdict.reached, verdict.left
            yield [[(one.ids, one.fit.misfit) for one in some] for some in several]
            yield world.fits


def acceptance():
    """Yield which fits by chance are accepted beside a scene's, and which free numbers the rows determine."""
    values = np.sin(np.arange(1.0, 31.0))
    printed = Target(BLOCK, np.full(30, 2e-3), np.arange(30), values[None], np.full((1, 30), 0.02))
    accepted = search.accepted
    is_determined = search.is_determined
    changes = ({"updated": True}, {"softness": 0.03}, {"base": 3.0, "softness": 0.3}, {"opens": True, "updated": True})
    changes += ({"contact": "rigid"}, {"contact": "impact"}, {"family": "hht", "spectral": 0.2}, {"gg": 0.9}, {})
    free = (("alpha", "gg"), ("spectral",), ("gg",), ("density", "young"), ("softness",), ("point",), ())
    for number in range(6):
        with pytest.MonkeyPatch.context() as patch:
            world = World(patch, number)
            patch.setattr(search, "intervals", lambda one: {"gg": SimpleNamespace(half_width=share(one.name) - 0.1)})
            patch.setattr(search.math, "isfinite", lambda width: width > 0)
            own = world.fit(OWN, ())
            target = printed if number % 2 else replace(printed, rounding=None)
            for change in changes:
                one = world.fit(replace(OWN, **change), ())
                for misfit, height in itertools.product((8e-7, 4e-5, 2e-4, one.misfit), (0.1, 1.0)):
                    one.misfit = misfit
                    one.residual = np.where(np.arange(30) == 20, 1.0, height) * misfit
                    yield accepted(target, own, one)
                for names_of_free in free:
                    one = world.fit(replace(OWN, density=1.2, **change), names_of_free)
                    one.name = str(one.misfit)
                    yield is_determined(target, own, Explanation((), one))
            pairs = [
                search.Explanation(pair, world.fit(OWN, ("gg", "band"))) for pair in itertools.combinations(LIMITS, 2)
            ]
            for one in search._fewer(target, OWN, pairs):
                yield one.ids, one.fit.misfit, [dict(move.changes) for move in one.moves]
            yield world.fits


def names():
    """Yield what fitted variants are called, with their numbers."""
    for soft in (-0.02, 0.0, 1e-4, 0.03, 0.1, np.log(2.0), 0.4):
        for base in (0.0, 7.0):
            v = replace(OWN, softness=soft, base=base, hold=2e-4, band=1e-3, point=-0.5, load=1.2, gravity=0.5)
            for error in (0.0, 3e-3, 0.2):
                yield causes.is_base(BLOCK, v, error), causes.round_factor(np.exp(-soft), error)
            for more in ({}, {"family": "hht", "spectral": 0.2}, {"alpha": 0.25}, {"start": "consistent"}):
                for ids in (IDS, ("springs-factor", "opening-tension"), ("rigid-contact", "start"), ("dead-band",)):
                    yield causes.causes_of(BLOCK, ids, replace(v, **more), OWN, 1e-3)
            yield causes.values_of(BLOCK, [*causes.CAUSES], v)
    for more in ({}, {"alpha": 1 / 6, "gg": 0.123456789, "start": "consistent"}, {"family": "hht", "spectral": 0.2}):
        for contact in ("springs", "impact", "dashpot", "rigid", "implicit"):
            v = replace(OWN, **more, contact=contact, dashpot=0.3, restitution=0.4)
            for name in ("scheme", "impact-law", "contact-dashpot", "gg"):
                yield assignments([name], v, OWN).split()
    for name in NUMBERS:
        yield name, bounds(name, OWN), bounds(name, replace(OWN, family="hht")), is_factor(name)
        yield [_side(replace(OWN, **{name: end}), name) for end in bounds(name, OWN)]
    for alpha, delta in itertools.product((0.0, 1 / 6, 0.25, 0.5), (0.5, 1.0)):
        name = named(alpha, delta)
        yield -1 if name is None else [*NAMED].index(name)
    for family in (*schemes.FAMILIES, "newmark"):
        yield schemes.scheme_numbers(replace(OWN, family=family, spectral=0.3, split=0.4))
    for low, high in ((0.93, 1.07), (2.1, 2.9), (0.00123, 0.00127), (8.0, 13.0), (33.3, 33.4), (0.96, 1.9)):
        yield causes.roundest(low, high)


def fits():
    """Yield where fits of one number end, after how many runs."""
    for target, start in ((0.3, 0.1), (0.3, 2.5), (9.0, 0.1), (-0.2, 0.0)):
        calls = []

        def residual(change, u, calls=calls, target=target):
            calls.append(u)
            return np.array([np.exp(u) - np.exp(target), 0.1 * u, np.tanh(9 * u)])

        change = CandidateChange("gg", str, np.exp, lambda u: {}, (start, 0.5, 1.0))
        best = one_change.fitted(residual, Fitted(change, start))
        (begun,) = one_change.nearest(residual, [change], 1, 0.0, 0.0)
        yield round(best.u, 6), round(best.remainder, 6), len(calls), begun.u, round(begun.remainder, 6)
    remainders = {"a": 3.0, "b": 1.0, "c": 2.0, "d": 8.0}
    changes = [fixed(name, "", {}) for name in remainders]
    for number, least, most in ((1, 0.0, 9.0), (2, 0.0, 9.0), (1, 3.0, 9.0), (9, 0.0, 2.0)):
        found = one_change.nearest(lambda change, u: np.array([remainders[change.id]]), changes, number, least, most)
        yield [one.id for one in found]


def readings_of_rows():
    """Yield how times, signs and units are read."""
    for times in (N, 3 * N, 1e-3 * N, 1e3 * N, 0.7 * N, 0.7 * (N + 4), N + (N > 4), N**1.2, N + 0.5, 1.0004 * N):
        foreign = Foreign(2e-3 * np.asarray(times, dtype=float), -np.ones(8))
        for changing in (None, np.full(8, 2e-3), 2e-3 * N):
            for one in steppings(replace(foreign, steps=changing), 2e-3):
                yield one.steps.tolist(), one.rows.tolist(), one.note, one.factor
    swing = -1 + np.cos(0.4 * N)
    for sign, factor in ((1, 1.0), (-1, 1.0), (1, 2e3), (-1, 700.0), (1, 1e-3), (1, 20.0)):
        foreign = Foreign(2e-3 * N, sign * factor * swing, -sign * 1e6 * factor * swing)
        for given in (foreign, replace(foreign, pressure=None), replace(foreign, pressure=0 * swing)):
            for one in readings.slips(given, Stepping(np.full(8, 2e-3), N - 1), swing, 1e6 * swing):
                yield [asdict(slip) for slip in one.corrected], one.recorded.tolist()


def scenes():
    """Yield what is taken of scenes."""
    opens = {"contact.law": "unilateral"}
    for values in (
        {"load.gravity": 3.0, "load.ramp": 0.1, "time.gg": 0.9},
        opens | {"contact.band": [1e-3, 4e-4]},
        opens | {"contact.band": [0.0, 4e-4]},
        opens | {"contact.gap": 0.1},
        {"load.eccentricity": 0.1},
        {"block.poisson": 0.2, "contact.shear_stiffness": 3.0, "time.scheme": "hht", "time.rho_inf": 0.7},
        {"time.scheme": "composite", "time.rho_inf": 0.2, "time.split": 0.4},
    ):
        scene = SCENE.with_values(values)
        rectangle = rectangle_of(scene)
        yield asdict(own_variant(scene)), rectangle and [asdict(rectangle), rectangle.force, rectangle.static]


def parts():
    """Yield single rows, rows that a shift leaves open, and parts of histories."""
    draw = 1e-3 * np.random.default_rng(3).standard_normal((2, 60))
    target = Target(
        BLOCK, np.full(60, 2e-3), np.arange(60), np.linspace([1, 30], [2, -40], 60).T, np.full((2, 60), 0.6)
    )
    for rows in ((), (0,), (2,), (59,), (1, 30), (20, 40, 50), (20, 21, 40), (20, 21, 22), (10, 20, 30, 40)):
        wrong = draw.copy()
        wrong[0, list(rows)] += 0.1
        yield replace(target, rounding=None).outlying((wrong / target.scales).ravel())
    yield target.values, target.floor, target.scales, target.parts(target.values), target.deviations(target.values)
    for changes in ({"shift": -2}, {"late": 0.5}, {"shift": 1, "late": 2.5}, {}):
        for steps in (3, 23, 24, 30):
            part = replace(target, left_out=draw > 1e-3).until(steps)
            yield len(part.rows), part.steps, part.recorded, part.left_out.tolist(), part.values
            yield part.inner(np.arange(2.0 * len(part.rows)), replace(OWN, **changes)).tolist()
        few = replace(target, recorded=target.recorded[:, :9], rows=target.rows[:9])
        yield few.inner(np.arange(18.0), replace(OWN, **changes)).tolist()


def same_rows():
    """Yield what gives the rows of causes, and the two causes of reversed columns."""
    steps = np.full(30, 2e-3)
    target = Target(BLOCK, steps, np.arange(30), np.ones((2, 30)))
    of_gravity = replace(target, column=replace(BLOCK, gravity=9.81, pressure=0.0))
    poisson = replace(target, column=replace(BLOCK, poisson=0.1))
    reversed_columns = [Slip("sign", name, -1.0) for name in ("displacement", "contact_pressure")]
    for one in (target, of_gravity, poisson):
        for corrected in (reversed_columns, reversed_columns[:1]):
            yield families.sign_or_gravity(one, ["sign"], corrected), families.sign_or_gravity(one, ["gg"], corrected)
    for ids in (["density-factor"], ["springs-factor"], ["base-compliance"], ["base-compliance", "gg"]):
        for changes in ({"density": 0.5}, {"softness": 0.03, "gg": 0.9}, {"softness": 0.03, "base": 3.0}):
            v = replace(OWN, **changes)
            fit = SimpleNamespace(variant=v)
            for others in ([], [("gg",), (*ids, "gg"), ("springs-factor",)]):
                same = [
                    Explanation(tuple(Move(name) for name in names), fit) for names in others if "sign" not in names
                ]
                for one in (target, of_gravity, poisson):
                    yield families.relatives(one, OWN, SimpleNamespace(same_rows=same), ids, v)
    for causes_named in (("hht",), ("gg",)):
        best = Explanation(tuple(Move(name) for name in causes_named), SimpleNamespace(variant=replace(OWN, gg=0.9)))
        for explained in (True, False):
            for alike in ((), (best,)):
                verdict = Verdict(SimpleNamespace(variant=OWN), best, explained, alike, aliases=(best,))
                yield families.as_good(target, verdict)


def test_rules_decide_as_before():
    tables = (departures, digits, decisions, names, fits, parts, readings_of_rows, same_rows, scenes, searches)
    tables += (acceptance, motions, aliases, forces, variants)
    assert_kept(KEPT, "rules", {table.__name__: summed(said([*table()], 0.0)) for table in tables})
