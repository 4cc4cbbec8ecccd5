"""Exported C on processors: the example runs under several compilers and an emulated ARM, the stack is as stated."""

from __future__ import annotations

import re
import shutil
import subprocess

import numpy as np
import pytest

import dualpin as dp

CASES = [
    ("ur5", "rnea"), ("panda", "aba"), ("ur5", "fk"), ("ur5+floating", "integrate"), ("ur5+floating", "difference"),
    ("ur5", "minv"),
]  # fmt: skip
STRICT = "-Wstrict-prototypes -Wmissing-prototypes -Wfloat-equal"
ARM = {"CC": "arm-linux-gnueabihf-gcc", "LDFLAGS": "-static", "RUN": "qemu-arm"}


def robot(name):
    return dp.load(name.removesuffix("+floating"), floating=name.endswith("+floating"))


def exported(folder, math, dtype, cases=CASES):
    return [dp.export_c(robot(name), term, folder, dtype=dtype, math=math) for name, term in cases]


def make(folder, target="check", **variables):
    needed = [variables.get("CC", "cc"), variables.get("RUN", "true"), "make"]
    for program in needed:
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed")
    words = ["make", "-s", target, *(f"{key}={value}" for key, value in variables.items())]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


GCC, CLANG = {"CC": "gcc"}, {"CC": "clang"}


@pytest.mark.parametrize(
    ("dtype", "math", "compiler"),
    [
        (np.float64, "libm", GCC), (np.float64, "own", GCC), (np.float32, "libm", GCC), (np.float32, "own", GCC),
        (np.float64, "own", CLANG), (np.float32, "libm", CLANG), (np.float64, "libm", ARM), (np.float32, "own", ARM),
    ],
    ids=lambda x: x.get("CC") if isinstance(x, dict) else getattr(x, "__name__", x),
)  # fmt: skip
def test_the_examples_come_out_right(dtype, math, compiler, tmp_path):
    codes = exported(tmp_path, math, dtype)
    said = make(tmp_path, CFLAGS=f"-O1 {STRICT}", **compiler)
    assert said.count(" of ") == len(codes)


@pytest.mark.parametrize("level", ["-O0", "-O3", "-Os"])
@pytest.mark.parametrize("compiler", ["gcc", "arm-linux-gnueabihf-gcc"])
def test_the_stack_is_no_more_than_stated(compiler, level, tmp_path):
    """The function, one of its parts, and what that calls of its own are open at once; FRAME is for the library's."""
    codes = exported(tmp_path, "own", np.float64, [("panda", "rnea"), ("ur5+floating", "difference")])
    codes += exported(tmp_path, "libm", np.float32, [("panda", "aba")])
    usage = make(tmp_path, "stack", CC=compiler, CFLAGS=level)
    for code in codes:
        taken = {m[1]: int(m[2]) for m in re.finditer(rf":({code.name}\w*)\t(\d+)\tstatic", usage)}
        parts = [n for name, n in taken.items() if "_part" in name]
        helpers = [n for name, n in taken.items() if name.endswith(("_root", "_turn"))]
        assert taken[code.name] + max(parts) + max(helpers, default=0) <= code.stack, taken


def test_nothing_of_a_library_is_called_but_what_is_said():
    for math, allowed in (("libm", {"sin", "cos"}), ("own", set())):
        for dtype, suffix in ((np.float64, ""), (np.float32, "f")):
            for name, term in CASES:
                code = dp.export_c(robot(name), term, dtype=dtype, math=math)
                called = set(re.findall(r"\b([a-z_]\w*)\(", re.sub(r"/\*.*?\*/", "", code.source, flags=re.S)))
                foreign = {x for x in called if not x.startswith(code.name)} - {"defined", "__attribute__", "void"}
                assert {x.removesuffix(suffix) for x in foreign - {"if"}} <= allowed
                assert ("#include <math.h>" in code.source) == bool(allowed)
                assert "//" not in code.source and "goto" not in code.source and "for (" not in code.source


def test_the_header_counts_what_a_call_does():
    code = dp.export_c(dp.load("ur5"), "rnea")
    body = re.sub(r"/\*.*?\*/", "", code.source, flags=re.S)
    statements = [line for line in body.splitlines() if re.match(r"\s+t\[\d+\] = ", line)]
    counted = {
        "additions": sum(bool(re.search(r" [-+] ", x)) for x in statements),
        "multiplications": sum(" * " in x for x in statements),
        "sines and cosines": sum("sin(" in x or "cos(" in x for x in statements),
    }
    assert {key: code.operations[key] for key in counted} == counted
    for key, n in counted.items():
        assert f"{n} {key}" in code.header
    assert f"{code.stack} bytes" in code.header


@pytest.mark.skipif(shutil.which("cc") is None, reason="cc is not installed")
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_own_functions_over_their_whole_reach(dtype, tmp_path):
    """Sines, cosines and roots against NumPy's: 2 and 1 units in the last place, beyond reach no number."""
    import ctypes

    kind = np.dtype(dtype)
    fk = dp.export_c(dp.load("ur5"), "fk", name="turns", dtype=dtype, math="own")
    roots = dp.export_c(robot("ur5+floating"), "difference", name="roots", dtype=dtype)
    word = {8: "double", 4: "float"}[kind.itemsize]
    text = fk.source.replace("static void turns_turn", "void turns_turn") + roots.source.replace(
        f"static {word} roots_root", f"{word} roots_root"
    ).replace('#include "roots.h"', "")
    fk.write(tmp_path)
    (tmp_path / "all.c").write_text(text)
    words = ["cc", "-O2", "-shared", "-fPIC", "all.c", "-o", "all.so", "-lm"]
    subprocess.run(words, cwd=tmp_path, check=True)
    library, number = ctypes.CDLL(str(tmp_path / "all.so")), {8: ctypes.c_double, 4: ctypes.c_float}[kind.itemsize]
    library.turns_turn.argtypes = [number, ctypes.POINTER(number), ctypes.POINTER(number)]
    library.roots_root.argtypes, library.roots_root.restype = [number], number
    reach, rng = {8: 1e8, 4: 1e3}[kind.itemsize], np.random.default_rng(0)
    s, c = number(), number()
    angles = [*rng.uniform(-10, 10, 2000), *rng.uniform(-reach, reach, 2000), 0.0, -0.0, np.pi / 2, reach, -reach]
    for x in np.array(angles, kind):
        library.turns_turn(x, s, c)
        for got, right in ((s.value, np.sin(np.float64(x))), (c.value, np.cos(np.float64(x)))):
            assert abs(got - right) <= 2 * np.spacing(np.abs(kind.type(right))) + 1e-16 * (kind.itemsize == 8)
    for x in (2 * reach, np.inf, np.nan):
        library.turns_turn(x, s, c)
        assert np.isnan(s.value) and np.isnan(c.value)
    exponents = rng.uniform(-300, 300, 3000) if kind.itemsize == 8 else rng.uniform(-37, 37, 3000)
    for x in (10.0**exponents).astype(kind):
        assert abs(library.roots_root(x) - float(np.sqrt(x))) <= np.spacing(np.sqrt(x))
    assert library.roots_root(0.0) == 0 and library.roots_root(1.0) == 1 and np.isnan(library.roots_root(np.nan))


def test_what_is_no_kind_of_mathematics_is_named():
    with pytest.raises(dp.ArgumentError, match=r"export_c: math"):
        dp.export_c(dp.load("ur5"), "rnea", math="fast")


@pytest.mark.campaign
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("math", ["own", "libm"])
def test_cppcheck_finds_nothing_of_misra_c_2012(math, dtype, tmp_path):
    """What its addon checks, half of the rules that a tool can check; the examples print, so they are not of it."""
    if shutil.which("cppcheck") is None:
        pytest.skip("cppcheck is not installed")
    exported(tmp_path, math, dtype, [("ur5", "rnea"), ("ur5+floating", "difference"), ("panda", "aba")])
    files = [x for x in tmp_path.glob("*.c") if not x.stem.endswith("_test")]
    flags = "--addon=misra --std=c99 --enable=style,warning,performance,portability --suppress=missingIncludeSystem"
    words = ["cppcheck", "-q", *flags.split(), *map(str, files)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert not done.returncode and not done.stderr, done.stderr


def test_files_of_something_else_are_kept(tmp_path):
    robot = dp.load("ur5")
    tool = dp.export_c(robot, "frame_pose", tmp_path, frame="tool0")
    again = dp.export_c(robot, "frame_pose", tmp_path, frame="tool0")
    with pytest.raises(dp.ArgumentError, match=r"ur5_frame_pose.c is something else .*tool0.* name= gives"):
        dp.export_c(robot, "frame_pose", tmp_path, frame="base_link")
    assert (tmp_path / "ur5_frame_pose.c").read_text() == tool.source == again.source
    (tmp_path / "Makefile").write_text("all: theirs\n")
    with pytest.warns(dp.DualpinWarning, match="Makefile is not ours and is kept"):
        dp.export_c(robot, "gravity", tmp_path)
    assert (tmp_path / "Makefile").read_text() == "all: theirs\n"


def test_names_that_differ_by_their_case_alone_do_not_hide_each_other():
    headers = [dp.export_c(dp.load("ur5"), "gravity", name=name).header for name in ("arm", "ARM")]
    guards = [re.search(r"#ifndef (\w+)", x)[1] for x in headers]
    assert len(set(guards)) == 2
