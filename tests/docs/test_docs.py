"""What the documentation shows is what happens, and its names and links lead somewhere."""

import re
from pathlib import Path

import pytest

import dualpin as dp
from tests.program import run

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.rglob("*.md"), *(ROOT / "validation").rglob("*.md"), ROOT / "CONTRIBUTING.md"])
FENCE = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```", re.M | re.S)


def named(path):
    return path.relative_to(ROOT).as_posix()


def blocks(path, language):
    return [code for kind, code in FENCE.findall(path.read_text(encoding="utf-8")) if kind == language]


@pytest.mark.parametrize("path", [p for p in PAGES if blocks(p, "python")], ids=named)
def test_the_python_of_a_page_runs_from_top_to_bottom(path, tmp_path, monkeypatch):
    if "pinocchio" in path.read_text(encoding="utf-8").lower() or "validate" in path.read_text(encoding="utf-8"):
        pytest.importorskip("pinocchio")
    monkeypatch.chdir(tmp_path)
    space = {"__name__": "page"}
    for code in blocks(path, "python"):
        exec(compile(code, named(path), "exec"), space)


def commands():
    """`dualpin ...` lines of each block, but for campaigns, servers, and files that only their reader has.

    Lines that stood in an earlier block are left out, unless a later line of theirs needs what they write.
    """
    found, seen = [], set()
    for path in sorted(DOCS.rglob("*.md")):
        for code in blocks(path, "sh"):
            lines = []
            for line in code.splitlines():
                words = line.split("#")[0].split()
                if words[:1] == ["dualpin"] and not {"--all", "view"} & {*words} and not any("old" in w for w in words):
                    lines.append(words[1:])
            writes = any("--out" in words for words in lines)
            lines = [words for words in lines if writes or " ".join(words) not in seen]
            seen |= {" ".join(words) for words in lines}
            found += [lines] * bool(lines)
    return found


@pytest.mark.parametrize("lines", commands(), ids=lambda lines: " ".join(lines[0]))
def test_every_command_of_a_block_runs(lines, tmp_path):
    pytest.importorskip("pinocchio")
    for words in lines:
        done = run(*words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("path", PAGES, ids=named)
def test_names_of_the_package_exist(path):
    """Every `dp.name.name` of a page."""
    for name in set(re.findall(r"\bdp\.([A-Za-z_][\w.]*\w)", path.read_text(encoding="utf-8"))):
        value = dp
        for part in name.split("."):
            assert hasattr(value, part), f"dp.{name}"
            value = getattr(value, part)


@pytest.mark.parametrize("path", PAGES, ids=named)
def test_links_lead_to_files(path):
    text = FENCE.sub("", path.read_text(encoding="utf-8"))
    for target in re.findall(r"\]\(([^)#\s]+)", text):
        if not re.match(r"[a-z]+:", target):
            assert (path.parent / target).exists(), target
