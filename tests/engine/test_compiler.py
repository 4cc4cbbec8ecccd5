"""Large programs are compiled by several processes, to the same code."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

import dualpin as dp
from dualpin.engine import tuning
from dualpin.engine.jit import compiler
from dualpin.engine.jit import kernel as kernels
from dualpin.engine.jit.host import CompilerError, this_host
from dualpin.terms import TERMS


@pytest.fixture
def three_processes(monkeypatch):
    monkeypatch.setattr(tuning, "PROCESSES_FROM", 0)
    dp.set_num_threads(3)
    yield
    dp.set_num_threads(None)


def coriolis(lanes=None):
    robot, host, kind = dp.load("solo8"), this_host(), np.dtype(float)
    about, code = kernels.compiled(robot, TERMS["coriolis"], {}, kind, host, lanes or host.lanes(8))
    q, v, _ = robot.sample(19, seed=1)
    return about["objects"], kernels.Kernel(about, code, (robot.nv, robot.nv), kind).rows([q, v])


@pytest.mark.parametrize("lanes", [1, None])
def test_several_processes_make_the_same_code(three_processes, monkeypatch, lanes):
    several, result = coriolis(lanes)
    monkeypatch.setattr(tuning, "PROCESSES_FROM", 10**9)
    one, expected = coriolis(lanes)
    assert (len(several), len(one)) == (3, 1)
    assert np.array_equal(result.view("u8"), expected.view("u8"))


@pytest.mark.parametrize("program", ["import sys; sys.stdin.read(); sys.exit(3)", "0", "print('x', flush=True); 1/0"])
def test_a_process_that_fails_is_done_without(three_processes, monkeypatch, tmp_path, program):
    _, expected = coriolis()
    broken = tmp_path / "worker.py"
    broken.write_text(program)
    begun = []

    def begin(command, **kinds):
        begun.append(subprocess_popen([*command[:-1], str(broken)], **kinds))
        return begun[-1]

    subprocess_popen = subprocess.Popen
    monkeypatch.setattr(compiler.subprocess, "Popen", begin)
    sizes, result = coriolis()
    assert len(sizes) == 3
    assert np.array_equal(result, expected)
    assert len(begun) == 2
    assert all(p.returncode is not None for p in begun)


def test_pipes_with_other_ends_elsewhere_hold_nobody_up(three_processes, monkeypatch):
    """As after a fork in another thread: closing a pipe here does not end it."""
    real, ends = subprocess.Popen, []

    def begin(*arguments, **kinds):
        process = real(*arguments, **kinds)
        ends.extend([os.dup(process.stdin.fileno()), os.dup(process.stdout.fileno())])
        return process

    monkeypatch.setattr(compiler.subprocess, "Popen", begin)
    try:
        sizes, _ = coriolis()
    finally:
        for end in ends:
            os.close(end)
    assert (len(sizes), len(ends)) == (3, 4)


def test_entries_of_the_path_that_python_ignores_are_ignored(three_processes, monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "path", [*sys.path, tmp_path, None])
    sizes, _ = coriolis()
    assert len(sizes) == 3


def test_objects_of_other_sizes_are_not_believed():
    assert compiler.split(b"abcde", [2, 3]) == [b"ab", b"cde"]
    for sizes in ([2, 2], [2, 4], []):
        with pytest.raises(CompilerError, match="5"):
            compiler.split(b"abcde", sizes)


@pytest.mark.parametrize("python", [None, "", "/opt/blender/blender"])
def test_a_program_that_python_is_part_of_compiles_alone(three_processes, monkeypatch, python):
    monkeypatch.setattr(sys, "executable", python)
    sizes, _ = coriolis()
    assert len(sizes) == 1


def test_an_error_ends_the_processes(three_processes, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(kernels, "schedule", interrupted)
    begun = []
    real = subprocess.Popen
    monkeypatch.setattr(compiler.subprocess, "Popen", lambda *a, **k: begun.append(real(*a, **k)) or begun[-1])
    with pytest.raises(KeyboardInterrupt):
        coriolis()
    assert len(begun) == 2
    assert all(p.returncode is not None for p in begun)
