"""Optional packages, imported at first use."""

from __future__ import annotations

import importlib
from typing import Any

from .errors import DualpinError


def extra(module: str, name: str, what: str) -> Any:
    """The module, or an error that names the extra of dualpin to install.

    Parameters
    ----------
    module : str
        What to import.
    name : str
        The extra of ``pip install 'dualpin[name]'``.
    what : str
        The feature that needs it, the beginning of the message.
    """
    try:
        return importlib.import_module(module)
    except ImportError as e:
        if e.name is not None and e.name.partition(".")[0] != module.partition(".")[0]:
            raise  # another module is missing: its own error is raised
        package = module.partition(".")[0]
        raise DualpinError(f"{what} needs {package}, which is not installed: pip install 'dualpin[{name}]'") from None
