"""A bar for long work."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any


class Progress:
    """A bar on stderr with rate and remaining time; nothing where stderr is no terminal."""

    def __init__(self, what: str, total: int) -> None:
        self.what, self.total = what, total
        self.bar: Any = None

    def __enter__(self) -> Callable[[Any, int, int], None]:
        if self.total > 1 and sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import (
                BarColumn,
                MofNCompleteColumn,
                Progress,
                ProgressColumn,
                TextColumn,
                TimeRemainingColumn,
            )
            from rich.text import Text

            class Rate(ProgressColumn):
                def render(self, task: Any) -> Text:
                    return Text(f"{60 * task.speed:.3g}/min" if task.speed else "", style="progress.data.speed")

            columns = (
                TextColumn("{task.description}"),
                BarColumn(),
                MofNCompleteColumn(),
                Rate(),
                TimeRemainingColumn(),
            )
            self.bar = Progress(*columns, console=Console(stderr=True), transient=True)
            self.bar.start()
            self.task = self.bar.add_task(self.what, total=self.total)
        return self.tick

    def tick(self, result: Any, done: int, total: int) -> None:
        if self.bar:
            self.bar.update(
                self.task, completed=done, total=total, description=getattr(result, "label", result.name)[:28].ljust(28)
            )

    def __exit__(self, *_: object) -> None:
        if self.bar:
            self.bar.stop()
