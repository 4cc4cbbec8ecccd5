"""The paper: its figures are of committed results, its references are cited and known, and it becomes a PDF."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAPER = Path(__file__).parent.parent / "paper"
TEXT = (PAPER / "paper.md").read_text(encoding="utf-8")


def test_every_citation_is_known_and_every_entry_is_cited():
    cited = set(re.findall(r"@(\w+)", TEXT.split("---", 2)[2]))
    known = set(re.findall(r"@\w+\{(\w+),", (PAPER / "paper.bib").read_text(encoding="utf-8")))
    assert cited == known, cited ^ known


def test_its_figures_stand_beside_it():
    for name in re.findall(r"\]\((\w+\.png)\)", TEXT):
        assert (PAPER / name).stat().st_size > 10_000, name


@pytest.mark.campaign
def test_it_becomes_a_pdf():
    specification = importlib.util.spec_from_file_location("build_paper", PAPER / "build.py")
    build = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(build)
    if build.pandoc() is None:
        pytest.skip("pandoc is not installed")
    done = subprocess.run([sys.executable, PAPER / "build.py"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    if "no PDF" not in done.stderr:
        assert (PAPER / "paper.pdf").read_bytes().startswith(b"%PDF")
