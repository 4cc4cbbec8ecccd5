"""Floating-point formats, and the constants of sine and cosine in each."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Number:
    """A floating-point format, and its constants for reducing an angle to [-pi/4, pi/4].

    Attributes
    ----------
    half_pi, split : tuple of float
        pi/2 as a sum of numbers: in full precision for hardware with fused multiply-add, and truncated, so
        that small multiples are exact, for other hardware.
    reach : float
        Largest |angle| that is reduced like this; for larger ones, inf and nan the C library is called.
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
