"""A page with thousands of robots: small, all of them in it, the worst with their particulars."""

import json
import re
from dataclasses import replace

import pytest

import dualpin as dp
from dualpin.report import page, paged

pytest.importorskip("pinocchio")
N = 2000


@pytest.fixture(scope="module")
def report():
    found = dp.validate("ur5", samples=2, terms=["rnea", "aba"], engine="numpy")
    (one,) = found.robots
    found.robots = [replace(one, name=f"ur5_{k}") for k in range(N)]
    bad = found.robots[1234]
    bad.terms = {name: replace(t) for name, t in bad.terms.items()}
    bad.terms["rnea"].settle("differs", "oracle", "wrong")
    found.robots[1234] = replace(bad, status="", passed=True)
    return found


@pytest.fixture(scope="module")
def html(report):
    return page(report)


def test_all_robots_are_in_the_table(html):
    rows = json.loads(re.search(r'class="rows">(.*?)</script>', html, re.S).group(1))
    assert [r[0] for r in rows] == [f"ur5_{k} numpy" for k in range(N)]
    assert rows[1234][3:5] == ["✗", "differs"]
    assert rows[1234][7].startswith("bad ")
    assert len(rows[0]) == 7 + 2


def test_what_differs_has_its_particulars(html):
    assert 'id="r1234"' in html
    assert html.count('class="robot"') == paged.SHOWN
    rows = json.loads(re.search(r'class="rows">(.*?)</script>', html, re.S).group(1))
    assert all((f'id="{r[6]}"' in html) for r in rows if r[6])


def test_it_is_small(html):
    assert len(html) / N < 800  # bytes a robot with two terms; the particulars of the shown ones included


def test_a_name_cannot_leave_the_data(report):
    robots = [replace(r) for r in report.robots[:500]]
    robots[0] = replace(robots[0], name="</script><script>alert(1)</script>")
    assert "<script>alert" not in page(replace(report, robots=robots))


def test_few_robots_are_drawn_at_once(report):
    assert 'class="rows"' not in page(replace(report, robots=report.robots[:3]))
