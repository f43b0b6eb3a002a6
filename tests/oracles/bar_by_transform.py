"""The bar on a spring by its transform, inverted wave by wave in many digits: no modes, no doubles, any damping.

With g^2 = s^2 + c s (times in travel times of the wave), kappa the stiffness of the spring over that of the bar and
R = (g - kappa) / (g + kappa),

    pressure / q         = sum over j of 2 kappa R^j e^(-(2 j + 1) g) / (s (g + kappa))
    -v(h / 2) E / (q h)  = sum over j of R^j (e^(-(2 j + 1/2) g) + R e^(-(2 j + 3/2) g)) / (s g)

since at the base D' = kappa D, at the top D' = -1 / s, and D is a sum of e^(g y) and e^(-g y). Each wave is inverted
on a contour of its own, scaled by the time since its arrival (Abate and Valko, Int. J. Numer. Meth. Eng. 60, 2004).
"""

from mpmath import mp, mpc, mpf

DIGITS, NODES = 50, 60


def inverted(transform, since):
    """Return the original at a time after its front, of a transform that carries no more delay."""
    r = mpf(2 * NODES) / (5 * since)
    total = mp.exp(r * since) * transform(mpc(r)).real / 2
    for k in range(1, NODES):
        theta = k * mp.pi / NODES
        cot = mp.cot(theta)
        s = r * theta * mpc(cot, 1)
        turn = mpc(1, theta + (theta * cot - 1) * cot)
        total += (mp.exp(since * s) * transform(s) * turn).real
    return total * r / NODES


def history(column, t, kappa, rate):
    """Return a column over its static value at a time, for a damping rate c per travel time (0 for none)."""
    with mp.workdps(DIGITS):
        t, k, c = mpf(t), mpf(kappa), mpf(rate)

        def wave(power, arrival, pressure):
            def transform(s):
                g = mp.sqrt(s) * mp.sqrt(s + c)
                front = mp.exp(-arrival * (g - s))  # the delay itself is taken out: it shifts the time
                amplitude = 2 * k / (s * (g + k)) if pressure else 1 / (s * g)
                return front * amplitude * ((g - k) / (g + k)) ** power

            return inverted(transform, t - arrival) if t > arrival else mpf(0)

        trips = range(int(t / 2) + 1)
        if column == "contact_pressure":
            return mp.fsum(wave(j, mpf(2 * j + 1), True) for j in trips)
        unit = mp.fsum(wave(j, mpf(4 * j + 1) / 2, False) + wave(j + 1, mpf(4 * j + 3) / 2, False) for j in trips)
        return unit / (1 / k + mpf(1) / 2)
