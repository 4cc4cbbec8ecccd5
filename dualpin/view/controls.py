"""The panel beside the scene: sliders, buttons, handles to drag, and notes on the model."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable
from functools import partial
from math import degrees, isfinite, pi, radians
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import escape
from ..errors import DualpinError, DualpinWarning
from ..functions import fk
from ..spatial.arrays import from_matrix, to_matrix
from ..tracking import ik

if TYPE_CHECKING:
    from ..model.robot import Joint

BASE = slice(0, 7)  # x y z, qw qx qy qz of a floating base
LISTED, LETTERS = 12, 160  # remarks shown before the rest is counted, and how much of each


class Controls:
    """The panel of a `Viewer`.  Changes made by the program do not trigger the handlers of user input."""

    def __init__(self, viewer: Any, tip: str | None) -> None:
        self.viewer, self.robot = viewer, viewer.robot
        self.gui, self.scene = viewer.server.gui, viewer.server.scene
        self.sliders: dict[int, tuple[Any, bool]] = {}
        self._random = np.random.default_rng(0)
        self._solving = threading.Lock()
        self.base: Any = None
        self.gui.configure_theme(dark_mode=viewer.dark, show_logo=False, show_share_button=False)
        robot = self.robot
        self.gui.add_markdown(f"**{escape.markdown(robot.name)}**: nq {robot.nq}, nv {robot.nv}")
        self._remarks()
        self._tool(tip)
        self._configuration()
        self._drawn()
        if len(viewer.sequence):
            self._player()

    def follow(self) -> None:
        """Set sliders, handles and texts to the configuration shown."""
        q = self.viewer.q
        for i, (slider, angular) in self.sliders.items():
            value = degrees(q[i]) if angular else float(q[i])
            shown = float(np.clip(value, slider.min, slider.max))
            if slider.value != shown:
                slider.value = shown
        self.typed.value = ", ".join(f"{x:.6g}" for x in q)
        pose = fk(self.robot, q, self.frame.value, engine="numpy")
        if not self._solving.locked():
            self.handle.wxyz, self.handle.position = from_matrix(pose)[:4], pose[:3, 3]
        self.readout.content = readout(pose)
        if self.base is not None:
            self.base.position, self.base.wxyz = q[:3], q[3:7]

    # sections of the panel

    def _remarks(self) -> None:
        said = self.viewer.warnings
        if not said:
            return
        with self.gui.add_folder(f"⚠ {len(said)} {'remark' if len(said) == 1 else 'remarks'} about the model"):
            lines = [f"- {escape.markdown(shortened(text))}" for text in said[:LISTED]]
            lines += [f"- and {len(said) - LISTED} more"] if len(said) > LISTED else []
            self.gui.add_markdown("\n".join(lines))

    def _tool(self, tip: str | None) -> None:
        names = self.robot.frame_names
        with self.gui.add_folder("tool"):
            self.frame = self.gui.add_dropdown("frame", options=names, initial_value=tip if tip in names else names[-1])
            self.readout = self.gui.add_markdown("")
            self.drag = self.gui.add_checkbox("drag it", initial_value=False)
            self.said = self.gui.add_markdown("")
        self.handle = self.scene.add_transform_controls("/tool", scale=0.3 * self.viewer.scale, visible=False)
        _led(self.frame, lambda: self.viewer.update(self.viewer.q))
        self.drag.on_update(lambda _: setattr(self.handle, "visible", self.drag.value))
        _led(self.handle, self.reach)

    def _configuration(self) -> None:
        with self.gui.add_folder("q"):
            buttons = self.gui.add_button_group("set", ("zero", "random", "copy q"))
            self.typed = self.gui.add_text("q [rad, m]", initial_value="", hint="Type or paste one, and press Enter.")
            for joint in self.robot:
                if not joint.mimic:
                    self._sliders(joint)
        buttons.on_click(lambda _: {"zero": self.zero, "random": self.random, "copy q": self.copy}[buttons.value]())
        _led(self.typed, lambda: self.take(self.typed.value))
        first = self.robot.joints[0] if self.robot.joints else None
        if first is not None and self.robot.floating and first.quaternions:
            self.base = self.scene.add_transform_controls("/base", scale=0.5 * self.viewer.scale)
            _led(self.base, self.float)

    def _sliders(self, joint: Joint) -> None:
        many = joint.q.stop - joint.q.start > 1
        for i, what in zip(range(joint.q.start, joint.q.stop), joint.model.coordinates, strict=True):
            if what == "quaternion" or (joint.quaternions and self.robot.floating and i < BASE.stop):
                continue  # moved by its handle
            angular = what == "angle"
            unit = "deg" if angular else "m"
            name = f"{joint.name} {i - joint.q.start} [{unit}]" if many else f"{joint.name} [{unit}]"
            low, high = (float(x[i]) for x in (self.robot.lower, self.robot.upper))
            most = pi if angular else 1.0
            low, high = (low if isfinite(low) else -most), (high if isfinite(high) else most)
            if low >= high:
                low, high = -most, most
            low, high = (round(degrees(low), 2), round(degrees(high), 2)) if angular else (low, high)
            at = float(self.viewer.q[i])
            value = float(np.clip(degrees(at) if angular else at, low, high))
            slider = self.gui.add_slider(name, min=low, max=high, step=(high - low) / 2000, initial_value=value)
            self.sliders[i] = (slider, angular)
            _led(slider, partial(self.slide, i))

    def _drawn(self) -> None:
        viewer = self.viewer
        with self.gui.add_folder("shown"):
            for part, handles in viewer.parts.items():
                if handles:
                    box = self.gui.add_checkbox(part, initial_value=bool(handles[0].visible))
                    box.on_update(lambda _, part=part, box=box: viewer.show(part, box.value))
            if viewer.parts["meshes"]:
                value = float(viewer.parts["meshes"][0].opacity)
                slider = self.gui.add_slider("mesh opacity", min=0.0, max=1.0, step=0.05, initial_value=value)
                slider.on_update(lambda _: viewer.opacity(slider.value))
            self.gui.add_button("fit the camera").on_click(lambda _: viewer.fit())
            dark = self.gui.add_checkbox("dark", initial_value=viewer.dark)
            dark.on_update(lambda _: self.darken(dark.value))

    def _player(self) -> None:
        with self.gui.add_folder("play"):
            buttons = self.gui.add_button_group("run", ("play", "pause"))
            buttons.on_click(lambda _: {"play": self.viewer.play, "pause": self.viewer.pause}[buttons.value]())

    # what a person does

    def slide(self, i: int) -> None:
        """A slider was moved."""
        slider, angular = self.sliders[i]
        q = self.viewer.q.copy()
        q[i] = radians(slider.value) if angular else slider.value
        self.viewer.update(q)

    def zero(self) -> None:
        """To the neutral configuration."""
        self.viewer.update(self.robot.neutral)

    def random(self) -> None:
        """To a random configuration within the limits; a floating base stays."""
        q = self.robot.sample(1, seed=int(self._random.integers(2**31)))[0][0]
        if self.base is not None:
            q[BASE] = self.viewer.q[BASE]
        self.viewer.update(q)

    def copy(self) -> None:
        """Show q as code to copy."""
        text = repr([float(x) for x in self.viewer.q])
        with self.gui.add_modal("q in rad and m, to copy") as modal:
            self.gui.add_markdown(f"```python\nq = {text}\n```")
            self.gui.add_button("close").on_click(lambda _: modal.close())

    def take(self, text: str) -> None:
        """A configuration was typed."""
        try:
            self.viewer.update([float(word) for word in text.strip("[]() ").replace(",", " ").split()])
            self.said.content = ""
        except (ValueError, DualpinError) as e:
            self.said.content = f"⚠ {escape.markdown(str(e))}"

    def float(self) -> None:
        """The handle of the base was dragged."""
        q = self.viewer.q.copy()
        q[BASE] = [*self.base.position, *self.base.wxyz]
        self.viewer.update(q)

    def reach(self) -> None:
        """The handle of the tool was dragged: the nearest configuration that brings the frame there, or close."""
        if not self._solving.acquire(blocking=False):
            return  # a newer place comes soon
        try:
            target = to_matrix(np.array([*self.handle.wxyz, *([0.0] * 4)], float))
            target[:3, 3] = self.handle.position
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DualpinWarning)
                found = ik(self.robot, target, self.frame.value, q0=self.viewer.q, restarts=0)
            q = found.q.copy()
            if self.base is not None:
                q[BASE] = found.q[BASE]
            self.viewer.update(q)
            turn, way = (float(np.linalg.norm(x)) for x in np.split(found.error, 2))
            missing = f"⚠ out of reach by {way:.3g} m, {degrees(turn):.3g} deg"
            self.said.content = "" if found.success else missing
        except DualpinError as e:
            self.said.content = f"⚠ {escape.markdown(str(e))}"
        finally:
            self._solving.release()

    def darken(self, dark: bool) -> None:
        """Light or dark."""
        self.viewer.dark = dark
        self.gui.configure_theme(dark_mode=dark, show_logo=False, show_share_button=False)


def _led(handle: Any, action: Callable[[], None]) -> None:
    """What happens when a person moves a slider, types or drags; the program's own changes have no client."""

    def changed(event: Any) -> None:
        if event.client is not None:
            action()

    handle.on_update(changed)


def shortened(text: str) -> str:
    """A remark, shortened to fit the panel."""
    return text if len(text) <= LETTERS else text[: LETTERS - 4].rsplit(" ", 1)[0] + " ..."


def readout(pose: np.ndarray) -> str:
    """A pose as text: position, quaternion, roll pitch yaw.

    Examples
    --------
    >>> import numpy as np
    >>> from dualpin.view.controls import readout
    >>> print(readout(np.eye(4)))
    x y z: 0.0000 0.0000 0.0000 m
    <BLANKLINE>
    roll pitch yaw: 0.00 0.00 0.00 deg
    <BLANKLINE>
    w x y z: 1.0000 0.0000 0.0000 0.0000
    """
    R, p = pose[:3, :3], pose[:3, 3]
    pitch = np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0]))
    upright = np.hypot(R[0, 0], R[1, 0]) > 1e-9
    roll = np.arctan2(R[2, 1], R[2, 2]) if upright else np.arctan2(-R[1, 2], R[1, 1])
    yaw = np.arctan2(R[1, 0], R[0, 0]) if upright else 0.0
    angles = " ".join(f"{degrees(x) + 0.0:.2f}" for x in (roll, pitch, yaw))
    return (
        f"x y z: {' '.join(f'{x + 0.0:.4f}' for x in p)} m\n\nroll pitch yaw: {angles} deg\n\n"
        f"w x y z: {' '.join(f'{x + 0.0:.4f}' for x in from_matrix(pose)[:4])}"
    )
