"""Whether a mode logic fits its spec, and keeps the rules of switching: one table."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.spec.check import NO_SUCH, Reference, Row, each, refuse
from nrs_design.spec.faults import Location
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec
from nrs_design.spec.switching import DwellTime, SwitchingSpec, Transition

_Times = tuple[DwellTime | None, DwellTime | None]
_REMEDY = "write `switching: mode-logic`, or rules that it keeps"


def _kept(spec: Spec) -> SwitchingSpec:
    """Return the rules that the mode logic keeps; none without one, or where it does not fit."""
    logic = spec.mode_logic
    fits = logic is not None and spec.controllers.keys() >= {*logic.controllers}
    return logic.rules() if logic is not None and fits else SwitchingSpec()


def _about_others(spec: Spec) -> bool:
    rules = spec.switching
    differ = rules.names_contacts != _kept(spec).names_contacts
    return spec.mode_logic is not None and differ and not rules.is_arbitrary


def _names(spec: Spec) -> Iterator[tuple[Location, Reference]]:
    for name in () if spec.mode_logic is None else spec.mode_logic.controllers:
        yield ("mode_logic",), Reference("controller", name, spec.controllers)


def _stays(spec: Spec) -> Iterator[tuple[str, _Times, _Times]]:
    """Yield how long the rules keep each controller, and how long the logic does."""
    kept = _kept(spec)
    if not _about_others(spec):
        for name in dict.fromkeys(end for pair in kept.transitions or () for end in pair):
            yield name, spec.switching.stay(name), kept.stay(name)


def _too_short(spec: Spec) -> Iterator[tuple[Location, tuple[str, str, str]]]:
    for name, (shortest, _), (least, _) in _stays(spec):
        if shortest is not None and (least is None or least.value < shortest.value):
            found = name, "no time" if least is None else least.text, shortest.text
            yield ("switching", "dwell_time"), found


def _too_long(spec: Spec) -> Iterator[tuple[Location, tuple[str, str]]]:
    """Yield what the rules say to be left, as thresholds leave it at no certain time."""
    for name, (_, longest), _ in _stays(spec):
        if longest is not None:
            yield ("switching", "longest_dwell_time"), (name, longest.text)


def _forbidden(spec: Spec) -> Iterator[Transition]:
    """Yield switches that the logic may make, and the rules do not allow."""
    allowed = None if _about_others(spec) else spec.switching.transitions
    pairs = _kept(spec).transitions or ()
    return (pair for pair in pairs if allowed is not None and pair not in allowed)


LOGIC_CHECKS: tuple[Row[Spec], ...] = (
    *each(_names, NO_SUCH),
    Row("switching", _about_others, "the rules are not about what the mode logic decides", _REMEDY),
    refuse(
        _too_short,
        "the mode logic keeps {0} for {1}, the rules say {2}",
        f"{_REMEDY}; a `hold` in mode_logic keeps it longer",
    ),
    refuse(_too_long, "the mode logic leaves {0} at no certain time, the rules say {1}", _REMEDY),
    Row(
        "switching.transitions",
        _forbidden,
        "the mode logic may switch from {0} to {1}, the rules do not allow it",
        _REMEDY,
    ),
)
