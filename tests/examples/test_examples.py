"""Every example does its task: it runs alone, from any folder, and its own assertions hold."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_it_runs(path, tmp_path, monkeypatch, capsys):
    text = path.read_text(encoding="utf-8")
    assert 15 <= len(text.splitlines()) <= 60 and text.startswith('"""')
    if any(word in text for word in ("validate", 'dp.load("', "judge")):
        pytest.importorskip("pinocchio")  # which brings the robots
    if "symbolic" in text:
        pytest.importorskip("sympy")
    if "convert" in text:
        pytest.importorskip("mujoco")
    for library in ("torch", "jax"):
        if f"dualpin.{library}" in text:
            pytest.importorskip(library)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", [str(path)])
    code = 0
    try:
        runpy.run_path(str(path), run_name="__main__")
    except SystemExit as e:
        code = e.code
    assert not code and capsys.readouterr().out
