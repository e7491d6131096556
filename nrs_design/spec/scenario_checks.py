"""Whether scenarios fit the rest of their spec: one table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from nrs_design.proof.text import quoted
from nrs_design.spec.check import Row, each
from nrs_design.spec.faults import Location
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec
from nrs_design.spec.references import NO_SUCH, Reference
from nrs_design.spec.scenarios import ScenarioSpec, SurfaceSpec


def _runs(spec: Spec) -> Iterator[tuple[Location, ScenarioSpec]]:
    for name, scenario in spec.scenarios.items():
        yield ("scenarios", name), scenario


def _names(spec: Spec) -> Iterator[tuple[Location, Reference]]:
    """Yield the environments and controllers that scenarios name."""
    for at, run in _runs(spec):
        for i, surface in enumerate(run.surfaces):
            at_surface = (*at, "surfaces", i)
            of_surface = {("environment",): surface.environment} | {
                ("beside", j): name for j, name in enumerate(surface.beside)
            }
            for key, name in of_surface.items():
                yield (*at_surface, *key), Reference("environment", name, spec.environments)
        if run.control is None:
            continue
        for place, name in run.control.named.items():
            yield (*at, "control", *place), Reference("controller", name, spec.controllers)
        for name in run.control.contact or ():
            place = (*at, "control", "contact", name)
            yield place, Reference("environment", name, spec.environments)


@dataclass(frozen=True, slots=True)
class _Surface:
    """One surface that a run meets."""

    spec: Spec
    run: ScenarioSpec
    it: SurfaceSpec

    @property
    def start(self) -> float:
        """Angle of the axis at first, in rad."""
        return 0.0 if self.run.start is None else self.run.start.si

    @property
    def depth(self) -> float:
        """How deep below the surface that is, in rad."""
        depth = self.start - self.it.at.si
        return depth if self.it.side == "above" else -depth

    def preloaded(self) -> str | None:
        """Return an environment of one body with others that is not linear."""
        names = (self.it.environment, *self.it.beside) if self.it.beside else ()
        laws = ((name, self.spec.environments.get(name)) for name in names)
        return next((name for name, law in laws if law is not None and law.preloaded), None)


def _surfaces(spec: Spec) -> Iterator[tuple[Location, _Surface]]:
    for at, run in _runs(spec):
        for i, surface in enumerate(run.surfaces):
            yield (*at, "surfaces", i), _Surface(spec, run, surface)


@dataclass(frozen=True, slots=True)
class _Velocity:
    """A velocity that is commanded, and the limit, in rad/s."""

    size: float
    limit: float
    text: str

    # The same number in another unit may be a rounding above.
    def is_beyond(self) -> bool:
        return self.size > self.limit * (1 + 1e-12)


def _velocities(spec: Spec) -> Iterator[tuple[Location, _Velocity]]:
    limit = spec.limits.velocity
    for at, run in _runs(spec):
        written: dict[Location, float] = {}
        command = run.command
        if command.constant is not None:
            written["constant",] = command.constant.si
        for i, (_, quantity) in enumerate(command.points or ()):
            written["points", i, 1] = quantity.si
        if command.sinusoid is not None:
            offset = 0.0 if command.sinusoid.offset is None else command.sinusoid.offset.si
            written["sinusoid",] = abs(offset) + command.sinusoid.amplitude.si
        for place, size in written.items():
            yield (*at, "command", *place), _Velocity(abs(size), limit.si, quoted(limit.text))


def _logic_of_runs(spec: Spec) -> Iterator[tuple[Location, bool]]:
    """Yield runs that the mode logic controls, with whether there is one."""
    there = spec.mode_logic is not None
    for at, run in _runs(spec):
        if run.control is not None and run.control.logic is not None:
            yield (*at, "control", "logic"), there


SCENARIO_CHECKS: tuple[Row[Spec], ...] = (
    *each(_names, NO_SUCH),
    *each(
        _surfaces,
        Row[_Surface](
            "",
            _Surface.preloaded,
            "{0} is not linear, and environments of one body are",
            "leave beside out, or name linear environments",
        ),
        Row[_Surface](
            "at",
            lambda x: x.depth > 0,
            "the axis rests inside {s.it.environment!r} at the start",
            "move the surface beyond {s.start:.6g} rad, or the start out of it",
        ),
    ),
    *each(
        _velocities,
        Row[_Velocity](
            "",
            _Velocity.is_beyond,
            "a velocity of {s.size:.6g} rad/s is beyond the limit of {s.text}",
            "command less, or raise limits.velocity",
        ),
    ),
    *each(
        _logic_of_runs,
        Row[bool](
            "",
            lambda there: not there,
            "the spec has no mode_logic",
            "add one, or control in another way",
        ),
    ),
)
