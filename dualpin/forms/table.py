"""The Denavit-Hartenberg table: dual angles, with the four usual columns as a view of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..algorithms.kinematics import frame_pose
from ..delegates import home
from ..dual import Dual
from ..errors import ArgumentError
from ..functions import fk
from ..model.robot import Robot
from ..renamed import Renamed
from ..scalars import Scalar
from ..spatial.pose import IDENTITY_POSE, Pose
from .chain import Chain, whole_q
from .text import write

CONVENTIONS = ("standard", "modified")


@dataclass(frozen=True)
class DHStep:
    """One step of the table: a screw about z and a screw about x, as dual angles.

    standard:  Z(theta + eps d) X(alpha + eps a);    modified:  X(alpha + eps a) Z(theta + eps d)

    NumPy sees it as its homogeneous matrix.

    Examples
    --------
    >>> import dualpin as dp
    >>> step = dp.forms.DHStep(dp.Dual(0.0, 0.5), dp.Dual(0.0, 0.2))
    >>> step.d, step.a
    (0.5, 0.2)
    """

    theta_hat: Dual
    alpha_hat: Dual
    convention: str = "standard"

    @property
    def theta(self) -> float:
        """Angle about z [rad]."""
        return float(self.theta_hat.real)

    @property
    def d(self) -> float:
        """Offset along z [m]."""
        return float(self.theta_hat.dual)

    @property
    def a(self) -> float:
        """Length along x [m]."""
        return float(self.alpha_hat.dual)

    @property
    def alpha(self) -> float:
        """Twist about x [rad]."""
        return float(self.alpha_hat.real)

    @property
    def pose(self) -> Pose:
        """The displacement at q = 0."""
        return Pose.dh(self.theta_hat, self.alpha_hat, self.convention)

    @property
    def matrix(self) -> np.ndarray:
        """The same as a homogeneous matrix, shape (4, 4)."""
        return self.pose.array

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return self.matrix.astype(dtype or float)


@dataclass(frozen=True)
class DHEnd:
    """The constant part before the first row, or after the last: a product of steps, usually one.

    NumPy sees it as its homogeneous matrix.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> tool = dp.to_dh(dp.load("panda"), tip="panda_link8").tool
    >>> np.asarray(tool).shape
    (4, 4)
    """

    steps: tuple[DHStep, ...] = ()

    def _only(self) -> DHStep:
        if len(self.steps) > 1:
            raise ArgumentError(
                f"{len(self.steps)} steps have no single theta, d, a, alpha; see .steps, .pose, .matrix"
            )
        return self.steps[0] if self.steps else DHStep(Dual(0.0, 0.0), Dual(0.0, 0.0))

    @property
    def theta_hat(self) -> Dual:
        """theta + eps d of a single step."""
        return self._only().theta_hat

    @property
    def alpha_hat(self) -> Dual:
        """alpha + eps a of a single step."""
        return self._only().alpha_hat

    @property
    def theta(self) -> float:
        """Angle about z [rad] of a single step."""
        return self._only().theta

    @property
    def d(self) -> float:
        """Offset along z [m] of a single step."""
        return self._only().d

    @property
    def a(self) -> float:
        """Length along x [m] of a single step."""
        return self._only().a

    @property
    def alpha(self) -> float:
        """Twist about x [rad] of a single step."""
        return self._only().alpha

    @property
    def pose(self) -> Pose:
        """The displacement."""
        X = IDENTITY_POSE
        for step in self.steps:
            X = X @ step.pose
        return X

    @property
    def matrix(self) -> np.ndarray:
        """The same as a homogeneous matrix, shape (4, 4)."""
        return self.pose.array

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return self.matrix.astype(dtype or float)

    def __getitem__(self, index: Any) -> Any:
        """Entries of the homogeneous matrix."""
        return self.matrix[index]

    def __matmul__(self, other: Any) -> np.ndarray:
        return self.matrix @ np.asarray(other)


@dataclass(frozen=True)
class DHRow(DHStep):
    """A row of the table: a `DHStep` whose z screw also carries the joint's coordinates.

    Attributes
    ----------
    letter : str
        "R" (theta varies), "P" (d), "C" (both), "H" (both, d by pitch times angle), "F" (none).
    joint : str or None
        The joint's name; None in a fixed row.
    q : tuple of int
        Where its coordinates lie in q of the whole robot.
    factors : tuple of float
        What each coordinate is multiplied with; 1 unless the joint follows another.
    pitch : float
        Of a helical joint [m/rad].
    """

    letter: str = "R"
    joint: str | None = None
    q: tuple[int, ...] = ()
    factors: tuple[float, ...] = ()
    pitch: float = 0.0
    kind = Renamed("letter")


@dataclass(frozen=True, eq=False)
class DHTable:
    """A serial chain as Denavit-Hartenberg rows between a base and a tool.

        T(q) = base * prod_i row_i(q_i) * tool

    With Z(theta^) and X(alpha^) screws by the dual angles theta^ = theta + eps d about z and
    alpha^ = alpha + eps a about x, this is one alternating product Z X Z X ... Z: standard
    (distal) rows pair (Z_i, X_i), modified (proximal) rows (X_{i-1}, Z_i), and what remains at the
    ends, base and tool, are dual angles too.

    Attributes
    ----------
    rows : tuple of DHRow
        Joints and, where two axes are nearly parallel, fixed rows (letter "F").
    base, tool : DHEnd
    convention : "standard" or "modified"
    notes : tuple of str
        What was snapped or inserted.

    References
    ----------
    Denavit & Hartenberg (1955); Paul (1981) for standard, Craig (1986) for modified rows;
    Hayati & Mirmirani (1985) for nearly parallel axes.
    """

    rows: tuple[DHRow, ...]
    base: DHEnd
    tool: DHEnd
    convention: str = "standard"
    name: str = "chain"
    nq: int = 0
    chain: Chain | None = None
    notes: tuple[str, ...] = field(default=())

    def __repr__(self) -> str:
        kinds = "".join(row.letter for row in self.rows)
        return f"<DHTable {self.name!r}: {self.convention}, {kinds or 'no joints'}>"

    def _repr_html_(self) -> str:
        return home("DHTable._repr_html_")(self)

    def plot(self, q: ArrayLike | None = None, axes: Any = None) -> Any:
        """Draw the frames of all rows at a configuration of the whole robot (zero by default); returns the axes.

        Needs ``pip install 'dualpin[figures]'``.
        """
        return home("DHTable.plot")(self, q, axes)

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def joints(self) -> list[str | tuple[str, float]]:
        """The kinds of the rows, as `dualpin.from_dh` takes them: a helical one with its pitch."""
        return [("H", row.pitch) if row.letter == "H" else row.letter for row in self.rows]

    @property
    def columns(self) -> np.ndarray:
        """theta, d, a, alpha of every row, shape (n, 4), in rad and m."""
        return np.array([(r.theta, r.d, r.a, r.alpha) for r in self.rows]).reshape(-1, 4)

    # the robot of the table

    @cached_property
    def robot(self) -> Robot:
        """The chain as a separate robot without masses, with a joint for each row that moves."""
        return home("DHTable.robot")(self)

    @cached_property
    def _wiring(self) -> tuple[list[int], list[float]]:
        """For each coordinate of `robot`: which of the whole robot's it is, and its factor."""
        return [i for r in self.rows for i in r.q], [f for r in self.rows for f in r.factors]

    def pose(self, q: Sequence[Scalar]) -> Pose:
        """T(q) over any scalar: floats, symbols, mpmath numbers; q of the whole robot."""
        columns, factors = self._wiring
        own = [q[i] if f == 1.0 else q[i] * f for i, f in zip(columns, factors, strict=True)]
        return frame_pose(self.robot, own, self.robot.frames[-1])

    def fk(self, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
        """Pose of the tip in the base by this table.

        Parameters
        ----------
        q : array_like, shape (..., nq)
            Of the whole robot the table was made from.

        Returns
        -------
        ndarray, shape (..., 4, 4)

        Raises
        ------
        ShapeError

        Examples
        --------
        >>> import numpy as np, dualpin as dp
        >>> dp.to_dh(dp.load("ur5"), tip="tool0").fk(np.zeros((5, 6))).shape
        (5, 4, 4)
        """
        columns, factors = self._wiring
        whole = self.chain.robot if self.chain else self.robot
        x = whole_q(whole, q, f"{self.name}: fk: q")
        return fk(self.robot, x[..., columns] * np.array(factors), self.robot.frames[-1], engine=engine)

    def frames(self, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
        """Poses of the frames of all rows in the base, fixed rows included, shape (..., n, 4, 4).

        Of a standard table the distal frames, of a modified one the frames on the joints' axes.

        Examples
        --------
        >>> import numpy as np, dualpin as dp
        >>> dp.to_dh(dp.load("ur5"), tip="tool0").frames(np.zeros(6)).shape
        (6, 4, 4)
        """
        columns, factors = self._wiring
        whole = self.chain.robot if self.chain else self.robot
        x = whole_q(whole, q, f"{self.name}: frames: q")[..., columns] * np.array(factors)
        kind = "frame" if self.convention == "standard" else "link"
        names = [f"{kind}_{k + 1}" for k in range(len(self.rows))]
        return np.stack([fk(self.robot, x, name, engine=engine) for name in names], axis=-3)

    def deviation(self, samples: int = 16, seed: int = 0) -> float:
        """Largest entry of |T_table(q) - T_robot(q)| over random q; angles in [-pi, pi], lengths in [-1, 1]."""
        if self.chain is None:
            return 0.0
        q = self.chain.sample(samples, seed)
        # few samples, used once: compiling would take longer
        return float(np.abs(self.fk(q, engine="numpy") - self.chain.fk(q, engine="numpy")).max())

    @cached_property
    def residual(self) -> float:
        """`deviation` over 16 samples: how far the table is from the robot it was made from."""
        return self.deviation()

    # text

    def table(self, degrees: bool = False, digits: int | None = None) -> str:
        """The rows as an aligned table, base and tool included; `digits` significant ones, or all."""
        return self.export("table", degrees=degrees, digits=digits)

    def export(self, format: str = "table", *, degrees: bool = False, digits: int | None = None) -> str:
        """The table as text.

        Parameters
        ----------
        format : "table", "csv", "json", "yaml", "markdown", "latex", "python" or "matlab"
            The last two are code for the Robotics Toolboxes.
        degrees : bool
            Angles in degrees instead of radians (code is always in radians).
        digits : int, optional
            Significant digits; by default every number is written in full.

        Raises
        ------
        ArgumentError
            For an unknown format, or one that cannot hold the table.
        """
        return home("DHTable.export")(self, format, degrees, digits)

    def _write(self, path: str | PathLike[str], format: str, **options: Any) -> None:
        write(path, self.export(format, **options))

    def to_csv(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("csv")` to a file; options as in `export`."""
        self._write(path, "csv", **options)

    def to_json(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("json")` to a file."""
        self._write(path, "json", **options)

    def to_yaml(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("yaml")` to a file."""
        self._write(path, "yaml", **options)

    def to_markdown(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("markdown")` to a file."""
        self._write(path, "markdown", **options)

    def to_latex(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("latex")` to a file."""
        self._write(path, "latex", **options)

    def to_python(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("python")`, code for roboticstoolbox-python, to a file."""
        self._write(path, "python", **options)

    def to_matlab(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("matlab")`, code for the Robotics Toolbox for MATLAB, to a file."""
        self._write(path, "matlab", **options)
