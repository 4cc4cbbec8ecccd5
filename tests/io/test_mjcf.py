"""MJCF: what MuJoCo compiles is the same robot here, and what is written is the same robot there."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.model import Builder, cylindrical, helical, prismatic, revolute, spherical
from dualpin.spatial import Pose, Vector3
from dualpin.spatial.inertia import Inertia

mujoco = pytest.importorskip("mujoco")
pytest.importorskip("gymnasium")
ASSETS = Path(str(resources.files("gymnasium"))) / "envs" / "mujoco" / "assets"
SHIPPED = (
    "ant", "half_cheetah", "hopper", "inverted_double_pendulum", "inverted_pendulum", "point", "pusher", "pusher_v5",
    "reacher", "swimmer", "walker2d", "walker2d_v5",
)  # fmt: skip
BOUND = 1e-12  # the ceiling of terms without a linear solve, see crosscheck/tolerance.py
WORLD = '<mujoco model="m"><compiler angle="radian"/><worldbody>{}</worldbody>{}</mujoco>'
BALL = '<geom type="capsule" size=".1 .3" pos=".1 .2 .3" euler=".3 .5 .1"/>'
ODD = WORLD.format(
    f"""<body name="a" pos=".1 .2 .3" euler=".5 .3 .1"><joint name="slide" type="slide" axis="1 2 3" ref=".4"/>
    <joint name="hinge" axis="3 1 2" pos=".2 -.1 .3" ref=".7" armature=".3"/>{BALL}
    <body name="b" pos="0 .4 0"><joint name="ball" type="ball" pos=".3 .1 -.2" armature=".05"/>{BALL}
      <body name="c" pos=".1 0 .2" euler="1 2 3">{BALL}<site name="eye" pos=".1 .1 .1" euler=".1 .2 .3"/></body></body>
    <body pos="0 0 1"><joint axis="0 1 0"/><joint axis="1 0 0" pos=".1 .2 .3"/>{BALL}</body></body>
    <body name="cup" pos="3 2 1"><freejoint/>{BALL}</body>
    <body name="saucer"><joint name="loose" type="free"/>{BALL}</body>""",
    "",
)


def compiled(file: Path | str) -> tuple:
    """MuJoCo's model, without what no term of ours contains, and its data."""
    m = mujoco.MjModel.from_xml_path(str(file)) if isinstance(file, Path) else mujoco.MjModel.from_xml_string(file)
    for bit in ("CONTACT", "LIMIT", "FRICTIONLOSS", "EQUALITY", "DAMPER", "SPRING", "ACTUATION"):
        m.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{bit}"))
    m.opt.density = m.opt.viscosity = 0
    return m, mujoco.MjData(m)


def turned(m, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """G with v_mujoco = G v: linear first, in the axes of the world; and R of each free body."""
    G = np.eye(m.nv)
    for k in range(m.njnt):
        if m.jnt_type[k] == 0:
            a, b = int(m.jnt_dofadr[k]), int(m.jnt_qposadr[k])
            R = np.zeros(9)
            mujoco.mju_quat2Mat(R, q[b + 3 : b + 7])
            G[a : a + 6, a : a + 6] = 0
            G[a : a + 3, a + 3 : a + 6], G[a + 3 : a + 6, a : a + 3] = R.reshape(3, 3), np.eye(3)
    return G


def scaled(x: np.ndarray, reference: np.ndarray) -> float:
    return float(np.abs(x - reference).max() / max(1.0, np.abs(reference).max()))


def agreement(robot: dp.Robot, m, d, seed: int = 0) -> dict[str, float]:
    """The largest scaled error of every term that both have, over five states."""
    q, v, a = robot.sample(5, seed)
    worst: dict[str, float] = {}
    bodies = {m.body(i).name or f"body{i}": i for i in range(1, m.nbody)}
    for k in range(5):
        G = turned(m, q[k])
        d.qpos[:], d.qvel[:] = q[k], G @ v[k]
        mujoco.mj_forward(m, d)
        M = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, d, M)
        for name, i in bodies.items():
            X = dp.fk(robot, q[k], frame=name, engine="numpy")
            J, Jm = (
                dp.jacobian(robot, q[k], frame=name, reference="local_world_aligned", engine="numpy"),
                np.zeros((6, m.nv)),
            )
            mujoco.mj_jacBody(m, d, Jm[3:], Jm[:3], i)
            for term, x, y in (
                ("fk", X[:3, :3], d.xmat[i].reshape(3, 3)),
                ("fk", X[:3, 3], d.xpos[i]),
                ("jacobian", J, Jm @ G),
            ):
                worst[term] = max(worst.get(term, 0.0), scaled(x, y))
        pairs = {"crba": (dp.crba(robot, q[k], engine="numpy"), G.T @ M @ G)}
        mujoco.mj_energyVel(m, d)
        pairs["kinetic_energy"] = dp.kinetic_energy(robot, q[k], v[k], engine="numpy"), d.energy[1]
        # with v_mujoco = G v:  a_mujoco = G a + G' v, where G' v turns the linear velocity of free bodies
        rate = np.zeros(m.nv)
        for j in robot:
            if j.model.nv == 6:
                w, l = v[k][j.v][:3], v[k][j.v][3:]
                rate[j.v][:3] = G[j.v, j.v][:3, 3:] @ np.cross(w, l)
        d.qacc[:] = G @ a[k] + rate
        mujoco.mj_inverse(m, d)
        pairs["rnea"] = dp.rnea(robot, q[k], v[k], a[k], engine="numpy"), G.T @ d.qfrc_inverse
        d.qvel[:] = 0
        mujoco.mj_forward(m, d)
        pairs["gravity"] = dp.gravity(robot, q[k], engine="numpy"), G.T @ d.qfrc_bias
        for term, (x, y) in pairs.items():
            worst[term] = max(worst.get(term, 0.0), scaled(np.asarray(x), np.asarray(y)))
    return worst


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_models_agree_with_mujoco_to_1e12(name):
    file = ASSETS / f"{name}.xml"
    robot = dp.load(file)
    found = agreement(robot, *compiled(file))
    assert set(found) == {"fk", "jacobian", "crba", "kinetic_energy", "rnea", "gravity"}
    assert max(found.values()) < BOUND, found


def test_every_kind_of_joint_shifted_turned_and_with_references_agrees():
    robot = dp.loads(ODD)
    assert [j.kind for j in robot] == [
        "prismatic",
        "revolute",
        "spherical",
        "revolute",
        "revolute",
        "floating",
        "floating",
    ]
    found = agreement(robot, *compiled(ODD))
    assert max(found.values()) < BOUND, found
    m, d = compiled(ODD)
    d.qpos[:] = q = robot.sample(seed=3)[0]
    mujoco.mj_kinematics(m, d)
    np.testing.assert_allclose(dp.fk(robot, q, frame="eye", engine="numpy")[:3, 3], d.site("eye").xpos, atol=1e-14)
    assert robot.joint("hinge").armature == (0.3,)


def test_the_referee_asks_mujoco_about_its_own_file(tmp_path):
    """All columns by name; free bodies turned; scenes with several of them too."""
    file = tmp_path / "odd.xml"
    file.write_text(ODD)
    report = dp.judge(str(file), "mujoco:clean", samples=3, diagnose=False)
    terms = report.robots[0].terms
    assert report.robots[0].reason == ""
    assert {t for t, x in terms.items() if x.status == "agrees"} >= {
        "fk",
        "jacobian",
        "crba",
        "rnea",
        "gravity",
        "aba",
        "com",
    }
    assert not [t for t, x in terms.items() if x.status == "differs"]


def test_it_is_validated_against_pinocchio_joint_by_joint(tmp_path):
    file = tmp_path / "arm.xml"
    file.write_text(
        WORLD.format(f'<body><joint axis="0 1 0"/>{BALL}<body pos="0 0 1"><joint type="ball"/>{BALL}</body></body>', "")
    )
    assert dp.validate(str(file), samples=3, engine="numpy").passed


@pytest.mark.parametrize(
    ("rest", "says"),
    [
        ('<tendon><fixed name="rope"><joint joint="h" coef="1"/></fixed></tendon>', "tendon 'rope' (over h)"),
        (
            '<equality><joint name="gear" joint1="h" joint2="k" polycoef="0 1 2 0 0"/></equality>',
            "equality 'gear' (joint of h and k)",
        ),
        ('<equality><connect name="pin" body1="a" anchor="0 0 0"/></equality>', "equality 'pin' (connect)"),
        ('<equality><weld body1="a" body2="b"/></equality>', "equality 'equality0' (weld)"),
    ],
)  # fmt: skip
def test_tendons_and_equalities_are_refused_by_name(rest, says):
    bodies = f'<body name="a"><joint name="h"/>{BALL}</body><body name="b"><joint name="k"/>{BALL}</body>'
    with pytest.raises(dp.UrdfError) as e:
        dp.loads(WORLD.format(bodies, rest))
    assert says in str(e.value) and "without=" in str(e.value)


def test_they_can_be_left_out_by_name_and_linear_ones_followed(tmp_path):
    bodies = (
        f'<body name="a"><joint name="h" ref=".2"/>{BALL}</body><body name="b"><joint name="k" ref=".5"/>{BALL}</body>'
    )
    file = tmp_path / "geared.xml"
    file.write_text(
        WORLD.format(bodies, '<equality><joint name="gear" joint1="h" joint2="k" polycoef=".1 2 0 0 0"/></equality>')
    )
    assert dp.load(file, without=["gear"]).nv == 2
    with pytest.raises(dp.DualpinError, match="did you mean 'gear'"):
        dp.load(file, without=["gaer"])
    geared = dp.load(file, mimic=True)
    assert geared.nv == 1
    # q_h - 0.2 = 0.1 + 2 (q_k - 0.5), by MuJoCo's documentation
    m, d = compiled(file)
    d.qpos[:] = 0.3 + 2 * (0.9 - 0.5), 0.9
    mujoco.mj_kinematics(m, d)
    for body in ("a", "b"):
        X = dp.fk(geared, np.array([0.9]), frame=body, engine="numpy")
        np.testing.assert_allclose(X[:3, :3], d.body(body).xmat.reshape(3, 3), atol=1e-14)


@pytest.mark.parametrize(
    "text", ["<mujoco><worldbody><body><joint/></body></worldbody></mujoco>", "<mujoco>", "<mujoco><nothing/></mujoco>"]
)
def test_what_mujoco_refuses_is_refused_with_its_words(text):
    with pytest.raises(dp.UrdfError, match="MuJoCo refuses it"):
        dp.loads(text)


def test_what_mujoco_warns_of_is_a_note_and_leaves_no_file(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    robot = dp.load(ASSETS / "half_cheetah.xml")
    assert any(n.startswith("MuJoCo: ") and "settotalmass" in n for n in robot.notes)
    assert not list(tmp_path.iterdir()) and capfd.readouterr() == ("", "")


def test_sdf_is_left_out_and_says_so():
    with pytest.raises(dp.UrdfError, match="SDF is not URDF and is not read"):
        dp.loads("<sdf version='1.9'/>")


# --- writing ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "floating"), [("panda", False), ("solo12", True), ("kinova", False)])
def test_what_is_written_is_the_same_robot_in_mujoco(name, floating):
    robot = dp.load(name, floating)
    text = robot.to_mjcf()
    found = agreement(robot, *compiled(text)) if not floating else agreement(dp.loads(text), *compiled(text))
    assert max(found.values()) < BOUND, found
    again = dp.loads(text)
    assert again.joint_names == robot.joint_names and set(robot.link_names) <= {*again.link_names}
    q, v, a = robot.sample(3, seed=1)
    assert scaled(dp.rnea(again, q, v, a, engine="numpy"), dp.rnea(robot, q, v, a, engine="numpy")) < BOUND
    for link in robot.link_names:
        assert scaled(dp.fk(again, q, frame=link, engine="numpy"), dp.fk(robot, q, frame=link, engine="numpy")) < BOUND
    np.testing.assert_allclose(again.lower, robot.lower, atol=1e-15)


def test_joints_that_urdf_does_not_have_are_written():
    body = Inertia.of(2.0, (0.1, 0.2, 0.3), np.diag([0.3, 0.4, 0.5]))
    b = Builder("odd", gravity=(0, 1, -9))
    b.joint("both", cylindrical(), placement=Pose(position=Vector3(0.1, 0.0, 0.0)), inertia=body)
    b.joint("ball", spherical(), on="both", inertia=body, armature=(0.1, 0.1, 0.1))
    b.joint("back", prismatic(Vector3(0.0, -0.6, 0.8)), on="ball", inertia=body)
    b.frame("tip", on="back", placement=Pose(position=Vector3(0.0, 0.0, 1.0)))
    robot = b.robot()
    again = dp.loads(robot.to_mjcf())
    assert again.joint_names == ["both", "both_slide", "ball", "back"]
    q, v, a = robot.sample(3, seed=1)
    assert scaled(dp.rnea(again, q, v, a, engine="numpy"), dp.rnea(robot, q, v, a, engine="numpy")) < BOUND
    assert scaled(dp.fk(again, q, frame="tip", engine="numpy"), dp.fk(robot, q, frame="tip", engine="numpy")) < BOUND


def test_what_mujoco_does_not_take_is_an_error_that_names_it():
    heavy = Inertia.of(1.0, (0, 0, 0), np.diag([1.0, 1.0, 1.0]))
    for what, says in (
        ((helical(pitch=0.1), heavy), "'j' is helical"),
        ((revolute(), None), "no mass and inertia"),
        ((revolute(), Inertia.of(1.0, (0, 0, 0), np.diag([1.0, 1.0, 3.0]))), "principal moments 1, 1, 3"),
    ):
        b = Builder("r")
        b.joint("j", what[0], inertia=what[1])
        with pytest.raises(dp.ArgumentError, match=says):
            b.robot().to_mjcf()


def test_a_follower_becomes_an_equality_and_is_read_as_one():
    robot = dp.load("panda", mimic=True)
    with pytest.warns(dp.DualpinWarning, match="which MuJoCo holds softly"):
        text = robot.to_mjcf()
    again = dp.loads(text, mimic=True)
    q, v, a = robot.sample(3, seed=1)
    assert again.nv == robot.nv == 8
    assert scaled(dp.rnea(again, q, v, a, engine="numpy"), dp.rnea(robot, q, v, a, engine="numpy")) < BOUND
