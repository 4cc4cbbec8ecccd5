"""Three outcomes: what agrees, what differs and who is nearer, what was not compared."""

import json

import pytest

from dualpin.crosscheck.findings import Finding
from dualpin.crosscheck.results import Report, RobotResult, TermResult
from tests.report import samples


@pytest.mark.parametrize(("nearer", "passed", "verdict"), [
    ("dualpin", True, "differs, dualpin nearer"), ("oracle", False, "differs, oracle nearer"),
    ("neither", False, "differs, both far"), ("undecided", False, "differs, undecided"),
])  # fmt: skip
def test_a_difference_passes_only_where_dualpin_is_nearer(nearer, passed, verdict):
    t = TermResult(1e-9, 1e-13, compared=3, status="differs", nearer=nearer)
    assert (t.passed, t.verdict) == (passed, verdict)


def test_passed_follows_from_the_verdict_whatever_was_given():
    assert not TermResult(1e-9, 1e-13, True, compared=3, status="differs", nearer="oracle").passed
    assert TermResult(passed=False, status="not compared", reason="no mass").passed


@pytest.mark.parametrize(("statuses", "overall"), [
    (("agrees", "agrees"), "agrees"), (("agrees", "not compared"), "agrees"), (("not compared",), "not compared"),
    (("agrees", "differs", "not compared"), "differs"), ((), "not compared"),
])  # fmt: skip
def test_a_robot_differs_if_a_term_does_and_agrees_only_if_one_was_compared(statuses, overall):
    terms = {str(k): TermResult(compared=s != "not compared", status=s) for k, s in enumerate(statuses)}
    robot = RobotResult("r", False, False, 1, 1, 0, True, terms)
    assert robot.status == overall
    assert Report([robot]).status == overall


def test_records_of_version_0_1_are_read_as_what_they_meant():
    def old(**entries):
        plain = {"passed": True, "reason": "", "oracle": "Pinocchio", "compared": 0, "note": "", "worst": {}}
        return {"max_scaled_error": 0.0, "tolerance": 0.0, **plain, **entries}

    terms = {
        "fk": old(max_scaled_error=1e-15, tolerance=1e-13, reason="eps x 64", compared=9),
        "aba": old(note="100 of 100 not compared: M is singular to working precision"),
        "rnea": old(max_scaled_error=1.0, tolerance=1e-13, passed=False, compared=9),
        "foreign": {"max_scaled_error": 1e-15, "tolerance": 1e-13, "passed": True},
    }
    robot = {"name": "a", "floating": False, "mimic": False, "nv": 1, "samples": 9, "seed": 0, "passed": False}
    report = Report.from_dict({"robots": [{**robot, "terms": terms}], "refused": [], "versions": {}})
    found = {k: (t.status, t.passed, t.nearer) for k, t in report.terms.items()}
    assert found == {
        "fk": ("agrees", True, ""), "aba": ("not compared", True, ""), "rnea": ("differs", False, "undecided"),
        "foreign": ("agrees", True, ""),
    }  # fmt: skip
    assert report.terms["fk"].tolerance_reason == "eps x 64"
    assert "singular" in report.terms["aba"].reason
    assert Report.from_dict(json.loads(report.to_json())).to_json() == report.to_json()


def everything_said(report):
    """What every format says, with its markup."""
    from dualpin.report import page

    return {"md": report.to_markdown(), "notebook": report._repr_html_(), "page": page(report).split("<script>")[0]}


@pytest.mark.parametrize("terms", [{}, {"rnea": TermResult(status="not compared", reason="no moving body has mass")}])
def test_where_nothing_was_compared_no_format_says_passed(terms):
    pytest.importorskip("jinja2")
    report = Report([RobotResult("r", False, False, 1, 1, 0, True, terms, reason="no moving body has mass")])
    assert report.passed
    for form, text in everything_said(report).items():
        visible = text.split("</style>")[-1].lower()
        assert "passed" not in visible, form
        assert "not compared" in visible, form
        assert "no moving body has mass" in visible, form


def test_the_verdict_stands_in_every_format():
    pytest.importorskip("jinja2")
    robot = samples.robot("ur5")
    robot.terms["rnea"] = TermResult(1e-9, 1e-13, compared=3, status="differs", nearer="dualpin", reason="50 digits")
    report = Report([RobotResult("ur5", False, False, 3, 10, 0, True, robot.terms)])
    for text in everything_said(report).values():
        assert "differs, dualpin nearer" in text


def test_findings_of_all_terms_are_gathered_once():
    finding = {"key": "gravity", "says": "9.8 for 9.81"}
    terms = {k: TermResult(status="differs", findings=[finding]) for k in ("rnea", "gravity")}
    assert Report([RobotResult("r", False, False, 1, 1, 0, True, terms)]).findings == [Finding.of(finding)]
