"""What the documentation shows is what happens, and its names and links lead somewhere."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import dualpin as dp

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
    """`dualpin ...` lines of the pages, but for campaigns, servers, and files that only their reader has."""
    found = {}
    for path in DOCS.glob("*.md"):
        for code in blocks(path, "sh"):
            for line in code.splitlines():
                words = line.split("#")[0].split()
                if words[:1] == ["dualpin"] and not {"--all", "view"} & {*words} and not any("old" in w for w in words):
                    found[" ".join(words)] = words[1:]
    return list(found.values())


@pytest.mark.parametrize("words", commands(), ids=" ".join)
def test_every_command_runs(words, tmp_path):
    pytest.importorskip("pinocchio")
    command = [sys.executable, "-m", "dualpin", *words]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=300, check=False)
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


@pytest.mark.parametrize("path", sorted((DOCS / "api").glob("*.md")), ids=named)
def test_the_reference_names_what_exists(path):
    for name in re.findall(r"^::: ([\w.]+)", path.read_text(encoding="utf-8"), re.M):
        module, _, last = name.rpartition(".")
        assert (
            importlib.util.find_spec(name)
            if last.islower() and _is_module(name)
            else hasattr(importlib.import_module(module), last)
        ), name


def _is_module(name):
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def test_the_reference_has_every_public_name():
    """Functions and classes reachable as dualpin.NAME have their module, or themselves, in docs/api."""
    listed = " ".join(p.read_text(encoding="utf-8") for p in (DOCS / "api").glob("*.md"))
    missing = []
    for name in dp.__all__:
        value = getattr(dp, name)
        module = getattr(value, "__module__", None)
        homes = [module, f"{module}.{name}", ".".join(str(module).split(".")[:2])]
        if module and not any(re.search(rf"^::: {re.escape(h)}$", listed, re.M) for h in homes):
            missing.append(name)
    assert missing == []


def test_the_site_builds_without_a_warning(tmp_path):
    pytest.importorskip("mkdocs")
    pytest.importorskip("material")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path / "site")]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=environment, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    pages = list((tmp_path / "site").rglob("*.html"))
    broken = []
    for page in pages:
        for target in re.findall(r'(?:href|src)="([^"#?]+)', page.read_text(encoding="utf-8")):
            if not re.match(r"[a-z]+:|/", target) and not (page.parent / target).exists():
                broken.append((page.name, target))
    assert broken == []
