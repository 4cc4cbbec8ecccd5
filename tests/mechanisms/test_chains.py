"""Serial chains in dual matrices and the 2C arm: golden values, identities, and the same robot in Pinocchio."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from tests.golden import REFERENCE, array, close, dual

GOLD = REFERENCE["robot_2C"][0]
P = GOLD["parameters"]
BODIES = [
    dp.mechanisms.body(float(m), array(c), array(J))
    for m, c, J in zip(P["mass"], P["com_in_DH_frame"], P["inertia_about_com_in_DH_frame"], strict=True)
]
ARM = dp.mechanisms.TwoC(
    float(P["l1"]), float(P["l2"]), float(P["alpha1"]), float(P["alpha2"]), BODIES, array(P["gravity"])
)
CASES = pytest.mark.parametrize("case", GOLD["cases"], ids=lambda c: c["name"])


def state(case):
    return (array(case[k]) for k in "qva")


@CASES
def test_golden_kinematics(case):
    q, _, _ = state(case)
    T = dp.fk(ARM.robot, q, "tip")
    close(T, array(case["T02"]["T"]))
    want = case["T02"]["dual_quaternion"]
    close(dp.fk(ARM.robot, q, "tip", as_="dual_quaternion"), np.concatenate([array(want["real"]), array(want["dual"])]))
    close(ARM.inverse_kinematics(T), q)
    close(ARM.chain.pose(ARM.dual_coordinates(q)), dp.algebra.dual_matrix(T))


@CASES
def test_golden_dynamics(case):
    q, v, a = state(case)
    close(dp.crba(ARM.robot, q), array(case["M"]))
    close(dp.coriolis(ARM.robot, q, v), array(case["C_christoffel"]))
    close(dp.gravity(ARM.robot, q), array(case["g"]))
    close(dp.rnea(ARM.robot, q, v, a), array(case["tau"]))
    close(dp.kinetic_energy(ARM.robot, q, v), float(case["kinetic_energy"]))
    # the recursion of dual momenta: force + eps torque of each joint
    F = ARM.chain.forces(*map(ARM.dual_coordinates, (q, v, a)))
    close(np.stack([F.dual, F.real], axis=-1).ravel(), array(case["tau"]))


def test_joint_wrenches_of_the_chain_are_those_of_newton_and_euler():
    """By a second recursion in plain vectors: what is left of each link and all behind it, about the joint's frame."""
    rng = np.random.default_rng(7)
    q, v, a = (ARM.dual_coordinates(x) for x in rng.standard_normal((3, 40, 4)))
    F = ARM.chain.joint_wrenches(q, v, a)
    assert F.shape == (40, 2, 3)
    own = ARM.chain.forces(q, v, a)
    close(F[..., 2].real, own.real, 1e-13)
    close(F[..., 2].dual, own.dual, 1e-13)
    # all of the arm's rate of change of momentum, less its weight, is what the first joint transmits
    x, dx, ddx = (np.stack([z.real, z.dual], axis=-1).reshape(40, 4) for z in (q, v, a))
    robot, h = ARM.robot, 1e-5

    def momentum(t):
        y, dy = x + t * dx + t**2 / 2 * ddx, dx + t * ddx
        h_world = np.zeros((40, 6))
        for i, end in enumerate(("link1_end", "tip")):
            T, w = dp.fk(robot, y, end), dp.frame_velocity(robot, y, dy, end, reference="local")
            m, c, J = float(P["mass"][i]), array(P["com_in_DH_frame"][i]), array(P["inertia_about_com_in_DH_frame"][i])
            p = m * (w[:, 3:] + np.cross(w[:, :3], c))
            n = w[:, :3] @ J.T + np.cross(c, p)
            h_world += np.einsum("bij,bj->bi", dp.spatial.coadjoint(T), np.concatenate((n, p), axis=-1))
        return h_world

    rate = (momentum(h) - momentum(-h)) / (2 * h)
    weight = float(sum(map(float, P["mass"]))) * array(P["gravity"])
    close(F.real[:, 0], rate[:, 3:] - weight, 1e-8)
    close(F.dual[:, 0], rate[:, :3] - np.cross(dp.com(robot, x), weight), 1e-8)
    bare = dp.mechanisms.DualChain(ARM.alpha)
    with pytest.raises(dp.ArgumentError, match="joint_wrenches: the bodies"):
        bare.joint_wrenches(q, v, a)


def test_the_three_routes_to_a_links_jacobian_are_one_and_give_its_mass_matrix():
    for robot in (dp.load("panda"), dp.load("ur5", floating=True)):
        q, v, _ = robot.sample(5, seed=2)
        link = next(k for k in robot.links if k.joint is robot.joints[-1] and not k.inertia.massless)
        routes = [dp.mechanisms.link_jacobian(robot, q, link.name, r) for r in ("direct", "transformed", "rotated")]
        for J in routes[1:]:
            close(J, routes[0], 1e-13)
        _, central = link.inertia.central
        m, I = float(link.inertia.mass), central.array
        W = np.block([[I, np.zeros((3, 3))], [np.zeros((3, 3)), m * np.eye(3)]])
        M = np.swapaxes(routes[0], -1, -2) @ W @ routes[0]
        others = [float(k.inertia.mass) for k in robot.links if k.joint is robot.joints[-1]]
        if others.count(0.0) == len(others) - 1:  # the only body that the joint moves
            close(M, np.stack([dp.link_terms(robot, x, y)[len(robot) - 1].M for x, y in zip(q, v, strict=True)]), 1e-13)
    with pytest.raises(dp.ArgumentError, match="route"):
        dp.mechanisms.link_jacobian(robot, q, link.name, "quick")


@CASES
@pytest.mark.parametrize("name", dp.mechanisms.TOPOLOGIES)
def test_golden_topologies(case, name):
    q, v, _ = state(case)
    want = case["topologies"][name]
    arm = ARM.topology(name, q)
    assert arm.free == want["free_coordinates"]
    f = arm.free
    close(arm.crba(q[f]), array(want["M"]))
    close(arm.bias(q[f], v[f]), array(want["bias"]))
    tau = array(case["tau"])[f]
    acc = arm.aba(q[f], v[f], tau)
    close(acc, array(want["forward_qdd_with_tau_restricted"]))
    close(arm.rnea(q[f], v[f], acc), tau)
    held = arm.reactions(q[f], v[f], acc)
    assert held.shape == (4 - len(f),)
    close(arm.fk(q[f], "tip"), dp.fk(ARM.robot, q, "tip"))
    assert arm.jacobian(q[f], "tip").shape == (6, len(f))


def test_golden_dual_matrix_of_the_paper():
    for case in REFERENCE["robot_2C_dual_fk"]:
        arm = dp.mechanisms.TwoC(float(case["l1"]), float(case["l2"]))
        q = dp.Dual(array([case["theta1"], case["theta2"]]), array([case["d1"], case["d2"]]))
        close(arm.chain.pose(q), dual(case))
        close(arm.chain.position(q), array(case["p"]))


def test_jacobians_and_velocities_are_those_of_the_robot():
    rng = np.random.default_rng(0)
    q, v, _ = rng.standard_normal((3, 50, 4))
    Q, V = ARM.dual_coordinates(q), ARM.dual_coordinates(v)
    J = ARM.chain.jacobian(Q)
    order = [0, 2, 1, 3]  # rates, then slides
    close(J, dp.jacobian(ARM.robot, q, "tip", reference="local")[..., order], 1e-13)
    m = ARM.chain.velocity(Q, V)
    close(m.six, dp.frame_velocity(ARM.robot, q, v, "tip", reference="local_world_aligned"), 1e-13)
    # the generalised Jacobian takes the stacked joint motors z v_i
    z = np.zeros((50, 6))
    motors = dp.Dual(z.copy(), z.copy())
    motors.real[:, 2::3], motors.dual[:, 2::3] = V.real, V.dual
    local = (ARM.chain.generalized_jacobian(Q) @ motors[..., None])[..., 0]
    last = ARM.chain.velocities(Q, V)[-1]
    close(local, np.stack(list(last), axis=-1), 1e-13)


def test_dual_momenta_of_a_long_chain_equal_newton_euler():
    rng = np.random.default_rng(1)
    n = 6
    rows = np.column_stack([rng.uniform(-1, 1, (n, 3)), rng.uniform(-3, 3, n)])  # theta d a alpha
    inertias = []
    for _ in range(n):
        X = rng.standard_normal((3, 3))
        inertias.append({"mass": rng.uniform(0.5, 3), "com": rng.standard_normal(3), "inertia": X @ X.T + np.eye(3)})
    robot = dp.from_dh(rows, joints="RPCRPC", convention="standard", inertias=inertias)
    bodies = [dp.mechanisms.body(**i) for i in inertias]
    chain = dp.mechanisms.DualChain(dp.Dual(rows[:, 3], rows[:, 2]), bodies)
    q, v, a = robot.sample(20, seed=0)
    tau = dp.rnea(robot, q, v, a)

    def spread(x, offset=False):
        real, slide = np.zeros((20, n)), np.zeros((20, n))
        k = 0
        for i, kind in enumerate("RPCRPC"):
            for part in {"R": [real], "P": [slide], "C": [real, slide]}[kind]:
                part[:, i] = x[:, k]
                k += 1
        return dp.Dual(real + offset * rows[:, 0], slide + offset * rows[:, 1])

    F = chain.forces(spread(q, True), spread(v), spread(a))
    got, k = np.empty_like(tau), 0
    for i, kind in enumerate("RPCRPC"):
        for part in {"R": [F.dual], "P": [F.real], "C": [F.dual, F.real]}[kind]:
            got[:, k] = part[:, i]
            k += 1
    assert np.abs(got - tau).max() < 1e-12 * np.abs(tau).max()


def test_the_pinocchio_twin_of_revolute_and_prismatic_pairs_agrees():
    pin = pytest.importorskip("pinocchio")
    model = pin.Model()
    on, placement = 0, pin.SE3.Identity()
    alpha = ARM.alpha
    for i in range(2):
        turn = model.addJoint(on, pin.JointModelRZ(), placement, f"turn{i}")
        on = model.addJoint(turn, pin.JointModelPZ(), pin.SE3.Identity(), f"slide{i}")
        x = float(alpha.real[i])
        R = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
        placement = pin.SE3(R, np.array([float(alpha.dual[i]), 0, 0]))
        c, J = (array(P[k][i]) for k in ("com_in_DH_frame", "inertia_about_com_in_DH_frame"))
        model.appendBodyToJoint(on, pin.Inertia(float(P["mass"][i]), c, J), placement)
    data = model.createData()
    rng = np.random.default_rng(2)
    for _ in range(20):
        q, v, a = rng.standard_normal((3, 4))
        close(dp.rnea(ARM.robot, q, v, a), pin.rnea(model, data, q, v, a), 1e-13)
        close(dp.aba(ARM.robot, q, v, a), pin.aba(model, data, q, v, a), 1e-11)
        close(dp.coriolis(ARM.robot, q, v), pin.computeCoriolisMatrix(model, data, q, v), 1e-13)
        M = pin.crba(model, data, q)
        close(dp.crba(ARM.robot, q), np.triu(M) + np.triu(M, 1).T, 1e-13)


def test_inverse_kinematics_of_batches_and_poses_out_of_reach():
    rng = np.random.default_rng(3)
    q = rng.uniform(-3, 3, (200, 4))
    arm = dp.mechanisms.TwoC(0.3, -0.2, 1.1, -0.4)
    close(arm.inverse_kinematics(dp.fk(arm.robot, q, "tip")), q, 1e-12)
    with pytest.raises(dp.ArgumentError, match="out of reach"):
        arm.inverse_kinematics(np.eye(4))
    with pytest.raises(dp.DualDivisionError, match="parallel"):
        dp.mechanisms.TwoC(0.3, 0.2, 0.0).inverse_kinematics(np.eye(4))
    with pytest.raises(dp.ArgumentError, match="CC, CR"):
        arm.topology("RX")


def test_instantaneous_screw_axis_of_a_robot_is_that_of_its_poses():
    robot = dp.load("ur5")
    q, v, _ = robot.sample(seed=3)
    m = dp.mechanisms.instantaneous_screw(robot, q, v, "tool0")
    h = 1e-6
    T0, T1 = (dp.fk(robot, q + s * h * v, "tool0") for s in (-1, 1))
    close(m.six, dp.algebra.twist_between(T0, T1, 2 * h).six, 1e-8)  # h^2, and rounding / h
    p = m.point + 3.7 * m.axis.real
    # points of the axis move along it, with the pitch
    close(m.dual + np.cross(m.real, p), m.pitch * m.real, 1e-12)
    still = dp.mechanisms.instantaneous_screw(robot, q, 0 * v, "tool0")
    assert still.kind.item() == "zero"


def test_principal_screws_of_inertia():
    rng = np.random.default_rng(4)
    X = rng.standard_normal((3, 3))
    J, c, m = X @ X.T + 5 * np.eye(3), rng.standard_normal(3), 2.5
    s = dp.mechanisms.principal_screws(dp.mechanisms.body(m, c, J))
    close(s.center, c)
    close(s.matrix, np.block([[J, np.zeros((3, 3))], [np.zeros((3, 3)), m * np.eye(3)]]))
    S = s.principal
    close(S.T @ S, 2 * np.diag([*(s.radii**2), 1, 1, 1]))
    assert np.linalg.det(s.axes) == pytest.approx(1)
    # conjugate: the momentum of one does no work on another
    body = dp.mechanisms.body(m, c, J)
    from dualpin.spatial import Vector3, motor, power

    V = [motor(Vector3(*x.real), Vector3(*x.dual)) for x in s.screws]
    work = np.array([[float(power(a, body(b))) for b in V] for a in V])
    close(work, np.diag(np.diag(work)), 1e-11)
    close([float(x.pitch) for x in s.screws], s.pitches)
    robot = dp.load("ur5")
    assert dp.mechanisms.principal_screws(robot, "forearm_link").mass > 0
    with pytest.raises(dp.ArgumentError, match="mass"):
        dp.mechanisms.principal_screws(robot, "tool0")
    with pytest.raises(dp.FrameNotFoundError, match="forearm_link"):
        dp.mechanisms.principal_screws(robot, "forearm_lnk")


def test_what_is_held_is_a_robot_of_its_own():
    """Against the whole robot with the other accelerations zero: the rows and columns of the free coordinates."""
    robot, rng = dp.load("panda"), np.random.default_rng(5)
    free = [0, 2, 3, 5, 7]
    at = robot.sample(seed=1)[0]
    some = dp.mechanisms.Locked(robot, free, at)
    x, v, a = at[free] + 0.1, rng.standard_normal(5), rng.standard_normal(5)
    q, dq, ddq = some.q(x), some.spread(v), some.spread(a)
    close(some.fk(x, "panda_hand"), dp.fk(robot, q, "panda_hand"), 1e-14)
    close(some.jacobian(x, robot.frame("panda_hand")), dp.jacobian(robot, q, "panda_hand")[:, free], 1e-14)
    close(some.crba(x), dp.crba(robot, q)[np.ix_(free, free)], 1e-14)
    tau = dp.rnea(robot, q, dq, ddq)
    close(some.rnea(x, v, a), tau[free], 1e-12)
    close(some.reactions(x, v, a), np.delete(tau, free), 1e-12)
    close(some.aba(x, v, tau[free]), a, 1e-9)
    assert some.rest.nv == 5 and len(some.rest) == len(robot)


def test_locked_refuses_what_it_cannot_hold():
    with pytest.raises(dp.ArgumentError, match="each once"):
        dp.mechanisms.Locked(ARM.robot, [0, 0], np.zeros(4))
    with pytest.raises(dp.ArgumentError, match="nq = 13"):
        dp.mechanisms.Locked(dp.load("ur5", floating=True), [0], np.zeros(13))
    with pytest.raises(dp.ArgumentError, match="ascending"):
        dp.mechanisms.Locked(ARM.robot, [2, 0], np.zeros(4))
    with pytest.raises(dp.ShapeError):
        dp.mechanisms.Locked(ARM.robot, [0], np.zeros(4)).crba([1.0, 2.0])
