"""Every public function says what goes in, what comes out, what is refused, where it comes from, and shows it."""

from __future__ import annotations

import functools
import importlib
import inspect
import pkgutil
import re
import types

import pytest

import dualpin as dp

SECTIONS = ("Parameters", "Returns", "Raises", "References", "Examples")
# no equation and no paper stands behind them: files, results, settings, what another function returns
TOOLS = {
    "load", "loads", "find", "catalogue", "export_c", "symbolic", "validate", "judge", "page", "read", "study",
    "compare", "document", "view", "get_num_threads", "set_num_threads", "clear", "limit", "stats", "method_named",
    "diagonal", "bones", "reach", "identify_payload", "check", "diff", "convert", "robot_page", "fixed", "from_figaroh",
    "to_figaroh", "read_figaroh", "asking", "resolve", "shipped", "write_starter", "fuzz", "examine", "random_spec",
    "shrink", "campaign", "all_cases", "run", "nearest_singularity", "device", "plan", "to_device",
}  # fmt: skip
# formulas over scalars and constructors that have nothing to refuse
HARMLESS = {
    "clear", "stats", "catalogue", "document", "spherical", "skew", "diagonal", "motor", "power", "displaced", "axes",
    "bones", "helix", "away_from_limits", "shipped", "examine", "random_spec", "shrink",
    "dualpin.analysis.check.diff",
}  # fmt: skip


INTERNAL = {"dualpin.call", "dualpin.cli", "dualpin.crosscheck.diagnosis"}  # what other rooms of the package call


def public() -> dict[str, object]:
    found = {f"dualpin.{n}": getattr(dp, n) for n in dp.__all__}
    rooms = {x.name for x in pkgutil.walk_packages(dp.__path__, "dualpin.") if x.ispkg}
    for name in sorted(rooms - INTERNAL | {f"dualpin.{n}" for n in dp._PACKAGES}):
        module = importlib.import_module(name)
        found |= {f"{name}.{n}": getattr(module, n) for n in getattr(module, "__all__", ())}
    kinds = (types.FunctionType, types.MethodType, types.BuiltinFunctionType, functools._lru_cache_wrapper)
    return {name: x for name, x in found.items() if isinstance(x, kinds)}


def sections(text: str) -> dict[str, str]:
    parts = re.split(r"(?m)^(\w[\w ]*)\n-{3,}\n", text)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


FUNCTIONS = public()


def test_there_are_many():
    assert len(FUNCTIONS) > 120 and "dualpin.rnea" in FUNCTIONS and "dualpin.spatial.exp" in FUNCTIONS


@pytest.mark.parametrize("name", FUNCTIONS)
def test_docstrings_are_complete(name):
    function = FUNCTIONS[name]
    text, short = inspect.getdoc(function) or "", name.rpartition(".")[2]
    found, parameters = sections(text), list(inspect.signature(function).parameters)
    wanted = set(SECTIONS)
    wanted -= {"Parameters"} if not parameters else set()
    wanted -= {"References"} if short in TOOLS else set()
    wanted -= {"Raises"} if HARMLESS & {short, name} else set()
    assert wanted <= set(found), f"{name} lacks {sorted(wanted - set(found))}"
    assert ">>>" in found["Examples"], f"{name}: an example that runs"
    lines = re.findall(r"(?m)^(\*{0,2}\w[\w, *]*)(?= :|$)", found.get("Parameters", ""))
    named = {word.strip(" *") for line in lines for word in line.split(",")}
    assert set(parameters) <= named, f"{name} does not say what {sorted(set(parameters) - named)} are"
    assert text.split("\n")[0].strip().endswith((".", ":")), f"{name}: the first line is a sentence"


@pytest.mark.parametrize("name", [n for n in FUNCTIONS if FUNCTIONS[n].__module__.startswith("dualpin.functions")])
def test_functions_of_robots_lead_to_the_conventions(name):
    assert "docs/conventions.md" in sections(inspect.getdoc(FUNCTIONS[name]))["References"]
