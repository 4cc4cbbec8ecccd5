"""Products of exponentials of a whole tree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import choice
from ..delegates import home
from ..errors import FrameNotFoundError, nearest
from ..model.robot import Frame, Robot
from .chain import leaves
from .screws import FRAMES, Screws, screws_of


class ScrewTree(Mapping[str, Screws]):
    """Products of exponentials of a whole tree: for each leaf link its `Screws`, from one root.

    ``tree[link]`` works for every link.  A joint's space screw is the same in all of them.

    Examples
    --------
    >>> import dualpin as dp
    >>> tree = dp.to_screws(dp.load("allegro_left"))
    >>> len(tree), tree.screws.shape
    (4, (16, 6))
    """

    def __init__(self, robot: Robot, base: str | Frame | None, frame: str) -> None:
        self.robot, self.base, self.frame = robot, base, frame
        self._tips = [f.name for f in leaves(robot) if f.joint is not None]
        self._made: dict[str, Screws] = {}

    def __repr__(self) -> str:
        return f"<ScrewTree of {self.robot.name!r}: {len(self._tips)} tips>"

    def __len__(self) -> int:
        return len(self._tips)

    def __iter__(self) -> Iterator[str]:
        return iter(self._tips)

    def __getitem__(self, link: str) -> Screws:
        if link not in self._made:
            try:
                self._made[link] = screws_of(self.robot, link, self.frame, self.base)
            except FrameNotFoundError:
                raise FrameNotFoundError(f"{link!r} is no tip; {nearest(link, self._tips, 'tips')}") from None
        return self._made[link]

    @property
    def home(self) -> dict[str, np.ndarray]:
        """Home pose of each leaf."""
        return {tip: self[tip].home for tip in self}

    @cached_property
    def _columns(self) -> dict[tuple[str, int], np.ndarray]:
        """(joint, coordinate) -> space screw, in the robot's order."""
        found: dict[tuple[str, int], np.ndarray] = {}
        for tip in self:
            poe = self[tip]
            for name, column, S in zip(poe.joint_names, poe.columns, poe.Slist.T, strict=True):
                found.setdefault((name, column), S)
        order = {j.name: j.index for j in self.robot}
        return dict(sorted(found.items(), key=lambda item: (order[item[0][0]], item[0][1])))

    @property
    def joint_names(self) -> tuple[str, ...]:
        """For each row of `screws` its joint."""
        return tuple(name for name, _ in self._columns)

    @property
    def screws(self) -> np.ndarray:
        """Space screws [w; v] of all joints in the robot's order, one a row, shape (n, 6)."""
        return np.array(list(self._columns.values())).reshape(-1, 6)

    def fk(self, q: ArrayLike, tip: str, *, engine: str = "auto") -> np.ndarray:
        """Pose of a link, shape (..., 4, 4)."""
        return self[tip].fk(q, engine=engine)

    def jacobian(self, q: ArrayLike, tip: str, *, engine: str = "auto") -> np.ndarray:
        """Jacobian of a link, shape (..., 6, nv)."""
        return self[tip].jacobian(q, engine=engine)

    def export(self, format: str = "table", *, degrees: bool = False, digits: int | None = None) -> str:
        """The forms of all tips as text, as `Screws.export` writes them."""
        return home("ScrewTree.export")(self, format, degrees, digits)


def to_screws(
    robot: Robot, tip: str | Frame | None = None, frame: str = "space", *, base: str | Frame | None = None
) -> Any:
    """Product of exponentials of a chain, or of a whole tree.

        T(q) = exp(S_1 q_1) ... exp(S_n q_n) M

    Parameters
    ----------
    robot : Robot
    tip, base : str or Frame, optional
        Links (or frames); base is the root by default.  Without a tip: the only leaf, or, of a
        robot that branches, all of them.
    frame : "space" or "body"
        Screws about the base frame's origin in its axes, or the tip's in its own.

    Returns
    -------
    Screws or ScrewTree
        ``.home`` (4, 4), ``.screws`` (n, 6) with rows [w; v] in rad, m, ``.fk(q)``, ``.jacobian(q)``.

    Raises
    ------
    FrameNotFoundError, ArgumentError

    References
    ----------
    Brockett (1984); Lynch & Park (2017), 4.1.

    Examples
    --------
    >>> import dualpin as dp
    >>> poe = dp.to_screws(dp.load("panda"), tip="panda_hand")
    >>> poe.screws.shape, poe.residual < 1e-14
    ((7, 6), True)
    """
    choice("to_screws: frame", frame, FRAMES)
    if tip is None and isinstance(robot, Robot) and len(leaves(robot)) > 1:
        return ScrewTree(robot, base, frame)
    return screws_of(robot, tip, frame, base)
