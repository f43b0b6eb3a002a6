"""Sweeps over processes and over a Dask cluster: the same rows, streamed into the same results directory."""

import itertools
import os
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from validation.cli.app import app
from validation.engine import cluster
from validation.engine.run import run_study
from validation.engine.study import Study
from validation.errors import InputError
from validation.runs.results import Results
from validation.scenes.scene import load_scene

SCENES = [
    load_scene("figures-5-6").with_values({"time.step": step, "time.gg": gg, "time.steps": 40}, label=True)
    for step, gg in itertools.product((1e-3, 2e-3), (1.0, 0.98))
]
STUDY = Study("sweep", "Sweep", "A sweep.", SCENES, ("dda", "bar"))


def rows(directory):
    """Return the rows without what a clock or an address decides."""
    return {key: replace(row, seconds={}) for key, row in Results(directory).rows().items()}


def same_histories(one, other):
    keys = rows(one)
    return all(
        np.array_equal(values, Results(other).history(key).columns[name])
        for key in keys
        for name, values in Results(one).history(key).columns.items()
    )


def test_an_absent_package_is_named(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(InputError, match=r"^--scheduler: needs .*\[cluster\]"), cluster.executor("tcp://127.0.0.1:1"):
        pass


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")  # another package's own
def test_a_dask_cluster_gives_the_same_rows_and_a_lost_worker_costs_none(tmp_path):
    distributed = pytest.importorskip("distributed")
    run_study(STUDY, Results(tmp_path / "serial"))
    lost = []
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as workers:

        def lose(done, total, label):
            if not lost:
                lost.append(next(iter(workers.workers.values())).pid)
                os.kill(lost[0], 9)

        address = workers.scheduler_address
        with cluster.executor(address) as pool:
            run_study(STUDY, Results(tmp_path / "dask"), executor=pool, progress=lose)
        arguments = ["run", "poisson-statics", "--scheduler", address, "--results", str(tmp_path / "cli")]
        assert CliRunner().invoke(app, arguments).exit_code == 0
    assert lost
    assert rows(tmp_path / "serial") == rows(tmp_path / "dask")
    assert same_histories(tmp_path / "serial", tmp_path / "dask")
