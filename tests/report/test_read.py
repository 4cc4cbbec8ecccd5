"""Files are recognised by what is in them."""

import json

import pytest

from dualpin.errors import ArgumentError
from dualpin.report import read, study
from dualpin.report.chart import Chart, Series, Strips, decades, label, steps

from . import samples


@pytest.mark.parametrize(("data", "kind"), [
    (json.loads(samples.report().to_json()), "validation"),
    (samples.speed(), "speed"),
    (samples.integrators(), "integrators"),
    ({"rows": [{"x": 1}]}, "records"),
])  # fmt: skip
def test_kinds(tmp_path, data, kind):
    path = tmp_path / "x.json"
    path.write_text(json.dumps(data))
    assert read(path).subject == kind


@pytest.mark.parametrize(("text", "message"), [
    ("{", "is not JSON"), ("{}", "holds no result"), ("[]", "holds no result"), ("3", "holds no result"),
    ('{"robots": [{"terms": 3}], "refused": []}', "is not a report"),
])  # fmt: skip
def test_what_is_no_result_is_refused_in_words(tmp_path, text, message):
    path = tmp_path / "x.json"
    path.write_text(text)
    with pytest.raises(ArgumentError, match=message):
        read(path)


def test_a_missing_file_is_refused_in_words(tmp_path):
    with pytest.raises(ArgumentError, match="cannot read"):
        read(tmp_path / "none.json")


def test_headers_and_curves_are_found():
    found = study(samples.integrators(), "s")
    assert found.header == {"cpu": "a CPU"}
    (euler, rk4) = found.curves["drift"]
    assert euler.points == [(50.0, 1e-3), (100.0, 2e-3)]
    assert rk4.xlabel == "turns"


def test_axes_have_round_numbers():
    assert decades(1e-16, 1e-12) == pytest.approx([1e-16, 1e-15, 1e-14, 1e-13, 1e-12])
    assert len(decades(1e-30, 1.0)) <= 8
    assert decades(3, 8) == pytest.approx([5])
    assert steps(0, 44) == pytest.approx([0, 10, 20, 30, 40])
    assert [label(x) for x in (0, 0.01, 1e-5, 20.0, 1e6)] == ["0", "0.01", "1e-5", "20", "1e6"]


@pytest.mark.parametrize("points", [
    [], [(1.0, 1.0, "")], [(0.0, -1.0, "")], [(1.0, 2.0, ""), (1.0, 2.0, "")],
    [(1.0, float("nan"), ""), (2.0, 3.0, "")], [(1e-300, 1e300, ""), (1.0, 1.0, "")],
])  # fmt: skip
@pytest.mark.parametrize("log", [True, False])
def test_any_points_lie_inside_the_drawing(points, log):
    chart = Chart("t", "x", "y", [Series("s", points)], xlog=log, ylog=log)
    for _, placed in chart.drawn:
        for x, y, _ in placed:
            assert chart.left - 1 <= x <= chart.right + 1
            assert chart.top - 1 <= y <= chart.bottom + 1
    assert chart.x.ticks is not None


def test_strips_keep_what_is_off_the_axis_at_its_end():
    strips = Strips("t", "x", [("rnea", [(0.0, "", False), (1e9, "", True)])], 1e-5, 10.0)
    ((_, _, placed),) = strips.drawn
    assert [p[0] for p in placed] == [strips.left, strips.right]
