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
    (box,) = shapes(urdf)
    assert box.link == "a"
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
    shown = view(robot, np.zeros((3, 4)), dh="standard", port=port_free())
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
    viewer.play()
    assert np.allclose(viewer.q, 0)
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
