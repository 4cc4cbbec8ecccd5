"""Guard a robot's model in CI: fail when the file stops meaning what it meant, or has remarks that are new."""

import json
import sys
import tempfile
from pathlib import Path

import numpy as np

import dualpin as dp


def facts(path):
    """What must not change unnoticed: joints, masses, a fingerprint of the dynamics, the loader's remarks."""
    robot = dp.load(path)
    q, v, a = robot.sample(20, seed=0)
    return {
        "joints": list(robot.joint_names), "mass": round(robot.mass, 9), "notes": list(robot.notes),
        "torques": np.round(dp.rnea(robot, q, v, a), 6).tolist(),
    }  # fmt: skip


if len(sys.argv) > 1:
    model, kept = Path(sys.argv[1]), Path(sys.argv[2])
else:  # to try it: the arm of this repository against itself
    model = Path(__file__).parents[1] / "urdf" / "pa10" / "pa10.urdf"
    kept = Path(tempfile.mkdtemp()) / "facts.json"
now = facts(model)
if not kept.exists():
    kept.write_text(json.dumps(now), encoding="utf-8")
before = json.loads(kept.read_text(encoding="utf-8"))
changed = [key for key in before if before[key] != now[key]]
report = dp.validate(model, samples=20)
print(f"changed: {', '.join(changed) or 'nothing'}; against Pinocchio: {report.status}; remarks: {len(now['notes'])}")
sys.exit(bool(changed) or not report.passed)
