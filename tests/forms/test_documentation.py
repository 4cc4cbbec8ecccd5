"""The page on DH tables shows what the code gives today."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


def test_every_table_of_the_page_is_what_its_script_prints() -> None:
    pytest.importorskip("matplotlib")
    spec = importlib.util.spec_from_file_location("dh_figures", DOCS / "figures" / "dh.py")
    assert spec is not None and spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    page = (DOCS / "dh.md").read_text(encoding="utf-8")
    for name, table in script.tables().items():
        # six digits; residues of rounding, below 1e-11, depend on the platform
        for line in table.splitlines():
            assert line in page or "e-1" in line, (name, line)


def test_the_figures_of_the_page_exist() -> None:
    for name in ("dh-frames.svg", "dh-near-parallel.svg"):
        assert (DOCS / "figures" / name).stat().st_size > 1000
