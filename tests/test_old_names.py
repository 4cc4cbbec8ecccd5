"""Names that became others work for one version, and say so."""

from __future__ import annotations

import pytest

import dualpin as dp


@pytest.mark.parametrize(("module", "old", "new"), [
    (dp.algebra, "Line", "LineVector"), (dp.tracking, "Solved", "IKResult"),
    (dp.tracking, "Tracking", "TrackingResult"), (dp.tracking, "Motion", "SimulationResult"),
])  # fmt: skip
def test_an_old_name_is_the_new_one_with_a_warning(module, old, new):
    with pytest.warns(DeprecationWarning, match=f"{old} is now .*{new}"):
        assert getattr(module, old) is getattr(module, new)


def test_other_names_are_missing_as_ever():
    with pytest.raises(AttributeError, match=r"dualpin\.algebra.*'Lines'"):
        dp.algebra.Lines
    assert dp.Line is dp.tracking.Line  # a trajectory, then and now
