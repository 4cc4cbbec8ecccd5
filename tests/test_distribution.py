"""What is released: built twice, it is the same bytes; installed in an empty environment, everything shown works."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from tests.test_readme import EXITS, README, blocks, commands, write_files

ROOT = Path(__file__).parent.parent
EXTRAS = re.search(r"pip install 'dualpin\[(.*?)\]'", README)[1]
pytestmark = pytest.mark.campaign


def run(*command, cwd, **options):
    done = subprocess.run([str(c) for c in command], cwd=cwd, capture_output=True, text=True, timeout=900, **options)
    assert done.returncode == 0, f"{command}: {done.stdout[-2000:]} {done.stderr[-2000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Two builds of what git tracks, from two folders and at two times."""
    found = []
    for name in ("first", "second"):
        place = tmp_path_factory.mktemp(name)
        files = run("git", "ls-files", cwd=ROOT).splitlines()
        with tarfile.open(place / "tree.tar", "w") as tar:
            for file in files:
                tar.add(ROOT / file, file)
        with tarfile.open(place / "tree.tar") as tar:
            tar.extractall(place / "tree", filter="data")
        epoch = {**os.environ, "SOURCE_DATE_EPOCH": "1790000000"}
        run(sys.executable, "-m", "build", "--outdir", place / "dist", cwd=place / "tree", env=epoch)
        found.append(place / "dist")
    return found


def test_two_builds_are_the_same_bytes(built):
    first, second = ({f.name: f.read_bytes() for f in place.iterdir()} for place in built)
    assert len(first) == 2 and first == second


def test_they_hold_what_they_should(built):
    (wheel,), (source,) = built[0].glob("*.whl"), built[0].glob("*.tar.gz")
    names = zipfile.ZipFile(wheel).namelist()
    assert "dualpin/py.typed" in names and any(n.endswith("licenses/LICENSE") for n in names)
    assert any(n.endswith("puma560.urdf") for n in names), "the models of urdf/ are not in the wheel"
    assert not [n for n in names if n.startswith(("tests/", "validation/", "docs/"))]
    with tarfile.open(source) as tar:
        inside = {n.split("/", 1)[1] for n in tar.getnames() if "/" in n}
    wanted = {"LICENSE", "README.md", "CHANGELOG.md", "pyproject.toml", "dualpin/py.typed", "tests/conftest.py",
              "urdf/puma560/puma560.urdf", "examples/payload.py", "CITATION.cff"}  # fmt: skip
    assert wanted <= inside, wanted - inside


@pytest.mark.timeout(3600)
def test_the_wheel_works_in_an_empty_environment_and_folder(built, tmp_path):
    (wheel,) = built[0].glob("*.whl")
    run(sys.executable, "-m", "venv", tmp_path / "venv", cwd=tmp_path)
    folder = tmp_path / "venv" / ("Scripts" if os.name == "nt" else "bin")
    run(folder / "python", "-m", "pip", "install", "--quiet", wheel, cwd=tmp_path)
    here = tmp_path / "empty"
    here.mkdir()
    plain = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    found = json.loads(run(folder / "dualpin", "selftest", "--json", cwd=here, env=plain))
    assert {one["outcome"] for one in found["outcomes"]} <= {"passed", "skipped"}
    skipped = {one["command"].split()[0] for one in found["outcomes"] if one["outcome"] == "skipped"}
    assert skipped <= {"view", "convert"}, found  # viser and MuJoCo are extras
    (code,), shown = blocks("python"), blocks("text")[0]
    assert run(folder / "python", "-c", code, cwd=here, env=plain) == shown
    write_files(here)

    def wants_more(words):
        """Whether the command needs an extra, and says which."""
        done = subprocess.run([folder / "dualpin", *words], cwd=here, env=plain, capture_output=True, text=True)
        if done.returncode == 2 and "pip install 'dualpin[" in done.stderr:
            return True
        assert done.returncode in EXITS.get(words[0], (0,)), done
        assert done.stdout or "wrote" in done.stderr, done
        return False

    pages = [words for words in commands() if "view" not in words or "--record" in words]  # others serve a browser
    more = list(filter(wants_more, pages))
    assert {words[0] for words in more} == {"view", "convert", "report"}
    run(folder / "python", "-m", "pip", "install", "--quiet", f"{wheel}[{EXTRAS}]", cwd=tmp_path)
    assert not any(map(wants_more, more))
    types = "import dualpin\nreveal_type(dualpin.rnea)\n"
    (here / "typed.py").write_text(types)
    said = run(sys.executable, "-m", "mypy", "--python-executable", folder / "python", "typed.py", cwd=here, env=plain)
    assert "Any" in said or "ndarray" in said
