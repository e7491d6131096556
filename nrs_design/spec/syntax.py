"""YAML syntax errors in words that name the remedy."""

from __future__ import annotations

from ruamel.yaml.error import MarkedYAMLError, StringMark, YAMLError
from ruamel.yaml.reader import ReaderError

# The first fragment that occurs in the parser's report decides.
_EXPLANATIONS: tuple[tuple[str, str, str], ...] = (
    ("character '\\t'", "a tab is used where YAML wants spaces", "indent with spaces"),
    ("mapping values are not allowed", "a second ': ' stands on this line", "quote the text"),
    ("while scanning a quoted scalar", "a quoted text is not closed or malformed", "close it"),
    ("while parsing a flow sequence", "a list [...] is not closed", "check commas and brackets"),
    ("while parsing a flow mapping", "a mapping {...} is not closed", "check commas and braces"),
    ("while parsing a flow node", "a bracket or brace is not closed", "check brackets and commas"),
    ("could not find expected ':'", "a key has no ':'", "write `key: value`"),
    ("while scanning a simple key", "a key has no ':'", "write `key: value`"),
    ("expected <block end>", "the indentation does not fit the lines above", "align the keys"),
    ("block sequence entries are not allowed", "a list item '- ' cannot stand here", "indent it"),
    ("that cannot start any token", "a text starts with a reserved character", "put it in quotes"),
    ("incompatible YAML document", "the file asks for another YAML version", "remove the line"),
)


def explain_syntax(error: YAMLError) -> tuple[str, str]:
    """Translate a parser error.

    Parameters
    ----------
    error : YAMLError
        As raised by ruamel.yaml.

    Returns
    -------
    tuple of str
        What is wrong, and the remedy.
    """
    if isinstance(error, ReaderError):
        return "a control character is not allowed here", "remove it"
    report = _report(error)
    for fragment, message, remedy in _EXPLANATIONS:
        if fragment in report:
            return message, remedy
    return "this is not valid YAML", "check indentation, colons and quotes"


def fault_mark(error: MarkedYAMLError) -> StringMark | None:
    """Where the fault is: what was begun and not finished is best shown at its beginning."""
    begun = error.context in ("while scanning a simple key", "while scanning a quoted scalar")
    marks = (error.problem_mark, error.context_mark)
    found: StringMark | None = next(filter(None, reversed(marks) if begun else marks), None)
    return found


def _report(error: YAMLError) -> str:
    if isinstance(error, MarkedYAMLError):
        return f"{error.context or ''} {error.problem or ''}"
    return ""
