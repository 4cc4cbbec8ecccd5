"""What the README shows is what happens."""

import contextlib
import io
import re
from pathlib import Path

import pytest

import dualpin as dp
from tests.program import run

pytest.importorskip("pinocchio")
README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_the_quickstart_prints_what_the_readme_says():
    (code,), shown = blocks("python"), blocks("text")[0]
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, "README.md", "exec"), {})
    assert printed.getvalue() == shown


def commands():
    lines = [line.split("#")[0].split() for line in "".join(blocks("sh")).splitlines()]
    # the whole campaign has its own target
    return [line[1:] for line in lines if line[:1] == ["dualpin"] and "--all" not in line]


CODE = """
import dualpin as dp

class Arm:
    def __init__(self, urdf):
        self.robot = dp.load(urdf)
        self.joints = self.robot.joint_names

    def rnea(self, q, v, a):
        return dp.rnea(self.robot, q, v, a)
"""


EXITS = {"check": (0, 1), "diff": (1,)}
"""Exit codes of commands that find something; of others 0."""


def write_files(folder):
    """The files that the README's reader has, and what commands before wrote."""
    body = {"mass": 2.0, "com": (0.1, 0.0, 0.0), "inertia": ((0.02, 0, 0), (0, 0.03, 0), (0, 0, 0.03))}
    rows = [(0, 0.1, 0.5, 1.5), (0, 0, 0.4, 0)]
    for name in ("my_robot.urdf", "my_arm.urdf", "old.urdf", "arm.urdf.xacro"):
        dp.from_dh(rows, inertias=[body, body], name="arm").to_urdf(folder / name)
    dp.from_dh(rows, inertias=[body, {**body, "mass": 3.0}], name="arm").to_urdf(folder / "new.urdf")
    (folder / "my_code.py").write_text(CODE)
    (folder / "q.csv").write_text("0,0,0,0,0,0\n0.1,0,0,0,0,0\n")
    report = dp.validate("panda", samples=3)
    for name in ("baseline", "out"):
        report.write(folder / name)
    study = ("integrate", "ur5", "--frame", "tool0", "--dt", "1", "--turns", "1", "--out", "study")
    assert run(*study, cwd=folder).returncode == 0


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    folder = tmp_path_factory.mktemp("readme")
    write_files(folder)
    return folder


@pytest.mark.parametrize("arguments", [c for c in commands() if "view" not in c or "--record" in c], ids=" ".join)
def test_every_command_of_the_readme_runs(arguments, own):
    for package in {"convert": ("mujoco", "xacro"), "view": ("viser",)}.get(arguments[0], ()):
        pytest.importorskip(package)
    done = run(*arguments, cwd=own)
    assert done.returncode in EXITS.get(arguments[0], (0,)), done.stderr
    assert done.stdout or "wrote" in done.stderr


def test_its_links_lead_somewhere():
    for target in re.findall(r"\]\(([^)#]+)", README):
        assert (Path(__file__).parent.parent / target).exists(), target
