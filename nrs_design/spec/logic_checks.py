"""Whether a mode logic fits its spec, and keeps the rules of switching: one table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from nrs_design.spec.check import Row, each
from nrs_design.spec.faults import Location
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec
from nrs_design.spec.references import NO_SUCH, Reference
from nrs_design.spec.switching import DwellTime, SwitchingSpec, Transition

_REMEDY = "write `switching: mode-logic`, or rules that it keeps"


@dataclass(frozen=True, slots=True)
class _Stay:
    """How long the rules keep a controller, and how long the logic does."""

    name: str
    rules: tuple[DwellTime | None, DwellTime | None]
    logic: tuple[DwellTime | None, DwellTime | None]

    def too_short(self) -> tuple[str, str] | None:
        """For how long the logic keeps it, and what the rules say, if that is more."""
        shortest, least = self.rules[0], self.logic[0]
        if shortest is None or (least is not None and least.value >= shortest.value):
            return None
        return "no time" if least is None else least.text, shortest.text

    def too_long(self) -> str | None:
        """When the rules say that it is left: thresholds leave it at no certain time."""
        longest = self.rules[1]
        return None if longest is None else longest.text


def _kept(spec: Spec) -> SwitchingSpec:
    """Return the rules that the mode logic keeps; none without one, or where it does not fit."""
    if spec.mode_logic is None or spec.mode_logic.lost_names(spec.controllers):
        return SwitchingSpec()
    return spec.mode_logic.rules()


def _about_others(spec: Spec) -> bool:
    rules = spec.switching
    differ = rules.names_contacts != _kept(spec).names_contacts
    return spec.mode_logic is not None and differ and not rules.is_arbitrary


def _names(spec: Spec) -> Iterator[tuple[Location, Reference]]:
    names = () if spec.mode_logic is None else spec.mode_logic.lost_names(spec.controllers)
    for name in names:
        yield ("mode_logic",), Reference("controller", name, spec.controllers)


def _stays(spec: Spec) -> Iterator[tuple[Location, _Stay]]:
    kept = _kept(spec)
    if not _about_others(spec):
        for name in dict.fromkeys(end for pair in kept.transitions or () for end in pair):
            yield ("switching",), _Stay(name, spec.switching.stay(name), kept.stay(name))


def _forbidden(spec: Spec) -> Transition | None:
    """Return a switch that the logic may make, and the rules do not allow."""
    allowed, pairs = spec.switching.transitions, _kept(spec).transitions or ()
    if allowed is None or _about_others(spec):
        return None
    return next((pair for pair in pairs if pair not in allowed), None)


LOGIC_CHECKS: tuple[Row[Spec], ...] = (
    *each(_names, NO_SUCH),
    Row(
        "switching",
        _about_others,
        "the rules are not about what the mode logic decides",
        _REMEDY,
    ),
    *each(
        _stays,
        Row[_Stay](
            "dwell_time",
            _Stay.too_short,
            "the mode logic keeps {s.name} for {0}, the rules say {1}",
            f"{_REMEDY}; a `hold` in mode_logic keeps it longer",
        ),
        Row[_Stay](
            "longest_dwell_time",
            _Stay.too_long,
            "the mode logic leaves {s.name} at no certain time, the rules say {0}",
            _REMEDY,
        ),
    ),
    Row(
        "switching.transitions",
        _forbidden,
        "the mode logic may switch from {0} to {1}, the rules do not allow it",
        _REMEDY,
    ),
)
