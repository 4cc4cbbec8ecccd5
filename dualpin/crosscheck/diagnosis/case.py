"""One subject on one robot: the states sent, its answers, and the predictions of any story (set of hypotheses)."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, TypeGuard

import numpy as np

from ...errors import DualpinError
from ...model.robot import Robot
from ..subjects.answers import Answers
from ..subjects.layout import Layout, product
from ..subjects.questions import QUESTIONS, Question
from .description import Description, Part, built, merged
from .evaluation import evaluate
from .finishing import SENSELESS, finish, tried
from .forces import forces_of
from .hypothesis import Hypothesis, Story, Wording, identity
from .reading import describe
from .scores import FAR, Score, errors, in_forces, limits, scored
from .shared import shared
from .textbook.slipped import Slipped, alike, in_one, predicted
from .textbook.steps import UncoveredError

States = dict[str, np.ndarray]
COLUMNS = 100_000
"""How many columns (stories x samples x velocities) are predicted at once: intermediate results stay small."""
PLAIN = ("word", "edit", "state", "force")
"""Places that change forward dynamics as they change M and h."""
READ = ("word", "edit", "state")
"""Places of what is read, from the columns to the file."""
KEPT = 512
"""How many robots of edited descriptions are kept."""
KEPT_BYTES = 2**26
"""Of intermediate results that many stories need."""


class View:
    """What one story sees: its robot and states, in dualpin's columns."""

    def __init__(self, case: Case, description: Description, layout: Layout, states: States) -> None:
        self.case, self.description, self.layout, self.states = case, description, layout, states

    @cached_property
    def robot(self) -> Robot:
        return self.case.robot_of(self.description)

    @cached_property
    def jointed(self) -> Robot:
        """A robot with the same joints and coordinates, whatever its links are: it need not be made for each edit."""
        asked = self.case.description
        return self.case.robot_of(asked) if self.description.joints == asked.joints else self.robot

    @property
    def frames(self) -> tuple[str, ...]:
        return self.case.frames

    @property
    def robot_mass(self) -> float:
        """What moves [kg]."""
        return float(sum(float(j.inertia.mass) for j in self.robot))

    def compute(self, term: str, reference: str = "local_world_aligned", **states: np.ndarray) -> np.ndarray:
        """dualpin's answer to another term, for the same robot and states (or with some replaced)."""

        def answer() -> np.ndarray:
            given = {k: x[None] for k, x in {**self.states, **states}.items()}
            return evaluate(self.robot, QUESTIONS[term], given, self.frames, reference)[0]

        return self.once((term, reference, *((k, x.tobytes()) for k, x in states.items())), answer)

    def at(self, **states: np.ndarray) -> View:
        """The same with some states replaced."""
        return View(self.case, self.description, self.layout, {**self.states, **states})

    def once(self, what: Hashable, make: Callable[[], np.ndarray]) -> np.ndarray:
        """What many stories need of the same robot and states: made once, not to be written to."""
        kept, key = self.case.kept, (id(self.description), id(self.states), what)
        if key not in kept:
            x = make()
            x.flags.writeable = False
            self.case.bytes += x.nbytes
            if self.case.bytes > KEPT_BYTES:
                kept.clear()
                self.case.bytes = x.nbytes
            kept[key] = self.description, self.states, x  # so that neither is another's place in memory
        return kept[key][2]


class Case:
    """A subject's answers, and predictions of what stories say they should be."""

    def __init__(self, answers: Answers, tolerance: float = 1e-9) -> None:
        self.answers, self.asking, self.tolerance = answers, answers.asking, tolerance
        self.robot, self.frames = self.asking.robot, self.asking.frames
        self.observed, self.sent = answers.terms, answers.sent
        self.wording = Wording(answers.how)
        self.description = describe(self.asking.text, self.robot)
        self.tried = 0
        self._predictions: dict[tuple[str, frozenset[Any]], np.ndarray | None] = {}
        self._layouts: dict[Wording, tuple[Layout, States] | None] = {}
        self.told: dict[str, Sequence[Story]] = {}
        """What explains terms, as far as it is found, the likeliest first."""
        self.asked: dict[int, list[str]] = {}
        """Of rules by number: the terms that they predict."""
        self.slips: dict[int, dict[Any, Hypothesis]] = {}
        """Of rules by number: the hypotheses of their slips."""
        self.spared: dict[Any, list[str]] = {}
        """What `spared` found out."""
        self._robots: dict[int, tuple[Description, Robot]] = {}
        self._edits: dict[Any, tuple[Description, Hypothesis, Description]] = {}
        self._states: dict[Any, tuple[View, States]] = {}
        self.kept: dict[Any, tuple[Description, States, np.ndarray]] = {}
        self.bytes = 0
        a = self.asking
        joints = tuple(j.name for j in self.robot if j.mimic is None)
        self.shared = shared((a.text, a.gravity, a.floating, joints, self.frames, self.how.reference))
        """What is kept for other subjects that are asked the same of the same robot."""

    # what rules look at

    @property
    def how(self) -> Any:
        return self.answers.how

    @property
    def floating(self) -> bool:
        return self.asking.floating

    def parts(self) -> Iterable[tuple[Part, slice]]:
        """The joints that move by themselves, with their places in v."""
        where = {j.name: j.v for j in self.robot if j.mimic is None}
        return ((p, where[p.joint]) for p in self.description.parts if p.joint in where)

    @cached_property
    def merged(self) -> Description:
        """The description with the inertia of fixed links in the bodies that carry them."""
        return merged(self.description)

    def per_velocity(self, what: Callable[[Part], float]) -> np.ndarray:
        """A number for each entry of v, from each joint's part; zero for the base."""
        out = np.zeros(self.robot.nv)
        for p, v in self.parts():
            out[v] = what(p)
        return out

    def robot_of(self, description: Description) -> Robot:
        """The robot of one description."""
        if id(description) not in self._robots:
            if len(self._robots) > KEPT:
                self._robots.clear()
            self._robots[id(description)] = description, built([description], self.robot)
        return self._robots[id(description)][1]

    def few(self, samples: int) -> Case:
        """The same subject, by its first answers alone."""
        return self._at(slice(samples))

    def complete(self) -> Case:
        """The same subject at the states for which all terms have a finite answer, but for those that have few."""
        answered = [
            np.isfinite(x).reshape(len(x), x.shape[1] if QUESTIONS[term].framed else 1, -1).all(2).any(1)
            for term, x in self.observed.items()
        ]
        most = max((rows.sum() for rows in answered), default=0)
        have = np.all([rows for rows in answered if 2 * rows.sum() >= most], axis=0)
        return self if not most or have.all() or 2 * have.sum() < most else self._at(have)

    def _at(self, samples: Any) -> Case:
        a = self.answers
        asking = a.asking.at({k: x[samples] for k, x in a.asking.states.items()}, self.frames)
        sent, terms = ({k: x[samples] for k, x in kept.items()} for kept in (a.sent, a.terms))
        return Case(replace(a, asking=asking, sent=sent, terms=terms), self.tolerance)

    # predictions

    def layout(self, wording: Wording) -> tuple[Layout, States] | None:
        """A wording's layout, and what the sent numbers mean under it; None where it is impossible."""
        if wording not in self._layouts:
            try:
                layout = Layout(self.robot, wording.how, wording.turned, wording.point)
                self._layouts[wording] = layout, layout.back(self.sent)
            except (DualpinError, np.linalg.LinAlgError):
                self._layouts[wording] = None
        return self._layouts[wording]

    def view(self, story: Story) -> View | None:
        """Robot, layout and states under a story."""
        return self._view(story) if any(h.place in READ for h in story) else self._as_asked

    @cached_property
    def _as_asked(self) -> View | None:
        """Under stories of what is made of it: slips, forces, answers."""
        return self._view(())

    def _view(self, story: Story) -> View | None:
        wording, description = self.wording, self.description
        for h in story:
            if h.place == "word":
                wording = h.act(wording)
            elif h.place == "edit":
                description = self._edited(description, h)
        if (found := self.layout(wording)) is None:
            return None
        view = View(self, description, *found)
        for h in (h for h in story if h.place == "state"):
            view = View(self, description, view.layout, self._stated(view, h))
        return view

    def _stated(self, view: View, h: Hypothesis) -> States:
        """The same object for the same change of what was sent, which all terms need."""
        key = h.identity, id(h.act), id(view.states), id(view.description)
        if key not in self._states:
            self._states[key] = view, h.act(view)  # the view, so that none of it is another's place in memory
        return self._states[key][1]

    def _edited(self, d: Description, h: Hypothesis) -> Description:
        """The same object for the same edit of what the file says, since much is kept of each description."""
        if d is not self.description:
            found: Description = h.act(d, h.items)
            return found
        key = id(d), h.identity, id(h.act)
        if key not in self._edits:
            self._edits[key] = d, h, h.act(d, h.items)
        return self._edits[key][2]

    def predict(self, term: str, story: Story = ()) -> np.ndarray | None:
        """What the subject would answer if the story were true; None where it makes no sense."""
        return self.predictions(term, [story])[0]

    def predictions(self, term: str, stories: Sequence[Story]) -> list[np.ndarray | None]:
        """Of many stories, in as few passes as their number allows."""
        missing = {identity(s): s for s in stories if (term, identity(s)) not in self._predictions}
        lasting = {key: what for key, s in missing.items() if (what := self._lasting(term, s)) is not None}
        for key, what in lasting.items():
            known = self.shared.prediction(what)
            if known:
                (self._predictions[term, key],) = known
                del missing[key]
        at_once = max(1, COLUMNS // (self.asking.samples * max(1, self.robot.nv)))
        todo = list(missing.values())
        for start in range(0, len(todo), at_once):
            self._predict(term, todo[start : start + at_once])
        for key in lasting.keys() & missing.keys():
            self.shared.predicted(lasting[key], self._predictions[term, key])
        return [self._predictions[term, identity(s)] for s in stories]

    def known(self, term: str, hypotheses: Iterable[Hypothesis]) -> Iterator[tuple[Hypothesis, np.ndarray | None]]:
        """Those of which a prediction was made already, with it."""
        for h in hypotheses:
            key = term, identity((h,))
            if key in self._predictions:
                yield h, self._predictions[key]

    @cached_property
    def _question(self) -> Hashable:
        """What answers depend on besides the robot: how the subject writes, states, and frames."""
        return self.how, self.frames, *((k, x.shape, x.tobytes()) for k, x in self.sent.items())

    def _lasting(self, term: str, story: Story) -> Hashable | None:
        """What determines a prediction, where it is the same for all subjects: single slips of textbook algorithms.

        Poses are not: they are predicted as rotations, or as what a slip makes of them, as the subject's are.
        """
        if term != "fk" and len(story) == 1 and story[0].place == "formula" and isinstance(story[0].act, Slipped):
            return self._question, term, story[0].act
        return None

    def _predict(self, term: str, stories: Sequence[Story]) -> None:
        self.tried += len(stories)
        with np.errstate(all="ignore"):
            views = [tried(self.view, s) for s in stories]
            together = [(s, v) for s, v in zip(stories, views, strict=True) if v is not None]
            for s in stories:
                self._predictions[term, identity(s)] = None
            evaluated = tried(self._evaluated, term, together)
            if evaluated is None:  # one of them makes no sense: each by itself
                alone = [tried(self._evaluated, term, [one]) or ([None], [None]) for one in together]
                evaluated = [x for (x,), _ in alone], [other for _, (other,) in alone]
            xs, others = evaluated
            finished = finish(term, together, xs, others, self.observed)
            for (story, _), x in zip(together, finished, strict=True):
                self._predictions[term, identity(story)] = x

    def _evaluated(self, term: str, together: Sequence[tuple[Story, View]]) -> tuple[list[Any], list[Any]]:
        """The term for every story, and the mass matrix or Jacobian that its layout needs besides."""
        question = QUESTIONS[term]
        acts = [in_one([h.act for h in s if h.place == "formula" and term in h.terms]) for s, _ in together]
        views = [view for _, view in together]
        xs = _by_formulas(term, acts, views)
        plain = [k for k, x in enumerate(xs) if x is None]
        forced = [self._with_forces(term, *together[k]) for k in plain]
        _fill(xs, plain, self._batch(question, forced))
        needs = {"bias": "crba", "coriolis": "crba", "six_rate": "jacobian"}.get(question.form)
        others: list[Any] = [None] * len(together)
        if needs:  # what the subject makes in its own columns is made of what it has there itself
            turning = [a if v.layout.turns else None for a, v in zip(acts, views, strict=True)]
            others = _by_formulas(needs, turning, views)
            plain = [k for k, x in enumerate(others) if x is None and views[k].layout.turns]
            _fill(others, plain, self._batch(QUESTIONS[needs], [views[k] for k in plain]))
        return xs, others

    def _with_forces(self, term: str, story: Story, view: View) -> View:
        """Forward dynamics under additional forces: they are taken from tau."""
        if QUESTIONS[term].source != "aba":
            return view
        forces = forces_of(story, view, term)
        if forces is None:
            return view
        return view.at(tau=view.states["tau"] - forces)

    def _batch(self, question: Question, views: Sequence[View]) -> list[np.ndarray]:
        """The term for many views in one pass, for each reference that is meant, and each tree."""
        out: list[Any] = [None] * len(views)
        kinds = [(v.layout.how.reference, v.description.tree) for v in views]
        for kind in dict.fromkeys(kinds):
            reference, at = kind[0], [k for k, x in enumerate(kinds) if x == kind]
            descriptions = [views[k].description for k in at]
            same = all(d is descriptions[0] for d in descriptions)
            robot = self.robot_of(descriptions[0]) if same else built(descriptions, self.robot)
            inputs = {k: np.stack([views[i].states[k] for i in at]) for k in question.inputs}
            _fill(out, at, evaluate(robot, question, inputs, self.frames, reference))
        return out

    # how near they come

    @cached_property
    def wrong(self) -> frozenset[str]:
        """The terms whose answers are not right."""
        return frozenset(t for t in self.observed if not self.score(t).right)

    def score(self, term: str, story: Story = ()) -> Score:
        return self.scores(term, [story])[0]

    def _under_tau(self, story: Story) -> bool:
        """Whether the accelerations are those of the torques that were sent: not if other inputs stand for them."""
        if not any(h.place == "state" for h in story):
            return True
        taken, given = self.view(story), self.view(tuple(h for h in story if h.place != "state"))
        return taken is not None and given is not None and np.array_equal(taken.states["tau"], given.states["tau"])

    def scores(self, term: str, stories: Sequence[Story]) -> list[Score]:
        """Forward dynamics is scored in forces: there one wrong entry moves all accelerations."""
        x, found = self.observed[term], self.predictions(term, stories)
        if term == "aba":
            return self._in_forces(x, found, stories)
        if not QUESTIONS[term].solves:
            return scored(x, found, np.full(len(found), self.tolerance))
        masses = found if term == "minv" else self.predictions("crba", stories)
        return scored(x, found, limits(masses, len(self.robot), self.tolerance))

    def _in_forces(self, x: np.ndarray, found: Sequence[np.ndarray | None], stories: Sequence[Story]) -> list[Score]:
        masses = self.predictions("crba", [tuple(h for h in s if h.place in PLAIN) for s in stories])
        plain = [k for k, s in enumerate(stories) if all(h.place in PLAIN for h in s) and self._under_tau(s)]
        biases = dict(zip(plain, self.predictions("bias", [stories[k] for k in plain]), strict=True))
        shapes = x.shape, (*x.shape, x.shape[-1])
        pairs = enumerate(zip(found, masses, strict=True))
        both = {k: (p, M) for k, (p, M) in pairs if _finite(p) and _finite(M) and (p.shape, M.shape) == shapes}
        out = [FAR] * len(found)
        if both:
            P, M = (np.stack(some) for some in zip(*both.values(), strict=True))
            # M a + h = tau needs no inverse: right answers fulfil it, however M is conditioned
            needed = product(M, P)
            for row, k in enumerate(both):
                if _finite(h := biases.get(k)):
                    needed[row] = self.sent["tau"] - h
            load = product(np.abs(M), np.abs(x)) + np.abs(needed)
            _fill(out, list(both), in_forces(errors(x, P), product(M, x), needed, load, self.tolerance))
        return out


def _by_formulas(term: str, acts: Sequence[Callable[..., Any] | None], views: Sequence[View]) -> list[Any]:
    """What the acts predict, many in one run; None where there is none, or where it makes no sense."""
    xs: list[Any] = [None] * len(acts)
    for at in alike(acts, views):
        try:
            found = predicted([act for k in at if (act := acts[k]) is not None], views[at[0]], term)
        except UncoveredError:
            continue
        except SENSELESS:  # one of them: each by itself
            found = [(tried(predicted, [acts[k]], views[at[0]], term) or [None])[0] for k in at]
        _fill(xs, at, found)
    return xs


def _fill(out: list[Any], at: Sequence[int], values: Iterable[Any]) -> None:
    for k, x in zip(at, values, strict=True):
        out[k] = x


def _finite(x: np.ndarray | None) -> TypeGuard[np.ndarray]:
    return x is not None and bool(np.isfinite(x).all())
