"""The side of `siconos.py` that Debian's Python runs: ``python3 -I siconos_program.py request.json answer.json``.

A request names one of three models and holds its matrices; the answer has a row for each step of the scene.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from typing import Any

ABSENT = 3  # exit status where there is no Siconos

try:
    import numpy as np
except ImportError:  # Debian's package of Siconos brings it
    sys.exit(ABSENT)

Request = dict[str, Any]


def stepped(sk: Any, system: Any, interactions: list[Any], solvers: tuple[Any, Any], given: Request) -> Any:
    """Return a time stepping of one dynamical system with its interactions."""
    model = sk.NonSmoothDynamicalSystem(0.0, 2 * given["step"] * given["parts"] * given["steps"])
    model.insertDynamicalSystem(system)
    for one in interactions:
        model.link(one, system)
    return sk.TimeStepping(model, sk.TimeDiscretisation(0.0, given["step"]), *solvers)


def rows(stepping: Any, given: Request, before: Callable[[int], None] = lambda number: None) -> Iterator[bool]:
    """Make all steps; yield at the end of each whether it is one of the scene's."""
    for number in range(given["steps"] * given["parts"]):
        before(number)
        stepping.computeOneStep()
        stepping.nextStep()
        yield (number + 1) % given["parts"] == 0


def linear(sk: Any, given: Request) -> dict[str, Any]:
    """M q'' + C q' + K q = F by Moreau and Jean's theta method from rest; F times a signal, where there is one."""
    M, K, C = (np.array(given[name]) for name in "MKC")
    size, load, signal = len(M), np.array(given["load"]), given["signal"]
    system = sk.LagrangianLinearTIDS(np.zeros(size), np.zeros(size), M, K, C)
    force = sk.SiconosVector(size)
    system.setFExtPtr(force)
    pushed = [int(i) for i in np.flatnonzero(load)]

    def push(number: int) -> None:
        if signal is not None or number == 0:
            for i in pushed:
                force.setValue(i, float(load[i] * (1.0 if signal is None else signal[number])))

    push(0)
    stepping = stepped(sk, system, [], (sk.MoreauJeanOSI(), sk.LCP()), given)
    return {"q": [np.array(system.q()).tolist() for at in rows(stepping, given, push) if at]}


def complementarity(sk: Any, given: Request) -> dict[str, Any]:
    """Solve x' = A x + b + B l, 0 <= C x + D l + e perp l >= 0 by the theta-gamma scheme, at the middle of the step.

    Rows from `ends` on hold for x at its end, which is twice the middle less the start: held at the middle, a force
    that vanishes at once would change its sign from step to step, and be there when the corner closes again.
    """
    A, B, C, D, b, e, x0 = (np.array(given[name]) for name in ("A", "B", "C", "D", "b", "e", "x0"))
    ends, own = given["ends"], C.copy()
    C[ends:] *= 2
    system = sk.FirstOrderLinearTIDS(x0, A, b)
    relation = sk.FirstOrderLinearTIR(C, B)
    offset = sk.SiconosVector(len(e))
    relation.setDPtr(D)
    relation.setePtr(offset)

    def before(number: int) -> None:
        at_start = own[ends:] @ system.x() if ends < len(e) else ()
        for i in range(0 if number == 0 else ends, len(e)):
            offset.setValue(i, float(e[i] - (at_start[i - ends] if i >= ends else 0.0)))

    before(0)
    contact = sk.Interaction(sk.ComplementarityConditionNSL(len(e)), relation)
    scheme = sk.EulerMoreauOSI(0.5, 0.5)
    scheme.setUseGammaForRelation(True)
    stepping = stepped(sk, system, [contact], (scheme, sk.LCP()), given)
    found, opened = [], False
    for at in rows(stepping, given, before):
        opened = opened or min(contact.lambda_(0)[:2]) <= 0
        if at:
            found.append(np.array(system.x()).tolist())
    return {"x": found, "opened": bool(opened)}


def rigid(sk: Any, given: Request) -> dict[str, Any]:
    """Move a rigid body (x, y, angle) on two corners that Siconos keeps from going below y = 0, with friction, e = 0.

    The corners' relations are linear in a step, about the angle at its start or foreseen at its middle.
    """
    q0, corners, turns = np.array(given["q0"]), np.array(given["corners"]), given["turns"]
    system = sk.LagrangianLinearTIDS(q0, np.zeros(3), np.diag(given["inertia"]))
    force = np.array(given["force"])
    system.setFExtPtr(force)
    relations = [(sk.SimpleMatrix(2, 3), sk.SiconosVector(2)) for _ in corners]
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, given["friction"], 2)
    contacts = [sk.Interaction(law, sk.LagrangianLinearTIR(*relation)) for relation in relations]

    def update(q: np.ndarray, angle: float) -> None:
        for (rows_, offset), corner in zip(relations, corners, strict=True):
            x, y = arm(corner, angle)
            values = [[0.0, 1.0, x], [1.0, 0.0, -y]]
            for i in range(6):
                rows_.setValue(i // 3, i % 3, values[i // 3][i % 3])
            height = q[1] + arm(corner, q[2])[1]
            offset.setValue(0, float(height - np.dot(values[0], q)))

    update(q0, q0[2] if turns else 0.0)
    stepping = stepped(sk, system, contacts, (sk.MoreauJeanOSI(), sk.FrictionContact(2)), given)
    q, rate = system.q(), system.velocity()  # of the stepping: what they were before is not moved

    def before(number: int) -> None:
        if turns:
            update(q, q[2] + (given["step"] / 2 * rate[2] if given["middle"] else 0.0))

    return {"q": [np.array(q).tolist() for at in rows(stepping, given, before) if at]}


def arm(corner: np.ndarray, angle: float) -> tuple[float, float]:
    """Return where a corner is from the centroid [m]."""
    c, s = np.cos(angle), np.sin(angle)
    return float(c * corner[0] - s * corner[1]), float(s * corner[0] + c * corner[1])


def main(request: str, answer: str) -> int:
    """Read a request, write its answer."""
    try:
        import siconos.kernel as sk
    except ImportError:
        return ABSENT
    with open(request) as file:
        given = json.load(file)
    found = {"linear": linear, "complementarity": complementarity, "rigid": rigid}[given["kind"]](sk, given)
    with open(answer, "w") as file:
        json.dump(found, file)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
