"""The side of `siconos.py` that Debian's Python runs: ``python3 -I siconos_program.py request.json answer.json``.

A request names one of three models and holds its matrices; the answer has a row for each step of the scene.
"""

import json
import math
import sys

LEMKE = 404  # SICONOS_FRICTION_2D_LEMKE
ROUNDING = 1e-12  # of the size of a box
ABSENT = 3  # exit status where there is no Siconos

try:
    import numpy as np
except ImportError:  # Debian's package of Siconos brings it
    sys.exit(ABSENT)


def stepped(sk, system, interactions, solvers, given):
    """Return a time stepping of one dynamical system with its interactions."""
    model = sk.NonSmoothDynamicalSystem(0.0, 2 * given["step"] * given["parts"] * given["steps"])
    model.insertDynamicalSystem(system)
    for one in interactions:
        model.link(one, system)
    return sk.TimeStepping(model, sk.TimeDiscretisation(0.0, given["step"]), *solvers)


def rows(stepping, given, before=lambda number: None):
    """Make all steps; yield at the end of each whether it is one of the scene's."""
    for number in range(given["steps"] * given["parts"]):
        before(number)
        stepping.computeOneStep()
        stepping.nextStep()
        yield (number + 1) % given["parts"] == 0


def linear(sk, given):
    """M q'' + C q' + K q = F by Moreau and Jean's theta method from rest; F times a signal, where there is one."""
    M, K, C = (np.array(given[name]) for name in "MKC")
    size, load, signal = len(M), np.array(given["load"]), given["signal"]
    system = sk.LagrangianLinearTIDS(np.zeros(size), np.zeros(size), M, K, C)
    force = sk.SiconosVector(size)
    system.setFExtPtr(force)
    pushed = [int(i) for i in np.flatnonzero(load)]

    def push(number):
        if signal is not None or number == 0:
            for i in pushed:
                force.setValue(i, float(load[i] * (1.0 if signal is None else signal[number])))

    push(0)
    stepping = stepped(sk, system, [], (sk.MoreauJeanOSI(), sk.LCP()), given)
    return {"q": [np.array(system.q()).tolist() for at in rows(stepping, given, push) if at]}


def complementarity(sk, given):
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

    def before(number):
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


def boxes(sk, given):
    """Move rigid boxes (x, y, angle) whose corners Siconos keeps out of faces, with friction and Newton's restitution.

    A contact is a corner of one body and a face of another, or of the ground. Its relation is linear in a step, about
    angles foreseen at its middle or as they are; where nothing `turns`, about those of the start. A ground that moves
    rests in its own frame: from t to t + h the boxes bear -m (V(t + h) - V(t)) / h.
    """
    step = given["step"]
    model = sk.NonSmoothDynamicalSystem(0.0, 2 * step * given["parts"] * given["steps"])
    systems = []
    pushes = []
    for box in given["boxes"]:
        inertia = np.array(box["inertia"])
        system = sk.LagrangianLinearTIDS(np.array(box["q0"]), np.array(box["v0"]), np.diag(inertia))
        force = sk.SiconosVector(3)
        for freedom in (0, 1):
            force.setValue(freedom, float(inertia[freedom] * given["pull"][freedom]))
        force.setValue(2, box["couple"])
        system.setFExtPtr(force)
        model.insertDynamicalSystem(system)
        systems.append(system)
        pushes.append(force)
    law = sk.NewtonImpactFrictionNSL(given["restitution"], 0.0, given["friction"], 2)
    contacts = []
    for contact in given["contacts"]:
        bodies = [contact["body"]] + ([] if contact["other"] is None else [contact["other"]])
        relation = sk.SimpleMatrix(2, 3 * len(bodies))
        offset = sk.SiconosVector(2)
        interaction = sk.Interaction(law, sk.LagrangianLinearTIR(relation, offset))
        contacts.append((contact, bodies, relation, offset, interaction))
        model.link(interaction, *[systems[body] for body in bodies])
    problem = sk.FrictionContact(2, LEMKE) if given["pivots"] else sk.FrictionContact(2)
    if given["iterations"]:
        problem.numericsSolverOptions().iparam[0] = given["iterations"]
    starts = [box["q0"] for box in given["boxes"]]
    update(given, contacts, starts, [box["v0"] for box in given["boxes"]])
    discretisation = sk.TimeDiscretisation(0.0, step)
    stepping = sk.TimeStepping(model, discretisation, sk.MoreauJeanOSI(), problem)
    positions = [system.q() for system in systems]  # of the stepping: what they were before is not moved
    rates = [system.velocity() for system in systems]

    def before(number):
        if given["amplitude"]:
            rate = given["rate"]
            change = math.sin(rate * step * (number + 1)) - math.sin(rate * step * number)
            acceleration = given["amplitude"] * rate * change / step
            for box, force in zip(given["boxes"], pushes, strict=True):
                force.setValue(0, box["inertia"][0] * (given["pull"][0] - acceleration))
        if given["turns"]:
            update(given, contacts, positions, rates)

    poses = []
    forces = []
    for at in rows(stepping, given, before):
        if at:
            poses.append([np.array(q).tolist() for q in positions])
            below = [0.0] * len(systems)
            for contact, _, _, _, interaction in contacts:
                below[contact["carried"]] += float(interaction.lambda_(1)[0]) / step
            forces.append(below)
    return {"poses": poses, "forces": forces}


def update(given, contacts, positions, rates):
    """Set the relations of a step: its rows for velocities, and an offset that makes them give the gap at its start.

    A gap within rounding is taken as closed: a corner that rounding lifts would stay open for a step.
    """
    ahead = given["step"] / 2 if given["middle"] else 0.0
    for contact, bodies, relation, offset, _ in contacts:
        q = [tuple(map(float, positions[body])) for body in bodies]
        gap = gap_of(contact, q)
        turned = [(x, y, angle + ahead * float(rates[body][2])) for (x, y, angle), body in zip(q, bodies, strict=True)]
        lines = velocities(contact, turned)
        for row, line in enumerate(lines):
            for column, value in enumerate(line):
                relation.setValue(row, column, value)
        if abs(gap) < ROUNDING * given["size"]:
            gap = -ROUNDING * given["size"]
        flat = [value for one in q for value in one]
        offset.setValue(0, gap - sum(factor * value for factor, value in zip(lines[0], flat, strict=True)))


def gap_of(contact, q):
    """Return how far a corner is from a face [m]."""
    x, y = arm(contact["corner"], q[0][2])
    if len(q) == 1:
        return q[0][1] + y
    normal = arm((0.0, contact["outward"]), q[1][2])
    return normal[0] * (q[0][0] + x - q[1][0]) + normal[1] * (q[0][1] + y - q[1][1]) - contact["level"]


def velocities(contact, q):
    """Return the rows of normal and tangential velocity of a corner from a face, of 3 or 6 factors."""
    face_angle = q[1][2] if len(q) == 2 else 0.0
    lever = arm(contact["corner"], q[0][2])
    normal = arm((0.0, contact["outward"]), face_angle)
    lines = []
    for x, y in (normal, (normal[1], -normal[0])):
        line = [x, y, lever[0] * y - lever[1] * x]
        if len(q) == 2:
            other = (q[0][0] + lever[0] - q[1][0], q[0][1] + lever[1] - q[1][1])
            line += [-x, -y, other[1] * x - other[0] * y]
        lines.append(line)
    return lines


def arm(corner, angle):
    """Return where a corner is from the centroid [m]."""
    c, s = math.cos(angle), math.sin(angle)
    return c * corner[0] - s * corner[1], s * corner[0] + c * corner[1]


KINDS = {"linear": linear, "complementarity": complementarity, "boxes": boxes}


def main(request, answer):
    """Read a request, write its answer."""
    try:
        import siconos.kernel as sk
    except ImportError:
        return ABSENT
    with open(request) as file:
        given = json.load(file)
    found = KINDS[given["kind"]](sk, given)
    with open(answer, "w") as file:
        json.dump(found, file)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
