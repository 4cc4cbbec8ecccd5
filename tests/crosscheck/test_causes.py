"""What libraries were found to do with a file: named from their answers alone."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.description import Body
from dualpin.crosscheck.diagnosis.hypothesis import Hypothesis
from dualpin.crosscheck.diagnosis.locate import partly
from dualpin.crosscheck.diagnosis.rules.links import possible
from dualpin.crosscheck.diagnosis.scores import Score
from dualpin.crosscheck.diagnosis.stories import Explanation
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.kinematic import Kinematic
from tests.crosscheck.recursive import Recursive
from tests.crosscheck.test_blind import PROBE

BODY = (
    '<inertial><origin xyz="{c} 0.02 0" rpy="0 0 0"/><mass value="{m}"/>'
    '<inertia ixx="{i}" iyy="{j}" izz="{k}" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def _link(name: str, c: float = 0.1, m: float = 1.0, moments: tuple[float, ...] = (0.02, 0.02, 0.03)) -> str:
    i, j, k = moments
    return f'<link name="{name}">{BODY.format(c=c, m=m, i=i, j=j, k=k)}</link>'


def _joint(name: str, parent: str, child: str, x: float, axis: str = "", limit: float = 3.0) -> str:
    rest = f'<axis xyz="{axis}"/><limit lower="{-limit}" upper="{limit}" effort="9" velocity="9"/>' if axis else ""
    kind = "revolute" if axis else "fixed"
    origin = f'<origin xyz="{x} 0.1 0.05" rpy="0.3 {x} 0.2"/>'
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{origin}{rest}</joint>'


def _robot(*parts: str) -> str:
    return f'<robot name="r">{"".join(parts)}</robot>'


ARM = _robot(
    '<link name="w"/>', _link("a"), _link("b", 0.2, 0.5), _link("s1", 0.05), _link("s2", 0.07), _link("s3", 0.03),
    _joint("j1", "w", "a", 0.1, "0 1 0"), _joint("j2", "a", "b", 0.3, "1 0 0"),
    _joint("f2", "b", "s2", 0.2), _joint("f1", "b", "s1", 0.1), _joint("f3", "s1", "s3", 0.3),
)  # fmt: skip
"""Three fixed links on the second body; their joints are listed in another order than they are."""
TERMS = ("fk", "gravity", "crba", "rnea")


def _judged(tmp_path, text: str, subject: dict) -> dp.crosscheck.results.Report:
    path = tmp_path / "r.urdf"
    path.write_text(text)
    return dp.judge(path, subject, 8, terms=[t for t in TERMS if t in subject])


def _of(robot: dp.Robot) -> dict:
    return {
        "gravity": lambda q: dp.gravity(robot, q), "crba": lambda q: dp.crba(robot, q),
        "rnea": lambda q, v, a: dp.rnea(robot, q, v, a),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("mass", "ixx", "becomes", "words"),
    [
        (0.2, 0.2, (0.2, 2 / 5 * 0.2 * (0.6 / (4000 * np.pi)) ** (2 / 3)), "ball of 1000"),
        (0.0, 0.02, (1.0, 2 / 5 * (3.0 / (4000 * np.pi)) ** (2 / 3)), "ball of 1000"),
        (0.2, 0.1, (0.2, 0.05), "mean of the three"),
        (0.2, 0.1, (0.2, 0.0), "by zero"),
    ],
)
def test_an_inertia_that_no_body_can_have_and_what_takes_its_place(tmp_path, mass, ixx, becomes, words):
    told, used = _link("b", 0.2, mass, (ixx, 0.02, 0.03)), _link("b", 0.2, becomes[0], 3 * becomes[1:])
    mine = _link("b", 0.2, 0.5)
    report = _judged(tmp_path, ARM.replace(mine, told), _of(dp.loads(ARM.replace(mine, used))))
    (finding,) = report.findings
    assert finding.key == "impossible_inertia" and words in finding.says and finding.items == ["b"]


def test_possible_inertias():
    def of(mass: float, *moments: float) -> bool:
        return possible(Body(mass, np.zeros(3), np.zeros(3), np.eye(3), np.diag(moments)))

    assert of(1, 0, 0, 0) and of(1, 1, 1, 2) and of(0, 0, 0, 0) and of(1, 0, 1, 1)
    assert not of(1, 1, 1, 2.1) and not of(1, -0.1, 1, 1) and not of(0, 1, 1, 1)


@pytest.mark.parametrize(("order", "words"), [("s1 s3 s2", "depth first"), ("s1 s2 s3", "breadth first")])
def test_a_chain_in_the_order_of_links(tmp_path, order, words):
    on, text = "b", ARM
    for link in order.split():
        (name,) = re.findall(rf'<joint name="(\w+)" type="fixed"><parent link="\w+"/><child link="{link}"/>', text)
        text = re.sub(rf'(<joint name="{name}" type="fixed"><parent link=")\w+', rf"\g<1>{on}", text)
        on = link
    report = _judged(tmp_path, ARM, _of(dp.loads(text)))
    (finding,) = report.findings
    assert finding.key == "chained" and finding.says.endswith(f"{words}, in the order of the file's links")


def test_positions_cut_to_limits_of_the_file(tmp_path):
    text = ARM.replace('lower="-3.0" upper="3.0"', 'lower="0" upper="0"')
    robot = dp.loads(text)
    report = _judged(tmp_path, text, {"fk": lambda q, frame: dp.fk(robot, np.clip(q, 0.0, 0.0), frame=frame)})
    (finding,) = report.findings
    assert finding.key == "clipped" and finding.alternatives == ["positions are ignored"]


def test_what_is_kept_from_another_term_shows_in_a_state_that_is_not_the_first(tmp_path):
    """Gravity turned as the base stood in the last state for which kinematics was asked."""
    robot, kept = dp.loads(ARM), [np.zeros(2)]

    def fk(q, frame):
        kept[0] = q
        return dp.fk(robot, q, frame=frame)

    def gravity(q):
        return dp.gravity(robot, kept[0])

    report = _judged(tmp_path, ARM, {"fk": fk, "gravity": gravity})
    assert [f.key for f in report.findings] == ["history"] and report.terms["gravity"].status == "differs"


def test_numbers_that_fit_nothing_are_no_partial_cause(tmp_path):
    """Noise in every entry: a factor for each joint can be estimated, and means nothing."""
    path = tmp_path / "r.urdf"
    path.write_text(ARM)
    ask = asking(path, 8, 0, ("rnea",))

    def rnea(q, v, a):
        return dp.rnea(ask.robot, q, v, a) * (1 + np.sin(1e4 * q) / 2)

    found = diagnose(Case(ask_here({"rnea": rnea}, ask, lambda what: None)), budget=1.0)
    assert not found.findings and found.located == {"rnea": "off in 2 of 2 rows (j1, j2)"}


def test_another_cause_than_those_of_other_terms_must_explain_nearly_all():
    ask = asking(PROBE, 1, 0, ("fk",))
    case = Case(ask_here(Kinematic(ask.text), ask, lambda what: None))
    other = Hypothesis("other", "another cause", ("fk",), "edit", lambda d, items: d)
    known = {replace(other, key="known").cause}
    before = Score(1.0, 0.0, 1.0)

    def told(share, causes, nearest=(other,)):
        e = Explanation("fk", before, nearest=nearest, left=Score(0.5, share, 0.1))
        return partly(case, "fk", e, "", causes) is not None

    assert told(0.96, ()) and told(0.995, known) and told(0.96, {other.cause})
    assert not told(0.96, known) and not told(0.96, known, (replace(other, key="known"), other))


def test_a_mass_matrix_without_a_factor_says_why_there_is_no_inverse():
    ask = asking(PROBE, 3, 0, ("crba", "minv"))

    class Indefinite(Recursive):
        def crba(self, q):
            return super().crba(q) - 5 * np.eye(len(q))

        def minv(self, q):
            return np.full((len(q), len(q)), np.nan)  # as Cholesky's factors of such a matrix are

    found = diagnose(Case(ask_here(Indefinite(ask.text), ask, lambda what: None))).findings
    (said,) = [f for f in found if f.terms == ["minv"]]
    assert said.key == "follows" and "positive definite" in said.says
