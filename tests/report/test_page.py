"""The page holds what the result holds, loads nothing, and survives odd input."""

import json
import re

import pytest
from lxml import html as lxml_html

from dualpin.crosscheck.results import Report, RobotResult, TermResult
from dualpin.errors import ArgumentError
from dualpin.report import compare, page, study
from dualpin.report.matrix import Matrix, short

from . import samples

pytest.importorskip("jinja2")


def parsed(text):
    return lxml_html.fromstring(text)


def every_kind():
    return [
        samples.failed(), study(samples.speed(), "speed.json"), study(samples.integrators(), "study.json"),
        study([{"a": 1, "b": "x"}], "records.json"), compare(samples.report(), samples.failed()),
    ]  # fmt: skip


def test_it_loads_nothing():
    text = page(*every_kind())
    tree = parsed(text)
    assert not tree.xpath("//script[@src] | //img | //iframe | //link[@rel='stylesheet']")
    links = [*tree.xpath("//@href"), *re.findall(r"url\(([^)]*)\)", text)]
    assert [x for x in links if not x.startswith(("#", "data:"))] == []
    assert not re.search(r"https?://(?!www\.w3\.org)", text)


def test_every_link_leads_to_something_on_the_page():
    tree = parsed(page(*every_kind()))
    ids = tree.xpath("//@id")
    assert len(ids) == len(set(ids))
    assert {x[1:] for x in tree.xpath("//a/@href")} <= set(ids)


def test_text_of_files_is_escaped():
    report = samples.report(samples.robot("<script>alert(1)</script>"))
    text = page(report)
    assert "<script>alert" not in text
    assert "&lt;script&gt;alert(1)" in text


def test_the_matrix_has_a_cell_for_every_robot_and_term():
    tree = parsed(page(samples.failed()))
    rows = tree.xpath("//table[contains(@class, 'matrix')]/tbody/tr")
    assert len(rows) == 2
    assert all(len(r.xpath("td[@title]")) == len(samples.TERMS) for r in rows)
    (bad,) = tree.xpath("//table[contains(@class, 'matrix')]//td[@class='bad']")
    assert "1e-3" in bad.text_content()
    assert "row elbow" in bad.get("title")


def test_a_worst_sample_can_be_copied_as_python():
    tree = parsed(page(samples.report(samples.robot("panda"))))
    space: dict = {}
    exec(tree.xpath("//div[@class='copy']/pre")[0].text_content(), space)
    assert space["q"] == [0.125] * 3
    assert space["a"] == [0.5] * 3


def test_remarks_refusals_and_limitations_are_there():
    text = parsed(page(samples.failed())).text_content()
    for words in ("<inertia> & more", "mine.urdf", "dualpin only", "both libraries", "Known limitations", "a CPU"):
        assert words in text


NOTHING_MOVES = TermResult(status="not compared", reason="nothing moves")
INFINITE = TermResult(float("inf"), 1e-9, compared=3, status="differs")


@pytest.mark.parametrize("report", [
    Report(),
    Report([RobotResult("gone", False, False, 0, 5, 0, False, error="it broke")]),
    Report([RobotResult("still", False, False, 0, 5, 0, True, {"fk": NOTHING_MOVES})]),
    Report([RobotResult("wild", False, False, 1, 5, 0, False, {"aba": INFINITE})]),
], ids=["empty", "error", "nothing compared", "infinite"])  # fmt: skip
def test_odd_reports_have_a_page(report):
    assert "<h1>" in page(report)
    assert "<h1>" in page(Report.from_dict(json.loads(report.to_json())))


def test_reports_of_older_versions_are_read():
    data = json.loads(samples.report().to_json())
    for r in data["robots"]:
        for t in r["terms"].values():
            del t["quantiles"], t["worst"]["where"]
    assert "<h1>" in page(Report.from_dict(data))


def test_nothing_to_show_is_an_error():
    with pytest.raises(ArgumentError, match="nothing to show"):
        page()


@pytest.mark.parametrize(
    ("error", "shade"), [(0.0, "k0"), (1e-19, "k0"), (2e-16, "k2"), (2e-14, "k4"), (1e-13, "k4"), (2e-13, "bad")]
)
def test_shades_follow_the_decades_below_the_tolerance(error, shade):
    view = Matrix(samples.report(samples.robot("panda", fk=error)))
    assert view.robots[0].cells[0].shade == shade


@pytest.mark.parametrize(
    ("x", "text"), [(0, "0"), (2.4e-15, "2e-15"), (float("inf"), "inf"), (None, "inf"), (3.0, "3e0")]
)
def test_short_numbers(x, text):
    assert short(x) == text


def test_speed_shows_ratios_and_how_costs_scale():
    tree = parsed(page(study(samples.speed(), "speed.json")))
    titles = [x.text_content() for x in tree.xpath("//figcaption/b")]
    assert "Cost against degrees of freedom, batch 4096" in titles
    assert any("against batch" in t for t in titles)
    heads = [x.text_content() for x in tree.xpath("//h3")]
    assert "Times faster than Pinocchio: batch 4096, 1 thread" in heads
    # the same figures stand in tables
    assert all(f.xpath(".//table") for f in tree.xpath("//figure[contains(@class, 'lines')]"))


def test_integrators_show_errors_and_drift():
    titles = [x.text_content() for x in parsed(page(study(samples.integrators(), "s"))).xpath("//figcaption/b")]
    assert titles == ["pa10: position peak against evaluations of the right-hand side",
                      "pa10: position peak against step in s", "drift over turns"]  # fmt: skip


def test_all_robots_are_under_ten_megabytes():
    """170 variants x 21 terms, each term with a worst sample of its own, at a mean of 24 degrees of freedom."""
    robots = []
    for k in range(170):
        terms = {f"centroidal_momentum_{i}": samples.term(nv=24) for i in range(21)}
        for i, t in enumerate(terms.values()):
            t.worst = {**t.worst, "sample": i, **{x: [-0.1234567890123456 + i] * 24 for x in "qva"}}
        robots.append(RobotResult(f"robot_{k}", False, False, 24, 100, 0, True, terms))
    assert len(page(samples.report(*robots)).encode()) < 10e6
