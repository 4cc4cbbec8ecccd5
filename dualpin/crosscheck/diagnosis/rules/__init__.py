"""The rules, by what they are about.  Importing this package registers them all in `RULES`."""

from . import answers, formulas, joints, links, merging, writing  # noqa: F401
