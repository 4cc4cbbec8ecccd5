"""Results that need no oracle: made up, but shaped like real ones."""

from dualpin.crosscheck.results import Refusal, Report, RobotResult, TermResult

TERMS = ("fk", "rnea", "centroidal_momentum_matrix")


def term(error=1e-15, tolerance=1e-13, nv=3):
    state = {"q": [0.125] * nv, "v": [0.25] * nv, "a": [0.5] * nv}
    worst = {"sample": 7, "variant": 0, "ratio": error / tolerance, "entry": 1, "where": "row elbow", **state}
    quantiles = [error * x for x in (0.01, 0.1, 0.2, 0.4, 0.8, 1.0)]
    status = "agrees" if error <= tolerance else "differs"
    return TermResult(
        error, tolerance, compared=10, worst=worst, quantiles=quantiles, status=status,
        tolerance_reason="eps x 32 roundings",
    )  # fmt: skip


def robot(name, floating=False, mimic=False, **errors):
    terms = {t: term(errors.get(t, 1e-15)) for t in TERMS}
    passed = all(t.passed for t in terms.values())
    return RobotResult(name, floating, mimic, 3, 10, 0, passed, terms, [f"{name}: <inertia> & more"])


def report(*robots, refused=()):
    versions = {"dualpin": "0.1.0", "pinocchio": "4.1.0", "machine": "x86_64, a CPU", "date": "2026-01-01"}
    return Report(
        list(robots) or [robot("panda"), robot("panda", floating=True), robot("ur5")], list(refused), versions
    )


def failed():
    refused = [Refusal("mine.urdf", "no name", False), Refusal("b", "x", True)]
    return report(robot("panda"), robot("ur5", rnea=1e-3), refused=refused)


def speed(scale=1.0):
    """Rows as `dualpin bench --json` prints them."""
    rows = []
    for name, nv in (("panda", 9), ("ur5", 6), ("talos", 44), ("chain_20", 20), ("chain_60", 60)):
        for term_, cost in (("rnea", 0.006), ("crba", 0.004)):
            for batch in (1, 64, 4096):
                for threads in (1, 2):
                    us = scale * (cost * nv + 0.5 / batch) / threads
                    theirs = 0.02 * nv + 1.0 / batch
                    row = {"robot": name, "nv": nv, "term": term_, "batch": batch, "threads": threads}
                    rows.append({**row, "us_per_sample": us, "pinocchio_us_per_sample": theirs, "ratio": theirs / us})
    return {"rows": rows, "versions": {"pinocchio": "4.1.0"}, "machine": "a CPU"}


def integrators():
    """A study as `python -m validation.integrators` writes it."""
    rows = [
        {"method": m, "dt": dt, "position_peak": dt**p, "evaluations": int(10 / dt)}
        for m, p in (("euler", 1), ("rk4", 4))
        for dt in (0.01, 0.1, 1.0)
    ]
    drift = {
        "turns": 100,
        "euler": {"first": 1e-3, "by_turn": [1e-3, 2e-3]},
        "rk4": {"first": 1e-9, "by_turn": [1e-9, 2e-9]},
    }
    return {"header": {"cpu": "a CPU"}, "pa10": rows, "drift": drift}
