"""Build the site:  python docs/build.py [site]

The site holds files that lie outside docs/: evidence, recipes, the commands' own help, and every file that a page links
to.  They are gathered in build/docs, with their links as they are there, and Zensical makes pages of that folder.
A page in docs/ says ``../validation/dh/README.md``, as it must to be readable in the repository; in the site that file
lies at ``validation/dh/README.md``.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
STAGE = ROOT / "build" / "docs"  # docs_dir of zensical.toml
SITE = ROOT / "site"  # its site_dir
PAGES = ("CONTRIBUTING.md", "CHANGELOG.md")
EVIDENCE = "validation"
LINK = re.compile(r"(\]\()([^)#\s]+)((?:#[^)\s]*)?\))")
FOLDER = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)#\s]+)\)")
EVIDENT = re.compile(r"^<!-- evidence: (\S+) (.*?) -->\n", re.M)
FENCE = re.compile(r"^```.*?^```", re.M | re.S)
BIGGEST = 5_000_000  # bytes of a file that is linked
RESULTS = ("results/report.json", "benchmarks/results/*.json", "integrators/results.json")
SUMMARY = "evidence.html"  # what `dualpin report` makes of the results
COMMANDS = "cli.md"  # what `dualpin --help` says
FROM_DISK = """if (location.protocol === "file:") {
  const search = URL.createObjectURL(new Blob([TEXT], {type: "text/javascript"}));
  window.Worker = class extends Worker { constructor() { super(search); } };
}
"""
THEME = DOCS / "theme"  # custom_dir of zensical.toml
DARK = re.compile(r"!\[([^\]]*)\]\(([^)#\s]+?)(\.\w+)\)")


def stage() -> None:
    """Gather everything the site consists of."""
    shutil.rmtree(STAGE, ignore_errors=True)
    for path in sorted(DOCS.rglob("*")):
        if path.is_file() and path.suffix not in (".py", ".pyc", ".md") and THEME not in path.parents:
            _copy(path)
    waiting = sorted([*DOCS.rglob("*.md"), *(ROOT / p for p in PAGES), *(ROOT / EVIDENCE).rglob("*.md")])
    (STAGE / COMMANDS).write_text(command_line(), encoding="utf-8")
    _summary()
    for page in waiting:  # grows by the pages that pages link to
        text = page.read_text(encoding="utf-8")
        _write(page, _moved(text, page))
        outside = FENCE.sub("", text)
        for target in [m[1] for m in LINK.findall(outside)] + [m[0] for m in EVIDENT.findall(outside)]:
            found = _target(page, target)
            if found is None or not found.is_file():
                continue
            if found.suffix == ".md":
                waiting += [found] * (found not in waiting)
            elif found.stat().st_size < BIGGEST:
                _copy(found)


def command_line() -> str:
    """Every command with its arguments and options, as typer writes them."""
    from typer.cli import get_docs_for_click
    from typer.main import get_command

    from dualpin.cli.main import program

    command = get_command(program())
    text = get_docs_for_click(obj=command, ctx=command.context_class(command, info_name="dualpin"), name="dualpin")
    return re.sub(r"<(?=[A-Za-z])", "&lt;", text)  # "a <mimic> tag" is no markup


def build(site: Path = SITE) -> int:
    """Stage, and let Zensical build; a warning is an error."""
    stage()
    done = subprocess.run([sys.executable, "-m", "zensical", "build", "--clean", "--strict"], cwd=ROOT, check=False)
    if done.returncode == 0:
        _search_from_disk()
    if done.returncode == 0 and site != SITE:
        shutil.copytree(SITE, site, dirs_exist_ok=True)
    return done.returncode


def _search_from_disk() -> None:
    """A page that was opened from the disk may not start a worker from a file: it gets the worker's text."""
    scripts = SITE / "assets" / "javascripts"
    (worker,) = (scripts / "workers").glob("search.*.js")
    text = json.dumps(worker.read_text(encoding="utf-8"))
    (scripts / "from-disk.js").write_text(FROM_DISK.replace("TEXT", text), encoding="utf-8")


def _summary() -> None:
    from dualpin import report

    results = [path for pattern in RESULTS for path in sorted((ROOT / EVIDENCE).glob(pattern))]
    if results:
        text = report.page(*(report.read(path) for path in results), title="dualpin: committed results")
        (STAGE / SUMMARY).write_text(text, encoding="utf-8")


def _moved(text: str, page: Path) -> str:
    """Links to the repository become links of the site; folders, which have no page, their names."""
    up = "../" * _uri(page).count("/")
    text = EVIDENT.sub(lambda m: f"- [{m[2]}]({m[1]})\n" if _exists(page, m[1]) else "", text)
    # "a[i-1] [m]" in the head of a table is no link
    text = re.sub(r"^\|.*", lambda m: m[0].replace("] [", "]&#32;["), text, flags=re.M)

    def moved(match: re.Match[str]) -> str:
        found = _target(page, match[2])
        return match[0] if found is None else match[1] + up + _uri(found) + match[3]

    text = FOLDER.sub(lambda m: m[1] if (_target(page, m[2]) or page).is_dir() else m[0], text)
    text = DARK.sub(lambda m: _two_pictures(m, page), text)
    return LINK.sub(moved, text)


def _two_pictures(match: re.Match[str], page: Path) -> str:
    """A picture that has a dark one beside it (report.png, report-dark.png) becomes both; the theme shows one."""
    alt, name, suffix = match.groups()
    if _target(page, f"{name}-dark{suffix}") is None:
        return match[0]
    return f"![{alt}]({name}{suffix}#only-light)![{alt}]({name}-dark{suffix}#only-dark)"


def _exists(page: Path, link: str) -> bool:
    """Whether evidence is there yet."""
    return (link == SUMMARY and (STAGE / SUMMARY).exists()) or _target(page, link) is not None


def _target(page: Path, link: str) -> Path | None:
    """The file or folder of the repository that a relative link means; None for any other link."""
    if re.match(r"[a-z]+:|/", link):
        return None
    found = (page.parent / link).resolve()
    return found if found.exists() and ROOT in found.parents else None


def _uri(path: Path) -> str:
    """Where a file of the repository lies in the site."""
    return path.relative_to(ROOT).as_posix().removeprefix("docs/")


def _copy(path: Path) -> None:
    to = STAGE / _uri(path)
    to.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, to)


def _write(path: Path, text: str) -> None:
    to = STAGE / _uri(path)
    to.parent.mkdir(parents=True, exist_ok=True)
    to.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    sys.exit(build(*map(Path, sys.argv[1:2])))
