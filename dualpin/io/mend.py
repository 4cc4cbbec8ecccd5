"""From bytes to text that an XML parser reads: encodings, and small faults whose meaning is clear.

Most readers of URDF use a lenient parser (TinyXML), so files that are no XML are common: a declaration of
version "0.0" or after a blank line, `--` in a comment, an undeclared namespace prefix.  Each is
mended with a note; everything else is left for the parser to refuse.  Lines are never moved, so that
the lines of messages are those of the file.
"""

from __future__ import annotations

import codecs
import re

from ..errors import UrdfError
from .notes import Notes

UNREADABLE = "\N{REPLACEMENT CHARACTER}"
_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"),  # before UTF-16, whose mark begins alike
    (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"),
    (b"<\0\0\0", "utf-32-le"), (b"\0\0\0<", "utf-32-be"), (b"<\0", "utf-16-le"), (b"\0<", "utf-16-be"),
)  # fmt: skip
# codecs that are no encodings of documents: escapes, protocols, what the platform has
_NO_ENCODINGS = {"unicode-escape", "raw-unicode-escape", "utf-7", "punycode", "idna", "undefined", "mbcs", "oem"}
_DECLARATION = re.compile(r"([ \t\r\n]*)<\?xml(?=[\s?])[^<>]*\?>", re.IGNORECASE)
_ENCODING = re.compile(rb"""\s*<\?xml[^<>]*?\sencoding\s*=\s*["']([^"'<>]*)["']""", re.IGNORECASE)
_VERSION = re.compile(r"""\sversion\s*=\s*["']([^"']*)["']""")


def decoded(data: bytes, source: str, notes: Notes) -> tuple[str, bool]:
    """The text of a file, by its byte order mark, its declaration, or as UTF-8; and whether all of it is text.

    Bytes that are not text become `UNREADABLE`: they are harmless in comments and meshes.
    """
    encoding = next((name for mark, name in _MARKS if data.startswith(mark)), None)
    if encoding is None:
        encoding = _declared(data, source, notes)
    try:
        text, clean = data.decode(encoding), True
    except UnicodeDecodeError:
        text, clean = data.decode(encoding, errors="replace"), False
    text = text.removeprefix("\ufeff")
    end = text.rstrip("\0 \t\r\n")
    if end and "\0" in text[len(end) :]:
        notes.add("the file ends in zero bytes, which are no text; they were dropped")
        text = end
    return text, clean


def _declared(data: bytes, source: str, notes: Notes) -> str:
    """The encoding of a file of 8-bit characters: what its declaration says, if that can be true."""
    found = _ENCODING.match(data[:1024])
    if found is None:
        return "utf-8"
    said = found.group(1).decode("latin-1")
    try:
        codec = codecs.lookup(said)
        name = codec.name.replace("_", "-") if getattr(codec, "_is_text_encoding", True) else "undefined"
    except (LookupError, ValueError):
        name = "undefined"
    if name in _NO_ENCODINGS:
        if not data.isascii():
            raise UrdfError(f"{source}: not well-formed XML: the declared encoding {said!r} is not known")
        notes.add(f"XML declaration: the encoding {said!r} is not known; the file is plain ASCII and was read as that")
        return "ascii"
    if name.startswith(("utf-16", "utf-32")):
        notes.add(
            f"XML declaration: the encoding is said to be {said!r}, but the file has 8-bit characters; read as UTF-8"
        )
        return "utf-8"
    return "utf-8" if name in ("utf-8-sig", "ascii") else name


def without_declaration(text: str, notes: Notes) -> str:
    """The text with blanks where the XML declaration stood: its encoding no longer holds, its version is 1.0."""
    found = _DECLARATION.match(text)
    if found is None:
        return text
    version = _VERSION.search(found.group())
    said = None if version is None else version.group(1)
    if said not in ("1.0", "1.1"):
        notes.add(
            "XML declaration " + ("without a version" if said is None else f"of version {said!r}") + ", read as '1.0'"
        )
    if found.group(1):
        notes.add("XML declaration after blanks or blank lines; it belongs at the start of the file")
    return _blank(found.group()) + text[found.end() :]


def _blank(text: str) -> str:
    return "\n" * text.count("\n") or " "


# --- faults of the markup --------------------------------------------------------------------------

_NAME = re.compile(r"<(/?)([^\s<>/=\"'&]+)")
_ATTRIBUTE = re.compile(r"""(\s*)([^\s<>/="'&]+)\s*=\s*("[^"]*"|'[^']*')""")
_CLOSE = re.compile(r"\s*(/?)>")
_BARE = re.compile(r"&(?!#\d+;|#x[0-9a-fA-F]+;|[A-Za-z_][\w.-]*;)")
_CONTENT = {"robot", "link", "joint"}


def mended(text: str, source: str, notes: Notes) -> str:
    """The text with its small faults corrected, up to the first place that is not understood.

    One pass from left to right, every character read a bounded number of times: hostile text
    costs no more than other text.
    """
    return _Mender(text, source, notes).result()


class _Mender:
    def __init__(self, text: str, source: str, notes: Notes) -> None:
        self.text, self.source, self.notes = text, source, notes
        self.out: list[str] = []
        self.at = 0
        self.line, self.line_at = 1, 0
        self.depth = 0
        self.root = -1  # where in `out` the name of the root element ends
        self.tail = -1  # where in `out` the text after the root element begins
        self.prefixes: dict[str, None] = {}
        self.declared: set[str] = {"xml", "xmlns"}  # on the root, and so everywhere
        self.declared_inside: set[str] = set()
        self.outside: list[str] = []

    def result(self) -> str:
        while self._token():
            pass
        self._end()
        missing = [p for p in self.prefixes if p not in self.declared]
        if missing and self.root >= 0:
            self.out[self.root] += "".join(f' xmlns:{p}="undeclared:{p}"' for p in missing)
            for prefix in missing:
                if prefix not in self.declared_inside:
                    self.notes.add("namespace prefixes that are not declared", "prefix", prefix)
        return "".join(self.out)

    def _line(self) -> int:
        self.line += self.text.count("\n", self.line_at, self.at)
        self.line_at = self.at
        return self.line

    def _token(self) -> bool:
        """Copy one token; False at the end, or where nothing is understood any more."""
        text, start = self.text, self.text.find("<", self.at)
        if start < 0:
            self.out.append(text[self.at :])
            self.at = len(text)
            return False
        self.out.append(_BARE.sub("&amp;", text[self.at : start]))
        self.at = start
        if text.startswith("<!--", start):
            return self._comment()
        if text.startswith("<![CDATA[", start):
            return self._copy("]]>")
        if text.startswith("<?", start):
            return self._instruction()
        if text[start : start + 9].upper() == "<!DOCTYPE":
            refuse_doctype(self.source)
        return self._tag()

    def _until(self, closing: str) -> int:
        end = self.text.find(closing, self.at + 2)
        return -1 if end < 0 else end + len(closing)

    def _copy(self, closing: str) -> bool:
        end = self._until(closing)
        if end < 0:
            return False
        self.out.append(self.text[self.at : end])
        self.at = end
        return True

    def _comment(self) -> bool:
        end = self.text.find("-->", self.at + 4) + 3
        if end < 3:
            return False
        inside = self.text[self.at + 4 : end - 3]
        if "--" in inside or inside.endswith("-"):
            self.notes.add('"--" inside of comments, which XML does not allow', "line", self._line())
        self.out.append(_blank(self.text[self.at : end]))
        self.at = end
        return True

    def _instruction(self) -> bool:
        if not re.match(r"<\?xml[\s?]", self.text[self.at : self.at + 6], re.IGNORECASE):
            return self._copy("?>")
        end = self._until("?>")
        if end < 0:
            return False
        self.notes.add("XML declaration that is not at the start of the file", "line", self._line())
        self.out.append(_blank(self.text[self.at : end]))
        self.at = end
        return True

    def _tag(self) -> bool:
        name = _NAME.match(self.text, self.at)
        if name is None:
            return False
        closing, tag = name.groups()
        words, position = [name.group()], name.end()
        while attribute := _ATTRIBUTE.match(self.text, position):
            blanks, key, value = attribute.groups()
            if not blanks:
                self.notes.add("attributes without a blank between them", "line", self._line())
            words.append(f"{blanks or ' '}{key}={self._value(value)}")
            self._prefix(key)
            position = attribute.end()
        end = _CLOSE.match(self.text, position)
        if end is None:
            return False
        self._prefix(tag)
        if self.tail >= 0:
            self.outside.append(tag)
        self.out.append(words[0])
        if self.root < 0 and not closing:
            self.root = len(self.out) - 1
        self.out.append("".join(words[1:]) + end.group())
        self.at = end.end()
        self.depth += -1 if closing else 0 if end.group(1) else 1
        if self.depth <= 0 and self.tail < 0:
            self.tail = len(self.out)
        return True

    def _value(self, quoted: str) -> str:
        value = quoted[1:-1]
        if "<" in value and ">" not in value and "\n" not in value:  # otherwise a quote is missing somewhere
            self.notes.add('"<" in attributes, where XML wants "&lt;"', "line", self._line())
            value = value.replace("<", "&lt;")
        bare = _BARE.sub("&amp;", value)
        if bare != value:
            self.notes.add('"&" in attributes, where XML wants "&amp;"', "line", self._line())
        return quoted[0] + bare + quoted[0]

    def _prefix(self, name: str) -> None:
        prefix, colon, rest = name.partition(":")
        if prefix == "xmlns" and colon:
            (self.declared if self.root < 0 else self.declared_inside).add(rest)
        elif colon and prefix:
            self.prefixes[prefix] = None

    def _end(self) -> None:
        """Drop what follows the root element, if it is elements without any content of a robot."""
        rest = self.text[self.at :]
        if not self.outside:
            self.out.append(rest)
            return
        after = "".join(self.out[self.tail :])
        if rest.strip() or _CONTENT & set(self.outside) or re.sub(r"<[^<>]*>", "", after).strip():
            self.out.append(rest)
            return
        self.notes.add(f"elements after the end of the root element were dropped: <{self.outside[0].lstrip('/')}>")
        self.out[self.tail :] = [_blank(after)]


def refuse_doctype(source: str) -> None:
    """A document type can define entities, which read files and grow without bound."""
    raise UrdfError(f"{source}: a DOCTYPE (entities) has no place in a URDF and is refused")
