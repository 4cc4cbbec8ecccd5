"""Mutated URDFs: a robot or a `DualpinError`, never another exception, never a hang."""

from __future__ import annotations

import re
import resource
import signal
import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.io.urdf import loads
from tests.random_robots import random_urdf

from .bad_urdfs import CASES, GOOD

HERE = Path(__file__).parent
OWN = [*sorted((HERE / "data").glob("*.urdf")), *sorted((HERE.parents[1] / "urdf").rglob("*.urdf"))]
MEGABYTES = 200  # that reading and using one file may take
SECONDS = 60  # for one file; the slowest honest one takes 0.2 s on a machine with nothing else to do


@contextmanager
def bounded(what: str) -> Iterator[None]:
    """Turn a hang into a failure that names the file."""

    def stop(*_: object) -> None:
        raise TimeoutError(f"more than {SECONDS} s: {what}")

    old = signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, old)


def seeds_of_mutation(most: int = 40_000) -> list[bytes]:
    """Real URDFs (short ones first), random ones, and the table of odd ones."""
    real = sorted((p.read_bytes() for p in dp.io.catalogue().values()), key=len)
    made = [random_urdf(s, mimic=True).encode() for s in range(5)]
    return [
        GOOD.encode(),
        *made,
        *(p.read_bytes() for p in OWN),
        *(c.data for c in CASES if 0 < len(c.data) < 5000),
        *(x for x in real if len(x) < most),
    ]


# --- blind to the structure ----------------------------------------------------------------------


def flip_bytes(data: bytes, rng: np.random.Generator) -> bytes:
    x = bytearray(data)
    for _ in range(int(rng.integers(1, 6))):
        x[int(rng.integers(len(x)))] = int(rng.integers(256))
    return bytes(x)


def cut(data: bytes, rng: np.random.Generator) -> bytes:
    a, b = sorted(rng.integers(0, len(data) + 1, 2))
    return data[:a] + data[b:]


def truncate(data: bytes, rng: np.random.Generator) -> bytes:
    return data[: int(rng.integers(len(data)))]


def repeat(data: bytes, rng: np.random.Generator) -> bytes:
    a, b = sorted(rng.integers(0, len(data) + 1, 2))
    return data[:b] + data[a:b][:4000] + data[b:]


# --- aware of it ---------------------------------------------------------------------------------

VALUES = (
    "nan", "inf", "-inf", "1e400", "1e308", "-1e308", "1e-320", "0", "-0", "", " ", "1_0", "0x1", "1,5", "true",
    "\u00e9", "\u0661", "1e5", "-1", "3.4028236692093846346337460743177e38",
    "1 2", "1 2 3", "1 2 3 4", "0 0 0", "1e200 1e200 0",
    "1e-200 0 0", "9" * 400, "universe", "base", "&lt;", "&#9;", "${x}", "1e308 1e308 1e308", "-1e308 1e308 0",
)  # fmt: skip


def change_attribute(data: bytes, rng: np.random.Generator) -> bytes:
    """Another value for one to three attributes."""
    for _ in range(int(rng.integers(1, 4))):
        found = list(re.finditer(rb'="[^"]*"', data))
        if found:
            m = found[int(rng.integers(len(found)))]
            others = [x.group()[2:-1] for x in found[:200]]
            value = (
                VALUES[int(rng.integers(len(VALUES)))].encode()
                if rng.random() < 0.7
                else others[int(rng.integers(len(others)))]
            )
            data = data[: m.start() + 2] + value + data[m.end() - 1 :]
    return data


def drop_attribute(data: bytes, rng: np.random.Generator) -> bytes:
    found = list(re.finditer(rb'\s[\w:]+="[^"]*"', data))
    if not found:
        return data
    m = found[int(rng.integers(len(found)))]
    return data[: m.start()] + data[m.end() :]


def move_element(data: bytes, rng: np.random.Generator) -> bytes:
    """Remove, double or move an element that has no children."""
    found = list(re.finditer(rb"<\w+[^<>]*/>", data))
    if not found:
        return data
    m, how = found[int(rng.integers(len(found)))], rng.integers(3)
    without = data[: m.start()] + data[m.end() :]
    if how == 0:
        return without
    at = m.end() if how == 1 else found[int(rng.integers(len(found)))].start()
    return data[:at] + m.group() + data[at:]


def rename_tag(data: bytes, rng: np.random.Generator) -> bytes:
    tags = [
        b"link",
        b"joint",
        b"inertial",
        b"origin",
        b"mass",
        b"inertia",
        b"parent",
        b"child",
        b"axis",
        b"limit",
        b"mimic",
        b"robot",
    ]
    a, b = (tags[int(rng.integers(len(tags)))] for _ in range(2))
    return re.sub(rb"(</?)" + a + rb"\b", rb"\1" + b, data, count=int(rng.integers(0, 4)))


def change_type(data: bytes, rng: np.random.Generator) -> bytes:
    kinds = (b"revolute", b"continuous", b"prismatic", b"fixed", b"floating", b"planar", b"spherical")
    found = list(re.finditer(rb'type="[^"]*"', data))
    if not found:
        return data
    m = found[int(rng.integers(len(found)))]
    return data[: m.start()] + b'type="' + kinds[int(rng.integers(len(kinds)))] + b'"' + data[m.end() :]


# --- faults of markup, which are mended or refused ------------------------------------------------

MARKUP = (
    b"<!-- a -- b --->", b"<!--", b"-->", b"<![CDATA[x<y]]>", b"]]>", b"<?pi?>", b"<?xml version='0.0'?>",
    b"<!DOCTYPE r>",
    b"<x:y/>", b"<xacro:property name='a' value='1'/>", b"<xacro:arm/>",
    b"<xacro:macro name='m'><link name='q'/></xacro:macro>",
    b"<gazebo a='b'c='d' e='<' f='&'/>", b"&", b"&amp;", b"&x;", b"<", b">", b"\0", b"\xff", b"\xef\xbb\xbf",
    b"\r\n", b"</robot>",
    b"</robot><extra/>", b"<link/>", b"<robot>", b"<Link name='l'/>", b" x:y='z'", b" xmlns='urn:x'",
    b" quat_xyzw='0 0 0 1'",
    b"${x}", b"$(arg x)", b"<!ENTITY x 'y'>",
)  # fmt: skip


def insert_markup(data: bytes, rng: np.random.Generator) -> bytes:
    """A piece of markup anywhere, or where a tag ends or begins."""
    at = int(rng.integers(len(data) + 1))
    if rng.random() < 0.7:
        edges = [m.start() + int(rng.integers(2)) * (m.group() == b">") for m in re.finditer(rb"[<>]", data)]
        at = edges[int(rng.integers(len(edges)))] if edges else at
    return data[:at] + MARKUP[int(rng.integers(len(MARKUP)))] + data[at:]


def change_head(data: bytes, rng: np.random.Generator) -> bytes:
    """Another declaration, or another encoding, that may or may not be true."""
    heads = (b'<?xml version="1"?>', b"<?xml?>", b"\n\n<?xml version='1.0'?>",
             b'<?xml version="1.0" encoding="utf-16"?>',
             b'<?xml version="1.0" encoding="latin-1"?>', b'<?xml version="1.0" encoding="no such"?>', b"",
             b'<?xml version="1.0" encoding="cp500"?>', b'<?xml version="1.0" encoding="utf-7"?>')  # fmt: skip
    data = heads[int(rng.integers(len(heads)))] + re.sub(rb"^\s*<\?xml.*?\?>", b"", data, flags=re.DOTALL)
    if rng.random() < 0.3:
        encodings = ("utf-16", "utf-16-le", "utf-32", "utf-8-sig", "cp500")
        data = data.decode("utf-8", "replace").encode(encodings[int(rng.integers(len(encodings)))], "replace")
    return data


BLIND = (flip_bytes, cut, truncate, repeat, insert_markup, change_head)
AWARE = (
    change_attribute,
    change_attribute,
    change_attribute,
    drop_attribute,
    move_element,
    rename_tag,
    change_type,
    insert_markup,
    insert_markup,
)


def examine(data: bytes, rng: np.random.Generator) -> bool:
    """Load it both ways; when it loads, use it.  True if it loaded."""
    floating, mimic = bool(rng.integers(2)), bool(rng.integers(2))
    with bounded(repr(data[:2000])), warnings.catch_warnings():
        # a remark of dualpin's own is fine; any other warning (NumPy's, a parser's) is a defect
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", dp.DualpinWarning)
        warnings.filterwarnings("ignore", category=DeprecationWarning, module="yourdfpy")
        try:
            robot = loads(data, floating=floating, mimic=mimic)
        except dp.DualpinError:
            return False
        repr(robot)
        robot.summary()
        q, v, a = robot.sample(seed=0)
        assert np.isfinite(q).all() and np.isfinite(v).all()
        T = dp.fk(robot, q, robot.frame_names[-1], engine="numpy")
        assert T.shape == (4, 4)
        if robot.nv <= 12:
            assert dp.rnea(robot, q, v, a, engine="numpy").shape == (robot.nv,)
            assert dp.aba(robot, q, v, a, engine="numpy").shape == (robot.nv,)
    return True


def campaign(n: int, seed: int, most: int) -> None:
    rng, sources = np.random.default_rng(seed), seeds_of_mutation(most)
    loaded = 0
    for i in range(n):
        data = sources[int(rng.integers(len(sources)))]
        operations = AWARE if rng.random() < 0.7 else BLIND
        for _ in range(int(rng.integers(1, 4))):
            data = operations[int(rng.integers(len(operations)))](data, rng) or b"<robot/>"
        before = _peak()
        try:
            loaded += examine(data, rng)
            assert _peak() - before < MEGABYTES
        except BaseException as e:
            raise AssertionError(f"mutation {i} of seed {seed}: {type(e).__name__}: {e}\n{data[:3000]!r}") from e
    assert n / 50 < loaded < n  # both outcomes occurred


def _peak() -> float:
    """The most memory that this process has had, in MB."""
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / 2**20 if sys.platform == "darwin" else most / 2**10


def test_mutated_urdfs_load_or_are_refused(seed):
    campaign(600, seed, most=15_000)


@pytest.mark.parametrize(
    "hostile",
    [
        b"<!--" * 200_000, b"<a '" * 200_000, b'<a b="' * 200_000, b"<a b='c'" * 100_000, b"<" * 500_000,
        b"&" * 500_000,
        b"<?xml?>" * 100_000, b"<!-- -- -->" * 100_000, b"<robot>" + b"<a:b/>" * 100_000, b"</a>" * 200_000,
        b"<robot name='r'><link name='l'/><!-- -- -->" + b"".join(b"<p%d:x/>" % i for i in range(50_000)) + b"</robot>",
        b"<robot name='r'><!-- -- -->" + b"<link name='a&b'/>" * 50_000 + b"</robot>", b"<robot " + b"a='b'" * 100_000,
        "<".encode("utf-16") + b"\0<" * 200_000, b"<?xml " + b" " * 500_000, b"<!D" * 200_000, b"<![CDATA[" * 100_000,
    ],
    ids=lambda b: f"{b[:12]!r}",
)  # fmt: skip
def test_hostile_markup_costs_time_in_proportion(hostile):
    """Nothing is looked at again for every one before it: a second for a megabyte, not hours."""
    start = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", dp.DualpinWarning)
        try:
            notes = "".join(loads(hostile).notes)
        except dp.UrdfError as e:
            notes = str(e)
    assert 0 < len(notes) < 2000
    assert time.process_time() - start < 10


@pytest.mark.campaign
@pytest.mark.timeout(0)
@pytest.mark.parametrize("round", range(20))  # 100,000 files
def test_many_mutated_urdfs_load_or_are_refused(seed, round):
    campaign(5000, seed + 1 + round, most=200_000)
