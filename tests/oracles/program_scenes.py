"""Scenes that say what the plain program runs."""

from validation import load_scene


def scene_of(p):
    """Return the scene of a run."""
    return load_scene("figures-3-4").with_values(
        {
            "time.step": p.dt,
            "time.steps": p.steps,
            "time.alpha": p.alpha,
            "time.delta": p.delta,
            "time.gg": p.gg,
            "time.start": "consistent" if p.consistent else "zero",
            "contact.stiffness": p.p,
            "block.density": p.rho,
            "block.young": p.E,
            "block.poisson": p.mu,
            "load.pressure": p.q,
            "load.gravity": p.g,
        }
    )
