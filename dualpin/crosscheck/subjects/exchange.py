"""The exchange folder: what a program in any language reads and writes.

    robot.urdf         the robot, without meshes
    ask.json           format, floating, gravity, joints, frames, terms, samples, q, v
    states.csv         sample, q.<column>..., v.<column>..., a.<column>..., tau.<column>..., and where a term needs
                       it f_ext.nx ... f_ext.fz, a wrench that acts on each frame in turn
    answers/TERM.csv   what the program writes, with a header; columns in any order: names decide
    subject.json       optional: name, version, rows, angular, linear, reference, as in `Convention`

The columns of an answer are those of `header`, also in ask.json; numbers have 17 significant digits.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ArgumentError, nearest
from ...files import write_text, writing
from ...model.robot import Robot
from .answers import Answers, poses
from .asking import Asking
from .convention import BASE_V, WRENCH, Convention, columns, parameter_names
from .layout import Layout
from .questions import FRAMED, QUESTIONS

FORMAT = 1
POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
MATRIX = tuple(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
VECTORS = {"fk": POSE, "com": ("x", "y", "z"), "kinetic_energy": ("value",), "potential_energy": ("value",)}
"""Of terms that have no columns of v: the columns of their files."""


def axes(term: str, how: Convention, robot: Robot) -> tuple[dict[str, tuple[str, ...]], tuple[str, ...]]:
    """Of a term's file: the columns that name a place, each with its names; and those that hold numbers."""
    question = QUESTIONS[term]
    keys: dict[str, tuple[str, ...]] = {}
    if question.form == "derivatives":
        keys["by"] = ("q", *question.inputs[1:])  # v, and a or tau
    if question.form in ("six", "six_rate"):
        keys["row"] = how.rows
    elif question.form == "columns":
        keys["row"] = ("x", "y", "z")
    elif question.form in ("matrix", "inverse", "coriolis", "derivatives", "regressor"):
        keys["row"] = how.v
    if question.form == "twist":
        return keys, how.rows
    if question.form == "regressor":
        return keys, how.parameters or parameter_names(robot)
    return keys, VECTORS.get(term, how.v)


def header(term: str, how: Convention, robot: Robot) -> list[str]:
    """The columns of ``answers/TERM.csv``."""
    keys, entries = axes(term, how, robot)
    return ["sample", *(["frame"] if term in FRAMED else []), *keys, *entries]


def _inputs(asking: Asking) -> dict[str, tuple[str, ...]]:
    """The quantities of states.csv, with their columns."""
    q, v = columns(asking.robot)
    wrench = {"f_ext": WRENCH} if any(QUESTIONS[t].pushes for t in asking.terms) else {}
    return {"q": q, "v": v, "a": v, "tau": v, **wrench}


def write(asking: Asking, folder: Path, terms: Iterable[str] | None = None) -> None:
    """Everything a program needs to answer."""
    q, v = columns(asking.robot)
    terms = list(asking.terms if terms is None else terms)
    ask = {
        "format": FORMAT, "robot": asking.name, "floating": asking.floating, "mimic": asking.mimic,
        "gravity": list(asking.gravity), "joints": [j.name for j in asking.robot if j.name in v],
        "frames": list(asking.frames), "terms": terms, "samples": asking.samples, "seed": asking.seed,
        "q": list(q), "v": list(v),
        "answers": {t: ",".join(header(t, Convention(q, v), asking.robot)) for t in terms},
    }  # fmt: skip
    with writing(f"ask: cannot write into {folder}"):
        (folder / "answers").mkdir(parents=True, exist_ok=True)
        write_text(folder / "robot.urdf", asking.text)
        write_text(folder / "ask.json", json.dumps(ask, indent=1) + "\n")
        with (folder / "states.csv").open("w", newline="", encoding="utf-8") as f:
            out = csv.writer(f, lineterminator="\n")
            named = _inputs(asking)
            out.writerow(["sample", *(f"{k}.{n}" for k, names in named.items() for n in names)])
            for i in range(asking.samples):
                out.writerow([i, *(f"{x:.17g}" for k in named for x in asking.states[k][i])])


def asked(folder: Path) -> dict[str, Any]:
    """What ``ask.json`` says; an error where it is none."""
    try:
        ask = json.loads((folder / "ask.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as e:
        raise ArgumentError(f"judge: {folder / 'ask.json'} cannot be read ({e}); `dualpin ask` writes it") from None
    if not isinstance(ask, dict) or ask.get("format") != FORMAT:
        raise ArgumentError(
            f"judge: {folder / 'ask.json'} is of another format than {FORMAT}; write it anew with `dualpin ask`"
        )
    return ask


def with_states(asking: Asking, folder: Path) -> Asking:
    """The same robot at the states that were written into the folder, which must be of this robot."""
    ask, (q, v) = asked(folder), columns(asking.robot)
    for what, ours in (("q", q), ("v", v)):
        if list(ours) != ask.get(what):
            theirs = ask.get(what) or []
            odd = next((n for n in theirs if n not in ours), None) or next(
                (n for n in ours if n not in theirs), "the order"
            )
            raise ArgumentError(
                f"judge: {folder} was written for another robot than {asking.name}: {what} differs in {odd}"
            )
    terms = tuple(t for t in asking.terms if t in ask["terms"])
    asking = replace(asking, terms=terms, seed=int(ask.get("seed", asking.seed)))
    rows = _rows(folder / "states.csv")
    states = {
        k: np.array([[_number(r, f"{k}.{n}", folder / "states.csv") for n in names] for r in rows])
        for k, names in _inputs(asking).items()
    }
    return asking.at(states, tuple(ask["frames"]))


def read(asking: Asking, folder: Path, name: str = "") -> Answers:
    """The answers in a folder; what is missing or malformed is said of its term."""
    said = _subject(folder)
    who = {k: said.pop(k, "") for k in ("name", "version")}
    try:
        how = Convention.read(said, asking.robot)
        layout = Layout(asking.robot, how)
    except (ArgumentError, TypeError) as e:
        raise ArgumentError(f"judge: {folder / 'subject.json'}: {e}") from None
    sent = _as_sent(asking, how)
    asking = asking.at(layout.back(sent), asking.frames)
    answers = Answers(str(who["name"] or name or folder.name), str(who["version"]), how, asking, sent)
    for term in asking.terms:
        path = folder / "answers" / f"{term}.csv"
        if not path.exists():
            answers.silent[term] = "not offered"
            continue
        try:
            x, remark = _answer(term, path, answers)
        except ArgumentError as e:
            answers.silent[term] = str(e)
            continue
        if np.isnan(x).all():
            answers.silent[term] = remark or f"{path.name} holds no answers"
            continue
        answers.take(term, x, {})
        if remark:
            answers.remarks[term] = remark
    unknown = [p.stem for p in sorted((folder / "answers").glob("*.csv")) if p.stem not in QUESTIONS]
    if unknown:
        answers.remarks[""] = (
            f"answers/{unknown[0]}.csv is of no term; {nearest(unknown[0], QUESTIONS, 'terms', most=99)}"
        )
    return answers


def _as_sent(asking: Asking, how: Convention) -> dict[str, np.ndarray]:
    """The numbers of states.csv under the subject's own order: what they mean, its convention says."""
    q, v = columns(asking.robot)
    to_q, to_v = [q.index(n) for n in how.q], [v.index(n) for n in how.v]
    order = {"q": to_q, "f_ext": [BASE_V.index(r) for r in how.rows]}
    return {k: x[:, order.get(k, to_v)] for k, x in asking.states.items()}


def _subject(folder: Path) -> dict[str, Any]:
    path = folder / "subject.json"
    if not path.exists():
        return {}
    try:
        said = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as e:
        raise ArgumentError(f"judge: {path} is not JSON ({e})") from None
    if not isinstance(said, dict):
        raise ArgumentError(f"judge: {path} must hold one object, with name, version, rows, ...")
    return {
        k: said[k]
        for k in ("name", "version", "q", "v", "rows", "angular", "linear", "reference", "parameters")
        if k in said
    }


def _rows(path: Path) -> list[dict[str, str]]:
    try:
        with path.open(newline="", encoding="utf-8-sig") as f:
            lines = [line for line in f if line.strip()]
            between = next((c for c in ",;\t" if c in "".join(lines[:1])), ",")
            table = csv.DictReader(lines, delimiter=between, skipinitialspace=True)
            names = [(n or "").strip() for n in table.fieldnames or ()]
            return [{k: (x or "").strip() for k, x in zip(names, row.values(), strict=False)} for row in table]
    except (OSError, UnicodeError, csv.Error) as e:
        raise ArgumentError(f"{path.name} cannot be read ({e})") from None


def _number(row: dict[str, str], name: str, path: Path) -> float:
    try:
        # Fortran's 1.0D-3; and 0,5 between semicolons, as some countries write it
        x = float(row[name].upper().replace("D", "E").replace(",", "."))
        return float("inf") if x != x else x  # not a number is an answer too, and a wrong one
    except KeyError:
        raise ArgumentError(f"{path.name} has no column {name!r}; {nearest(name, row, 'columns', most=40)}") from None
    except ValueError:
        raise ArgumentError(f"{path.name}: {name} is {row[name]!r}, a number expected") from None


def _answer(term: str, path: Path, answers: Answers) -> tuple[np.ndarray, str]:
    """One file of answers, in the subject's order; rows that were cut off are left out and said."""
    asking = answers.asking
    rows = _rows(path)
    wanted = ",".join(header(term, answers.how, asking.robot))
    if not rows:
        raise ArgumentError(f"{path.name} is empty; a header {wanted} and rows expected")
    keys, entries = axes(term, answers.how, asking.robot)
    if term == "fk" and "qw" not in rows[0]:
        entries = ("x", "y", "z", *MATRIX)
    if term in FRAMED:
        keys = {"frame": asking.frames, **keys}
    lead = [asking.samples, *map(len, keys.values())]
    x = np.full((*lead, len(entries)), np.nan)
    cut = twice = 0
    for row in rows:
        if any(not row.get(n) for n in entries):
            lacks = next((n for n in entries if n not in row), None)
            if lacks is not None:
                raise ArgumentError(f"{path.name} has no column {lacks!r}; {wanted} expected, not {','.join(row)}")
            cut += 1
            continue
        at = [_sample(row, path, asking.samples)]
        at += [_place(row, key, names, path) for key, names in keys.items()]
        numbers = [_number(row, n, path) for n in entries]
        before = x[tuple(at)]
        twice += not np.isnan(before).all() and not np.array_equal(before, numbers)
        x[tuple(at)] = numbers
    if term == "fk":
        x = poses(x) if len(entries) == len(POSE) else _from_entries(x)
    if entries == ("value",):
        x = x[..., 0]
    missing = int(np.isnan(x.reshape(asking.samples, -1)).any(axis=1).sum())
    remarks = []
    if missing or cut:
        remarks.append(f"{path.name} holds {asking.samples - missing} of {asking.samples} samples whole")
    if twice:
        remarks.append(f"{path.name} answers {twice} places twice, and otherwise the second time, which counts")
    return x, "; ".join(remarks)


def _from_entries(x: np.ndarray) -> np.ndarray:
    H = np.zeros((*x.shape[:-1], 4, 4))
    H[..., :3, :3], H[..., :3, 3], H[..., 3, 3] = x[..., 3:].reshape(*x.shape[:-1], 3, 3), x[..., :3], 1.0
    H[np.isnan(x).any(axis=-1)] = np.nan
    return H


def _sample(row: dict[str, str], path: Path, n: int) -> int:
    k = _number(row, "sample", path)
    if k != int(k) or not 0 <= k < n:
        raise ArgumentError(f"{path.name}: sample {row['sample']} is none of 0 ... {n - 1}")
    return int(k)


def _place(row: dict[str, str], what: str, names: Sequence[str], path: Path) -> int:
    name = row.get(what)
    if name is None:
        raise ArgumentError(f"{path.name} has no column {what!r}")
    if name not in names:
        raise ArgumentError(f"{path.name}: {what} {name!r} is not known; {nearest(name, names, what + 's', most=40)}")
    return list(names).index(name)
