"""Small valid specs to be spoiled, and the refusal that must follow."""

from collections.abc import Callable
from fractions import Fraction

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import InteractionDesignSpec, SwitchedSystemSpec, parse_spec
from nrs_design.spec.switched_system import ModeSpec
from tests.tables import spec_text

IMPEDANCE, FORCE, SWITCHED = map(spec_text, ("impedance", "force", "switched"))


def interaction(text: str) -> InteractionDesignSpec:
    """Parse a text that must be an interaction design."""
    spec = parse_spec(text)
    assert isinstance(spec, InteractionDesignSpec)
    return spec


def switched(text: str) -> SwitchedSystemSpec:
    """Parse a text that must be a switched system."""
    spec = parse_spec(text)
    assert isinstance(spec, SwitchedSystemSpec)
    return spec


def numbers(mode: ModeSpec) -> list[tuple[Fraction, ...]]:
    """Rows of a matrix that depends on no parameter."""
    return [tuple(row) for row in mode.matrix({})]


def spoiled(sample: str, old: str, new: str) -> str:
    """Replace a piece that must be there exactly once."""
    assert sample.count(old) == 1, old
    return sample.replace(old, new)


def refusal(text: str, read: Callable[[str], object] = parse_spec) -> SpecError:
    """Return the error that a text must cause; its position lies in the text."""
    with pytest.raises(SpecError) as caught:
        read(text)
    assert_inside(caught.value, text)
    return caught.value


def assert_inside(error: SpecError, text: str) -> None:
    """Check that the position of an error is one of the text's."""
    assert error.line is not None
    assert error.column is not None
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    assert 1 <= error.line <= len(lines)
    assert 1 <= error.column <= len(lines[error.line - 1]) + 1
    assert error.message
    assert error.remedy


def place_of(text: str, piece: str, start: int = 0) -> tuple[int, int]:
    """Line and column at which a piece of text first stands from a place on, or else before."""
    where = text.find(piece, start)
    before = text[: where if where >= 0 else text.index(piece)]
    return before.count("\n") + 1, len(before) - before.rfind("\n")


def message_of(read: Callable[[], object]) -> str:
    """Message of the SpecError that a reader raises, or nothing; other errors pass through."""
    try:
        read()
    except SpecError as error:
        return error.message
    return ""
