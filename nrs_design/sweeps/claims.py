"""What a kept answer claims: none of it is taken over that nothing shows again.

A file in a folder is no proof. An answer that says that something is proved or refuted is used
again only as far as a certificate that is checked again shows the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

# Words that are verdicts, and how the names of numbers begin that are claimed.
_VERDICTS = frozenset({"proved", "refuted", "exists", "impossible"})
_CLAIMED = ("claim", "proved", "refuted", "certified", "kept_up_to", "decay_rate_exact")


def claims_in(document: object) -> Iterator[str]:
    """Yield the name of everything that a document claims to be proved, or refuted."""
    if isinstance(document, Mapping):
        for name, value in document.items():
            if (str(name).startswith(_CLAIMED) and _says(value)) or (
                isinstance(value, str) and value.lower() in _VERDICTS
            ):
                yield str(name)
            else:
                yield from claims_in(value)
    elif isinstance(document, list | tuple):
        for item in document:
            yield from claims_in(item)


def _says(value: object) -> bool:
    """Tell whether a value is something; zero is, too."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number or bool(value)


# What an answer with a certificate may hold beside what that shows: how it was found.
BESIDE = frozenset(
    {
        "schema",
        "spec",
        "spec_sha256",
        "method",
        "attempts",
        "decay_rate_limit",
        "decay_rate_unit",
        "relief",
    }
)


def is_shown(result: Mapping[str, Any], shown: Mapping[str, Any]) -> bool:
    """Tell whether a kept answer says nothing beyond what was shown just now.

    `shown` is what a certificate shows that was checked again, under the names of the answer; empty
    without one, and then nothing may be claimed.
    """
    same = all(name in result and result[name] == value for name, value in shown.items())
    rest = {name: value for name, value in result.items() if name not in shown}
    known = not shown or rest.keys() <= BESIDE
    return same and known and not any(claims_in(rest))
