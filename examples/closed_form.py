"""The equations of a planar arm in closed form, and as C for a controller."""

import tempfile
from pathlib import Path

import numpy as np

import dualpin as dp

arm = dp.from_dh([(0, 0, 0.5, 0), (0, 0, 0.4, 0)], joints="RR", convention="standard", gravity=(0, -9.81, 0), inertias=[
    {"mass": 2.0, "com": (-0.25, 0, 0), "inertia": np.zeros((3, 3))},
    {"mass": 1.0, "com": (-0.2, 0, 0), "inertia": np.zeros((3, 3))},
])  # fmt: skip
M = dp.symbolic(arm, "crba")
print("M11 =", M[0, 0])
print("g   =", dp.symbolic(arm, "gravity").tolist())

with tempfile.TemporaryDirectory() as folder:
    code = dp.export_c(arm, "rnea", folder, name="arm_rnea")
    print(
        next(
            line
            for line in (Path(folder) / "arm_rnea.h").read_text(encoding="utf-8").splitlines()
            if "arm_rnea(" in line
        )
    )
