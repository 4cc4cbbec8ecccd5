"""The figures of the paper from committed results, and its PDF where pandoc is installed:  python paper/build.py"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
VALIDATION = HERE.parent / "validation"
MEASURED = "amd-epyc-znver4.json"  # the processor that the paper names
COLOURS = ("#1b6ca8", "#b9bec4")


def errors() -> None:
    """The worst scaled error of each term over all robots of the campaign."""
    import matplotlib.pyplot as plt

    worst: dict[str, float] = {}
    for robot in json.loads((VALIDATION / "results" / "report.json").read_text(encoding="utf-8"))["robots"]:
        for term, found in robot["terms"].items():
            if found["status"] == "agrees":
                worst[term] = max(worst.get(term, 0.0), found["max_scaled_error"])
    terms = sorted(worst, key=lambda t: worst[t])
    figure, axes = plt.subplots(figsize=(6.5, 4.2))
    axes.barh(terms, [worst[t] for t in terms], color=COLOURS[0], left=1e-16)
    axes.set(xscale="log", xlim=(1e-16, 1e-4), xlabel="worst scaled error, max|x - ref| / max(1, max|ref|)")
    axes.tick_params(labelsize=7)
    _save(figure, "errors.png")


def speed() -> None:
    """Microseconds a sample beside Pinocchio's."""
    import matplotlib.pyplot as plt
    import numpy as np

    rows = json.loads((VALIDATION / "benchmarks" / "results" / MEASURED).read_text(encoding="utf-8"))["main"]
    rows = [r for r in rows if r["batch"] == 4096 and not r["floating"] and r["term"] in ("rnea", "aba", "crba")]
    names = [f"{r['robot']}  {r['term']}" for r in rows]
    places = np.arange(len(rows))
    figure, axes = plt.subplots(figsize=(6.5, 0.22 * len(rows) + 1))
    for k, (key, label) in enumerate((("us_per_sample", "dualpin"), ("pinocchio_us_per_sample", "Pinocchio 4.1"))):
        axes.barh(places + 0.4 * k, [r[key] for r in rows], 0.4, color=COLOURS[k], label=label)
    axes.set_yticks(places + 0.2, names)
    axes.set(xscale="log", xlabel="microseconds a sample")
    axes.invert_yaxis()
    axes.tick_params(labelsize=7)
    axes.legend(fontsize=7)
    _save(figure, "speed.png")


def _save(figure, name: str) -> None:
    figure.tight_layout()
    figure.savefig(HERE / name, dpi=200, metadata={"Software": None})


def pandoc() -> str | None:
    """The program, of the system or of the package `pypandoc_binary`."""
    found = shutil.which("pandoc")
    if found is None:
        try:
            import pypandoc

            found = pypandoc.get_pandoc_path()
        except (ImportError, OSError):
            return None
    return found


def pdf() -> Path | None:
    """paper.pdf by whatever sets type here (a TeX, or Typst); None where pandoc or that is missing."""
    program = pandoc()
    if program is None:
        return None
    out, source = HERE / "paper.pdf", ["--citeproc", "paper.md"]
    engine = next((e for e in ("tectonic", "xelatex", "lualatex", "pdflatex", "typst") if shutil.which(e)), None)
    if engine is not None:
        subprocess.run([program, *source, f"--pdf-engine={engine}", "-o", out.name], cwd=HERE, check=True)
        return out
    try:
        import typst
    except ImportError:
        return None
    text = HERE / "paper.typ"
    subprocess.run([program, *source, "--standalone", "-t", "typst", "-o", text.name], cwd=HERE, check=True)
    out.write_bytes(typst.compile(str(text)))
    text.unlink()
    return out


if __name__ == "__main__":
    errors()
    speed()
    if "--figures" not in sys.argv:
        made = pdf()
        print(made or "no PDF: pandoc and a TeX, or `pip install pypandoc_binary typst`, are needed", file=sys.stderr)
