"""`contact`, `advise` and `show` of columns whose contacts open or slip."""

import json

import pytest
from conftest import typed

from validation.cli.app import NUMERICAL_FAILURE

STACK = """
[column]
motion = "pressure"
law = "unilateral"
stiffness = 1.0e9
gravity = 9.81
{more}

[[column.layer]]
thickness = 7.0
density = 2500.0
young = inf
blocks = 7
velocity = -1.0

[time]
step = 1.0e-3
steps = 30

[run]
solvers = ["dda"]
"""


@pytest.fixture
def stack(tmp_path):
    path = tmp_path / "stack.toml"
    path.write_text(STACK.format(more=""))
    return path


def test_contact_tells_what_the_steps_of_a_stack_took_and_what_to_allow(stack):
    data = json.loads(typed("advise", "contact", stack, "--json").stdout)
    run = data["runs"]["dda"]
    assert run["contact.most_solves"] == 8.0 == data["limits"]["solves"]  # the first impact closes one in each solve
    assert run["contact.p99_solves"] == 8.0 and 1 < run["contact.mean_solves"] < 8
    page = typed("advise", "contact", stack)
    assert page.returncode == 0
    lines = page.stdout.splitlines()
    assert any(line.split()[:6] == ["most", "solves", "in", "a", "step", "8"] for line in lines)
    assert any(line.startswith("Allow 8 solves") for line in lines)


def test_a_stack_whose_solves_are_limited_ends_by_name(tmp_path):
    path = tmp_path / "limited.toml"
    path.write_text(STACK.format(more="solve_limit = 6"))
    done = typed("advise", "contact", path)
    assert done.returncode == NUMERICAL_FAILURE
    assert "needs more solves than its limit" in done.stdout
    assert "ALARM solve limit" in done.stdout
