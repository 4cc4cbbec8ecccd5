"""Ask a subject: an object here, or a program in a process of its own that may crash, hang or refuse."""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ArgumentError, DualpinError, nearest
from .answers import Answers
from .apart import serve
from .asking import Asking
from .convention import Convention, columns
from .environments import ADAPTERS
from .kept import Kept
from .layout import Layout
from .questions import FRAMED, QUESTIONS

SECONDS = 20.0
"""What all states of one term may take before a slow subject is asked fewer of them."""
LOADING = 120.0
"""What a subject may take to start: libraries of a gigabyte are imported."""
PICKLED = "object.pkl"
DIED = re.compile("crashed|no answer within")
IN_PROCESS = "asked in this process, since it cannot be sent to another: a crash or a hang would be its own"
_WARNED = re.compile(r"^\S+:\d+: \w*Warning: ")
"""A warning says nothing of an end, nor does the line of the source under it, which is indented."""
_RAISED = re.compile(r"[\w.]*(Error|Exception): ")
_COLOUR = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")
Tick = Callable[[str], None]


def prepared(asking: Asking, said: Mapping[str, Any], name: str) -> tuple[Asking, Convention, str]:
    """The robot as far as the subject knows it, how it writes, and a remark on what it does not know."""
    how = said if isinstance(said, Convention) else Convention.read(said, asking.robot)
    q, v = columns(asking.robot)
    known = [n for n in q if n in how.q]
    missing = [n for n in q if n not in how.q and n in v]
    if known and missing and len(missing) == len(q) - len(known) and set(missing) == set(v) - set(how.v):
        asking = asking.holding(missing)
        remark = f"{name} has no {', '.join(missing)}: held at zero"
        return asking, how, remark
    return asking, how, ""


def ask_object(subject: Any, asking: Asking, tick: Tick, limit: float = 60.0) -> Answers:
    """An object with terms as methods, or a mapping of functions: in a process of its own if it can be sent there."""
    _check_terms(subject)
    try:
        data = pickle.dumps(subject)
    except Exception:  # whatever its own reduction raises: it stays here
        return ask_here(subject, asking, tick)
    with tempfile.TemporaryDirectory() as at:
        path = Path(at) / PICKLED
        path.write_bytes(data)
        answers = ask_apart(str(path), asking, tick, limit=limit)
    if answers.refused and not DIED.match(answers.refused):  # there it cannot be put together again
        return ask_here(subject, asking, tick)
    return answers


def ask_here(subject: Any, asking: Asking, tick: Tick) -> Answers:
    """An object in this process."""
    who = serve.introduction(subject, serve.kind(subject))
    asking, how, remark = prepared(asking, who["writes"], who["name"])
    answers = _begun(who, how, asking, "; ".join(x for x in (remark, IN_PROCESS) if x))
    start, asked, raw = time.perf_counter(), {}, {}
    for term in asking.terms:
        tick(term)
        question = QUESTIONS[term]
        given = [answers.sent[k] for k in question.inputs]
        frames = list(asking.frames) if question.framed else None
        asked[term] = given
        x, note = serve.interview(subject, term, given, frames, SECONDS)
        answers.take(term, x, note)
        if x is not None:
            raw[term] = x  # as it came: poses may be quaternions
    framed = {t: asking.frames[0] for t in raw if QUESTIONS[t].framed}
    answers.later(serve.asked_later(subject, asked, framed, raw))
    answers.seconds = time.perf_counter() - start
    return answers


def _begun(who: Mapping[str, Any], how: Convention, asking: Asking, remark: str = "") -> Answers:
    sent = Layout(asking.robot, how).states(asking.states)
    answers = Answers(who["name"], who["version"], how, asking, sent, calls=dict(who.get("calls", {})))
    if remark:
        answers.remarks[""] = remark
    return answers


def _check_terms(subject: Any) -> None:
    if isinstance(subject, Mapping):
        others = {"name", "version", "writes", "batched"}
        for key, f in subject.items():
            if key not in QUESTIONS and key not in others:
                raise ArgumentError(f"judge: {key!r} is no term; {nearest(str(key), QUESTIONS, 'terms', most=99)}")
            if key in QUESTIONS and not callable(f):
                raise ArgumentError(f"judge: {key} must be a function, got {type(f).__name__}")
    writes = subject.get("writes") if isinstance(subject, Mapping) else getattr(subject, "writes", None)
    if writes is not None and not isinstance(writes, (Convention, Mapping)):
        raise ArgumentError(f"judge: `writes` must be a Convention, or a mapping of its words; got {writes!r}")
    if not any(serve.function(subject, t) for t in QUESTIONS):
        raise ArgumentError(
            f"judge: {type(subject).__name__} has none of the terms {', '.join(QUESTIONS)} as a method; a subject is a "
            "shipped name, module:attribute, an object, a mapping of functions, an exchange folder or a command"
        )


# --- a process of its own ------------------------------------------------------------------------


def ask_apart(
    spec: str, asking: Asking, tick: Tick, *, python: str = sys.executable, limit: float = 60.0,
    kept: Kept | None = None,
) -> Answers:  # fmt: skip
    """``module:attribute`` in a process of its own; one that dies is started again without the term it died in."""
    with tempfile.TemporaryDirectory() as at:
        folder, start = Path(at), time.perf_counter()
        child = _Child(spec, folder, asking, python, limit)
        try:
            answers = child.introduced()
            if not answers.refused:
                child.asked(answers, tick, kept or Kept())
        finally:
            stop(child.process)  # also where the user interrupts
        answers.seconds = time.perf_counter() - start
        return answers


def refusal_apart(spec: str, asking: Asking, seconds: float, *, python: str = sys.executable) -> str:
    """Why a subject does not read this robot; empty if it does.  It is made, and asked nothing."""
    with tempfile.TemporaryDirectory() as at:
        child = _Child(spec, Path(at), asking, python, seconds, loading=min(seconds, LOADING))
        try:
            return child.introduced().refused
        finally:
            stop(child.process)


class _Child:
    """The process that asks one subject; `loading` and `limit` are seconds for its start and for each term."""

    def __init__(
        self, spec: str, folder: Path, asking: Asking, python: str, limit: float, loading: float = LOADING
    ) -> None:
        self.spec, self.folder, self.asking, self.python, self.limit = spec, folder, asking, python, limit
        self.loading = loading
        self.log = folder / "log.txt"
        self._write_ask(asking.terms)
        self.process = self._started()

    def _write_ask(self, terms: tuple[str, ...] | list[str]) -> None:
        a = self.asking
        (self.folder / "robot.urdf").write_text(a.text, encoding="utf-8")
        inputs = {t: [*QUESTIONS[t].inputs, *(["frame"] if t in FRAMED else [])] for t in terms}
        ask = {
            "floating": a.floating, "gravity": a.gravity, "frames": list(a.frames), "terms": list(terms),
            "inputs": inputs, "seconds": SECONDS, "samples": a.samples,
            "path": sys.path if self.spec.endswith(PICKLED) else [],
        }  # fmt: skip
        (self.folder / "ask.json").write_text(json.dumps(ask), encoding="utf-8")

    def _started(self) -> subprocess.Popen:
        (self.folder / "subject.json").unlink(missing_ok=True)
        (self.folder / "now.json").unlink(missing_ok=True)
        python = str(Path(self.python).absolute()) if os.sep in self.python else self.python
        words = [python, serve.__file__, str(self.folder), self.spec]
        # files that a library writes, a log say, go to a temporary folder; a user's own module needs the user's folder
        where = self.folder if self.spec.startswith(str(ADAPTERS)) else None
        with self.log.open("ab") as log:
            try:
                return subprocess.Popen(
                    words, stdin=subprocess.PIPE, stdout=log, stderr=log, cwd=where, start_new_session=True
                )
            except OSError as e:
                raise ArgumentError(f"judge: python {self.python!r} cannot be started ({e.strerror or e})") from None

    def _waited(self, done: Callable[[], bool], since: Callable[[], float], limit: float) -> str:
        """Until `done`, the process ends, or `limit` seconds have passed since `since`; what went wrong."""
        pause = 0.002
        while not done():
            code = self.process.poll()
            if code is not None:
                return "" if done() or code == 0 else ended(code, self.log)
            if time.time() - since() > limit:
                stop(self.process)
                return f"no answer within {limit:g} s"
            time.sleep(pause)
            pause = min(2 * pause, 0.05)
        return ""

    def introduced(self) -> Answers:
        """Who the subject says it is; or why it does not even start."""
        path, start = self.folder / "subject.json", time.time()
        wrong = self._waited(path.exists, lambda: start, self.loading)
        name = self.spec.rpartition("/")[2]
        if not path.exists():
            answers = Answers(name, "", Convention.of(self.asking.robot), self.asking, {})
            answers.refused = wrong or ended(0, self.log)
            stop(self.process)
            return answers
        who = json.loads(path.read_text(encoding="utf-8"))
        try:
            self.asking, how, remark = prepared(self.asking, who["writes"], who["name"])
            answers = _begun(who, how, self.asking, remark)
        except DualpinError as e:
            stop(self.process)
            answers = Answers(who["name"], who["version"], Convention.of(self.asking.robot), self.asking, {})
            answers.refused = str(e)
            return answers
        if remark:  # it must be given the robot that it knows
            stop(self.process)
            self._write_ask(self.asking.terms)
            self.process = self._started()
            self._waited(path.exists, time.time, self.loading)
        return answers

    def asked(self, answers: Answers, tick: Tick, kept: Kept) -> None:
        """All terms but those kept from before; a term in which the process dies or hangs is left out of the next."""
        np.savez(self.folder / "states.npz", **answers.sent)  # type: ignore[arg-type]
        waiting = [t for t in self.asking.terms if not kept.restore(t, answers)]
        if waiting != list(self.asking.terms):
            self._write_ask(waiting)
        while waiting:
            wrong = self._session(tick, lambda: self._take(answers, waiting, kept))
            self._take(answers, waiting, kept)
            now = _json(self.folder / "now.json").get("term")
            (self.folder / "notes.json").unlink(missing_ok=True)
            answers.later(_json(self.folder / "later.json"))
            if not wrong or not waiting:
                break
            blamed = now if now in waiting else waiting[0]
            answers.silent[blamed] = wrong
            kept.silent(blamed, answers, wrong)
            waiting.remove(blamed)
            if waiting:
                self._write_ask(waiting)
                self.process = self._started()
        for term in waiting:
            answers.silent.setdefault(term, "no answer")

    def _take(self, answers: Answers, waiting: list[str], kept: Kept) -> None:
        """What was answered since; it leaves `waiting`."""
        for term, note in _json(self.folder / "notes.json").items():
            if term in waiting:
                file = self.folder / "answers" / f"{term}.npy"
                x = np.load(file) if file.exists() else None
                answers.take(term, x, note)
                kept.answer(term, answers, x, note)
                waiting.remove(term)

    def _session(self, tick: Tick, take: Callable[[], None]) -> str:
        """One process from its introduction to its end; what went wrong, if anything."""
        subject, now = self.folder / "subject.json", self.folder / "now.json"
        finished = self.folder / "later.json"  # written last
        finished.unlink(missing_ok=True)
        start = time.time()
        wrong = self._waited(subject.exists, lambda: start, self.loading)
        if wrong:
            return wrong
        try:
            assert self.process.stdin is not None
            self.process.stdin.write(b"go\n")
            self.process.stdin.close()
        except OSError:
            pass  # it is gone already: its exit says how
        begun, seen = time.time(), [""]

        def since() -> float:
            term = _json(now).get("term", "")
            if term != seen[0]:
                seen[0] = term
                take()
                tick(term)
            try:
                return max(begun, now.stat().st_mtime)
            except OSError:
                return begun

        wrong = self._waited(lambda: self.process.poll() == 0, since, self.limit)
        return wrong or ("" if finished.exists() else ended(0, self.log))


def _json(path: Path) -> dict[str, Any]:
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return {}


def stop(process: subprocess.Popen) -> None:
    """End a process and whatever it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)  # what it started may outlive it
    except (OSError, AttributeError):
        if process.poll() is None:
            process.kill()
    if process.stdin:
        with contextlib.suppress(OSError):
            process.stdin.close()
    process.wait()


def ended(code: int, log: Path) -> str:
    """How a process ended, and the last thing it said."""
    try:
        lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
        said = [_shown(x) for x in lines if x[:1].strip() and _shown(x) and not _WARNED.search(x)]
    except OSError:
        said = []
    if code < 0:
        try:
            how = f"crashed ({signal.Signals(-code).name})"
        except ValueError:
            how = f"crashed (signal {-code})"
    else:
        how = f"ended with exit code {code}"
    raised = [x for x in said if _RAISED.match(x)]  # libraries print more after it
    return how + (f": {(raised or said)[-1][:300]}" if said else "")


def _shown(line: str) -> str:
    """A line without colours, control characters and bytes that are no text: it stands in a terminal and in XML."""
    return "".join(c for c in _COLOUR.sub("", line) if c.isprintable() and c != "\N{REPLACEMENT CHARACTER}").strip()
