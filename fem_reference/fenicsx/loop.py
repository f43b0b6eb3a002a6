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

from .block import Block
from .factor import Factor
from .model import COMM, Inapplicable, Request
from .newmark import effective, start, steps
from .plane import PlaneBody

IDLE = 1e-3  # s between two looks for work on the ranks that wait for the first


def run(request: Request) -> dict[str, Any]:
    """Answer one request; every rank runs this, and all return the same."""
    Factor.factorisations = Factor.solves = 0
    began = time.perf_counter()
    block = PlaneBody(request) if "tractions" in request else Block(request)
    solve = effective(block, request)
    A = start(block, request, solve)
    ready = time.perf_counter()
    names = request.get("columns", [*block.observers])
    rows = [block.observers[name] for name in names]
    history = np.array([[row.dot(D) for row in rows] for D in steps(block, request, solve, A)])
    stepped = time.perf_counter()
    peak = COMM.allreduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024, MPI.SUM)
    if request["moved"] and "contact_pressure" in names:
        history[:, names.index("contact_pressure")] += np.array(request["moved"][1:]) @ block.base_pressure
    return {
        "time": (request["step"] * np.arange(1, request["steps"] + 1)).tolist(),
        "columns": {name: history[:, i].tolist() for i, name in enumerate(names)},
        "unknowns": block.K.getSize()[0],
        "nonzeros": solve.nonzeros,
        "factorisations": Factor.factorisations,
        "solves": Factor.solves,
        "setup_seconds": ready - began,
        "stepping_seconds": stepped - ready,
        "memory": peak,
        "version": dolfinx.__version__,
        "static": block.statics(),  # last: what it factors is no part of the history's count
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
