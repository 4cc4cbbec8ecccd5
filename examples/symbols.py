"""The planar arm of two links in symbols: what Laus, Simoni and Martins print as their equations 46 to 52."""

import sympy

import dualpin as dp

a1, a2, l1, l2, m1, m2, I1, I2, g = sympy.symbols("a1 a2 l1 l2 m1 m2 I1 I2 g", positive=True)
t = sympy.Symbol("t")
q = [sympy.Function(name)(t) for name in ("theta1", "theta2")]  # functions of time
v = [x.diff(t) for x in q]

arm = dp.from_dh(
    [(0, 0, a1, 0), (0, 0, a2, 0)], gravity=(0, -g, 0),
    inertias=[
        {"mass": m1, "com": (l1 - a1, 0, 0), "inertia": sympy.diag(0, 0, I1)},
        {"mass": m2, "com": (l2 - a2, 0, 0), "inertia": sympy.diag(0, 0, I2)},
    ],
)  # fmt: skip
print("J2 =", dp.symbolic(arm, "jacobian", frame="com:link_2", reference="local", q=q).tolist()[2:5])  # eq 46
terms = dp.symbolic(arm, "link_terms", q=q, v=v)
for i in (1, 2):
    M, C, gravity = (sympy.Matrix(terms[i - 1, :i, columns]) for columns in (slice(0, i), slice(2, 2 + i), slice(4, 5)))
    print(f"M{i} =", M.tolist(), f"\nC{i} =", C.tolist(), f"\ng{i} =", gravity.tolist())  # eqs 47, 48, 51, 52
    print(f"J{i}_com =", dp.symbolic(arm, "jacobian", frame=f"com:link_{i}", q=q,
                                     reference="local_world_aligned").tolist()[2:5])  # eqs 49, 50  # fmt: skip
