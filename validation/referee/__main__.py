"""Libraries judged on twenty robots, term by term; run with ``make referee``.

Every library runs in the environment that ``dualpin subjects install`` makes.  Writes results.json and
README.md.  Answers and judgements are kept in ``out/referee``: an interrupted run goes on where it was, and a
dualpin that judges better judges the same answers again, without asking for them.
"""

from __future__ import annotations

import hashlib
import json
import sys
import time
import warnings
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import dualpin
from dualpin.crosscheck.judging import verdict
from dualpin.crosscheck.results import Report
from dualpin.crosscheck.subjects import QUESTIONS, Asking, asking, environments
from dualpin.crosscheck.subjects.asking import SAMPLES
from dualpin.errors import DualpinError, DualpinWarning
from dualpin.files import write_text

from .answering import Cell
from .page import page

HERE = Path(__file__).parent
EXAMPLES = "examples/subjects"
SUBJECTS = {
    "pinocchio": "pinocchio",
    "mujoco": "mujoco",
    "mujoco, passive forces off": "mujoco:clean",
    "drake": "drake",
    "idyntree": "idyntree",
    "adam": "adam",
    "robotics-toolbox": "rtb",
    "pybullet": f"{EXAMPLES}/pybullet.py:Subject",
    "frax": f"{EXAMPLES}/frax.py:Subject",
    "kinpy": f"{EXAMPLES}/kinpy.py:Subject",
    "pytorch_kinematics": f"{EXAMPLES}/pytorch_kinematics.py:Subject",
    "scikit-robot": f"{EXAMPLES}/skrobot.py:Subject",
    "placo": f"{EXAMPLES}/placo.py:Subject",
    "DQ Robotics": f"{EXAMPLES}/dqrobotics.py:Subject",
    "JaxSim": f"{EXAMPLES}/jaxsim.py:Subject",
    "Brax": f"{EXAMPLES}/brax.py:Subject",
    "MJX": f"{EXAMPLES}/mjx.py:Subject",
}
FEW = dict.fromkeys(("JaxSim", "Brax", "MJX"), (("panda", False), ("ur5", False), ("solo12", True)))
"""Libraries that compile every robot for minutes are asked about some."""
FIXED = (
    "panda", "ur5", "ur10", "kinova", "xarm7", "z1", "talos_arm", "so101", "TwoDofs", "double_pendulum", "finger_edu",
    "baxter", "tiago", "talos",
)  # fmt: skip
FLOATING = ("solo12", "go2", "anymal_c", "bolt", "hextilt", "g1")
CASES = [*((name, False) for name in FIXED), *((name, True) for name in FLOATING)]
KEPT = ("sample", "where", "against_50_digits", "n_eps_cond")


Reports = dict[str, dict[str, dict[str, Any]]]


def main(words: list[str], folder: Path = Path("out/referee")) -> int:
    """``--ask`` only asks, ``--page`` only writes; titles of libraries, if given, are those asked and judged."""
    named = [t for t in SUBJECTS if t in words]
    titles = [] if "--page" in words else named or list(SUBJECTS)
    reports: Reports = {}
    for title, label, cell in cells([t for t in titles if ready(t)], folder):
        print(f"{title}: {label} {time.strftime('%T')}", file=sys.stderr, flush=True)
        cell.answers()
        if "--ask" not in words:
            reports.setdefault(title, {})[label] = judged(cell, folder)
    if "--ask" not in words:
        write({t: judged_before(t, folder) | reports.get(t, {}) for t in SUBJECTS})
    return 0


def cells(titles: Iterable[str], folder: Path) -> Iterator[tuple[str, str, Cell]]:
    """Libraries and robots, in the order of the page."""
    for title in titles:
        adapter = environments.environment(SUBJECTS[title].partition(":")[0])
        for robot, floating in FEW.get(title, CASES):
            label = f"{robot} floating" if floating else robot
            yield title, label, Cell(SUBJECTS[title], adapter, asked(robot, floating), folder)


@cache
def asked(robot: str, floating: bool) -> Asking:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)  # what the reader remarks is in `dualpin info`
        return asking(robot, SAMPLES, 0, tuple(QUESTIONS), floating=floating)


def ready(title: str) -> bool:
    """Whether the library has its environment, which is made where it is missing."""
    adapter = environments.environment(SUBJECTS[title].partition(":")[0])
    if title != "pinocchio" and not adapter.ready:
        try:
            environments.install(adapter.adapter, lambda what: print(what, file=sys.stderr))
        except DualpinError as e:
            print(f"{title}: left out ({e})", file=sys.stderr)
            return False
    return True


def write(reports: Reports) -> None:
    (HERE / "results.json").write_text(json.dumps(reports, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    (HERE / "README.md").write_text(page(reports), encoding="utf-8")


def judged_before(title: str, folder: Path) -> dict[str, dict[str, Any]]:
    """What is known of a library: judged by this dualpin, else what is committed."""
    committed = json.loads((HERE / "results.json").read_text(encoding="utf-8")).get(title, {})
    found = {label: kept(cell, folder) or committed.get(label) for _, label, cell in cells([title], folder)}
    return {label: x for label, x in found.items() if x is not None}


def places(cell: Cell, folder: Path) -> tuple[Path, Path]:
    """Where a judgement is kept: one without differences, which stands for this version, and any other.

    Other answers are another judgement; so is another diagnosis, where one was asked for.
    """
    answers = cell.path.read_bytes() if cell.path.exists() else b""
    keys = (answers + dualpin.__version__.encode(), answers + diagnosis())
    a, b = (folder / "judged" / f"{hashlib.sha256(key).hexdigest()[:24]}.json" for key in keys)
    return a, b


@cache
def diagnosis() -> bytes:
    """What the causes depend on that are named."""
    home = Path(dualpin.__file__).parent / "crosscheck"
    files = [home / "judging.py", *sorted((home / "diagnosis").rglob("*.py"))]
    return hashlib.sha256(b"".join(f.read_bytes() for f in files)).digest()


def kept(cell: Cell, folder: Path) -> dict[str, Any] | None:
    """A judgement that is there already, of all that the library has."""
    if cell.missing:
        return None
    for path in places(cell, folder):
        if path.exists():
            return dict(json.loads(path.read_text(encoding="utf-8")))
    return None


def judged(cell: Cell, folder: Path) -> dict[str, Any]:
    """The judgement as plain data, from `folder` where it is there already."""
    cell.answers()
    found = kept(cell, folder)
    if found is None:
        result = verdict(cell.answers(), cell.asking, True, cell.refusal, lambda what: None)
        found = shortened(Report([result]))
        odd = found["reason"] or any(t["status"] == "differs" for t in found["terms"].values())
        path = places(cell, folder)[1 if odd else 0]  # a refusal has asked more
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, json.dumps(found))
    return found


def shortened(report: Report) -> dict[str, Any]:
    """What the table needs; ``dualpin judge`` with the same seed has the rest."""
    data = json.loads(report.to_json())
    (robot,) = data["robots"]
    terms = {}
    for name, t in robot["terms"].items():
        short = {
            key: t[key] for key in ("status", "reason", "nearer", "max_scaled_error", "compared", "note") if t.get(key)
        }
        short["worst"] = {k: t["worst"][k] for k in KEPT if k in t["worst"]}
        short["findings"] = [
            {
                k: f[k]
                for k in ("key", "says", "items", "before", "after", "alternatives", "fix", "convention")
                if f.get(k)
            }
            for f in t.get("findings", [])
        ]
        terms[name] = short
    refusal = {k: robot["refusal"][k] for k in ("says", "items", "alternatives", "fix")} if robot.get("refusal") else {}
    return {
        "version": robot.get("subject_version", ""), "reason": robot.get("reason", ""), "refusal": refusal,
        "terms": terms,
    }  # fmt: skip


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
