"""Writing LLVM IR for vectors of any number of lanes: arithmetic, transposition, sine and cosine."""

from __future__ import annotations

import copy
import itertools
import math
import struct
from dataclasses import dataclass

from ..jit.host import Host, binding


@dataclass(frozen=True)
class Number:
    """A floating-point format, and what reducing an angle to [-pi/4, pi/4] takes in it.

    Attributes
    ----------
    half_pi, split : tuple of float
        pi/2 as a sum of numbers: in full precision for hardware that multiplies and adds in one
        operation, and cut short, so that small multiples are exact, for hardware that does not.
    reach : float
        Largest |angle| reduced like this; beyond it, and for inf and nan, the C library answers.
    sin, cos : tuple of float
        sin r = r + r z S(z), cos r = 1 - z/2 + z^2 C(z), z = r^2: interpolated at Chebyshev's
        nodes, errors below 2e-17 (2e-8 in single precision).
    """

    name: str
    size: int
    half_pi: tuple[float, ...]
    split: tuple[float, ...]
    rounding: float
    reach: float
    sin: tuple[float, ...]
    cos: tuple[float, ...]

    @property
    def bits(self) -> int:
        return 8 * self.size


DOUBLE = Number(
    "double", 8,
    half_pi=(1.5707963267948966, 6.123233995736766e-17, -1.4973849048591698e-33),
    split=(1.570796325802803, 9.920935739593517e-10, 5.721188709663575e-18, 1.6446256936324258e-26),
    rounding=1.5 * 2.0**52,
    reach=1e8,
    sin=(-0.16666666666666666, 0.008333333333330948, -0.0001984126983675854, 2.7557316102534617e-06,
         -2.505113184128889e-08, 1.5918129027234826e-10),
    cos=(0.041666666666666664, -0.0013888888888887398, 2.4801587298765665e-05, -2.7557317271718644e-07,
         2.087614626607931e-09, -1.1382632258093615e-11),
)  # fmt: skip
SINGLE = Number(
    "float", 4,
    half_pi=(1.5707963705062866, -4.371138828673793e-08, -1.7151245100058819e-15),
    split=(1.5703125, 0.0004837512969970703, 7.549533620476723e-08, 2.5633440682570896e-12),
    rounding=1.5 * 2.0**23,
    reach=1e3,
    sin=(-0.166666641831398, 0.008332747966051102, -0.00019587890710681677),
    cos=(0.0416666641831398, -0.001388830249197781, 2.454794230288826e-05),
)  # fmt: skip


class Lanes:
    """Lines of IR that work on vectors of `width` numbers.  Methods return the name of their value."""

    def __init__(self, number: Number, width: int, host: Host) -> None:
        self.number, self.host = number, host
        self.lines: list[str] = []
        self._names = itertools.count(1)
        self._splat = binding().llvm_version_info[0] >= 19
        self._set_width(width)

    def _set_width(self, width: int) -> None:
        number, self.width = self.number, width
        self.vector = f"<{width} x {number.name}>"
        self.integer = f"<{width} x i{number.bits}>"
        self.mask = f"<{width} x i1>"
        self.suffix = f"v{width}f{number.bits}"
        self.align = width * number.size

    def of_width(self, width: int) -> Lanes:
        """More of the same lines, on vectors of another width."""
        other = copy.copy(self)
        other._set_width(width)
        return other

    def value(self, text: str) -> str:
        name = f"%t{next(self._names)}"
        self.lines.append(f"  {name} = {text}")
        return name

    def do(self, text: str) -> None:
        self.lines.append("  " + text)

    def label(self, name: str) -> None:
        self.lines.append(f"{name}:")

    def constants(self, values: list[str], kind: str) -> str:
        return "<" + ", ".join(f"{kind} {v}" for v in values) + ">"

    def every(self, text: str, kind: str) -> str:
        """The same constant in all lanes."""
        return f"splat ({kind} {text})" if self._splat else self.constants([text] * self.width, kind)

    def number_text(self, x: float) -> str:
        if self.number.size == 4:
            x = struct.unpack("<f", struct.pack("<f", x))[0]
        return f"0x{struct.unpack('<Q', struct.pack('<d', x))[0]:016X}"

    def constant(self, x: float) -> str:
        return self.every(self.number_text(x), self.number.name)

    # memory

    def at(self, base: str, i: int | str) -> str:
        """The place of the number i after the one at `base`."""
        return self.value(f"getelementptr {self.number.name}, ptr {base}, i64 {i}")

    def slot(self, base: str, index: int | str) -> str:
        return self.value(f"getelementptr inbounds {self.vector}, ptr {base}, i64 {index}")

    def load(self, base: str, index: int | str) -> str:
        return self.value(f"load {self.vector}, ptr {self.slot(base, index)}, align {self.align}")

    def store(self, base: str, index: int | str, x: str) -> None:
        self.do(f"store {self.vector} {x}, ptr {self.slot(base, index)}, align {self.align}")

    def load_row(self, p: str, count: int) -> str:
        """`count` numbers, the lanes beyond them zero.  Rows of arrays may lie anywhere."""
        if not count:
            return "zeroinitializer"
        if count == self.width:
            return self.value(f"load {self.vector}, ptr {p}, align {self.number.size}")
        mask = self.constants(["true"] * count + ["false"] * (self.width - count), "i1")
        return self.value(
            f"call {self.vector} @llvm.masked.load.{self.suffix}.p0(ptr {p}, i32 {self.number.size}, "
            f"{self.mask} {mask}, {self.vector} zeroinitializer)"
        )

    def store_row(self, p: str, count: int, x: str) -> None:
        if count == self.width:
            self.do(f"store {self.vector} {x}, ptr {p}, align {self.number.size}")
            return
        mask = self.constants(["true"] * count + ["false"] * (self.width - count), "i1")
        self.do(
            f"call void @llvm.masked.store.{self.suffix}.p0({self.vector} {x}, ptr {p}, i32 {self.number.size}, "
            f"{self.mask} {mask})"
        )

    def splat(self, x: str, kind: str) -> str:
        """The same number in all lanes."""
        vector = f"<{self.width} x {kind}>"
        one = self.value(f"insertelement {vector} poison, {kind} {x}, i32 0")
        return self.value(f"shufflevector {vector} {one}, {vector} poison, <{self.width} x i32> zeroinitializer")

    def broadcast(self, p: str) -> str:
        """The number at p, in all lanes."""
        return self.splat(self.value(f"load {self.number.name}, ptr {p}"), self.number.name)

    @property
    def declarations(self) -> str:
        V = self.vector
        pick = f"declare {V} @{self._pick}({V}, {self.integer}, {V})\n" if self.align == 64 else ""
        return pick + (
            f"declare {V} @llvm.fma.{self.suffix}({V}, {V}, {V})\n"
            f"declare {V} @llvm.sqrt.{self.suffix}({V})\n"
            f"declare {V} @llvm.fabs.{self.suffix}({V})\n"
            f"declare {V} @llvm.masked.load.{self.suffix}.p0(ptr, i32, {self.mask}, {V})\n"
            f"declare void @llvm.masked.store.{self.suffix}.p0({V}, ptr, i32, {self.mask})\n"
        )

    # arithmetic

    def binary(self, op: str, a: str, b: str) -> str:
        return self.value(f"{op} {self.vector} {a}, {b}")

    def negative(self, a: str) -> str:
        return self.value(f"fneg {self.vector} {a}")

    def unary(self, name: str, a: str) -> str:
        return self.value(f"call {self.vector} @llvm.{name}.{self.suffix}({self.vector} {a})")

    def fma(self, a: str, b: str, c: str) -> str:
        """a b + c, rounded once where the hardware can."""
        if not self.host.fma:
            return self.binary("fadd", self.binary("fmul", a, b), c)
        V = self.vector
        return self.value(f"call {V} @llvm.fma.{self.suffix}({V} {a}, {V} {b}, {V} {c})")

    def where_less(self, x: str, y: str, a: str, b: str) -> str:
        mask = self.value(f"fcmp olt {self.vector} {x}, {y}")
        return self.value(f"select {self.mask} {mask}, {self.vector} {a}, {self.vector} {b}")

    # rearrangement

    def transposed(self, rows: list[tuple[str, int]]) -> list[str]:
        """Columns of `width` rows, given where each is and how many numbers it has; beyond them are zeros.

        Halves of vectors change places while they are loaded, which takes no shuffle; then blocks of
        1, 2, 4, ... lanes between pairs of vectors.
        """
        if self.width == 1:
            return [self.load_row(*row) for row in rows]
        W, h, half = self.width, self.width // 2, self.of_width(self.width // 2)
        parts = [[half.load_row(p, min(n, h)), half.load_row(half.at(p, h), max(0, n - h))] for p, n in rows]
        columns = [self.joined(parts[i % h][i // h], parts[i % h + h][i // h], half) for i in range(W)]
        d = 1
        while d < h:
            for i in (i for i in range(W) if not i & d):
                a, b = columns[i], columns[i + d]
                low = [lane if not lane & d else W + lane - d for lane in range(W)]
                high = [lane + d if not lane & d else W + lane for lane in range(W)]
                columns[i], columns[i + d] = self.shuffled(a, b, low), self.shuffled(a, b, high)
            d *= 2
        return columns

    def joined(self, a: str, b: str, half: Lanes) -> str:
        """Two vectors of half the width, one after the other."""
        pick = self.constants([str(lane) for lane in range(self.width)], "i32")
        return self.value(f"shufflevector {half.vector} {a}, {half.vector} {b}, <{self.width} x i32> {pick}")

    def shuffled(self, a: str, b: str, lanes: list[int]) -> str:
        pick = self.constants([str(lane) for lane in lanes], "i32")
        return self.value(f"shufflevector {self.vector} {a}, {self.vector} {b}, <{self.width} x i32> {pick}")

    def picked(self, a: str, b: str, lanes: str) -> str:
        """Lanes of a, or `width` and more of b, that are known only when it runs.  AVX-512."""
        arguments = f"{self.vector} {a}, {self.integer} {lanes}, {self.vector} {b}"
        return self.value(f"call {self.vector} @{self._pick}({arguments})")

    @property
    def _pick(self) -> str:
        return f"llvm.x86.avx512.vpermi2var.{'pd' if self.number.size == 8 else 'ps'}.512"

    # sine and cosine

    def cos_sin(self, x: str) -> tuple[str, str, str]:
        """cos x, sin x, and a mask of the lanes where |x| is within reach.  (Cody & Waite 1980)

        x = n pi/2 + r with |r| <= pi/4; two polynomials in r, then the octant n says which is which
        and of what sign.  Adding 1.5 * 2^52 leaves n in the low bits.  The first product and
        difference are exact, so r is rounded once or twice, and results are within 1.5 ulp (2 without fma).
        """
        c, V = self.number, self.vector
        k = self.constant
        shifted = self.fma(x, k(2 / math.pi), k(c.rounding))
        octant = self.value(f"bitcast {V} {shifted} to {self.integer}")
        minus_n = self.binary("fsub", k(c.rounding), shifted)
        r = x
        for part in c.half_pi if self.host.fma else c.split:
            r = self.fma(minus_n, k(part), r)

        near = self.value(f"fcmp ole {V} {self.unary('fabs', x)}, {k(c.reach)}")
        return *self.turned(r, octant), near

    def turned(self, r: str, octant: str) -> tuple[str, str]:
        """Cosine and sine of r + octant pi/2, where |r| <= pi/4 and the octant is an integer."""
        c, V = self.number, self.vector
        z = self.binary("fmul", r, r)
        sin = self.fma(self.binary("fmul", r, z), self.polynomial(c.sin, z), r)
        cos = self.polynomial((1.0, -0.5, *c.cos), z)

        odd = self.value(f"trunc {self.integer} {octant} to {self.mask}")
        s = self.value(f"select {self.mask} {odd}, {V} {cos}, {V} {sin}")
        t = self.value(f"select {self.mask} {odd}, {V} {self.negative(sin)}, {V} {cos}")
        return self.signed(t, octant), self.signed(s, octant)

    def polynomial(self, coefficients: tuple[float, ...], z: str) -> str:
        *rest, value = (self.constant(c) for c in coefficients)
        for c in reversed(rest):
            value = self.fma(value, z, c)
        return value

    def signed(self, x: str, octant: str) -> str:
        """-x where bit 1 of the octant is set."""
        bits, kind = self.number.bits, self.integer
        bit = self.value(f"and {kind} {octant}, {self.every('2', f'i{bits}')}")
        sign = self.value(f"shl {kind} {bit}, {self.every(str(bits - 2), f'i{bits}')}")
        raw = self.value(f"bitcast {self.vector} {x} to {kind}")
        return self.value(f"bitcast {kind} {self.value(f'xor {kind} {raw}, {sign}')} to {self.vector}")
