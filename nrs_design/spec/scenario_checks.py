"""Whether scenarios fit the rest of their spec: one table."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.proof.text import quoted
from nrs_design.spec.check import NO_SUCH, Reference, Row, each, refuse
from nrs_design.spec.faults import Location
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec
from nrs_design.spec.scenarios import ScenarioSpec, SurfaceSpec


def _names(spec: Spec) -> Iterator[tuple[Location, Reference]]:
    """Yield the environments and controllers that scenarios name."""
    for at, _, surface in _surfaces(spec):
        yield (*at, "environment"), Reference("environment", surface.environment, spec.environments)
        for j, name in enumerate(surface.beside):
            yield (*at, "beside", j), Reference("environment", name, spec.environments)
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


def _preloaded(spec: Spec) -> Iterator[tuple[Location, str]]:
    """Yield an environment of one body with others that is not linear."""
    for at, _, surface in _surfaces(spec):
        names = (surface.environment, *surface.beside) if surface.beside else ()
        laws = ((name, spec.environments.get(name)) for name in names)
        if found := next((name for name, law in laws if law is not None and law.preloaded), None):
            yield at, found


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
    """Yield runs that the mode logic controls, where there is none."""
    for at, run in _runs(spec):
        if run.control is not None and run.control.logic is not None:
            yield (*at, "control", "logic"), spec.mode_logic is None


SCENARIO_CHECKS: tuple[Row[Spec], ...] = (
    *each(_names, NO_SUCH),
    refuse(
        _preloaded,
        "{0} is not linear, and environments of one body are",
        "leave beside out, or name linear environments",
    ),
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
