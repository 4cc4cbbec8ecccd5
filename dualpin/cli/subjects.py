"""`dualpin subjects`: the libraries that can be judged, each in an environment of its own."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from .app import Json, app, show_json

subjects = typer.Typer(
    help="List, install and remove the libraries that `dualpin judge` knows by name.", no_args_is_help=True
)
app.add_typer(subjects, name="subjects")
Names = Annotated[
    list[str], typer.Argument(metavar="NAME...", help="Shipped names (mujoco, mujoco==3.12.0), or files of adapters.")
]


@subjects.command("list")
def listed(json: Json = False) -> None:
    """Print the shipped subjects: what they require, whether they are installed, their size and terms."""
    from ..crosscheck.subjects import environments

    rows = [_facts(environments.environment(name)) for name in environments.shipped()]
    if json:
        show_json(rows)
        return
    from .show import console, table

    listing = table(
        "subject", "requires", "installed", "MiB>", "terms", title=f"environments in {environments.folder()}"
    )
    for r in rows:
        size = f"{r['mebibytes']}" if r["mebibytes"] is not None else "-"
        listing.add_row(r["name"], ", ".join(r["requires"]), r["installed"], size, ", ".join(r["terms"]))
    console().print(listing)


@subjects.command()
def install(names: Names) -> None:
    """Make an environment for each subject and install its library there."""
    from ..crosscheck.subjects import environments

    for name in names:
        found = environments.install(name, lambda what: print(what, file=sys.stderr))
        facts = found.facts()
        print(f"{found.name}: {', '.join(found.requires)}; {facts['mebibytes']} MiB, {facts['seconds']} s")


@subjects.command()
def remove(names: Names) -> None:
    """Remove environments."""
    from ..crosscheck.subjects import environments

    for name in names:
        print(f"{name}: {'removed' if environments.remove(name) else 'was not installed'}")


def _facts(found: Any) -> dict[str, Any]:
    from ..crosscheck.subjects import QUESTIONS, environments

    installed = "yes" if found.ready else "no"
    if not found.ready and importable(found.requires):
        installed = "in this environment"
    return {
        "name": found.name, "requires": list(found.requires), "installed": installed,
        "mebibytes": found.facts().get("mebibytes"), "terms": environments.terms(Path(found.adapter), tuple(QUESTIONS)),
    }  # fmt: skip


def importable(requires: tuple[str, ...]) -> bool:
    """Whether the distributions are installed beside dualpin, whatever their version."""
    from importlib import metadata

    try:
        for requirement in requires:
            metadata.version(requirement.partition("==")[0])
    except metadata.PackageNotFoundError:
        return False
    return bool(requires)
