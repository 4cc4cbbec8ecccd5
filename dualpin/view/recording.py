"""A scene, and what it plays, as one page that opens without a server."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import ArgumentError
from ..files import write_text, writing


def record(viewer: Any, path: str | PathLike[str], fps: float = 30.0) -> None:
    """Write the scene as it is, and the viewer's sequence in its own time, as HTML.

    Raises
    ------
    ArgumentError
        If the name does not end in .html, or the file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() not in (".html", ".htm"):
        raise ArgumentError(f"view: record: {path} ends in {path.suffix!r}; .html expected")
    if not 0 < fps <= 240:
        raise ArgumentError(f"view: record: fps = {fps!r}; a number above 0, at most 240, expected")
    before = viewer.q
    serializer = viewer.server.get_scene_serializer()
    if len(viewer.sequence):
        span = viewer.times[-1] - viewer.times[0]
        for now in np.arange(0.0, span + 1.0 / fps, 1.0 / fps):
            k = min(np.searchsorted(viewer.times, viewer.times[0] + now), len(viewer.sequence) - 1)
            viewer.update(viewer.sequence[k])
            viewer.server.flush()
            serializer.insert_sleep(1.0 / fps)
    text = serializer.as_html(dark_mode=viewer.dark)
    viewer.update(before)
    with writing(f"view: record: cannot write {path}"):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, text)
