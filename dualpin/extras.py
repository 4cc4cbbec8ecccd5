"""Packages that are imported when something first needs them."""

from __future__ import annotations

import importlib
from typing import Any

from .errors import DualpinError


def extra(module: str, name: str, what: str) -> Any:
    """The module, or an error that says which extra of dualpin brings it.

    Parameters
    ----------
    module : str
        What to import.
    name : str
        The extra of ``pip install 'dualpin[name]'``.
    what : str
        What needs it, the beginning of the message.
    """
    try:
        return importlib.import_module(module)
    except ImportError as e:
        if e.name is not None and e.name.partition(".")[0] != module.partition(".")[0]:
            raise  # something else is missing, and says so itself
        package = module.partition(".")[0]
        raise DualpinError(f"{what} needs {package}, which is not installed: pip install 'dualpin[{name}]'") from None
