"""Mutants of a code: one step done wrongly, nothing of another kind in its place, and whether it is predicted."""

from __future__ import annotations

import pytest

import dualpin as dp
from dualpin.crosscheck.diagnosis.rules.register import RULES
from dualpin.crosscheck.subjects import asking
from validation.referee import mutants
from validation.referee.mutations import Source

CODE = '''
import numpy as np
import dualpin as dp

class Code:
    """Potential energy and torques of gravity of two links."""
    name, version = "two links", "1"
    mistakes = ()

    def __init__(self, text, floating=False):
        self.robot = dp.loads(text)

    def potential_energy(self, q):
        g, c, m = np.array([0.0, 0.0, -9.81]), dp.com(self.robot, q), 0.0
        for link in self.robot:
            m += float(link.inertia.mass)
        if "upside_down" in self.mistakes or not m:
            g = -g
        return -m * (g @ c)

    def crba(self, q):
        M = dp.crba(self.robot, q)
        return M @ np.eye(2)
'''
ROBOT = """<robot name="two"><link name="base"/>
<link name="a"><inertial><origin xyz=".1 .2 .3"/><mass value="2"/>
  <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="b"><inertial><origin xyz=".3 .1 .2"/><mass value="1"/>
  <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="one" type="revolute"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>
  <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="two" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" effort="1" velocity="1"/></joint></robot>"""


@pytest.fixture
def drawn(monkeypatch):
    monkeypatch.setattr(mutants, "code", lambda name: Source(CODE))
    return mutants.Drawn("two links", 1, asking(dp.loads(ROBOT), 2, 0, ("potential_energy", "crba")))


def test_mutants_are_single_steps_of_equal_kind(drawn):
    said = {str(m) for m in drawn.mutants}
    assert not {m for m in said if "another: g " in m or "another: c " in m}  # units: neither stands for the other
    assert "Code.potential_energy: left out: -m * (g @ c)  ->  g @ c" in said
    assert "Code.crba: transposed: M @ np.eye(2)  ->  M.T @ np.eye(2)" in said
    assert not any("mistakes" in m.old for m in drawn.mutants)  # switches for planted mistakes are off
    assert len({(m.number, m.new) for m in drawn.mutants}) == len(drawn.mutants)


def test_a_mutant_is_explained_by_a_hypothesis_or_by_terms_that_it_follows_from(drawn, capsys):
    rules = [r for r in RULES if r.key in ("sign", "diagonal")]
    kept = {(drawn.right.how, tuple(drawn.terms), False): mutants.Predictions(drawn.right, drawn.terms, rules)}
    counts = mutants.analysed(drawn, "two links", 1000, kept)
    missed = capsys.readouterr().out
    assert sum(counts["drawn"].values()) == counts["there"] == len(drawn.mutants)
    assert 0 < sum(counts["explained"].values()) < sum(counts["shown"].values()) <= sum(counts["ran"].values())
    assert "sign: -m" not in missed  # predicted
    assert "eye(2)  ->  M * np.eye(2)" not in missed
    assert "one fewer" in missed  # neither rule leaves a body out


def test_what_never_ends_does_not_run(drawn, monkeypatch):
    monkeypatch.setattr(mutants, "SECONDS", 0.2)
    monkeypatch.setattr(drawn.source, "mutated", lambda mutant: Endless)
    assert drawn.run(drawn.mutants[0]) == (None, [])


class Endless(dict):
    def __init__(self, text, floating):
        while True:
            pass
