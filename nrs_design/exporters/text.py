"""Text of exported files: names, numbers and comments of C, and templates."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from html import escape
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.operations import Coefficient, StepLaw, Value
from nrs_design.controllers.step_logic import SignalBound
from nrs_design.errors import DesignError
from nrs_design.models.axis import unit
from nrs_design.printable import printable

if TYPE_CHECKING:
    from jinja2 import Environment

WIDTH = 100


@dataclass(frozen=True, slots=True)
class CNames:
    """Identifiers in C of one law, which begin with the name of its spec."""

    spec: str  # Name of the spec

    @property
    def lower(self) -> str:
        """Beginning of functions and types."""
        return f"nrs_{_identifier(self.spec).lower()}"

    @property
    def upper(self) -> str:
        """Beginning of macros."""
        return self.lower.upper()

    def mode(self, controller: str) -> str:
        """Return the macro of a mode."""
        return f"{self.upper}_MODE_{_identifier(controller).upper()}"

    def limit(self, value: Value) -> str:
        """Return the macro of the limit of an input or a state."""
        return f"{self.upper}_MAX_{value.name.upper()}"

    def coefficient(self, coefficient: Coefficient, controller: str = "") -> str:
        """Return the macro of a coefficient; of one that each mode has, with a controller."""
        suffix = f"_OF_{_identifier(controller).upper()}" if controller else ""
        return f"{self.upper}_{coefficient.name.upper()}{suffix}"

    @property
    def modes(self) -> str:
        """The macro of how many modes there are."""
        return f"{self.upper}_MODES"

    def threshold(self, index: int, bound: SignalBound) -> str:
        """Return the macro of a bound of the switch with that number, counted from one."""
        side = "ABOVE" if bound.is_lower else "BELOW"
        return f"{self.upper}_LOGIC_{index}_{bound.signal.upper()}_{side}"

    def hold(self, controller: str) -> str:
        """Return the macro of how many samples a mode is held."""
        return f"{self.upper}_LOGIC_HOLD_OF_{_identifier(controller).upper()}"

    @property
    def start(self) -> str:
        """The macro of the mode at first."""
        return f"{self.upper}_LOGIC_START"

    def stays(self, law: StepLaw) -> dict[str, int]:
        """Return the macros of mode and stays of a mode logic with their numbers."""
        assert law.logic is not None
        hold_times = zip(law.modes, law.logic.hold_samples, strict=True)
        return {self.start: law.logic.start, **{self.hold(mode): stay for mode, stay in hold_times}}

    def coefficients(self, law: StepLaw) -> dict[str, tuple[Coefficient, Fraction]]:
        """Return every coefficient of a law with its number, by its macro."""
        found: dict[str, tuple[Coefficient, Fraction]] = {}
        for coefficient in law.coefficients:
            owners = law.modes if coefficient.differs_by_mode else ("",)
            for owner, value in zip(owners, coefficient.values, strict=True):
                found[self.coefficient(coefficient, owner)] = coefficient, value
        return found

    def check(self, law: StepLaw) -> None:
        """Refuse a law whose names are not names in C, or two controllers of one name in C."""
        if len({self.mode(name) for name in law.modes}) < len(law.modes):
            raise DesignError(
                "two controllers have the same name in C",
                remedy="let their names differ in letters or digits",
                at=("controllers",),
            )


def _identifier(name: str) -> str:
    return re.sub("[^A-Za-z0-9]", "_", name)


def literal(value: Fraction) -> str:
    """Return the hexadecimal literal of a single-precision number, without any rounding."""
    mantissa, _, exponent = float(value).hex().partition("p")
    digits = mantissa.rstrip("0") if "." in mantissa else mantissa
    text = f"{digits}{'0' * digits.endswith('.')}p{exponent}F"
    return f"({text})" if value < 0 else text


def block_comment(lines: Iterable[str], first: bytes) -> str:
    """Return a block comment that its lines cannot end; each is wrapped for itself."""
    wrapped = (
        part
        for line in lines
        for part in textwrap.wrap(harmless(line), WIDTH - 5, subsequent_indent="  ") or [""]
    )
    return first.decode() + "".join(f" * {part}".rstrip() + "\n" for part in wrapped) + " */\n"


def harmless(text: str) -> str:
    """Return a text that neither ends a comment nor begins one: printable ASCII, no trigraphs."""
    ascii_text = printable(" ".join(text.split())).encode("ascii", "backslashreplace").decode()
    return re.sub(r"\?(?=\?)", "? ", ascii_text.replace("*/", "* /").replace("/*", "/ *"))


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
        # C is no markup; templates of XML and HTML name their escapes.
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
