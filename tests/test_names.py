"""Names of strangers: in no export do they become code, markup, formulas or commands of a terminal."""

from __future__ import annotations

import ast
import csv
import html.parser
import io
import json
import re
import shutil
import subprocess
import sys
import tokenize
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import dualpin as dp
from dualpin import escape
from dualpin.crosscheck.subjects import asking, starter
from dualpin.model import Builder, revolute
from dualpin.spatial import UY, Pose, Vector3
from tests.program import run

NASTY = [
    "*/ int evil = 1; /*", "a\nimport os; os.system('x') #", "a\r\nevil = 1",
    "'); evil(); ('", '"; evil(); "', "\\", "a\\",
    "%d %s %", "??/", "/* x", "{ } $x$ ^ ~ & # _", r"\input{/etc/passwd}", "=cmd|' /C calc'!A0", "+1+1", "-2+3",
    "@SUM(1)",
    "\t=1", "</script><script>alert(1)</script>", "<img src=x onerror=alert(1)>", "[click](javascript:x)", "![x](y)",
    "`x`", "**x**", "|", "a|b", "\x1b[31mred\x1b[0m", "\x9b31m", "\x07", "[bold red]x[/]", "[/]", ":smile:",
    "m\u00e3o \u624b",
    "\U0001f916", "\u2028x = 1", "\u202etxt", "yes", "null", "- x", "? x", "!!python/object:os.system", "key: value",
    "#x", "double", "int", "7axis", "sin", "", " ", "\x00", "\ud800", "a:\n  - b", "it's", "...", "%{",
    "\x85evil = 1",
    "\x0cevil = 1", "printf", "main", "a__b", "_A", "\u200f", "//", "${x}", "$(x)", "a/b", "../../x", "x,y", "x;y",
]  # fmt: skip
# Hypothesis also draws words of the sources: those that `named` gives to other frames are left out
ANY = st.one_of(st.sampled_from(NASTY), st.text(max_size=20)).filter(lambda name: name not in ("end", "universe"))
slow = settings(deadline=None, suppress_health_check=list(HealthCheck), max_examples=60)


def named(robot: str, joint: str, link: str) -> dp.Robot:
    b = Builder(robot)
    b.joint(joint, revolute(UY), link=link)
    b.frame("end", on=joint, placement=Pose(position=Vector3(1.0, 0.0, 0.0)))
    return b.robot()


def table(robot: str, joint: str) -> dp.forms.table.DHTable:
    return dp.to_dh(named(robot, joint, "link"), tip="end")


def flat_controls(text: str) -> list[str]:
    return re.findall("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]", text)


@slow
@given(ANY, ANY)
def test_python_code_holds_names_as_strings_and_comments_only(robot, joint):
    for text in (
        table(robot, joint).export("python"),
        dp.to_screws(named(robot, joint, "l"), tip="end").export("python"),
    ):
        tree = ast.parse(text)
        kinds = {type(node) for node in tree.body}
        assert kinds <= {ast.Import, ast.ImportFrom, ast.Assign}
        modules = {a.name for n in tree.body if isinstance(n, ast.Import) for a in n.names}
        assert modules <= {"numpy"}
        defined = {t.id for n in tree.body if isinstance(n, ast.Assign) for t in n.targets}
        assert defined <= {"base", "tool", "robot", "M", "Slist", "Blist", "Mlist", "Glist"}
        strings = [
            k.value.value for n in ast.walk(tree) if isinstance(n, ast.Call) for k in n.keywords if k.arg == "name"
        ]
        assert strings in ([], [robot])
        comments = [
            t.string for t in tokenize.generate_tokens(io.StringIO(text).readline) if t.type == tokenize.COMMENT
        ]
        assert any(escape.line(joint) in c for c in comments)


@slow
@given(ANY, ANY)
def test_matlab_code_holds_names_as_strings_and_comments_only(robot, joint):
    text = table(robot, joint).export("matlab")
    assert len(text.split("\n")) == len(table("r", "j").export("matlab").split("\n"))
    assert flat_controls(text) == []
    for line in text.split("\n"):
        code = re.sub(r"'(?:[^']|'')*'", "''", line).split("%")[0]  # without strings, then without comments
        assert re.fullmatch(r"[\w\s\[\](),.;:=*/+\-']*", code), line


@slow
@given(ANY, ANY)
def test_tables_for_people_keep_their_lines(robot, joint):
    for format in ("table", "markdown", "latex"):
        text, plain = table(robot, joint).export(format), table("r", "j").export(format)
        assert len(text.splitlines()) == len(plain.splitlines())
        assert flat_controls(text) == []


@slow
@given(ANY)
def test_latex_prints_names(joint):
    shown = escape.tex(joint)
    assert f" & {shown} & " in table("r", joint).export("latex")
    bare = re.sub(r"\\text(backslash|asciicircum|asciitilde|less|greater|quotedbl)\{\}|\\[_&%$#{}]", "", shown)
    assert not set(bare) & set("\\_&%$#{}^~"), bare


@slow
@given(ANY)
def test_csv_has_no_formulas_and_keeps_its_columns(joint):
    rows = list(csv.reader(io.StringIO(table("r", joint).export("csv"), newline="")))
    assert {len(row) for row in rows} == {8}
    number = re.compile(r"[+-]?([\d_]+\.?\d*|\.\d+|inf|nan|infinity)([eE][+-]?\d+)?\s*", re.IGNORECASE)
    for cell in (cell for row in rows for cell in row):
        assert not re.match(r"[=@\t\r+\-]", cell) or number.fullmatch(cell)


@slow
@given(ANY, ANY, ANY)
def test_json_and_yaml_give_the_names_back(robot, joint, link):
    import yaml

    whole = table(robot, joint)
    data = json.loads(whole.export("json"))
    assert (data["robot"], data["rows"][0]["joint"]) == (robot, joint)
    if not re.search("[\ud800-\udfff\ufffe\uffff]", robot + joint + link):  # YAML has no form for these
        data = yaml.safe_load(whole.export("yaml"))
        assert (data["robot"], data["rows"][0]["joint"]) == (robot, joint)
        tree = dp.to_dh(named(robot, joint, link or "l"), convention="khalil-kleinfinger")
        assert list(yaml.safe_load(tree.export("yaml"))["tips"]) == list(tree.tips)


@slow
@given(ANY)
def test_markdown_shows_names_without_markup(joint):
    shown = escape.markdown(joint)
    assert "<" not in shown and "\n" not in shown
    assert not re.search(r"(?<!\\)(?:\\\\)*[|`*\[\]!]", shown)


class Elements(html.parser.HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.seen: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.seen += [tag, *(f"{tag}@{k}" for k, _ in attrs)]


@slow
@given(ANY, ANY)
def test_notebooks_show_names_without_markup(robot, joint):
    found = []
    for text in (named(robot, joint, "l")._repr_html_(), named("r", "j", "l")._repr_html_()):
        parser = Elements()
        parser.feed(text)
        found.append(parser.seen)
    assert found[0] == found[1]


@slow
@given(ANY, ANY, ANY)
def test_summaries_have_no_controls(robot, joint, link):
    text = named(robot, joint, link or "l").summary()
    assert flat_controls(text) == []
    assert len(text.splitlines()) == len(named("r", "j", "l").summary().splitlines())


@slow
@given(ANY, ANY, ANY)
def test_urdf_gives_the_names_back_or_refuses(robot, joint, link):
    link, joint, robot = link or "l", joint or "j", robot or "r"
    if re.search("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]", robot + joint + link):
        with pytest.raises(dp.DualpinError, match="is no name for a URDF element"):
            named(robot, joint, link).to_urdf()
        return
    if joint in ("end", "universe", "root_joint") or link == "end":
        return
    text = named(robot, joint, link).to_urdf()
    if "${" in robot + joint + link or "$(" in robot + joint + link:
        with pytest.raises(dp.UrdfError, match="xacro expression"):
            dp.loads(text)
        return
    again = dp.loads(text)
    assert (again.name, again.joint_names) == (robot, [joint]) and link in again.link_names


# --- C ---------------------------------------------------------------------------------------------


@slow
@given(ANY)
def test_names_of_functions_are_names_of_c(name):
    assert escape.is_c_identifier(escape.c_identifier(name))
    code = dp.export_c(named(name, "j", "l"), "gravity")
    assert escape.is_c_identifier(code.name)
    comment = re.match(r"/\*(.*)\*/\n#include", code.source)
    assert comment and "*/" not in comment.group(1) and "/*" not in comment.group(1)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no C compiler")
def test_c_of_nasty_names_compiles_without_a_warning(tmp_path):
    """One file for all: every export, with its comments and its name, behind the others."""
    units, declared = [], set()
    for i, name in enumerate(NASTY):
        b = Builder(name)
        b.joint(name, revolute(UY))
        code = dp.export_c(b.robot(), "frame_pose", frame=name, name=None)
        if code.name not in declared:
            declared.add(code.name)
            code.write(tmp_path)
            units.append(tmp_path / f"{code.name}.c")
        assert i < 100
    done = subprocess.run(
        ["gcc", "-std=gnu99", "-Wall", "-Wextra", "-Werror", "-Wcomment", "-Wtrigraphs", "-O0", "-fsyntax-only",
         f"-I{tmp_path}", *units], capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no C compiler")
def test_every_short_word_that_is_taken_for_a_name_compiles(tmp_path):
    words = {w for w in [*NASTY, "isnan", "NAN", "linux", "memcpy", "index", "y1", "_x", "q", "result", "ur5", "cabs"]
             if escape.is_c_identifier(w)}  # fmt: skip
    for word in sorted(words):
        dp.export_c(named("r", "j", "l"), "gravity", tmp_path, name=word)
    units = sorted(tmp_path.glob("*.c"))
    done = subprocess.run(
        ["gcc", "-Wall", "-Werror", "-fsyntax-only", *units], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0 and units, done.stderr


@pytest.mark.parametrize(
    "name",
    ["double", "int", "7a", "m\u00e3o", "a b", "", "sin", "cosf", "NAN", "isnan", "__x", "_X", "printf", "class", None],
)
def test_words_of_c_are_no_names(name):
    if name is None:
        assert dp.export_c(named("double", "j", "l"), "gravity").name == "double_gravity"
        return
    with pytest.raises(dp.ArgumentError, match=r"is no C identifier; '\w+' would be one"):
        dp.export_c(named("r", "j", "l"), "gravity", name=name)


# names that look like the places of a starter, and what would be code if they were filled in
PLACES = ["@V@", "@FRAMES@", "@Q@", "};int evil=1;char*x[]={", "a??/", '"]; evil(); [', "a\nb", "\\"]


@pytest.mark.parametrize("language", ["c", "cpp", "python", "matlab", "julia"])
def test_programs_to_fill_in_hold_names_as_strings_only(language):
    def program(names):
        b = Builder("@FRAMES@")
        for k, name in enumerate(names):
            b.joint(name, revolute(UY), names[k - 1] if k else None, link=f"{name}-{name}")
        given = replace(asking("ur5", 2, 0, ("fk",)), robot=b.robot(), name="@FRAMES@")
        return starter.starter(given, language)

    quote = "'" if language == "matlab" else '"'
    string = {
        "matlab": r"'(?:[^'\n]|'')*'",
        "python": r"""'(?:[^'\\\n]|\\.)*'|"(?:[^"\\\n]|\\.)*\"""",
    }.get(language, r'"(?:[^"\\\n]|\\.)*"')
    text = program(PLACES)
    bare, plain = (re.sub(string, quote, x) for x in (text, program([f"j{k}" for k in range(len(PLACES))])))
    assert bare == plain
    assert "??/" not in text or language not in ("c", "cpp")
    if language == "python":
        values = {n.targets[0].id: n.value for n in ast.parse(text).body if isinstance(n, ast.Assign)}
        assert ast.literal_eval(values["Q"]) == PLACES


# --- the program -----------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["info", "dh", "screws", "validate"])
def test_the_terminal_gets_no_commands(command, tmp_path):
    """Control characters of names and of paths, and the markup of the library that prints tables."""
    path = tmp_path / "[bold red]a\x1b[31m.urdf"
    body = np.diag([0.1, 0.1, 0.1]).tolist()
    arm = dp.from_dh([(0, 0, 0.5, 0)], name="[/]\x9b31m :smile:", inertias=[{"mass": 1.0, "inertia": body}])
    arm.to_urdf(path)
    more = ["--samples", "2", "--terms", "rnea"] if command == "validate" else []
    done = run(command, path, *more, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    shown = done.stdout + done.stderr
    assert flat_controls(shown) == []
    assert ("[/]" in shown and ":smile:" in shown) or command == "validate"


def test_errors_have_no_controls(tmp_path):
    for name in ("a\x1b[31m", "a\x1b]0;x\x07.urdf", "\udcff"):
        done = subprocess.run([sys.executable, "-m", "dualpin", "info", name], capture_output=True, timeout=120)
        assert done.returncode == 2 and b"\x1b" not in done.stderr and b"Traceback" not in done.stderr
