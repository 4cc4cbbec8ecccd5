"""Base parameters: which dynamic parameters can be identified from torques, and which only in combinations."""

import collections

import dualpin as dp

arm = dp.load("ur10")
base = dp.base_parameters(arm)
print(f"{len(base)} base parameters of {len(base.parameters)}, {base}")
for name, value in list(zip(base.names, base.values(), strict=True))[:4]:
    print(f"  {value:9.4f} = {name}")
print(collections.Counter(base.identifiable.values()))

# they give the torques
q, v, a = arm.sample(100, seed=0)
error = abs(base.regressor(q, v, a) @ base.values() - dp.rnea(arm, q, v, a)).max()
print(f"largest error of torques: {error:.1e} N m")
assert len(base) == 36 and error < 1e-10

# gravity alone shows less; rotors and friction are more to find
still = dp.base_parameters(arm, (q, 0 * v, 0 * a))
full = dp.base_parameters(arm, rotors=True, friction=True)
print(f"at rest {len(still)}; with rotors and friction {len(full)} of {len(full.parameters)}")
assert len(still) < 36 < len(full)
