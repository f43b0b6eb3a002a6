"""`contact`, `advise` and `show` of columns whose contacts open or slip."""

from conftest import typed

from validation.cli.app import NUMERICAL_FAILURE
from validation.runs.run import Outcome

STACK = """
[column]
motion = "pressure"
law = "unilateral"
stiffness = 1.0e9
gravity = 9.81
{more}

[[column.layer]]
thickness = 4.0
density = 2500.0
young = inf
blocks = 4
velocity = -1.0

[time]
step = 1.0e-3
steps = 4

[run]
solvers = ["dda"]
"""


def test_a_stack_whose_solves_are_limited_ends_by_name(tmp_path):
    path = tmp_path / "limited.toml"
    path.write_text(STACK.format(more="solve_limit = 3"))
    done = typed("advise", "contact", path)
    assert done.returncode == NUMERICAL_FAILURE
    assert Outcome.SOLVE_LIMIT.sentence in done.stdout
