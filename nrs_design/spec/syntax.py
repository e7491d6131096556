"""YAML syntax errors in words that name the remedy."""

from __future__ import annotations

from ruamel.yaml.error import MarkedYAMLError, StringMark, YAMLError
from ruamel.yaml.reader import ReaderError

from nrs_design.proof.text import counted, quoted

# The first fragment that occurs in the parser's report decides.
_EXPLANATIONS: tuple[tuple[str, str, str], ...] = (
    ("character '\\t'", "a tab is used where YAML wants spaces", "indent with spaces"),
    ("while scanning a quoted scalar", "a quoted text is not closed or malformed", "close it"),
    ("while parsing a flow sequence", "a list [...] is not closed", "check commas and brackets"),
    ("while parsing a flow mapping", "a mapping {...} is not closed", "check commas and braces"),
    ("while parsing a flow node", "a bracket or brace is not closed", "check brackets and commas"),
    ("could not find expected ':'", "a key has no ':'", "write `key: value`"),
    ("while scanning a simple key", "a key has no ':'", "write `key: value`"),
    ("block sequence entries are not allowed", "a list item '- ' cannot stand here", "indent it"),
    ("that cannot start any token", "a text starts with a reserved character", "put it in quotes"),
    ("incompatible YAML document", "the file asks for another YAML version", "remove the line"),
)


def explain_syntax(error: YAMLError, text: str, index: int) -> tuple[str, str, int]:
    """Translate a parser error: what is wrong, the remedy, and where a reader sees the fault.

    The index, where the parser saw it, counts characters from 0.
    """
    if isinstance(error, ReaderError):
        return "a control character is not allowed here", "remove it", index
    report = _report(error)
    if "mapping values are not allowed" in report:
        return _second_colon(text, index)
    if "expected <block end>" in report:
        indent = counted(index - _line_start(text, index), "space")
        return (
            f"indented by {indent}, which fits nothing above",
            "align it with the keys that it belongs to",
            index,
        )
    for fragment, message, remedy in _EXPLANATIONS:
        if fragment in report:
            return message, remedy, index
    return "this is not valid YAML", "check indentation, colons and quotes", index


def _second_colon(text: str, index: int) -> tuple[str, str, int]:
    """Tell `a: b: c` from a key that is indented too far, so that it goes on the line above."""
    start = _line_start(text, index)
    before = text[start:index]
    key = before.strip()
    if before[:1] != " " or ": " in before or key.startswith(("-", "[", "{", "?")):
        return "a second ': ' stands on this line", "quote the text", index
    indent = len(before) - len(before.lstrip(" "))
    return (
        f"{quoted(key)} is indented by {counted(indent, 'space')}, so that it goes on the value "
        "above",
        "give it the indentation of the keys that it belongs to",
        start + indent,
    )


def _line_start(text: str, index: int) -> int:
    return max(text.rfind(end, 0, index) for end in "\n\r") + 1


def fault_mark(error: MarkedYAMLError) -> StringMark | None:
    """Return the place of the fault; an unfinished part is shown at its beginning."""
    begun = error.context in ("while scanning a simple key", "while scanning a quoted scalar")
    marks = (error.problem_mark, error.context_mark)
    found: StringMark | None = next(filter(None, reversed(marks) if begun else marks), None)
    return found


def _report(error: YAMLError) -> str:
    if isinstance(error, MarkedYAMLError):
        return f"{error.context or ''} {error.problem or ''}"
    return ""
