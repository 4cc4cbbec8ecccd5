"""The models that ship with dualpin are robots by name, wherever the current folder is."""

from __future__ import annotations

from pathlib import Path

import pytest

import dualpin as dp
from dualpin.io import catalogue

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", ["pa10", "puma560", "planar_2r", "two_cylindrical"])
def test_shipped_models_are_found_by_name_in_an_empty_folder(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert dp.load(name).name
    assert name not in catalogue()  # which stays what example-robot-data offers


def test_a_name_nearly_right_leads_to_a_shipped_model():
    with pytest.raises(dp.UrdfError, match="did you mean 'puma560'"):
        dp.load("puma56")


def test_the_wheel_takes_the_models_along_where_they_are_looked_for():
    tomllib = pytest.importorskip("tomllib")  # Python 3.11
    wheel = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert wheel["force-include"]["urdf"] == "dualpin/urdf"
    assert "urdf/pa10/pa10.urdf" in {p.relative_to(ROOT).as_posix() for p in (ROOT / "urdf").glob("*/*.urdf")}
