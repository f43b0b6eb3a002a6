"""The block by FEniCSx: a program in a folder of its own, run by whatever interpreter has dolfinx.

It shares no line with the rest of this package, and nothing imports it: own nodes for the same mesh, own weak forms
(UFL), own Newmark loop on PETSc matrices, factored once by PETSc's LU on one rank and by MUMPS on more; its springs are
locked. It reads one JSON object a line from standard input and answers each with one line of JSON that carries the
request's "id"; it ends where its input ends::

    python3 fem_reference/fenicsx < requests.jsonl
    mpirun -n 2 python3 fem_reference/fenicsx < requests.jsonl

A request holds, in SI units: vertices, base, top, density, young, poisson, hypothesis, stiffness, shear_stiffness,
pressure, eccentricity, traction, gravity, slope (deg), moved (displacements (x, y) of the base at t = 0, dt, ... or
null), last (where the base comes to rest), degree, foundation, patch_width, elements and cells ("quadrilaterals" or
"triangles"; or points and cells of a mesh file), alpha, delta, gg, step, start, steps, columns. An answer holds time,
columns, static, unknowns, nonzeros, factorisations, solves, setup_seconds, stepping_seconds, memory (peak of all ranks,
bytes), version; or "refused" (bad input), "inapplicable" or "raised" with a sentence.

Runs with dolfinx 0.5 and with the interface of 0.7 to 0.10 (basix elements, another order of arguments).
"""
