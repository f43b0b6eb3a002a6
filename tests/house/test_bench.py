"""The rivals of `make bench` give our answers, and the committed table holds what was asked for."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.long
def test_each_part_of_the_bench_runs():
    code = (
        "import bench; print(bench.fenicsx_line(4, 20)); print(bench.two_workers(2, 4)); "
        "print(bench.grown('n', [1, 2, 4], lambda n: n**2)); "
        "print(bench.compete(bench.dda_contest(50, bench.dda_model(), 0, 1e-9, 1))); "
        "bench.opening_steps(200); bench.slipping_steps(200); bench.turning_steps(100); bench.fem_steps(300, 200); "
        "bench.accuracy_lines([0.02])"
    )
    told = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT / "reports", capture_output=True, text=True, timeout=300
    )
    assert told.returncode == 0, told.stderr
    lines = told.stdout.splitlines()
    assert lines[0].startswith("| fem, 4 x 4, mu = 0.25, 20 steps |")
    assert re.search("2 .* `fem` ", told.stdout) and "- n: 16 s at 4, as n^2.00" in lines
    assert "| numpy " in told.stdout
    for name, steps in (("contact that opens", 200), ("slope under a record", 200), ("rocking with impacts", 100)):
        assert f"| dda, {name} | {steps} |" in told.stdout
    assert "| fem, 16 x 16, bonded, opens | 300 |" in told.stdout and "| 0.02 | " in told.stdout
