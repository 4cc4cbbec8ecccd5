"""Escaping of names for other languages, so that a joint's name never becomes code, markup or a terminal command.

Names of robots, joints, links and files come from unknown sources.  Each function escapes a name for one kind of
document.
"""

from __future__ import annotations

import json
import re
from html import escape as html
from typing import Any

__all__ = ["c_comment", "c_identifier", "csv_cell", "html", "is_c_identifier", "json_text", "line", "lines", "markdown",
           "matlab_string", "tex", "yaml_string"]  # fmt: skip

# control characters, direction marks, line separators, lone surrogates, noncharacters
_UNPRINTABLE = re.compile(
    "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ufffe\uffff\ud800-\udfff]"
)
_FORMULA = re.compile(r"[=+\-@\t\r\uff0b\uff0d\uff1d\uff20]")  # the last four are their wide forms


def _code(match: re.Match[str]) -> str:
    n = ord(match.group())
    return {9: r"\t", 10: r"\n", 13: r"\r"}.get(n) or (f"\\x{n:02x}" if n < 256 else f"\\u{n:04x}")


def line(text: str) -> str:
    r"""The text on one line without control characters, for terminals and for comments to the end of a line.

    Examples
    --------
    >>> print(line("a\nimport os\x1b[31m"))
    a\nimport os\x1b[31m
    """
    return _UNPRINTABLE.sub(_code, text)


def lines(text: str) -> str:
    """The text without control characters except line breaks, for messages."""
    return "\n".join(map(line, text.split("\n")))


def c_comment(text: str) -> str:
    """The text for /* */: it neither ends the comment nor begins another."""
    return line(text).replace("*/", "* /").replace("/*", "/ *").replace("??/", "? ?/")


def c_identifier(text: str) -> str:
    """The nearest name that C and C++ take for a function of their user.

    Examples
    --------
    >>> [c_identifier(x) for x in ("ur5 rnea", "double", "7 axes", "a*/b")]
    ['ur5_rnea', 'f_double', 'f_7_axes', 'a_b']
    """
    name = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_") or "f"
    return name if is_c_identifier(name) else f"f_{name}"


def is_c_identifier(name: str) -> bool:
    """Whether it may be the name of a function and a header: not a keyword, nor a name of the compiler or libraries."""
    return re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name) is not None and not (
        name in _C_WORDS or name.startswith("__") or re.match("_[A-Z]", name)
    )


_C_KEYWORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int long register
restrict return short signed sizeof static struct switch typedef union unsigned void volatile while alignas alignof
and and_eq asm bitand bitor bool catch char8_t char16_t char32_t class co_await co_return co_yield compl concept
consteval constexpr constinit const_cast decltype delete dynamic_cast explicit export false friend mutable namespace
new noexcept not not_eq nullptr operator or or_eq private protected public reinterpret_cast requires static_assert
static_cast template this thread_local throw true try typeid typename typeof typeof_unqual using virtual wchar_t xor
xor_eq main linux unix i386
"""  # of C, of C++ whose compilers read the header too, and what GCC defines by itself
_C_LIBRARY = """
abort abs atexit atof atoi atol bcmp bcopy bzero calloc clog exit fflush fopen fprintf fputc fputs free fscanf fwrite
getenv gettext imaxabs index isalnum isalpha isascii isblank iscntrl isdigit isgraph islower isprint ispunct isspace
isupper iswalnum isxdigit labs llabs malloc memchr memcmp memcpy mempcpy memmove memset posix_memalign printf putc
putchar puts qsort rand realloc rindex round scanf setjmp longjmp snprintf sprintf sscanf stpcpy strcasecmp strcat
strchr strcmp strcpy strcspn strdup strfmon strftime strlen strncat strncmp strncpy strndup strpbrk strrchr strspn
strstr strtod strtol toascii tolower toupper vfprintf vprintf vscanf vsnprintf vsprintf vsscanf execl execv execve
fork signbit alloca fpclassify isfinite isgreater isgreaterequal isinf isless islessequal islessgreater isnan isnormal
isunordered finite float_t double_t signgam math_errhandling NAN INFINITY HUGE_VAL HUGE_VALF HUGE_VALL math features
cabs cacos cacosh carg casin casinh catan catanh ccos ccosh cexp cimag conj cpow cproj creal csin csinh csqrt ctan
ctanh
"""
_C_FUNCTIONS = """
acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh drem erf erfc exp exp10 exp2 expm1 fabs fdim floor
fma fmax fmin fmod frexp gamma hypot ilogb j0 j1 jn ldexp lgamma llrint llround log log10 log1p log2 logb lrint lround
modf nan nearbyint nextafter nexttoward pow pow10 remainder remquo rint roundeven scalb scalbln scalbn significand sin
sincos sinh sqrt tan tanh tgamma trunc y0 y1 yn
"""  # of <math.h>, which every exported file includes; each also for float and long double
_C_WORDS = frozenset(
    [*_C_KEYWORDS.split(), *_C_LIBRARY.split(), *(f + e for f in _C_FUNCTIONS.split() for e in ("", "f", "l"))]
)


def c_string(text: str) -> str:
    r"""A string of C and C++, with its quotes; a question mark is escaped, since two may begin a trigraph.

    Examples
    --------
    >>> print(c_string('a"b?\n'))
    "a\"b\?\012"
    """
    special = {'"': r"\"", "\\": r"\\", "?": r"\?"} | {chr(n): f"\\{n:03o}" for n in (*range(32), 127)}
    return '"' + "".join(special.get(c, c) for c in text) + '"'


def julia_string(text: str) -> str:
    """A string of Julia, with its quotes."""
    return yaml_string(text).replace("$", r"\$")


def matlab_string(text: str) -> str:
    """A character vector of MATLAB, with its quotes."""
    return "'" + line(text).replace("'", "''") + "'"


_TEX = {
    "\\": r"\textbackslash{}", "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", "<": r"\textless{}",
    ">": r"\textgreater{}", '"': r"\textquotedbl{}", **{c: "\\" + c for c in "_&%$#{}"},
}  # fmt: skip


def tex(text: str) -> str:
    """A name that LaTeX prints as it is."""
    return "".join(_TEX.get(c, c) for c in line(text))


def csv_cell(text: str) -> str:
    """A cell that spreadsheets read as text or a number, never as a formula.

    Examples
    --------
    >>> [csv_cell(x) for x in ("-0.5", "=1+1", "-x", "joint")]
    ['-0.5', "'=1+1", "'-x", 'joint']
    """
    kept = "".join(c if c in "\t\n" else line(c) for c in text)
    return f"'{kept}" if _FORMULA.match(kept) and not is_number(text) else kept


def is_number(text: str) -> bool:
    """Whether Python reads it as one."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def markdown(text: str) -> str:
    """A name that Markdown shows literally, in a cell, an item or a sentence: no HTML, no links, no emphasis."""
    text = html(line(text), quote=False).replace("\\", "\\\\")
    text = re.sub(r"([`*\[\]|!~$])", r"\\\1", text)
    # underscores inside words have no meaning
    return re.sub(r"(?<![A-Za-z0-9])_|_(?![A-Za-z0-9])", r"\\_", text)


def json_text(data: Any, indent: int | None = 2) -> str:
    """Data as JSON: characters as they are where they are text, escapes where they are not."""
    return "\n".join(_unicode(x) for x in json.dumps(data, indent=indent, ensure_ascii=False).split("\n"))


def yaml_string(text: str) -> str:
    """A string of YAML in double quotes, with JSON's escapes."""
    return _unicode(json.dumps(text, ensure_ascii=False))


def _unicode(text: str) -> str:
    return _UNPRINTABLE.sub(lambda m: f"\\u{ord(m.group()):04x}", text)
