"""Full matrices of prepared scenes, for steps and sums that share nothing with the solvers."""

import numpy as np
from oracles.stepped_vibration import Rule

from dda import spring_vectors
from validation.solvers.dda import OneBlock, SubBlocks
from validation.solvers.fem import Mesh


def matrices(prepared):
    """Return M, K, F and the rows of displacement and contact pressure of a prepared scene."""
    if isinstance(prepared, Mesh):
        m, size = prepared.model, prepared.problem.load_size
        return (
            m.M.toarray(),
            m.K.toarray(),
            size * m.F,
            np.array([m.observers[c] for c in ("displacement", "contact_pressure")]),
        )
    if isinstance(prepared, SubBlocks):
        e, size = prepared.system.equations, prepared.system.load_size
        K = np.diag(e.k) + (e.B.T @ e.kappa @ e.B).toarray()
        return (
            np.eye(len(K)),
            K,
            size * e.F,
            np.array([e.observers["displacement"], e.pressure @ (e.kappa @ e.B).toarray()]),
        )
    assert isinstance(prepared, OneBlock)
    model = prepared.model
    normal, _ = spring_vectors(model.block, model.base)
    length = prepared.scene.block.base_length
    pressure = -model.contact.normal / length * normal.sum(axis=0)
    return model.mass, model.stiffness, model.force, np.array([np.eye(6)[1], pressure])


def rule_of(scene):
    t, d = scene.time, scene.damping
    return Rule(t.alpha, t.delta, t.discount, t.step, d.mass, d.stiffness, t.start)
