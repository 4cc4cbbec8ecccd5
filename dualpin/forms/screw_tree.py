"""Products of exponentials of a whole tree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..errors import FrameNotFoundError, nearest
from ..model.robot import Frame, Robot
from .chain import leaves
from .screws import Screws, to_screws


class ScrewTree(Mapping[str, Screws]):
    """Products of exponentials of a whole tree: for each leaf link its `Screws`, from one root.

    ``tree[link]`` works for every link.  A joint's space screw is the same in all of them.

    Examples
    --------
    >>> import dualpin as dp
    >>> tree = dp.to_screws(dp.load("allegro_left"))
    >>> len(tree), tree.screws.shape
    (4, (6, 16))
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
                self._made[link] = to_screws(self.robot, link, self.frame, base=self.base)
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
        """For each column of `screws` its joint."""
        return tuple(name for name, _ in self._columns)

    @property
    def screws(self) -> np.ndarray:
        """Space screws [w; v] of all joints as columns, in the robot's order, shape (6, n)."""
        return np.array(list(self._columns.values())).reshape(-1, 6).T

    def fk(self, q: ArrayLike, tip: str, *, engine: str = "auto") -> np.ndarray:
        """Pose of a link, shape (..., 4, 4)."""
        return self[tip].fk(q, engine=engine)

    def jacobian(self, q: ArrayLike, tip: str, *, engine: str = "auto") -> np.ndarray:
        """Jacobian of a link, shape (..., 6, nv)."""
        return self[tip].jacobian(q, engine=engine)

    def export(self, format: str = "table", *, degrees: bool = False, digits: int | None = None) -> str:
        """The forms of all tips as text, as `Screws.export` writes them."""
        from .export_screws import tree_text

        return tree_text(self, format, degrees, digits)
