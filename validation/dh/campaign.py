"""Every root-to-leaf chain of every robot of example-robot-data, as DH tables and as screws, against Pinocchio.

    python validation/dh/campaign.py [--samples 100] [--seed 0]

For each chain: the standard and the modified table and the product of exponentials are evaluated on
random coordinates (angles in [-pi, pi], lengths in [-1, 1] m, limits left aside) and compared with
Pinocchio's pose of the leaf link, entry by entry.  Writes chains.csv, results.json and README.md here.
"""

from __future__ import annotations

import argparse
import csv
import json
import platform
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import dualpin as dp
from dualpin.crosscheck.oracles.pinocchio import OracleError, Pinocchio
from dualpin.files import replacing, write_text
from dualpin.forms.chain import chain, leaves

HERE = Path(__file__).parent
# 1e-12 for matrix entries and metres: a product of up to 40 rotations, each within an eps, times metres, gives
# some 1e-14; nearly parallel axes just above the threshold of 0.02 lose 1/0.02 of it
TOLERANCE = 1e-12
LONGEST = 2.0  # m; no robot here has a longer link, so a longer d comes from the method
FORMS = ("standard", "modified", "screws")


def robots(mimic: bool) -> Any:
    """(name, robot, Pinocchio's model) of every file that both read; with mimic, those that have any."""
    for name, path in dp.io.catalogue().items():
        try:
            robot = dp.load(path, mimic=mimic)
            if mimic and not robot.coupled:
                continue
            yield name, robot, Pinocchio.of_file(robot, str(path), floating=False)
        except (dp.UrdfError, OracleError) as e:
            if not mimic:
                yield name, None, str(e).splitlines()[0]


def examine(robot: dp.Robot, oracle: Pinocchio, leaf: Any, samples: int, seed: int) -> dict[str, Any] | None:
    """Errors, longest d, fixed rows and time of one chain; None if nothing moves on it."""
    links = chain(robot, None, leaf)
    if not links.axes:
        return None
    q = links.sample(samples, seed)
    (truth,) = oracle.compute("frame_pose", {"q": q}, [{"frame": leaf}])
    out: dict[str, Any] = {"leaf": leaf.name, "joints": "".join(a.letter for a in links.axes)}
    for form in FORMS:
        start = time.perf_counter()
        made = dp.to_screws(robot, leaf) if form == "screws" else dp.to_dh(robot, None, leaf, form)
        out[f"{form}_ms"] = round(1e3 * (time.perf_counter() - start), 3)
        out[f"{form}_error"] = float(np.abs(made.fk(q, engine="numpy") - truth).max())
        if form != "screws":
            steps = (*made.base.steps, *made.rows, *made.tool.steps)
            out[f"{form}_d"] = max(abs(s.d) for s in steps)
            out[f"{form}_fixed_rows"] = sum(r.letter == "F" for r in made.rows)
    return out


def run(samples: int, seed: int) -> dict[str, Any]:
    """All chains; the result as written to results.json, with the chains."""
    chains: list[dict[str, Any]] = []
    refused: list[dict[str, str]] = []
    count = 0
    for mimic in (False, True):
        for name, robot, oracle in robots(mimic):
            if robot is None:
                refused.append({"robot": name, "reason": oracle})
                continue
            count += not mimic
            for leaf in leaves(robot):
                found = examine(robot, oracle, leaf, samples, seed)
                if found is not None:
                    chains.append({"robot": name, "mimic": mimic, **found})
    worst = {form: max(chains, key=lambda c, f=form: c[f"{f}_error"]) for form in FORMS}
    summary = {
        "robots": count,
        "chains": sum(not c["mimic"] for c in chains),
        "chains_with_mimic": sum(c["mimic"] for c in chains),
        "samples": samples,
        "seed": seed,
        "tolerance": TOLERANCE,
        "max_error": {form: worst[form][f"{form}_error"] for form in FORMS},
        "worst": {form: f"{worst[form]['robot']}: {worst[form]['leaf']}" for form in FORMS},
        "max_abs_d": max(c[f"{form}_d"] for c in chains for form in FORMS[:2]),
        "fixed_rows": {
            str(k): sum(c["standard_fixed_rows"] == k for c in chains)
            for k in sorted({c["standard_fixed_rows"] for c in chains})
        },
        "seconds_to_convert": {form: round(sum(c[f"{form}_ms"] for c in chains) / 1e3, 2) for form in FORMS},
        "refused": refused,
        "versions": {"python": platform.python_version(), "numpy": np.__version__, "dualpin": dp.__version__},
    }
    summary["passed"] = max(summary["max_error"].values()) <= TOLERANCE and summary["max_abs_d"] < LONGEST
    return {"summary": summary, "chains": chains}


def write(result: dict[str, Any]) -> None:
    """results.json, chains.csv and README.md beside this script."""
    s, chains = result["summary"], result["chains"]
    import pinocchio

    s["versions"]["pinocchio"] = str(pinocchio.__version__)
    write_text(HERE / "results.json", json.dumps(s, indent=2) + "\n")
    keys = [k for k in chains[0] if not k.endswith("_ms")]
    with replacing(HERE / "chains.csv") as beside, beside.open("w", newline="", encoding="utf-8") as f:
        writer = csv.DictWriter(f, keys, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows({k: f"{v:.3g}" if isinstance(v, float) else v for k, v in c.items()} for c in chains)
    rows = "\n".join(f"| {form} | {s['max_error'][form]:.2g} | {s['worst'][form]} |" for form in FORMS)
    refused = "\n".join(f"- `{r['robot']}`: {r['reason']}" for r in s["refused"])
    fixed = ", ".join(f"{n} with {k}" for k, n in s["fixed_rows"].items())
    text = f"""# Denavit-Hartenberg tables and screws of every chain, against Pinocchio

Written by `python validation/dh/campaign.py --samples {s["samples"]} --seed {s["seed"]}`.
`chains.csv` has one line a chain.

{s["robots"]} robots of example-robot-data, {s["chains"]} root-to-leaf chains with at least one moving joint, and
{s["chains_with_mimic"]} more with mimic joints coupled; {s["samples"]} random q each.
**{"Passed" if s["passed"] else "FAILED"}**: largest entry of abs(T - T_pinocchio) at most {s["tolerance"]:g},
and abs(d) below {LONGEST:g} m.

| form | max error | worst chain |
|---|---|---|
{rows}

- Largest abs(d): {s["max_abs_d"]:.4g} m.
- Chains by number of fixed rows between nearly parallel axes: {fixed}.
- Files that are not compared:
{refused}

Versions: {", ".join(f"{k} {v}" for k, v in s["versions"].items())}.
"""
    write_text(HERE / "README.md", text)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    warnings.simplefilter("ignore", dp.DualpinWarning)
    result = run(given.samples, given.seed)
    write(result)
    print(json.dumps(result["summary"], indent=2))
    raise SystemExit(0 if result["summary"]["passed"] else 1)


if __name__ == "__main__":
    main()
