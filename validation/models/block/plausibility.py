"""Values of a block that no rock, soil or concrete has."""

from __future__ import annotations

import math
from collections.abc import Iterator

from validation.scenes.plausibility import (
    FASTEST,
    SLOWEST,
    Implausible,
    PlausibilityHooks,
    friction,
    judged,
    material,
    pressure_values,
    stepping,
    strength,
)
from validation.scenes.scene import Scene


class HOOKS(PlausibilityHooks):
    """What a block's values are held against."""

    def values(self, scene: Scene) -> Iterator[Implausible]:
        """Yield what material, friction, times, lengths and loads say."""
        block = scene.block
        load = scene.load
        modulus = block.young
        if block.hypothesis == "plane strain":
            modulus /= 1 - block.poisson**2
        strains = {
            "load.pressure": abs(load.pressure) / modulus,
            "load.traction": abs(load.traction) * 2 * (1 + block.poisson) / block.young,
            "load.gravity": block.density * abs(load.gravity) * block.extent[1] / modulus,
        }
        yield from material("block", block.density, block.young, math.sqrt(modulus / block.density), strains)
        yield from friction("contact.friction", scene.contact.friction)
        yield from _of_block(scene)
        yield from stepping(scene)
        # sizes, gravity, loads and strength
        width, height = block.extent
        stated = [name for name in ("side", "vertices") if name in block.model_fields_set]
        if stated:
            shape = "size" if block.vertices is None else "vertices"
            yield from judged(shape, f"block.{stated[0]}", max(width, height))
        else:
            yield from judged("size", "block.width", width)
            yield from judged("size", "block.height", height)
        yield from judged("gravity", "load.gravity", load.gravity)
        yield from judged("tension", "load.pressure", load.pressure)
        yield from pressure_values("load.pressure", load.pressure, block.young)
        yield from pressure_values("load.traction", load.traction, block.young)
        yield from strength("contact.cohesion", scene.contact.cohesion, block.young)

    def sinks(self, scene: Scene) -> Iterator[Implausible]:
        """Yield springs that give way by a tenth of the height."""
        b = scene.block
        p = scene.contact.stiffness
        if math.isinf(p):
            return
        load = abs(scene.load.pressure) * b.base_length + b.mass * abs(scene.load.gravity)
        springs = {"stiffness": p, "young": b.young, "tenfold": 10 * b.young}
        if load:
            sink = load / (2 * p)
            yield from judged("sink", "contact.stiffness", sink / scene.block.extent[1], sink=sink, **springs)
        else:
            yield from judged("unloaded", "contact.stiffness", p / b.young, **springs)


def _of_block(scene: Scene) -> Iterator[Implausible]:
    """Yield times, speeds and lengths of a block that are out of proportion to it."""
    b = scene.block
    c = scene.contact
    t = scene.time
    yield from judged("damping_ratio", "contact.damping_ratio", c.damping_ratio)
    speed = math.sqrt(b.young / b.density)
    height = scene.block.extent[1]
    if not 0 < speed / height < math.inf:  # said already of the modulus
        return
    travel = height / speed
    if SLOWEST <= speed <= FASTEST:
        yield from judged("step", "time.step", t.step / travel, step=t.step, inverse=travel / t.step)
    yield from judged("ramp", "load.ramp", scene.load.ramp / t.duration, ramp=scene.load.ramp, duration=t.duration)
    yield from judged("velocity", "block.velocity", abs(b.velocity) / speed, velocity=b.velocity, speed=speed)
    yield from judged("poisson", "block.poisson", b.poisson)
    if math.isfinite(c.stiffness):
        springs = {"stiffness": c.stiffness, "young": b.young, "hundredfold": 100 * b.young}
        yield from judged("springs", "contact.stiffness", c.stiffness / b.young, **springs)
        shear = c.shear_stiffness or 0.0
        shear_springs = {"shear": shear, "stiffness": c.stiffness}
        yield from judged("shear_springs", "contact.shear_stiffness", shear / c.stiffness, **shear_springs)
    if b.subdivide is not None:
        yield from judged("glue_ratio", "block.glue_ratio", b.glue_ratio)
    for name, length in (("gap", c.gap), ("band", max(c.band))):
        yield from judged(name, f"contact.{name}", length / height, length=length)
    frequency = math.sqrt(3) * speed / height  # of the block of one strain on a rigid base
    by_mass = scene.damping.mass / (2 * frequency)
    by_stiffness = scene.damping.stiffness * frequency / 2
    field = "damping.mass" if by_mass > by_stiffness else "damping.stiffness"
    yield from judged("rayleigh", field, by_mass + by_stiffness, frequency=frequency)
