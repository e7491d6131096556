"""Text of exported files from the templates beside this module; numbers arrive in them as text."""

from __future__ import annotations

from functools import cache
from html import escape
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from nrs_design.axis import unit
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.exporters.c_names import harmless, literal

if TYPE_CHECKING:
    from jinja2 import Environment


def fill_template(name: str, **values: object) -> str:
    """Return the text of a file in `templates`; a name in it that has no value is an error."""
    return _environment().get_template(name).render(values | {"unit": unit})


@cache
def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    found = Environment(
        loader=PackageLoader("nrs_design.exporters"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        # C and Python are no markup; what goes into XML and HTML says how it is escaped.
        autoescape=False,
    )
    found.filters |= {
        "literal": literal,
        "exact_decimal": exact_decimal,
        "harmless": harmless,
        "quoted": quoteattr,
        "escaped": escape,
    }
    return found
