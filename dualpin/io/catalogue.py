"""Which robots there are by name: those of the installed example-robot-data, and the models that ship with dualpin."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from ..errors import UrdfError, nearest
from .expand import expanded, is_xacro

PACKAGE = "example-robot-data"

ALIASES = {
    "allegro_left": "allegro_left_hand",
    "allegro_right": "allegro_right_hand",
    "anymal_b": "anymal_b_simple_description/anymal",
    "anymal_c": "anymal_c_simple_description/anymal",
    "anymal_kinova": "anymal-kinova",
    "asr_twodof": "TwoDofs",
    "b1_z1": "b1-z1",
    "borinot": "borinot_flying_arm_2",
    "g1": "g1_29dof_rev_1_0",
    "g1_with_hand": "g1_29dof_with_hand_rev_1_0",
    "hextilt": "hextilt_flying_arm_5",
    "hyq": "hyq_no_sensors",
    "solo8": "solo",
    "talos": "talos_reduced",
    "talos_arm": "talos_left_arm",
    "talos_box": "talos_reduced_box",
    "talos_full": "talos_full_v2",
    "talos_full_box": "talos_full_v2_box",
    "ur10": "ur10_robot",
    "ur10_limited": "ur10_joint_limited_robot",
    "ur3_limited": "ur3_joint_limited_robot",
    "ur5": "ur5_robot",
    "ur5_limited": "ur5_joint_limited_robot",
}
"""Short names, beside the files' own stems."""


@cache
def data_folder() -> Path | None:
    """The folder `robots` of the installed example-robot-data, or None."""
    candidates = [Path(p, "cmeel.prefix", "share", PACKAGE, "robots") for p in sys.path if p]
    try:
        files = metadata.files(PACKAGE) or []
        inside = next((f for f in files if "robots" in f.parts), None)
        if inside is not None:
            place = Path(str(inside.locate()))
            candidates += [p for p in place.parents if p.name == "robots"]
    except metadata.PackageNotFoundError:
        pass
    prefixes = [sys.prefix, *os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep), "/usr", "/usr/local"]
    candidates += [Path(p, "share", PACKAGE, "robots") for p in prefixes if p]
    return next((c for c in candidates if c.is_dir()), None)


@cache
def catalogue() -> dict[str, Path]:
    """Every URDF file of example-robot-data: name -> path, sorted.

    The name is the file's stem, qualified by its robot's folder where two files share it.

    Returns
    -------
    dict of str to Path

    Examples
    --------
    >>> from dualpin.io import catalogue
    >>> catalogue()["panda"].name
    'panda.urdf'
    """
    folder = data_folder()
    if folder is None:
        return {}
    files = sorted(folder.rglob("*.urdf"))
    count = Counter(f.stem for f in files)
    return {(f.stem if count[f.stem] == 1 else f"{f.relative_to(folder).parts[0]}/{f.stem}"): f for f in files}


@cache
def shipped() -> dict[str, Path]:
    """The models that ship with dualpin: name -> path, sorted; in a checkout they lie beside the package."""
    package = Path(__file__).parents[1]
    folder = next((f for f in (package / "urdf", package.parent / "urdf") if f.is_dir()), None)
    return {} if folder is None else {f.stem: f for f in sorted(folder.glob("*/*.urdf"))}


def find(
    name: str | os.PathLike[str],
    xacro_args: Mapping[str, Any] | None = None,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
) -> Path:
    """The file of a robot's name, alias or path; of an xacro file the URDF that it expands to.

    Parameters
    ----------
    name : str or path
    xacro_args, packages : mapping, optional
        As of `dualpin.load`.

    Returns
    -------
    Path

    Raises
    ------
    UrdfError
        With the nearest names, or with what to install.

    Examples
    --------
    >>> from dualpin.io import find
    >>> find("panda").name
    'panda.urdf'
    """
    text = os.fspath(name)
    if not text:
        raise UrdfError("the robot's name is empty; a URDF file or a name of `dualpin list` expected")
    robots = catalogue()
    known = robots.get(ALIASES.get(text, text)) or shipped().get(text)
    if known is not None and not (isinstance(name, os.PathLike) and Path(text).exists()):
        return known
    try:
        path = Path(text).expanduser()
        here = path.is_file()
        if not here and path.exists():
            raise UrdfError(
                f"{text}: a URDF file expected, this is {'a folder' if path.is_dir() else 'not a regular file'}"
            )
    except (OSError, RuntimeError, ValueError) as e:  # too long, not permitted, no such user's home, null bytes
        shown = text if len(text) <= 60 else text[:57] + "..."
        raise UrdfError(f"{shown!r}: not a path that can be opened ({getattr(e, 'strerror', None) or e})") from None
    if here:
        return expanded(path, xacro_args, packages) if is_xacro(path) else path
    if path.suffix.lower() in (".urdf", ".xml", ".xacro", ".sdf"):
        raise UrdfError(f"{text}: no such file")
    if not robots:
        raise UrdfError(
            f"{text!r} is no file, and robots by name need the package {PACKAGE} (pip install {PACKAGE}); "
            f"{nearest(text, [*shipped()], 'models that ship with dualpin')}"
        )
    raise UrdfError(
        f"{text!r} is neither a file nor a robot of {PACKAGE}; "
        f"{nearest(text, [*ALIASES, *robots, *shipped()], 'robots')}; "
        "`dualpin list` prints them all"
    )
