# SPDX-License-Identifier: BSD-3-Clause
"""Signals while weft computes: Python sees them, and its end ends the program."""
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import weft


def grid(n, up):
    """A square of n x n vertices as a mesh; `up`: it stands."""
    u, v = np.meshgrid(np.linspace(-0.1, 0.1, n), np.linspace(-0.1, 0.1, n))
    rest = np.c_[u.ravel(), v.ravel()]
    start = np.c_[rest[:, 0], rest[:, 1], 0.003 + 0 * rest[:, 0]] if up else \
        np.c_[rest[:, 0], 0 * rest[:, 0], rest[:, 1]]
    at = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    triangles = np.r_[np.c_[at, at + 1, at + n], np.c_[at + 1, at + n + 1, at + n]]
    return weft.Mesh(rest, start, triangles)


def tangled():
    """Two sheets through one another that do not come apart, for minutes."""
    fabric = {"density": 0.2, "stretch": 80, "shear": 20}
    return {"cloths": [{"name": "a", "mesh": grid(20, False), "fabric": fabric},
                       {"name": "b", "mesh": grid(20, True), "fabric": fabric}],
            "contact": {"thickness": 1.5e-3, "self": True, "untangle": 1000},
            "stepper": {"plugin": "arkode", "method": "dormand_prince"}, "run": {"duration": 0.1}}


@pytest.mark.parametrize("name", ["SIGINT", "SIGALRM"])
def test_a_signal_ends_a_start_that_relaxes(name):
    def handler(*_):
        raise TimeoutError("in time")

    before = signal.signal(signal.SIGALRM, handler)
    timer = threading.Timer(1.0, os.kill, (os.getpid(), getattr(signal, name)))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt if name == "SIGINT" else TimeoutError):
            weft.load(tangled())
    finally:
        timer.join()
        signal.signal(signal.SIGALRM, before)
    assert weft.load(weft.scene("two-corners")).step() > 0  # the next call knows nothing of it


def brief(**run):
    """A grid of few particles, as functions of Python see it."""
    return {"weft": 1, "cloth": {"grid": {"rows": 4, "cols": 4, "spacing": 0.01}, "density": 0.2,
                                 "springs": {"stretch": {"stiffness": 50}}},
            "stepper": {"plugin": "arkode", "method": "rk4", "fixed_step": 1e-4}, "run": {"duration": 1.0, **run}}


def advancing(**own):
    sim = weft.load(brief(), **own)
    return lambda: sim.advance(sim.time + 0.02)


OWN = {
    "force": lambda: advancing(force=lambda t, x, v, f: None),
    "correction": lambda: advancing(correct=lambda t, h, x, v: False),
    "event": lambda: advancing(event=lambda t, x, v: 1.0),
    "objective": lambda: lambda: weft.gradient(brief(duration=0.01, fps=10000),
                                               lambda t, x, v: (0.0, np.zeros(x.shape))),
}


def test_a_simulation_is_destroyed_without_python_code():
    """There a handler of a signal would run, and what it raises would be lost."""
    called, sim = [], weft.load(brief())
    sys.setprofile(lambda frame, event, _: called.append(frame.f_code.co_name) if event == "call" else None)
    try:
        del sim
    finally:
        sys.setprofile(None)
    assert called == []


@pytest.mark.filterwarnings("ignore::weft.PerformanceWarning")
@pytest.mark.parametrize("name", OWN)
def test_no_signal_is_lost_between_weft_and_an_own_function(name):
    class Signal(Exception):
        pass

    sent = []

    def handler(*_):
        sent.append(1)
        raise Signal

    compute = OWN[name]()
    before = signal.signal(signal.SIGALRM, handler)
    try:
        for k in range(20):
            with pytest.raises(Signal):
                signal.setitimer(signal.ITIMER_REAL, 0.002 + 0.0004 * k, 0.5)
                while True:
                    compute()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert len(sent) == 20  # the timer repeats after one that is lost
    compute()  # what was interrupted can be used again


@pytest.mark.parametrize("end", [signal.SIGTERM, signal.SIGKILL])
def test_the_program_ends_with_python(end, tmp_path):
    code = "import sys, weft; weft.run(weft.scene('two-corners'), sys.argv[1], {'run.duration': 1e4})"
    out = tmp_path / "run"
    python = subprocess.Popen([sys.executable, "-c", code, str(out)])
    while not (out / "series.csv").exists():
        assert python.poll() is None
        time.sleep(0.05)
    python.send_signal(end)
    assert python.wait() == -end
    while not (out / "result.yaml").exists():
        time.sleep(0.05)
    assert weft.open(out).result["status"] == "interrupted"
