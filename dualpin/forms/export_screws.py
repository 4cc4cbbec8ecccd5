"""Home poses and screws as text in many formats."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arguments import choice
from ..errors import ArgumentError
from ..escape import csv_cell, json_text, line, markdown, tex
from . import text
from .export import FORMATS

if TYPE_CHECKING:
    from .screw_tree import ScrewTree
    from .screws import Screws

AXES = ("wx", "wy", "wz", "vx", "vy", "vz")


def screws_text(poe: Screws, format: str, degrees: bool, digits: int | None) -> str:
    """Home pose and screws in one of the formats."""
    choice("export: format", format, FORMATS)
    text.checked_digits(digits)
    S = poe.screws * _scale(poe, degrees)
    if format in ("json", "yaml"):
        data = text.rounded(_data(poe, S, degrees), digits)
        return json_text(data) if format == "json" else text.yaml(data)
    if format in ("python", "matlab"):
        return _code(poe, format, degrees, digits)
    cells = [[name, *(text.number(x, digits) for x in s)] for name, s in zip(poe.joint_names, S, strict=True)]
    home = [[f"home row {i + 1}", *(text.number(x, digits) for x in row), "", ""] for i, row in enumerate(poe.home)]
    header = ["joint", *AXES]
    if format == "csv":
        return text.comma_separated(header, [*cells, *home])
    if format == "markdown":
        return text.markdown(header, cells) + "\n\n" + text.markdown(["home", "", "", "", ""], [
            ["", *row[1:5]] for row in home
        ])  # fmt: skip
    if format == "latex":
        matrix = " \\\\\n".join(" & ".join(map(text.scientific, row[1:5])) for row in home)
        symbols = [rf"${c[0] if c[0] == 'v' else chr(92) + 'omega'}_{c[1]}$" for c in AXES]
        rows = [[tex(row[0]), *(f"${text.scientific(x)}$" for x in row[1:])] for row in cells]
        table = text.latex("lrrrrrr", ["joint", *symbols], rows)
        return table + "\n\\[ M = \\left[\\begin{array}{rrrr}\n" + matrix + "\n\\end{array}\\right] \\]"
    unit = "deg" if degrees else "rad"
    ends = f"from {line(poe.chain.base.name)} to {line(poe.chain.tip.name)}"
    title = f"{line(poe.chain.robot.name)}: {poe.frame} screws [w; v] per {unit} (or m), {ends}"
    order = "T = exp(S1 q1) ... exp(Sn qn) M" if poe.frame == "space" else "T = M exp(B1 q1) ... exp(Bn qn)"

    def tidied(row: Any) -> list[str]:
        return [text.tidy(x, poe.residual, digits) for x in row]

    cells = [[name, *tidied(s)] for name, s in zip(poe.joint_names, S, strict=True)]
    matrix = text.aligned(["M", "", "", ""], [tidied(row) for row in poe.home])
    return f"{title}\n{order}\n{text.aligned(header, cells)}\n\n{matrix}"


def tree_text(tree: ScrewTree, format: str, degrees: bool, digits: int | None) -> str:
    """All tips, one after the other; JSON as one document."""
    choice("export: format", format, FORMATS)
    if format in ("json", "yaml"):
        data = {
            tip: text.rounded(_data(tree[tip], tree[tip].screws * _scale(tree[tip], degrees), degrees), digits)
            for tip in tree
        }
        return json_text(data) if format == "json" else text.yaml(data)
    if format in ("python", "matlab"):
        raise ArgumentError(f"export: {format} code holds one chain; choose a tip (tree[tip].export({format!r}))")
    name = {"csv": csv_cell, "markdown": markdown, "latex": tex, "table": line}[format]
    return "\n\n".join(f"{name(tip)}\n{screws_text(tree[tip], format, degrees, digits)}" for tip in tree)


def _scale(poe: Screws, degrees: bool) -> np.ndarray:
    """pi / 180 for the screws of angles, when their coordinates are in degrees."""
    turns = np.abs(poe.screws[:, :3]).max(axis=1, keepdims=True, initial=0.0) > 0
    return np.where(turns & degrees, pi / 180, 1.0)


def _data(poe: Screws, S: np.ndarray, degrees: bool) -> dict[str, Any]:
    return {
        "robot": poe.chain.robot.name, "base": poe.chain.base.name, "tip": poe.chain.tip.name, "frame": poe.frame,
        "order": "w v", "angles": "deg" if degrees else "rad", "lengths": "m",
        "home": poe.home.tolist(),
        "screws": [
            {"joint": name, "q": column, "screw": s.tolist()}
            for name, column, s in zip(poe.joint_names, poe.columns, S, strict=True)
        ],
        "residual": poe.residual,
    }  # fmt: skip


def _code(poe: Screws, language: str, degrees: bool, digits: int | None) -> str:
    """M, Slist, Blist, Mlist, Glist as the Modern Robotics packages take them."""
    if degrees:
        raise ArgumentError("export: code is in radians")
    joints = line(", ".join(poe.joint_names))
    matrices = [(name, getattr(poe, name)) for name in ("M", "Slist", "Blist")]
    if language == "matlab":
        parts = [f"% joints: {joints}", *(text.array(name, A, "matlab", digits) for name, A in matrices)]
        if not poe.chain.downward:
            return "\n".join([*parts, ""])
        parts.append(f"Mlist = zeros(4, 4, {len(poe) + 1}); Glist = zeros(6, 6, {len(poe)});")
        for name, stack in (("Mlist", poe.Mlist), ("Glist", poe.Glist)):
            parts += [text.array(f"{name}(:, :, {i})", A, "matlab", digits) for i, A in enumerate(stack, 1)]
        return "\n".join([*parts, ""])
    parts = [f"# joints: {joints}", "import numpy as np", ""]
    parts += [text.array(name, A, "python", digits) for name, A in matrices]
    stacks = (("Mlist", poe.Mlist), ("Glist", poe.Glist)) if poe.chain.downward else ()
    for name, stack in stacks:
        blocks = ["    " + repr([[float(text.number(x, digits)) for x in row] for row in A]) for A in stack]
        parts.append(f"{name} = np.array([\n" + ",\n".join(blocks) + "\n])")
    return "\n".join([*parts, ""])
