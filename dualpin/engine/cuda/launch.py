"""A kernel on a device, and how it is begun."""

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
        What `Plan.about` says of it.
    """

    def __init__(self, about: dict[str, Any], function: Function, where: Device) -> None:
        self.function, self.device = function, where
        self.warps: int = about["threads"] // WARP
        self.warp_bytes: int = about["warp_bytes"]
        function.allow_shared(self.warp_bytes * self.warps)

    def start(self, n: int, stream: int, numbers: Sequence[int]) -> None:
        """n samples, with the address and two strides of each array; a few are spread, a warp to a multiprocessor."""
        tiles = -(-n // WARP)
        warps = max(1, min(self.warps, tiles // self.device.multiprocessors))
        self.function.launch(-(-tiles // warps), WARP * warps, warps * self.warp_bytes, stream, (n, *numbers))
