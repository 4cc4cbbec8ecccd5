"""Results that leave as whole lines of the cache, where a vector is as long as a line.

A store that crosses the border between two lines costs more than two stores, and rows begin
anywhere.  So what belongs to a line is put together first: in registers, from two vectors of a row
next to each other, or on machines that gather quickly from the slots.  Either way results too many
for the caches go past them.
"""

from __future__ import annotations

from .host import Host
from .lanes import Lanes, Number
from .rows import Array, Rows
from .schedule import Schedule

BLOCK = 256  # columns gathered together: their slots fit the first cache
STREAMED = 8 << 20  # bytes of results from which they go past the caches
FEW = 12, 4  # vectors in a row from which lines pay; if every row begins as far into a line as the first


def rows_of(plan: Schedule, number: Number, width: int, host: Host) -> Rows:
    """The way in and out that takes this host the least time."""
    vectors, rest = divmod(len(plan.outputs), width)
    if width * number.size == 64 and plan.outputs and host.gathers:
        return Gathered(plan, number, width, host)
    if width * number.size == 64 and vectors >= FEW[not rest]:
        return Shifted(plan, number, width, host)
    return Rows(plan, number, width, host)


class _Lines(Rows):
    def _aligned(self, e: Lanes, array: Array) -> str:
        """Whether numbers lie where numbers should: then some of them begin a line."""
        address = e.value(f"ptrtoint ptr {array.pointer} to i64")
        return e.value(f"icmp eq i64 {e.value(f'and i64 {address}, {self.number.size - 1}')}, 0")

    def _branch(self, e: Lanes, array: Array, last: str) -> tuple[tuple[str, str], tuple[str, str]]:
        """On to past.first if the results go past the caches, else to cached.first; and how these store."""
        whole = e.value(f"mul i64 {e.value(f'add i64 {last}, 1')}, {array.stride}")
        past = e.value(f"and i1 {self._aligned(e, array)}, {e.value(f'icmp ugt i64 {whole}, {STREAMED}')}")
        e.do(f"br i1 {past}, label %past.first, label %cached.first")
        return ("past", f"align {e.align}, !nontemporal !0"), ("cached", f"align {self.number.size}")


class Shifted(_Lines):
    """Rows transposed a vector at a time; a line is the end of one vector and the beginning of the next.

    A row goes on where the row before it ends, also across tiles: nothing but whole lines is written,
    except by the first tile and the last, since what lies around all results is not ours.
    """

    @property
    def spare(self) -> int:
        """The end of the tile before."""
        return 1

    def store(self, e: Lanes, array: Array, first: str, last: str) -> None:
        W, bases = self.width, self._addresses(e, array, first, last)
        full, rest = divmod(self.columns, W)
        bases.append(e.value(f"getelementptr i8, ptr {bases[-1]}, i64 {array.stride}"))
        within = e.value(
            f"select i1 {self._aligned(e, array)}, i{self.number.bits} {e.align - 1}, i{self.number.bits} 0"
        )
        lines, picks = zip(*(self._line(e, base, within) for base in bases), strict=True)
        ends = self._results(e, self.columns - W, W)
        before = [e.load("%out", self.plan.output_slots), *ends[:-1]]
        e.store("%out", self.plan.output_slots, ends[-1])
        begun = e.value(f"icmp ne i64 {first}, 0")
        goes_on = e.value(f"icmp sle i64 {e.value(f'add i64 {first}, {W}')}, {last}")
        e.do(f"br i1 {e.value(f'and i1 {begun}, {goes_on}')}, label %middle, label %edge")
        e.label("edge")
        earlier = self._at(e, bases[0], -W)
        e.store_row(e.value(f"select i1 {begun}, ptr {earlier}, ptr {bases[0]}"), W, before[0])
        super().store(e, array, first, last)
        e.do("br label %rest")
        e.label("middle")
        for tag, how in self._branch(e, array, last):
            e.label(f"{tag}.first")
            e.do(f"br label %{tag}")
            e.label(tag)
            e.do(f"%{tag}.j = phi i64 [0, %{tag}.first], [%{tag}.next, %{tag}]")
            phis = len(e.lines)
            rows = self._results(e, f"%{tag}.j", W)
            for k in range(W):
                line = e.picked(f"%{tag}.before{k}", rows[k], picks[k])
                e.do(f"store {e.vector} {line}, ptr {self._at(e, lines[k], f'%{tag}.j')}, {how}")
            e.do(f"%{tag}.next = add i64 %{tag}.j, {W}")
            e.do(f"%{tag}.more = icmp slt i64 %{tag}.next, {(full if rest else full - 1) * W}")
            e.do(f"br i1 %{tag}.more, label %{tag}, label %{tag}.end")
            e.lines[phis:phis] = [
                f"  %{tag}.before{k} = phi {e.vector} [{before[k]}, %{tag}.first], [{rows[k]}, %{tag}]"
                for k in range(W)
            ]
            e.label(f"{tag}.end")
            if rest:
                rows = self._results(e, self.columns - 2 * W, W)
            for k in range(W):
                line, end = e.picked(rows[k], ends[k], picks[k + 1]), self._at(e, lines[k + 1], -W)
                if rest:  # of the same rows in every tile: foreseen by the processor
                    written = e.value(f"icmp eq ptr {end}, {self._at(e, lines[k], (full - 1) * W)}")
                    e.do(f"br i1 {written}, label %{tag}.ended{k}, label %{tag}.end{k}")
                    e.label(f"{tag}.end{k}")
                e.do(f"store {e.vector} {line}, ptr {end}, {how}")
                if rest:
                    e.do(f"br label %{tag}.ended{k}")
                    e.label(f"{tag}.ended{k}")
            e.do("br label %rest")
        e.label("rest")

    def _line(self, e: Lanes, base: str, within: str) -> tuple[str, str]:
        """Where the line around an address begins, and which of two vectors' numbers are in the second's line.

        Where numbers lie across the borders of lines, 0 is `within` them: the second vector is stored as it is.
        """
        kind = f"i{self.number.bits}"
        offset = e.value(f"and {kind} {e.value(f'ptrtoint ptr {base} to {kind}')}, {within}")
        back = e.splat(e.value(f"lshr {kind} {offset}, {self.number.size.bit_length() - 1}"), kind)
        second = e.constants([str(self.width + lane) for lane in range(self.width)], kind)
        pick = e.value(f"sub {e.integer} {second}, {back}")
        return e.value(f"getelementptr i8, ptr {base}, {kind} {e.value(f'sub {kind} 0, {offset}')}"), pick


class Gathered(_Lines):
    """A line gathered from the slots; rows shorter than a vector are taken several as one."""

    def __init__(self, plan: Schedule, number: Number, width: int, host: Host) -> None:
        super().__init__(plan, number, width, host)
        self.joined = next(r for r in (1, 2, 4, 8, 16) if r * self.columns >= width)
        self.row = self.joined * self.columns

    @property
    def spare(self) -> int:
        return self.joined

    def tables(self) -> str:
        """The numbers of the slots to gather from, and on into the next row, as far as a vector goes."""
        W, outputs = self.width, self.plan.outputs
        numbers = range(self.row + W)
        return self._table([outputs[i % self.columns] * W + i // self.columns for i in numbers])

    def store(self, e: Lanes, array: Array, first: str, last: str) -> None:
        """Numbers up to where a line begins, lines, and the rest."""
        W, size = self.width, self.number.size
        rows = e.value(f"sub i64 {e.value(f'add i64 {last}, 1')}, {first}")
        rows = e.value(f"select i1 {e.value(f'icmp slt i64 {rows}, {W}')}, i64 {rows}, i64 {W}")
        total = e.value(f"mul i64 {rows}, {self.columns}")
        offset = e.value(f"mul i64 {first}, {array.stride}")
        pointer = e.value(f"getelementptr i8, ptr {array.pointer}, i64 {offset}")
        address = e.value(f"ptrtoint ptr {pointer} to i64")
        head = e.value(f"and i64 {e.value(f'sub i64 0, {address}')}, {e.align - 1}")
        head = e.value(f"lshr i64 {head}, {size.bit_length() - 1}")
        head = e.value(f"select i1 {e.value(f'icmp slt i64 {total}, {head}')}, i64 {total}, i64 {head}")

        def part(p: str, count: str) -> None:
            lanes, kind = e.constants([str(lane) for lane in range(W)], "i64"), f"<{W} x i64>"
            mask = e.value(f"icmp slt {kind} {lanes}, {e.splat(count, 'i64')}")
            row = e.value(f"udiv i64 {p}, {self.row}")
            j = e.value(f"sub i64 {p}, {e.value(f'mul i64 {row}, {self.row}')}")
            e.store_some(self._at(e, pointer, p), self._line(e, row, j), mask)

        part("0", head)
        for tag, how in self._branch(e, array, last):
            e.label(f"{tag}.first")
            self._lines(e, tag, pointer, head, total, how)
        e.label("rest")
        lines = e.value(f"and i64 {e.value(f'sub i64 {total}, {head}')}, -{W}")
        done = e.value(f"add i64 {head}, {lines}")
        part(done, e.value(f"sub i64 {total}, {done}"))

    def _lines(self, e: Lanes, tag: str, pointer: str, head: str, total: str, how: str) -> None:
        """Block by block of columns, so that their slots stay close, and row by row in it."""
        W, row = self.width, self.row
        last = e.value(f"sub i64 {total}, {W - 1}")
        e.do(f"br label %{tag}.block")
        e.label(f"{tag}.block")
        e.do(f"%{tag}.c = phi i64 [0, %{tag}.first], [%{tag}.c1, %{tag}.block.end]")
        e.do(f"%{tag}.c1 = add i64 %{tag}.c, {BLOCK}")
        end = e.value(f"select i1 {e.value(f'icmp slt i64 %{tag}.c1, {row}')}, i64 %{tag}.c1, i64 {row}")
        e.do(f"br label %{tag}.row")
        e.label(f"{tag}.row")
        e.do(f"%{tag}.r = phi i64 [0, %{tag}.block], [%{tag}.r1, %{tag}.row.end]")
        start = e.value(f"mul i64 %{tag}.r, {row}")
        left = e.value(f"sub i64 {last}, {start}")
        stop = e.value(f"select i1 {e.value(f'icmp slt i64 {left}, {end}')}, i64 {left}, i64 {end}")
        # the first column from c on that begins a line
        offset = e.value(f"sub i64 {e.value(f'sub i64 {head}, {start}')}, %{tag}.c")
        first = e.value(f"add i64 %{tag}.c, {e.value(f'and i64 {offset}, {W - 1}')}")
        e.do(f"br label %{tag}.line")
        e.label(f"{tag}.line")
        e.do(f"%{tag}.j = phi i64 [{first}, %{tag}.row], [%{tag}.j1, %{tag}.one]")
        e.do(f"%{tag}.more = icmp slt i64 %{tag}.j, {stop}")
        e.do(f"br i1 %{tag}.more, label %{tag}.one, label %{tag}.row.end")
        e.label(f"{tag}.one")
        at = self._at(e, pointer, e.value(f"add i64 {start}, %{tag}.j"))
        e.do(f"store {e.vector} {self._line(e, f'%{tag}.r', f'%{tag}.j')}, ptr {at}, {how}")
        e.do(f"%{tag}.j1 = add i64 %{tag}.j, {W}")
        e.do(f"br label %{tag}.line")
        e.label(f"{tag}.row.end")
        e.do(f"%{tag}.r1 = add i64 %{tag}.r, 1")
        e.do(f"%{tag}.rows = icmp slt i64 %{tag}.r1, {W // self.joined}")
        e.do(f"br i1 %{tag}.rows, label %{tag}.row, label %{tag}.block.end")
        e.label(f"{tag}.block.end")
        e.do(f"%{tag}.blocks = icmp slt i64 %{tag}.c1, {row}")
        e.do(f"br i1 %{tag}.blocks, label %{tag}.block, label %rest")

    def _line(self, e: Lanes, row: str, j: str) -> str:
        """A vector of results, from entry j of a row (of joined rows) on."""
        base = self._at(e, "%out", e.value(f"mul i64 {row}, {self.joined}"))  # in all slots, that many numbers on
        entry = e.value(f"getelementptr i32, ptr @outputs, i64 {j}")
        where = e.value(f"load <{self.width} x i32>, ptr {entry}, align 4")
        return e.gather(e.value(f"getelementptr {self.number.name}, ptr {base}, <{self.width} x i32> {where}"))
