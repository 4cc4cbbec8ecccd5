"""Rows of arrays to slots, and slots to rows.

A sample is a row; a slot holds the same entry of as many samples as there are lanes.  Rows are
loaded as vectors and transposed in registers, and so are results on their way out.  Where a vector
is as long as a line of the cache, results leave line by line, none of them touched twice; machines
that gather quickly collect each line from the slots.  Results too many for the caches go past them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .host import Host
from .lanes import Lanes, Number
from .schedule import Schedule

UNROLLED = 64  # columns that are written out instead of looped over
BLOCK = 256  # columns of a result that leave together: their slots fit the first cache
STREAMED = 8 << 20  # bytes of a result from which it is written past the caches


@dataclass(frozen=True)
class Array:
    """An array as the kernel knows it: its address, and how many bytes lie from one row to the next."""

    pointer: str
    stride: str


class Rows:
    """IR that moves one tile of samples into its slots and out of them."""

    def __init__(self, plan: Schedule, number: Number, width: int, host: Host) -> None:
        self.plan, self.number, self.width, self.host = plan, number, width, host
        self.widest = host.lanes(number.size)
        self.columns = len(plan.outputs)
        self.lines = host.width == 64 and width > 1 and self.columns > 0
        self.gathers = self.lines and host.gathers
        # lines need rows no shorter than a vector: so many are taken as one
        self.joined = next(r for r in (1, 2, 4, 8, 16, 32) if r * max(self.columns, 1) >= width)

    @property
    def spare(self) -> int:
        """Slots needed after the others: to copy or gather beyond the last, or to put rows together in."""
        if self.width == 1:
            return self.widest
        if not self.lines:
            return 0
        return self.joined if self.gathers else self.columns + 1

    def tables(self) -> str:
        """The constants of a row; or where its entries come from: slots, or the numbers in them to gather from."""
        name, W, outputs = self.number.name, self.width, self.plan.outputs
        if self.plan.direct:
            text = Lanes(self.number, 1, self.host).number_text
            row = [f"{name} {text(self.plan.constants.get(j, 0.0))}" for j in range(self.columns)]
            return f"@row = internal constant [{len(row)} x {name}] [{', '.join(row)}]\n"
        if self.gathers:  # and on into the next row, as far as a vector goes
            count = self.joined * self.columns + W
            outputs = [outputs[i % self.columns] * W + i // self.columns for i in range(count)]
        return f"@outputs = internal constant [{len(outputs)} x i32] [{', '.join(f'i32 {x}' for x in outputs)}]\n"

    # in

    def load(self, e: Lanes, k: int, array: Array, first: str, last: str) -> None:
        """Input k of the tile's rows: `first`, those after it up to the `last` there is, and that again."""
        start, columns = sum(self.plan.sizes[:k]), self.plan.sizes[k]
        bases = self._addresses(e, array, first, last)
        if self.width == 1:
            self._copy(e, f"in{k}", columns, bases[0], e.slot("%scratch", start), beyond=True)
            return

        def transpose(j: int | str, count: int) -> None:
            slot, rows = e.value(f"add i64 {j}, {start}"), [e.load_row(self._at(e, base, j), count) for base in bases]
            for c, column in enumerate(e.transposed(rows)[:count]):
                e.store("%scratch", e.value(f"add i64 {slot}, {c}"), column)

        self._each(e, f"in{k}", columns, self.width, transpose)

    def _addresses(self, e: Lanes, array: Array, first: str, last: str) -> list[str]:
        places = []
        for lane in range(self.width):
            row = e.value(f"add i64 {first}, {lane}")
            row = e.value(f"select i1 {e.value(f'icmp slt i64 {row}, {last}')}, i64 {row}, i64 {last}")
            offset = e.value(f"mul i64 {row}, {array.stride}")
            places.append(e.value(f"getelementptr i8, ptr {array.pointer}, i64 {offset}"))
        return places

    def _copy(self, e: Lanes, tag: str, count: int, source: str, target: str, beyond: bool = False) -> None:
        """Numbers from one place to another, by whole vectors; the last may go `beyond`."""
        wide = e.of_width(self.widest)

        def vector(j: int | str, n: int) -> None:
            x = wide.load_row(self._at(wide, source, j), n)
            wide.store_row(self._at(wide, target, j), wide.width if beyond else n, x)

        self._each(wide, tag, count, wide.width, vector)

    # out

    def copy_constants(self, e: Lanes) -> None:
        """What does not depend on the inputs, to a row that the rest will be written to."""
        if self.plan.constants:
            self._copy(e, "constants", self.columns, "@row", "%out")

    def store(self, e: Lanes, array: Array, first: str, last: str) -> None:
        """The results of the tile's rows, which follow each other without gaps; `last` is the last of all."""
        if not self.lines:
            self._transposed(e, self._addresses(e, array, first, last))
            return
        source = "%out"
        if not self.gathers:
            source = e.slot("%out", self.plan.output_slots)
            self._transposed(e, [self._at(e, source, r * self.columns) for r in range(self.width)])
        all_rows = e.value(f"add i64 {last}, 1")
        rows = e.value(f"sub i64 {all_rows}, {first}")
        rows = e.value(f"select i1 {e.value(f'icmp slt i64 {rows}, {self.width}')}, i64 {rows}, i64 {self.width}")
        offset = e.value(f"mul i64 {first}, {array.stride}")
        pointer = e.value(f"getelementptr i8, ptr {array.pointer}, i64 {offset}")
        whole = e.value(f"mul i64 {all_rows}, {array.stride}")
        self._in_lines(e, pointer, e.value(f"mul i64 {rows}, {self.columns}"), whole, source)

    def _transposed(self, e: Lanes, bases: list[str]) -> None:
        """Entries from their slots to rows at these addresses."""

        def group(j: int | str, count: int) -> None:
            columns = []
            for c in range(self.width):
                if c >= count:
                    columns.append("zeroinitializer")
                elif isinstance(j, int):
                    columns.append(e.load("%out", self.plan.outputs[j + c]))
                else:
                    entry = e.value(f"getelementptr i32, ptr @outputs, i64 {e.value(f'add i64 {j}, {c}')}")
                    columns.append(e.load("%out", e.value(f"zext i32 {e.value(f'load i32, ptr {entry}')} to i64")))
            for base, row in zip(bases, e.transposed(columns), strict=True):
                e.store_row(self._at(e, base, j), count, row)

        self._each(e, "results", self.columns, self.width, group)

    def _in_lines(self, e: Lanes, pointer: str, total: str, whole: str, source: str) -> None:
        """`total` numbers to `pointer` and after: up to where a line begins, lines, and the rest.

        `whole` is the size of all results in bytes.
        """
        W, size, line = self.width, self.number.size, self.width * self.number.size
        address = e.value(f"ptrtoint ptr {pointer} to i64")
        beyond = e.value(f"and i64 {e.value(f'sub i64 0, {address}')}, {line - 1}")
        head = e.value(f"lshr i64 {beyond}, {size.bit_length() - 1}")
        head = e.value(f"select i1 {e.value(f'icmp slt i64 {total}, {head}')}, i64 {total}, i64 {head}")
        large = e.value(f"icmp ugt i64 {whole}, {STREAMED}")
        lined = e.value(f"icmp eq i64 {e.value(f'and i64 {beyond}, {size - 1}')}, 0")
        past = e.value(f"and i1 {large}, {lined}")

        def part(p: str, count: str) -> None:
            lanes, kind = e.constants([str(lane) for lane in range(W)], "i64"), f"<{W} x i64>"
            mask = e.value(f"icmp slt {kind} {lanes}, {e.splat(count, 'i64')}")
            row = e.value(f"udiv i64 {p}, {self.joined * self.columns}")
            j = e.value(f"sub i64 {p}, {e.value(f'mul i64 {row}, {self.joined * self.columns}')}")
            e.store_some(self._at(e, pointer, p), self._line(e, source, row, j), mask)

        part("0", head)
        e.do("br label %lines")
        e.label("lines")
        e.do(f"br i1 {past}, label %past.first, label %cached.first")
        self._whole_lines(e, "past", pointer, head, total, source, f"align {line}, !nontemporal !0")
        self._whole_lines(e, "cached", pointer, head, total, source, f"align {size}")
        e.label("rest")
        lines = e.value(f"and i64 {e.value(f'sub i64 {total}, {head}')}, -{W}")
        done = e.value(f"add i64 {head}, {lines}")
        part(done, e.value(f"sub i64 {total}, {done}"))

    def _whole_lines(self, e: Lanes, tag: str, pointer: str, head: str, total: str, source: str, how: str) -> None:
        """Block by block of columns, so that their slots stay close, and row by row in it."""
        W, row = self.width, self.joined * self.columns
        e.label(f"{tag}.first")
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
        e.do(f"store {e.vector} {self._line(e, source, f'%{tag}.r', f'%{tag}.j')}, ptr {at}, {how}")
        e.do(f"%{tag}.j1 = add i64 %{tag}.j, {W}")
        e.do(f"br label %{tag}.line")
        e.label(f"{tag}.row.end")
        e.do(f"%{tag}.r1 = add i64 %{tag}.r, 1")
        e.do(f"%{tag}.rows = icmp slt i64 %{tag}.r1, {W // self.joined}")
        e.do(f"br i1 %{tag}.rows, label %{tag}.row, label %{tag}.block.end")
        e.label(f"{tag}.block.end")
        e.do(f"%{tag}.blocks = icmp slt i64 %{tag}.c1, {row}")
        e.do(f"br i1 %{tag}.blocks, label %{tag}.block, label %rest")

    def _at(self, e: Lanes, base: str, i: int | str) -> str:
        return e.value(f"getelementptr {self.number.name}, ptr {base}, i64 {i}")

    def _line(self, e: Lanes, source: str, row: str, j: str) -> str:
        """A vector of results, from entry j of a row (of joined rows) on."""
        if not self.gathers:
            start = e.value(f"mul i64 {row}, {self.joined * self.columns}")
            return e.load_row(self._at(e, source, e.value(f"add i64 {start}, {j}")), self.width)
        base = self._at(e, source, e.value(f"mul i64 {row}, {self.joined}"))  # in all slots, that many numbers on
        entry = e.value(f"getelementptr i32, ptr @outputs, i64 {j}")
        where = e.value(f"load <{self.width} x i32>, ptr {entry}, align 4")
        return e.gather(e.value(f"getelementptr {self.number.name}, ptr {base}, <{self.width} x i32> {where}"))

    # loops

    def _each(self, e: Lanes, tag: str, count: int, step: int, body: Callable[[int | str, int], None]) -> None:
        """body(j, how many) for j = 0, step, ...: written out if few, else a loop and what is left of it."""
        full = count // step
        if full <= UNROLLED // step:
            for j in range(0, full * step, step):
                body(j, step)
        else:
            e.do(f"br label %{tag}.before")
            e.label(f"{tag}.before")
            e.do(f"br label %{tag}")
            e.label(tag)
            e.do(f"%{tag}.j = phi i64 [0, %{tag}.before], [%{tag}.next, %{tag}]")
            body(f"%{tag}.j", step)
            e.do(f"%{tag}.next = add i64 %{tag}.j, {step}")
            e.do(f"%{tag}.more = icmp slt i64 %{tag}.next, {full * step}")
            e.do(f"br i1 %{tag}.more, label %{tag}, label %{tag}.after")
            e.label(f"{tag}.after")
        if count % step:
            body(full * step, count % step)
