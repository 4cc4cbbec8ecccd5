"""The page: templates filled in.  The only module that knows Jinja."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources
from importlib.util import find_spec
from typing import Any

from .. import __version__
from ..analysis.diff import Diff
from ..crosscheck.results import Report
from ..errors import ArgumentError
from .changes import Comparison
from .matrix import Matrix, number, short
from .methods import Methods
from .read import Study
from .sections import Section
from .speed import Speed

ORDER = ("Difference", "Comparison", "Validation", "Speed", "Integrators", "Records")
HINT = "HTML needs Jinja: pip install 'dualpin[report]'"


def page(*of: Report | Study | Comparison | Diff | Section, title: str = "") -> str:
    """One self-contained HTML page of results: no network, readable without JavaScript.

    Parameters
    ----------
    *of : Report, Study, Comparison, Diff or Section
        What to show; sections of robots come first, as they are given, then validations, speed, integrators and
        other records.
    title : str
        The heading; "dualpin: validation", say, by default.

    Returns
    -------
    str

    Raises
    ------
    ArgumentError
        If Jinja is not installed, or nothing is given to show.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.report import page
    >>> html = page(dp.validate("ur5", samples=2, terms=["rnea"]))
    >>> "<h1>" in html, "http://" in html.replace("http://www.w3.org/2000/svg", "")
    (True, False)
    """
    if not of:
        raise ArgumentError("report: there is nothing to show; give a report, or studies read from files")
    sections = sorted((_section(x) for x in of), key=lambda s: ORDER.index(s["title"]) if s["title"] in ORDER else -1)
    kinds = dict.fromkeys(s["title"].lower() for s in sections)
    environment = _environment()
    return environment.get_template("page.html.j2").render(
        title=title or f"dualpin: {', '.join(kinds)}",
        sections=sections,
        version=__version__,
        style=_text("style.css"),
        script="".join(_text(name) for name in ("page.js", "paged.js", "voxels.js") if _needed(name, of, sections)),
    )


def _needed(script: str, of: Sequence[Any], sections: Sequence[dict[str, Any]]) -> bool:
    """Whether a part of the page works by this script."""
    if script == "voxels.js":
        return any(isinstance(x, Section) for x in of)
    return script == "page.js" or any(getattr(s["view"], "many", False) for s in sections)


def available() -> bool:
    """Whether pages can be written: Jinja is installed."""
    return find_spec("jinja2") is not None


def _section(of: Report | Study | Comparison | Diff | Section) -> dict[str, Any]:
    """What a section's template is given."""
    if isinstance(of, Section):
        return of.entries
    if isinstance(of, Diff):
        return {"template": "diff.html.j2", "title": "Difference", "header": {}, "view": of, "source": ""}
    if isinstance(of, Comparison):
        return {"template": "compare.html.j2", "title": "Comparison", "header": {}, "view": of, "source": ""}
    if isinstance(of, Report):
        of = Study("validation", "", of, header=dict(of.versions))
    common = {"header": of.header, "source": of.name}
    if of.report is not None:
        return common | {"template": "validation.html.j2", "title": "Validation", "view": Matrix(of.report)}
    if of.subject == "speed":
        return common | {"template": "speed.html.j2", "title": "Speed", "view": Speed(of)}
    title = "Integrators" if of.subject == "integrators" else "Records"
    return common | {"template": "methods.html.j2", "title": title, "view": Methods(of)}


def _environment() -> Any:
    try:
        import jinja2
    except ImportError:
        raise ArgumentError(f"report: {HINT}") from None
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("dualpin.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number
    environment.filters["short"] = short
    return environment


def _text(name: str) -> str:
    return (resources.files("dualpin.report") / "templates" / name).read_text(encoding="utf-8")
