"""Results that leave as whole lines of the cache, where a vector is as long as a line.

A store that crosses the border between two lines costs two, and rows begin anywhere.  So what
belongs to a line is put together in registers, from two vectors of a row next to each other, and
each line is written once.  Results too many for the caches can then go past them.
"""

from __future__ import annotations

from .host import Host
from .lanes import Lanes, Number
from .rows import Array, Rows
from .schedule import Schedule

STREAMED = 8 << 20  # bytes of results from which they go past the caches
FEW = 4  # vectors in a row from which lines pay


def rows_of(plan: Schedule, number: Number, width: int, host: Host) -> Rows:
    """The way in and out that takes this host the least time."""
    lined = width * number.size == 64 and len(plan.outputs) >= FEW * width
    return (Lines if lined else Rows)(plan, number, width, host)


class Lines(Rows):
    """Rows transposed a vector at a time; a line is the end of one vector and the beginning of the next.

    A row goes on where the row before it ends, also across tiles: nothing but whole lines is written,
    except by the first tile and the last, since what lies around all results is not ours.
    """

    @property
    def spare(self) -> int:
        """The end of the tile before."""
        return 1

    def store(self, e: Lanes, array: Array, first: str, last: str) -> None:
        W, carried, bases = self.width, self.plan.output_slots, self._addresses(e, array, first, last)
        ends = self._results(e, self.columns - W, W)
        before = [e.load("%out", carried), *ends[:-1]]
        e.store("%out", carried, ends[-1])
        begun = e.value(f"icmp ne i64 {first}, 0")
        goes_on = e.value(f"icmp sle i64 {e.value(f'add i64 {first}, {W}')}, {last}")
        e.do(f"br i1 {e.value(f'and i1 {begun}, {goes_on}')}, label %middle, label %edge")
        e.label("edge")
        earlier = e.at(bases[0], -W)
        e.store_row(e.value(f"select i1 {begun}, ptr {earlier}, ptr {bases[0]}"), W, before[0])
        super().store(e, array, first, last)
        e.do("br label %rest")
        e.label("middle")
        address = e.value(f"ptrtoint ptr {array.pointer} to i64")
        aligned = e.value(f"icmp eq i64 {e.value(f'and i64 {address}, {self.number.size - 1}')}, 0")
        bases.append(e.value(f"getelementptr i8, ptr {bases[-1]}, i64 {array.stride}"))
        lines = [self._line(e, base, aligned) for base in bases]
        whole = e.value(f"mul i64 {e.value(f'add i64 {last}, 1')}, {array.stride}")
        past = e.value(f"and i1 {aligned}, {e.value(f'icmp ugt i64 {whole}, {STREAMED}')}")
        e.do(f"br i1 {past}, label %past.first, label %cached.first")
        self._middle(e, "past", f"align {e.align}, !nontemporal !0", lines, before, ends)
        self._middle(e, "cached", f"align {self.number.size}", lines, before, ends)
        e.label("rest")

    def _line(self, e: Lanes, base: str, aligned: str) -> tuple[str, str]:
        """Where the line around an address begins, and which numbers of two vectors are in the second's line.

        Where numbers lie across the borders of lines there are none: the second vector is stored as it is.
        """
        kind = f"i{self.number.bits}"
        within = e.value(f"select i1 {aligned}, {kind} {e.align - 1}, {kind} 0")
        offset = e.value(f"and {kind} {e.value(f'ptrtoint ptr {base} to {kind}')}, {within}")
        back = e.splat(e.value(f"lshr {kind} {offset}, {self.number.size.bit_length() - 1}"), kind)
        second = e.constants([str(self.width + lane) for lane in range(self.width)], kind)
        pick = e.value(f"sub {e.integer} {second}, {back}")
        return e.value(f"getelementptr i8, ptr {base}, {kind} {e.value(f'sub {kind} 0, {offset}')}"), pick

    def _middle(
        self, e: Lanes, tag: str, how: str, lines: list[tuple[str, str]], before: list[str], ends: list[str]
    ) -> None:
        """All lines that end in these rows, given the vectors before and at the end of each."""
        W = self.width
        full, rest = divmod(self.columns, W)

        e.label(f"{tag}.first")
        e.do(f"br label %{tag}")
        e.label(tag)
        e.do(f"%{tag}.j = phi i64 [0, %{tag}.first], [%{tag}.next, %{tag}]")
        phis = len(e.lines)
        rows = self._results(e, f"%{tag}.j", W)
        for k in range(W):
            line = e.picked(f"%{tag}.before{k}", rows[k], lines[k][1])
            e.do(f"store {e.vector} {line}, ptr {e.at(lines[k][0], f'%{tag}.j')}, {how}")
        e.do(f"%{tag}.next = add i64 %{tag}.j, {W}")
        e.do(f"%{tag}.more = icmp slt i64 %{tag}.next, {(full if rest else full - 1) * W}")
        e.do(f"br i1 %{tag}.more, label %{tag}, label %{tag}.last")
        e.lines[phis:phis] = [
            f"  %{tag}.before{k} = phi {e.vector} [{before[k]}, %{tag}.first], [{rows[k]}, %{tag}]" for k in range(W)
        ]
        e.label(f"{tag}.last")
        if rest:
            rows = self._results(e, self.columns - 2 * W, W)
        for k, (end, pick) in enumerate(lines[1:]):
            at, line = e.at(end, -W), e.picked(rows[k], ends[k], pick)
            if rest:  # it may be there already, in every tile in the same rows: the processor foresees it
                written = e.value(f"icmp eq ptr {at}, {e.at(lines[k][0], (full - 1) * W)}")
                e.do(f"br i1 {written}, label %{tag}.ended{k}, label %{tag}.end{k}")
                e.label(f"{tag}.end{k}")
            e.do(f"store {e.vector} {line}, ptr {at}, {how}")
            if rest:
                e.do(f"br label %{tag}.ended{k}")
                e.label(f"{tag}.ended{k}")
        e.do("br label %rest")
