"""The site holds files that lie outside docs/: evidence, recipes, and every file that a page links to.

A page in docs/ says ``../validation/dh/README.md``, as it must to be readable in the repository; in
the site that file lies at ``validation/dh/README.md``.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

from dualpin import report

ROOT = Path(__file__).parent.parent
PAGES = ("CONTRIBUTING.md", "CHANGELOG.md")
EVIDENCE = "validation"
LINK = re.compile(r"(\]\()([^)#\s]+)((?:#[^)\s]*)?\))")
FOLDER = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)#\s]+)\)")
BIGGEST = 5_000_000  # bytes of a file that is linked
EVIDENT = re.compile(r"^<!-- evidence: (\S+) (.*?) -->\n", re.M)
RESULTS = ("results/report.json", "benchmarks/results.json", "integrators/results.json")
PAGE = "evidence.html"  # what `dualpin report` makes of the results
FENCE = re.compile(r"^```.*?^```", re.M | re.S)


def on_files(files: Files, config: Any) -> Files:
    """Add the pages outside docs/, then whatever any page links to."""
    known = {f.src_uri for f in files}
    waiting = [(f.src_uri, Path(f.abs_src_path)) for f in files if f.src_uri.endswith(".md")]
    for path in [*(ROOT / p for p in PAGES), *sorted((ROOT / EVIDENCE).rglob("*.md"))]:
        uri = path.relative_to(ROOT).as_posix()
        if path.exists() and uri not in known:
            known.add(uri)
            waiting.append((uri, path))
            files.append(File.generated(config, uri, abs_src_path=str(path)))
    results = [ROOT / EVIDENCE / r for r in RESULTS if (ROOT / EVIDENCE / r).exists()]
    if results:
        studies = (report.read(path) for path in results)
        text = report.page(*studies, title="dualpin: committed results")
        files.append(File.generated(config, PAGE, content=text))
    for _, path in waiting:
        text = FENCE.sub("", path.read_text(encoding="utf-8"))
        linked = [m[1] for m in LINK.findall(text)] + [m[0] for m in EVIDENT.findall(text)]
        for target in linked:
            found = _target(path, target)
            if found is None:
                continue
            new = _uri(found)
            if new not in known and found.is_file() and found.stat().st_size < BIGGEST:
                known.add(new)
                files.append(File.generated(config, new, abs_src_path=str(found)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Turn links to the repository into links of the site; folders, which have no page, into their names."""
    path = ROOT / page.file.src_uri
    if not path.exists():
        path = ROOT / "docs" / page.file.src_uri
    depth = page.file.src_uri.count("/")
    markdown = EVIDENT.sub(lambda m: f"- [{m[2]}]({m[1]})\n" if _exists(path, m[1], files) else "", markdown)
    # "a[i-1] [m]" in the head of a table is no link
    markdown = re.sub(r"^\|.*", lambda m: m[0].replace("] [", "]&#32;["), markdown, flags=re.M)

    def moved(match: re.Match[str]) -> str:
        found = _target(path, match[2])
        if found is None:
            return match[0]
        return match[1] + "../" * depth + _uri(found) + match[3]

    markdown = FOLDER.sub(lambda m: m[1] if (_target(path, m[2]) or path).is_dir() else m[0], markdown)
    return LINK.sub(moved, markdown)


def _exists(page: Path, link: str, files: Files) -> bool:
    """Whether evidence is there yet."""
    return (link == PAGE and files.get_file_from_path(PAGE) is not None) or _target(page, link) is not None


def _target(page: Path, link: str) -> Path | None:
    """The file or folder of the repository that a relative link means; None for any other link."""
    if re.match(r"[a-z]+:|/", link):
        return None
    found = (page.parent / link).resolve()
    return found if found.exists() and ROOT in found.parents else None


def _uri(path: Path) -> str:
    """Where a file of the repository lies in the site."""
    uri = path.relative_to(ROOT).as_posix()
    return uri.removeprefix("docs/")
