"""The scene in a browser, by viser."""

from __future__ import annotations

import time
from math import isfinite, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .. import escape
from ..errors import ArgumentError, nearest
from ..forms import to_dh
from ..functions import fk
from ..io.meshes import shapes
from ..model.robot import Robot
from ..spatial.arrays import from_matrix
from .scene import axes, bones, helix, matrix, size

if TYPE_CHECKING:
    from ..tracking.track import TrackingResult

PARTS = ("frames", "screws", "lines", "meshes", "dh")
COLOURS = {"revolute": (0, 105, 180), "prismatic": (0, 140, 90), "helical": (184, 85, 0)}


class Viewer:
    """A robot in a browser window; `update` moves it, `play` runs a sequence of configurations.

    Parameters
    ----------
    robot : Robot
    run : TrackingResult or array_like, shape (n, nq), optional
        What the button "play" plays.
    dh : "standard" or "modified", optional
        DH frames of the chain to `tip`.
    tip : str, optional
    host, port : str, int
        Where the page is served; only to this machine by default.

    Raises
    ------
    ArgumentError
        If viser is not installed (``pip install 'dualpin[view]'``), or a name is not known.
    """

    def __init__(
        self, robot: Robot, run: TrackingResult | ArrayLike | None = None, *, dh: str | None = None,
        tip: str | None = None, host: str = "127.0.0.1", port: int = 8080,
    ) -> None:  # fmt: skip
        try:
            import viser
        except ImportError:
            raise ArgumentError("view: needs viser: pip install 'dualpin[view]'") from None
        self.robot, self.scale = robot, size(robot)
        self.table = to_dh(robot, tip=tip, convention=dh) if dh else None
        self.sequence, self.times = _sequence(robot, run)
        self.q = np.array(self.sequence[0] if len(self.sequence) else robot.neutral, float)
        self.server = viser.ViserServer(host=host, port=port, verbose=False)
        self.parts: dict[str, list[Any]] = {name: [] for name in PARTS}
        self._draw()
        self._controls()
        self.update(self.q)

    @property
    def url(self) -> str:
        return f"http://{self.server.get_host()}:{self.server.get_port()}"

    def update(self, q: ArrayLike) -> None:
        """Show one configuration, shape (nq,)."""
        self.q = np.array(q, float)
        with self.server.atomic():
            for handle, pose in zip(self.moving, fk(self.robot, self.q, engine="numpy"), strict=True):
                _place(handle, pose)
            if self.table is not None and self.table.chain is not None:
                ground = fk(self.robot, self.q, self.table.chain.base, engine="numpy")
                for handle, pose in zip(self.parts["dh"], self.table.frames(self.q, engine="numpy"), strict=True):
                    _place(handle, ground @ pose)

    def show(self, part: str, visible: bool) -> None:
        """Show or hide "frames", "screws", "lines", "meshes" or "dh"."""
        if part not in self.parts:
            raise ArgumentError(f"view: part {part!r} is not known; {nearest(part, PARTS, 'parts')}")
        for handle in self.parts[part]:
            handle.visible = visible

    def play(self) -> None:
        """Run through the sequence in its own time."""
        start = time.monotonic()
        while (now := time.monotonic() - start) < self.times[-1]:
            self.update(self.sequence[np.searchsorted(self.times, now)])
            time.sleep(1 / 60)
        self.update(self.sequence[-1])

    def stop(self) -> None:
        """Close the page's server."""
        self.server.stop()

    def _draw(self) -> None:
        scene, s = self.server.scene, self.scale
        scene.set_up_direction("+z")
        scene.add_grid("/ground", width=3 * s, height=3 * s, cell_size=s / 4)
        self.server.initial_camera.position = (1.6 * s, 1.6 * s, 1.3 * s)
        self.server.initial_camera.look_at = (0.0, 0.0, 0.5 * s)
        self.moving = []
        names: dict[Any, str] = {None: "/robot"}
        for j in self.robot:
            names[j] = f"/robot/{j.index}_{escape.line(j.name).replace('/', ':')}"
            self.moving.append(scene.add_frame(names[j], show_axes=False))
            frame = scene.add_frame(f"{names[j]}/frame", axes_length=0.08 * s, axes_radius=0.003 * s)
            self.parts["frames"].append(frame)
        for k, (joint, line) in enumerate(bones(self.robot)):
            self.parts["lines"].append(self._line(f"{names[joint]}/bone_{k}", line, (110, 120, 130), 0.008))
        for k, a in enumerate(axes(self.robot)):
            kind = "prismatic" if not isfinite(a.pitch) else "helical" if a.pitch else "revolute"
            line = helix(a, 0.5 * s, 0.02 * s)
            self.parts["screws"].append(self._line(f"{names[a.joint]}/screw_{k}", line, COLOURS[kind], 0.006))
        links = {link.name: link for link in self.robot.links}
        for k, shape in enumerate(shapes(self.robot.source) if self.robot.source else ()):
            if shape.link in links:
                link = links[shape.link]
                mesh = scene.add_mesh_trimesh(f"{names[link.joint]}/mesh_{k}", shape.mesh)
                _place(mesh, matrix(link.placement) @ shape.placement)
                self.parts["meshes"].append(mesh)
        for k in range(len(self.table.rows) if self.table else 0):
            frame = scene.add_frame(f"/dh/{k + 1}", axes_length=0.15 * s, axes_radius=0.004 * s)
            scene.add_label(f"/dh/{k + 1}/label", f"DH {k + 1}", position=(0.0, 0.0, 0.17 * s))
            self.parts["dh"].append(frame)

    def _line(self, name: str, points: np.ndarray, colour: tuple[int, int, int], width: float) -> Any:
        segments = np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)
        return self.server.scene.add_line_segments(name, segments, colour, thickness=width * self.scale)

    def _controls(self) -> None:
        gui = self.server.gui
        gui.add_markdown(f"**{escape.markdown(self.robot.name)}**: nq {self.robot.nq}, nv {self.robot.nv}")
        for part in PARTS:
            if self.parts[part]:
                self._checkbox(part)
        with gui.add_folder("q"):
            for j in self.robot:
                if not j.mimic and not j.quaternions:
                    for i in range(j.q.start, j.q.stop):
                        self._slider(j.name if j.q.stop - j.q.start == 1 else f"{j.name} {i - j.q.start}", i)
        if len(self.sequence):
            gui.add_button("play").on_click(lambda _: self.play())

    def _checkbox(self, part: str) -> None:
        box = self.server.gui.add_checkbox(part, initial_value=True)
        box.on_update(lambda _: self.show(part, box.value))

    def _slider(self, name: str, i: int) -> None:
        low, high = (float(x[i]) for x in (self.robot.lower, self.robot.upper))
        low, high = (low if isfinite(low) else -pi), (high if isfinite(high) else pi)
        if low >= high:
            low, high = -pi, pi
        value = float(np.clip(self.q[i], low, high))
        slider = self.server.gui.add_slider(name, min=low, max=high, step=(high - low) / 1000, initial_value=value)

        def moved(_: Any) -> None:
            q = self.q.copy()
            q[i] = slider.value
            self.update(q)

        slider.on_update(moved)


def view(robot: Robot, run: TrackingResult | ArrayLike | None = None, **options: Any) -> Viewer:
    """Show a robot in a browser: serve a page and return its `Viewer`.

    Parameters
    ----------
    robot : Robot
    run : TrackingResult or array_like, shape (n, nq), optional
        What to play: the result of `dualpin.track`, or configurations 20 ms apart.
    **options
        Of `Viewer`: ``dh=``, ``tip=``, ``host=``, ``port=``.

    Returns
    -------
    Viewer
        ``.url`` is where the page is, ``.stop()`` ends it.

    Raises
    ------
    DualpinError
        If viser is not installed, with what to install.
    ArgumentError
        For configurations of another shape.

    Examples
    --------
    >>> import dualpin as dp
    >>> shown = dp.view.view(dp.load("ur5"), port=0)  # doctest: +SKIP
    """
    return Viewer(robot, run, **options)


def _sequence(robot: Robot, run: Any) -> tuple[np.ndarray, np.ndarray]:
    """Configurations (n, nq) and their times."""
    if run is None:
        return np.empty((0, robot.nq)), np.empty(0)
    q = np.asarray(run.q if hasattr(run, "q") else run, float)
    if q.ndim != 2 or q.shape[1] != robot.nq or not len(q):
        raise ArgumentError(f"view: run: configurations of shape (n, {robot.nq}) expected, got {q.shape}")
    return q, np.asarray(run.t, float) if hasattr(run, "t") else 0.02 * np.arange(len(q))


def _place(handle: Any, pose: np.ndarray) -> None:
    handle.wxyz, handle.position = from_matrix(pose)[:4], pose[:3, 3]
