"""Generated programs build, run as they are, and answer all terms once their functions are filled in."""

from __future__ import annotations

import math
import re
import shutil
import subprocess

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.subjects import QUESTIONS, Command, asking, exchange, write_starter
from dualpin.crosscheck.subjects.convention import parameter_names
from dualpin.crosscheck.subjects.questions import FRAMED, wanted

BUILT = {
    "c": ("gcc -O1 -Wall -Wextra -Werror answer.c -lm -o answer", "PATH/answer FOLDER"),
    "cpp": ("g++ -std=c++17 -Wall -Wextra -Werror answer.cpp -o answer", "PATH/answer FOLDER"),
    "python": ("", "python3 PATH/answer.py FOLDER"),
    "matlab": ("", "octave-cli --quiet --path PATH --eval \"answer('FOLDER')\""),
    "julia": ("", "julia PATH/answer.jl FOLDER"),
}
"""How a starter of each language is built, and run."""
STUBS = {
    "c": r"static int {term}\((?P<given>.*)\) \{{ .* return 0; \}}",
    "cpp": r"std::optional<(?P<of>.*)> {term}\((?P<given>.*)\) \{{ .* return \{{\}}; \}}",
    "python": r'def {term}\((?P<given>.*)\):\n    """.*"""\n',
    "matlab": r"function (?P<of>\w+) = {term}\((?P<given>.*)\), \w+ = (\[\]|\{{\}}); end",
    "julia": r"(?<=\n){term}\((?P<given>.*)\) = nothing",
}
"""A function as it stands there."""
POSE = (0, 0, 0, 1, 0, 0, 0)


def answers(robot: dp.Robot) -> dict[str, np.ndarray]:
    """0, 1, 2, ... for every term, but a pose."""
    nv, six = robot.nv, (6, robot.nv)
    shapes = dict.fromkeys(QUESTIONS, (nv,)) | dict.fromkeys(("crba", "minv", "coriolis"), (nv, nv))
    shapes |= dict.fromkeys(("jacobian", "jacobian_dot", "centroidal_momentum_matrix"), six) | {"com_jacobian": (3, nv)}
    shapes |= {"com": (3,), "frame_velocity": (6,), "frame_acceleration": (6,), "kinetic_energy": (), "fk": (7,)}
    shapes |= {"potential_energy": (), "joint_torque_regressor": (nv, len(parameter_names(robot)))}
    shapes |= dict.fromkeys(("rnea_derivatives", "aba_derivatives"), (3, nv, nv))
    found = {term: np.arange(math.prod(shape)).reshape(shape) for term, shape in shapes.items()}
    return found | {"fk": np.array(POSE)}


def body(language: str, term: str, x: np.ndarray, given: str, of: str) -> str:
    """A function that returns an array."""
    if language == "c":
        out = "p" if term == "fk" else re.findall(r"(\w+)(?:\[.*)?$", given)[0].split("[")[0]
        out = {"jacobian": "J", "jacobian_dot": "J"}.get(term, out)
        values = f"const double x[] = {{{', '.join(map(str, x.ravel()))}}}; (void)s; "
        values += "(void)frame; " * (term in FRAMED)
        if term == "fk":
            return f"static int fk({given}) {{ {values}memcpy(p, x, 24); memcpy(wxyz, x + 3, 32); return 1; }}"
        return f"static int {term}({given}) {{ {values}memcpy({out}, x, sizeof x); return 1; }}"
    if language == "cpp":
        unused = "(void)s; " + "(void)frame; " * (term in FRAMED)
        text = re.sub(r"[\[\]]", lambda m: {"[": "{", "]": "}"}[m[0]], str(x.tolist()))
        return f"std::optional<{of}> {term}({given}) {{ {unused}return {of}{text if x.ndim else f'({text})'}; }}"
    if language == "python":
        return f"def {term}({given}):\n    return {x.tolist()}\n"
    blocks = ["[" + "; ".join(" ".join(map(str, np.atleast_1d(row))) for row in np.atleast_1d(y)) + "]"
              for y in (x if x.ndim == 3 else [x])]  # fmt: skip
    listed = ", ".join(blocks)
    if language == "matlab":
        return f"function {of} = {term}({given}), {of} = {f'{{{listed}}}' if x.ndim == 3 else listed}; end"
    return f"{term}({given}) = {f'({listed})' if x.ndim == 3 else str(x.tolist()) if x.ndim < 2 else listed}"


@pytest.mark.parametrize("language", BUILT)
def test_starters_run_as_they_are_and_filled_in(tmp_path, language):
    build, line = BUILT[language]
    for tool in (build or line, line):
        name = tool.split()[0]
        if "/" not in name and shutil.which(name) is None:
            pytest.skip(f"no {name}")
    given = asking("ur5", 4, 0, wanted(None))
    exchange.write(given, tmp_path)
    path = write_starter(given, tmp_path, language)
    command = Command(line.replace("PATH", str(tmp_path)))

    def run() -> None:
        if build:
            subprocess.run(build.split(), cwd=tmp_path, check=True)
        subprocess.run(command.words(str(tmp_path)), cwd=tmp_path, check=True)

    run()
    assert list((tmp_path / "answers").iterdir()) == []
    text, right = path.read_text(), answers(given.robot)
    for term, x in right.items():
        stub = STUBS[language].format(term=term)
        (m,) = re.finditer(stub, text)
        text = text.replace(m[0], body(language, term, x, m["given"], m.groupdict().get("of", "")))
    path.write_text(text)
    run()
    read = exchange.read(given, tmp_path).terms
    assert set(read) == set(QUESTIONS)
    for term in set(QUESTIONS) - {"fk"}:
        assert (read[term] == right[term]).all(), term
    assert (read["fk"] == np.eye(4)).all()
    report = dp.judge("ur5", command, 5, terms=["gravity", "rnea"], diagnose=False)
    assert {t: (r.compared, r.status) for t, r in report.terms.items()} == dict.fromkeys(report.terms, (5, "differs"))
