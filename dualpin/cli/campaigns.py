"""`dualpin campaign`: the contents of a store of results."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from ..errors import ArgumentError
from .app import Json, app, show_json

campaigns = typer.Typer(help="Look into stores of `dualpin validate --store` and `dualpin fuzz`.", no_args_is_help=True)
app.add_typer(campaigns, name="campaign")


@campaigns.command()
def status(store: Annotated[Path, typer.Argument(metavar="STORE")], json: Json = False) -> None:
    """Print how far each campaign of a store is, its verdicts, rate and remaining time.

    The campaign may be running.  Exit code 1 if one is not complete.
    """
    from ..crosscheck.campaign import Store

    if not store.is_file():
        raise ArgumentError(f"campaign status: {store} is no file; the one given to --store expected")
    found = Store(store).progress()
    if json:
        show_json([{**vars(p), "remaining_minutes": p.remaining if p.rate else None} for p in found])
    else:
        from .show import console, table

        rows = table("campaign", "what", "done>", "units>", "verdicts", "units/min>", "latest", "remaining>")
        for p in found:
            asked = {k: p.settings[k] for k in ("robots", "samples", "seed", "engine") if k in p.settings}
            left = "-" if p.done == p.units else f"{p.remaining:.0f} min" if p.rate else "?"
            rows.add_row(
                p.id, ", ".join(f"{k} {v}" for k, v in asked.items()), str(p.done), str(p.units),
                ", ".join(f"{n} {v}" for v, n in sorted(p.verdicts.items())), f"{p.rate:.3g}",
                time.strftime("%Y-%m-%d %H:%M", time.localtime(p.latest)), left,
            )  # fmt: skip
        console().print(rows)
    raise typer.Exit(1 if any(p.done < p.units for p in found) else 0)
