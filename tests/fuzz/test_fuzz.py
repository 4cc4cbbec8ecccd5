"""Random robots: a wrong algorithm is found, decided and made small; a right one passes."""

import json
import sys
from dataclasses import replace

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.enclosure import enclosure, error
from dualpin.fuzz import JointSpec, Spec, examine, fuzz, random_spec, shrink
from dualpin.fuzz.identities import IDENTITIES, identities
from dualpin.fuzz.small import small_case
from dualpin.fuzz.spec import GROUND
from dualpin.fuzz.write import to_markdown, write
from tests.program import run

pytest.importorskip("pinocchio")
SEED = 11


@pytest.fixture(scope="module")
def specs():
    return [random_spec(SEED, n) for n in range(400)]


def test_the_generator_draws_what_it_promises(specs):
    kinds = {j.type for s in specs for j in s.joints}
    assert kinds == {
        "revolute", "continuous", "prismatic", "helical", "cylindrical", "spherical", "planar", "floating"
    }  # fmt: skip
    masses = np.array([j.mass for s in specs for j in s.joints if j.mass])
    assert np.log10(masses.max() / masses.min()) > 8
    lengths = np.array([np.linalg.norm(j.xyz) for s in specs for j in s.joints])
    assert lengths.max() > 50
    assert 0 < lengths[lengths > 0].min() < 1e-3
    counts = [len(s.joints) for s in specs]
    assert max(c for n, c in enumerate(counts) if n % 200 != 199) == 20
    assert max(counts) > 20
    children = [max(np.bincount([j.on for j in s.joints if j.on != GROUND] or [0])) for s in specs]
    assert {1} < set(children)
    assert max(children) > 5
    assert any(j.leader != GROUND for s in specs for j in s.joints)
    axes = [
        np.linalg.norm(np.cross(a, b)) / np.linalg.norm(a) / np.linalg.norm(b)
        for s in specs for j in s.joints if j.on != GROUND
        for a, b in [(np.array(j.axis), np.array(s.joints[j.on].axis))]
    ]  # fmt: skip
    assert sum(0 < x < 1e-6 for x in axes) > 20


def test_a_spec_survives_json(specs):
    assert all(Spec.from_json(s.to_json()) == s for s in specs[:50])


def test_bodies_are_ones_that_exist(specs):
    for s in specs[:100]:
        for j in s.joints:
            xx, xy, xz, yy, yz, zz = j.tensor
            w = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            assert w.min() >= -1e-15 * w.max()
            assert w.max() <= (w.sum() - w.max()) * (1 + 1e-12)


@pytest.mark.parametrize("number", range(0, 24, 3))
def test_random_robots_agree_or_dualpin_is_nearer(number):
    found = examine(random_spec(SEED, number))
    assert found.passed, found.remark
    assert set(IDENTITIES) < set(found.terms)


@pytest.mark.parametrize("name", list(IDENTITIES))
def test_every_identity_says_something_and_can_fail(name, monkeypatch):
    spec = next(s for s in (random_spec(SEED, n) for n in range(200)) if identities(s.robot(), 0)[name].compared)
    sides = IDENTITIES[name]

    def wrong(state):
        x, y, size = sides(state)
        x = np.array(x)
        x.flat[0] += 1e-6 * max(1.0, np.abs(y).max())
        return x, y, size

    wrong.__doc__ = sides.__doc__
    monkeypatch.setitem(IDENTITIES, name, wrong)
    found = identities(spec.robot(), 0)[name]
    assert (found.status, found.nearer, found.passed) == ("differs", "oracle", False)


def test_shrinking_keeps_what_it_is_about_and_little_else(specs):
    spec = next(s for s in specs if len(s.joints) > 10 and sum(j.type == "prismatic" for j in s.joints) > 2)
    small = shrink(spec, lambda s: sum(j.type == "prismatic" and j.mass > 0 for j in s.joints) >= 2)
    assert [j.type for j in small.joints] == ["prismatic"] * 2
    assert all(j.xyz == j.turn == (0.0, 0.0, 0.0) and j.armature == 0 for j in small.joints)
    small.robot()


def test_what_carries_others_can_go_alone():
    chain = Spec("c", tuple(JointSpec(k, i - 1) for i, k in enumerate(["revolute", "prismatic", "continuous"])))
    assert [(j.type, j.on) for j in chain.without({1}).joints] == [("revolute", GROUND)]
    small = shrink(chain, lambda s: any(j.type == "continuous" for j in s.joints))
    assert [j.type for j in small.joints] == ["continuous"]


def test_pinocchios_kinetic_energy_without_rotors_is_found_and_decided():
    """Pinocchio's computeKineticEnergy leaves out the armature of joints with an axis of their own."""
    spec = Spec("r", (JointSpec("revolute", mass=1.0, com=(0.1, 0.0, 0.0), axis=(0.6, 0.0, 0.8), armature=0.5),))
    found = examine(replace(spec, joints=(*spec.joints, JointSpec("prismatic", 0, mass=2.0))))
    assert (found.status, found.passed, found.terms["kinetic_energy"].nearer) == ("differs", True, "dualpin")
    case = small_case(spec, "kinetic_energy", "dualpin")
    assert len(case.spec.joints) == 1
    assert case.against_50_digits["dualpin"] < 1e-15 < 1e-3 < case.against_50_digits["oracle"]
    assert case.enclosed["dualpin"][1] < 1e-14
    assert case.enclosed["oracle"][0] > 1e-3
    assert dp.loads(case.urdf).nv == 1


def test_a_mistake_of_dualpin_is_named_as_one(monkeypatch, tmp_path):
    from dualpin.crosscheck import compare

    right = compare.evaluate

    def wrong(robot, term, *inputs, **options):
        x = right(robot, term, *inputs, **options)
        return x * (1 + 1e-6) if term == "rnea" and any(j.model.kind == "prismatic" for j in robot) else x

    monkeypatch.setattr(compare, "evaluate", wrong)
    outcome = fuzz(6, seed=SEED)
    assert not outcome.passed
    assert ("rnea", "oracle") in outcome.kinds
    case = next(c for c in outcome.cases if (c.term, c.nearer) == ("rnea", "oracle"))
    assert [j.type for j in case.spec.joints] == ["prismatic"]
    assert {p.name for p in write(outcome, tmp_path)} >= {
        "README.md",
        "fuzz.json",
        f"rnea-oracle-{case.spec.name}.urdf",
    }
    assert "| rnea | oracle |" in to_markdown(outcome)


def test_what_is_raised_is_counted_and_made_small(monkeypatch):
    from dualpin.fuzz import examine as room

    def broken(robot, seed):
        if any(j.model.kind == "prismatic" for j in robot):
            raise IndexError("7")
        return {}

    monkeypatch.setattr(sys.modules[room.__module__], "identities", broken)
    outcome = fuzz(6, seed=SEED)
    assert not outcome.passed
    assert outcome.verdicts["error"] == len(outcome.kinds["error: IndexError", "oracle"]) > 0
    case = next(c for c in outcome.cases if c.term == "error: IndexError")
    assert [j.type for j in case.spec.joints] == ["prismatic"]


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "helical"])
@pytest.mark.parametrize("armature", [0.0, 0.5])
def test_robots_of_one_joint(kind, armature):
    body = {"mass": 2.0, "com": (0.1, 0.2, 0.3), "tensor": (1.0, 0.0, 0.0, 1.1, 0.0, 1.2)}
    assert not examine(Spec("one", (JointSpec(kind, axis=(0.6, 0.0, 0.8), armature=armature, **body),))).error


def test_what_cannot_change_with_q_has_no_coriolis_term():
    """C_kk = dM_kk/dt / 2 of a joint that carries one body; far and heavy, rounding would leave 1e-7."""
    rng = np.random.default_rng(3)
    for kind in ("revolute", "prismatic", "helical"):
        far = JointSpec(kind, axis=(0.3, -0.5, 0.8), pitch=0.2, mass=500.0, com=tuple(rng.normal(size=3) * 500))
        robot = Spec(
            "far", (far, JointSpec("revolute", 0, axis=(0.6, 0.0, 0.8), mass=300.0, com=(90.0, 5.0, 7.0)))
        ).robot()
        q, v, _ = robot.sample(seed=0)
        assert dp.coriolis(Spec("one", (far,)).robot(), q[:1], v[:1], engine="numpy").tolist() == [[0.0]]
        assert dp.coriolis(robot, q, v, engine="numpy")[1, 1] == 0.0


def test_beyond_the_ceiling_only_errors_beyond_rounding_count(monkeypatch):
    """Half a tonne 700 m away: 1e-12 is less than what the rounding of either library leaves of it."""
    from dualpin.crosscheck import compare

    spec = Spec("far", (JointSpec("revolute", axis=(0.31, -0.57, 0.8), mass=511.3, com=(303.7, 517.1, -411.9)),))
    found = examine(spec).terms["coriolis"]
    assert (found.status, found.worst["ratio"] < 1) == ("agrees", True)
    assert found.max_scaled_error > 1e-12
    assert found.worst["against_50_digits"]["dualpin"] == 0.0
    assert "50 digits find both" in found.tolerance_reason
    right = compare.evaluate
    monkeypatch.setattr(compare, "evaluate", lambda *a, **o: right(*a, **o) + (a[1] == "coriolis"))
    assert examine(spec).terms["coriolis"].nearer == "oracle"


def test_a_term_is_computed_once_while_it_is_remembered(monkeypatch):
    from dualpin import interpret

    asked = []
    right = interpret._interpreted
    monkeypatch.setattr(interpret, "_interpreted", lambda *a: (asked.append(a[1].name), right(*a))[1])
    robot = random_spec(SEED, 3).robot()
    q, other = robot.sample(2, seed=0)[0]
    with interpret.remembered():
        M = dp.crba(robot, q, engine="numpy")
        M[:] = 0.0
        again = dp.crba(robot, q, engine="numpy")
        dp.crba(robot, other, engine="numpy")
    assert asked == ["crba", "crba"]
    assert (again == dp.crba(robot, q, engine="numpy")).all()


def test_every_variant_is_drawn_by_some_robot():
    from dualpin.fuzz.examine import DRAWN

    check = next(c for c in DRAWN if c.term == "frame_acceleration")
    seen = {tuple(check.variants(random_spec(SEED, n).robot(), 0)[0].items())[1:] for n in range(60)}
    assert len(seen) == 6


def test_an_inertia_that_pinocchio_refuses_is_not_compared():
    spec = Spec("odd", (JointSpec("revolute", mass=1.0, tensor=(-1.0, 0.0, 0.0, 1.0, 0.0, 1.0)),))
    found = examine(spec)
    assert (found.status, found.passed) == ("not compared", True)
    assert "refuses the inertia of j000" in found.reason


TENSOR = (1.66294e-05, 2.9e-11, -3.8e-09, 1.66294e-05, 7.5e-09, 9.8e-11)
BALL = JointSpec("spherical", 1, (0.0, 0.0, 0.16), (0.0, 0.0, 0.0), mass=35.0, com=(0.0, 0.0, 4.8e-4), tensor=TENSOR)


@pytest.mark.parametrize(
    "joints",
    [  # a link without inertia between two balls can spin; a base without mass is weightless
        (JointSpec("revolute", mass=7e-4, tensor=(3e-5, 0.0, 0.0, 3e-5, 0.0, 3e-5), armature=7e-5),
         JointSpec("spherical", 0, (-0.4, -0.2, 0.2)), BALL),
        (JointSpec("floating", axis=(0.0, 0.0, -1.0)),
         JointSpec("revolute", 0, (0.0, 0.0, 0.0), (0.0, np.pi / 2, 0.0), (0.0, 0.0, -1.0), mass=1.8630191760902436e-06,
                   com=(0.000137346377842692, 1.8520383243359037e-05, -0.06123493293221544),
                   tensor=(9.938411836283087e-08, 4.351060092005295e-14, -2.90339435751949e-11,
                           9.938405926455232e-08, 7.803147763916278e-11, 1.2324175664274342e-13))),
    ],
)  # fmt: skip
def test_where_rounding_decides_accelerations_nothing_is_compared(joints):
    found = examine(Spec("singular", joints))
    assert not found.error
    for name in "aba", "minv", "forward":
        assert found.terms[name].status == "not compared", name


def test_errors_are_relative_to_what_the_definition_gives():
    """Pinocchio's kinetic energy lacks nearly all of a large rotor's; the last digit of all of it is no difference."""
    for armature in np.random.default_rng(2).uniform(1e3, 1e5, 8):
        rotor = JointSpec("revolute", mass=1.0, tensor=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0), axis=(0.6, 0.0, 0.8),
                          armature=armature)  # fmt: skip
        energy = examine(Spec("rotor", (rotor,))).terms["kinetic_energy"]
        assert (energy.status, energy.nearer) == ("differs", "dualpin")


def test_a_robot_without_joints_has_identities_too():
    found = examine(Spec("rigid", (JointSpec("fixed", mass=1.0, tensor=(1.0, 0.0, 0.0, 1.0, 0.0, 1.0)),)))
    assert not found.error
    assert found.passed


def test_more_robots_take_up_what_the_store_has(tmp_path):
    path, seen = tmp_path / "f.sqlite", []
    few = fuzz(2, seed=SEED, store=path, small=0)
    more = fuzz(4, seed=SEED, store=path, small=0, progress=lambda r, *_: seen.append(r.name))
    assert few.robots == 2
    assert more.robots == 4
    assert len(seen) == 2
    assert more.verdicts == fuzz(4, seed=SEED, small=0).verdicts


def test_arguments():
    for wrong in {"robots": 0}, {"robots": 2.5}, {"seed": -1}, {"small": "x"}:
        with pytest.raises(dp.ArgumentError, match=next(iter(wrong))):
            fuzz(**{"robots": 1, **wrong})


@pytest.mark.parametrize("term", ["fk", "rnea", "crba", "coriolis", "aba"])
def test_balls_hold_what_is_computed(term):
    robot = random_spec(SEED, 3).robot()
    q, v, a = robot.sample(seed=0)
    inputs = {"q": q, "v": v, "a": a, "tau": a}
    state = {key: inputs[key] for key in dp.terms.TERMS[term].inputs}
    ours = np.ravel(getattr(dp, term)(robot, *state.values()))
    balls = enclosure(robot, term, state)
    errors = [error(ball, float(x)) for ball, x in zip(balls, ours, strict=True)]
    assert max(most for _, most in errors) < 1e-9 * max(1.0, np.abs(ours).max())
    assert all(least <= most for least, most in errors)
    off = error(balls[-1], float(ours[-1]) + 1.0)
    assert abs(off[0] - 1) < 1e-9


def test_the_command(tmp_path):
    done = run("fuzz", "--robots", "3", "--seed", "7", "-j", "1", "--out", tmp_path, "--json")
    found = json.loads(done.stdout)
    assert done.returncode == (0 if found["passed"] else 1)
    assert found["robots"] == 3
    spec = tmp_path / "one.json"
    spec.write_text(random_spec(7, 0).to_json())
    again = run("fuzz", "--replay", spec)
    assert again.returncode == 0, again.stderr
    spec.write_text("{}")
    bad = run("fuzz", "--replay", spec)
    assert bad.returncode == 2
    assert "is no robot" in bad.stderr
