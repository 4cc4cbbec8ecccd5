"""From text to XML that can be trusted: parsed without entities, stripped to what a robot's motion depends on.

URDFs come from strangers.  Other readers fill gaps silently (a missing mass is zero or one, an axis
of four numbers is cut to three); here what has one clear meaning is read with a note, and the rest is
an error that names the element, the attribute, what was found, what was expected, and the line.
"""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

from lxml import etree

from ..errors import UrdfError
from .document import VERSIONS, Document, short
from .joints import read_joints
from .links import read_links
from .mend import UNREADABLE, decoded, mended, refuse_doctype, without_declaration
from .notes import Notes
from .transmissions import reductions
from .xacro import check_xacro

MAX_BYTES = 64 << 20
HINTS = {
    "sdf": " (SDF is not URDF and is not read; convert it first, with sdformat_urdf for instance)",
    "mujoco": " (MJCF is not URDF; dualpin.load reads it)",
}
# what a robot's motion depends on; meshes, materials, transmissions and simulator blocks do not
KEPT = {
    "robot": {"link", "joint"},
    "link": {"inertial"},
    "inertial": {"origin", "mass", "inertia"},
    "joint": {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"},
}


def read(path: Path) -> Document:
    """The checked document of a file."""
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise UrdfError(f"{path.name}: {size >> 20} MiB; files up to {MAX_BYTES >> 20} MiB are read")
        data = path.read_bytes()
    except OSError as e:
        raise UrdfError(f"{path}: cannot be read ({e.strerror or e})") from None
    return parse(data, path.name)


def read_stream(stream: Any) -> tuple[bytes | str, str]:
    """What an open file holds, in binary or in text mode, and its name."""
    name = getattr(stream, "name", None)
    source = Path(name).name if isinstance(name, str) and name and not name.startswith("<") else "<file>"
    try:
        data = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as e:  # closed, not readable, not text in its encoding
        raise UrdfError(f"{source}: cannot be read ({e})") from None
    if not isinstance(data, (bytes, bytearray, str)):
        raise UrdfError(f"{source}: read() gave {type(data).__name__}; bytes or str expected")
    return data if isinstance(data, str) else bytes(data), source


def parse(data: bytes | str, source: str = "<bytes>") -> Document:
    """The checked document of bytes, or of text."""
    if len(data) > MAX_BYTES:
        raise UrdfError(f"{source}: {len(data) >> 20} MiB; files up to {MAX_BYTES >> 20} MiB are read")
    notes = Notes()
    text, clean = (data, True) if isinstance(data, str) else decoded(data, source, notes)
    text = text.removeprefix("\ufeff")
    if not text.strip():
        raise UrdfError(f"{source}: the file is empty")
    root, mended = _tree(without_declaration(text, notes), source, notes)
    _check_root(root, source, notes)
    hint = check_xacro(root, KEPT, text, source, notes)
    document = Document(
        _kept(root, notes), source, notes, reductions=reductions(root, notes), whole=root, mended=mended
    )
    _check_words(document, clean, hint)
    read_links(document)
    read_joints(document)
    return document


def _tree(text: str, source: str, notes: Notes) -> tuple[etree._Element, bool]:
    """The root element, of the text as it is or else with its small faults mended, and whether it had some."""
    try:
        return _parsed(text, source), False
    except etree.XMLSyntaxError:
        text = mended(text, source, notes)
    try:
        return _parsed(text, source), True
    except etree.XMLSyntaxError as e:
        line = f":{e.lineno}" if e.lineno else ""
        raise UrdfError(f"{source}{line}: not well-formed XML: {str(e.msg).split(', line')[0]}") from None


def _parsed(text: str, source: str) -> etree._Element:
    # no entities, no network, no recovery: what cannot be read whole is refused whole
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False, huge_tree=False,
        recover=False, remove_comments=True, remove_pis=True, encoding="utf-8",
    )  # fmt: skip
    try:
        tree = etree.parse(BytesIO(text.encode()), parser)
    except UnicodeEncodeError as e:
        raise UrdfError(f"{source}: not text that can be written ({e})") from None
    except (ValueError, LookupError) as e:
        raise UrdfError(f"{source}: not well-formed XML: {e}") from None
    if tree.docinfo.doctype or tree.docinfo.internalDTD is not None:
        refuse_doctype(source)
    return tree.getroot()


def plain(e: etree._Element) -> str:
    """The tag of an element that is URDF's: without a prefix; a default namespace changes nothing."""
    return etree.QName(e).localname if isinstance(e.tag, str) and e.prefix is None else ""


def _check_root(root: etree._Element, source: str, notes: Notes) -> None:
    name = etree.QName(root)
    at = f"{source}:{root.sourceline}"
    if plain(root) != "robot":
        if name.localname == "robot":
            raise UrdfError(f"{at}: <{root.prefix}:robot> is in the namespace {name.namespace!r}; a URDF has none")
        hint = HINTS.get(name.localname, "")
        raise UrdfError(f"{at}: root element is <{name.localname}>, <robot> expected{hint}")
    if name.namespace:
        notes.add(f"the default namespace {name.namespace!r} (xmlns) changes nothing; a URDF has none")
    version = root.get("version")
    if version not in (None, *VERSIONS):
        notes.add(f"<robot version> is {version!r}, read as '1.0' (versions of URDF: {', '.join(VERSIONS)})")


def _kept(e: etree._Element, notes: Notes) -> etree._Element:
    """A copy with only the elements that a robot's motion depends on; the others need not be readable."""
    tag = plain(e)
    copy = etree.Element(tag, {k: v for k, v in e.attrib.items() if not k.startswith("{")})
    copy.sourceline = e.sourceline
    wanted = KEPT.get(tag, ())
    for child in e:
        name = plain(child)
        if name in wanted:
            copy.append(_kept(child, notes))
        elif name.lower() in wanted:
            notes.add("elements that no reader knows, ignored (tags are lower case)", "line", child.sourceline)
    return copy


def _check_words(document: Document, clean: bool, hint: str) -> None:
    """Refuse what has no value in attributes that are read: bytes that are no text, xacro's expressions."""
    for e in document.root.iter():
        for key, value in e.attrib.items():
            if not clean and UNREADABLE in value:
                document.fail(
                    e, f"not well-formed XML: <{e.tag} {key}> is {short(value)}, with bytes that are not of the "
                    "file's encoding; the declaration names another encoding than UTF-8"
                )  # fmt: skip
            if "${" in value or "$(" in value:
                owner = next((a for a in (e, *e.iterancestors()) if a.tag in ("link", "joint")), e)
                what = f"{owner.tag} {owner.get('name')!r}: " if owner is not e else ""
                document.fail(
                    e, f"{what}<{e.tag} {key}> is {short(value)}, an xacro expression and no value{hint}"
                )  # fmt: skip
    if not clean:
        document.notes.add("bytes that are no text, in comments or parts that are not read")
