"""PyTorch: gradients and gradients of gradients against finite differences, batches, no copies, clear refusals."""

from __future__ import annotations

import numpy as np
import pytest
from random_robots import tree

import dualpin as dp

torch = pytest.importorskip("torch", reason="torch is not installed: make torch")

import dualpin.torch as dt  # noqa: E402

ROBOTS = {
    "fixed": lambda: tree(["revolute", "prismatic", "helical"], seed=1, armature=True),
    "planar": lambda: tree(["planar", "revolute"], seed=2),
    "spherical": lambda: tree(["spherical", "revolute"], seed=3, armature=True),
    "floating": lambda: tree(["floating", "revolute"], seed=4),
}
TERMS = {
    "rnea": "qva", "aba": "qvt", "bias": "qv", "gravity": "q", "crba": "q", "fk": "q", "com": "q",
    "minv": "q", "coriolis": "qv", "integrate": "qv", "com_jacobian": "q", "kinetic_energy": "qv",
    "potential_energy": "q",
}  # fmt: skip
MORE = {"jacobian": "q", "rnea_jvp": "qvavat"}


def case(robot, name, *shape, forces=False, seed=0, options=()):
    """The term as a function of tensors that may leave the group, and where to take its derivatives."""
    n = int(np.prod(shape, dtype=int))
    states = [torch.from_numpy(x.reshape(*shape, -1)) for x in robot.sample(n, seed=seed)]
    given = [dict(zip("qvat", (*states, states[2]), strict=True))[k] for k in (TERMS | MORE)[name]]
    if forces:
        given.append(torch.from_numpy(np.random.default_rng(seed).normal(size=(*shape, len(robot), 6))))
    units = [at for j in robot for at in j.quaternions]

    def f(q, *rest):
        parts, start = [], 0
        for at in units:  # disturbed quaternions are normalised
            part = q[..., at]
            parts += [q[..., start : at.start], part / part.norm(dim=-1, keepdim=True)]
            start = at.stop
        return getattr(dt, name)(robot, torch.cat([*parts, q[..., start:]], -1), *rest, *options)

    return f, [x.clone().requires_grad_() for x in given]


@pytest.mark.parametrize("kind", ROBOTS)
@pytest.mark.parametrize("name", TERMS)
def test_gradients(name, kind):
    f, given = case(ROBOTS[kind](), name, 2)
    assert torch.autograd.gradcheck(f, given)


@pytest.mark.parametrize("kind", ROBOTS)
@pytest.mark.parametrize("name", TERMS)
def test_gradients_of_gradients(name, kind):
    f, given = case(ROBOTS[kind](), name, 1, seed=1)
    assert torch.autograd.gradgradcheck(f, given)


@pytest.mark.parametrize("name", ["rnea", "aba"])
def test_gradients_with_wrenches_on_the_bodies(name):
    f, given = case(ROBOTS["floating"](), name, 1, forces=True)
    assert torch.autograd.gradcheck(f, given)
    assert torch.autograd.gradgradcheck(f, given)


def test_a_frame_and_its_gradients():
    robot = dp.load("panda")
    tip = robot.frame_names[-1]
    q = torch.from_numpy(robot.sample(2, seed=0)[0]).requires_grad_()
    assert np.array_equal(dt.fk(robot, q, tip).detach().numpy(), dp.fk(robot, q.detach().numpy(), tip))
    assert torch.autograd.gradcheck(lambda q: dt.fk(robot, q, tip), [q])
    assert torch.autograd.gradgradcheck(lambda q: dt.fk(robot, q, tip), [q[:1].detach().requires_grad_()])
    assert torch.autograd.gradcheck(lambda q: dt.fk(robot, q, "universe"), [q])


@pytest.mark.parametrize("reference", ["world", "local", "local_world_aligned"])
@pytest.mark.parametrize("kind", ["fixed", "floating"])
def test_a_jacobian_and_its_gradients(kind, reference):
    robot = ROBOTS[kind]()
    frame = robot.frame_names[-1]
    f, (q,) = case(robot, "com", 1)
    assert torch.equal(
        dt.jacobian(robot, q, frame, reference),
        torch.from_numpy(dp.jacobian(robot, q.detach().numpy(), frame, reference)),
    )
    f, given = case(robot, "jacobian", 1, options=(frame, reference))
    assert torch.autograd.gradcheck(f, given)
    assert torch.autograd.gradgradcheck(f, given)


def test_a_directional_derivative():
    f, given = case(ROBOTS["floating"](), "rnea_jvp", 1)
    assert torch.autograd.gradcheck(f, given)


def test_coupled_joints():
    robot = dp.load("panda", mimic=True)
    q, v, a = (torch.from_numpy(x).requires_grad_() for x in robot.sample(1, seed=0))
    assert torch.autograd.gradcheck(lambda *x: dt.rnea(robot, *x), [q, v, a])
    assert torch.autograd.gradcheck(lambda *x: dt.coriolis(robot, *x), [q, v])


@pytest.mark.parametrize("kind", ROBOTS)
def test_steps_on_the_group(kind):
    robot = ROBOTS[kind]()
    q, v, _ = robot.sample(4, seed=5)
    v[0], v[1] = 0.0, 1e-9 * v[1]
    found = dt.integrate(robot, torch.from_numpy(q), torch.from_numpy(v))
    assert np.allclose(found.numpy(), dp.integrate(robot, q, v), rtol=0, atol=1e-14)
    assert torch.autograd.gradcheck(
        lambda v: dt.integrate(robot, torch.from_numpy(q), v), [torch.from_numpy(v).requires_grad_()]
    )


def test_the_third_derivative_is_refused():
    robot = ROBOTS["fixed"]()
    q, v, a = (torch.from_numpy(x).requires_grad_() for x in robot.sample(seed=0))
    (first,) = torch.autograd.grad(dt.rnea(robot, q, v, a).sum(), q, create_graph=True)
    (second,) = torch.autograd.grad(first.sum(), q, create_graph=True)
    with pytest.raises(dp.DualpinError, match="rnea_hvp has no derivative"):
        second.sum().backward()


def test_values_batches_and_precision():
    robot = dp.load("ur5")
    q, v, a = robot.sample(12, seed=1)
    expected = dp.rnea(robot, q, v, a)
    for shape in ((12,), (3, 4), (2, 1, 6)):
        given = [torch.from_numpy(x.reshape(*shape, 6)) for x in (q, v, a)]
        assert np.array_equal(dt.rnea(robot, *given).numpy(), expected.reshape(*shape, 6))
    singles = [torch.from_numpy(x).float() for x in (q, v, a)]
    got = dt.rnea(robot, *singles)
    assert got.dtype == torch.float32 and np.abs(got.numpy() - expected).max() < 1e-5 * np.abs(expected).max()
    mixed = dt.rnea(robot, singles[0], torch.from_numpy(v), singles[2])
    assert mixed.dtype == torch.float64
    assert dt.rnea(robot, *(torch.from_numpy(x[:0]) for x in (q, v, a))).shape == (0, 6)
    energy = dt.kinetic_energy(robot, torch.from_numpy(q[0]), torch.from_numpy(v[0]))
    assert energy.shape == () and float(energy) == float(dp.kinetic_energy(robot, q[0], v[0]))


def test_leading_axes_broadcast_and_gradients_sum_over_them():
    robot = dp.load("ur5")
    q, _, a = (torch.from_numpy(x) for x in robot.sample(5, seed=2))
    still = torch.zeros(6, dtype=torch.float64, requires_grad=True)
    dt.rnea(robot, q, still, a).sum().backward()
    zero, one = np.zeros(6), np.ones(6)
    expected = sum(dp.rnea_vjp(robot, x, zero, y, one)[1] for x, y in zip(q.numpy(), a.numpy(), strict=True))
    assert still.grad.shape == (6,) and np.allclose(still.grad.numpy(), expected)


def test_tensors_are_not_copied(monkeypatch):
    robot, seen = dp.load("ur5"), []
    from dualpin.autodiff.operation import Operation

    compute = Operation.compute
    monkeypatch.setattr(Operation, "compute", lambda self, *x: seen.append((x, compute(self, *x))) or seen[-1][1])
    given = [torch.from_numpy(x) for x in robot.sample(3, seed=3)]
    got = dt.rnea(robot, *given)
    arrays, result = seen[0]
    assert [x.__array_interface__["data"][0] for x in arrays] == [x.data_ptr() for x in given]
    assert result.__array_interface__["data"][0] == got.data_ptr()


def test_transforms_of_functions():
    robot = dp.load("ur5")
    q, v, a = (torch.from_numpy(x) for x in robot.sample(4, seed=4))
    one = dt.rnea(robot, q, v, a)
    assert torch.equal(torch.func.vmap(lambda *x: dt.rnea(robot, *x))(q, v, a), one)
    assert torch.equal(torch.func.vmap(lambda q, v: dt.rnea(robot, q, v, a[0]))(q, v)[0], one[0])
    loss = lambda q, v, a: dt.rnea(robot, q, v, a).square().sum()  # noqa: E731
    each = torch.func.vmap(torch.func.grad(loss))(q, v, a)
    assert torch.allclose(each, torch.func.grad(loss)(q, v, a))
    inner = torch.func.vmap(torch.func.vmap(lambda q, v: dt.bias(robot, q, v), (0, None)), (None, 0))(q, v)
    assert torch.equal(inner[1, 2], dt.bias(robot, q[2], v[1]))


class Torques(torch.utils.data.Dataset):
    robot = dp.load("ur5")
    states = [torch.from_numpy(x) for x in robot.sample(8, seed=6)]

    def __len__(self):
        return 8

    def __getitem__(self, i):
        return dt.rnea(self.robot, *(x[i] for x in self.states))


def test_in_the_processes_of_a_loader():
    expected = dt.rnea(Torques.robot, *Torques.states)
    loaded = torch.cat(list(torch.utils.data.DataLoader(Torques(), batch_size=2, num_workers=2)))
    assert torch.equal(loaded, expected)


@pytest.mark.filterwarnings("ignore:The .grad attribute of a Tensor:UserWarning")  # PyTorch's own check
def test_a_compiled_function_leaves_kernels_as_they_are():
    robot = dp.load("ur5")
    q, v, a = (torch.from_numpy(x) for x in robot.sample(4, seed=7))
    loss = lambda q: (2 * dt.rnea(robot, q, v, a)).square().sum()  # noqa: E731
    compiled = torch.compile(loss, backend="eager")
    q.requires_grad_()
    assert torch.equal(*(torch.autograd.grad(f(q), q)[0] for f in (loss, compiled)))


def test_tensors_of_any_stride_and_any_need_of_gradients():
    robot = dp.load("ur5")
    q, v, a = (torch.from_numpy(x) for x in robot.sample(4, seed=8))
    expected = dt.rnea(robot, q, v, a)
    across = torch.from_numpy(np.asfortranarray(q.numpy()))
    assert torch.equal(dt.rnea(robot, across, v, a), expected)
    assert torch.equal(dt.rnea(robot, q.flip(0), v.flip(0), a.flip(0)), expected.flip(0))
    single = v.float().requires_grad_()
    dt.rnea(robot, q, single, a).sum().backward()
    assert single.grad.dtype == torch.float32 and q.grad is None
    with torch.no_grad():
        assert not dt.rnea(robot, q, single, a).requires_grad


def test_what_is_not_offered_is_named_with_what_is():
    with pytest.raises(AttributeError, match=r"matrix has no derivative here; the momentum is .*functions: rnea"):
        _ = dt.centroidal_momentum_matrix
    with pytest.raises(AttributeError, match="did you mean 'jacobian'"):
        _ = dt.jacobain


def test_what_does_not_fit_is_named():
    robot = dp.load("ur5")
    q, v, a = (torch.from_numpy(x) for x in robot.sample(2, seed=5))
    with pytest.raises(dp.ShapeError, match=r"v of shape \(\.\.\., 6\) expected for ur5"):
        dt.rnea(robot, q, v[:, :5], a)
    with pytest.raises(dp.ArgumentError, match="q must be a tensor, got ndarray"):
        dt.rnea(robot, q.numpy(), v, a)
    with pytest.raises(dp.ArgumentError, match=r"float32 or float64 expected, got torch\.int64"):
        dt.rnea(robot, q.long(), v, a)
    with pytest.raises(dp.ArgumentError, match="a Robot expected"):
        dt.rnea("ur5", q, v, a)
    with pytest.raises(dp.ArgumentError, match="v is on meta"):
        dt.rnea(robot, q, v.to("meta"), a)
    with pytest.raises(dp.FrameNotFoundError, match="did you mean 'tool0'"):
        dt.fk(robot, q, "tool")
