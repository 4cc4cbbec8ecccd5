"""Parameter files of figaroh: standard parameters as a flat mapping, and results in base parameters.

    m_JOINT: 2.5          mx, my, mz; Ixx, Ixy, Iyy, Ixz, Iyz, Izz; Ia (rotor); fv, fs (friction); off (offset)

    parameter_names: [Izz_j1 + 0.25*m_j2, ...]     base_parameters: [...]     standard_deviation: [...]

Its inertial parameters are those of dualpin: of Pinocchio's bodies, about the joint frame's origin.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ArgumentError, nearest
from ...extras import extra
from ...files import write_text
from ...model.robot import Robot
from .base import BaseParameters
from .fit import Identification
from .parameters import Parameters

THEIRS = {
    "m": "m", "hx": "mx", "hy": "my", "hz": "mz", "Jxx": "Ixx", "Jxy": "Ixy", "Jyy": "Iyy", "Jxz": "Ixz",
    "Jyz": "Iyz", "Jzz": "Izz", "rotor": "Ia", "viscous": "fv", "coulomb": "fs", "offset": "off",
}  # fmt: skip
VALUES = ("base_parameters", "base parameters values")
NAMES = ("parameter_names", "base parameters names")


def names(parameters: Parameters) -> list[str]:
    """Names of parameters in figaroh: "hx[elbow]" is "mx_elbow"."""
    found = []
    for name in parameters.names:
        symbol, _, joint = name.partition("[")
        found.append(f"{THEIRS[symbol]}_{joint.removesuffix(']')}")
    return found


def to_figaroh(of: Robot | Identification, path: str | PathLike[str] | None = None, *, base: bool = False) -> str:
    """The YAML that figaroh reads: all parameters, or (``base=True``) results in base parameters.

    Parameters
    ----------
    of : Robot or Identification
    path : str or path, optional
        Where to write it too.
    base : bool

    Returns
    -------
    str

    Raises
    ------
    ArgumentError
        If it is neither a robot nor an identification, or `base` is asked of a robot.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.analysis.identification import to_figaroh
    >>> to_figaroh(dp.load("ur5")).splitlines()[0]
    'm_shoulder_pan_joint: 3.7'
    """
    yaml = extra("yaml", "identify", "to_figaroh")
    if isinstance(of, Robot):
        if base:
            raise ArgumentError("to_figaroh: base=True needs an Identification; a robot has its description only")
        parameters = Parameters.of("to_figaroh", of)
        document: dict[str, Any] = dict(zip(names(parameters), parameters.nominal.tolist(), strict=True))
    elif not isinstance(of, Identification):
        raise ArgumentError(f"to_figaroh: a Robot or an Identification expected, got {type(of).__name__}")
    elif base:
        document = {
            "base_parameters": of.values.tolist(),
            "condition_number": float(of.condition),
            "parameter_names": expressions(of.base),
            "rmse_norm": float(np.sqrt(np.nanmean(of.residuals**2))),
            "standard_deviation": of.deviation.tolist(),
        }
    else:
        document = dict(zip(names(of.base.parameters), of.parameters.tolist(), strict=True))
    text: str = yaml.safe_dump(document, sort_keys=False, default_flow_style=False, width=1_000_000)
    if path is not None:
        write_text(path, text)
    return text


def expressions(base: BaseParameters) -> list[str]:
    """The regrouped parameters as figaroh writes them: "Izz_j1 + 0.25*m_j2"."""
    theirs, found = names(base.parameters), []
    for row, first in zip(base.grouping, base.columns, strict=True):
        others = [i for i in np.flatnonzero(row) if i != first]
        parts = [f" {'-' if row[i] < 0 else '+'} {abs(float(row[i]))!r}*{theirs[i]}" for i in others]
        found.append(theirs[first] + "".join(parts))
    return found


def from_figaroh(robot: Robot, file: str | PathLike[str]) -> np.ndarray:
    """All parameters of a robot, shape (n,) as `dualpin.inertial_parameters`, from a file of figaroh.

    Of results in base parameters: the parameters nearest to the description that have these values.
    Rotors and friction in the file are left out; `read_figaroh` returns them too.

    Parameters
    ----------
    robot : Robot
    file : str or path

    Returns
    -------
    ndarray, shape (10 njoints,)

    Raises
    ------
    ArgumentError
        If the file is none of these, or names a joint that the robot does not have.

    Examples
    --------
    >>> import tempfile, pathlib, dualpin as dp
    >>> from dualpin.analysis.identification import from_figaroh, to_figaroh
    >>> robot = dp.load("ur5")
    >>> file = pathlib.Path(tempfile.mkdtemp(), "ur5.yaml")
    >>> _ = to_figaroh(robot, file)
    >>> from_figaroh(robot, file).shape
    (60,)
    """
    parameters, values = read_figaroh(robot, file)
    return values[: parameters.inertial]


def read_figaroh(robot: Robot, file: str | PathLike[str]) -> tuple[Parameters, np.ndarray]:
    """The parameters that a file of figaroh names, rotors and friction included, and their values.

    Parameters
    ----------
    robot : Robot
    file : str or path

    Returns
    -------
    parameters : Parameters
    values : ndarray, shape (len(parameters),)

    Raises
    ------
    ArgumentError
        As of `from_figaroh`.

    Examples
    --------
    >>> import tempfile, pathlib, dualpin as dp
    >>> from dualpin.analysis.identification import read_figaroh, to_figaroh
    >>> robot = dp.load("ur5")
    >>> file = pathlib.Path(tempfile.mkdtemp(), "ur5.yaml")
    >>> _ = to_figaroh(robot, file)
    >>> parameters, values = read_figaroh(robot, file)
    >>> parameters.names[0], float(values[0])
    ('m[shoulder_pan_joint]', 3.7)
    """
    document = _document(file)
    of_base = next((k for k in VALUES if k in document), None)
    listed = next((document[k] for k in NAMES if k in document), None)
    flat = {k: document[k] for k in document} if of_base is None else {}
    terms = _terms(listed or []) if of_base else [{k: 1.0} for k in flat]
    symbols = {name.partition("_")[0] for term in terms for name in term}
    friction = tuple(model for model in ("viscous", "coulomb", "offset") if THEIRS[model] in symbols)
    parameters = Parameters.of("from_figaroh", robot, "Ia" in symbols, friction)
    numbers = _numbers(document[of_base] if of_base else list(flat.values()), len(terms), file)
    where = {name: i for i, name in enumerate(names(parameters))}
    A = np.zeros((len(terms), len(where)))
    for row, term in zip(A, terms, strict=True):
        for name, factor in term.items():
            if name not in where:
                raise ArgumentError(f"{fspath(file)}: {name!r} is no parameter of {robot.name}; {nearest(name, where)}")
            row[where[name]] += factor
    p = parameters.nominal
    return parameters, p + np.linalg.pinv(A, rcond=1e-12) @ (numbers - A @ p)


def _document(file: str | PathLike[str]) -> Mapping[str, Any]:
    yaml = extra("yaml", "identify", "from_figaroh")
    try:
        document = yaml.safe_load(Path(file).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as e:
        raise ArgumentError(f"{fspath(file)}: cannot be read ({e})") from None
    except yaml.YAMLError as e:
        raise ArgumentError(f"{fspath(file)}: no YAML ({' '.join(str(e).split())})") from None
    if not isinstance(document, dict) or not document or not all(isinstance(k, str) for k in document):
        raise ArgumentError(f"{fspath(file)}: a mapping of parameters such as m_JOINT: 2.5 expected")
    return document


def _terms(expressions: Any) -> list[dict[str, float]]:
    """ "Izz_j1 - 0.25*m_j2" as {"Izz_j1": 1.0, "m_j2": -0.25}."""
    found: list[dict[str, float]] = []
    for text in expressions:
        sign, term = 1.0, dict[str, float]()
        for word in str(text).split():
            if word in ("+", "-"):
                sign = 1.0 if word == "+" else -1.0
                continue
            factor, star, name = word.partition("*")
            if star and not re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", factor):
                raise ArgumentError(f"from_figaroh: {word!r} in {text!r}: a number before * expected")
            own = name if star else factor
            term[own] = term.get(own, 0.0) + sign * (float(factor) if star else 1.0)
            sign = 1.0
        found.append(term)
    return found


def _numbers(values: Any, count: int, file: Any) -> np.ndarray:
    try:
        x = np.array(values, dtype=float)
    except (TypeError, ValueError):
        x = np.array(np.nan)
    if x.shape != (count,) or not np.isfinite(x).all():
        raise ArgumentError(f"{fspath(file)}: {count} finite numbers expected, one for each parameter it names")
    return x
