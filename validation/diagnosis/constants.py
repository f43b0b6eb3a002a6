"""The numbers that several parts of the diagnosis share, each with what it bounds and how it was found.

What a single part needs stands at its head. `validation.runs.numbers.ROUNDING` (1e-12, of an operation) and
`validation.metrics.contact.AGREED` (1e-6, what two correct codes keep) belong to these. Anywhere in the room a comment
that begins with "given" marks a number that is no choice: of physics, statistics, a scheme, a format or a unit.
"""

# ---- what counts as equal: relative ----
ARITHMETIC = 1e-8  # half the digits of double precision, which sums of increments and runs of one program keep
NUDGE = 1e-6  # step of a difference quotient: about the root of the rounding of a relative history
SAME_NUMBER = 1e-4  # two fits of one number, as noise leaves them
SEEN = 1e-3  # a smaller difference is none: times and values are often printed with four digits

# ---- shares of a whole ----
FAINT = 0.01  # of the largest value: more is put down neither to noise nor to a base with a mass of its own
SLIGHT = 0.02  # counts as nothing: what a base or a mesh leaves of a difference, or a weight of the block's own
CHANGE = 0.1  # of a factor: counts as a change of it; fits are scaled by it

# ---- times more that is left without what is there ----
TWICE = 2.0  # by a fit: three times left two causes unnamed beside noise of 1 %, where twice lists them
FARTHER = 3.0  # by the scene as another solver, reading or dead band has it, or by a candidate that is not pursued
CLEARLY = 10.0  # by the scene or another cause: noise hides no other one so large
SIGMAS = 4.0  # standard deviations, beyond which one of ten thousand values of noise is

# ---- rows, rounds and lists ----
ORDER = 12  # of the recurrence that a block obeys: static value, four modes, rows at rest
WINDOW = 2 * ORDER  # rows that determine a recurrence
FIRST_ROUNDS = 5  # of fits, after which poor ones are given up
ROUNDS = 12  # of a fit that goes on
MOST_ALIKE = 6  # explanations that are told where the rows do not tell them apart

# ---- where fits begin, and units ----
DISCOUNTS = (0.999, 0.99, 0.97, 0.93, 0.8, 0.5)  # gg
UNIT_POWERS = (-6, -3, -2, 2, 3, 6)  # given: of ten, prefixes and centimetres, by which a unit is off
UNITS = (1e-3, 1e3)  # given: factors of a datum in other units: mm, g, kPa, or MPa for Pa
UNBOUNDED = CLEARLY * 10.0 ** max(UNIT_POWERS)  # times: no unit is so wrong; stands for what has no bound
