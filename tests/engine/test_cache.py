"""Kernels on disk: used when every bit is in place, made again when not, and never trusted to others."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys

import numpy as np
import pytest

import dualpin as dp
from dualpin.call import find
from dualpin.engine.jit import cache
from dualpin.engine.jit import kernel as kernels
from dualpin.terms import TERMS


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setenv("DUALPIN_CACHE_DIR", str(tmp_path / "mine"))
    cache._announce.cache_clear()
    return tmp_path / "mine" / "kernels"


@pytest.fixture
def compilations(monkeypatch):
    made = []
    original = kernels.compiled
    monkeypatch.setattr(kernels, "compiled", lambda *args: made.append(1) or original(*args))
    return made


def gravity():
    robot = dp.load("ur5")  # a new robot each time: kernels stay with robots
    return find(robot, TERMS["gravity"], {}).rows([np.ones((1, 6))])


def stored(place):
    (file,) = place.iterdir()
    return file


def test_the_second_time_nothing_is_compiled(place, compilations):
    first = gravity()
    assert np.array_equal(gravity(), first)
    assert len(compilations) == 1
    assert cache.info()["kernels"] == 1
    assert cache.info()["usable"]


@pytest.mark.skipif(os.name == "nt", reason="POSIX permissions")
def test_folder_and_files_are_the_users_own(place):
    gravity()
    assert place.stat().st_mode & 0o777 == 0o700
    assert stored(place).stat().st_mode & 0o777 == 0o600


def damaged(content, how):
    at = len(content) // 2
    return {
        "flipped bit": content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :],
        "truncated": content[:at],
        "empty": b"",
        "foreign": b"\x7fELF" + content,
        "flipped checksum": content[:20] + bytes([content[20] ^ 1]) + content[21:],
        "longer": content + b"\0",
    }[how]


@pytest.mark.parametrize("how", ["flipped bit", "truncated", "empty", "foreign", "flipped checksum", "longer"])
def test_a_damaged_file_is_compiled_again_with_a_warning(place, compilations, how):
    first = gravity()
    file = stored(place)
    sound = file.read_bytes()
    file.write_bytes(damaged(sound, how))
    with pytest.warns(dp.DualpinWarning, match="damaged"):
        assert np.array_equal(gravity(), first)
    assert len(compilations) == 2
    assert file.read_bytes() == sound  # and stored anew


def test_a_sound_file_made_for_something_else_is_not_used(place, compilations):
    first = gravity()
    file = stored(place)
    file.write_bytes(cache.packed("another key", {"sizes": [6]}, b"code"))
    with pytest.warns(dp.DualpinWarning, match="something else"):
        assert np.array_equal(gravity(), first)
    assert len(compilations) == 2


@pytest.mark.parametrize("head", ["[]", "{}", '{"about": {}}', '{"key": %s}', '{"key": %s, "about": 1}'])
def test_a_head_of_another_form_is_not_believed_whatever_its_checksum(place, compilations, head):
    first = gravity()
    file = stored(place)
    magic, _, old, code = file.read_bytes().split(b"\n", 3)
    rest = (head.replace("%s", json.dumps(json.loads(old)["key"]))).encode() + b"\n" + code
    file.write_bytes(b"\n".join([magic, hashlib.sha256(rest).hexdigest().encode(), rest]))
    with pytest.warns(dp.DualpinWarning, match="something else"):
        assert np.array_equal(gravity(), first)
    assert len(compilations) == 2


@pytest.mark.skipif(os.name == "nt", reason="POSIX permissions")
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o1777])
def test_a_folder_that_others_may_write_is_refused(place, compilations, mode):
    first = gravity()
    place.chmod(mode)
    with pytest.warns(dp.DualpinWarning, match="may be written by others"):
        assert np.array_equal(gravity(), first)
    assert len(compilations) == 2
    assert not cache.info()["usable"]
    assert "others" in cache.info()["reason"]


@pytest.mark.skipif(os.name == "nt", reason="POSIX permissions")
def test_a_file_that_others_may_write_is_refused(place, compilations):
    gravity()
    stored(place).chmod(0o666)
    with pytest.warns(dp.DualpinWarning, match="not this user's alone"):
        gravity()
    assert len(compilations) == 2


@pytest.mark.skipif(os.name == "nt", reason="POSIX files")
@pytest.mark.parametrize("what", ["pipe", "link", "endless link", "folder", "nothing"])
def test_what_is_no_file_is_neither_waited_for_nor_read(place, compilations, tmp_path, what):
    first = gravity()
    file = stored(place)
    file.rename(tmp_path / "moved")
    if what == "pipe":
        os.mkfifo(file, 0o600)
    elif what == "folder":
        file.mkdir()
    elif what == "nothing":
        file.touch(0o600)
    else:
        file.symlink_to(tmp_path / "moved" if what == "link" else "/dev/zero")
    with pytest.warns(dp.errors.DualpinWarning, match="kernel cache"):
        assert np.array_equal(gravity(), first)
    assert len(compilations) == 2


def test_a_link_is_no_folder_of_its_own(place, compilations, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    place.symlink_to(tmp_path / "elsewhere")
    with pytest.warns(dp.DualpinWarning, match="not a folder of its own"):
        gravity()
    assert list((tmp_path / "elsewhere").iterdir()) == []


def test_where_nothing_can_be_written_it_still_computes(monkeypatch, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    monkeypatch.setenv("DUALPIN_CACHE_DIR", str(blocked))
    cache._announce.cache_clear()
    with pytest.warns(dp.DualpinWarning, match="cache"):
        gravity()
    assert cache.info()["kernels"] == 0


def test_clear_removes_kernels_and_nothing_else(place):
    gravity()
    other = place / "notes.txt"
    other.write_text("mine")
    result = cache.clear()
    assert result["removed"] == 1 and result["bytes"] > 0
    assert other.exists()
    assert cache.info()["kernels"] == 0


def test_robots_that_differ_have_kernels_that_differ(place):
    robot = dp.load("ur5")
    gravity()
    moon = robot.with_gravity((0, 0, -1.62))
    on_moon = find(moon, TERMS["gravity"], {}).rows([np.ones((1, 6))])
    assert cache.info()["kernels"] == 2
    assert np.abs(on_moon * (9.81 / 1.62) - gravity()).max() < 1e-12


def test_code_from_outside_the_package_is_not_kept(place):
    from dualpin.dual import Dual
    from dualpin.model import Builder
    from dualpin.model.joints import Axial
    from dualpin.scalars import ONE, ZERO
    from dualpin.spatial import UZ, Inertia, Matrix3, Vector3

    class Mine(Axial):
        pass

    model = Mine(UZ, Dual(ONE, ZERO), kind="revolute", coordinates=("angle",))
    b = Builder("mine")
    eye = Matrix3(Vector3(1.0, 0.0, 0.0), Vector3(0.0, 1.0, 0.0), Vector3(0.0, 0.0, 1.0))
    b.joint("hinge", model, inertia=Inertia(1.0, Vector3(0.5, 0.0, 0.0), eye))
    assert dp.crba(b.robot(), np.zeros((3, 1))).shape == (3, 1, 1)
    assert cache.info()["kernels"] == 0


def test_processes_at_the_same_time(place):
    code = (
        "import dualpin as dp, numpy as np; r = dp.load('ur5'); q, v, a = r.sample(4, seed=0); "
        "print(repr(dp.rnea(r, q, v, a).sum()), repr(dp.crba(r, q).sum()))"
    )
    running = [subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) for _ in range(4)]
    answers = {p.communicate(timeout=120)[0] for p in running}
    assert len(answers) == 1 and all(p.returncode == 0 for p in running)
    assert all(f.suffix == cache.SUFFIX for f in place.iterdir())
