"""Tables as text: what is written in full reads back to the last bit, and code builds the same arm."""

from __future__ import annotations

import csv
import io
import json
import re
import sys
import types
from math import pi

import numpy as np
import pytest

import dualpin as dp


@pytest.fixture(scope="module")
def mixed() -> dp.Robot:
    rows = np.random.default_rng(8).uniform(-1, 1, (3, 4))
    rows[1, 3] = 1e-3  # nearly parallel: a fixed row
    return dp.from_dh(rows, "RPC", base=dp.Dual(0.3, 0.1), tool=dp.Dual(0.2, 0.4), name="mixed")


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_json_rebuilds_the_arm(mixed: dp.Robot, convention: str) -> None:
    dh = dp.to_dh(mixed, convention=convention)
    data = json.loads(dh.export("json"))
    assert data["convention"] == convention and data["angles"] == "rad"
    rows = [[r["theta"], r["d"], r["a"], r["alpha"]] for r in data["rows"]]
    assert np.array_equal(rows, dh.columns)
    letter = {"revolute": "R", "prismatic": "P", "cylindrical": "C", "fixed": "F"}

    def end(steps: list) -> np.ndarray:
        T = np.eye(4)
        for s in steps:
            T = T @ dp.forms.DHStep(dp.Dual(s["theta"], s["d"]), dp.Dual(s["alpha"], s["a"]), convention).matrix
        return T

    arm = dp.from_dh(
        rows, [letter[r["kind"]] for r in data["rows"]], convention, base=end(data["base"]), tool=end(data["tool"])
    )
    q = np.random.default_rng(0).uniform(-1, 1, (4, 4))
    assert np.abs(dp.fk(arm, q, "tool") - dp.fk(mixed, q, "tool")).max() <= 1e-13


def test_csv_is_in_full_precision_and_degrees_are_named(mixed: dp.Robot) -> None:
    dh = dp.to_dh(mixed)
    rows = list(csv.DictReader(io.StringIO(dh.export("csv"))))
    moving = [r for r in rows if r["row"] not in ("base", "tool")]
    assert np.array_equal([[float(r[k]) for k in ("theta", "d", "a", "alpha")] for r in moving], dh.columns)
    assert [r["kind"] for r in moving] == [r.letter for r in dh.rows]
    rows = list(csv.DictReader(io.StringIO(dh.export("csv", degrees=True))))
    assert float(rows[1]["theta_deg"]) == np.degrees(dh.rows[0].theta)


def test_yaml_is_read_back_the_same(mixed: dp.Robot) -> None:
    yaml = pytest.importorskip("yaml")
    dh = dp.to_dh(mixed)
    assert yaml.safe_load(dh.export("yaml")) == json.loads(dh.export("json"))


def test_digits_round_only_when_asked() -> None:
    dh = dp.to_dh(dp.load("ur5"), "base", "tool0")
    assert "1.5707963267948966" in dh.export("csv")
    assert "1.570796326794897" in dh.table()  # for people: rounded below the residual
    assert "1.571" in dh.table(digits=4) and "1.5707" not in dh.table(digits=4)
    assert json.loads(dh.export("json", digits=3))["rows"][0]["alpha"] == 1.57


def test_latex_and_markdown_have_a_line_for_each_row(mixed: dp.Robot) -> None:
    dh = dp.to_dh(mixed)
    latex, markdown = dh.export("latex"), dh.export("markdown")
    steps = len(dh.base.steps) + len(dh.rows) + len(dh.tool.steps)
    assert latex.count(r"\\") == steps + 1
    assert len(markdown.splitlines()) == steps + 2
    assert r"joint\_1" in latex and "q_{1}" in latex
    assert r"-\pi/2" in dp.to_dh(dp.load("panda"), tip="panda_link8").export("latex")


def test_files_are_written(mixed: dp.Robot, tmp_path) -> None:
    dh = dp.to_dh(mixed)
    for format in ("csv", "json", "yaml", "markdown", "latex", "python", "matlab"):
        path = tmp_path / format
        getattr(dh, f"to_{format}")(path)
        assert path.read_text(encoding="utf-8") == dh.export(format)


class _Toolbox:
    """The links of robotics-toolbox-python as its manual defines them, no more."""

    def __init__(self) -> None:
        self.toolbox, self.spatialmath = types.ModuleType("roboticstoolbox"), types.ModuleType("spatialmath")
        self.spatialmath.SE3 = lambda T, check=True: np.asarray(T)
        for kind in ("Revolute", "Prismatic"):
            for suffix in ("DH", "MDH"):
                setattr(self.toolbox, kind + suffix, lambda kind=kind, suffix=suffix, **kw: (kind, suffix, kw))
        self.toolbox.DHRobot = lambda links, name, base, tool: (links, name, base, tool)

    @staticmethod
    def fk(robot: tuple, q: np.ndarray) -> np.ndarray:
        links, _, T, tool = robot
        for (kind, suffix, k), x in zip(links, q, strict=True):
            theta, d = (x + k["offset"], k["d"]) if kind == "Revolute" else (k["theta"], x + k["offset"])
            if "qlim" in k:
                assert x == 0 == sum(k["qlim"])
            convention = "standard" if suffix == "DH" else "modified"
            T = T @ dp.forms.DHStep(dp.Dual(theta, d), dp.Dual(k["alpha"], k["a"]), convention).matrix
        return T @ tool


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_python_code_builds_the_same_arm(mixed: dp.Robot, convention: str, monkeypatch: pytest.MonkeyPatch) -> None:
    fake = _Toolbox()
    monkeypatch.setitem(sys.modules, "roboticstoolbox", fake.toolbox)
    monkeypatch.setitem(sys.modules, "spatialmath", fake.spatialmath)
    dh = dp.to_dh(mixed, convention=convention)
    code = dh.export("python")
    scope: dict = {}
    exec(code, scope)
    still = [int(k) for k in re.findall(r"q\[(\d+)\] = 0 always", code)]
    assert len(still) == sum(r.letter == "F" for r in dh.rows) == 1
    for q in np.random.default_rng(0).uniform(-1, 1, (4, 4)):
        with_zeros = list(q)
        for k in still:
            with_zeros.insert(k, 0.0)
        assert np.abs(fake.fk(scope["robot"], np.array(with_zeros)) - dp.fk(mixed, q, "tool")).max() <= 1e-13


def test_matlab_code_names_the_same_numbers(mixed: dp.Robot) -> None:
    code = dp.to_dh(mixed, convention="modified").export("matlab")
    assert code.count("'modified'") == 5 == code.count("    Link(")  # R, P, C as two, and the fixed row
    assert "'qlim', [0 0]" in code and "SerialLink(links, 'name', 'mixed', 'base', base, 'tool', tool)" in code
    panda = dp.to_dh(dp.load("panda"), "panda_link0", "panda_link8").export("matlab")
    assert "'revolute', 'd', 0.333, 'a', 0.0, 'alpha', -pi/2, 'offset', 0.0, 'standard')  % panda_joint1" in panda


@pytest.mark.parametrize("format", ["table", "csv", "json", "yaml", "markdown", "latex"])
def test_khalil_tables_are_exported(format: str) -> None:
    table = dp.to_dh(dp.load("allegro_left"), convention="khalil-kleinfinger")
    text = table.export(format, degrees=True)
    assert "joint_0" in text.replace("\\", "")
    if format == "json":
        rows = json.loads(text)["rows"]
        assert [r["antecedent"] for r in rows] == [r.antecedent for r in table.rows]
        assert rows[0]["alpha"] * pi / 180 == pytest.approx(table.rows[0].alpha)
