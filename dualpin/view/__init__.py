"""A robot in a browser: links, frames, joint screws with their pitch, DH frames, sliders, playing a run."""

from .scene import Axis, axes, bones, helix
from .viewer import Viewer, view

__all__ = ["Axis", "Viewer", "axes", "bones", "helix", "view"]
