"""Lines of scalar IR, for one thread of a GPU."""

from __future__ import annotations

import itertools

from ..codegen.host import Host
from ..codegen.number import Number
from ..codegen.vector import VectorWriter

DEVICE = Host("nvptx64-nvidia-cuda", "sm_80", "+ptx70", 8, True)
"""Code for this architecture also runs on later ones."""


class Scalar(VectorWriter):
    """The interface of `VectorWriter` for scalars, so that both use the same code for sines, cosines and arithmetic."""

    def __init__(self, number: Number, host: Host = DEVICE) -> None:
        super().__init__(number, 1, host)
        self.here = "entry"  # the current block
        self._blocks = itertools.count(1)

    def _set_width(self, width: int) -> None:
        number, self.width = self.number, width
        self.vector, self.integer, self.mask = number.name, f"i{number.bits}", "i1"
        self.suffix, self.align = f"f{number.bits}", number.size

    def label(self, name: str) -> None:
        super().label(name)
        self.here = name

    def new_label(self, name: str) -> str:
        return f"{name}{next(self._blocks)}"

    def every(self, text: str, kind: str) -> str:
        return text

    def splat(self, x: str, kind: str) -> str:
        return x

    @property
    def declarations(self) -> str:
        T, s = self.vector, self.suffix
        return (
            f"declare {T} @llvm.fma.{s}({T}, {T}, {T})\n"
            f"declare {T} @llvm.sqrt.{s}({T})\ndeclare {T} @llvm.fabs.{s}({T})\n"
        )

    def get(self, pointer: str, space: int = 0, fixed: bool = False) -> str:
        """Load a number; a constant one (`fixed`) may use the read-only cache."""
        note = ", !invariant.load !1" if fixed else ""
        return self.value(f"load {self.vector}, {address(space)} {pointer}, align {self.align}{note}")

    def put(self, pointer: str, x: str, space: int = 0) -> None:
        self.do(f"store {self.vector} {x}, {address(space)} {pointer}, align {self.align}")

    def entry(self, pointer: str, index: int | str, space: int = 0, kind: str = "i64") -> str:
        """The address of the number at `index` from `pointer`."""
        return self.value(f"getelementptr {self.vector}, {address(space)} {pointer}, {kind} {index}")


GLOBAL, SHARED = 1, 3


def address(space: int) -> str:
    return f"ptr addrspace({space})" if space else "ptr"
