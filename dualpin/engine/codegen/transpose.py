"""Rows of arrays to slots, and slots to rows, transposed in registers.

    array (a sample a row)            slots (an entry a vector)
    a0 b0 c0 d0   <- sample 0         a0 a1 a2 a3
    a1 b1 c1 d1                       b0 b1 b2 b3
    a2 b2 c2 d2            <->        c0 c1 c2 c3
    a3 b3 c3 d3                       d0 d1 d2 d3

Gain: storing each entry directly from the arithmetic takes LLVM 41 to 62 s for large robots, tiles take 0.3 to 1.4 s.
Exchanging halves of vectors by the loads saves one of three shuffles.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .. import tuning
from ..graph.schedule import Schedule
from .host import Host
from .number import Number
from .vector import VectorWriter


def transposed(e: VectorWriter, rows: list[tuple[str, int]]) -> list[str]:
    """Columns of `width` rows, given the address and length of each; padded with zeros.

    The loads exchange halves of vectors, without a shuffle; then blocks of 1, 2, 4, ... lanes are exchanged
    between pairs of vectors.
    """
    if e.width == 1:
        return [e.load_row(*row) for row in rows]
    W, h, half = e.width, e.width // 2, e.of_width(e.width // 2)
    parts = [[half.load_row(p, min(n, h)), half.load_row(half.at(p, h), max(0, n - h))] for p, n in rows]
    columns = [e.joined(parts[i % h][i // h], parts[i % h + h][i // h], half) for i in range(W)]
    d = 1
    while d < h:
        for i in (i for i in range(W) if not i & d):
            a, b = columns[i], columns[i + d]
            low = [lane if not lane & d else W + lane - d for lane in range(W)]
            high = [lane + d if not lane & d else W + lane for lane in range(W)]
            columns[i], columns[i + d] = e.shuffled(a, b, low), e.shuffled(a, b, high)
        d *= 2
    return columns


@dataclass(frozen=True)
class Array:
    """An array in a kernel: its address, and the distance between rows in bytes."""

    pointer: str
    stride: str


class TileTransfer:
    """IR that moves one tile of samples into slots and out of them."""

    def __init__(self, plan: Schedule, number: Number, width: int, host: Host) -> None:
        self.plan, self.number, self.width, self.host = plan, number, width, host
        self.widest = host.lanes(number.size)
        self.columns = len(plan.outputs)
        # results may be stored after the next rows are loaded
        self.overlaps = host.width == 64 and width > 1 and self.columns > 0
        self.ahead = 0  # angles of the first stage whose sines and cosines are computed between the stores

    @property
    def lead(self) -> int:
        """Entries at the end of the preceding row that the table also contains."""
        return 0

    @property
    def spare(self) -> int:
        """Extra slots after the others, for copies beyond the last one."""
        return self.widest if self.width == 1 else 0

    def tables(self) -> str:
        """The constants of a row, and the source offsets of its entries in bytes."""
        table, kind = "outputs", "i32"
        places = [*self.plan.outputs[self.columns - self.lead :], *self.plan.outputs]
        entries = [str(place * self.width * self.number.size) for place in places]
        if self.plan.direct:
            table, kind, text = "row", self.number.name, VectorWriter(self.number, 1, self.host).number_text
            entries = [text(self.plan.constants.get(j, 0.0)) for j in range(self.columns)]
        return f"@{table} = internal constant [{len(entries)} x {kind}] [{', '.join(f'{kind} {x}' for x in entries)}]\n"

    # inputs

    def load(self, e: VectorWriter, k: int, array: Array, first: str, last: str) -> None:
        """Load input k of the tile's rows: from `first` up to `last`, which is repeated."""
        start, columns = sum(self.plan.sizes[:k]), self.plan.sizes[k]
        bases = self._addresses(e, array, first, last)
        if self.width == 1:
            e.do(f"%input{k} = getelementptr i8, ptr {bases[0]}, i64 0")  # for `SinCos`
            self._copy(e, f"in{k}", columns, bases[0], e.slot("%scratch", start), beyond=True)
            return

        def transpose(j: int | str, count: int) -> None:
            slot = e.value(f"add i64 {j}, {start}")
            for c, column in enumerate(transposed(e, [(e.at(base, j), count) for base in bases])[:count]):
                e.store("%scratch", e.value(f"add i64 {slot}, {c}"), column)

        self._each(e, f"in{k}", columns, self.width, transpose)

    def _addresses(self, e: VectorWriter, array: Array, first: str, last: str) -> list[str]:
        places = []
        for lane in range(self.width):
            row = e.value(f"add i64 {first}, {lane}")
            row = e.value(f"select i1 {e.value(f'icmp slt i64 {row}, {last}')}, i64 {row}, i64 {last}")
            offset = e.value(f"mul i64 {row}, {array.stride}")
            places.append(e.value(f"getelementptr i8, ptr {array.pointer}, i64 {offset}"))
        return places

    def _copy(self, e: VectorWriter, tag: str, count: int, source: str, target: str, beyond: bool = False) -> None:
        """Copy numbers by whole vectors; the last one may write `beyond` the end."""
        wide = e.of_width(self.widest)

        def vector(j: int | str, n: int) -> None:
            x = wide.load_row(wide.at(source, j), n)
            wide.store_row(wide.at(target, j), wide.width if beyond else n, x)

        self._each(wide, tag, count, wide.width, vector)

    # outputs

    def copy_constants(self, e: VectorWriter) -> None:
        """Write the constant results into a row."""
        if self.plan.constants:
            self._copy(e, "constants", self.columns, "@row", "%out")

    def store(self, e: VectorWriter, array: Array, first: str, last: str, unrolled: int = tuning.UNROLLED) -> None:
        """Store the results of the tile's rows, which are contiguous; `last` is the last row of all."""
        bases = self._addresses(e, array, first, last)

        def group(j: int | str, count: int) -> None:
            for base, row in zip(bases, self._results(e, j, count), strict=True):
                e.store_row(e.at(base, j), count, row)

        self._each(e, "results", self.columns, self.width, group, unrolled)

    def _results(self, e: VectorWriter, j: int | str, count: int) -> list[str]:
        """The entries j, j + 1, ... of each row."""
        columns = [("%out", 0)] * self.width
        for c in range(count):
            if isinstance(j, int):
                columns[c] = e.slot("%out", self.plan.outputs[j + c]), self.width
            else:
                entry = e.value(f"getelementptr i32, ptr @outputs, i64 {e.value(f'add i64 {j}, {self.lead + c}')}")
                offset = e.value(f"load i32, ptr {entry}")
                columns[c] = e.value(f"getelementptr i8, ptr %out, i32 {offset}"), self.width
        return transposed(e, columns)

    # loops

    def _each(
        self, e: VectorWriter, tag: str, count: int, step: int, body: Callable[[int | str, int], None],
        unrolled: int = tuning.UNROLLED,
    ) -> None:  # fmt: skip
        """body(j, count) for j = 0, step, ...: unrolled if few, else a loop and its remainder."""
        full = count // step
        if full <= unrolled // step:
            for j in range(0, full * step, step):
                body(j, step)
        else:
            self._loop(e, tag, 0, full * step, step, lambda j: body(j, step))
        if count % step:
            body(full * step, count % step)

    def _loop(self, e: VectorWriter, tag: str, start: int, stop: int, step: int, body: Callable[[str], None]) -> None:
        """body(j) for j = start, start + step, ... before stop, at least once."""
        e.do(f"br label %{tag}.before")
        e.label(f"{tag}.before")
        e.do(f"br label %{tag}")
        e.label(tag)
        e.do(f"%{tag}.j = phi i64 [{start}, %{tag}.before], [%{tag}.next, %{tag}.again]")
        body(f"%{tag}.j")
        e.do(f"br label %{tag}.again")
        e.label(f"{tag}.again")
        e.do(f"%{tag}.next = add i64 %{tag}.j, {step}")
        e.do(f"%{tag}.more = icmp slt i64 %{tag}.next, {stop}")
        e.do(f"br i1 %{tag}.more, label %{tag}, label %{tag}.after")
        e.label(f"{tag}.after")
