"""Written files: UTF-8 in every locale, whole or not at all."""

from __future__ import annotations

import ast
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

import dualpin as dp
from dualpin.files import replacing, write_text

PACKAGE = Path(dp.__file__).parent


def names(folder: Path) -> list[str]:
    return [p.name for p in folder.iterdir()]


def test_a_text_is_written_as_utf8_with_its_line_ends(tmp_path):
    path = tmp_path / "m\u00e3o"
    write_text(path, "q\u0307 \u624b\r\n\n")
    assert path.read_bytes() == "q\u0307 \u624b\r\n\n".encode()
    assert names(tmp_path) == [path.name]


def test_what_is_no_text_is_written_as_an_escape(tmp_path):
    write_text(tmp_path / "x", "a\udcffb")
    assert (tmp_path / "x").read_bytes() == b"a\\udcffb"


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError("x")])
def test_an_error_leaves_what_was_there_and_nothing_else(error, tmp_path):
    path = tmp_path / "report.json"
    path.write_text("old")

    def interrupted() -> None:
        with replacing(path) as beside:
            beside.write_text("half of the n")
            raise error

    with pytest.raises(type(error)):
        interrupted()
    assert (path.read_text(), names(tmp_path)) == ("old", ["report.json"])


def test_a_full_disk_is_said_and_leaves_no_file(tmp_path, monkeypatch):
    def full(self, data):
        with self.open("wb") as f:
            f.write(data[: len(data) // 2])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    robot = dp.from_dh([(0, 0, 0.5, 0)], name="arm")
    table = dp.to_dh(robot)
    for write in (
        lambda: robot.to_urdf(tmp_path / "arm.urdf"),
        lambda: table.to_csv(tmp_path / "arm.csv"),
        lambda: dp.export_c(robot, "fk", tmp_path),
    ):
        with pytest.raises(dp.DualpinError, match="No space left on device"):
            write()
        assert names(tmp_path) == []


def test_permissions_links_and_devices_stay_what_they_are(tmp_path):
    path, link = tmp_path / "file", tmp_path / "link"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    write_text(link, "new")
    assert link.is_symlink() and path.read_text() == "new" and stat.S_IMODE(path.stat().st_mode) == 0o640
    write_text("/dev/null", "gone")
    assert stat.S_ISCHR(Path("/dev/null").stat().st_mode)
    fresh, mask = tmp_path / "fresh", os.umask(0)
    os.umask(mask)
    write_text(fresh, "x")
    assert stat.S_IMODE(fresh.stat().st_mode) == 0o666 & ~mask


def test_a_folder_is_not_replaced(tmp_path):
    with pytest.raises(OSError):
        write_text(tmp_path, "x")
    with pytest.raises(OSError):
        write_text(tmp_path / "no" / "such", "x")


SCRIPT = """
import sys, warnings, dualpin as dp
warnings.simplefilter("ignore")
out = sys.argv[1]
arm = dp.from_dh([(0, 0, 0.5, 0)], name="m\\u00e3o \\u624b")
arm.to_urdf(out + "/a.urdf")
table = dp.to_dh(arm)
for kind in ("csv", "json", "yaml", "markdown", "latex", "python", "matlab"):
    getattr(table, "to_" + kind)(out + "/a." + kind)
dp.export_c(arm, "fk", out, name="arm")
print(arm.summary(), dp.load(out + "/a.urdf").name)
"""


def test_no_locale_changes_what_is_written(tmp_path):
    """The C locale without Python's UTF-8 mode writes ASCII by default."""
    written = []
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii:backslashreplace"}
    for name, more in (("c", plain), ("utf8", {"PYTHONUTF8": "1"})):
        folder = tmp_path / name
        folder.mkdir()
        environment = {k: v for k, v in os.environ.items() if not k.startswith("LC_")}
        subprocess.run([sys.executable, "-c", SCRIPT, folder], check=True, capture_output=True, timeout=120,
                       env=environment | more)  # fmt: skip
        written.append({p.name: p.read_bytes() for p in folder.iterdir()})
    assert written[0] == written[1] and len(written[0]) == 12
    named = ("a.urdf", "a.json", "a.yaml", "a.python", "a.matlab", "arm.c", "arm.h")
    assert all("m\u00e3o \u624b".encode() in written[0][name] for name in named)


def test_the_program_prints_in_every_locale(tmp_path):
    path = tmp_path / "arm.urdf"
    dp.from_dh([(0, 0, 0.5, 0)], name="m\u00e3o \u624b").to_urdf(path)
    environment = os.environ | {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = [sys.executable, "-m", "dualpin", "info", path]
    shown = subprocess.run(command, capture_output=True, env=environment, timeout=120)
    assert shown.returncode == 0 and shown.stdout.startswith(b"m\\xe3o \\u624b: 1 joints"), shown


def test_nobody_writes_files_in_another_way():
    """Every file leaves through `dualpin.files`, but for the cache of kernels, logs that grow, and passing files."""
    allowed = {
        "files.py", "cli/stdin.py", "crosscheck/adjudicate.py", "crosscheck/ledger.py", "io/expand.py",
    }  # fmt: skip
    for path in PACKAGE.rglob("*.py"):
        where = path.relative_to(PACKAGE).as_posix()
        if where in allowed or where.startswith(("engine/", "crosscheck/subjects/", "peers/")):
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                assert not (node.func.attr in ("write_text", "write_bytes") and not _of_files(node)), path
                modes = [a.value for a in node.args if isinstance(a, ast.Constant) and isinstance(a.value, str)]
                if ast.unparse(node.func.value) == "beside":  # of `replacing`
                    continue
                assert not (node.func.attr == "open" and any(set(m) & set("wax") and len(m) < 4 for m in modes)), path


def _of_files(call: ast.Call) -> bool:
    return isinstance(call.func.value, ast.Name) and call.func.value.id == "files"
