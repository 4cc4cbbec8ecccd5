"""`dualpin cache`: the compiled kernels on disk."""

from __future__ import annotations

import typer

from .app import Json, app, show_json

cache = typer.Typer(help="Look at or empty the folder of compiled kernels.", no_args_is_help=True)
app.add_typer(cache, name="cache")


@cache.command()
def info(json: Json = False) -> None:
    """Print where compiled kernels are kept, how many, and how large."""
    from ..engine.jit import cache as disk

    _show(disk.info(), json)


@cache.command()
def clear(json: Json = False) -> None:
    """Remove every compiled kernel."""
    from ..engine.jit import cache as disk

    _show(disk.clear(), json)


def _show(facts: dict[str, object], json: bool) -> None:
    if json:
        show_json(facts)
        return
    width = max(map(len, facts), default=0)
    for key, value in facts.items():
        print(f"{key.ljust(width)}  {value}")
