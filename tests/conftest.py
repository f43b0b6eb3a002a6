"""Shared fixtures: a small scene as text, as a file, and the command line as a process."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCENE = """\
title = "A small scene"

[block]
side = 2.0
density = 2700.0
young = 1.0e9

[contact]
stiffness = 1.0e9

[load]
pressure = 5.0e6

[time]
step = 0.002
steps = 50

[fem]
elements = 4
"""


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(SCENE)
    return path


def cli(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run the command line as a user does."""
    return subprocess.run(
        [sys.executable, "-m", "validation", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=cwd,
        env=os.environ | {"OMP_NUM_THREADS": "1", "COLUMNS": "160"},
    )
