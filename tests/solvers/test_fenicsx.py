"""FEniCSx as a second finite-element code: absence by name, equality on every mesh and foundation, faults seen."""

import os
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from conftest import typed
from faults import seams
from faults.fault import Fault, times, undiscounted, with_scheme
from faults.kill_matrix import check_study

from validation import solve
from validation.engine.case import Case
from validation.engine.measure import execute
from validation.engine.run import finish, run_study
from validation.engine.study import Study
from validation.errors import InputError
from validation.gates.gate import Gate, Status
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import load_scene
from validation.solvers import fenicsx as adapters_fenicsx
from validation.solvers.contract import NotReported
from validation.solvers.fenicsx import VARIABLE, interpreter, launcher, worker_directories
from validation.solvers.processes import worker
from validation.solvers.registry import get_solver
from validation.studies.two_codes.formulas import SAME
from validation.suite.folders import get_study


def error(scene, solver="fenicsx"):
    """Largest difference of the two codes over the maximum, of any column."""
    sound, other = solve(scene, "fem", full=True).history, solve(scene, solver).history
    assert sound is not None and other is not None and np.array_equal(sound.time, other.time)
    return max(np.abs(other.columns[n] - x).max() / np.abs(x).max() for n, x in sound.columns.items())


def test_absence_is_not_run_by_name(scene_file, monkeypatch, tmp_path):
    monkeypatch.setenv(VARIABLE, "/no/such/python")
    alone = typed("solve", scene_file, "--solver", "fenicsx", cwd=tmp_path)
    assert alone.returncode == 2
    assert (
        adapters_fenicsx.INSTALL_HINT in alone.stderr and "/no/such/python" in alone.stderr and VARIABLE in alone.stderr
    )
    gate = Gate("small", ("fenicsx", "fem"), "pressure.l2", 0.0, 1e-9, "two codes")
    study = Study("test", "t", "p", [load_scene(scene_file)], ("fem", "fenicsx"), gates=lambda: (gate,))
    (verdict,) = run_study(study, Results(tmp_path))
    assert verdict.status is Status.NOT_RUN


def test_a_mesh_file_becomes_points_and_cells(tmp_path):
    """Numbers without those that no cell has."""
    points = np.array([[9.0, 9.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.5, 0.0]])
    kept = {"triangle": np.array([[1, 2, 3], [3, 2, 4]]), "line": np.array([[1, 2]])}
    scene = load_scene("pentagon")
    for cells in (kept, {"line": kept["line"]}):
        meshio.write(tmp_path / "m.vtk", meshio.Mesh(points, cells))
        asked = scene.with_values({"fem.mesh": str(tmp_path / "m.vtk")})
        if "triangle" in cells:
            found = adapters_fenicsx.request(asked)
            assert (found["points"], found["cells"]) == (points[1:, :2].tolist(), [[0, 1, 2], [2, 1, 3]])
        else:
            with pytest.raises(InputError) as error:
                adapters_fenicsx.request(asked)
            assert error.value.field == "fem.mesh"


def test_what_was_not_installed_is_tried_again(scene, tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "/no/such/python")
    row, _ = execute(Case(scene, "fenicsx"), "key", "study")
    assert row.outcome is Outcome.NOT_RUN
    absent = get_solver("fenicsx").prepare(scene)
    for ask in (absent.static, absent.modes, absent.diagnostics, lambda: absent.amplitudes(np.ones(1), False)):
        with pytest.raises(NotReported, match="/no/such/python"):
            ask()
    results = Results(tmp_path)
    for _ in range(2):
        finish([Case(scene, "fenicsx")], get_study("two-codes"), results)
    assert (tmp_path / "rows.jsonl").read_text().count("FEniCSx") == 2


def test_a_directory_of_the_path_that_cannot_be_read_is_passed_over(tmp_path, monkeypatch):
    for name, text in (("python3", "#!/bin/sh\n"), ("python3.9", "")):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)

    def listed(path):  # root may read everything, so that no mode of a directory will do
        if path == "/locked/bin":
            raise PermissionError(13, "Permission denied", path)
        return os.listdir(path)

    worker_directories = SimpleNamespace(**vars(os) | {"listdir": listed})
    monkeypatch.setattr(adapters_fenicsx, "os", worker_directories)
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setenv("PATH", os.pathsep.join(["/locked/bin", str(tmp_path / "absent"), str(tmp_path)]))
    assert list(adapters_fenicsx.candidates()) == [
        sys.executable,
        *(str(tmp_path / name) for name in ("python3.9", "python3")),
    ]


@pytest.mark.parametrize("name", ["fenicsx:0", "fenicsx:two", "fenicsx:", "dda:2"])
def test_a_wrong_number_of_ranks_is_refused(name):
    with pytest.raises(InputError, match=r"^solver: "):
        get_solver(name)


def test_ranks_go_with_solvers_that_can_use_them(scene_file):
    done = typed("solve", scene_file, "--solver", "dda", "--ranks", 2)
    assert done.returncode == 2 and done.stderr.startswith("error: --ranks: ")


@pytest.mark.fenicsx
def test_the_interpreter_is_found_and_the_launcher_beside_it():
    python = interpreter()
    assert python is not None and not adapters_fenicsx.has_dolfinx("/no/such/python")
    assert launcher(python) is not None


LOADS = {
    "eccentric": {"load.eccentricity": -0.25},
    "sideways": {"load": {"traction": 2e5}, "fem.foundation": "corner"},
    "weight": {"load": {"gravity": 9.81, "slope": 20.0}, "block.poisson": 0.2},
    "record": {"load": {"base_motion": "quake.csv"}, "time.start": "consistent"},
    "record on corners": {"load": {"base_motion": "quake.csv"}, "fem.foundation": "corner"},
    "all": {
        "load": {"pressure": 1e6, "eccentricity": 0.5, "traction": 1e5, "gravity": 9.81, "base_motion": "quake.csv"}
    },
}
TELLING = ("all",)  # what they miss is in no other


@pytest.mark.fenicsx
@pytest.mark.parametrize(
    "values",
    [
        pytest.param(values, id=name, marks=[] if name in TELLING else pytest.mark.long)
        for name, values in LOADS.items()
    ],
)
def test_the_two_codes_agree_on_every_load(scene, values, tmp_path):
    record = tmp_path / "quake.csv"
    record.write_text("time,x,y\n0,1e-4,0\n0.01,1e-3,2e-4\n0.03,-5e-4,1e-4\n")
    load = values.get("load")
    if isinstance(load, dict) and "base_motion" in load:
        values = values | {"load": load | {"base_motion": str(record)}}
    columns = {"run.columns": ["displacement", "contact_pressure", "horizontal_displacement"]}
    case = scene.with_values(values | columns)
    runs = [get_solver(name).solve(case, full=True) for name in ("fenicsx", "fem")]
    own, other = (run.history for run in runs)
    static = [get_solver(name).static(case) for name in ("fenicsx", "fem")]
    moved = max(float(np.abs(other.columns[name]).max()) for name in ("displacement", "horizontal_displacement"))
    for name, values_of in other.columns.items():
        # what is zero by symmetry is rounding in both: displacements share a scale, the springs turn it into pressure
        scale = moved * (case.contact.stiffness if name == "contact_pressure" else 1.0)
        assert np.abs(own.columns[name] - values_of).max() <= SAME * scale, name
        assert abs(static[0][name] - static[1][name]) <= SAME * scale, name


@pytest.mark.fenicsx
@pytest.mark.parametrize("ranks", [1, pytest.param(2, marks=pytest.mark.long)])
def test_what_the_worker_counts(scene, ranks):
    run = get_solver(f"fenicsx:{ranks}").solve(scene.with_values({"time.start": "consistent"}))
    assert dict(run.work) | {"nonzeros": 0} == {
        "unknowns": 2 * 9**2,
        "nonzeros": 0,
        "factorisations": 2,
        "solves": 51,
        "steps": 50,
        "ranks": ranks,
    }
    assert run.notes[0].startswith("dolfinx ") and run.seconds.keys() == {"setup", "stepping"}


@pytest.mark.fenicsx
def test_what_it_does_not_do_is_said(scene):
    inside = scene.with_values({"fem": {"elements": 4, "foundation": "patch", "patch_width": 0.31}})
    run = solve(inside, "fenicsx")
    assert run.outcome is Outcome.NOT_APPLICABLE
    within = solve(scene.with_values({"load.eccentricity": 0.31}), "fenicsx")
    assert within.outcome is Outcome.NOT_APPLICABLE
    with pytest.raises(InputError, match=r"run\.columns"):
        solve(scene.with_values({"run.columns": ["rotation"]}), "fenicsx")


def test_a_dead_worker_is_named_and_replaced():
    command = [sys.executable, "-c", "import sys; sys.stderr.write('no licence\\n'); sys.exit(7)"]
    for _ in range(2):
        with pytest.raises(worker.WorkerDied, match="licence"):
            worker.ask(command, {}, {})
    echo = [sys.executable, "-c", "import sys\nfor line in sys.stdin: print(line, end='', flush=True)"]
    assert [worker.ask(echo, {}, {"a": n}) for n in (1, 2)] == [{"a": 1}, {"a": 2}]


def test_the_reason_is_found_under_the_launcher_s_words():
    rule = "-" * 74
    advice = "[host:00012] 1 more process has sent help message help-mpi-api.txt / mpi-abort"
    error = "PermissionError: [Errno 13] Permission denied: '/nonexistent'"
    aborted = ["MPI_ABORT was invoked on rank 0", "", "NOTE: invoking MPI_ABORT", rule, advice]
    assert worker.stderr_tail("\n".join([error, error, rule, *aborted])) == error
    assert worker.stderr_tail(f"{rule}\nfailed\n{rule}\n{advice}\n") == "failed"
    assert worker.stderr_tail("\n")


def test_a_worker_without_a_home_gets_a_temporary_one(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    for _ in range(2):  # made, and there already
        assert worker_directories().keys() == {"TMPDIR"}
    monkeypatch.delenv("XDG_CACHE_HOME")
    for home in ("/proc/none", "/dev/null/home"):  # where not even root can make a directory
        monkeypatch.setenv("HOME", home)
        found = worker_directories()
        assert len({found[name] for name in ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME")}) == 1
        assert os.access(found["XDG_CACHE_HOME"], os.W_OK)


@pytest.mark.long
@pytest.mark.fenicsx
@pytest.mark.parametrize("solver", ["fenicsx", "fenicsx:2"])
def test_fenicsx_runs_without_a_home_and_from_any_path(scene, solver, tmp_path, monkeypatch):
    path = tmp_path / "mit Blank und Ümläuten" / "worker"
    shutil.copytree(adapters_fenicsx.WORKER, path)
    seams.FENICSX_WORKER.put(monkeypatch, path)
    monkeypatch.chdir(path.parent)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    for name, value in {"HOME": "/proc/none", "TMPDIR": "/proc/none", "LC_ALL": "POSIX", "PYTHONUTF8": "0"}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("PYTHONCOERCECLOCALE", "0")
    assert 0 < error(scene, solver) <= SAME


WORKER_FAULTS = {  # a line of the worker, and what a slip makes of it; 2e-10 is twice the band's edge
    "fenicsx: load 2e-10 high": ("return load", "return (1 + 2e-10) * load"),
    "fenicsx: gg missing in the velocity": ("V = gg * V", "V = V"),
    "fenicsx: start forgotten": ('request["start"] == "consistent"', "False"),
    "fenicsx: plane strain as plane stress": ('hypothesis == "plane strain"', "False"),
    "fenicsx: quadrature one point short": ('2 * request["degree"] + 1', '2 * request["degree"] - 1'),
    "fenicsx: springs p/2": ("spread = 2 / carried", "spread = 1 / carried"),
}
OTHER_FAULTS = [
    Fault("fem: gg missing in the velocity", ("fem:full",), seams.FEM_VELOCITY, undiscounted(2)),
    Fault("fem: delta 1e-6 high", ("fem:full",), seams.FEM_VELOCITY, with_scheme(0, gamma=lambda d: d * (1 + 1e-6))),
    Fault("fem: foundation 1e-6 stiff", ("fem:full",), seams.FEM_FOUNDATION, times(1 + 1e-6)),
    Fault("fem: mass 1e-6 heavy", ("fem:full",), seams.FEM_MASS, times(1 + 1e-6)),
    Fault("fem: load 2e-10 high", ("fem:full",), seams.FEM_LOAD, times(1 + 2e-10)),
    Fault("dda: load 2e-10 high", ("dda",), seams.DDA_LOAD, times(1 + 2e-10)),
]


def module_of(line):
    """Return the one module of the worker in which the line stands, once."""
    modules = ("model.py", "block.py", "newmark.py", "loop.py")
    counts = {name: (adapters_fenicsx.WORKER / name).read_text().count(line) for name in modules}
    (name,) = [name for name, count in counts.items() if count]
    assert counts[name] == 1, line
    return name


def test_the_line_of_each_fault_stands_in_the_worker():
    for line, _ in WORKER_FAULTS.values():  # where FEniCSx is not installed nothing else would see that it moved
        assert module_of(line)


def faulty_worker(directory, number, line, slip):
    """Write the worker with one fault into a directory of its own."""
    path = directory / f"worker{number}"
    shutil.copytree(adapters_fenicsx.WORKER, path)
    module = path / module_of(line)
    module.write_text(module.read_text().replace(line, slip))
    return path


@pytest.mark.long
@pytest.mark.fenicsx
@pytest.mark.parametrize("solver", ["fenicsx", "fem:full", "dda"])
def test_seeded_faults_of_each_code_bite_its_gates(solver, tmp_path, finished_cases):
    faults = [fault for fault in OTHER_FAULTS if solver in fault.solvers]
    for number, (name, (line, slip)) in enumerate(WORKER_FAULTS.items() if solver == "fenicsx" else ()):
        path = faulty_worker(tmp_path, number, line, slip)
        faults.append(Fault(name, ("fenicsx", "fenicsx:2"), seams.FENICSX_WORKER, lambda _, path=path: path))

    def is_checked(gate):
        return any(name.startswith(solver) for name in gate.pair)

    check_study("two-codes", faults, tmp_path, finished_cases, is_checked)
    worker.close_all()


@pytest.mark.parametrize("name", ["pentagon", pytest.param("quadrilateral", marks=pytest.mark.long)])
def test_polygons_on_files_of_gmsh(name, tmp_path):
    scene = load_scene(name)
    assert scene.fem.mesh is not None and Path(scene.fem.mesh).read_text().startswith("$MeshFormat\n4.1")
    get_solver("fem").solve(scene, fields=tmp_path / "block.vtu")
    mesh, source = meshio.read(tmp_path / "block.vtu"), meshio.read(scene.fem.mesh)
    kind = "quad" if name == "quadrilateral" else "triangle"
    assert len(mesh.points) == len(source.points) and len(mesh.cells_dict[kind]) == len(source.cells_dict[kind])
    assert {tuple(p) for p in mesh.points.round(12)} == {tuple(p) for p in source.points.round(12)}
    stress = mesh.cell_data["stress"][0]
    # nearly at rest: the mean vertical stress over the cells is what the top carries
    assert -1.2 * scene.load.pressure < stress[:, 1].mean() < -0.6 * scene.load.pressure
