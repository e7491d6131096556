"""Two tables of checks that mode logic and scenarios fit the rest of their spec."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.proof.text import quoted
from nrs_design.spec.check import NO_SUCH, Reference, Row, each, refuse
from nrs_design.spec.faults import Location
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec
from nrs_design.spec.scenarios import ScenarioSpec, SurfaceSpec
from nrs_design.spec.switching import DwellTime, SwitchingSpec, Transition

_Times = tuple[DwellTime | None, DwellTime | None]
_REMEDY = "write `switching: mode-logic`, or rules that it keeps"


def _names(spec: Spec) -> Iterator[tuple[Location, Reference]]:
    """Yield the environments and controllers that mode logic and scenarios name."""
    for name in () if spec.mode_logic is None else spec.mode_logic.controllers:
        yield ("mode_logic",), Reference("controller", name, spec.controllers)
    for at, _, surface in _surfaces(spec):
        yield (*at, "environment"), Reference("environment", surface.environment, spec.environments)
    for at, run in _runs(spec):
        if run.control is None:
            continue
        for place, name in run.control.named.items():
            yield (*at, "control", *place), Reference("controller", name, spec.controllers)
        for name in run.control.contact or ():
            place = (*at, "control", "contact", name)
            yield place, Reference("environment", name, spec.environments)


def _runs(spec: Spec) -> Iterator[tuple[Location, ScenarioSpec]]:
    return ((("scenarios", name), run) for name, run in spec.scenarios.items())


def _surfaces(spec: Spec) -> Iterator[tuple[Location, ScenarioSpec, SurfaceSpec]]:
    for at, run in _runs(spec):
        for i, surface in enumerate(run.surfaces):
            yield (*at, "surfaces", i), run, surface


def _inside(spec: Spec) -> Iterator[tuple[Location, tuple[str, float]]]:
    """Yield what a run begins within, and where, in rad."""
    for at, run, surface in _surfaces(spec):
        start = 0.0 if run.start is None else run.start.si
        depth = start - surface.at.si
        if (depth if surface.side == "above" else -depth) > 0:
            yield (*at, "at"), (surface.environment, start)


def _too_fast(spec: Spec) -> Iterator[tuple[Location, tuple[float, str]]]:
    """Yield velocities in rad/s that are commanded beyond the limit, and that."""
    limit = spec.limits.velocity
    for at, run in _runs(spec):
        written: dict[Location, float] = {}
        command = run.command
        if command.constant is not None:
            written["constant",] = abs(command.constant.si)
        for i, (_, quantity) in enumerate(command.points or ()):
            written["points", i, 1] = abs(quantity.si)
        if command.sinusoid is not None:
            offset = 0.0 if command.sinusoid.offset is None else command.sinusoid.offset.si
            written["sinusoid",] = abs(offset) + command.sinusoid.amplitude.si
        for place, size in written.items():
            # The same number in another unit may be a rounding above.
            if size > limit.si * (1 + 1e-12):
                yield (*at, "command", *place), (size, quoted(limit.text))


def _without_logic(spec: Spec) -> Iterator[tuple[Location, bool]]:
    """Yield runs under the mode logic in a spec without mode logic."""
    for at, run in _runs(spec):
        if run.control is not None and run.control.logic is not None:
            yield (*at, "control", "logic"), spec.mode_logic is None


SCENARIO_CHECKS: tuple[Row[Spec], ...] = (
    *each(_names, NO_SUCH),
    refuse(
        _inside,
        "the axis rests inside {0!r} at the start",
        "move the surface beyond {1:.6g} rad, or the start out of it",
    ),
    refuse(
        _too_fast,
        "a velocity of {0:.6g} rad/s is beyond the limit of {1}",
        "command less, or raise limits.velocity",
    ),
    refuse(_without_logic, "the spec has no mode_logic", "add one, or control in another way"),
)


def _kept(spec: Spec) -> SwitchingSpec:
    """Return the rules that the mode logic keeps; none without mode logic, or if it is faulty."""
    logic = spec.mode_logic
    fits = logic is not None and spec.controllers.keys() >= {*logic.controllers}
    return logic.rules() if logic is not None and fits else SwitchingSpec()


def _about_others(spec: Spec) -> bool:
    rules = spec.switching
    differ = rules.names_contacts != _kept(spec).names_contacts
    return spec.mode_logic is not None and differ and not rules.is_arbitrary


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
