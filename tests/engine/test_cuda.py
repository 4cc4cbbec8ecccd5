"""GPU kernels where there may be no GPU: the same functions on the host, and what the assembler says.

Those that need a device skip without one; `python -m validation.benchmarks.gpu` is the long check there.
"""

from __future__ import annotations

import ctypes
import gc
import weakref

import mpmath
import numpy as np
import pytest
from random_robots import tree

import dualpin as dp
from dualpin import bench_device
from dualpin.engine.codegen.number import DOUBLE, SINGLE
from dualpin.engine.cuda import arrays, dlpack, driver, far, layout, program, resources
from dualpin.engine.cuda.arrays import one_step
from dualpin.engine.cuda.build import Plan, plan
from dualpin.engine.cuda.emulator import Emulated
from dualpin.engine.graph.trace import Graph, Sym, Trace, trace
from dualpin.engine.jit.kernel import build
from dualpin.terms import TERMS

from .test_kernels import options, states

SIX = [("ur5", False), ("panda", False), ("talos", False), ("anymal_c", True), ("g1", True), ("tiago_dual", False)]
TYPES = (np.float64, np.float32)
TYPE_NAMES = ("float64", "float32")
needs_device = pytest.mark.skipif(driver.count() == 0, reason="no CUDA device")
needs_ptxas = pytest.mark.skipif(resources.ptxas() is None, reason="the wheel nvidia-cuda-nvcc is not installed")


def inputs_of(robot, term, n, dtype, seed=0):
    given = states(robot, n, seed)
    return [np.ascontiguousarray(given[x].reshape(n, -1), dtype=dtype) for x in TERMS[term].inputs]


def agrees(robot, term, dtype, strided, n=77, part=program.PART):
    """Whether a GPU's program on the host gives the bits of the host's own kernel."""
    chosen = options(robot, term)
    xs = inputs_of(robot, term, n, dtype)
    expected = build(robot, TERMS[term], chosen, dtype).rows(xs)
    made = plan(robot, TERMS[term], chosen, dtype, strided=strided, part=part)
    return np.array_equal(Emulated(made)(*(np.asfortranarray(x) if strided else x for x in xs)), expected)


# --- the same bits as the host's kernel -----------------------------------------------------------


@pytest.mark.parametrize("term", TERMS)
def test_every_term_has_the_bits_of_the_hosts_kernel(term):
    robot = tree(("floating", "helical"), 3)
    for dtype in TYPES:
        for strided in (False, True):
            assert agrees(robot, term, dtype, strided), (dtype, strided)


@pytest.mark.parametrize(("name", "term"), [("panda", "rnea"), ("panda", "aba"), ("talos", "rnea")])
def test_robots_have_the_bits_of_the_hosts_kernel(name, term):
    assert agrees(dp.load(name), term, np.float64, False)


@pytest.mark.parametrize("n", [1, 31, 32, 33, 64])
def test_a_last_tile_may_be_short(n):
    assert agrees(dp.load("ur5"), "rnea", np.float64, False, n)


@pytest.mark.parametrize("part", [10, 40, 200])
def test_a_program_in_parts_is_the_same_program(part):
    robot = dp.load("ur5")
    assert len(plan(robot, TERMS["aba"], {}, part=part).program.parts) > 3
    for strided in (False, True):
        assert agrees(robot, "aba", np.float64, strided, part=part)


def test_one_sample_serves_all_and_rows_may_have_gaps():
    robot = dp.load("ur5")
    q, v, a = inputs_of(robot, "rnea", 50, np.float64)
    kernel = Emulated(plan(robot, TERMS["rnea"], {}))
    assert np.array_equal(kernel(q[:1], v, a), dp.rnea(robot, q[0], v, a))
    wide = np.full((50, 25), np.nan)
    wide[:, 3:9], wide[:, 9:15], wide[:, 16:22] = q, v, a
    assert np.array_equal(kernel(wide[:, 3:9], wide[:, 9:15], wide[:, 16:22]), dp.rnea(robot, q, v, a))


def test_results_that_are_inputs_or_sines_or_known():
    graph = Graph()
    (x, y) = graph.inputs(0, 2)
    library = {"sin": Sym(graph, graph.node("sin", x.i)), "cos": Sym(graph, graph.node("cos", x.i))}
    traced = Trace(graph, [2], [y, library["sin"], 2.5, y, library["cos"], x * y, library["sin"]])
    for lay in (layout.strided((2, 7)), layout.staged((2, 7), 100), layout.staged((2, 7), 7)):
        got = Emulated(Plan(program.program(traced, 100), DOUBLE, lay))(np.array([[0.5, 3.0]]))[0]
        assert got.tolist() == [3.0, np.sin(0.5), 2.5, 3.0, np.cos(0.5), 1.5, np.sin(0.5)]


@pytest.mark.campaign
@pytest.mark.parametrize(("name", "floating"), SIX)
@pytest.mark.parametrize("term", TERMS)
def test_every_term_of_six_robots_has_the_bits_of_the_hosts_kernel(name, floating, term):
    robot = dp.load(name, floating=floating)
    try:
        plan(robot, TERMS[term], options(robot, term))
    except program.TooLongError as e:
        pytest.skip(str(e))
    for dtype in TYPES:
        assert agrees(robot, term, dtype, strided=False)


# --- angles far away ------------------------------------------------------------------------------


def turned(xs, number=DOUBLE):
    """Cosines and sines by a kernel of nothing else."""
    graph = Graph()
    (x,) = graph.inputs(0, 1)
    traced = Trace(graph, [1], [Sym(graph, graph.node(op, x.i)) for op in ("cos", "sin")])
    made = Plan(program.program(traced, 100), number, layout.staged((1, 2), 8))
    return Emulated(made)(np.asarray(xs, made.dtype).reshape(-1, 1))


def test_digits_of_two_over_pi():
    with mpmath.workprec(1400):
        expected = int(mpmath.floor(mpmath.ldexp(2 / mpmath.pi, far.BITS)))
    words = far.digits()
    assert words[0] == 0
    assert sum(w << 64 * k for k, w in enumerate(reversed(words))) == expected


@pytest.mark.parametrize("number", [DOUBLE, SINGLE])
def test_angles_beyond_reach_are_reduced_exactly(number, seed):
    """Within 1.5 units in the last place, as near ones; 6381956970095103 2^797 is nearest to a multiple of pi/2."""
    rng = np.random.default_rng(seed)
    kind = np.float64 if number is DOUBLE else np.float32
    top = 308 if number is DOUBLE else 38
    xs = (10.0 ** rng.uniform(np.log10(number.reach), top, 2000) * rng.choice([-1, 1], 2000)).astype(kind)
    if number is DOUBLE:
        xs = np.append(xs, [6381956970095103 * 2.0**797, np.finfo(float).max, 1e22, number.reach * (1 + 1e-15)])
    got = turned(xs, number)
    with mpmath.workprec(1300):
        for x, both in zip(xs.tolist(), got, strict=True):
            for f, value in zip((mpmath.cos, mpmath.sin), both, strict=True):
                true = f(mpmath.mpf(x))
                assert abs(mpmath.mpf(float(value)) - true) < 1.5 * float(np.spacing(kind(abs(float(true))))), (x, f)


def test_near_and_far_angles_share_a_warp():
    xs = np.array([0.3, 1e12, -2.0, np.inf, 5.0, np.nan, -1e300, 0.0])
    got = turned(xs)
    with np.errstate(invalid="ignore"):
        expected = np.stack([np.cos(xs), np.sin(xs)], 1)
    assert np.array_equal(np.isnan(got), np.isnan(expected))
    assert np.nanmax(np.abs(got - expected)) < 3e-16
    assert got[7].tolist() == [1.0, 0.0]


# --- the program ----------------------------------------------------------------------------------


def test_values_are_made_before_they_are_read():
    robot = dp.load("ur5")
    traced = trace(robot, TERMS["aba"], {})
    for part in (50, 10_000):
        made = program.program(traced, 100, part=part, together=3)
        nodes, here, slots = made.nodes, set(), {}
        for p in made.parts:
            here = {key for key, slot in p.reads.items() if slots[slot] == key}
            assert len(here) == len(p.reads)
            assert not set(p.reads.values()) & set(p.writes.values())
            for s in p.segments:
                assert len(s.angles) <= 3
                assert all(nodes[a][0] == "in" or ("", a) in here for a in s.angles)
                here |= {(op, a) for a in s.angles for op in ("sin", "cos")}
                for step in s.steps:
                    needed = {program.value_of(nodes, a) for a in step.args if nodes[a][0] not in ("in", "const")}
                    assert needed <= here
                    here.add(("", step.i))
            slots |= {slot: key for key, slot in p.writes.items()}
        assert sum(len(s.steps) for p in made.parts for s in p.segments) == made.operations


def test_programs_that_are_too_long_say_so(monkeypatch):
    monkeypatch.setattr(program, "LONGEST", 100)
    with pytest.raises(program.TooLongError, match=r"operations: too long for a GPU.* 100 "):
        plan(dp.load("ur5"), TERMS["aba"], {})


@pytest.mark.parametrize("most", [0, 7, 14, 30, 200])
@pytest.mark.parametrize("sizes", [(6, 6, 6, 6), (7, 1, 0, 12), (32, 33)])
def test_rows_in_shared_memory_are_apart_and_odd(sizes, most):
    made = layout.staged(sizes, most)
    places = sorted((o, layout.row(s)) for o, s in zip(made.offsets, sizes, strict=True) if o is not None)
    end = 0
    for offset, places_of_row in places:
        assert places_of_row % 2 == 1
        assert offset == end
        end = offset + layout.WARP * places_of_row
    assert made.room == end <= layout.WARP * most


# --- PTX ------------------------------------------------------------------------------------------


def test_ptx_is_made_without_a_gpu():
    text = plan(dp.load("ur5"), TERMS["rnea"], {}).ptx(threads=64, resident=3)
    assert ".target sm_80" in text
    assert ".maxntid 64\n.minnctapersm 3\n{" in text
    assert "ld.global.nc.b64" in text or "ld.global.nc.f64" in text
    assert "call" in text  # of angles far away
    assert "mul.f64" not in text  # which ptxas could join with a sum: then bits would differ from the host's
    assert text == plan(dp.load("ur5"), TERMS["rnea"], {}).ptx(threads=64, resident=3)


@needs_ptxas
@pytest.mark.parametrize("architecture", ["sm_80", "sm_90"])
def test_inverse_dynamics_of_panda_needs_no_memory_for_its_values(architecture):
    found = resources.resources(plan(dp.load("panda"), TERMS["rnea"], {}), architecture)
    assert found.registers <= 255
    assert found.spill_stores == found.spill_loads == found.stack == 0
    assert (found.parts, found.blocks, found.occupancy) == (1, 2, 0.125)
    single = resources.resources(plan(dp.load("panda"), TERMS["rnea"], {}, np.float32), architecture)
    assert single.registers < found.registers
    assert single.blocks > found.blocks


@needs_ptxas
def test_the_assembler_refuses_what_is_no_ptx():
    with pytest.raises(dp.DeviceError, match="ptxas -arch=sm_90"):
        resources.assembled("no ptx", "sm_90")


def test_without_the_assembler_the_report_says_what_to_install(monkeypatch):
    monkeypatch.setattr(resources, "ptxas", lambda: None)
    with pytest.raises(dp.DeviceError, match=r"pip install 'dualpin\[cuda\]'"):
        resources.assembled("", "sm_90")


def test_blocks_that_have_room():
    """CUDA's own occupancy calculator: 255 registers, 8 warps; 128 registers, 16; 33 KiB a block of 164, 4."""
    assert resources.resident(255, 0, 90) == 2
    assert resources.resident(128, 0, 90) == 4
    assert resources.resident(32, 0, 90) == 16
    assert resources.resident(32, 33 * 1024, 80) == 4


@pytest.mark.campaign
@needs_ptxas
@pytest.mark.parametrize(("name", "floating"), SIX)
@pytest.mark.parametrize("term", TERMS)
def test_every_term_of_six_robots_is_assembled(name, floating, term):
    robot = dp.load(name, floating=floating)
    for dtype in TYPES:
        try:
            text = plan(robot, TERMS[term], options(robot, term), dtype).ptx()
        except program.TooLongError as e:
            pytest.skip(str(e))
        for architecture in ("sm_80", "sm_90"):
            code, said = resources.assembled(text, architecture)
            assert code[:4] == b"\x7fELF"
            assert "error" not in said


# --- arrays and devices ---------------------------------------------------------------------------


class Lender:
    def __init__(self, shape=(3, 5), dtype=np.float32):
        self.shape, self.dtype = shape, np.dtype(dtype)

    def __dlpack__(self, stream=None):
        self.stream = stream
        return dlpack.capsule(self, 0x1000, self.shape, self.dtype, 2)


def test_arrays_are_lent_by_dlpack_and_come_back(monkeypatch):
    monkeypatch.setattr(ctypes.pythonapi.PyCapsule_New, "argtypes", ())  # other packages set it, JAX among them
    lender = Lender()
    got = dlpack.received(lender, 7)
    assert got[:5] == (0x1000, (3, 5), (20, 4), np.dtype(np.float32), 2)
    assert lender.stream == 7
    alive = weakref.ref(lender)
    del lender
    gc.collect()
    assert alive() is not None  # the capsule holds it
    del got
    gc.collect()
    assert alive() is None
    assert not dlpack._lent


def test_the_default_stream_has_a_number_in_dlpack():
    lender = Lender()
    dlpack.received(lender, 0)
    assert lender.stream == 1


@pytest.mark.parametrize(
    ("shape", "strides", "step"),
    [((), (), 1), ((5,), (8,), 1), ((5,), (24,), 3), ((1, 5), (999, 8), 1), ((4, 5), (40, 8), 1),
     ((4, 5), (48, 8), None), ((4, 5), (0, 0), 0), ((3,), (12,), None), ((2, 3, 4), (96, 32, 8), 1),
     ((1, 1), (8, 8), 1), ((3,), (-8,), -1)],
)  # fmt: skip
def test_axes_that_can_be_walked_along_as_one(shape, strides, step):
    assert one_step(shape, strides, 8) == step


def test_whose_arrays_they_are():
    assert arrays.adapter(np.zeros(3)) is arrays.adapter([1.0]) is arrays.adapter("text") is None

    class Foreign:
        __cuda_array_interface__ = {"shape": (3,), "typestr": "<f8", "data": (4096, False), "version": 3}

    assert type(arrays.adapter(Foreign())) is arrays.Adapter


@pytest.mark.skipif(driver.count() > 0, reason="there is a CUDA device")
def test_without_a_device_the_error_says_so():
    with pytest.raises(dp.DeviceError, match=r"no CUDA driver|finds no device"):
        dp.load("ur5").kernel("rnea", device="cuda")
    robot = dp.load("ur5")
    q, v, a = robot.sample(3, seed=0)
    with pytest.raises(dp.DeviceError, match=r"no CUDA driver|finds no device"):
        dp.rnea(robot, q, v, a, engine="cuda")


def test_names_of_terms_and_types_are_checked_first():
    robot = dp.load("ur5")
    with pytest.raises(dp.errors.ArgumentError, match="did you mean 'rnea'"):
        robot.kernel("rnae", device="cuda")
    with pytest.raises(dp.errors.ArgumentError, match="float64 or float32 expected, got int64"):
        robot.kernel("rnea", np.int64, device="cuda")


@needs_device
@pytest.mark.parametrize("term", ["rnea", "aba", "crba", "fk"])
def test_a_device_gives_the_bits_of_the_host(term):
    robot = dp.load("panda")
    for dtype in TYPES:
        xs = inputs_of(robot, term, 1000, dtype)
        there = [arrays.to_device(x) for x in xs]
        expected = robot.kernel(term, dtype=dtype)(*xs)
        compute = robot.kernel(term, dtype, device="cuda")
        assert np.array_equal(compute(*there).to_host(), expected)
        assert np.array_equal(compute(*xs, copy=True), expected)


# --- the report ------------------------------------------------------------------------------------


@needs_ptxas
def test_the_report_of_registers_needs_no_device():
    rows = bench_device.explained(["ur5"], ["rnea", "jacobian"])
    assert [(r["term"], r["dtype"]) for r in rows] == [
        (t, d) for t in ("rnea", "jacobian") for d in bench_device.DTYPES
    ]
    assert all(0 < r["registers"] <= 255 and 0 < r["occupancy"] <= 1 for r in rows)


@pytest.mark.skipif(driver.count() > 0, reason="there is a CUDA device")
def test_nothing_is_measured_without_a_device():
    with pytest.raises(dp.DeviceError):
        bench_device.run(["ur5"], ["rnea"])


def test_terms_that_are_too_long_are_in_the_report(monkeypatch):
    monkeypatch.setattr(program, "LONGEST", 10)
    rows = bench_device.explained(["ur5"], ["rnea"])
    assert all("too long for a GPU" in r["reason"] for r in rows)
