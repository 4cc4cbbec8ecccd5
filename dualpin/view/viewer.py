"""The scene in a browser, by viser: what is drawn, and how it follows q."""

from __future__ import annotations

import threading
import time
from math import isfinite
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .. import escape
from ..errors import ArgumentError, nearest
from ..extras import extra
from ..forms import to_dh
from ..functions import fk
from ..io.meshes import Shapes, shapes
from ..model.robot import Robot
from ..spatial.arrays import from_matrix
from .controls import Controls
from .recording import record
from .scene import axes, bodies, bones, extent, helix, matrix, size

if TYPE_CHECKING:
    from ..tracking.track import TrackingResult

PARTS = ("frames", "screws", "lines", "meshes", "collision", "com", "inertia", "dh")
HIDDEN = ("collision", "com", "inertia")  # until they are asked for
COLOURS = {"revolute": (0, 105, 180), "prismatic": (0, 140, 90), "helical": (184, 85, 0)}
MASS, HULL = (200, 60, 60), (220, 120, 20)
STEP = 0.02  # s between configurations that come without times
OPACITY = 0.55  # of meshes: the frames inside are seen
FIELD = 0.75  # rad, viser's vertical field of view


class Viewer:
    """A robot in a browser window; `update` moves it, `play` runs a sequence of configurations.

    The page has sliders in degrees, buttons for the zero, a random and the typed configuration, the pose of a frame
    and a handle to drag it by, a handle for a floating base, and boxes for what is drawn.

    Parameters
    ----------
    robot : Robot
    run : TrackingResult, SimulationResult or array_like, shape (n, nq), optional
        What the button "play" plays.
    dt : float
        Seconds between configurations of a `run` that has no times.
    dh : "standard" or "modified", optional
        DH frames of the chain to `tip`.
    tip : str, optional
    dark : bool
    host, port : str, int
        Where the page is served; only to this machine by default.

    Raises
    ------
    ArgumentError
        If viser is not installed (``pip install 'dualpin[view]'``), or a name is not known.

    Examples
    --------
    >>> import dualpin as dp
    >>> viewer = dp.view.Viewer(dp.load("ur5"), port=8123)  # doctest: +SKIP
    >>> viewer.update([0, -1.2, 1.4, 0, 0, 0])  # doctest: +SKIP
    """

    def __init__(
        self, robot: Robot, run: Any = None, *, dt: float = STEP, dh: str | None = None, tip: str | None = None,
        dark: bool = False, host: str = "127.0.0.1", port: int = 8080,
    ) -> None:  # fmt: skip
        viser = extra("viser", "view", "view")
        self.robot, self.scale, self.dark = robot, size(robot), dark
        self.table = to_dh(robot, tip=tip, convention=dh) if dh else None
        self.sequence, self.times = _sequence(robot, run, dt)
        self.q = np.array(self.sequence[0] if len(self.sequence) else robot.neutral, float)
        self.shapes = shapes(robot.source) if robot.source else Shapes()
        self.server = viser.ViserServer(host=host, port=port, verbose=False)
        self.parts: dict[str, list[Any]] = {name: [] for name in PARTS}
        self._moves = threading.RLock()
        self._playing = threading.Event()
        self._draw()
        for part in HIDDEN:
            self.show(part, False)
        self.controls = Controls(self, tip)
        self.update(self.q)
        self.fit()

    @property
    def url(self) -> str:
        return f"http://{self.server.get_host()}:{self.server.get_port()}"

    @property
    def warnings(self) -> list[str]:
        """Notes on the model: those of the loader, and shapes that cannot be drawn."""
        return [*self.robot.notes, *(f"not drawn: {text}" for text in self.shapes.missing)]

    def update(self, q: ArrayLike) -> None:
        """Show one configuration, shape (nq,); sliders and handles follow."""
        x = np.array(q, float)
        if x.shape != (self.robot.nq,):
            raise ArgumentError(f"view: q: shape ({self.robot.nq},) expected, got {x.shape}")
        with self._moves, self.server.atomic():
            self.q = x
            for handle, pose in zip(self.moving, fk(self.robot, x, engine="numpy"), strict=True):
                _place(handle, pose)
            if self.table is not None and self.table.chain is not None:
                ground = fk(self.robot, x, self.table.chain.base, engine="numpy")
                for handle, pose in zip(self.parts["dh"], self.table.frames(x, engine="numpy"), strict=True):
                    _place(handle, ground @ pose)
            self.controls.follow()

    def show(self, part: str, visible: bool) -> None:
        """Show or hide "frames", "screws", "lines", "meshes", "collision", "com", "inertia" or "dh"."""
        if part not in self.parts:
            raise ArgumentError(f"view: part {part!r} is not known; {nearest(part, PARTS, 'parts')}")
        for handle in self.parts[part]:
            handle.visible = visible

    def opacity(self, value: float) -> None:
        """How opaque the meshes are, from 0 to 1."""
        for handle in self.parts["meshes"]:
            handle.opacity = value

    def play(self) -> None:
        """Run through the sequence in its own time; `pause` stops it."""
        if not len(self.sequence):
            return
        self._playing.set()
        start = time.monotonic()
        while self._playing.is_set() and (now := time.monotonic() - start) < self.times[-1] - self.times[0]:
            self.update(self.sequence[np.searchsorted(self.times, self.times[0] + now)])
            time.sleep(1 / 60)
        if self._playing.is_set():
            self.update(self.sequence[-1])
        self._playing.clear()

    def pause(self) -> None:
        """Stop playing where it is."""
        self._playing.clear()

    def record(self, path: str | PathLike[str], fps: float = 30.0) -> None:
        """Write the scene, and the sequence if there is one, as a page that opens without a server."""
        record(self, path, fps)

    def fit(self) -> None:
        """Move the camera of present and later clients so that the whole robot is visible."""
        middle, radius = extent(self.robot, self.q)
        away = np.array([1.0, 1.0, 0.7]) / np.linalg.norm([1.0, 1.0, 0.7])
        position = middle + away * 1.1 * radius / np.sin(FIELD / 2)
        cameras = [self.server.initial_camera, *(c.camera for c in self.server.get_clients().values())]
        for camera in cameras:
            camera.position, camera.look_at = tuple(position), tuple(middle)

    def stop(self) -> None:
        """Close the page's server."""
        self.pause()
        self.server.stop()

    def _draw(self) -> None:
        scene, s = self.server.scene, self.scale
        scene.set_up_direction("+z")
        scene.add_grid("/ground", width=3 * s, height=3 * s, cell_size=s / 4)
        self.moving = []
        self.names: dict[Any, str] = {None: "/robot"}
        for j in self.robot:
            self.names[j] = f"/robot/{j.index}_{escape.line(j.name).replace('/', ':')}"
            self.moving.append(scene.add_frame(self.names[j], show_axes=False))
            frame = scene.add_frame(f"{self.names[j]}/frame", axes_length=0.08 * s, axes_radius=0.003 * s)
            self.parts["frames"].append(frame)
        for k, (joint, line) in enumerate(bones(self.robot)):
            self.parts["lines"].append(self._line(f"{self.names[joint]}/bone_{k}", line, (110, 120, 130), 0.008))
        for k, a in enumerate(axes(self.robot)):
            kind = "prismatic" if not isfinite(a.pitch) else "helical" if a.pitch else "revolute"
            line = helix(a, 0.5 * s, 0.02 * s)
            self.parts["screws"].append(self._line(f"{self.names[a.joint]}/screw_{k}", line, COLOURS[kind], 0.006))
        self._draw_shapes()
        self._draw_masses()
        for k in range(len(self.table.rows) if self.table else 0):
            frame = scene.add_frame(f"/dh/{k + 1}", axes_length=0.15 * s, axes_radius=0.004 * s)
            scene.add_label(f"/dh/{k + 1}/label", f"DH {k + 1}", position=(0.0, 0.0, 0.17 * s))
            self.parts["dh"].append(frame)

    def _draw_shapes(self) -> None:
        links = {link.name: link for link in self.robot.links}
        for k, shape in enumerate(self.shapes.found):
            link = links.get(shape.link)
            if link is None:
                continue
            seen = shape.role == "visual"
            mesh = self.server.scene.add_mesh_simple(
                f"{self.names[link.joint]}/{shape.role}_{k}", shape.mesh.vertices, shape.mesh.faces, side="double",
                color=shape.colour if seen else HULL, opacity=OPACITY if seen else None, wireframe=not seen,
            )  # fmt: skip
            _place(mesh, matrix(link.placement) @ shape.placement)
            self.parts["meshes" if seen else "collision"].append(mesh)

    def _draw_masses(self) -> None:
        scene, total = self.server.scene, max(float(self.robot.mass), 1e-9)
        for k, body in enumerate(bodies(self.robot)):
            share = (float(body.link.inertia.mass) / total) ** (1 / 3)
            name = self.names[body.link.joint]
            ball = scene.add_icosphere(f"{name}/com_{k}", radius=max(0.03 * share, 0.004) * self.scale, color=MASS)
            place = matrix(body.link.placement) @ _pose(np.eye(3), body.com)
            _place(ball, place)
            self.parts["com"].append(ball)
            if body.radii.any():
                radii = tuple(float(r) for r in np.maximum(body.radii, 1e-3 * self.scale))
                hull = scene.add_icosphere(f"{name}/inertia_{k}", color=MASS, scale=radii, opacity=0.35)
                _place(hull, matrix(body.link.placement) @ _pose(body.turn, body.com))
                self.parts["inertia"].append(hull)

    def _line(self, name: str, points: np.ndarray, colour: tuple[int, int, int], width: float) -> Any:
        segments = np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)
        return self.server.scene.add_line_segments(name, segments, colour, thickness=width * self.scale)


def view(robot: Robot, run: TrackingResult | ArrayLike | None = None, **options: Any) -> Viewer:
    """Show a robot in a browser: serve a page and return its `Viewer`.

    Parameters
    ----------
    robot : Robot
    run : TrackingResult, SimulationResult or array_like, shape (n, nq), optional
        What to play: the result of `dualpin.track` or `dualpin.simulate`, or configurations ``dt`` apart.
    **options
        Of `Viewer`: ``dt=``, ``dh=``, ``tip=``, ``dark=``, ``host=``, ``port=``.

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


def _sequence(robot: Robot, run: Any, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Configurations (n, nq) and their times."""
    if run is None:
        return np.empty((0, robot.nq)), np.empty(0)
    if not dt > 0:
        raise ArgumentError(f"view: dt = {dt!r}; a number above 0 expected [s]")
    q = np.asarray(run.q if hasattr(run, "q") else run, float)
    if q.ndim != 2 or q.shape[1] != robot.nq or not len(q):
        raise ArgumentError(f"view: run: configurations of shape (n, {robot.nq}) expected, got {q.shape}")
    return q, np.asarray(run.t, float) if hasattr(run, "t") else dt * np.arange(len(q))


def _pose(turn: np.ndarray, position: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = turn, position
    return T


def _place(handle: Any, pose: np.ndarray) -> None:
    handle.wxyz, handle.position = from_matrix(pose)[:4], pose[:3, 3]
