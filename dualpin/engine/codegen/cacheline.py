"""Cache-line stores: results are stored as whole cache lines, where a vector is as long as a line (AVX-512).

    rows of a result     | r0 r0 r0 r0 r0 | r1 r1 r1 r1 r1 | r2 ...
    lines of the cache   ... ----][-----------][-----------][-----------][ ...
    stored               each line once, from one register, also across the borders of rows and tiles

A store that crosses the border between two lines costs two stores, and rows begin at any offset.  So each line is
assembled in a register.  Results larger than the caches use non-temporal stores; `jit.stores` measures from which size
on.

Gain (Zen 4): CRBA of tiago_dual 1.9 us instead of 3.8, all joint poses of panda 65 536 times 0.04 us instead of 0.17.
Angles of the next tile between the stores: FK of talos 161 ns instead of 185 (Zen 4), 189 instead of 207 (Xeon).
"""

from __future__ import annotations

from collections.abc import Callable

from .. import tuning
from ..graph.schedule import Schedule
from .host import Host
from .number import Number
from .sincos import SinCos
from .transpose import Array, TileTransfer
from .vector import VectorWriter

Line = tuple[str, str]
"""The beginning of the line that contains an address, and the distance to it in numbers."""


def transfer_for(plan: Schedule, number: Number, width: int, host: Host) -> TileTransfer:
    """The fastest transfer on this host."""
    vectors, rest = divmod(len(plan.outputs), width)
    if width * number.size < 64 or vectors < tuning.WHOLE_LINES_FROM:
        return TileTransfer(plan, number, width, host)
    return (ShiftedTransfer if rest else CacheLineTransfer)(plan, number, width, host)


class CacheLineTransfer(TileTransfer):
    """Rows of whole vectors, which all begin at the same offset in a line; columns are read as the lines need them.

    A row continues in the line where the row before it ends, also across tiles: only whole lines are written,
    except by the first and the last tile, since memory around the results is not part of them.  Stores wait
    for memory; the sines and cosines of the next tile are computed in the meantime.
    """

    def __init__(self, plan: Schedule, number: Number, width: int, host: Host) -> None:
        super().__init__(plan, number, width, host)
        self.angles = SinCos(plan, number, width, host)
        self.ahead = self.angles.ahead

    @property
    def lead(self) -> int:
        return self.width

    @property
    def spare(self) -> int:
        """The end of the preceding tile."""
        return 1

    def store(self, e: VectorWriter, array: Array, first: str, last: str, unrolled: int = 0) -> None:
        W, spare = self.width, self.plan.output_slots
        address = e.value(f"ptrtoint ptr {array.pointer} to i64")
        aligned = e.value(f"icmp eq i64 {e.value(f'and i64 {address}, {self.number.size - 1}')}, 0")
        base = e.value(f"getelementptr i8, ptr {array.pointer}, i64 {e.value(f'mul i64 {first}, {array.stride}')}")
        line = self._line(e, base, aligned)
        ends, back = self._ends(e, line)
        before = [e.load("%out", spare), *ends[:-1]]
        e.store("%out", spare, ends[-1])
        begun = e.value(f"icmp ne i64 {first}, 0")
        goes_on = e.value(f"icmp sle i64 {e.value(f'add i64 {first}, {W}')}, {last}")
        e.do(f"br i1 {e.value(f'and i1 {begun}, {goes_on}')}, label %middle, label %edge")
        e.label("edge")
        end = e.at(base, e.value(f"sub i64 0, {back}"))
        e.store_row(e.value(f"select i1 {begun}, ptr {end}, ptr {base}"), W, before[0])
        super().store(e, array, first, last, unrolled)  # one tile of hundreds: a loop compiles faster
        if self.ahead:
            self.angles.some(e, 0, 0)
        e.do("br label %rest")
        e.label("middle")
        lines = self._lines(e, array, base, line, aligned)
        whole = e.value(f"mul i64 {e.value(f'add i64 {last}, 1')}, {array.stride}")
        most = e.value("load i64, ptr @dualpin_stores")
        past = e.value(f"and i1 {aligned}, {e.value(f'icmp uge i64 {whole}, {most}')}")
        e.do(f"br i1 {past}, label %past.first, label %cached.first")
        for tag, how in ("past", f"align {e.align}, !nontemporal !0"), ("cached", f"align {self.number.size}"):
            e.label(f"{tag}.first")
            self._middle(e, tag, how, lines, before, ends)
            e.do("br label %rest")
        e.label("rest")

    def _line(self, e: VectorWriter, base: str, aligned: str) -> Line:
        """If numbers are not aligned, lines are not used."""
        within = e.value(f"select i1 {aligned}, i64 {e.align - 1}, i64 0")
        offset = e.value(f"and i64 {e.value(f'ptrtoint ptr {base} to i64')}, {within}")
        back = e.value(f"lshr i64 {offset}, {self.number.size.bit_length() - 1}")
        return e.at(base, e.value(f"sub i64 0, {back}")), back

    def _lines(self, e: VectorWriter, array: Array, base: str, line: Line, aligned: str) -> list[Line]:
        """The lines of the rows and of the row after them."""
        return [(place, line[1]) for place in self._places(e, array, line[0])]

    def _places(self, e: VectorWriter, array: Array, place: str) -> list[str]:
        """An address in the first row, in those after it, and in the row after them."""
        places = [place]
        for _ in range(self.width):
            places.append(e.value(f"getelementptr i8, ptr {places[-1]}, i64 {array.stride}"))
        return places

    def _ends(self, e: VectorWriter, line: Line) -> tuple[list[str], str]:
        """For each row, the vector from which the next continues, and the distance to its beginning in numbers.

        It holds the end of the row and the beginning of the next: one vector for the two lines.
        """
        return self._results(e, e.value(f"sub i64 0, {line[1]}"), self.width), line[1]

    def _middle(
        self, e: VectorWriter, tag: str, how: str, lines: list[Line], before: list[str], ends: list[str]
    ) -> None:
        """All lines that end in these rows, given the results of `_ends` for the rows before them and for them."""
        W, back = self.width, lines[0][1]
        lanes, kind = e.constants([str(lane) for lane in range(W)], "i64"), f"<{W} x i64>"
        old = e.value(f"icmp slt {kind} {lanes}, {e.splat(back, 'i64')}")
        for k in range(W):
            line = e.value(f"select {e.mask} {old}, {e.vector} {before[k]}, {e.vector} {ends[k]}")
            e.do(f"store {e.vector} {line}, ptr {lines[k][0]}, {how}")

        def body(j: str) -> None:
            for k, row in enumerate(self._results(e, e.value(f"sub i64 {j}, {back}"), W)):
                e.do(f"store {e.vector} {row}, ptr {e.at(lines[k][0], j)}, {how}")

        if self.ahead:
            self._with_angles(e, tag, body)
        else:
            self._loop(e, tag, W, self.columns, W, body)

    def _with_angles(self, e: VectorWriter, tag: str, body: Callable[[str], None]) -> None:
        """body(j) for the vectors of a row except the first, and one angle with each."""
        W, near = self.width, f"%{tag}.near"

        def both(j: str) -> None:
            phis = len(e.lines)
            body(j)
            k = e.value(f"sub i64 {e.value(f'lshr i64 {j}, {W.bit_length() - 1}')}, 1")
            e.do(f"br i1 {e.value(f'icmp slt i64 {k}, {self.ahead}')}, label %{tag}.angle, label %{tag}.on")
            e.label(f"{tag}.angle")
            *_, good = self.angles.one(e, "%scratch", "@angles0", k)
            good = e.value(f"and i1 {good}, {near}")
            e.do(f"br label %{tag}.on")
            e.label(f"{tag}.on")
            e.do(f"{near}.all = phi i1 [{near}, %{tag}], [{good}, %{tag}.angle]")
            e.lines[phis:phis] = [f"  {near} = phi i1 [true, %{tag}.before], [{near}.all, %{tag}.again]"]

        self._loop(e, tag, W, self.columns, W, both)
        e.do(f"br i1 {near}.all, label %{tag}.left, label %{tag}.far")
        e.label(f"{tag}.far")  # again, with the C library for angles beyond the reduction
        self.angles.some(e, 0, 0)
        e.do(f"br label %{tag}.left")
        e.label(f"{tag}.left")
        self.angles.some(e, 0, self.columns // W - 1)


class ShiftedTransfer(CacheLineTransfer):
    """All other rows: a line is the end of one vector of a row and the beginning of the next."""

    def __init__(self, plan: Schedule, number: Number, width: int, host: Host) -> None:
        super().__init__(plan, number, width, host)
        self.ahead = 0  # no registers are free: the preceding vectors and their shifts need them

    @property
    def lead(self) -> int:
        return 0

    def _lines(self, e: VectorWriter, array: Array, base: str, line: Line, aligned: str) -> list[Line]:
        return [self._line(e, place, aligned) for place in self._places(e, array, base)]

    def _ends(self, e: VectorWriter, line: Line) -> tuple[list[str], str]:
        return self._results(e, self.columns - self.width, self.width), str(self.width)

    def _middle(
        self, e: VectorWriter, tag: str, how: str, lines: list[Line], before: list[str], ends: list[str]
    ) -> None:
        W = self.width
        stop = self.columns // W * W
        picks = [self._pick(e, back) for _, back in lines]
        names = [f"%{tag}.before{k}" for k in range(W)]

        def body(j: str) -> None:
            phis = len(e.lines)
            rows = self._results(e, j, W)
            for k, row in enumerate(rows):
                e.do(f"store {e.vector} {e.picked(names[k], row, picks[k])}, ptr {e.at(lines[k][0], j)}, {how}")
            e.lines[phis:phis] = [
                f"  {name} = phi {e.vector} [{x}, %{tag}.before], [{row}, %{tag}.again]"
                for name, x, row in zip(names, before, rows, strict=True)
            ]

        self._loop(e, tag, 0, stop, W, body)
        # the last line of a row, if not yet written: the same rows in every tile, so the branch is predicted
        rows = self._results(e, self.columns - 2 * W, W)
        for k in range(W):
            at, line = e.at(lines[k + 1][0], -W), e.picked(rows[k], ends[k], picks[k + 1])
            written = e.value(f"icmp eq ptr {at}, {e.at(lines[k][0], stop - W)}")
            e.do(f"br i1 {written}, label %{tag}.ended{k}, label %{tag}.end{k}")
            e.label(f"{tag}.end{k}")
            e.do(f"store {e.vector} {line}, ptr {at}, {how}")
            e.do(f"br label %{tag}.ended{k}")
            e.label(f"{tag}.ended{k}")

    def _pick(self, e: VectorWriter, back: str) -> str:
        """The lanes of two vectors that form the line of the second."""
        kind = f"i{self.number.bits}"
        resized = e.value(f"ptrtoint ptr {e.value(f'inttoptr i64 {back} to ptr')} to {kind}")
        second = e.constants([str(self.width + lane) for lane in range(self.width)], kind)
        return e.value(f"sub {e.integer} {second}, {e.splat(resized, kind)}")
