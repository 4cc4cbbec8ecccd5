"""Sines and cosines of large angles.  (Payne & Hanek 1983)

A GPU has no C library.  x = m 2^k with an integer m; only the remainder of m 2^k (2/pi) modulo 4 matters, so the digits
of 2/pi whose products with m 2^k are multiples of 4 are omitted.  192 bits of the following digits suffice for every
double, since no double is nearer than 2^-62 to a multiple of pi/2.
"""

from __future__ import annotations

import math
from functools import cache

from ..codegen.number import DOUBLE, Number
from ..codegen.sincos import turned
from .scalar import Scalar

BITS = 1216  # bits of 2/pi that the largest double needs
LEAD = 63  # zeros before the binary point, so that small exponents need no special case


@cache
def digits() -> tuple[int, ...]:
    """2/pi in words of 64 bits, the first of them 63 zeros and the digit before the point.

    By Machin's formula in integers, with 64 guard bits.
    """
    one = 1 << (BITS + 64)

    def arctan_of_inverse(n: int) -> int:
        power, total, k = one // n, 0, 1
        while power:
            total += power // k if k % 4 == 1 else -(power // k)
            power, k = power // (n * n), k + 2
        return total

    pi = 4 * (4 * arctan_of_inverse(5) - arctan_of_inverse(239))
    bits = ((2 * one * one) // pi) >> 64  # BITS digits after the point
    count = BITS // 64
    return (0, *(bits >> 64 * (count - 1 - k) & (1 << 64) - 1 for k in range(count)))


def function(number: Number) -> str:
    """``{T, T} far(T x)``: cosine and sine of any angle; nan for inf and nan."""
    T, e = number.name, Scalar(DOUBLE)
    x = "%x" if number.size == 8 else e.value("fpext float %x to double")
    raw = e.value(f"bitcast double {x} to i64")
    exponent = _op(e, "and", _op(e, "lshr", raw, 52), 2047)
    mantissa = _op(e, "or", _op(e, "and", raw, (1 << 52) - 1), 1 << 52)
    # the first digit that matters has the weight 2^(1 - k), k = exponent - 1075
    place = _call(e, "smax", _op(e, "sub", exponent, 1076 - LEAD), 0)
    word, shift = _op(e, "lshr", place, 6), _op(e, "and", place, 63)
    words = []
    for k in range(4):
        pointer = e.value(f"getelementptr i64, ptr @two_over_pi, i64 {_op(e, 'add', word, k)}")
        words.append(e.value(f"load i64, ptr {pointer}, align 8"))
    w0, w1, w2 = (_call(e, "fshl", words[k], words[k + 1], shift) for k in range(3))

    # the low 192 bits of the product with the mantissa, two of them before the point
    low, carry = _product(e, mantissa, w2)
    middle, high = _product(e, mantissa, w1)
    p1 = _op(e, "add", middle, carry)
    over = e.value(f"zext i1 {e.value(f'icmp ult i64 {p1}, {middle}')} to i64")
    p0 = _op(e, "add", _op(e, "mul", mantissa, w0), _op(e, "add", high, over))
    f0, f1 = _call(e, "fshl", p0, p1, 2), _call(e, "fshl", p1, low, 2)

    # a fraction above one half is negative relative to the next multiple of pi/2
    above = _op(e, "ashr", f0, 63)
    octant = _op(e, "sub", _op(e, "lshr", p0, 62), above)
    f0, f1 = _op(e, "xor", f0, above), _op(e, "xor", f1, above)
    zeros = _call(e, "umin", e.value(f"call i64 @llvm.ctlz.i64(i64 {f0}, i1 false)"), 63)
    bits = _call(e, "fshl", f0, f1, zeros)
    scale = e.value(f"bitcast i64 {_op(e, 'shl', _op(e, 'sub', 1023 - 64, zeros), 52)} to double")
    upper, lower = (e.value(f"uitofp i64 {_op(e, 'and', bits, mask)} to double") for mask in (-2048, 2047))
    half_pi, rest, _ = (e.constant(part) for part in DOUBLE.half_pi)
    r = e.fma(upper, half_pi, e.fma(upper, rest, e.binary("fmul", lower, half_pi)))
    c, s = turned(e, _with_sign(e, e.binary("fmul", r, scale), above), octant)
    s = _with_sign(e, s, raw)

    infinite = e.value(f"icmp eq i64 {exponent}, 2047")
    results = [e.value(f"select i1 {infinite}, double {e.constant(math.nan)}, double {v}") for v in (c, s)]
    if number.size == 4:
        results = [e.value(f"fptrunc double {v} to float") for v in results]
    both = e.value(f"insertvalue {{{T}, {T}}} poison, {T} {results[0]}, 0")
    both = e.value(f"insertvalue {{{T}, {T}}} {both}, {T} {results[1]}, 1")
    table, body = ", ".join(f"i64 {w}" for w in digits()), "\n".join(e.lines)
    return (
        "declare i64 @llvm.smax.i64(i64, i64)\ndeclare i64 @llvm.umin.i64(i64, i64)\n"
        "declare i64 @llvm.ctlz.i64(i64, i1)\ndeclare i64 @llvm.fshl.i64(i64, i64, i64)\n"
        f"@two_over_pi = internal constant [{len(digits())} x i64] [{table}], align 8\n"
        f"define internal {{{T}, {T}}} @far({T} %x) noinline #0 {{\n{body}\n  ret {{{T}, {T}}} {both}\n}}\n"
    )


def _op(e: Scalar, name: str, a: str | int, b: str | int) -> str:
    return e.value(f"{name} i64 {a}, {b}")


def _call(e: Scalar, name: str, *args: str | int) -> str:
    return e.value(f"call i64 @llvm.{name}.i64({', '.join(f'i64 {a}' for a in args)})")


def _product(e: Scalar, a: str, b: str) -> tuple[str, str]:
    """The lower and upper 64 bits of a product."""
    wide = e.value(f"mul i128 {e.value(f'zext i64 {a} to i128')}, {e.value(f'zext i64 {b} to i128')}")
    upper = e.value(f"trunc i128 {e.value(f'lshr i128 {wide}, 64')} to i64")
    return e.value(f"trunc i128 {wide} to i64"), upper


def _with_sign(e: Scalar, x: str, of: str) -> str:
    """x, or -x where the top bit of an integer is set."""
    sign = _op(e, "and", of, -1 << 63)
    turned = _op(e, "xor", e.value(f"bitcast double {x} to i64"), sign)
    return e.value(f"bitcast i64 {turned} to double")
