"""Libraries judged on twenty robots, term by term; run with ``make referee``.

Every library runs in the environment that ``dualpin subjects install`` makes.  Writes results.json and
README.md.  A pair of library and robot that was judged before, by the same versions, is not judged again
(``out/referee``), so an interrupted run goes on where it was.
"""

from __future__ import annotations

import hashlib
import json
import sys
import time
from pathlib import Path
from typing import Any

import dualpin as dp
from dualpin.crosscheck.results import Report
from dualpin.crosscheck.subjects import environments
from dualpin.errors import DualpinError

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
LIMIT = 120.0
"""Seconds that a term of one robot may take before the library counts as hanging."""
KEPT = ("sample", "where", "against_50_digits", "n_eps_cond")


def main(folder: Path = Path("out/referee")) -> int:
    folder.mkdir(parents=True, exist_ok=True)
    reports: dict[str, dict[str, Any]] = {}
    for title, subject in SUBJECTS.items():
        adapter = environments.environment(subject.partition(":")[0])
        if title != "pinocchio" and not adapter.ready:
            try:
                environments.install(adapter.adapter, lambda what: print(what, file=sys.stderr))
            except DualpinError as e:
                print(f"{title}: left out ({e})", file=sys.stderr)
                continue
        reports[title] = {}
        for robot, floating in FEW.get(title, CASES):
            label = f"{robot} floating" if floating else robot
            print(f"{title}: {label} {time.strftime('%T')}", file=sys.stderr, flush=True)
            reports[title][label] = judged(subject, adapter, robot, floating, folder)
        write(reports)
    return 0


def write(reports: dict[str, dict[str, Any]]) -> None:
    (HERE / "results.json").write_text(json.dumps(reports, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    (HERE / "README.md").write_text(page(reports), encoding="utf-8")


def kept_only(folder: Path) -> int:
    """The page of what is judged so far: `python -m validation.referee --page`."""
    reports: dict[str, dict[str, Any]] = {}
    for title, subject in SUBJECTS.items():
        adapter = environments.environment(subject.partition(":")[0])
        for robot, floating in FEW.get(title, CASES):
            path = place(subject, adapter, robot, floating, folder)
            if path.exists():
                label = f"{robot} floating" if floating else robot
                reports.setdefault(title, {})[label] = json.loads(path.read_text(encoding="utf-8"))
    write(reports)
    return 0


def place(subject: str, adapter: environments.Environment, robot: str, floating: bool, folder: Path) -> Path:
    """Where a judgement is kept: another version of the library, of dualpin or of the adapter is another one."""
    source = adapter.adapter.read_text(encoding="utf-8")
    of = f"{subject} {adapter.requires} {robot} {floating} {dp.__version__} {source}"
    return folder / f"{hashlib.sha256(of.encode()).hexdigest()[:24]}.json"


def judged(subject: str, adapter: environments.Environment, robot: str, floating: bool, folder: Path) -> dict[str, Any]:
    """The judgement as plain data, from `folder` where it is there already."""
    kept = place(subject, adapter, robot, floating, folder)
    if kept.exists():
        return dict(json.loads(kept.read_text(encoding="utf-8")))
    found = shortened(dp.judge(robot, subject, floating=floating, limit=LIMIT))
    new = kept.with_suffix(".new")
    new.write_text(json.dumps(found), encoding="utf-8")
    new.replace(kept)
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
    return {"version": robot.get("subject_version", ""), "reason": robot.get("reason", ""), "terms": terms}


if __name__ == "__main__":
    sys.exit(kept_only(Path("out/referee")) if "--page" in sys.argv else main())
