"""Ask a subject, term by term.  Runs in the subject's own process and environment: NumPy is all it needs.

    python serve.py FOLDER SPEC

SPEC is ``module:attribute`` or ``path/to/file.py:attribute``, optionally followed by ``:option``, or the file
of a pickled object.  The attribute is a class (made with what its signature asks for among urdf, floating,
gravity, option), an object with terms as methods, or a mapping of terms to functions.

What passes through FOLDER:

    ask.json       what is asked (see `dualpin.crosscheck.subjects.exchange`)
    subject.json   written first: name, version, and how the subject writes
    states.npz     its q, v, a, tau, in its own columns; they are there when a line arrives on stdin
    now.json       the term being asked, to which a crash is attributed
    answers/T.npy  the answers of a term, on disk before the next begins
    later.json     terms that answer their first state otherwise once all terms were asked, and how far off
    notes.json     of each term: seconds, what was not answered and why, whether it depends on its history
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import json
import pickle
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

ASKED_AGAIN = 1e-9
"""The same state asked twice: a scaled difference above this is a dependence on what was asked between."""
LEAST = 2  # states that even the slowest subject is asked


def interview(
    subject: Any,
    term: str,
    given: list[np.ndarray],
    frames: list[str] | None,
    seconds: float = 20.0,
) -> tuple[np.ndarray | None, dict[str, Any]]:
    """The answers of a term (n, ...) or (n, frames, ...), not-a-number where there is none, and notes.

    A subject so slow that all states would take longer than `seconds` is asked fewer of them.
    """
    f = function(subject, term)
    if f is None:
        return None, {"absent": True}
    if frames == []:
        return None, {"absent": True, "errors": {"": "not offered: the robot has no link besides its root"}}
    n, start = len(given[0]), time.perf_counter()
    note: dict[str, Any] = {}
    asked = frames if frames is not None else [None]
    if getattr(subject, "batched", False):
        answers = [_tried(f, given, frame, note, n) for frame in asked]
        rows = [[None if a is None else a[k] for a in answers] for k in range(n)]
    else:
        rows = []
        for k in range(n):
            if k >= LEAST and time.perf_counter() - start > seconds:
                note["states"] = k
                break
            rows.append([_tried(f, [x[k] for x in given], frame, note) for frame in asked])
    whole = _stacked(rows, n, note)
    if whole is not None and n > 1 and rows[0][0] is not None:
        history = _again(f, given, asked[0], rows[0][0], getattr(subject, "batched", False))
        if history is not None:
            note["history"] = history
    note["seconds"] = round(time.perf_counter() - start, 6)
    return (None if whole is None else whole if frames is not None else whole[:, 0]), note


def function(subject: Any, term: str) -> Any:
    """A subject's function for a term, or None."""
    f = subject.get(term) if isinstance(subject, dict) else getattr(subject, term, None)
    return f if callable(f) else None


def _tried(f: Any, state: list[np.ndarray], frame: str | None, note: dict[str, Any], n: int = 0) -> np.ndarray | None:
    """One call; whatever goes wrong is noted, not raised."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            answer = f(*(s.copy() for s in state), *([] if frame is None else [frame]))
        if answer is None:
            raise ValueError("None returned")
        if np.iscomplexobj(answer) and np.any(np.imag(answer)):
            raise ValueError("complex numbers")
        x = np.array(answer, dtype=float)
        x[np.isnan(x)] = np.inf  # not a number is an answer too, and a wrong one; what is not answered is nan
        if n and (x.ndim == 0 or len(x) != n):
            raise ValueError(f"a leading axis of {n} expected of a batched subject, got shape {x.shape}")
    except NotImplementedError as e:
        note["absent"] = True
        note.setdefault("errors", {})[frame or ""] = f"not offered{': ' if str(e) else ''}{e}"[:300]
        return None
    except (Exception, SystemExit) as e:  # whatever a subject raises is its answer, and so is its exit()
        note.setdefault("errors", {})[frame or ""] = f"{type(e).__name__}: {e}"[:300]
        return None
    return x


def _stacked(rows: list[list[Any]], n: int, note: dict[str, Any]) -> np.ndarray | None:
    """All answers in one array, not-a-number where there is none; None where there is none at all."""
    shapes = {x.shape for row in rows for x in row if x is not None}
    if not shapes:
        return None
    if len(shapes) > 1:
        note.setdefault("errors", {})[""] = f"answers of different shapes: {sorted(shapes)}"
        return None
    empty = np.full(shapes.pop(), np.nan)
    width = len(rows[0])
    rows = rows + [[None] * width] * (n - len(rows))
    return np.array([[empty if x is None else x for x in row] for row in rows])


def _again(
    f: Any, given: list[np.ndarray], frame: str | None, before: np.ndarray, batched: bool, at: int = 0
) -> float | None:
    """The state `at` asked again after others: how far the two answers are apart, if they are."""
    note: dict[str, Any] = {}
    state = given if batched else [x[at] for x in given]
    again = _tried(f, state, frame, note, len(given[0]) if batched else 0)
    again = again[at] if batched and again is not None else again
    if again is None or again.shape != before.shape:
        return float("inf")
    with np.errstate(invalid="ignore"):
        apart = np.where(again == before, 0.0, np.abs(again - before))
        scaled = float(apart.max(initial=0.0) / max(1.0, np.abs(before).max(initial=0.0)))
    return scaled if scaled > ASKED_AGAIN else None


def load(spec: str, urdf: str, floating: bool, gravity: list[float]) -> Any:
    """The subject that ``module:attribute`` or ``file.py:attribute`` names."""
    if spec.endswith(".pkl"):
        return pickle.loads(Path(spec).read_bytes())  # written by the process that started this one
    where, _, rest = spec.partition(":")
    name, _, option = rest.partition(":")
    if where.endswith(".py"):
        path = Path(where).resolve()
        sys.path.append(str(path.parent))  # last: a file named as the library that it imports must not hide it
        made = importlib.util.spec_from_file_location(f"subject_{path.stem}", path)
        if made is None or made.loader is None:
            raise ImportError(f"{where} is no Python file")
        module = importlib.util.module_from_spec(made)
        sys.modules[module.__name__] = module
        made.loader.exec_module(module)
        same = importlib.util.find_spec(path.stem)
        if same is not None and same.origin == str(path):  # the library is not there: its adapter is no stand-in
            sys.path.remove(str(path.parent))
    else:
        sys.path.insert(0, "")
        module = importlib.import_module(where)
    name = name or "Subject"
    if not hasattr(module, name):
        named = ", ".join(sorted(k for k, x in vars(module).items() if k[:1] != "_" and not inspect.ismodule(x)))
        raise ImportError(f"{where} has no {name!r}; it has {named or 'no names'}")
    found = getattr(module, name)
    if not inspect.isclass(found):
        return found
    offered = {"urdf": urdf, "floating": floating, "gravity": gravity, "option": option}
    wants = inspect.signature(found).parameters
    open_ended = inspect.Parameter.VAR_KEYWORD in {p.kind for p in wants.values()}
    given = {k: x for k, x in offered.items() if open_ended or k in wants}
    try:
        inspect.signature(found).bind(**given)
    except TypeError as e:
        raise ImportError(f"{where}:{name}: {e}; a class is constructed with those of {', '.join(offered)}") from e
    return found(**given)


def asked_later(
    subject: Any, given: dict[str, list[np.ndarray]], framed: dict[str, str], answers: dict[str, np.ndarray]
) -> dict[str, float]:
    """The last state of every term asked once more, after all other terms: where it is answered otherwise, how far.

    The first one was asked again at the end of each term, so what a subject keeps between calls may belong to it.
    `framed` holds, of terms of frames, the frame asked.
    """
    batched, found = getattr(subject, "batched", False), {}
    for term, x in answers.items():
        frame = framed.get(term)
        one = x if frame is None else x[:, 0]
        whole = np.flatnonzero(~np.isnan(one).reshape(len(one), -1).any(axis=1))
        if len(whole):
            at = int(whole[-1])
            apart = _again(function(subject, term), given[term], frame, one[at], batched, at)
            if apart is not None:
                found[term] = apart
    return found


def kind(subject: Any) -> str:
    """What an object is called that does not say its name."""
    return "mapping" if isinstance(subject, dict) else type(subject).__name__


def introduction(subject: Any, spec: str) -> dict[str, Any]:
    """Who the subject is and how it writes, as plain data."""
    get = subject.get if isinstance(subject, dict) else lambda k, d=None: getattr(subject, k, d)
    writes = get("writes") or {}
    if not isinstance(writes, dict):
        words = ("q", "v", "rows", "angular", "linear", "reference", "parameters")
        writes = {k: getattr(writes, k) for k in words if hasattr(writes, k)}
    writes = {k: list(x) if isinstance(x, (list, tuple)) else x for k, x in writes.items()}
    return {
        "name": str(get("name") or spec),
        "version": str(get("version") or ""),
        "writes": writes,
        "calls": dict(get("calls") or {}),
    }


def write(path: Path, data: Any) -> None:
    """Whole or not at all: a reader never sees half a file."""
    new = path.with_suffix(".new")
    new.write_text(json.dumps(data, indent=1), encoding="utf-8")
    new.replace(path)


def main(folder: Path, spec: str) -> None:
    ask = json.loads((folder / "ask.json").read_text(encoding="utf-8"))
    start = time.perf_counter()
    sys.path += [x for x in ask.get("path", []) if x not in sys.path]
    subject = load(spec, str(folder / "robot.urdf"), ask["floating"], ask["gravity"])
    name = kind(subject) if spec.endswith(".pkl") else spec
    write(folder / "subject.json", introduction(subject, name) | {"load_s": round(time.perf_counter() - start, 3)})
    if not sys.stdin.readline():
        return  # the parent has closed the pipe
    ask = json.loads((folder / "ask.json").read_text(encoding="utf-8"))  # some terms may be known from before
    inputs, frames = ask["inputs"], ask["frames"]
    given = dict(np.load(folder / "states.npz"))
    (folder / "answers").mkdir(exist_ok=True)
    notes: dict[str, Any] = {}
    answered: dict[str, np.ndarray] = {}
    asked = {term: [given[k] for k in inputs[term] if k != "frame"] for term in ask["terms"]}
    for term in ask["terms"]:
        write(folder / "now.json", {"term": term})
        framed = inputs[term][-1] == "frame"
        answers, notes[term] = interview(subject, term, asked[term], frames if framed else None, ask["seconds"])
        if answers is not None:
            np.save(folder / "answers" / f"{term}.npy", answers)
            answered[term] = answers
        write(folder / "notes.json", notes)
    framed_terms = {t: frames[0] for t in answered if inputs[t][-1] == "frame"}
    write(folder / "later.json", asked_later(subject, asked, framed_terms, answered))
    (folder / "now.json").unlink(missing_ok=True)


if __name__ == "__main__":
    sys.path.pop(0)  # this file's folder must not be searched for modules
    main(Path(sys.argv[1]), sys.argv[2])
