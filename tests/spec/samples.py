"""Small valid specs to be spoiled, and the refusal that must follow."""

from collections.abc import Callable
from fractions import Fraction

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import InteractionDesignSpec, ModeSpec, SwitchedSystemSpec, parse_spec

IMPEDANCE = """\
kind: interaction-design
name: sample
actuator:
  gain: 4.8417e-4 rad/s/rpm
  time_constant: 0.0351 s
motion_loop:
  damping_ratio: 0.707
  settling_time: 0.1404 s
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
environments:
  soft:
    model: elastic
    stiffness: 747.1461 N/m
    lever_arm: 0.24 m
  hand:
    model: kelvin-voigt
    stiffness: 43 N*m/rad
    damping: 0.5 N*m*s/rad
controllers:
  insertion:
    type: impedance
    environment: soft
    Mt: 0.01 kg*m^2
    Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}
switching: arbitrary
"""

FORCE = IMPEDANCE.partition("controllers:")[0] + (
    """\
controllers:
  position: {type: position}
  force:
    type: force
    environment: soft
    proportional_gain: 0.02 rad/(N*m)
switching: arbitrary
"""
)

SWITCHED = """\
kind: switched-system
name: sample
time: continuous
modes:
  - {name: a, A: [[-1, -1], [1, -1]]}
  - {name: b, A: [[-1, -6], ["1/6", -1]]}
switching: arbitrary
"""


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


def refusal(text: str) -> SpecError:
    """Return the error that a text must cause; its position lies in the text."""
    with pytest.raises(SpecError) as caught:
        parse_spec(text)
    assert_inside(caught.value, text)
    return caught.value


def assert_refused(text: str, said: str, at: str | None = None) -> None:
    """Check what is said of a faulty text, and that it is said where a piece first stands."""
    error = refusal(text)
    assert said in f"{error.message} ({error.remedy})"
    assert at is None or (error.line, error.column) == place_of(text, at)


def assert_among_faults(text: str, said: str, at: str) -> None:
    """Check what one of the faults says, and that one is in a line with a piece of text."""
    faults, lines = refusal(text).faults, text.splitlines()
    assert any(said in f"{fault.message}; {fault.remedy}" for fault in faults), faults
    assert any(at in lines[(fault.line or 0) - 1] for fault in faults), faults


def assert_inside(error: SpecError, text: str) -> None:
    """Check that the position of an error is one of the text's."""
    assert error.line is not None
    assert error.column is not None
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    assert 1 <= error.line <= len(lines)
    assert 1 <= error.column <= len(lines[error.line - 1]) + 1
    assert error.message
    assert error.remedy


def place_of(text: str, piece: str) -> tuple[int, int]:
    """Line and column at which a piece of text first stands."""
    before = text[: text.index(piece)]
    return before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1


def message_of(read: Callable[[], object]) -> str:
    """Message of the SpecError that a reader raises, or nothing; other errors pass through."""
    try:
        read()
    except SpecError as error:
        return error.message
    return ""
