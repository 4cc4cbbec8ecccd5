"""Every row of the papers' pages: dualpin is right, and the print wrong exactly where an erratum says so."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

from validation.papers.__main__ import PAPERS

# errata that are mathematical or numerical errors, paper by paper
MATHEMATICAL = {
    "tapia_herrera": "0.1 0.2 0.5 0.11 0.12 0.14 0.15 0.16",
    "laus": "1.1 1.2 1.3 1.4 1.5",
    "pennestri": "2.1 2.2 2.3 2.5 2.6 2.10 2.11 2.12 2.13 2.14 2.15 2.17 2.18 2.21 2.29 2.30 2.33 2.36",
    "gouasmi": "3.1 3.2 3.3 3.7 3.12",
    "sariyildiz": "4.1 4.2 4.3",
}


@pytest.fixture(scope="module", params=PAPERS)
def page(request):
    module = importlib.import_module(f"validation.papers.{request.param}")
    for slow in ("times", "costs"):  # measurements of time belong to the pages, not to the tests
        if hasattr(module, slow):
            pytest.MonkeyPatch().setattr(module, slow, lambda: "")
    return module.page()


def test_ours_is_right_and_the_print_wrong_only_where_an_erratum_says_so(page):
    wrong = [f"{r.where}: {r.what}: {r.verdict}, ours off by {r.difference:.2g}, print by {r.misprint:.2g}"
             for r in page.rows if not r.consistent]  # fmt: skip
    assert not wrong, "\n".join(wrong)


def test_every_mathematical_erratum_has_a_row_that_shows_it(page):
    shown = {r.erratum for r in page.rows}
    assert set(MATHEMATICAL[page.name].split()) <= shown


def test_the_committed_page_has_the_same_verdicts(page):
    text = (Path(__file__).parents[2] / "validation" / "papers" / f"{page.name}.md").read_text()
    for r in page.rows:
        cell = r.what.replace("|", "\\|")
        line = next((x for x in text.splitlines() if f"| {r.where} | {cell} |" in x), "")
        assert r.verdict in line, (r.what, line)
    assert not re.search("UNEXPLAINED|NOT REPRODUCED|NOT SEEN", text)


def test_measured_operation_counts_of_table_2():
    from dualpin import Dual
    from dualpin.spatial import Vector3
    from validation.papers.counting import Counted, count

    def one():
        return Dual(Counted(), Counted())

    def three():
        return Vector3(one(), one(), one())

    assert count(lambda: one() * one()) == (3, 1, 0)
    assert count(lambda: one() / one()) == (3, 1, 0)
    assert count(lambda: three().dot(three())) == (9, 7, 0)
    assert count(lambda: three().cross(three())) == (18, 12, 0)
