"""Versions, processor, date and sources, for all reports, benchmarks and what is kept between runs."""

from __future__ import annotations

import hashlib
import platform
from datetime import datetime, timezone
from functools import cache
from importlib import metadata
from pathlib import Path

PACKAGES = ("numpy", "yourdfpy", "lxml", "llvmlite", "example-robot-data")


def processor() -> str:
    """The processor's name, such as "AMD EPYC 9R14"."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown processor"


def package(name: str) -> str:
    """The version of an installed package, or "absent"."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "absent"


def versions(**more: str) -> dict[str, str]:
    """Versions of the relevant packages, the machine, and the date."""
    from . import __version__

    return {
        "dualpin": __version__,
        "python": platform.python_version(),
        **{name: package(name) for name in PACKAGES},
        "machine": f"{platform.machine()}, {processor()}",
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%d"),
        **more,
    }


@cache
def sources() -> str:
    """A hash of the whole package: a result of other code is another result."""
    root = Path(__file__).parent
    total = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        total.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return total.hexdigest()[:16]
