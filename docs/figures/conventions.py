"""The picture of docs/conventions.md:  python docs/figures/conventions.py  writes conventions.svg beside this file."""

from __future__ import annotations

from math import cos, radians, sin
from pathlib import Path

INK, SOFT, FIRST, SECOND = "#24303b", "#6b7885", "#cfe3f5", "#f6e0c4"
X, Y, Z = "#c0392b", "#2e8b57", "#1f6fb2"
ARRAYS = (
    ("quaternion", ["w", "x", "y", "z"], 1),
    ("dual quaternion", ["w", "x", "y", "z", "w'", "x'", "y'", "z'"], 4),
    ("twist [w; v]", ["wx", "wy", "wz", "vx", "vy", "vz"], 3),
    ("wrench [n; f]", ["nx", "ny", "nz", "fx", "fy", "fz"], 3),
    ("floating base, q", ["x", "y", "z", "qw", "qx", "qy", "qz"], 3),
    ("floating base, v", ["wx", "wy", "wz", "vx", "vy", "vz"], 3),
)
REFERENCES = (
    ('"world"', "about the world's origin, its axes", (0.0, 0.0), 0.0),
    ('"local"', "about the frame's origin, its axes", (78.0, -52.0), -35.0),
    ('"local_world_aligned"', "about the frame's origin, world axes", (78.0, -52.0), 0.0),
)


def text(
    x: float, y: float, words: str, size: int = 13, fill: str = INK, anchor: str = "start", weight: str = "400"
) -> str:
    style = f'font-size="{size}" fill="{fill}" text-anchor="{anchor}" font-weight="{weight}"'
    return f'<text x="{x}" y="{y}" {style}>{words}</text>'


def arrays(x: float, y: float) -> list[str]:
    """The order of numbers, a box each; the colour changes where the second part begins."""
    found = [text(x, y - 12, "Order of numbers", 14, weight="600")]
    for k, (name, entries, split) in enumerate(ARRAYS):
        top = y + 34 * k
        found.append(text(x, top + 18, name))
        for i, entry in enumerate(entries):
            left = x + 128 + 33 * i
            fill = FIRST if i < split else SECOND
            found.append(f'<rect x="{left}" y="{top}" width="32" height="26" rx="3" fill="{fill}"/>')
            found.append(text(left + 16, top + 18, entry, 12, anchor="middle"))
    return found


def axes(x: float, y: float, turn: float, length: float = 30, width: float = 2.2, opacity: float = 1.0) -> list[str]:
    """Two axes of a frame, x and z, turned by an angle in degrees."""
    found = []
    for angle, colour, name in ((0.0, X, "x"), (-90.0, Z, "z")):
        dx, dy = (length * f(radians(angle + turn)) for f in (cos, sin))
        end = f'x2="{x + dx:.1f}" y2="{y + dy:.1f}"'
        found.append(f'<line x1="{x}" y1="{y}" {end} stroke="{colour}" stroke-width="{width}" opacity="{opacity}"/>')
        if opacity == 1.0:
            found.append(text(round(x + 1.3 * dx, 1), round(y + 1.3 * dy + 4, 1), name, 11, colour, "middle"))
    return found


def references(x: float, y: float) -> list[str]:
    """Where a Jacobian's point and axes are, for each reference: drawn strongly; the frames faintly."""
    found = [text(x, y - 12, "reference= of Jacobians, velocities, accelerations", 14, weight="600")]
    for k, (name, words, (dx, dy), turn) in enumerate(REFERENCES):
        left, bottom = x + 24, y + 92 + 112 * k
        tool = (left + 78, bottom - 52)
        found.append(
            f'<path d="M{left} {bottom} q 20 -60 78 -52" fill="none" stroke="{SOFT}" stroke-width="5" opacity="0.35"/>'
        )
        found += axes(left, bottom, 0.0, opacity=0.3) + axes(*tool, -35.0, opacity=0.3)
        found += axes(left + dx, bottom + dy, turn)
        found.append(f'<circle cx="{left + dx}" cy="{bottom + dy}" r="4" fill="{INK}"/>')
        found.append(text(left + 140, bottom - 40, name, 13, weight="600"))
        found.append(text(left + 140, bottom - 20, words, 12, SOFT))
    return found


def world(x: float, y: float) -> list[str]:
    """z up, gravity down."""
    arrow = f'<path d="M{x + 110} {y - 34} v40 m-5 -8 l5 8 l5 -8" fill="none" stroke="{INK}" stroke-width="2"/>'
    return [
        text(x - 20, y - 64, "World: z up, SI units, radians", 14, weight="600"), *axes(x, y, 0.0, 38), arrow,
        text(x + 124, y - 8, "gravity (0, 0, -9.81)", 12),
    ]  # fmt: skip


def picture() -> str:
    parts = [*arrays(20, 40), *references(440, 40), *world(40, 350)]
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 840 380" font-family="sans-serif" role="img" '
        'aria-label="Order of numbers in arrays, and where Jacobians are taken">'
        '<rect width="840" height="380" fill="#ffffff" rx="6"/>' + "\n".join(parts) + "</svg>\n"
    )


if __name__ == "__main__":
    Path(__file__).with_suffix(".svg").write_text(picture(), encoding="utf-8")
