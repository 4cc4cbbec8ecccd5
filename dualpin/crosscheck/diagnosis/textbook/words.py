"""What a slip is called: a sentence about the step where it was made, and what to change there."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple


class Kind(NamedTuple):
    """A kind of slip: its words about one step, its fix, and its line in the table of keys.

    Of the words in braces, `{site}` and `{what}` end a phrase, after `{Site}` and `{What}` it goes on; `{is}` and
    `{it_is}` agree with the site, `{What_is}` and `{What_has}` are what goes wrong there, and its verb.
    """

    says: str
    fix: str
    row: str


KINDS = {
    "step_left_out": Kind(
        "{What_is} left out of {site}", "add {What} to {site}", "a term of an equation is left out"
    ),
    "step_sign": Kind(
        "{What_has} the other sign in {site}", "change the sign of {What} in {site}",
        "a term of an equation has another sign",
    ),
    "step_half": Kind(
        "{What_is} counted half in {site}", "count {What} once, not half, in {site}",
        "a term of an equation is counted half",
    ),
    "step_twice": Kind(
        "{What_is} counted twice in {site}", "count {What} once, not twice, in {site}",
        "a term of an equation is counted twice",
    ),
    "step_swapped": Kind(
        "the factors of the cross product change places in {site}",
        "exchange the two factors of the cross product in {site}", "the factors of a cross product change places",
    ),
    "step_unturned": Kind(
        "{Site} {is} not transformed into the axes in which {it_is} used",
        "transform {Site} into the axes of what {it_is} added to or multiplied by",
        "a quantity is not transformed into the axes in which it is used",
    ),
    "step_turned_back": Kind(
        "{Site} {is} transformed by the transposed matrix",
        "transpose the matrix by which {Site} {is} transformed",
        "a quantity is transformed into other axes by the transposed matrix",
    ),
    "step_other_turn": Kind(
        "{Site} {is} transformed {what}", "transform {Site} by the matrix of this step, not {what}",
        "a quantity is transformed by another matrix",
    ),
    "step_from_left": Kind(
        "{Site} {is} turned from the left alone (R I in place of R I R^T)", "multiply by R^T from the right too",
        "a matrix is turned from the left alone",
    ),
    "step_from_right": Kind(
        "{Site} {is} turned from the right alone (I R^T in place of R I R^T)", "multiply by R from the left too",
        "a matrix is turned from the right alone",
    ),
    "step_untransposed": Kind("{Site} {is} not transposed", "transpose {site}", "a matrix is not transposed"),
    "step_other": Kind(
        "{Site} {is} {what}", "correct {site}: here {it_is} {what}",
        "another quantity stands in a place of an equation",
    ),
    "step_mistaken": Kind(
        "{What_is} taken for {site}", "take {site}, not {what}", "a quantity is mistaken for one of another kind"
    ),
    "step_first": Kind(
        "the loop over {site} leaves out the first", "begin the loop over {site} with the first",
        "the first turn of a loop is left out",
    ),
    "step_last": Kind(
        "the loop over {site} leaves out the last", "end the loop over {site} with the last",
        "the last turn of a loop is left out",
    ),
    "step_last_alone": Kind(
        "the loop over {site} keeps only the last", "add up all in the loop over {site}, do not replace what is there",
        "a sum is overwritten, not added up",
    ),
    "step_first_alone": Kind(
        "the loop over {site} ends after the first", "go through all in the loop over {site}",
        "a sum ends after its first term",
    ),
    "step_overwritten": Kind(
        "{Site} {is} overwritten where a link has several children: {what}",
        "add {Site} to what is there, do not replace it", "what one child hands on replaces what others do",
    ),
}  # fmt: skip

NEW = "a new one, or a copy of the parent's before anything is added: w = w_p + z qd, not w = w_p; w += z qd"
RIGHT = {
    "the angular velocity that carries a link's origin": "that of the parent, on which the origin is fixed",
    "the angular acceleration that carries a link's origin": "that of the parent, on which the origin is fixed",
    "the angular velocity that carries a centre of mass": "that of the link itself",
    "the angular acceleration that carries a centre of mass": "that of the link itself",
    "the angular velocity in w x I w": "that of the link itself",
    "the angular velocity in 2 w x z qd": "that of the link, in the axes of z",
    "the arm to a link's origin": "the vector from the parent's origin to the link's, in the axes of w",
    "the arm to a sliding link": "the vector from the parent's origin to the link where it has slid to",
    "the arm in r x f": "the vector from the link's origin to its child's, in the axes of f",
    "the arm of a body's own force": "the vector from the link's origin to its centre of mass",
    "the arm that carries a centre of mass": "the vector from the link's origin to its centre of mass",
    "the angular acceleration in I alpha": "that of the link itself",
    "the acceleration in m a": "that of the centre of mass",
    "the motion that a link starts from": "that of its parent",
    "the link that a link hands its force on to": "its parent",
    "the link that a link hands its inertia on to": "its parent",
    "the link that a link hands its inertia and bias force on to": "its parent",
    "the array of a link's velocity": NEW, "the array of a link's acceleration": NEW,
    "the array of a link's angular velocity": NEW, "the array of a link's linear velocity": NEW,
    "the array of a link's angular acceleration": NEW, "the array of a link's linear acceleration": NEW,
    "the array of a link's v x S qd": "one of its own in the list, set anew for every link and every call",
    "the force in r x f": "the child's",
    "w x (w x r)": "made of w and r, with the cross product twice",
    "the velocity in Christoffel's sum": "v_k, of the index that is summed over",
    "the velocity in v x* I v": "that of the link itself",
    "the acceleration in I a": "that of the link itself",
    "the point at which weight acts": "the centre of mass",
    "the inertia about the centre of mass": "the tensor of <inertial>, before m (c.c 1 - c c^T) is added",
    "the inertia in w x I w": "R I R^T about the centre of mass, as in I alpha",
    "the tensor of <inertial>": "the whole symmetric matrix of ixx, ixy, ixz, iyy, iyz, izz",
    "the tensor of a body": "that about its centre of mass",
    "the axis along which a joint feels force or moment": "the joint's own, in the axes of force and moment",
    "what a turning joint feels": "the moment along its axis",
    "what a sliding joint feels": "the force along its axis",
    "what a link hands on": "its force and its moment, to its parent",
    "gravity at the first link that moves": "turned into the link's axes by all of its orientation",
    "gravity as a six-vector": "in the linear rows alone, [0; g]",
    "S of a turning joint": "[z; p x z], p a point of its axis in these coordinates ([z; 0] in the link's own)",
    "S of a sliding joint": "[0; z]",
    "the block -E [r x] of X": "-E [r x], with E = R^T",
    "E of X": "R^T, which turns vectors of the parent's axes into the link's",
    "the orientation of a link": "that of its parent times its own on the parent, in this order",
    "the position of a link": "p_p + R_p r, of the parent's pose and its place r there",
    "Ad(T)": "[R 0; [p x] R  R]",
    "the block [p x] R of Ad": "[p x] R, in the lower left",
    "the matrix of v x": "[w x  0; u x  w x], of v = [w; u]",
    "R^T of the inverse of a pose": "R^T",
    "-R^T p of the inverse of a pose": "-R^T p",
    "the screw of a turning joint": "[w; -w x p], p a point of its axis at home, in the base's frame",
    "the screw of a sliding joint": "[0; w]",
    "the factor of [w] in G of an exponential": "1 - cos q",
    "the factor of [w]^2 in G of an exponential": "q - sin q",
    "the pose, the product of exponentials times the pose at home": "exp(S_1 q_1) ... exp(S_n q_n) M, in this order",
    "the pose of the parent's frame in that of the body, at home,": "M^-1 M_p",
    "the pose of the parent's frame in that of the body, exp(-A q) M^-1 M_p,": "made of both, in this order",
    "-q in exp(-A q) of the recursion": "-q, since it leads from the parent's frame into the body's",
    "-q in exp(-B q) of the body Jacobian": "-q",
    "the composite inertia in F = I S": "that of the link and all that it carries",
    "S in an entry of H, S_j^T F,": "that of the joint in whose axes F is, S_j",
    "an entry of H beyond the parent": "filled for every joint down to the base",
    "the lever arm of a column": "the vector from the joint's origin to the point",
    "the column of a turning axis": "[z; z x r]",
    "the column of a sliding axis": "[0; z]",
    "the axes that have a column": "those of the joints between the root and the frame's link",
    "the joint whose axis is in a column": "the joint that the column belongs to",
    "the angular velocity that turns an axis": "that of the link that the joint moves",
    "the weight of a body's centre": "its mass",
    "the weight of a body's Jacobian": "its mass",
    "the divisor of the sum over bodies": "the mass of all bodies that joints move",
    "the mass in the potential energy": "that of the body",
    "the mass in gravity's torques": "that of the body",
    "the mass of a body": "that of the body itself",
    "the place of a body, whose height counts,": "its centre of mass",
    "the order of joints along a path": "that from the root to the frame",
    "the orientation of an origin": "the parent's orientation times R(rpy), in this order",
    "the rotation of a link": "R(rpy) of the origin times the joint's turn, in this order",
    "the factor of K in Rodrigues' formula": "sin q",
    "the factor of K^2 in Rodrigues' formula": "1 - cos q",
    "the centre of merged links": "sum m c / sum m",
    "the mass of merged links": "sum m",
    "the mass in Steiner's term": "that of the link",
}  # fmt: skip
"""What belongs in a place where other quantities are put."""

_ENDS = re.compile(r",| (?:of|that|in|from|by|with|at|whose|beyond|to|on|as|along|about|over|which)\b")
_SINGULAR = ("mass", "axis", "bias", "radius")


@cache
def says(site: str, what: str, how: str) -> str:
    """The sentence about a slip."""
    return KINDS[how].says.format_map(_forms(site, what))


@cache  # the same slips stand in many formulations
def fix(site: str, what: str, how: str) -> str:
    """What to change; what belongs there, where that is known."""
    right = RIGHT.get(site.partition(": ")[0])
    forms = _forms(site, what)
    if how == "step_other" and right:
        return f"{forms['Site']} must be {right}"
    return KINDS[how].fix.format_map(forms)


def rows() -> Mapping[str, str]:
    """The lines of all kinds in the table of keys."""
    return {key: kind.row for key, kind in KINDS.items()}


def plural(noun: str) -> bool:
    """Whether a phrase such as "the links that hand on their force" is plural: its noun stands before `_ENDS`."""
    noun = _ENDS.split(noun, maxsplit=1)[0]
    article, _, rest = noun.partition(" ")
    if article not in ("the", "its", "their", "all"):
        return False
    last = rest.rpartition(" ")[2]
    many = last == "children" or (last.endswith("s") and not last.endswith(("'s", "ss")) and last not in _SINGULAR)
    return many or " and " in rest


def _forms(site: str, what: str) -> dict[str, str]:
    site = ", ".join(part.rstrip(",") for part in site.split(": "))
    what = what.rstrip(",")
    many, several = plural(site), plural(what)
    return {
        "site": site, "Site": _subject(site), "is": "are" if many else "is",
        "it_is": "they are" if many else "it is", "what": what, "What": _subject(what),
        "What_is": f"{_subject(what)} {'are' if several else 'is'}",
        "What_has": f"{_subject(what)} {'have' if several else 'has'}",
    }  # fmt: skip


def _subject(phrase: str) -> str:
    """As it stands before its verb: an apposition ends with a comma."""
    return phrase + "," * (", " in phrase)
