"""Closed forms of a block on an incline with Coulomb's friction.

Gravity is g (sin b, -cos b) along and across the base. While every corner slips downhill or, without cohesion, is open,
the resultants of the contact obey T + tan(phi) N = -c a, whatever bounces: the sum u_t + tan(phi) u_n of the centroid's
displacements moves freely under

    a_s = g (sin b - tan(phi) cos b) - c a / m,

for any springs, and in any Newmark scheme as a free body does in that scheme. A corner that opens loses its half of
c a.
"""

from __future__ import annotations

import math

import numpy as np

from validation.runs.history import ArrayPair
from validation.scenes.scene import Scene
from validation.theory.stages import step_end
from validation.theory.statics import moduli, size
from validation.theory.stepping import Stepping

RINGS_ALIKE = 0.01  # relative difference of shear and normal springs
STANDS_BELOW = 0.47  # of tan(phi): the steepest slope that was seen to stand on springs that ring alike


def coefficient(scene: Scene) -> float:
    """Coefficient of friction tan(phi) [-]; zero without friction."""
    return math.tan(math.radians(scene.contact.friction or 0.0))


def along(scene: Scene) -> float:
    """Gravity along the base, towards +x [m/s2]."""
    return scene.load.gravity * math.sin(math.radians(scene.load.slope))


def across(scene: Scene) -> float:
    """Gravity that presses the block on its base [m/s2]."""
    return scene.load.gravity * math.cos(math.radians(scene.load.slope))


def adhesion(scene: Scene) -> float:
    """Deceleration c a / m by cohesion over the whole base [m/s2]."""
    return scene.contact.cohesion * scene.block.base_length / scene.block.mass


def sliding_acceleration(scene: Scene) -> float:
    """Acceleration a_s of a sliding block, downhill on either side [m/s2]; negative where the block stands."""
    return abs(along(scene)) - coefficient(scene) * across(scene) - adhesion(scene)


def run_out(scene: Scene, time: float) -> float:
    """Way that a block slides from rest, a_s t^2 / 2 [m]; zero where it stands."""
    return max(sliding_acceleration(scene), 0.0) * time**2 / 2


def settlement(scene: Scene) -> float:
    """Displacement of the centroid into the base, at rest [m].

    m g cos(b) (1 / (2 p) + h / (4 E' a)): the springs, and the strain of the block, for mu = 0.
    """
    width, height = size(scene)
    modulus, _ = moduli(scene)
    weight = scene.block.mass * across(scene)
    return weight * (1 / (2 * scene.contact.stiffness) + height / (4 * modulus * width))


def penalty_offset(scene: Scene) -> float:
    """Way that a sliding block is ahead of a_s t^2 / 2 because its springs have given way [m].

    u_n = -settlement in u_t + tan(phi) u_n = a_s t^2 / 2; it does not depend on the time step.
    """
    return coefficient(scene) * settlement(scene)


def threshold_angle(scene: Scene) -> float:
    """Slope beyond which the block slides [deg].

    phi + asin(c a cos(phi) / (m g)), from g sin(b) = tan(phi) g cos(b) + c a / m; 90 deg where it always stands.
    """
    phi = math.atan(coefficient(scene))
    adhesion_share = adhesion(scene) * math.cos(phi) / scene.load.gravity
    return math.degrees(phi + math.asin(adhesion_share)) if adhesion_share < math.cos(phi) else 90.0


def normal_frequency(scene: Scene) -> float:
    """Frequency sqrt(2 p / m) of the rigid block on its normal springs [rad/s]."""
    return math.sqrt(2 * scene.contact.stiffness / scene.block.mass)


def creep_scale(scene: Scene) -> float:
    """Speed g / w_n, with which that of a stable block on undamped ringing springs scales [m/s].

    Each period 2 pi / w_n unloads the friction once, and the block then moves by some g / w_n^2. How fast depends on
    the shear springs: at 20 degrees under 30 3.3 and more times g / w_n at p_s = p/10, 0.8 at 0.4 p and 0.9 at p; on
    gentler slopes not at all at p_s = p, see `stands_on_ringing_springs`.
    """
    return scene.load.gravity / normal_frequency(scene)


def stands_on_ringing_springs(scene: Scene) -> bool:
    """Whether a stable block is known to stand although its springs ring.

    Shear springs as stiff as the normal ones ring with them: under a weight that comes on at once, N = m g cos(b)
    (1 - cos(w_n t)) and T = tan(b) N, so that nothing slips but for the block's rotation. Average acceleration at
    w_n dt = 0.02 moves by less than 1 % of g / w_n after half a second at tan(b) up to 0.47 tan(phi); at 0.63 by 0.9.
    """
    ratio = scene.contact.shear / scene.contact.stiffness
    slope = math.tan(math.radians(abs(scene.load.slope)))
    return abs(ratio - 1) < RINGS_ALIKE and slope < STANDS_BELOW * coefficient(scene) and scene.contact.cohesion == 0


def lag(scene: Scene) -> float:
    """Phase by which average acceleration lags the normal ringing at the end of a run, (w_n dt)^2 / 12 of w_n t [rad].

    Share of a swing by which such a run differs from the exact one, as long as both stick and slip in one order.
    """
    ringing, t = normal_frequency(scene), scene.time
    return (ringing * t.step) ** 2 / 12 * ringing * t.duration


def ringing_decay(scene: Scene) -> float:
    """Rate at which scheme and discount damp the slowest normal ringing [1/s].

    w_1^2 (delta - 1/2) dt / 2 - ln(gg) / (2 dt), for w_1 dt below 1; w_1^2 = g cos(b) / settlement. Of other schemes
    w_1 times the leading term of their damping ratio.
    """
    t = scene.time
    if t.scheme != "newmark":
        frequency = math.sqrt(across(scene) / settlement(scene))
        return frequency * Stepping.of(scene).leading_damping(frequency * t.step)
    return across(scene) / settlement(scene) * (t.delta - 0.5) * t.step / 2 + drag_rate(scene) / 2


def damped_creep(scene: Scene) -> float:
    """Way g / w_n t_s that a stable block creeps until its damped ringing unloads the friction no more [m].

    Under a weight that comes on at once the normal force swings between nothing and twice its rest; the block stands
    once it stays above tan(b) / tan(phi) of its rest: t_s = ln(tan(phi) / (tan(phi) - tan(b))) / decay.
    """
    friction = coefficient(scene)
    slope = math.tan(math.radians(scene.load.slope))
    return creep_scale(scene) * math.log(friction / (friction - slope)) / ringing_decay(scene)


# ---- the discount as a drag ----


def drag_rate(scene: Scene) -> float:
    """Rate -ln(gg) / dt at which the discount takes speed away [1/s]."""
    gg = scene.time.discount
    return -math.log(gg) / scene.time.step if gg > 0 else math.inf


def time_constant(scene: Scene) -> float:
    """Terminal speed of a free body over its acceleration, dt / (1 - gg) [s].

    It comes near that speed with the time constant -dt / ln(gg), which is shorter: by 1 % at 0.98, 28 % at 0.5.
    """
    lost = 1 - scene.time.discount
    return scene.time.step / lost if lost else math.inf


def free_motion(scene: Scene, acceleration: float) -> ArrayPair:
    """Return displacement and velocity at each step of a free body in the scene's scheme, from rest [m], [m/s].

    From the consistent start Newmark's is V_n = dt a (1 - gg^n) / (1 - gg).
    """
    t = scene.time
    stepping = Stepping.of(scene)
    pull = t.step**2 * acceleration
    late = pull / 2 if t.scheme == "leapfrog" else 0.0  # its v is that of half a step before
    moved = np.zeros(t.steps)
    speed = np.zeros(t.steps)
    x = 0.0
    u = -late  # discounted velocity
    a = pull if t.start == "consistent" else 0.0
    for n in range(t.steps):
        x, v, a = step_end(stepping.stages, x, u, a, load=pull)
        u = t.discount * v
        moved[n] = x
        speed[n] = u + late if late else v
    return moved, speed / t.step


def distance_share(gg: float, step: float, time: float) -> float:
    """Return the distance of a body that falls or slides from rest with a discount over that without [-].

    The sum of the V_n of `free_motion` over that of n dt a.
    """
    n = max(round(time / step), 1)
    if gg == 1:
        return 1.0
    # expm1 keeps the digits that 1 - gg^n would lose next to gg = 1
    gained = -math.expm1(n * math.log(gg)) / (1 - gg) if gg > 0 else 1.0
    return (n / 2 + gg * (n - gained) / (1 - gg)) / (n * n / 2)
