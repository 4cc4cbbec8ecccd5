"""What readings of the file and of the inputs predict is what an independent code gives that reads so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from dualpin.crosscheck.diagnosis import RULES, Case, diagnose
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.questions import QUESTIONS
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.recursive import Recursive
from tests.crosscheck.test_textbook import PROBE
from tests.crosscheck.unseen_codes import rewritten

TERMS = ("fk", "crba", "com", "rnea", "bias", "aba", "frame_acceleration", "kinetic_energy")


@pytest.fixture(scope="module")
def right():
    ask = asking(PROBE, 2, 0, TERMS)
    return ask_here(Recursive(ask.text), ask, lambda what: None)


def predicted(answers, key, words):
    """The predictions of the one hypothesis with this key and these words, of all terms that it touches."""
    case = Case(answers)
    found = [
        h for rule in RULES if rule.key == key for h in rule.propose(case) if str(h).endswith(words) and not h.items
    ]
    assert len(found) == 1, [str(h) for h in found]
    return {t: x for t in TERMS if (x := case.predict(t, (found[0],))) is not None and t in found[0].terms}


def agree(there, observed, least):
    off = {t: float(np.abs(x - observed[t]).max() / max(1, np.abs(observed[t]).max())) for t, x in there.items()}
    assert len(off) >= least and max(off.values()) < 1e-9, off


# --- the file ------------------------------------------------------------------------------------


def numbers(e, name, default="0 0 0"):
    return np.array([float(x) for x in e.get(name, default).split()])


def origins(owners, name, f):
    def edit(root):
        for e in root.iter("origin"):
            if e.getparent().tag in owners:
                e.set(name, " ".join(repr(float(x)) for x in f(numbers(e, name))))

    return edit


def entries(**of):
    def edit(root):
        for e in root.iter("inertia"):
            old = dict(e.attrib)
            for to, name in of.items():
                e.set(to, old.get(name, name))

    return edit


def multiplied(mass, inertia):
    def edit(root):
        for e in root.iter("mass"):
            e.set("value", repr(float(e.get("value")) * mass))
        for e in root.iter("inertia"):
            for name in e.attrib:
                e.set(name, repr(float(e.get(name)) * inertia))

    return edit


def of_next(root):
    links = [x for x in root.findall("link") if x.find("inertial") is not None]
    bodies = [x.find("inertial") for x in links]
    for link, body in zip(links, [*bodies[1:], bodies[0]], strict=True):
        link.append(body)


BOTH = ("joint", "inertial")
FILES = {
    "rpy of both backwards": (
        origins(BOTH, "rpy", np.negative), "rpy_part", "joints and of <inertial> has an angle left out, or of the "
        "other sign: -roll -pitch -yaw",
    ),
    "rpy in degrees": (origins(BOTH, "rpy", np.radians), "rpy_degrees", "joints and of <inertial> is read as degrees"),
    "millimetres": (origins(("inertial",), "xyz", lambda x: x / 1000), "inertial_xyz_units", "units): 1/1000"),
    "y z x": (origins(BOTH, "xyz", lambda x: x[[1, 2, 0]]), "xyz_order", "of joints and of <inertial> has components "
              "that are swapped, left out, or of the other sign: y z x as x y z"),
    "no ixy": (entries(ixy="0"), "inertia_entry", "without ixy"),
    "ixz for iyy": (entries(iyy="ixx"), "inertia_entry_copied", "ixx stands for iyy"),
    "cycled": (entries(ixy="ixz", ixz="iyz", iyz="ixy"), "products_swapped", "ixz iyz ixy"),
    "twice as heavy": (multiplied(2, 2), "density", "a number: 2"),
    "of the next": (
        of_next, "inertial_shifted", "links have <inertial> of the next link in the file, of those that weigh something"
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_a_reading_of_the_file_predicts_what_a_file_so_written_gives(right, name):
    edit, key, words = FILES[name]
    root = etree.fromstring(right.asking.text.encode())
    edit(root)
    observed = ask_here(Recursive(etree.tostring(root).decode()), right.asking, lambda what: None).terms
    agree(predicted(right, key, words), observed, 4)


# --- inputs --------------------------------------------------------------------------------------


class Calls:
    """Calls a code with changed inputs."""

    def __init__(self, text, change):
        self._code, self._change = Recursive(text), change

    def __getattr__(self, name):
        f = getattr(self._code, name)
        if name not in TERMS:
            return f
        inputs = QUESTIONS[name].inputs

        def call(*given):
            changed = self._change(dict(zip(inputs, given, strict=False)))
            return f(*changed.values(), *given[len(inputs) :])

        return call


def instead(**of):
    """Another input, where the call has it."""
    return lambda s: {k: s.get(of.get(k, k), x) for k, x in s.items()}


def ordered(what, to):
    return lambda s: {k: x[to] if k == what else x for k, x in s.items()}


INPUTS = {
    "q for v": (instead(v="q"), "input_instead", "q in the place of v", 5),
    "v for a": (instead(a="v"), "input_instead", "v in the place of a", 2),
    "v and tau": (instead(v="tau", tau="v"), "inputs_swapped", "v and tau", 1),
    "v backwards": (ordered("v", slice(None, None, -1)), "input_order", "v: in the declared order, reversed", 5),
    "q one late": (ordered("q", [1, 2, 3, 4, 5, 5]), "input_order", "q: one column too late, the last one twice", 7),
}  # fmt: skip


@pytest.mark.parametrize("name", INPUTS)
def test_inputs_taken_for_others_are_predicted(right, name):
    change, key, words, least = INPUTS[name]
    observed = ask_here(Calls(right.asking.text, change), right.asking, lambda what: None).terms
    agree(predicted(right, key, words), observed, least)


def test_the_origin_of_a_shape_is_taken_for_that_of_inertial(tmp_path):
    root = etree.parse(PROBE).getroot()
    for link in root.findall("link"):
        etree.SubElement(etree.SubElement(link, "visual"), "origin", xyz="0.1 -0.2 0.05", rpy="0.2 0 -0.4")
    (tmp_path / "shown.urdf").write_bytes(etree.tostring(root))
    for e in root.iter("inertial"):
        e.find("origin").attrib.update({"xyz": "0.1 -0.2 0.05", "rpy": "0.2 0 -0.4"})
    ask = asking(str(tmp_path / "shown.urdf"), 2, 0, TERMS)
    answers = ask_here(Recursive(etree.tostring(root).decode()), ask, lambda what: None)
    agree(predicted(answers, "inertial_of_shape", "xyz and rpy of the first <visual>"), answers.terms, 4)


# --- chains of fixed links -----------------------------------------------------------------------

PLACED = "R_here, p_here = R @ Rj, p + R @ pj"
CHAINS = {
    "fixed_order": (PLACED.replace("R @ Rj", "Rj @ R"), "has the two rotations multiplied in the other order"),
    "fixed_parent": (PLACED.replace("p + R @ pj", "R @ pj"), "loses the fixed link's position"),
}


@pytest.mark.parametrize("key", CHAINS)
def test_poses_along_a_chain_of_fixed_links_are_multiplied_wrongly(key, tmp_path):
    new, words = CHAINS[key]
    text = Path(PROBE).read_text()
    for child, old, on in (("b_lid", "b", "b_box"), ("c", "b", "b_lid")):
        joint = '<parent link="{}"/><child link="{}"/>'
        text = text.replace(joint.format(old, child), joint.format(on, child))
    (tmp_path / "nested.urdf").write_text(text)
    ask = asking(str(tmp_path / "nested.urdf"), 2, 0, TERMS)
    answers = ask_here(rewritten("newton", (PLACED, new))(ask.text), ask, lambda what: None)
    agree(predicted(answers, key, f"a joint on a fixed link, a fixed joint too, {words}"), answers.terms, 8)


def test_accelerations_under_other_torques_are_not_taken_for_those_under_the_torques_sent():
    """tau in the place of v: forces under which the answer is right are those of tau, not of v in its place too."""
    ask = asking(PROBE, 8, 0, ("aba", "crba", "bias"))

    class Wrong(Recursive):
        def aba(self, q, v, tau):
            return np.linalg.solve(self.crba(q), tau - self.bias(q, tau))

    (finding,) = diagnose(Case(ask_here(Wrong(ask.text), ask, lambda what: None))).findings
    assert "tau in the place of v" in finding.says
    assert finding.after < 1e-9
