"""Print pip constraints that hold the dependencies of the installed dualpin at their declared lower bounds.

python -m tests.smoke.lowest exact integrators
"""

from __future__ import annotations

import re
import sys
from importlib.metadata import requires


def lowest(requirements: list[str], extras: list[str]) -> list[str]:
    """'name>=1.2' as 'name==1.2', for the core dependencies and those of the extras named."""
    found = []
    for line in requirements:
        need, _, marker = line.partition(";")
        extra = re.search(r"""extra == ['"]([^'"]+)""", marker)
        if need.strip().startswith("dualpin") or (extra and extra[1] not in extras):
            continue
        marker = re.sub(r"(\s*and\s*)?\(?extra == ['\"][^'\"]+['\"]\)?", "", marker)
        match = re.match(r"\s*([A-Za-z0-9._-]+)\s*>=\s*([0-9.]+)", need)
        if match is None:
            raise SystemExit(f"{need.strip()!r}: a lower bound (name>=version) expected")
        found.append(f"{match[1]}=={match[2]}" + (f"; {marker.strip()}" if marker.strip() else ""))
    return found


if __name__ == "__main__":
    print("\n".join(dict.fromkeys(lowest(requires("dualpin") or [], sys.argv[1:]))))
