"""The processor for which code is generated."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Host:
    """A processor, as LLVM names it.

    Attributes
    ----------
    width : int
        Bytes of a vector register: 64 (AVX-512), 32 (AVX2), 16 (SSE2, NEON), 8 (one number at a time).
    fma : bool
        Whether a b + c is one instruction.
    """

    triple: str
    cpu: str
    features: str
    width: int
    fma: bool

    def lanes(self, itemsize: int) -> int:
        return max(1, self.width // itemsize)

    @property
    def key(self) -> str:
        return f"{self.triple}|{self.cpu}|{self.features}|{self.width}|{self.fma}"
