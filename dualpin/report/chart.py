"""Charts as geometry: numbers go in, places on a drawing come out, and a template draws them as SVG."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from math import ceil, floor, isfinite, log10

WIDTH, HEIGHT = 480.0, 320.0
LEFT, RIGHT, TOP, BOTTOM = 62.0, 12.0, 10.0, 46.0
ROW = 17.0  # height of a row of a strip chart
STRIP_LEFT = 190.0
WIDE, SLIM = 760.0, 360.0  # of a strip chart

Tick = tuple[float, str]


@dataclass
class Series:
    """A named series of points (x, y, tooltip)."""

    name: str
    points: list[tuple[float, float, str]]


@dataclass
class Axis:
    """From numbers to places between two ends of a drawing."""

    lowest: float
    highest: float
    start: float
    stop: float
    log: bool = False

    def place(self, x: float) -> float:
        low, high, x = (log10(v) if self.log else v for v in (self.lowest, self.highest, x))
        return round(self.start + (self.stop - self.start) * (x - low) / (high - low), 1)

    @property
    def ticks(self) -> list[Tick]:
        values = decades(self.lowest, self.highest) if self.log else steps(self.lowest, self.highest)
        return [(self.place(v), label(v)) for v in values]


@dataclass
class Chart:
    """Lines and dots over two axes.

    Examples
    --------
    >>> from dualpin.report.chart import Chart, Series
    >>> chart = Chart("cost", "degrees of freedom", "time in us", [Series("rnea", [(7, 0.05, ""), (70, 0.6, "")])])
    >>> [text for _, text in chart.y.ticks]
    ['0.01', '0.1', '1']
    """

    title: str
    xlabel: str
    ylabel: str
    series: list[Series]
    xlog: bool = True
    ylog: bool = True
    note: str = ""
    line: float | None = None  # a level to compare with
    x: Axis = field(init=False)
    y: Axis = field(init=False)

    def __post_init__(self) -> None:
        for s in self.series:
            s.points = sorted(p for p in s.points if _drawable(p[0], self.xlog) and _drawable(p[1], self.ylog))
        self.series = [s for s in self.series if s.points]
        xs = [p[0] for s in self.series for p in s.points]
        ys = [p[1] for s in self.series for p in s.points] + ([self.line] if self.line is not None else [])
        self.x = Axis(*_ends(xs, self.xlog, tight=True), LEFT, WIDTH - RIGHT, self.xlog)
        self.y = Axis(*_ends(ys, self.ylog), HEIGHT - BOTTOM, TOP, self.ylog)

    shape = "lines"
    width, height = WIDTH, HEIGHT
    left, right, top, bottom = LEFT, WIDTH - RIGHT, TOP, HEIGHT - BOTTOM

    @property
    def drawn(self) -> list[tuple[Series, list[tuple[float, float, str]]]]:
        """The series with their points placed."""
        return [(s, [(self.x.place(x), self.y.place(y), text) for x, y, text in s.points]) for s in self.series]

    @property
    def level(self) -> float | None:
        return None if self.line is None else self.y.place(self.line)


@dataclass
class Strips:
    """One row of dots for each name, over a common logarithmic axis."""

    title: str
    xlabel: str
    rows: list[tuple[str, list[tuple[float, str, bool]]]]  # name, (x, hover, whether it is bad)
    lowest: float
    highest: float
    line: float = 1.0
    note: str = ""
    slim: bool = False  # for small screens: names above their rows, and nothing to hover over

    shape = "strips"
    top = TOP

    @property
    def both(self) -> list[Strips]:
        """The drawing for wide screens and for small ones; the page shows one."""
        rows = [(name, [(x, "", bad) for x, _, bad in points]) for name, points in self.rows]
        return [self, replace(self, rows=rows, slim=True)]

    @property
    def width(self) -> float:
        return SLIM if self.slim else WIDE

    @property
    def left(self) -> float:
        return RIGHT if self.slim else STRIP_LEFT

    @property
    def right(self) -> float:
        return self.width - RIGHT

    @property
    def row(self) -> float:
        return 1.8 * ROW if self.slim else ROW

    @property
    def bottom(self) -> float:
        return TOP + self.row * len(self.rows)

    @property
    def height(self) -> float:
        return self.bottom + BOTTOM

    @property
    def x(self) -> Axis:
        return Axis(self.lowest, self.highest, self.left, self.right, True)

    @property
    def level(self) -> float:
        return self.x.place(self.line)

    @property
    def drawn(self) -> list[tuple[str, float, list[tuple[float, str, bool]]]]:
        """The rows with their height and their points placed; what is off the axis stands at its end."""
        x = self.x
        return [
            (
                name,
                TOP + self.row * (k + (0.75 if self.slim else 0.5)),
                [(x.place(min(max(v, self.lowest), self.highest)), t, bad) for v, t, bad in p],
            )
            for k, (name, p) in enumerate(self.rows)
        ]


def decades(lowest: float, highest: float, most: int = 8) -> list[float]:
    """Powers of ten between two positive numbers, at most so many; 1-2-5 where there are hardly any."""
    first, last = ceil(log10(lowest) - 1e-9), floor(log10(highest) + 1e-9)
    if last - first < 1:
        some = [m * 10.0**e for e in range(first - 1, last + 2) for m in (1, 2, 5)]
        return [v for v in some if lowest * (1 - 1e-9) <= v <= highest * (1 + 1e-9)]
    step = max(1, ceil((last - first + 1) / most))
    return [10.0**e for e in range(first, last + 1, step)]


def steps(lowest: float, highest: float, most: int = 6) -> list[float]:
    """Round numbers between two numbers."""
    raw = (highest - lowest) / most
    power = 10.0 ** floor(log10(raw))
    step = next(m * power for m in (1, 2, 2.5, 5, 10) if m * power >= raw * (1 - 1e-9))
    return [k * step for k in range(ceil(lowest / step - 1e-9), floor(highest / step + 1e-9) + 1)]


def label(x: float) -> str:
    """A number for an axis."""
    if x == 0 or 1e-3 <= abs(x) < 1e5:
        return f"{x:.6g}"
    mantissa, exponent = f"{x:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def _drawable(x: float | None, log: bool) -> bool:
    return isinstance(x, (int, float)) and isfinite(x) and (x > 0 or not log)


def _ends(values: Sequence[float] | Iterable[float], log: bool, tight: bool = False) -> tuple[float, float]:
    """Where an axis begins and ends: around the values, at whole decades if logarithmic."""
    found = [float(v) for v in values] or [1.0]
    low, high = min(found), max(found)
    if log and tight and high > low:
        return low / 1.15, high * 1.15
    if log:
        low, high = 10.0 ** floor(log10(low) + 1e-9), 10.0 ** ceil(log10(high) - 1e-9)
        return (low / 10, high * 10) if low == high else (low, high)
    pad = 0.05 * (high - low) or max(abs(high), 1.0) * 0.1
    return (0.0 if 0 <= low < 0.3 * high else low - pad), high + pad
