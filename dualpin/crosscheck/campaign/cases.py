"""The robots of a campaign."""

from __future__ import annotations

import warnings

from ...errors import ArgumentError, DualpinError, DualpinWarning
from ...io.catalogue import catalogue, find
from ...io.urdf import load
from ..checks import Case


def all_cases() -> list[Case]:
    """Every URDF file of example-robot-data, on a fixed and a floating base, and with mimic where it has any.

    Returns
    -------
    list of Case

    Raises
    ------
    ArgumentError
        If example-robot-data is not installed.

    Examples
    --------
    >>> from dualpin.crosscheck.campaign import all_cases
    >>> {case.floating for case in all_cases() if case.name == "panda"}
    {False, True}
    """
    names = list(catalogue())
    if not names:
        raise ArgumentError("--all needs the robots of example-robot-data (pip install example-robot-data)")
    cases = []
    for name in names:
        cases += [Case(name), Case(name, floating=True)]
        if _coupled(name):
            cases.append(Case(name, mimic=True))
    return cases


def _coupled(name: str) -> bool:
    if b"mimic" not in find(name).read_bytes():
        return False  # without reading all of it as a robot
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        try:
            return load(name, mimic=True).coupled
        except DualpinError:
            return False  # its refusal is reported of the fixed and the floating base
