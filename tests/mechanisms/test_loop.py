"""Closed loops: known linkages over full turns, their textbook equations, velocities by differences, refusals."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from tests.golden import REFERENCE, close, dual

RIGHT = np.pi / 2
TURN = np.linspace(0.1, 0.1 + 2 * np.pi, 25)
# a ball is three revolute joints, a universal joint two: R S U R
RSSR = dp.mechanisms.Loop(
    "R" * 7,
    [(0.0, 0.3), (RIGHT, 0.0), (RIGHT, 0.0), (0.0, 1.3), (RIGHT, 0.0), (0.0, 0.7), (0.9, 1.1)],
    [(0.0, 0.2), *[(0.0, 0.0)] * 5, (0.0, -0.3)],
)
LOOPS = {
    "Bennett": dp.mechanisms.Loop("RRRR", [(0.6, np.sin(0.6)), (1.1, np.sin(1.1))] * 2),
    "spherical 4R": dp.mechanisms.Loop("RRRR", [(0.5, 0.0), (1.3, 0.0), (1.1, 0.0), (1.2, 0.0)]),
    "planar 4R": dp.mechanisms.Loop("RRRR", [(0.0, 1.0), (0.0, 3.0), (0.0, 2.5), (0.0, 3.2)]),
    "slider-crank": dp.mechanisms.Loop("RRRP", [(0.0, 0.3), (0.0, 1.0), (RIGHT, 0.0), (-RIGHT, 0.0)]),
    "RCCC": dp.mechanisms.RCCC(dual(REFERENCE["rccc"]["cases"][0]["alpha_a"])).loop,
    "RSSR": RSSR,
    "RHCCR": dp.mechanisms.Loop(
        ["R", ("H", 0.3), "C", "C", "R"], [(0.5, 0.4), (0.9, 1.0), (1.0, 0.8), (1.1, 0.9), (0.3, 0.2)]
    ),
}
EVERY = pytest.mark.parametrize("name", LOOPS)
RANGES = dict.fromkeys(LOOPS, TURN) | {"RHCCR": np.linspace(0.1, 0.7, 25)}  # its links allow no full turn


@pytest.fixture(scope="module")
def motions():
    return {name: loop.follow(RANGES[name]) for name, loop in LOOPS.items()}


@EVERY
def test_closed_to_rounding_over_a_full_turn_and_moving_in_one_way(name, motions):
    loop, run = LOOPS[name], motions[name]
    assert run.q.shape == (25, loop.nq)
    assert run.closure.max() < 1e-12
    assert np.abs(run.q[:, loop.driven] - RANGES[name]).max() == 0
    again = loop.closure(loop.theta(run.q))
    assert max(np.abs(again.real).max(), np.abs(again.dual).max()) < 1e-12
    assert loop.mobility(run.q[7]) == 1
    assert loop.mobility(run.q[0]) == 1


@EVERY
def test_velocity_and_acceleration_are_the_differences_of_positions(name, motions):
    loop, start = LOOPS[name], motions[name].q[9]
    h, rate, push = 1e-4, 1.7, -0.4
    t = np.array([-h, 0.0, h])
    near = loop.follow(start[loop.driven] + rate * t + push * t**2 / 2, loop.follow(
        [start[loop.driven], start[loop.driven] - rate * h + push * h**2 / 2], start).q[1]).q  # fmt: skip
    v, a = loop.velocity(start, rate), loop.acceleration(start, rate, push)
    size = max(1.0, np.abs(a).max())
    assert np.abs((near[2] - near[0]) / (2 * h) - v).max() < 1e-6 * size  # h^2 times third derivatives
    assert np.abs((near[2] - 2 * near[1] + near[0]) / h**2 - a).max() < 2e-6 * size  # and rounding / h^2
    assert np.abs(loop.screws(start) @ v).max() < 1e-12 * size


def test_the_rccc_linkage_has_its_positions_in_closed_form():
    linkage = dp.mechanisms.RCCC(dual(REFERENCE["rccc"]["cases"][0]["alpha_a"]))
    found = linkage.loop.solve(np.radians(40))
    for mine, theirs in zip(found, sorted(linkage.solve(np.radians(40)), key=lambda p: p.theta2.real), strict=True):
        for x, y in zip(mine.theta, (theirs.theta1, theirs.theta2, theirs.theta3, theirs.theta4), strict=True):
            close(x, y, 1e-12)
    degrees = np.radians(np.arange(40.0, 401.0, 15))
    for start in found:
        run = linkage.loop.follow(degrees, start)
        both = linkage.sweep(degrees)
        branch = both[:, int(np.argmin(np.abs(both.real[0, :, 2] - float(start.theta[3].real))))]
        assert np.abs(np.angle(np.exp(1j * (run.theta.real[:, 1:] - branch.real)))).max() < 1e-11
        assert np.abs(run.theta.dual[:, 1:] - branch.dual).max() < 1e-11


def test_bennetts_linkage_keeps_the_product_of_half_tangents(motions):
    q = motions["Bennett"].q
    product = np.tan(q[:, 0] / 2) * np.tan(q[:, 1] / 2)
    away = np.abs(np.cos(q[:, 0] / 2)) > 0.1  # where both tangents are finite
    known = np.sin((0.6 + 1.1) / 2) / np.sin((0.6 - 1.1) / 2)
    assert np.abs(np.abs(product[away]) - abs(known)).max() < 1e-11
    assert np.abs(np.sin((q[:, 0] + q[:, 2]) / 2)).max() < 1e-12  # opposite hinges turn alike


def test_the_spherical_linkage_satisfies_the_real_part_of_the_rccc_equation(motions):
    loop, q = LOOPS["spherical 4R"], motions["spherical 4R"].q
    A, B, C = dp.mechanisms.RCCC(loop.alpha).coefficients(q[:, 0])
    assert np.abs(A.real * np.sin(q[:, 3]) + B.real * np.cos(q[:, 3]) + C.real).max() < 1e-13


def test_the_planar_linkage_satisfies_freudensteins_equation(motions):
    """The coupler's length 3 from the crank's angle and the rocker's alone."""
    q = motions["planar 4R"].q
    assert np.abs(np.abs(np.exp(1j * q[:, 0]) + 3.2 + 2.5 * np.exp(-1j * q[:, 3])) - 3.0).max() < 1e-12


def test_the_coupler_between_two_balls_keeps_its_length(motions):
    """From the crank's and the rocker's angle alone, without the joints between them."""
    q = motions["RSSR"].q
    crank, rocker = q[:, 0], q[:, 6]
    A = np.stack([0.3 * np.cos(crank), 0.3 * np.sin(crank), np.full_like(crank, 0.2)], axis=-1)
    c, s = np.cos(0.9), np.sin(0.9)
    # A7 = Z(rocker - 0.3 eps) X(0.9 + 1.1 eps) takes the first frame to the rocker's; its inverse is wanted
    x = np.stack([np.cos(rocker), -c * np.sin(rocker), s * np.sin(rocker)], axis=-1)
    z = np.array([0.0, s, c])
    B = -np.array([1.1, 0.0, 0.0]) + 0.3 * z - 0.7 * x
    assert np.abs(np.linalg.norm(A - B, axis=-1) - 1.3).max() < 1e-12


def test_with_two_real_balls_the_coupler_is_free_to_turn_and_is_not_taken_for_a_motion():
    loop = dp.mechanisms.Loop(
        "R" * 8,
        [(0.0, 0.3), (RIGHT, 0), (RIGHT, 0), (0.0, 1.3), (RIGHT, 0), (RIGHT, 0), (0.0, 0.7), (0.9, 1.1)],
    )
    p = loop.solve(0.4, starts=32)[0]
    q = loop.coordinates(p.theta)
    assert loop.mobility(q) == 2
    with pytest.raises(dp.DualDivisionError, match="freedoms of the loop beside the input"):
        loop.velocity(q)


def test_loops_that_cannot_close_or_move_say_so():
    short = dp.mechanisms.Loop("RRRR", [(0.0, 1.0), (0.0, 0.2), (0.0, 0.2), (0.0, 3.0)])
    assert short.solve(1.0) == []
    with pytest.raises(dp.algebra.AssumptionError, match="cannot be closed at theta1 = 1"):
        short.follow([1.0, 1.1])
    # Bennett's links, but for the ratio sin(alpha) / a
    stiff = dp.mechanisms.Loop("RRRR", [(0.6, np.sin(0.6)), (1.1, 1.2 * np.sin(1.1))] * 2)
    assert all(p.closure < 1e-9 for p in stiff.solve(0.7))
    triangle = dp.mechanisms.Loop("RRR", [(0.0, 3.0), (0.0, 4.0), (0.0, 5.0)])
    q = triangle.coordinates(triangle.solve(np.pi - np.arccos(3 / 5))[0].theta)
    assert triangle.mobility(q) == 0
    with pytest.raises(dp.algebra.AssumptionError, match="do not let it move"):
        triangle.velocity(q)


def test_a_motion_ends_in_a_dead_centre():
    rocker = dp.mechanisms.Loop("RRRR", [(0.0, 2.5), (0.0, 3.0), (0.0, 1.0), (0.0, 3.2)])
    begin = rocker.solve(2.0)[0]
    with pytest.raises(dp.DualpinError, match="dead centre"):
        rocker.follow(np.linspace(2.0, 2.0 + np.pi, 20), begin)


def test_a_position_that_leaves_the_loop_open_is_refused():
    loop = LOOPS["RCCC"]
    spurious = {
        k: dp.Dual(*map(float, v)) for k, v in REFERENCE["rccc"]["spurious_root_of_eq64"].items() if k != "note"
    }
    theta = [dp.Dual(np.radians(40), 0.0), *(spurious[f"theta{i}"] for i in (2, 3, 4))]
    q = loop.coordinates(theta)
    for ask in (loop.velocity, loop.acceleration, loop.mobility):
        with pytest.raises(dp.algebra.AssumptionError, match="leaves the loop open"):
            ask(q)
    assert loop.follow([np.radians(40)], q).closure[0] < 1e-12  # Newton's method leads to one that closes


@pytest.mark.parametrize(("build", "match"), [
    (lambda: dp.mechanisms.Loop("RXRR", [(0, 1)] * 4), "joint 2 is 'X'"),
    (lambda: dp.mechanisms.Loop("RHRR", [(0, 1)] * 4), "joint 2 is 'H'"),
    (lambda: dp.mechanisms.Loop("RRRR", [(0, 1)] * 3), "4 dual angles expected"),
    (lambda: dp.mechanisms.Loop("RRRR", [(0, 1)] * 4, [(0, np.nan)] * 4), "finite"),
    (lambda: dp.mechanisms.Loop("RRRR", [(0, 1)] * 4, driven=4), "from 0 to 3"),
    (lambda: dp.mechanisms.Loop(7, [(0, 1)] * 4), "letters of R P C H"),
    (lambda: LOOPS["Bennett"].velocity([0.0, 0.0]), r"theta1, theta2, theta3, theta4"),
    (lambda: LOOPS["Bennett"].solve("a"), "input"),
    (lambda: LOOPS["Bennett"].follow([[0.0]]), "follow"),
    (lambda: LOOPS["Bennett"].follow([0.1], [0.0]), "shape"),
])  # fmt: skip
def test_bad_input(build, match):
    with pytest.raises(dp.DualpinError, match=match):
        build()


def test_the_frames_of_the_joints_lead_from_one_link_to_the_next():
    loop = LOOPS["RSSR"]
    q = loop.coordinates(loop.solve(0.4, starts=64)[0].theta)
    frames = loop.frames(q)
    assert frames.shape == (7, 3, 3)
    T = dp.algebra.homogeneous(frames)
    assert np.abs(T[1:4, :3, 3] - T[1, :3, 3]).max() < 1e-12  # the ball
    assert abs(np.linalg.norm(T[4, :3, 3] - T[3, :3, 3]) - 1.3) < 1e-12
