"""Check one's own dynamics code: a two-link arm written by hand, with a mistake that the check finds."""

import numpy as np

import dualpin as dp

arm = dp.from_dh([(0, 0, 0.5, 0), (0, 0, 0.4, 0)], joints="RR", convention="standard", gravity=(0, -9.81, 0), inertias=[
    {"mass": 2.0, "com": (-0.25, 0, 0), "inertia": np.diag([0.0, 0.05, 0.05])},
    {"mass": 1.0, "com": (-0.2, 0, 0), "inertia": np.diag([0.0, 0.02, 0.02])},
])  # fmt: skip
l1, c1, c2, m1, m2, I1, I2, g = 0.5, 0.25, 0.2, 2.0, 1.0, 0.05, 0.02, 9.8  # whose g is this?


def inverse_dynamics(q, v, a):
    """From the textbook's Lagrangian."""
    cosine, h = np.cos(q[1]), m2 * l1 * c2 * np.sin(q[1])
    M11 = m1 * c1**2 + I1 + m2 * (l1**2 + c2**2 + 2 * l1 * c2 * cosine) + I2
    M12, M22 = m2 * (c2**2 + l1 * c2 * cosine) + I2, m2 * c2**2 + I2
    g2 = m2 * g * c2 * np.cos(q[0] + q[1])
    g1 = (m1 * c1 + m2 * l1) * g * np.cos(q[0]) + g2
    return [
        M11 * a[0] + M12 * a[1] - h * v[1] * (2 * v[0] + v[1]) + g1,
        M12 * a[0] + M22 * a[1] + h * v[0] ** 2 + g2,
    ]


report = dp.judge(arm, {"rnea": inverse_dynamics})
print(report.terms["rnea"].status)
for finding in report.findings:
    print(f"[{finding.key}] {finding.says}; fix: {finding.fix}")
assert [f.key for f in report.findings] == ["gravity"]
