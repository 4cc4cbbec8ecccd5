"""Run xacro on one file: a program of its own, so that it can be stopped and leaves nothing behind.

It reads {"file", "args", "packages", "folders"} as JSON from standard input and writes {"text"} or {"error"}
to standard output.  It imports nothing of dualpin.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

PACKAGE = "package://"


def located(name: str, folder: Path, path_of: Any) -> str:
    """The absolute path of a mesh's file, where it can be resolved; otherwise the name unchanged."""
    if name.startswith(PACKAGE):
        package, _, rest = name.removeprefix(PACKAGE).partition("/")
        try:
            return f"file://{Path(path_of(package), rest)}"
        except Exception:  # not found, by whatever exception: the name is left as it is
            return name
    if "://" in name or Path(name).is_absolute():
        return name
    return f"file://{folder / name}"


def expanded(job: dict[str, Any]) -> str:
    """The URDF of an xacro file."""
    import xacro
    from xacrodoc import packages  # finds packages without a ROS installation, also for xacro's $(find ...)

    file = Path(job["file"])
    packages.walk_up_from(file.parent)
    if job["folders"]:
        packages.look_in(job["folders"])
    packages.update_package_cache(job["packages"])
    try:
        text = xacro.process_file(str(file), mappings=job["args"]).toprettyxml(indent="  ")
    except Exception as e:  # expressions of a file raise what they like
        inner = [Path(x).name for x in xacro.filestack or [] if x and x != str(file)]
        raise ValueError(f"{e}{f' (in {inner[-1]})' if inner else ''}") from e
    from lxml import etree

    root = etree.fromstring(text.encode(), etree.XMLParser(resolve_entities=False, no_network=True))
    for mesh in root.iter("mesh"):
        if mesh.get("filename"):
            mesh.set("filename", located(mesh.get("filename"), file.parent, packages.get_path))
    return str(etree.tostring(root, encoding="unicode"))


def main() -> None:
    """One job."""
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # standard output is for the result: what xacro prints goes to standard error
    job = json.load(sys.stdin)
    try:
        answer = {"text": expanded(job)}
    except SystemExit as e:
        answer = {"error": f"xacro ended with code {e.code}"}
    except Exception as e:  # expressions of a file raise what they like
        answer = {"error": str(e)}
    json.dump(answer, out)
    out.close()


if __name__ == "__main__":
    main()
