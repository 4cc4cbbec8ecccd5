"""The papers' pages: dualpin is right, each verdict has its evidence, and no number of a paper is left out."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

from validation.papers.__main__ import PAPERS, index
from validation.papers.common import CANNOT, HOLDS, ROUNDING, VERDICTS, Row

FOLDER = Path(__file__).parents[2] / "validation" / "papers"
# how far the papers number their equations, appendix equations, tables and figures
NUMBERED = {
    "tapia_herrera": {"eq": 28, "Table": 2, "Fig": 10},
    "laus": {"eq": 64, "Table": 1, "Fig": 1},
    "pennestri": {"eq": 76, "Table": 7, "Fig": 7},
    "gouasmi": {"eq": 17, "A": 15, "Table": 1, "Fig": 4},
    "sariyildiz": {"eq": 17, "Fig": 10},
}


@pytest.fixture(scope="module", params=PAPERS)
def page(request):
    module = importlib.import_module(f"validation.papers.{request.param}")
    with pytest.MonkeyPatch.context() as patch:
        for slow in ("times", "costs", "table"):  # measurements of time belong to the pages, not to the tests
            if hasattr(module, slow):
                patch.setattr(module, slow, lambda: "")
        return module.page()


def test_every_verdict_has_its_evidence(page):
    wrong = [f"{r.where}: {r.what}: {r.wrong}" for r in page.rows if r.wrong]
    assert not wrong, "\n".join(wrong)


def numbers(where: str, kind: str) -> set[int]:
    """The numbers of one kind that a row's place names: "eqs 9-12, 16", "A8", "Table 4", "Figs 5-8"."""
    found = set()
    text = where
    if kind == "A":
        return {int(n) for n in re.findall(r"\bA(\d+)", text)}
    for m in re.finditer(rf"{kind}s? ((?:\d+[a-z]?(?![a-z])(?:-\d+)?(?:, | and )?)+)", text):
        for first, last in re.findall(r"(\d+)[a-z]?(?:-(\d+))?", m[1]):
            found |= set(range(int(first), int(last or first) + 1))
    return found


def test_every_numbered_equation_table_and_figure_has_its_row(page):
    for kind, last in NUMBERED[page.name].items():
        have = set().union(*(numbers(r.where, kind) for r in page.rows))
        assert set(range(1, last + 1)) - have == set(), kind
        assert not any(n > last for n in have), f"{kind} {max(have)} is not in the paper"


def test_places_are_read_as_a_reader_reads_them():
    assert numbers("eqs 9-12, 16", "eq") == {9, 10, 11, 12, 16}
    assert numbers("eq 10, 2nd line", "eq") == {10}
    assert numbers("eqs 43-46, Table 4", "Table") == {4}
    assert numbers("Figs 5-8", "Fig") == {5, 6, 7, 8}


def test_no_row_compares_a_value_with_itself(page):
    for r in page.rows:
        plain = (int, float, str, type(None))
        assert isinstance(r.value, plain) or r.value is not r.computed, r.what
        assert isinstance(r.right, plain) or r.right is not r.computed, r.what


def test_the_committed_page_has_the_same_verdicts_and_figures(page):
    text = (FOLDER / f"{page.name}.md").read_text()
    for r in page.rows:
        cells = [c.replace("|", "\\|") for c in (r.where, r.what, r.printed or "-")]
        line = next((x for x in text.splitlines() if x.startswith("| " + " | ".join(cells) + " |")), "")
        assert f"| {r.verdict}" in line, (r.what, line)
    assert "OPEN" not in text and "NOT:" not in text
    for file in page.figures:
        assert f"](figures/{file})" in text
        assert (FOLDER / "figures" / file).read_text().lstrip().startswith("<?xml")


def test_the_index_names_every_verdict_and_page():
    text = (FOLDER / "README.md").read_text()
    assert all(f"*{v}*" in text for v in VERDICTS)
    assert all(f"({name}.md)" in text for name in PAPERS)
    assert "What is not covered" in text and "read by machine" in text
    assert index([]).startswith("# The five papers")


@pytest.mark.parametrize("row", [
    Row("eq 1", "print differs", "1.00", 1.0, 1.1),
    Row("eq 1", "nothing compared", "1.00"),
    Row("eq 1", "dualpin is wrong", "1.00", 1.0, 1.0, right=2.0),
    Row("eq 1", "misprint without independent value", "1.00", 1.0, 1.1, CANNOT),
    Row("eq 1", "misprint that is none", "1.00", 1.0, 1.0, CANNOT, 1.0),
    Row("eq 1", "rounding that single precision does not show", "1.00", 1.0, 1.1, ROUNDING, single=1.1, digits=0.005),
    Row("eq 1", "no such verdict", "1.00", 1.0, 1.0, "fine"),
], ids=lambda r: r.what)  # fmt: skip
def test_a_verdict_without_evidence_is_seen(row):
    assert row.wrong


def test_a_printed_number_is_held_to_half_a_unit_of_its_last_digit():
    assert not Row("eq 1", "", "0.316", 0.316, 0.31623, HOLDS, digits=5.1e-4).wrong
    assert Row("eq 1", "", "0.316", 0.316, 0.3166, HOLDS, digits=5.1e-4).wrong


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
