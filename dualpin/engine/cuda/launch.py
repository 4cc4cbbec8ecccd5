"""A kernel on a device, and its launch configuration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .driver import Device, Function
from .layout import WARP


class Launch:
    """A kernel with its shape of blocks.

    Parameters
    ----------
    about : dict
        The data of `Plan.about`.
    """

    def __init__(self, about: dict[str, Any], function: Function, where: Device) -> None:
        self.function, self.device = function, where
        self.warps: int = about["threads"] // WARP
        self.warp_bytes: int = about["warp_bytes"]
        function.allow_shared(self.warp_bytes * self.warps)

    def start(self, n: int, stream: int, numbers: Sequence[int]) -> None:
        """Launch for n samples, with address and two strides of each array; few warps are spread out."""
        tiles = -(-n // WARP)
        warps = max(1, min(self.warps, tiles // self.device.multiprocessors))
        self.function.launch(-(-tiles // warps), WARP * warps, warps * self.warp_bytes, stream, (n, *numbers))
