"""The table of keys: what each says, and what to do about it."""

from __future__ import annotations

from .fits import FITTED
from .repair import FIX, SAYS
from .rules import RULES

OTHERS = {
    "history": (
        "the same state asked twice gives other numbers", "compute everything from the arguments of the call"
    ),
    "partly": (
        "what is named explains part of the difference, nearly all, or all of it and contradicts terms that are right",
        "repair it, and judge again",
    ),
    "refusal": (SAYS, FIX),
}  # fmt: skip


def keys() -> dict[str, tuple[str, str]]:
    """Every key that a finding can have: what it says, and the fix.

    Examples
    --------
    >>> from dualpin.crosscheck.diagnosis.keys import keys
    >>> keys()["rows"][0]
    'six-vectors have their other part first'
    """
    found = dict(OTHERS)
    for rule in RULES:
        for key, says in (rule.rows or {rule.key: rule.says}).items():
            found.setdefault(key, (says, rule.fix))
    return dict(sorted({**found, **FITTED}.items()))


def table() -> str:
    """The keys as Markdown."""
    rows = [f"| `{key}` | {says} | {fix} |" for key, (says, fix) in keys().items()]
    plain = "\n".join(["| key | what is the case | what to do |", "|---|---|---|", *rows]) + "\n"
    return plain.replace("<", "&lt;")


if __name__ == "__main__":
    print(table(), end="")
