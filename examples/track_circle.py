"""Which integrator for a circle with a redundant arm?  Peak error against the cost, in closed loop, on a PA-10."""

from pathlib import Path

import numpy as np

import dualpin as dp

arm = dp.load(Path(__file__).parents[1] / "urdf" / "pa10" / "pa10.urdf")
start = np.deg2rad([10, 40, 10, 60, 10, 50, 10])
circle = dp.Circle(radius=0.1, period=10.0, plane="xy", start=start)
print("method        dt [s]  peak error [m]  evaluations")
for method in ("euler", "trapezoidal", "abm4", "rk4"):
    for dt in (0.1, 0.05):
        run = dp.track(arm, circle, method=method, dt=dt, t_end=20.0, gain=5.0)
        print(f"{method:12s}  {dt:5.2f}  {np.abs(run.position_error).max():14.1e}  {run.cost.evaluations:11d}")
