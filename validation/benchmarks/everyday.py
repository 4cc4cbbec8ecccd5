"""Speed as users meet it: plain calls, sizes, every function, single calls and cold starts.

    python -m validation.benchmarks.everyday [--against FOLDER] [--only SECTION ...] [--quick] [--again]

    results   plain calls, calls with `out`, NumPy's fill and Pinocchio, at batches of 512 and 4096
    sizes     five terms from one sample to 1 GB: plain beside `out`
    single    one configuration: kernel, plain call, Pinocchio
    cold      the first call in a process with an empty cache
    validate  `dualpin validate`, cold and warm
    terms     every function from 1 kB to 256 MB: plain beside `out`

Each section runs in processes of its own, one thread; with ``--against`` (a checkout of another commit) in turns with
processes of that, so that before and after come from one run.  After each process everyday/PROCESSOR.json and .md are
written: interrupted, the same command goes on, and what it measured of the same commits is not measured again.
Sections keep their date and commits until they are measured for others.  Checked before timing: plain calls, calls with
`out` and NumPy's execution agree.
"""

from __future__ import annotations

import argparse
import contextlib
import inspect
import json
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np

from dualpin.files import write_text

HERE = Path(__file__).parent
SECTIONS = {
    "results": (2, 0.4), "sizes": (2, 0.3), "single": (2, 0.3), "cold": (2, 0.0), "validate": (1, 0.0),
    "terms": (1, 0.2),
}  # fmt: skip
"""Rounds, in which the versions take turns, and the seconds of what is measured within one."""

Rows = dict[str, float]
"""What was measured -> seconds, or microseconds a sample."""


def best(calls: dict[str, Callable[[], Any]], seconds: float) -> dict[str, float]:
    """The shortest run of each, in turns: what disturbs, disturbs them all."""
    for f in calls.values():
        f()
    found = dict.fromkeys(calls, float("inf"))
    end, turns = time.perf_counter() + seconds, 0
    while time.perf_counter() < end or turns < 3:
        turns += 1
        for name, f in calls.items():
            f()  # caches and clocks are its own
            start = time.perf_counter()
            f()
            found[name] = min(found[name], time.perf_counter() - start)
    return found


# --- what a process measures ----------------------------------------------------------------------

RESULTS = [("talos", True, "crba"), ("talos", True, "coriolis"), ("panda", False, "fk"), ("panda", False, "crba"),
           ("panda", False, "coriolis"), ("panda", False, "jacobian"), ("ur5", False, "fk"),
           ("talos", True, "fk")]  # fmt: skip
ARMS = ("ur3", "ur5", "ur10", "panda", "kinova", "xarm7", "z1", "bravo7_no_ee", "so100", "talos_arm")


def arguments(robot: Any, term: str, n: int | None) -> list[Any]:
    """What the function needs: states of the robot, and its outermost frame."""
    import dualpin as dp

    q, v, a = robot.sample(n, seed=0)
    frame = max(robot.frames, key=lambda f: len(list(f.joint.chain)) if f.joint else 0)
    known = {"q": q, "q0": q, "q1": robot.sample(n, seed=1)[0], "frame": frame.name, "a": a, "tau": a}
    wanted = list(inspect.signature(getattr(dp, term)).parameters.values())[1:]
    return [known.get(x.name, v) for x in wanted if x.kind is x.POSITIONAL_OR_KEYWORD and x.default is x.empty]


def checked(robot: Any, f: Callable[..., np.ndarray], given: list[Any], out: np.ndarray) -> None:
    f(robot, *given, engine="compiled")  # not while it is measured
    few = [x[:8] if isinstance(x, np.ndarray) and x.ndim > 1 else x for x in given]
    expected = f(robot, *few, engine="numpy")
    f(robot, *given, out=out)
    plain = f(robot, *given)
    assert np.array_equal(plain, out)
    assert np.allclose(plain[: len(expected)] if plain.ndim == expected.ndim else plain, expected, rtol=1e-9, atol=1e-9)


def results(seconds: float) -> Rows:
    """The table: microseconds a sample, plain and with `out`, beside NumPy's fill of such an array, and Pinocchio."""
    import dualpin as dp
    from dualpin import bench

    rows: Rows = {}
    for name, floating, term in RESULTS:
        robot, f = dp.load(name, floating=floating), getattr(dp, term)
        for n in (512, 4096):
            given = arguments(robot, term, n)
            out = np.empty_like(f(robot, *given))
            checked(robot, f, given, out)
            calls = {
                "plain": lambda f=f, r=robot, x=given: f(r, *x),
                "out": lambda f=f, r=robot, x=given, o=out: f(r, *x, out=o),
                "empty + fill": lambda o=out: np.empty(o.shape).fill(1.0),
                "fill": lambda o=out: o.fill(1.0),
            }
            label = f"{name}{' + floating' if floating else ''} {term} ({out.nbytes // n} B) x {n}"
            rows |= {f"{label} | {k}": 1e6 * t / n for k, t in best(calls, seconds).items()}
            theirs, samples, _ = bench.Pair(robot, term, n, 1).theirs()
            took = best({"": lambda f=theirs: f(1)}, seconds / 4)[""]
            rows[f"{label} | Pinocchio, Python loop"] = 1e6 * took / samples
    return rows


def sizes(seconds: float) -> Rows:
    """Plain calls and calls with `out`, from one sample to 1 GB."""
    import dualpin as dp

    rows: Rows = {}
    for name, floating, term in [*RESULTS[:3], ("panda", False, "rnea"), ("ur5", False, "gravity")]:
        robot, f = dp.load(name, floating=floating), getattr(dp, term)
        for n in (1, 8, 64, 512, 4096, 32768, 1 << 18, 1 << 20):
            given = arguments(robot, term, n)
            if f(robot, *arguments(robot, term, 2)).nbytes // 2 * n > 1.1e9:
                break
            out = np.empty_like(f(robot, *given, engine="compiled"))  # compiled now, not while it is measured
            calls = {
                "plain": lambda f=f, r=robot, x=given: f(r, *x),
                "out": lambda f=f, r=robot, x=given, o=out: f(r, *x, out=o),
            }
            label = f"{name} {term} {out.nbytes / 1e6:.4g} MB"
            rows |= {f"{label} | {k}": 1e6 * t / n for k, t in best(calls, seconds).items()}
    return rows


TERMS = (
    "rnea", "aba", "bias", "gravity", "fk", "crba", "coriolis", "minv", "jacobian", "jacobian_dot", "frame_velocity",
    "frame_acceleration", "com", "com_jacobian", "kinetic_energy", "potential_energy", "centroidal_momentum_matrix",
    "joint_torque_regressor", "joint_wrenches", "integrate", "difference", "rnea_derivatives", "aba_derivatives",
    "rnea_jvp", "rnea_vjp", "rnea_hessian", "rnea_hvp", "rnea_second_derivatives",
)  # fmt: skip

MOST = 1 << 19  # samples: their states take more memory than the results of some


def terms(seconds: float) -> Rows:
    """Each function with `out`, results of 1 kB to 256 MB: plain calls beside calls with `out`."""
    import dualpin as dp

    rows: Rows = {}
    robot = dp.load("panda")
    for term in TERMS:
        f = getattr(dp, term, None)
        if f is None or "out" not in inspect.signature(f).parameters:
            continue  # of a later version
        one = result(f(robot, *arguments(robot, term, 2))).nbytes // 2
        for size in (1 << k for k in range(10, 29, 3)):
            n = min(max(2, size // one), MOST)
            given = arguments(robot, term, n)
            out = result(f(robot, *given, engine="compiled"))  # compiled now, not while it is measured
            calls = {
                "plain": lambda f=f, x=given: f(robot, *x),
                "out": lambda f=f, x=given, o=out: f(robot, *x, out=o),
            }
            label = f"panda {term} {out.nbytes / 1e6:.4g} MB"
            rows |= {f"{label} | {k}": 1e6 * t / n for k, t in best(calls, seconds).items()}
    return rows


def result(found: Any) -> np.ndarray:
    """An array for the result: several of one shape are parts of one."""
    return np.ascontiguousarray(np.stack(found, axis=1)) if isinstance(found, tuple) else np.empty_like(found)


def single(seconds: float) -> Rows:
    """One configuration: `robot.kernel`, the public function, and Pinocchio's functions."""
    import pinocchio as pin

    import dualpin as dp
    from dualpin import bench

    rows: Rows = {}
    for name in ARMS:
        try:
            robot = dp.load(name)
            pair = bench.Pair(robot, "rnea", 1, 1)
        except dp.DualpinError:
            continue  # not among this release's robots
        model = pair.oracle.free.model
        data, neutral, rest = model.createData(), pin.neutral(model), np.zeros(model.nv)
        for term, theirs in (("rnea", [pin.rnea, model, data, neutral, rest, rest]),
                             ("fk", [pin.forwardKinematics, model, data, neutral]),
                             ("crba", [pin.crba, model, data, neutral])):  # fmt: skip
            given, kernel, f = arguments(robot, term, None), robot.kernel(term), getattr(dp, term)
            kernel(*given), f(robot, *given)
            loops = [bench.loop(kernel, [given]), bench.loop(f, [[robot, *given]]), bench.loop(theirs[0], [theirs[1:]])]
            times = bench.alternating(loops, max(5, int(seconds / 0.004)), 0.002)
            best_of = zip(("kernel", "plain", "pin"), map(min, times), strict=True)
            rows |= {f"{name} {term} | {k}": 1e6 * t for k, t in best_of}
    return rows


COLD = [("ur5", False, "rnea"), ("panda", False, "rnea"), ("panda", False, "coriolis"), ("panda", False, "aba"),
        ("panda", False, "rnea_derivatives"), ("panda", False, "aba_derivatives"),
        ("panda", False, "rnea_second_derivatives"), ("panda", False, "joint_torque_regressor"),
        ("talos", True, "rnea"), ("talos", True, "fk"), ("talos", True, "crba"), ("g1", True, "rnea"),
        ("panda", False, "rnea", 100), ("panda", False, "rnea_derivatives", 100),
        ("panda", False, "rnea_second_derivatives", 100)]  # fmt: skip
"""Robot, whether it floats, term; samples of a batch."""


def cold(seconds: float) -> Rows:
    """From the call to its result, in a new process with an empty cache; and from the start of that process.

    Python may read its bytecode of the package, as it does where one is installed: a run before all others writes it.
    """
    import dualpin as dp

    rows: Rows = {}
    usual = {**os.environ, "PYTHONWARNINGS": "ignore", "PYTHONDONTWRITEBYTECODE": ""}
    rehearsal = "import dualpin as dp; r = dp.load('ur5'); dp.rnea(r, *r.sample(seed=0))"
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-c", rehearsal], env={**usual, "DUALPIN_CACHE_DIR": folder}, check=True)
    for name, floating, term, *samples in COLD:
        if not hasattr(dp, term):
            continue  # of a later version
        code = f"""
import time, dualpin as dp
robot = dp.load({name!r}, floating={floating})
q, v, a = robot.sample(*{samples}, seed=0)
given = {{"fk": (q,), "crba": (q,), "coriolis": (q, v)}}.get({term!r}, (q, v, a))
start = time.perf_counter()
dp.{term}(robot, *given)
print(time.perf_counter() - start)
"""
        with tempfile.TemporaryDirectory() as folder:
            env = {**usual, "DUALPIN_CACHE_DIR": folder}
            start = time.perf_counter()
            done = subprocess.run([sys.executable, "-c", code], env=env, check=True, capture_output=True, text=True)
            label = f"{name}{' + floating' if floating else ''} {term}{''.join(f' x {n}' for n in samples)}"
            rows[f"{label} | process"] = time.perf_counter() - start
            rows[f"{label} | call"] = float(done.stdout)
    return rows


VALIDATED = [("panda", []), ("xarm7", []), ("g1", []), ("icub", ["--floating"])]


def validate(seconds: float) -> Rows:
    """`dualpin validate`, cold and then warm."""
    rows: Rows = {}
    for name, more in VALIDATED:
        with tempfile.TemporaryDirectory() as folder:
            env = {**os.environ, "DUALPIN_CACHE_DIR": folder, "PYTHONWARNINGS": "ignore", "DUALPIN_NUM_THREADS": ""}
            for state in ("cold", "warm"):
                start = time.perf_counter()
                done = subprocess.run(
                    [sys.executable, "-m", "dualpin", "validate", name, *more],
                    env=env,
                    check=False,
                    capture_output=True,
                )
                if done.returncode in (0, 1):
                    rows[f"validate {name} {' '.join(more)} | {state}"] = time.perf_counter() - start
    return rows


# --- in turns -------------------------------------------------------------------------------------


class Record:
    """What was measured on this processor, in a file that is written after each process; an interrupted run goes on."""

    def __init__(self, roots: dict[str, Path]) -> None:
        from dualpin import bench
        from validation.benchmarks.report import named

        self.machine, self.commits = bench.machine(), {name: commit(root) for name, root in roots.items()}
        self.path = HERE / "everyday" / f"{named(self.machine['processor'])}.json"
        self.sections: dict[str, Any] = {}
        with contextlib.suppress(OSError):
            self.sections = json.loads(self.path.read_text(encoding="utf-8"))["sections"]

    def begun(self, name: str, rounds: int, again: bool) -> Any:
        """The record of a section: a new one for other commits or rounds, or where it is to be measured again."""
        found, wanted = self.sections.get(name, {}), {"commits": self.commits, "rounds": rounds}
        if again or {key: found.get(key) for key in wanted} != wanted:
            rows: dict[str, Rows] = {version: {} for version in self.commits}
            found = wanted | {"machine": self.machine, "loads": [], "seconds": 0, "done": [], "rows": rows}
        return found

    def add(self, name: str, section: Any, turn: int, version: str, found: Rows, seconds: float) -> None:
        """Enter a run of a section: of each row the least of all rounds is kept."""
        rows = section["rows"][version]
        rows |= {key: min(x, rows.get(key, x)) for key, x in found.items()}
        section["done"].append([turn, version])
        section["loads"].append(round(os.getloadavg()[0], 2))
        section["seconds"] = round(section["seconds"] + seconds)
        section["date"] = datetime.now(timezone.utc).strftime("%Y-%m-%d")
        self.sections = {x: section if x == name else self.sections[x] for x in SECTIONS if x in {*self.sections, name}}
        self.write()

    def write(self) -> None:
        write_text(self.path, json.dumps({"sections": self.sections}, indent=1) + "\n")
        head = f"# Speed as users meet it: {self.machine['processor']}\n\nThe shortest of all runs.\n\n"
        tables = [table(x, about) for x, about in self.sections.items() if all(about["rows"].values())]
        write_text(self.path.with_suffix(".md"), head + "\n".join(tables))


def commit(root: Path) -> str:
    """The commit checked out in that folder."""
    git = ["git", "-C", str(root), "rev-parse", "--short", "HEAD"]
    done = subprocess.run(git, check=False, capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else "unknown"


def measured(section: str, root: Path, seconds: float) -> Rows:
    """One section in a process that takes dualpin from this folder."""
    env = {**os.environ, "PYTHONPATH": str(root), "PYTHONWARNINGS": "ignore", "DUALPIN_NUM_THREADS": "1"}
    command = [sys.executable, str(Path(__file__).resolve()), "--section", section, "--seconds", str(seconds)]
    done = subprocess.run(command, env=env, cwd=root, check=True, stdout=subprocess.PIPE, text=True)
    found: Rows = json.loads(done.stdout.splitlines()[-1])
    return found


def table(section: str, about: Any) -> str:
    """The rows of each version side by side."""
    rows: dict[str, Rows] = about["rows"]
    labels = list(dict.fromkeys(k.partition(" | ")[0] for k in rows["now"]))
    columns = list(dict.fromkeys(k.partition(" | ")[2] for k in rows["now"]))
    heads = [f"{c}{f', {version}' if len(rows) > 1 else ''}" for c in columns for version in rows]
    unit = "seconds" if section in ("cold", "validate") else "microseconds a sample"
    m, loads = about["machine"], about["loads"]
    left = about["rounds"] * len(rows) - len(about["done"])
    made = (
        f"{about['date']}, {', '.join(f'{v} {c}' for v, c in about['commits'].items())}; rounds: {about['rounds']}"
        f"{f', load {min(loads)} to {max(loads)}' if loads else ''}; Python {m['python']}, numpy {m['numpy']}, "
        f"pin {m['pin']}.{f' **{left} runs are missing.**' if left else ''}"
    )
    lines = [f"## {section} ({unit})", "", made, "", f"| | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    for label in labels:
        cells = [rows[v].get(f"{label} | {c}") for c in columns for v in rows]
        lines.append(f"| {label} | {' | '.join('' if x is None else f'{x:.4g}' for x in cells)} |")
    return "\n".join([*lines, "", *remarks(section, rows["now"])]) + "\n"


def remarks(section: str, rows: Rows) -> list[str]:
    """What the table is to show, in a line."""
    if section in ("sizes", "terms"):
        big = (k.removesuffix(" | plain") for k in rows if k.endswith(" | plain") and float(k.split()[2]) >= 1e-3)
        over, where = max((rows[f"{k} | plain"] / rows[f"{k} | out"], k) for k in big)
        return [f"Plain over `out` from 1 kB on, at worst: {over:.2f} ({where}).", ""]
    if section == "results":
        whole = [k.removesuffix(" x 512 | plain") for k in rows if k.endswith(" x 512 | plain")]
        shown = []
        for k in whole:
            ours, fill = (rows[f"{k} x 4096 | {x}"] / rows[f"{k} x 512 | {x}"] for x in ("plain", "fill"))
            shown.append(f"{k} {ours:.2f} ({fill:.2f})")
        return [f"A sample of 4096 over one of 512, plain (and of NumPy's fill): {'; '.join(shown)}.", ""]
    return []


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m validation.benchmarks.everyday")
    parser.add_argument("--against", type=Path, help="a checkout of another commit, measured in turns")
    parser.add_argument("--only", nargs="*", choices=SECTIONS, help="these sections")
    parser.add_argument("--quick", action="store_true", help="one round, short")
    parser.add_argument("--again", action="store_true", help="also what was measured of these commits")
    parser.add_argument("--section", choices=SECTIONS, help=argparse.SUPPRESS)
    parser.add_argument("--seconds", type=float, default=0.0, help=argparse.SUPPRESS)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    if given.section:
        print(json.dumps(globals()[given.section](given.seconds)))
        return
    roots = ({"before": given.against.resolve()} if given.against else {}) | {"now": HERE.parents[1]}
    record = Record(roots)
    for name in [x for x in SECTIONS if x in (given.only or SECTIONS)]:
        rounds, seconds = (1, 0.05) if given.quick else SECTIONS[name]
        section = record.begun(name, rounds, given.again)
        for turn in range(rounds):
            for version, root in roots.items():
                if [turn, version] not in section["done"]:
                    start = time.perf_counter()
                    found = measured(name, root, seconds)
                    record.add(name, section, turn, version, found, took := time.perf_counter() - start)
                    print(f"{name} {turn + 1}/{rounds}, {version}: {took:.0f} s", file=sys.stderr, flush=True)
        print(table(name, section), flush=True)


if __name__ == "__main__":
    main()
