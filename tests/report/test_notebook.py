"""What a prompt and a notebook show: every result in a few lines, and with a drawing."""

import numpy as np
import pytest

import dualpin as dp
from dualpin.report import compare, study
from dualpin.tracking.study import run

Q0 = np.array([0.0, -1.2, 1.4, -0.4, -1.5, 0.0])
CIRCLE = dp.Circle(0.02, 1.0, start=Q0)
DRAWN = ("report", "comparison", "tracking", "simulation", "ik", "integrators", "workspace")


def results():
    pytest.importorskip("pinocchio")
    robot = dp.load("ur5")
    report = dp.validate(robot, samples=2, terms=["fk", "rnea"], engine="numpy")
    worse = dp.validate(robot, samples=2, terms=["fk", "rnea"], engine="numpy")
    worse.robots[0].terms["rnea"].max_scaled_error = 1e-9
    return {
        "robot": robot,
        "report": report,
        "robot result": report.robots[0],
        "term": report.terms["fk"],
        "comparison": compare(report, worse),
        "tracking": dp.track(robot, CIRCLE, frame="tool0", dt=0.1, t_end=1.0, engine="numpy"),
        "simulation": dp.simulate(robot, Q0, np.zeros(6), dt=0.01, t_end=0.1, engine="numpy"),
        "ik": dp.ik(robot, dp.fk(robot, Q0, "tool0"), "tool0", q0=Q0 + 0.1),
        "integrators": run(robot, frame="tool0", steps=[0.5], gains=[0.0], turns=1),
        "workspace": dp.reach_map(robot, "tool0", n=2000),
        "table": dp.to_dh(robot, tip="tool0"),
        "tree": dp.to_dh(robot, convention="khalil-kleinfinger"),
        "screws": dp.to_screws(robot, tip="tool0"),
        "study": study([{"robot": "a", "term": "b", "us_per_sample": 1.0}] * 500),
        "dual": dp.Dual(np.ones((60, 60)), np.zeros((60, 60))),
        "trajectory": CIRCLE,
    }


@pytest.fixture(scope="module")
def found():
    return results()


def test_every_result_is_under_ten_lines(found):
    for name, value in found.items():
        assert repr(value).count("\n") < 9 and len(repr(value)) < 1000, name


def test_results_are_drawn_in_notebooks(found):
    pytest.importorskip("matplotlib")
    for name in DRAWN:
        html = found[name]._repr_html_()
        assert "<svg" in html and "<table" in html, name
        assert len(html) < 400_000, name


def test_tables_in_notebooks_have_base_and_tool_and_the_residual():
    table = dp.to_dh(dp.load("panda"), tip="panda_hand")
    html = table._repr_html_()
    assert html.count("<td>base</td>") == 1 and html.count("<td>tool</td>") == 1
    assert "residual" in html and "from panda_link0 to panda_hand" in html
    assert "0.3839999" not in html  # rounded off below the residual


def test_plots_return_their_axes(found):
    mpl = pytest.importorskip("matplotlib")
    mpl.use("Agg")
    import matplotlib.pyplot as plt

    try:
        for name in ("report", "comparison", "tracking", "ik", "table", "screws", "trajectory"):
            axes = found[name].plot()
            assert hasattr(axes, "get_title"), name
        for name in ("simulation", "integrators"):
            left, right = found[name].plot()
            assert left.lines and right.lines
        _, given = plt.subplots()
        assert found["tracking"].plot(axes=given) is given
        with pytest.raises(dp.ArgumentError, match="axes in space expected"):
            found["table"].plot(axes=given)
    finally:
        plt.close("all")


def test_the_frames_of_a_plot_are_those_of_the_table(found):
    pytest.importorskip("matplotlib").use("Agg")
    import matplotlib.pyplot as plt

    table = found["table"]
    axes = table.plot(Q0)
    x, y, z = axes.lines[0].get_data_3d()
    assert np.allclose(np.transpose([x, y, z])[1:-1], table.frames(Q0)[:, :3, 3])
    assert np.allclose([x[-1], y[-1], z[-1]], table.fk(Q0)[:3, 3])
    plt.close("all")
