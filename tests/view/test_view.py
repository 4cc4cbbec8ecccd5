"""What is drawn of a robot, and the page in a headless browser."""

import math
import shutil
import time

import numpy as np
import pytest

import dualpin as dp
from dualpin.io.meshes import find, shapes
from dualpin.view import axes, bones, helix
from dualpin.view.scene import size


def arm(joints, rows=None):
    return dp.from_dh(rows or [(0, 0.3, 0.2, 0.4)] * len(joints), joints=joints, convention="standard")


def test_axes_have_the_pitch_of_their_joint():
    pitches = [a.pitch for a in axes(arm(["R", "P", ("H", 0.05)]))]
    assert pitches == [0.0, math.inf, pytest.approx(0.05)]


def test_a_cylindrical_joint_has_two_axes_on_one_line():
    turn, slide = axes(arm("C"))
    assert (turn.pitch, slide.pitch) == (0.0, math.inf)
    assert np.allclose(turn.direction, slide.direction)


def test_a_helix_advances_by_its_pitch():
    (a,) = axes(arm([("H", 0.05)]))
    line = helix(a, length=10.0, radius=0.1, turns=2)
    along = (line - a.point) @ a.direction
    assert np.ptp(along) == pytest.approx(2 * 2 * math.pi * 0.05)
    off = line - a.point - np.outer(along, a.direction)
    assert np.allclose(np.linalg.norm(off, axis=1), 0.1)


def test_a_long_helix_is_cut():
    (a,) = axes(arm([("H", 5.0)]))
    along = helix(a, length=1.0, radius=0.1) @ a.direction
    assert np.ptp(along) == pytest.approx(1.0)


def test_bones_end_where_the_next_frame_begins():
    robot = arm("RRR")
    T = dp.fk(robot, np.zeros(3))
    ends = [(T[0] @ [*line[1], 1.0])[:3] for joint, line in bones(robot) if joint is robot.joints[0]]
    assert any(np.allclose(end, T[1, :3, 3]) for end in ends)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_dh_frames_end_at_the_last_row(convention):
    robot = arm("RPRC")
    table = dp.to_dh(robot, convention=convention)
    q = robot.sample(3, seed=0)[0]
    frames = table.frames(q)
    assert frames.shape == (3, len(table.rows), 4, 4)
    tool = np.linalg.solve(frames[:, -1], table.fk(q))  # the tool is fixed to the last frame
    assert np.allclose(tool, tool[0])


def test_meshes_are_found_beside_and_above_the_file(tmp_path):
    (tmp_path / "pack" / "meshes").mkdir(parents=True)
    (tmp_path / "pack" / "urdf").mkdir()
    file = tmp_path / "pack" / "meshes" / "a.stl"
    file.touch()
    urdf = tmp_path / "pack" / "urdf" / "r.urdf"
    assert find(urdf, "package://pack/meshes/a.stl") == file
    assert find(urdf, "../meshes/a.stl").resolve() == file
    assert find(urdf, "package://other/a.stl") is None


def test_primitive_shapes_are_read_and_broken_ones_left_out(tmp_path):
    pytest.importorskip("trimesh")
    urdf = tmp_path / "r.urdf"
    urdf.write_text(
        '<robot name="r"><link name="a"><visual><origin xyz="1 2 3"/><geometry><box size="1 1 2"/></geometry></visual>'
        '<visual><geometry><mesh filename="none.stl"/></geometry></visual>'
        '<visual><geometry><cylinder radius="x"/></geometry></visual></link></robot>'
    )
    found = shapes(urdf)
    (box,) = found.found
    assert box.link == "a"
    assert len(found.missing) == 2
    assert "'none.stl' is not found" in found.missing[1] and "cylinder radius" in found.missing[0]
    assert box.placement[:3, 3].tolist() == [1, 2, 3]
    assert box.mesh.extents.tolist() == [1, 1, 2]


def test_size_is_never_zero():
    assert size(arm("R", [(0, 0, 0, 0)])) > 0


@pytest.fixture
def viewer():
    pytest.importorskip("viser")
    if not 0 < port_free() < 65536:
        pytest.skip("no free port")
    from dualpin.view import view

    robot = arm("RPRR", [(0, 0.3, 0.2, 1.5), (0, 0.2, 0, -1.5), (0, 0.1, 0.3, 0.5), (0, 0.2, 0.1, 0)])
    shown = view(robot, np.linspace(0.0, 0.4, 12).reshape(3, 4), dt=0.1, dh="standard", port=port_free())
    yield shown
    shown.stop()


def port_free():
    import socket

    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


@pytest.mark.filterwarnings("ignore")
def test_a_viewer_follows_q_and_hides_parts(viewer):
    q = np.array([0.3, 0.1, -0.2, 0.5])
    viewer.update(q)
    T = dp.fk(viewer.robot, q)
    assert np.allclose([h.position for h in viewer.moving], T[:, :3, 3], atol=1e-6)
    start = time.monotonic()
    viewer.play()
    assert time.monotonic() - start >= 0.2  # three configurations, 0.1 s apart
    assert np.allclose(viewer.q, viewer.sequence[-1])
    viewer.show("screws", False)
    assert not any(h.visible for h in viewer.parts["screws"])
    with pytest.raises(dp.ArgumentError, match="did you mean 'screws'"):
        viewer.show("screw", True)


@pytest.mark.filterwarnings("ignore")
def test_the_page_opens_in_a_browser(viewer, tmp_path):
    webdriver = pytest.importorskip("selenium.webdriver")
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not chromium or not driver:
        pytest.skip("no Chromium with its driver here (Debian: chromium chromium-driver)")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for flag in ("headless=new", "no-sandbox", "no-first-run", "disable-background-networking", "disable-sync",
                 "enable-unsafe-swiftshader", f"user-data-dir={tmp_path}", "window-size=1280,900"):  # fmt: skip
        options.add_argument(f"--{flag}")
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    try:
        browser.get(viewer.url)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and "joint_4" not in browser.find_element("tag name", "body").text:
            time.sleep(0.2)
        text = browser.find_element("tag name", "body").text
        assert all(word in text for word in ("joint_1", "joint_4", "screws", "dh", "play")), text
        assert browser.find_elements("tag name", "canvas")
    finally:
        browser.quit()


@pytest.mark.filterwarnings("ignore")
def test_the_panel_follows_and_leads(viewer):
    panel, robot = viewer.controls, viewer.robot
    viewer.update([0.3, 0.1, -0.2, 0.5])
    assert panel.sliders[0][0].value == pytest.approx(np.degrees(0.3), abs=1e-6)
    assert panel.sliders[1][0].value == pytest.approx(0.1)  # a slide, in m
    assert panel.typed.value == "0.3, 0.1, -0.2, 0.5"
    panel.sliders[0][0].value = 90.0
    panel.slide(0)
    assert viewer.q[0] == pytest.approx(np.pi / 2)
    panel.zero()
    assert np.array_equal(viewer.q, robot.neutral)
    panel.random()
    assert (robot.lower <= viewer.q).all() and (viewer.q <= robot.upper).all() and viewer.q.any()
    panel.take("[0.1, 0.2, 0.3, 0.4]")
    assert viewer.q.tolist() == [0.1, 0.2, 0.3, 0.4]
    panel.take("1, 2")
    assert "shape" in panel.said.content and viewer.q[0] == 0.1
    pose = dp.fk(robot, viewer.q, panel.frame.value)
    assert f"{pose[0, 3]:.4f}" in panel.readout.content


@pytest.mark.filterwarnings("ignore")
def test_the_tool_is_dragged_by_inverse_kinematics(viewer):
    panel, robot = viewer.controls, viewer.robot
    goal = np.array([0.4, 0.15, 0.3, -0.2])
    viewer.update(goal + 0.02)
    T = dp.fk(robot, goal, panel.frame.value)
    panel.handle.position, panel.handle.wxyz = T[:3, 3], dp.spatial.from_matrix(T)[:4]
    panel.reach()
    assert np.allclose(dp.fk(robot, viewer.q, panel.frame.value), T, atol=1e-4)
    panel.handle.position = (90.0, 0.0, 0.0)
    panel.reach()
    assert "out of reach" in panel.said.content


@pytest.mark.filterwarnings("ignore")
def test_a_floating_base_has_a_handle_and_masses_are_drawn():
    pytest.importorskip("viser")
    from dualpin.view import view

    robot = dp.load("double_pendulum", floating=True)
    shown = view(robot, port=port_free())
    try:
        shown.controls.base.position = (1.0, 2.0, 3.0)
        shown.controls.float()
        assert shown.q[:3].tolist() == [1.0, 2.0, 3.0]
        assert len(shown.parts["com"]) == sum(float(x.inertia.mass) > 0 for x in robot.links)
        assert not any(h.visible for h in shown.parts["inertia"])
    finally:
        shown.stop()


def test_ellipsoids_have_the_inertia_of_their_bodies():
    from dualpin.view.scene import bodies

    for body in bodies(dp.load("ur5")):
        m, (a, b, c) = float(body.link.inertia.mass), body.radii**2
        J = body.turn @ np.diag([b + c, c + a, a + b]) @ body.turn.T * m / 5
        com, expected = body.link.inertia.central
        rows = [[float(x) for x in (r.x, r.y, r.z)] for r in expected.rows]
        assert np.allclose(J, rows, atol=1e-9)
        assert np.allclose(body.com, [float(x) for x in (com.x, com.y, com.z)])


@pytest.mark.filterwarnings("ignore")
def test_a_recording_is_one_page_that_loads_nothing(viewer, tmp_path):
    path = tmp_path / "motion.html"
    viewer.record(path, fps=10)
    text = path.read_text(encoding="utf-8")
    assert text.lstrip().lower().startswith("<!doctype html>")
    assert len(text) > 100_000
    with pytest.raises(dp.ArgumentError, match=r"\.html expected"):
        viewer.record(tmp_path / "motion.mp4")


def test_what_cannot_be_drawn_is_said(tmp_path):
    pytest.importorskip("viser")
    from dualpin.view import view

    path = tmp_path / "r.urdf"
    mesh = '<visual><geometry><mesh filename="none.stl"/></geometry></visual>'
    path.write_text(f'<robot name="r"><link name="a">{mesh}</link></robot>')
    shown = view(dp.load(str(path)), port=port_free())
    try:
        assert any("none.stl" in text for text in shown.warnings)
    finally:
        shown.stop()


def test_rows_to_play_have_times(tmp_path, capsys):
    from dualpin.cli.view import motion

    robot, path = arm("RR"), tmp_path / "q.csv"
    path.write_text("0,90\n0,45\n")
    run = motion(robot, path, 0.5, True)
    assert run.t.tolist() == [0.0, 0.5] and run.q[0, 1] == pytest.approx(np.pi / 2)
    path.write_text("time,a,b\n0,0,1\n2,0,2\n")
    assert motion(robot, path, 0.5, False).t.tolist() == [0.0, 2.0]
    wrong = {"0,1,2\n": "rows of 3 numbers", "t,a,b\n1,0,0\n0,0,0\n": "do not increase", "x\ny": "cannot read"}
    for text, why in wrong.items():
        path.write_text(text)
        with pytest.raises(dp.ArgumentError, match=why):
            motion(robot, path, 0.5, False)
