"""Rules about joints: angles close to 90 degrees, limits, friction, mimic joints."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isfinite, pi

import numpy as np

from ...io.remarks import MOST_DEGREES, TURNS
from ...model.limits import HUGE
from .description import Hinge, half_digit
from .findings import ERROR, NOTE, WARNING, Effect, Finding
from .rules import Case, Rule, rules

QUARTER = pi / 2
EXACT = 1e-9  # rad; smaller deviations from a quarter turn count as exact: a nanometre in a metre
UNKNOWN = 1e5  # N m: more than any joint takes, so velocity and effort are placeholders
FEWEST = 2  # decimals: 1.6 is not a rounded quarter turn


@rules(Rule("near-right-angle", NOTE, "An angle is a quarter turn printed with few digits: axes are not quite square."))
def almost_square(case: Case) -> Iterator[Finding]:
    for h in case.about.hinges:
        origin = None if h.element is None else h.element.find("origin")
        text = None if origin is None else origin.get("rpy")
        words = [] if text is None else text.split()
        if len(words) != 3:
            continue
        whole = [_quarters(w) for w in words]
        off = max((abs(float(w) - n * QUARTER) for w, n in zip(words, whole, strict=True) if n), default=0.0)
        if off <= EXACT:
            continue
        value = " ".join(repr(n * QUARTER) if n else w for w, n in zip(words, whole, strict=True))
        effect = _swing(case, h, off)
        dh = "" if h.type == "fixed" else "; a DH table gets a row more, or parameters that are almost singular"
        says, edits = f'rpy="{text}" is off a quarter turn by {off:.2g} rad', case.about.edit(origin, "rpy", value)
        why, fix = f"{effect.says}{dh}", f'rpy="{value}"'
        yield case.found("near-right-angle", h, says, why, fix, effect=effect, edits=edits)


def _quarters(word: str) -> int:
    """The number of quarter turns of an angle printed with few digits; 0 if it is not one, or is exact."""
    x, n = float(word), round(float(word) / QUARTER)
    decimals = len(word.lower().partition("e")[0].partition(".")[2])
    if not n or decimals < FEWEST or abs(n) > 4 or abs(x - n * QUARTER) <= EXACT:
        return 0
    # rounded or truncated: 1.57 and 1.571 count, 1.5701 does not
    return n if abs(x - n * QUARTER) <= 2 * half_digit(word) * (1 + 1e-9) else 0


def _swing(case: Case, h: Hinge, angle: float) -> Effect:
    """The displacement of the subtree by a small rotation at a joint."""
    moving = h.joint
    if moving is None:
        link = next((k for k in case.about.robot.links if k.name == h.child), None)
        carried = [] if link is None else [j for j in case.about.robot if _is_below(case, j.name, h.child)]
        if not carried:
            return Effect("fk", 0.0, "m", f"it turns the frame of link {h.child!r} by {angle:.2g} rad")
        moving = carried[0]
    reach, frame = case.effects.reach_below(moving.name)
    if not reach:
        return Effect("fk", 0.0, "m", f"it turns {frame!r} by {angle:.2g} rad")
    return Effect("fk", angle * reach, "m", f"it moves {frame!r} by up to {1e3 * angle * reach:.2g} mm")


def _is_below(case: Case, joint: str, link: str) -> bool:
    """Whether a joint is attached to a link, or to a link fixed to it."""
    waiting = [link]
    while waiting:
        for h in case.about.children.get(waiting.pop(), ()):
            if h.name == joint:
                return True
            if h.type == "fixed":
                waiting.append(h.child)
    return False


@rules(
    Rule("limits-crossed", ERROR, "The lower limit is above the upper one.", "exchange them, or correct a sign"),
    Rule(
        "limits-empty", NOTE, "Both limits are the same: the joint cannot move.",
        "give its range, or make the joint fixed",
    ),
    Rule(
        "limits-huge", NOTE, "A limit is a placeholder: farther than any joint goes.",
        "give the true range, or make it continuous",
    ),
    Rule("degrees", ERROR, "Angles are in degrees, radians are expected.", "convert the limits to radians"),
    Rule("no-effort", NOTE, "The effort or velocity limit is 0: controllers will not move the joint."),
    Rule("negative-limit", ERROR, "An effort or velocity limit is negative."),
)  # fmt: skip
def limits(case: Case) -> Iterator[Finding]:
    for h in case.about.hinges:
        if h.type in ("fixed", "floating", "planar"):
            continue
        slides = h.type == "prismatic"
        unit, force = ("m", "N") if slides else ("rad", "N m")
        low, high = h.lower, h.upper
        idle = "samplers, planners and IK"
        if low > high:
            why = f"no q is allowed: {idle} have an empty range of {high - low:.3g} {unit}"
            yield case.found("limits-crossed", h, f"lower {low:g} above upper {high:g} {unit}", why)
        elif low == high and isfinite(low):
            why = f"q has a range of 0 {unit}: {idle} keep it there"
            yield case.found("limits-empty", h, f"both limits are {low:g} {unit}", why)
        largest = max((abs(x) for x in (low, high) if isfinite(x)), default=0.0)
        tenths = all(float(x) % 5 == 0 for x in (low, high) if isfinite(x))
        span = f"limits {low:g} to {high:g}"
        if h.type == "revolute" and TURNS < largest <= MOST_DEGREES and largest % 100 and tenths:
            why = f"read as radians the joint turns {largest / 2 / pi:.3g} times; {largest:g} degrees are "
            yield case.found("degrees", h, span, f"{why}{np.radians(largest):.3g} rad")
        elif isfinite(largest) and largest > HUGE["length" if slides else "angle"]:
            far = f"{largest:.3g} {unit}"
            why = f"{far} is no stop: sampling and IK count it as none, and planners that do not draw states {far} away"
            yield case.found("limits-huge", h, f"{span} {unit}", why)
        for what, value, of in (("effort", h.effort, force), ("velocity", h.velocity, f"{unit}/s")):
            if value < 0:
                why = f"Pinocchio refuses the file; others allow no {what}, or any"
                yield case.found("negative-limit", h, f"{what} limit {value:g} {of}", why, f"write {-value:g}")
            elif value == 0 and low < high:
                why = f"a controller that respects it gives at most 0 {of}; 0 is also what exporters write for unknown"
                yield case.found("no-effort", h, f"{what} limit 0 {of}", why, f"give the true {what} limit")


@rules(
    Rule("negative-friction", ERROR, "Damping or friction is negative: the joint gains energy."),
    Rule(
        "damping-above-effort", WARNING, "Damping at the velocity limit takes more than the effort limit gives.",
        "one of damping, effort and velocity is wrong, or a placeholder",
    ),
)  # fmt: skip
def friction(case: Case) -> Iterator[Finding]:
    for h in case.about.hinges:
        if h.type == "fixed":
            continue
        force, speed = ("N", "m/s") if h.type == "prismatic" else ("N m", "rad/s")
        for what, value in (("damping", h.damping), ("friction", h.friction)):
            if value < 0:
                why = f"at 1 {speed} it adds {-value:g} W: simulations gain energy"
                yield case.found("negative-friction", h, f"{what} {value:g}", why, f"write {-value:g}")
        lost = h.damping * h.velocity if h.damping > 0 and 0 < h.velocity < inf else 0.0
        if 0 < h.effort < lost < UNKNOWN:
            effect = Effect("rnea", lost, force, f"damping takes {lost:.3g} {force} at {h.velocity:g} {speed}")
            says, reached = f"damping {h.damping:g}, effort {h.effort:g} {force}", h.effort / h.damping
            why = f"{effect.says}, the motor gives {h.effort:g}: it reaches {reached:.3g} {speed}"
            yield case.found("damping-above-effort", h, says, why, effect=effect)


@rules(
    Rule("mimic-undefined", ERROR, "A joint follows one that does not exist.", "name the joint that leads"),
    Rule(
        "mimic-fixed", ERROR, "A joint follows one that does not move, or itself.",
        "make it fixed, or name the joint that leads",
    ),
    Rule("mimic-chain", NOTE, "A joint follows one that follows another."),
    Rule(
        "mimic-limits", WARNING, "A follower's limits and its leader's do not fit.",
        "make multiplier, offset and both limits fit",
    ),
)  # fmt: skip
def mimics(case: Case) -> Iterator[Finding]:
    hinges = {h.name: h for h in case.about.hinges}
    for h in case.about.hinges:
        if h.mimic is None or h.type == "fixed":
            continue
        leader = hinges.get(h.mimic)
        says = f"follows {h.mimic!r}"
        if leader is None:
            yield case.found("mimic-undefined", h, says, "readers refuse it, or leave the joint free: nv is 1 more")
        elif leader.type == "fixed" or _leads_back(hinges, h):
            yield case.found("mimic-fixed", h, says, "its coordinate is a constant or undefined: nv is 1 less or more")
        elif leader.mimic is not None:
            product = h.multiplier * leader.multiplier
            why = f"Pinocchio refuses it, others follow one step only and miss the factor {product:g}"
            fix = f'follow {leader.mimic!r} with multiplier="{product:g}"'
            yield case.found("mimic-chain", h, f"{says}, which follows {leader.mimic!r}", why, fix)
        elif all(map(isfinite, (h.lower, h.upper, leader.lower, leader.upper))) and h.lower < h.upper:
            low, high = sorted(h.multiplier * x + h.offset for x in (leader.lower, leader.upper))
            over = max(h.lower - low, high - h.upper)
            if over > 0.01 * (high - low) and low < high:
                unit = "m" if h.type == "prismatic" else "rad"
                says = f"led from {low:.4g} to {high:.4g}, its limits are {h.lower:.4g} and {h.upper:.4g} {unit}"
                why = f"the leader stops {over:.3g} {unit} early, or the follower passes its limit"
                yield case.found("mimic-limits", h, says, why)


def _leads_back(hinges: dict[str, Hinge], h: Hinge) -> bool:
    """Whether its chain of leaders returns to it."""
    seen, at = {h.name}, h
    while at.mimic in hinges:
        assert at.mimic is not None
        if at.mimic in seen:
            return True
        seen.add(at.mimic)
        at = hinges[at.mimic]
    return False
