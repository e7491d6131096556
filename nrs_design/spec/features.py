"""Features of an interaction design, each with the test that finds it in a spec.

The plainest: impedance controllers on elastic tissue of one stiffness, touched one by one, one
axis, continuous time, contact kept, arbitrary switching.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple, TypeVar

from nrs_design.models.axis import AxisType
from nrs_design.spec.check import Feature
from nrs_design.spec.controllers import ControllerSpec, contact_name, names_in, touched_in
from nrs_design.spec.environment import AbstractEnvironmentSpec
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec

T = TypeVar("T")
# Texts of the features, and which are not modelled together.
TABLE = tomllib.loads(Path(__file__).with_name("combinations.toml").read_text(encoding="utf-8"))


class ContactedEnvironment(NamedTuple):
    """An environment that a controller touches."""

    name: str
    spec: AbstractEnvironmentSpec


class SimultaneousContact(NamedTuple):
    """One of several environments that a controller touches at once."""

    controller: str
    contact: str
    name: str


def contacted_environments(spec: Spec) -> Iterator[ContactedEnvironment]:
    """Yield the touched environments by name; an unknown name is another fault."""
    for name in sorted(spec.touched & spec.environments.keys()):
        yield ContactedEnvironment(name, spec.environments[name])


def _named(name: str, find: Callable[[Spec], object]) -> Feature[Spec]:
    """Return a feature with the texts that it has in the table."""
    phrase, at, without = TABLE["features"][name]
    return Feature(phrase, at, without, find)


def _given(name: str, value: object = None) -> Feature[Spec]:
    """Return the feature that a field is given, or has one value; parts above may be missing."""
    _, at, _ = TABLE["features"][name]

    def find(spec: Spec) -> bool:
        part: object = spec
        for key in at.split("."):
            part = getattr(part, key, None)
        return part is not None if value is None else part == value

    return _named(name, find)


def _contacted(name: str, holds: Callable[[AbstractEnvironmentSpec], bool]) -> Feature[Spec]:
    """Return the feature of the first such environment that a controller touches."""
    return _named(
        name, lambda s: _first(item for item in contacted_environments(s) if holds(item.spec))
    )


def _at_once(name: str, holds: Callable[[AbstractEnvironmentSpec], bool]) -> Feature[Spec]:
    """Return the feature of the first such environment that is touched at once with others."""

    def find(spec: Spec) -> SimultaneousContact | None:
        for controller, its in spec.controllers.items():
            for contact in its.contacts:
                for key in names_in(contact) if len(names_in(contact)) > 1 else ():
                    if key in spec.environments and holds(spec.environments[key]):
                        return SimultaneousContact(controller, contact_name(contact), key)
        return None

    return _named(name, find)


def _controller(name: str, holds: Callable[[ControllerSpec], object]) -> Feature[Spec]:
    """Return the feature of the first such controller."""
    return _named(name, lambda s: _first(key for key, c in s.controllers.items() if holds(c)))


def _first(found: Iterable[T]) -> T | None:
    return next(iter(found), None)


def _bleeding(spec: Spec) -> str | None:
    """Return a controller whose integral bleeds while others are active."""
    all_alike = len({c.is_leaky for c in spec.controllers.values()}) < 2
    return None if all_alike else _first(n for n, c in spec.controllers.items() if c.is_leaky)


def _dwell(spec: Spec) -> str | None:
    """Return the key of a dwell time."""
    return _first(at[0] for at, _ in spec.switching.dwell_times())


def _sampled_dwell(spec: Spec) -> str | None:
    """Return the key of a dwell time of a sampled spec whose rules name no contacts."""
    counted = spec.sampling is not None and not spec.switching.names_contacts
    return _dwell(spec) if counted else None


def _damped_force(spec: Spec) -> tuple[str, str] | None:
    """Return a controller of a force that takes the velocity, and the first such environment."""
    for name, controller in spec.controllers.items():
        laws = ((key, spec.environments.get(key)) for key in touched_in(controller.contacts))
        damped = (key for key, e in laws if e and not (e.is_spring or e.law.has_memory))
        if controller.holds_force and (key := _first(damped)):
            return name, key
    return None


def _constants(spec: Spec) -> Iterator[tuple[str, ...]]:
    """Yield the ranges that are constant, by the keys that lead to them."""
    yield from (at for at, q in spec.ranges.items() if not (q.varies or q.fixed))
    yield from (at for at, times in spec.late_times.items() if times.is_constant)


SAMPLED = _given("SAMPLED")
CONTINUOUS = _named("CONTINUOUS", lambda s: s.sampling is None)
TWO_PERIODS = _named("TWO_PERIODS", lambda s: s.sampling is not None and s.sampling.round > 1)
MISSES = _given("MISSES")
ZEROED = _given("ZEROED", "zero")
TIMED = _named("TIMED", lambda s: s.late_at)
LOSABLE = _given("LOSABLE", "losable")
NOT_KEPT = _named("NOT_KEPT", lambda s: s.contact != "kept")
GIVEN_LOOP = _given("GIVEN_LOOP")
STREAMED = _named("STREAMED", lambda s: _first(k for k in s.drives if s.followed))
VELOCITIES = _given("VELOCITIES")
PLACED = _given("PLACED")
TORQUES = _given("TORQUES")
MOTOR_RANGE = _named(
    "MOTOR_RANGE", lambda s: _first(at for at, item in s.motor_ranges.items() if not item.fixed)
)
CONSTANT_TISSUE = _named(
    "CONSTANT_TISSUE", lambda s: _first(at for at in _constants(s) if at[0] == "environments")
)
CONSTANT_MOTOR = _named(
    "CONSTANT_MOTOR", lambda s: _first(at for at in _constants(s) if at[0] != "environments")
)
LOADED = _given("LOADED")

HAND = _contacted("HAND", lambda e: e.law.has_mass)
MEMORY = _contacted("MEMORY", lambda e: e.law.has_memory)
RESTLESS = _contacted("RESTLESS", lambda e: not e.law.has_rest)
PRELOADED = _contacted("PRELOADED", lambda e: e.preloaded)
OTHER_TISSUE = _named("OTHER_TISSUE", lambda s: len(s.touched) > 1)
ANY_CONTACT = _controller("ANY_CONTACT", lambda c: not c.contacts)
DAMPED = _contacted("DAMPED", lambda e: not e.is_spring)
TISSUE_RANGE = _contacted("TISSUE_RANGE", lambda e: not e.fixed)
AT_ONCE = _controller(
    "AT_ONCE", lambda c: any(not isinstance(contact, str) for contact in c.contacts)
)
HEAVY_AT_ONCE = _at_once("HEAVY_AT_ONCE", lambda e: e.law.has_memory or e.law.has_mass)
LAGGING_AT_ONCE = _at_once("LAGGING_AT_ONCE", lambda e: not e.is_losable)
SEVERAL_CONTACTS = _named(
    "SEVERAL_CONTACTS",
    lambda s: (
        not s.switching.names_contacts
        and _first(name for name, c in s.controllers.items() if len(c.contacts) > 1)
    ),
)

OTHERS = _controller("OTHERS", lambda c: c.commands != "velocity" and not c.makes_torques)
DAMPED_FORCE = _named("DAMPED_FORCE", _damped_force)
SPRUNG = _controller("SPRUNG", lambda c: c.sprung)
RELAXED = _controller("RELAXED", lambda c: c.commands == "velocity" and not c.sprung)
BLEEDING = _named("BLEEDING", _bleeding)
IDLE = _given("IDLE")
IDLE_RESET = _given("IDLE_RESET", True)
OFFSET = _controller("OFFSET", lambda c: c.own_offset not in (None, "none"))
FILTER = _given("FILTER")
UNFILTERED = _named("UNFILTERED", lambda s: not FILTER.find(s))

DISTURBED = _given("DISTURBED")
COMMAND = _given("COMMAND")
ANGLE = _given("ANGLE")
RULES = _named("RULES", lambda s: not s.switching.is_arbitrary)
DWELL = _named("DWELL", lambda s: s.sampling is None and _dwell(s))
SAMPLED_DWELL = _named("SAMPLED_DWELL", _sampled_dwell)
LONGEST_STAY = _named(
    "LONGEST_STAY", lambda s: bool(_sampled_dwell(s)) and s.switching.longest_dwell_time is not None
)
CONTACT_RULES = _named("CONTACT_RULES", lambda s: s.switching.names_contacts)
SATURATED = _given("SATURATED")

SLIDING = _given("SLIDING", AxisType.PRISMATIC)
LIMITED = _given("LIMITED")
MODE_LOGIC = _given("MODE_LOGIC")
