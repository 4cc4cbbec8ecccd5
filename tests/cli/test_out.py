"""`--out`, `--plot`, `--degrees`, and tables that are whole: what commands leave behind and print."""

import json

import numpy as np
import pytest

import dualpin as dp
from dualpin.cli.angles import remarks, typed
from dualpin.cli.listing import text_of
from dualpin.cli.main import program
from dualpin.report import compare, document, read, study

typer_testing = pytest.importorskip("typer.testing")
START = "0,-70,80,-20,-90,0"


def run(*arguments):
    return typer_testing.CliRunner().invoke(program(), [*map(str, arguments)])


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    pytest.importorskip("jinja2")
    folder = tmp_path_factory.mktemp("study")
    done = run("integrate", "ur5", "--frame", "tool0", "--start", START, "--degrees", "--turns", 1, "--gain", 0,
               "--dt", "0.1,0.2,0.5", "--out", folder)  # fmt: skip
    assert done.exit_code == 0, done.output
    return folder, done


def test_integrate_leaves_a_document_and_a_page(studied):
    folder, done = studied
    found = json.loads((folder / "integrate.json").read_text())
    assert {"processor", "date", "command", "dualpin", "numpy", "python"} <= found["header"].keys()
    assert found["settings"]["start"] == pytest.approx(np.radians([0, -70, 80, -20, -90, 0]))
    assert len(found["rows"]) == 12
    page = (folder / "report.html").read_text()
    for words in ("ur5: tool0 on a circle of radius 0.05 m", "start q = (0, -1.222", "dt = 0.1, 0.2, 0.5 s",
                  "evaluations of the right-hand side", "seconds", "Fitted orders"):  # fmt: skip
        assert words in page
    assert "orientation_peak [deg]" in done.stdout


def test_fitted_orders_are_those_of_the_methods(studied):
    from dualpin.report.methods import Methods

    found = {o.method: o.order for o in Methods(read(studied[0] / "integrate.json")).orders}
    for method, order in {"euler": 1, "trapezoidal": 2, "abm4": 3, "rk4": 4}.items():
        assert abs(found[method] - order) < 0.25, method  # abm4 starts with Heun's, of order 2: 3 in the large


def test_studies_are_compared(studied, tmp_path):
    data = json.loads((studied[0] / "integrate.json").read_text())
    assert compare(study(data), study(data)).passed
    worse = json.loads(json.dumps(data))
    worse["rows"][3]["position_peak"] *= 100
    worse["rows"][0]["warnings"] = ["unstable: K dt = 3"]
    worse["rows"].pop()
    found = compare(study(data), study(worse))
    assert {c.what for c in found.worse} == {"error", "remark", "missing"}
    assert compare(study(worse), study(data)).passed
    (tmp_path / "worse.json").write_text(json.dumps(worse))
    done = run("report", "--compare", studied[0] / "integrate.json", tmp_path / "worse.json")
    assert done.exit_code == 1
    assert "method rk4" in done.stdout


def test_a_plot_is_a_file_whose_ending_says_what(tmp_path):
    pytest.importorskip("matplotlib")
    words = ("integrate", "ur5", "--frame", "tool0", "--dt", "0.5", "--turns", 1, "--gain", 0)
    assert run(*words, "--plot", tmp_path / "p.svg").exit_code == 0
    assert "<svg" in (tmp_path / "p.svg").read_text()
    with pytest.raises(dp.DualpinError, match=r"\.png, \.svg, \.pdf expected"):
        dp.tracking.study.run(dp.load("ur5"), frame="tool0", steps=[0.5], gains=[0.0], turns=1).save(tmp_path / "p.gif")


def test_bench_has_means_and_spread(tmp_path):
    pytest.importorskip("pinocchio")
    done = run("bench", "ur5", "--terms", "rnea,crba", "--batch", "1,16", "--out", tmp_path)
    assert done.exit_code == 0, done.output
    found = json.loads((tmp_path / "bench.json").read_text())
    assert {"processor", "date", "command", "pin"} <= found["header"].keys()
    ratios = [r["ratio"] for r in found["rows"] if r["batch"] == 16]
    page = (tmp_path / "report.html").read_text()
    assert "Geometric means" in page and "geometric standard deviation" in page
    from dualpin.report.speed import Speed

    mean = next(m for m in Speed(read(tmp_path / "bench.json")).means if m.of == "all terms" and "16" in m.setting)
    assert mean.mean == pytest.approx(np.sqrt(np.prod(ratios)), rel=0.01)
    assert mean.least[0] <= mean.mean <= mean.most[0] and mean.spread >= 1


@pytest.mark.parametrize("words", [("dh", "ur5", "--tip", "tool0"), ("screws", "ur5", "--tip", "tool0")])
def test_forms_leave_a_document_and_a_page(words, tmp_path):
    done = run(*words, "--out", tmp_path)
    assert done.exit_code == 0, done.output
    found = json.loads((tmp_path / f"{words[0]}.json").read_text())
    assert {"processor", "date", "command"} <= found["header"].keys()
    assert (tmp_path / f"{words[0]}.csv").read_text().count("\n") >= 6
    assert "shoulder_pan_joint" in (tmp_path / "report.html").read_text()
    assert run("report", tmp_path / f"{words[0]}.json").exit_code == 0


def test_a_configuration_in_degrees_and_what_is_odd_about_one(capsys):
    robot = dp.load("ur5")
    given = np.array([0.0, -90.0, 90.0, 0.0, 0.0, 0.0])
    assert np.allclose(typed(robot, given, True, "--q"), np.radians(given))
    assert capsys.readouterr().err == ""
    assert np.array_equal(typed(robot, given, False, "--q"), given)
    said = capsys.readouterr().err
    assert "-90 of shoulder_lift_joint, 90 of elbow_joint are read as rad" in said and "--degrees" in said
    (outside,) = remarks(robot, np.array([6.9, 0, 0, 0, 0, 0.0]))[-1:]
    assert "6.9 of shoulder_pan_joint is read as rad" in outside
    (outside,) = remarks(dp.load("panda"), np.array([3.0, *dp.load("panda").neutral[1:]]))[:1]
    assert "3 rad of panda_joint1 is outside its limits, -2.8973 rad to 2.8973 rad" in outside
    assert remarks(robot, robot.neutral) == []


def test_angles_are_printed_in_degrees_everywhere():
    assert "-360 to 360 deg" in run("info", "ur5", "--degrees").stdout
    turned = run("fk", "ur5", "--q", "0,-90,0,0,0,0", "--degrees", "--json")
    assert json.loads(turned.stdout)["q"][1] == pytest.approx(-np.pi / 2)


def test_rows_are_shown_whole_within_the_width():
    rows = [{"robot": "ur5", "method": f"m{k}", **{f"figure_{i}": k + i / 7 for i in range(30)}} for k in range(70)]
    lines = text_of("many", rows, None, 80)
    assert max(map(len, lines)) <= 80
    assert "in all rows: robot ur5" in lines
    for i in range(30):
        assert sum(f"figure_{i}" in x.split() for x in lines) == 1
    assert sum(x.startswith("m69") for x in lines) > 1  # every part has the columns that name its rows
    assert text_of("none", [], None, 80) == ["none: no rows"]
    nested = text_of("", [{"a": 1, "list": [1]}], None, 80)
    assert nested[-1] == "not shown: list (--json has them)"


def test_a_document_says_with_what_it_was_made():
    found = study(document("title", [{"a": 1.0, "b": 2}], notes=["odd"], settings={"x": 1}, command="dualpin x"))
    assert (found.title, found.notes) == ("title", ["odd"])
    assert found.header["command"] == "dualpin x" and found.header["x"] == "1"
