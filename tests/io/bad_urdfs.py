"""A table of URDFs that strangers write: what is wrong with each, and what a reader must say of it.

Every case is a small change of one good file, so the line of the fault is known.
"""

# ruff: noqa: E501 -- a table reads better in lines than in blocks

from __future__ import annotations

from dataclasses import dataclass

GOOD = """<?xml version="1.0"?>
<robot name="two">
  <link name="base">
    <inertial>
      <origin xyz="0 0 0.1" rpy="0 0 0"/>
      <mass value="2.0"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <link name="arm">
    <inertial>
      <mass value="1.0"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
    </inertial>
  </link>
  <link name="hand"><inertial><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial></link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="arm"/>
    <origin xyz="0 0 0.5" rpy="0 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="2"/>
  </joint>
  <joint name="wrist" type="prismatic">
    <parent link="arm"/>
    <child link="hand"/>
    <origin xyz="0.3 0 0"/>
    <axis xyz="1 0 0"/>
    <limit lower="0" upper="0.2" effort="10" velocity="2"/>
  </joint>
</robot>
"""


@dataclass(frozen=True)
class Case:
    """A file, what must be said ("error", "warning" or "accept"), and words that must be in it."""

    name: str
    data: bytes
    verdict: str
    words: tuple[str, ...] = ()
    line: int | None = None


def _line(old: str) -> int:
    return GOOD[: GOOD.index(old)].count("\n") + 1


def _case(verdict: str, name: str, old: str, new: str, *words: str, at: str | None = None) -> Case:
    assert GOOD.count(old) == 1, (name, old)
    line = _line(at or old) if verdict == "error" else None
    return Case(name, GOOD.replace(old, new).encode(), verdict, words, line)


def _error(name: str, old: str, new: str, *words: str, at: str | None = None) -> Case:
    return _case("error", name, old, new, *words, at=at)


def _warning(name: str, old: str, new: str, *words: str) -> Case:
    return _case("warning", name, old, new, *words)


def _accept(name: str, old: str, new: str) -> Case:
    return _case("accept", name, old, new)


AXIS, ORIGIN, MASS = '<axis xyz="0 1 0"/>', '<origin xyz="0 0 0.5" rpy="0 0 0"/>', '<mass value="1.0"/>'
INERTIA = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>'
LIMIT, WRIST_LIMIT = (
    '<limit lower="-1" upper="1" effort="10" velocity="2"/>',
    '<limit lower="0" upper="0.2" effort="10" velocity="2"/>',
)
SHOULDER, WRIST, HAND = (
    '<joint name="shoulder" type="revolute">',
    '<joint name="wrist" type="prismatic">',
    '<link name="hand">',
)
END = "</robot>"


def _joint(name: str, parent: str, child: str, inside: str = "") -> str:
    return f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


NUMBERS = {
    "nan": "nan", "inf": "inf", "minus_inf": "-INF", "overflow": "1e400", "underscore": "1_0", "hexadecimal": "0x10",
    "comma": "0,5", "text": "half", "arabic_digit": "\u0661",
    "full_width_digit": "\uff11", "fortran": "1d0", "lone_sign": "+", "lone_point": ".", "lone_exponent": "1e",
}  # fmt: skip

CASES: list[Case] = [
    Case("good", GOOD.encode(), "accept"),
    # axes
    _error("axis_without_xyz", AXIS, "<axis/>", "joint 'shoulder'", "<axis>", "'xyz'", "3 numbers"),
    _error("axis_zero", AXIS, '<axis xyz="0 0 0"/>', "joint 'shoulder'", "<axis xyz>", "'0 0 0'", "zero"),
    _error("axis_almost_zero", AXIS, '<axis xyz="1e-9 0 0"/>', "joint 'shoulder'", "'1e-9 0 0'"),
    _error("axis_two_numbers", AXIS, '<axis xyz="0 1"/>', "joint 'shoulder'", "3 numbers", "got 2"),
    _warning("axis_not_unit", AXIS, '<axis xyz="0 3 0"/>', "joint 'shoulder'", "length 3", "normalised"),
    # masses and inertias
    _error("no_mass", MASS, "", "link 'arm'", "without <mass>", at="<inertial>\n      <mass value=\"1.0\""),
    _error("mass_without_value", MASS, "<mass/>", "link 'arm'", "<mass>", "'value'", "a number"),
    _error("mass_nan", MASS, '<mass value="NaN"/>', "link 'arm'", "<mass value>", "'NaN'"),
    _error("mass_inf", MASS, '<mass value="inf"/>', "link 'arm'", "'inf'"),
    _error("mass_negative", MASS, '<mass value="-1"/>', "link 'arm'", "-1", "zero or more"),
    _error("mass_two_numbers", MASS, '<mass value="1 2"/>', "link 'arm'", "'1 2'", "got 2"),
    _error("mass_empty", MASS, '<mass value=""/>', "link 'arm'", "got 0"),
    _warning("no_inertia", INERTIA, "", "link 'arm'", "without <inertia>"),
    _warning("inertia_without_entries", INERTIA, "<inertia/>", "link 'arm'", "without <inertia>"),
    _warning("empty_inertial", "<inertial>\n      " + MASS + "\n      " + INERTIA + "\n    </inertial>", "<inertial/>", "link 'arm'", "empty <inertial>"),
    _warning("inertia_product_missing", INERTIA, INERTIA.replace('iyz="0" ', ""), "link 'arm'", "iyz", "Pinocchio"),
    _error("inertia_moment_missing", INERTIA, INERTIA.replace('iyy="0.01" ', ""), "link 'arm'", "'iyy'", "a number"),
    _accept("mass_with_blanks", MASS, '<mass value=" 1.0 "/>'),
    _error("inertia_entry_nan", INERTIA, INERTIA.replace('iyz="0"', 'iyz="nan"'), "link 'arm'", "<inertia iyz>", "'nan'"),
    _warning("inertia_indefinite", INERTIA, INERTIA.replace('ixx="0.01"', 'ixx="-0.01"'), "positive definite", "negative", "arm"),
    _warning("inertia_of_a_rod", INERTIA, INERTIA.replace('ixx="0.01"', 'ixx="0"'), "zero eigenvalues", "arm"),
    _warning("inertia_triangle", INERTIA, INERTIA.replace('ixx="0.01"', 'ixx="0.1"'), "triangle inequality", "arm"),
    _warning("inertia_without_mass", MASS, '<mass value="0"/>', "without mass", "arm"),
    # origins
    _error("xyz_four_numbers", ORIGIN, '<origin xyz="0 0 0.5 1"/>', "joint 'shoulder'", "<origin xyz>", "'0 0 0.5 1'", "got 4"),
    _error("xyz_empty", ORIGIN, '<origin xyz=""/>', "joint 'shoulder'", "got 0"),
    _error("rpy_two_numbers", ORIGIN, '<origin rpy="0 1"/>', "joint 'shoulder'", "<origin rpy>", "got 2"),
    _error("no_break_space", ORIGIN, '<origin xyz="0\u00a00 0 0"/>', "joint 'shoulder'", "<origin xyz>"),
    *(
        _error(f"xyz_{name}", ORIGIN, f'<origin xyz="0 {text} 0"/>', "joint 'shoulder'", "<origin xyz>", text, "finite decimal")
        for name, text in NUMBERS.items()
    ),
    _error("quaternion_of_no_version", ORIGIN, '<origin xyz="0 0 0" quat_xyzw="0 0 0 1"/>', "joint 'shoulder'", "quat_xyzw", "xyz and rpy"),
    _error("quaternion_of_another_name", ORIGIN, '<origin xyz="0 0 0" wxyz="1 0 0 0"/>', "joint 'shoulder'", "'wxyz'", "xyz and rpy"),
    _warning("attribute_of_an_origin", ORIGIN, ORIGIN.replace("/>", ' unit="m"/>'), "joint 'shoulder'", "unit", "ignored"),
    *(
        Case(f"quaternion_{name}", GOOD.replace('"two"', '"two" version="1.1"').replace(ORIGIN, f'<origin xyz="0 0 0.5" {text}/>').encode(),
             verdict, words, _line(ORIGIN) if verdict == "error" else None)
        for name, text, verdict, words in (
            ("of_version_1.1", 'quat_xyzw="0 0 0 1"', "accept", ()),
            ("of_length_2", 'quat_xyzw="0 0 0 2"', "warning", ("joint 'shoulder'", "quat_xyzw", "normalised", "length 2")),
            ("of_length_0", 'quat_xyzw="0 0 0 0"', "error", ("joint 'shoulder'", "quat_xyzw", "zero")),
            ("and_rpy", 'rpy="0 0 0" quat_xyzw="0 0 0 1"', "error", ("joint 'shoulder'", "rpy and quat_xyzw", "one orientation")),
            ("of_three_numbers", 'quat_xyzw="0 0 1"', "error", ("joint 'shoulder'", "quat_xyzw", "4 numbers", "got 3")),
        )
    ),
    _error("origin_of_inertial", '<origin xyz="0 0 0.1" rpy="0 0 0"/>', '<origin xyz="0 0 zero"/>', "link 'base' <inertial>", "'zero'"),
    _accept("xyz_tabs_and_newlines", ORIGIN, '<origin xyz="\t0\n0\r\n0.5 " rpy="&#9;0&#10;0 0"/>'),
    _accept("numbers_as_people_write_them", ORIGIN, '<origin xyz="+0. -.0 5E-1"/>'),
    _warning("two_origins", ORIGIN, ORIGIN + '<origin xyz="9 9 9"/>', "joint 'shoulder'", "2 <origin>", "first"),
    # the root element
    _warning("default_namespace", '<robot name="two">', '<robot name="two" xmlns="http://example.org/x">', "namespace", "http://example.org/x"),
    _accept("default_namespace_of_a_link", HAND, '<link name="hand" xmlns="http://example.org/x">'),
    _error("prefixed_root", '<robot name="two">', '<u:robot name="two" xmlns:u="x">', "namespace").__class__(
        "prefixed_root", GOOD.replace("<robot", "<u:robot xmlns:u='urn:x'").replace("</robot", "</u:robot").encode(), "error", ("<u:robot>", "namespace", "urn:x"), 2
    ),
    _warning("version_of_the_robot", '<robot name="two">', '<robot name="two" version="0.9">', "version", "'0.9'", "1.0"),
    _error("sdf", '<robot name="two">', '<sdf name="two">', "<sdf>", "<robot> expected").__class__(
        "sdf", GOOD.replace("<robot", "<sdf").replace("</robot", "</sdf").encode(), "error", ("<sdf>", "<robot> expected"), 2
    ),
    Case("html", b"<!DOCTYPE html><html/>", "error", ("DOCTYPE",)),
    _warning("robot_without_name", '<robot name="two">', "<robot>", "<robot> without a name", "'robot'"),
    _warning("robot_with_empty_name", '<robot name="two">', '<robot name="">', "<robot> without a name", "'robot'"),
    *(
        _warning(f"xacro_{name}", '<robot name="two">', f'<robot name="two" xmlns:xacro="http://www.ros.org/wiki/xacro">{text}', "xacro:", "not expanded")
        for name, text in (
            ("property", '<xacro:property name="width" value="0.2"/>'), ("argument", '<xacro:arg name="w" default=""/>'),
            ("macro", '<xacro:macro name="m"><link name="x"/></xacro:macro>'),
            ("in_a_dropped_part", '<gazebo><xacro:grey/></gazebo>'),
            ("macro_without_content", '<xacro:macro name="m" params="j"><transmission name="${j}"/></xacro:macro><xacro:m j="shoulder"/>'),
        )
    ),
    *(
        _error(f"xacro_{name}", '<robot name="two">', f'<robot name="two" xmlns:xacro="http://www.ros.org/wiki/xacro">{text}', f"<xacro:{tag}>", "run xacro")
        for name, tag, text in (
            ("call", "leg", "<xacro:leg/>"), ("include", "include", '<xacro:include filename="x"/>'),
            ("macro_with_content", "m", '<xacro:macro name="m"><link name="x"/></xacro:macro><xacro:m/>'),
            ("condition", "if", '<xacro:if value="1"><link name="x"/></xacro:if>'),
        )
    ),
    _error("xacro_in_a_link", HAND, HAND + '<xacro:box mass="1"/>', "<xacro:box>", "<link>", "run xacro"),
    _error("xacro_in_a_name", HAND, '<link name="${side}hand"><inertial/></link>' + HAND, "<link name>", "${side}hand", "run xacro"),
    _error("xacro_argument_in_a_number", ORIGIN, '<origin xyz="$(arg x) 0 0"/>', "joint 'shoulder'", "<origin xyz>", "$(arg x)", "run xacro"),
    Case("xacro_undeclared", GOOD.replace(END, "<xacro:include filename='x'/></robot>").encode(), "error", ("xacro", "run xacro"), 31),
    # files that are no XML, but that everybody's readers read
    *(
        Case(f"markup_{name}", GOOD.replace(old, new).encode(), "warning", words)
        for name, old, new, words in (
            *((f"version_{v}", 'version="1.0"', f'version="{v}"', ("version", repr(v))) for v in ("0.0", "1", "2.0", "", "1.0.0")),
            ("no_version", '<?xml version="1.0"?>', "<?xml?>", ("without a version",)),
            ("capitals", "<?xml", " <?XML", ("blank",)),
            ("blank_line_first", "<?xml", "\n\n<?xml", ("declaration", "blank")),
            ("comment_first", "<?xml", "<!-- mine -->\n<?xml", ("declaration", "line 2")),
            ("two_declarations", "<robot", '<?xml version="1.0"?><robot', ("declaration", "line 2")),
            ("comment_with_dashes", "<robot", "<!-- a -- b --->\n<!----- c ----->\n<robot", ('"--"', "lines 2, 3")),
            ("prefix_undeclared", END, "<drake:x><a drake:y='1'/><sensor:camera/></drake:x>" + END, ("prefix", "'drake'", "'sensor'")),
            ("prefix_undeclared_in_dropped", HAND, HAND + "<visual><drake:declare_convex/></visual>", ("prefix", "'drake'")),
            ("ampersand", END, "<gazebo file='a & b'/>" + END, ("&amp;", "line 31")),
            ("less_in_an_attribute", END, "<gazebo when='a < b'/>" + END, ("&lt;", "line 31")),
            ("no_blank_between", 'name="two"', 'name="two"kind="x"', ("blank between", "line 2")),
            ("element_after_the_end", END, END + "<gazebo/><!-- -- -->", ("after the end", "gazebo")),
            ("zero_bytes_at_the_end", END, END + "\0\0", ("zero bytes",)),
            ("unknown_encoding", '"1.0"?>', '"1.0" encoding="klingon"?>', ("encoding", "'klingon'")),
            ("utf16_that_is_not", '"1.0"?>', '"1.0" encoding="UTF-16"?>', ("encoding", "'UTF-16'")),
            ("capital_tag", END, '<Link name="x"/>' + END, ("no reader knows", "line 31")),
        )
    ),
    _accept("processing_instruction", END, "<?some thing?>" + END),
    _accept("character_data", END, "<gazebo><![CDATA[ a < b && c ]]></gazebo>" + END),
    _accept("capital_utf8", '"1.0"?>', '"1.0" encoding="UTF8"?>'),
    Case("dashes_then_truncated", GOOD.replace("<robot", "<!-- -- -->\n<robot").encode()[:-10], "error", ("not well-formed",)),
    Case("robot_after_the_end", (GOOD + '<link name="x"/>').encode(), "error", ("not well-formed",)),
    Case("doctype_behind_dashes", GOOD.replace("<robot", "<!-- -- --><!DOCTYPE robot><robot").encode(), "error", ("DOCTYPE",)),
    Case("attribute_twice", GOOD.replace('name="two"', 'name="two" name="three"').encode(), "error", ("not well-formed",), 2),
    Case("attribute_without_quotes", GOOD.replace('name="two"', "name=two").encode(), "error", ("not well-formed",), 2),
    Case("quote_missing", GOOD.replace('name="two"', 'name="two').encode(), "error", ("not well-formed",)),
    Case("comment_without_end", GOOD.replace("<robot", "<!-- -- <robot").encode(), "error", ("not well-formed",)),
    Case("undefined_entity", GOOD.replace('"two"', '"a&x;b"').encode(), "error", ("not well-formed",), 2),
    Case("no_links", b'<robot name="r"/>', "error", ("no <link>",)),
    # joints
    *(
        _error(f"type_{kind}", SHOULDER, SHOULDER.replace("revolute", kind), "joint 'shoulder'", repr(kind), "revolute", "continuous", "planar")
        for kind in ("screw", "Revolute", "", "ball")
    ),
    _error("no_type", SHOULDER, '<joint name="shoulder">', "joint 'shoulder'", "type", "revolute"),
    _warning("revolute_without_limit", LIMIT, "", "joint 'shoulder'", "revolute", "without <limit>"),
    _warning("prismatic_without_limit", WRIST_LIMIT, "", "joint 'wrist'", "prismatic", "without <limit>"),
    _warning("limit_without_effort", LIMIT, '<limit lower="-1" upper="1" velocity="2"/>', "joint 'shoulder'", "<limit>", "effort"),
    _warning("limit_without_velocity", LIMIT, '<limit lower="-1" upper="1" effort="2"/>', "joint 'shoulder'", "<limit>", "velocity"),
    _warning("limits_without_end", LIMIT, LIMIT.replace('"-1"', '"-inf"').replace('upper="1"', 'upper="1.8e308"'), "joint 'shoulder'", "limits that are infinite"),
    _warning("limits_huge", WRIST_LIMIT, WRIST_LIMIT.replace("0.2", "999999"), "limit", "wrist", "100 m"),
    _warning("effort_negative", LIMIT, LIMIT.replace('effort="10"', 'effort="-10"'), "joint 'shoulder'", "effort", "negative", "-10"),
    _warning("velocity_negative", LIMIT, LIMIT.replace('velocity="2"', 'velocity="-2"'), "joint 'shoulder'", "velocity", "negative", "-2"),
    _warning("limits_in_degrees", LIMIT, LIMIT.replace('"-1"', '"-90"').replace('upper="1"', 'upper="90"'), "joint 'shoulder'", "degrees"),
    _warning("angles_in_degrees", '<origin xyz="0.3 0 0"/>', '<origin xyz="0.3 0 0" rpy="0 0 90"/>', "joint 'wrist'", "degrees"),
    _warning("lengths_in_millimetres", '<origin xyz="0.3 0 0"/>', '<origin xyz="300 0 0"/>', "joint 'wrist'", "millimetres"),
    _warning("centre_in_millimetres", '<origin xyz="0 0 0.1" rpy="0 0 0"/>', '<origin xyz="0 0 100"/>', "link 'base'", "millimetres"),
    _warning("inertia_of_a_placeholder", MASS, '<mass value="1e-5"/>', "link 'arm'", "radius of gyration", "31.6 m"),
    _accept("limits_of_a_placeholder", LIMIT, LIMIT.replace('"-1"', '"-100"').replace('upper="1"', 'upper="100"')),
    _warning("moves_no_mass", '<mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/>', "", "joint 'wrist'", "no mass"),
    _warning("damping", LIMIT, LIMIT + '<dynamics damping="0.5" friction="2"/>', "joint 'shoulder'", "damping 0.5", "friction 2"),
    _warning("armature", LIMIT, LIMIT + '<dynamics armature="0.1"/>', "joint 'shoulder'", "armature", "ignored"),
    _warning("blanks_in_the_type", SHOULDER, SHOULDER.replace("revolute", " revolute "), "joint 'shoulder'", "type", "blanks"),
    _error("limit_nan", LIMIT, LIMIT.replace('"-1"', '"nan"'), "joint 'shoulder'", "<limit lower>", "'nan'"),
    _warning("limit_without_bounds", LIMIT, '<limit effort="1" velocity="2"/>', "joint 'shoulder'", "lower or upper"),
    _warning("limits_crossed", LIMIT, LIMIT.replace('"-1"', '"3"'), "joint 'shoulder'", "above"),
    _accept("empty_dynamics", LIMIT, LIMIT + "<dynamics/>"),
    _accept("safety_without_k_velocity", LIMIT, LIMIT + '<safety_controller soft_lower_limit="0"/>'),
    _error("dynamics_nan", LIMIT, LIMIT + '<dynamics damping="nan"/>', "joint 'shoulder'", "<dynamics damping>", "'nan'"),
    _warning("damping_negative", LIMIT, LIMIT + '<dynamics damping="-1"/>', "joint 'shoulder'", "negative damping"),
    _accept("planar_axis_z", WRIST + '\n    <parent link="arm"/>\n    <child link="hand"/>\n    <origin xyz="0.3 0 0"/>\n    <axis xyz="1 0 0"/>',
            WRIST.replace("prismatic", "planar") + '<parent link="arm"/><child link="hand"/><axis xyz="0 0 2"/>'),
    _warning("planar_axis_x", WRIST, WRIST.replace("prismatic", "planar"), "joint 'wrist'", "planar", "ignored"),
    # names and the tree
    _error("joint_without_name", SHOULDER, '<joint type="revolute">', "<joint> without a name"),
    _error("link_without_name", HAND, "<link/>" + HAND, "2 root links", "robot"),
    _error("link_twice", HAND, '<link name="arm"/>' + HAND, "link 'arm'", "twice", "line 10"),
    _error("joint_twice", WRIST, WRIST.replace("wrist", "shoulder"), "joint 'shoulder'", "twice", "line 17"),
    _accept("link_named_like_a_joint", HAND, '<link name="shoulder"/>' + HAND).__class__(
        "link_named_like_a_joint", GOOD.replace('"hand"', '"shoulder"').encode(), "accept"
    ),
    *(
        _error(f"joint_named_{name}", WRIST, WRIST.replace("wrist", name), f"joint {name!r}", "reserved")
        for name in ("universe",)
    ),
    Case("joint_named_root_joint", GOOD.replace(END, '<link name="tool"/>' + _joint("root_joint", "hand", "tool") + END).encode(), "accept"),
    _error("missing_parent_link", '<parent link="arm"/>', '<parent link="am"/>', "joint 'wrist'", "'am'", "did you mean 'arm'"),
    _error("missing_child_link", '<child link="hand"/>', '<child link="fist"/>', "joint 'wrist'", "'fist'", "not defined"),
    _error("no_parent", '<parent link="arm"/>', "", "joint 'wrist'", "no parent link", at=WRIST),
    _error("no_child", '<child link="hand"/>', "<child/>", "joint 'wrist'", "no child link", at=WRIST),
    _error("two_parents", END, _joint("strut", "base", "hand") + END, "link 'hand'", "'wrist'", "'strut'", "tree"),
    _error("self_loop", HAND, '<link name="x"/>' + _joint("loop", "x", "x") + HAND, "x", "loop"),
    _error("detached_loop", HAND, '<link name="x"/><link name="y"/>' + _joint("a", "x", "y") + _joint("b", "y", "x") + HAND, "x", "y", "loop"),
    Case("full_cycle", GOOD.replace(END, _joint("back", "hand", "base") + END).encode(), "error", ("no root link", "loop")),
    _error("two_roots", HAND, '<link name="island"/>' + HAND, "2 root links", "base", "island"),
    Case("diamond", GOOD.replace(HAND, '<link name="x"/>' + HAND).replace(
        END, _joint("a", "base", "x") + _joint("b", "arm", "x") + END).encode(), "error", ("link 'x'", "'a'", "'b'"), 31),
    # mimic
    _warning("mimic_left_free", WRIST_LIMIT, WRIST_LIMIT + '<mimic joint="shoulder"/>', "joint 'wrist'", "<mimic>", "free"),
    _warning("mimic_of_nobody", WRIST_LIMIT, WRIST_LIMIT + '<mimic joint="elbow"/>', "joint 'wrist'", "'elbow'"),
    _error("mimic_without_joint", WRIST_LIMIT, WRIST_LIMIT + "<mimic/>", "joint 'wrist'", "<mimic>"),
    _error("mimic_multiplier", WRIST_LIMIT, WRIST_LIMIT + '<mimic joint="shoulder" multiplier="two"/>', "joint 'wrist'", "<mimic multiplier>", "'two'"),
    # bytes
    Case("empty", b"", "error", ("empty",)),
    Case("blank", b" \n\t ", "error", ("empty",)),
    Case("truncated", GOOD[: GOOD.index('<axis xyz="1')].encode(), "error", ("not well-formed",), _line('<axis xyz="1 0 0"/>')),
    Case("truncated_end", GOOD.encode()[:-10], "error", ("not well-formed",)),
    Case("two_documents", (GOOD + GOOD).encode(), "error", ("not well-formed",)),
    Case("trailing_text", (GOOD + "x").encode(), "error", ("not well-formed",)),
    Case("binary", bytes(range(256)) * 8, "error", ("not well-formed",)),
    Case("null_bytes", b"\0" * 64, "error", ("not well-formed",)),
    Case("gzip", b"\x1f\x8b\x08\0\0\0\0\0", "error", ("not well-formed",)),
    Case("latin1_undeclared", GOOD.replace("hand", "m\u00e3o").encode("latin-1"), "error", ("not well-formed", "<link name>"), _line(HAND)),
    Case("latin1_in_a_comment", GOOD.replace(END, "<!-- m\u00e3o -->" + END).encode("latin-1"), "warning", ("bytes", "no text")),
    Case("latin1_in_a_mesh", GOOD.replace(END, "<gazebo file='m\u00e3o'/>" + END).encode("latin-1"), "warning", ("bytes", "no text")),
    *(Case(f"encoding_{c}", GOOD.replace("hand", "m\u00e3o").encode(c), "accept") for c in ("utf-16-le", "utf-16-be", "utf-32", "utf-32-le")),
    Case("line_ends_of_windows", GOOD.replace("\n", "\r\n").encode(), "accept"),
    Case("latin1_declared", GOOD.replace("hand", "m\u00e3o").replace('"1.0"?>', '"1.0" encoding="ISO-8859-1"?>').encode("latin-1"), "accept"),
    Case("utf8", GOOD.replace("hand", "m\u00e3o \u624b").encode(), "accept"),
    Case("utf8_with_mark", GOOD.encode("utf-8-sig"), "accept"),
    Case("utf16", GOOD.replace("hand", "m\u00e3o").encode("utf-16"), "accept"),
    Case("unknown_encoding", GOOD.replace("hand", "m\u00e3o").replace('"1.0"?>', '"1.0" encoding="klingon"?>').encode(), "error", ("not well-formed", "'klingon'")),
    Case("encoding_of_escapes", GOOD.replace("hand", "m\u00e3o").replace('"1.0"?>', '"1.0" encoding="unicode_escape"?>').encode(), "error", ("not well-formed",)),
    # attacks
    Case("external_entity", b'<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="r"><link name="&x;"/></robot>', "error", ()),
    Case("external_entity_as_element", b'<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot name="r">&x;<link name="l"/></robot>', "error", ("DOCTYPE",)),
    Case("parameter_entity", b'<!DOCTYPE r [<!ENTITY % p SYSTEM "http://127.0.0.1:9/x.dtd"> %p;]><robot name="r"><link name="l"/></robot>', "error", ("DOCTYPE",)),
    Case("external_dtd", b'<!DOCTYPE robot SYSTEM "http://127.0.0.1:9/x.dtd"><robot name="r"><link name="l"/></robot>', "error", ("DOCTYPE",)),
    Case("billion_laughs", (
        "<!DOCTYPE r [<!ENTITY a0 'ha'>" + "".join(f"<!ENTITY a{i} '{f'&a{i - 1};' * 10}'>" for i in range(1, 10))
        + "]><robot name='r'><link name='l'>&a9;</link></robot>").encode(), "error", ()),
    Case("billion_laughs_in_an_attribute", (
        "<!DOCTYPE r [<!ENTITY a0 'ha'>" + "".join(f"<!ENTITY a{i} '{f'&a{i - 1};' * 10}'>" for i in range(1, 10))
        + "]><robot name='r'><link name='&a9;'/></robot>").encode(), "error", ()),
    Case("deep_nesting", b'<robot name="r">' + b"<link>" * 5000 + b"</link>" * 5000 + b"</robot>", "error", ("not well-formed",)),
]  # fmt: skip
