"""Requests from standard input, answers to standard output."""

from __future__ import annotations

import gc
import json
import os
import resource
import sys
import time
from typing import IO, Any

import dolfinx
import numpy as np
from mpi4py import MPI

from .model import COMM, Block, Inapplicable, Request
from .newmark import Factor, Newmark
from .opening import COLUMNS as OPENING
from .opening import Opening
from .plane import PlaneBody, statics

IDLE = 1e-3  # s between two looks for work on the ranks that wait for the first


def run(request: Request) -> dict[str, Any]:
    """Answer one request; every rank runs this, and all return the same."""
    if "tractions" in request:
        return run_plane(request)
    return run_open(request) if request["law"] == "unilateral" else run_locked(request)


def run_plane(request: Request) -> dict[str, Any]:
    """Answer a request for a plane body without springs."""
    Factor.factorisations = Factor.solves = 0
    began = time.perf_counter()
    body = PlaneBody(request)
    scheme = Newmark(body, request)
    ready = time.perf_counter()
    (row,) = body.observers.values()
    history = [float(row.dot(scheme.advance())) for _ in range(request["steps"])]
    counted = _counted(began, ready, time.perf_counter())
    return {
        "outcome": "completed",
        "time": (request["step"] * np.arange(1, request["steps"] + 1)).tolist(),
        "columns": {"displacement": history},
        "static": statics(body),
        "unknowns": body.K.getSize()[0],
        "nonzeros": scheme.nonzeros,
        **counted,
    }


def run_open(request: Request) -> dict[str, Any]:
    """Answer a request for contact that carries no tension; a history may end early."""
    Factor.factorisations = Factor.solves = 0
    began = time.perf_counter()
    block = Block(request | {"stiffness": 0.0, "shear_stiffness": 0.0})
    scheme = Opening(block, request)
    ready = time.perf_counter()
    rows: list[dict[str, float]] = []
    failure = ""
    while len(rows) < request["steps"] and not failure:
        contact, failure = scheme.advance()
        observed = {name: float(row.dot(scheme.D)) for name, row in block.observers.items()}
        rows += [] if failure else [observed | dict(zip(OPENING, contact, strict=True))]
    return {
        "outcome": failure or "completed",
        "time": (request["step"] * np.arange(1, len(rows) + 1)).tolist(),
        "columns": {name: [row[name] for row in rows] for name in request["columns"]},
        "pressed": [bool(row["contact_pressure"] > 0) for row in rows],
        "unknowns": block.K.getSize()[0],
        "nonzeros": scheme.nonzeros,
        **_counted(began, ready, time.perf_counter()),
    }


def run_locked(request: Request) -> dict[str, Any]:
    """Answer a request for locked springs."""
    Factor.factorisations = Factor.solves = 0
    began = time.perf_counter()
    block = Block(request)
    scheme = Newmark(block, request)
    ready = time.perf_counter()
    rows = [block.observers[name] for name in request["columns"]]
    history = np.array([[row.dot(D) for row in rows] for D in (scheme.advance() for _ in range(request["steps"]))])
    counted = _counted(began, ready, time.perf_counter())
    rest = Factor(block.K)(scheme.load(request["last"]))
    static = {name: float(row.dot(rest)) for name, row in block.observers.items()}
    static["contact_pressure"] += float(block.carried_pressure(request["last"]))
    if request["moved"] and "contact_pressure" in request["columns"]:
        history[:, request["columns"].index("contact_pressure")] += block.carried_pressure(request["moved"][1:])
    return {
        "outcome": "completed",
        "time": (request["step"] * np.arange(1, request["steps"] + 1)).tolist(),
        "columns": {name: history[:, i].tolist() for i, name in enumerate(request["columns"])},
        "static": static,
        "unknowns": block.K.getSize()[0],
        "nonzeros": scheme.nonzeros,
        **counted,
    }


def _counted(began: float, ready: float, ended: float) -> dict[str, Any]:
    """What a history has cost."""
    peak = COMM.allreduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024, MPI.SUM)
    return {
        "factorisations": Factor.factorisations,
        "solves": Factor.solves,
        "setup_seconds": ready - began,
        "stepping_seconds": ended - ready,
        "memory": peak,
        "version": dolfinx.__version__,
    }


def answer(request: Request) -> dict[str, Any]:
    """Run one request; what fails alike on every rank is an answer, anything else ends all ranks."""
    try:
        return run(request)
    except Inapplicable as error:
        return {"inapplicable": str(error)}
    except ValueError as error:
        return {"refused": str(error)}
    except Exception as error:
        if COMM.size > 1:
            sys.stderr.write(f"{type(error).__name__}: {error}\n")
            COMM.Abort(1)
        return {"raised": f"{type(error).__name__}: {error}"}


def next_line() -> str:
    """Line that the first rank reads; the others wait for it without keeping a processor busy."""
    if COMM.rank == 0:
        line = sys.stdin.readline()
        for rank in range(1, COMM.size):
            COMM.send(line, dest=rank)
        return line
    while not COMM.iprobe(source=0):
        time.sleep(IDLE)
    return str(COMM.recv(source=0))


def answers_only() -> IO[str]:
    """Keep standard output for answers: whatever a library writes there goes to standard error."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    return answers


def main() -> None:
    """Answer request after request."""
    out = answers_only()
    while line := next_line():
        request = json.loads(line)
        result = answer(request)
        if COMM.rank == 0:
            out.write(json.dumps({**result, "id": request.get("id")}) + "\n")
            out.flush()
        gc.collect()  # on every rank at the same place: matrices are freed together
