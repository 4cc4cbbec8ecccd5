"""Whether another version computes the same bits:  python -m validation.benchmarks.bits --against FOLDER [--robots ...]

FOLDER is a checkout of the other version.  For each term of each robot two digests are compared:

    numpy       the bytes of the results of NumPy's execution, of a batch and of one sample
    program     the operations of the compiled program after fusion, each with its operands: what decides its bits

The order of operations and the slots of values do not decide bits, and are not compared.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve()
ROBOTS = ("ur5", "panda", "panda/mimic", "solo12/floating", "talos/floating")
LONGEST = 20  # degrees of freedom beyond which terms that grow with their third power are left out
LONG = ("rnea_second_derivatives", "rnea_hessian", "rnea_hvp", "link_terms")


def digests(names: list[str]) -> dict[str, list[str]]:
    """For each term and option: the digest of NumPy's results, and that of the program."""
    import numpy as np

    import dualpin as dp
    from dualpin.interpret import interpret
    from dualpin.terms import TERMS

    warnings.simplefilter("ignore")
    found = {}
    for name in names:
        plain, _, how = name.partition("/")
        robot = dp.load(plain, **({how: True} if how else {}))
        rng = np.random.default_rng(1)
        states = robot.sample(3, seed=1)[0], robot.sample(3, seed=2)[0]
        for term in TERMS.values():
            if robot.nv > LONGEST and term.name.startswith(LONG):
                continue
            inputs = [
                states[x.name == "q1"] if x.configuration else rng.normal(size=(3, x.size(robot)))
                for x in term.arguments
            ]
            for options in choices(robot, term):
                settled = term.settled(robot, options)
                with np.errstate(all="ignore"):
                    rows = [interpret(robot, term, settled, [x[:n] for x in inputs]) for n in (3, 1)]
                label = " ".join([name, term.name, *map(str, options.values())])
                found[label] = [digest(b"".join(x.tobytes() for x in rows)), program(robot, term, settled)]
    return found


def choices(robot: Any, term: Any) -> list[dict[str, Any]]:
    """The options to compare: the last frame, each reference."""
    names = [x.name for x in term.options]
    frame = {"frame": robot.frames[-1].name} if "frame" in names else {}
    if "reference" not in names:
        return [frame]
    return [frame | {"reference": x} for x in ("world", "local", "local_world_aligned")]


def program(robot: Any, term: Any, options: Any) -> str:
    """A digest of the operations after fusion, and of the results."""
    from inspect import signature

    from dualpin.engine.graph.schedule import fused
    from dualpin.engine.graph.trace import UntraceableError, trace

    try:
        traced = trace(robot, term, options)
    except UntraceableError as e:
        return type(e).__name__
    nodes, order = traced.graph.nodes, traced.graph.live(traced.outputs)
    steps, named = fused(*(traced, order)[: len(signature(fused).parameters)]), dict[int, str]()
    for i in order:
        step, node = steps.get(i), nodes[i]
        if step is None and node[0] in ("in", "const"):
            named[i] = digest(repr(node).encode())
        elif step is None:  # a sine, or a product that became part of a sum
            named[i] = digest(repr((node[0], *commuted(node[0], [named[a] for a in node[1:]]))).encode())
        else:
            named[i] = digest(repr((step.op, step.signs, *commuted(step.op, [named[a] for a in step.args]))).encode())
    results = [named[x.i] if hasattr(x, "i") else repr(x) for x in traced.outputs]
    return digest(repr(results).encode())


def commuted(op: str, operands: list[str]) -> list[str]:
    """Factors and summands in one order; those of differences, and the sum of a product and a number, as they are."""
    if op in ("+", "*"):
        return sorted(operands)
    return [*sorted(operands[:2]), *operands[2:]] if op == "fma" else operands


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m validation.benchmarks.bits")
    parser.add_argument("--against", type=Path, required=True, help="a checkout of the other version")
    parser.add_argument("--robots", nargs="+", default=list(ROBOTS), help="names, with /floating or /mimic")
    given = parser.parse_args()
    both = []
    for root in (given.against.resolve(), HERE.parents[2]):
        command = [sys.executable, "-c", _ASKED.format(folder=str(HERE.parent), robots=given.robots)]
        env = {**os.environ, "PYTHONPATH": str(root)}
        both.append(json.loads(subprocess.run(command, env=env, cwd=root, check=True, stdout=subprocess.PIPE).stdout))
    before, now = both
    common = [key for key in now if key in before]
    for k, what in enumerate(("numpy", "program")):
        other = [key for key in common if before[key][k] != now[key][k]]
        print(f"{what}: {len(common) - len(other)} of {len(common)} are the same" + "".join(f"\n  {x}" for x in other))
    only = sorted(before.keys() ^ now.keys())
    print("of one version only: " + ", ".join(only) if only else "Both versions have the same terms.")
    return int(any(before[key] != now[key] for key in common))


_ASKED = """
import json, sys
sys.path.append({folder!r})
import bits
print(json.dumps(bits.digests({robots!r})))
"""

if __name__ == "__main__":
    sys.exit(main())
