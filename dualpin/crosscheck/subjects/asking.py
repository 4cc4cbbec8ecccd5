"""The queries: a robot as every subject is given it, the states, and dualpin's own answers."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from lxml import etree

from ...call import evaluate as call
from ...errors import ArgumentError, DualpinError, DualpinWarning
from ...io.catalogue import find
from ...io.mjcf import is_mjcf
from ...io.urdf import load, loads
from ...io.xml import parse
from ...model.robot import Robot
from ..sampling import states as sampled
from .convention import base_of, columns, is_ground
from .layout import Layout, States
from .questions import QUESTIONS, Question, pushed

SAMPLES = 16  # states asked of a subject: half of them estimate what a diagnosis fits, all of them judge
FRAMES = 6  # links looked at


@dataclass(frozen=True)
class Asking:
    """A robot, the text of its URDF without what is not mechanics, and the states in dualpin's columns.

    `mjcf` is the path of the MJCF that it came from, if it did: what MuJoCo is given instead of the URDF.
    """

    name: str
    robot: Robot
    text: str
    states: dict[str, np.ndarray]
    terms: tuple[str, ...]
    seed: int = 0
    mjcf: str = ""

    @property
    def floating(self) -> bool:
        return base_of(self.robot) is not None

    @property
    def mimic(self) -> bool:
        return self.robot.coupled

    @property
    def samples(self) -> int:
        return len(self.states["q"])

    @property
    def gravity(self) -> tuple[float, float, float]:
        x, y, z = (float(c) for c in self.robot.gravity)
        return x, y, z

    @cached_property
    def frames(self) -> tuple[str, ...]:
        """Links to look at, but the root: the one with most joints under it, the last, others at random."""
        links = [f for f in self.robot.frames if f.role == "link" and f.joint is not None]
        if self.floating:
            links = [f for f in links if f.joint is not base_of(self.robot) or not is_ground(f)]
        if not links:
            return ()
        deepest = max(links, key=lambda f: sum(1 for _ in f.joint.chain) if f.joint else 0)
        rng = np.random.default_rng([self.seed, 3])
        chosen = [deepest.name, links[-1].name, *(links[i].name for i in rng.permutation(len(links)))]
        return tuple(dict.fromkeys(chosen))[:FRAMES]

    def holding(self, joints: Sequence[str]) -> Asking:
        """The same robot with some joints fixed where they are zero: those a subject does not know of."""
        return self.of_text(_fixed(self.text, joints))

    def at(self, states: Mapping[str, np.ndarray], frames: tuple[str, ...]) -> Asking:
        """The same questions at other states, of these frames."""
        found = replace(self, states=dict(states))
        found.__dict__["frames"] = frames
        return found

    def of_text(self, text: str) -> Asking:
        """The same asked of another URDF."""
        robot = _read(text, self.name, self.floating, self.mimic).with_gravity(self.gravity)
        return replace(self, robot=robot, text=text, states=random_states(robot, self.samples, self.seed))


def asking(
    robot: str | Path | Robot,
    samples: int,
    seed: int,
    terms: tuple[str, ...],
    *,
    floating: bool = False,
    mimic: bool = False,
) -> Asking:
    """Everything a subject is given, of a robot by name or path, or of the robot itself.

    Parameters
    ----------
    robot : str, Path or Robot
    samples, seed : int
        Of the random states.
    terms : tuple of str
        Keys of `QUESTIONS`.
    floating, mimic : bool
        As of `dualpin.load`.

    Returns
    -------
    Asking

    Raises
    ------
    ArgumentError, UrdfError
        If the robot is none, or cannot be read.

    Examples
    --------
    >>> from dualpin.crosscheck.subjects import asking
    >>> asking("ur5", 4, 0, ("rnea",)).samples
    4
    """
    mjcf = ""
    if not isinstance(robot, (str, Path, Robot)):
        raise ArgumentError(f"judge: a robot, or the name or path of one expected, got {type(robot).__name__}")
    if isinstance(robot, Robot):
        name = robot.name
        for word, asked, has in (("floating", floating, base_of(robot)), ("mimic", mimic, robot.coupled)):
            if asked and not has:
                raise ArgumentError(f"judge: {word}=True, but the robot {name!r} was loaded without; load it with it")
        mjcf = _mjcf_of(robot)
        text = _text_of_model(robot) if mjcf else _text_of(robot)
    elif is_mjcf(path := find(robot)):
        name, mjcf, robot = str(robot), str(path.resolve()), load(path, floating, mimic)
        text = _text_of_model(robot)
    else:
        name, text = str(robot), mechanics(path.read_bytes(), str(path))
        robot = _read(text, path.stem, floating, mimic)
    if not robot.nv:
        raise ArgumentError(f"judge: {name} has no joint that moves, so there is nothing to ask")
    return Asking(name, robot, text, random_states(robot, samples, seed), terms, seed, mjcf)


def _mjcf_of(robot: Robot) -> str:
    """The MJCF that a robot was read from and still is; empty if there is none."""
    if robot.source is None or not is_mjcf(Path(robot.source)):
        return ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DualpinWarning)
            again = load(robot.source, robot.floating, robot.coupled)
    except DualpinError:
        return ""
    return str(Path(robot.source).resolve()) if _same(robot, again) else ""


def _text_of_model(robot: Robot) -> str:
    """A URDF of a robot that MuJoCo reads itself; empty where URDF cannot hold it."""
    try:
        return _text_of(replace(robot, source=None))
    except ArgumentError:
        return ""


def random_states(robot: Robot, n: int, seed: int) -> dict[str, np.ndarray]:
    """n random states of a robot, and a wrench [n; f] in each: what every subject is given."""
    given = sampled(robot, n, seed)
    base = base_of(robot)
    if base is not None:  # no force on the base: some libraries cannot take one
        given["tau"][:, base.v] = 0
    wrenches = np.random.default_rng([seed, 4]).uniform(-10, 10, (n, 6))  # [n; f], on one link after the other
    return {k: given[k] for k in ("q", "v", "a", "tau")} | {"f_ext": wrenches}


def _read(text: str, name: str, floating: bool, mimic: bool) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        return loads(text, floating, mimic, source=name)


def mechanics(data: bytes, source: str) -> str:
    """The URDF without meshes and whatever else is not mechanics: what every subject reads alike."""
    root = parse(data, source).root
    etree.indent(root)
    return str(etree.tostring(root, encoding="unicode"))


def _text_of(robot: Robot) -> str:
    """The file a robot was read from, if it still says the same; else the URDF that it writes."""
    floating = base_of(robot) is not None
    if robot.source:
        try:
            text = mechanics(Path(robot.source).read_bytes(), robot.source)
            if _same(robot, _read(text, robot.name, floating, robot.coupled)):
                return text
        except (OSError, DualpinError):
            pass
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        text = robot.to_urdf()
    again = _read(text, robot.name, floating, robot.coupled)
    if again.joint_names != robot.joint_names:
        raise ArgumentError(
            f"judge: the URDF of {robot.name} has other joints ({', '.join(again.joint_names)}), since URDF cannot "
            "hold some of its own; a subject could not be given the same robot"
        )
    return text


def _same(a: Robot, b: Robot) -> bool:
    return a.joint_names == b.joint_names and all(
        np.array_equal(x, y) for x, y in zip(_numbers(a), _numbers(b), strict=True)
    )


def _numbers(robot: Robot) -> Iterable[np.ndarray]:
    for j in robot:
        rows = [*(x for row in j.placement.rows for x in row), *j.inertia.parameters, *j.armature]
        screws = [x for s in j.model.screws for c in s for x in (c.real, c.dual)]
        yield np.array([float(x) for x in (*rows, *screws)])


def _fixed(text: str, joints: Sequence[str]) -> str:
    root = etree.fromstring(text.encode())
    for j in root.iter("joint"):
        if j.get("name") in joints:
            j.set("type", "fixed")
            for tag in ("axis", "limit", "dynamics", "mimic"):
                for e in j.findall(tag):
                    j.remove(e)
    return str(etree.tostring(root, encoding="unicode"))


# --- dualpin's answers ---------------------------------------------------------------------------


def compute(robot: Robot, question: Question, s: States, frames: Sequence[str], reference: str) -> np.ndarray:
    """dualpin's answer in its own columns: (n, ...), or (n, frames, ...) for a term of frames."""
    if question.pushes:
        return pushed(question, s, lambda of, states: compute(robot, of, states, frames, reference))
    inputs = {k: s[k] for k in question.inputs}
    if not question.framed:
        return call(robot, question.source, inputs, engine="numpy")
    options = question.options(reference)
    answers = [call(robot, question.source, inputs, engine="numpy", frame=robot.frame(f), **options) for f in frames]
    return np.stack(answers, axis=1)


def expected(robot: Robot, layout: Layout, term: str, s: States, frames: Sequence[str]) -> np.ndarray:
    """What dualpin would answer in the subject's place, in the subject's form."""
    question, reference = QUESTIONS[term], layout.how.reference
    x = compute(robot, question, s, frames, reference)
    other = None
    if layout.turns and question.form in ("bias", "coriolis"):
        other = compute(robot, QUESTIONS["crba"], s, frames, reference)
    elif layout.turns and question.form == "six_rate":
        other = compute(robot, QUESTIONS["jacobian"], s, frames, reference)
    return layout.answer(question.form, x, s, other)


__all__ = ["SAMPLES", "Asking", "asking", "columns", "compute", "expected", "mechanics"]
