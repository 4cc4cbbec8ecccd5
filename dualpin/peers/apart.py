"""The server in a peer's environment: creates the peer, computes and measures on request.  It needs only NumPy.

    python apart.py ADAPTER FOLDER

FOLDER has robot.urdf, model.npz, and states.npz with q, v, a in the robot's order.  Requests and answers are
lines of JSON:

    {"do": "check", "term": T, "one": B}             the results, in FOLDER/answer.npy
    {"do": "time", "term": T, "one": B, "times": n}  seconds of so many runs over the states
"""

from __future__ import annotations

import importlib.util
import json
import os
import sys
import time
import traceback
from pathlib import Path
from typing import Any

import numpy as np

ONE, PATIENCE = 64, 0.3
"""States of the loop over single calls; fewer where they would take longer than so many seconds, but two."""


class Peer:
    """What an adapter made, with states in its own order."""

    def __init__(self, made: dict[str, Any], folder: Path) -> None:
        self.made, self.folder = made, folder
        states = np.load(folder / "states.npz")
        names = states["joints"].tolist()
        theirs = list(made["joints"])
        if sorted(names) != sorted(theirs):
            raise ValueError(f"joints {', '.join(theirs)} where {', '.join(names)} were expected")
        order = [names.index(x) for x in theirs]
        self.back = np.argsort(order)
        self.states = [np.ascontiguousarray(states[k][:, order]) for k in "qva"]
        self.few = [np.ascontiguousarray(x[:ONE]) for x in self.states]
        self.counts: dict[str, int] = {}
        self.rows = [tuple(np.ascontiguousarray(x) for x in row) for row in zip(*self.few)]  # noqa: B905 - Python 3.9

    def terms(self) -> dict[str, dict[str, str]]:
        """What is offered: term -> how one and many states are computed."""
        found = {}
        for term in {*self.made.get("single", {}), *self.made.get("each", {})}:
            each, batch = self.made.get("each", {}), self.made.get("batch", {})
            how = self.made.get("how", "")
            many = how if term in each or term in batch else "Python loop"
            found[term] = {"one": how if term in each else "Python call", "many": many}
        return found

    def check(self, term: str, one: bool) -> np.ndarray:
        made, states = self.made, self.few if one else self.states
        if term in made.get("each", {}):
            result = made["each"][term][0](*states)
        elif not one and term in made.get("batch", {}):
            result = made["batch"][term](*states)
        else:
            f = made.get("checked", {}).get(term) or made["single"][term]
            result = np.array([np.array(f(*row), dtype=float) for row in self.limited(term)])
        return self.ordered(term, np.asarray(result, dtype=float))

    def limited(self, term: str) -> list[tuple[np.ndarray, ...]]:
        """The states that fit into the time limit."""
        if term not in self.counts:
            f = self.made["single"][term]
            f(*self.rows[0])
            start = time.perf_counter()
            f(*self.rows[1])
            self.counts[term] = max(2, min(ONE, int(PATIENCE / max(time.perf_counter() - start, 1e-9))))
        return self.rows[: self.counts[term]]

    def ordered(self, term: str, x: np.ndarray) -> np.ndarray:
        """In the robot's order of joints."""
        axes = {"rnea": (-1,), "aba": (-1,), "fk": (-3,), "rnea_second_derivatives": (-1, -2, -3)}
        for axis in axes.get(term, (-1, -2)):
            x = np.take(x, self.back, axis)
        return x

    def time(self, term: str, one: bool, times: int) -> float:
        """Seconds of so many runs over the states, `ONE` of them or all, after one that fills the caches."""
        made, states = self.made, self.few if one else self.states
        if term in made.get("each", {}):
            f = made["each"][term][1]
            f(*states, 1)
            start = time.perf_counter()
            f(*states, times)
            return time.perf_counter() - start
        if not one and term in made.get("batch", {}):
            f = made["batch"][term]
            f(*states)
            start = time.perf_counter()
            for _ in range(times):
                f(*states)
            return time.perf_counter() - start
        f, rows = made["single"][term], self.limited(term)
        for row in rows:
            f(*row)
        start = time.perf_counter()
        for _ in range(times):
            for q, v, a in rows:
                f(q, v, a)
        return time.perf_counter() - start


def answered(peer: Peer, asked: dict[str, Any]) -> dict[str, Any]:
    term, one = asked["term"], asked["one"]
    if asked["do"] == "check":
        np.save(peer.folder / "answer.npy", peer.check(term, one))
        return {}
    seconds = peer.time(term, one, asked["times"])
    looped = term not in peer.made.get("each", {}) and (one or term not in peer.made.get("batch", {}))
    return {
        "seconds": seconds,
        "samples": len(peer.limited(term)) if looped else len(peer.few[0] if one else peer.states[0]),
    }


def main(adapter: Path, folder: Path) -> None:
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # output of libraries must not mix with answers
    sys.path[0] = str(adapter.parent)
    try:
        spec = importlib.util.spec_from_file_location(f"adapter_{adapter.stem}", adapter)
        module = importlib.util.module_from_spec(spec)  # type: ignore[arg-type]
        # the adapter's folder holds files with the libraries' names: they must not be found in their place
        sys.path.pop(0)
        sys.path.append(str(adapter.parent))
        spec.loader.exec_module(module)  # type: ignore[union-attr]
        peer = Peer(module.made(folder), folder)
        first: dict[str, Any] = {
            "version": str(peer.made["version"]),
            "terms": peer.terms(),
            "gravity": peer.made.get("gravity"),
        }
    except Exception as e:
        traceback.print_exc()
        first = {"refused": f"{type(e).__name__}: {e}"}
    print(json.dumps(first), file=out, flush=True)
    for line in sys.stdin:
        try:
            answer = answered(peer, json.loads(line))
        except Exception as e:
            traceback.print_exc()
            answer = {"error": f"{type(e).__name__}: {e}"}
        print(json.dumps(answer), file=out, flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
