"""Whether scenarios fit the rest of their spec: one table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from nrs_design.proof.text import quoted
from nrs_design.spec.check import Row, each
from nrs_design.spec.faults import Location
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec
from nrs_design.spec.references import NO_SUCH, Reference
from nrs_design.spec.scenarios import AXES, ScenarioSpec, SurfaceSpec


def _axis_of_another(spec: Spec) -> tuple[str, str] | None:
    """Return a scenario that is called as one axis of another, ``NAME.theta1``."""
    for name in spec.scenarios:
        whole, _, axis = name.rpartition(".")
        if axis in AXES and whole in spec.scenarios and spec.scenarios[whole].axes is not None:
            return name, whole
    return None


def _of_three_axes(spec: Spec) -> Iterator[tuple[Location, ScenarioSpec]]:
    for name, scenario in spec.scenarios.items():
        if scenario.axes is not None:
            yield ("scenarios", name), scenario


def _axes(spec: Spec) -> Iterator[tuple[Location, ScenarioSpec]]:
    """Yield what each axis does by itself."""
    for name, scenario in spec.scenarios.items():
        if scenario.axes is None:
            yield ("scenarios", name), scenario
        else:
            for axis in AXES:
                yield ("scenarios", name, "axes", axis), scenario.of_axis(axis)


def _names(spec: Spec) -> Iterator[tuple[Location, Reference]]:
    """Yield the environments and controllers that scenarios name."""
    for at, axis in _axes(spec):
        for i, surface in enumerate(axis.surfaces):
            at_surface = (*at, "surfaces", i)
            of_surface = {("environment",): surface.environment} | {
                ("beside", j): name for j, name in enumerate(surface.beside)
            }
            for key, name in of_surface.items():
                yield (*at_surface, *key), Reference("environment", name, spec.environments)
        if axis.control is None:
            continue
        for place, name in axis.control.named.items():
            yield (*at, "control", *place), Reference("controller", name, spec.controllers)
        for name in axis.control.contact or ():
            place = (*at, "control", "contact", name)
            yield place, Reference("environment", name, spec.environments)


@dataclass(frozen=True, slots=True)
class _Surface:
    """One surface that an axis meets."""

    spec: Spec
    axis: ScenarioSpec
    it: SurfaceSpec

    @property
    def start(self) -> float:
        """Angle of the axis at first, in rad."""
        return 0.0 if self.axis.start is None else self.axis.start.si

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
    for at, axis in _axes(spec):
        for i, surface in enumerate(axis.surfaces):
            yield (*at, "surfaces", i), _Surface(spec, axis, surface)


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
    for at, axis in _axes(spec):
        written: dict[Location, float] = {}
        command = axis.command
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
    for at, axis in _axes(spec):
        if axis.control is not None and axis.control.logic is not None:
            yield (*at, "control", "logic"), there


SCENARIO_CHECKS: tuple[Row[Spec], ...] = (
    Row(
        "scenarios.{0}",
        _axis_of_another,
        "{0!r} is the name of a run of {1!r}",
        "give it another name",
    ),
    Row(
        "scenarios.{0}.axes",
        lambda s: (
            (s.coupling is None or s.coupling.robot is None)
            and next((name for name, run in s.scenarios.items() if run.axes is not None), None)
        ),
        "three axes move on the links of a robot, and the spec names none",
        "add `coupling: {{robot: arm.nrs.yaml}}`, or remove axes",
    ),
    *each(
        _of_three_axes,
        Row[ScenarioSpec](
            "start",
            lambda run: run.start is not None,
            "three axes begin in a pose",
            "write axes: {{pose: ...}}",
        ),
    ),
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
