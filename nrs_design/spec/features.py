"""What an interaction design may have besides the plainest, each with how a spec is asked for it.

The plainest: impedance controllers on elastic tissue of one stiffness, touched one by one, one
axis, continuous time, contact kept, arbitrary switching.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from operator import attrgetter
from typing import NamedTuple, TypeVar

from nrs_design.axis import AxisType
from nrs_design.spec.check import Feature
from nrs_design.spec.controllers import ControllerSpec, contact_name, names_in, touched_in
from nrs_design.spec.environment import AbstractEnvironmentSpec
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec

T = TypeVar("T")


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
    """Yield what is touched, by name; a name that there is not is a fault of its own."""
    for name in sorted(spec.touched & spec.environments.keys()):
        yield ContactedEnvironment(name, spec.environments[name])


def _given(phrase: str, at: str, without: str) -> Feature[Spec]:
    """Return the feature that a field is given, by its keys; parts on the way may be missing."""
    first, _, rest = at.partition(".")

    def find(spec: Spec) -> bool:
        part = getattr(spec, first)
        return part is not None and (not rest or attrgetter(rest)(part) is not None)

    return Feature(phrase, at, without, find)


def _contacted(
    phrase: str,
    without: str,
    holds: Callable[[AbstractEnvironmentSpec], bool],
    at: str = "environments.{0.name}.model",
) -> Feature[Spec]:
    """Return the feature of the first such environment that a controller touches."""
    return Feature(
        phrase,
        at,
        without,
        lambda s: _first(item for item in contacted_environments(s) if holds(item.spec)),
    )


def _at_once(
    phrase: str, without: str, holds: Callable[[AbstractEnvironmentSpec], bool]
) -> Feature[Spec]:
    """Return the feature of the first such environment that is touched at once with others."""

    def find(spec: Spec) -> SimultaneousContact | None:
        for name, controller in spec.controllers.items():
            for contact in controller.contacts:
                for key in names_in(contact) if len(names_in(contact)) > 1 else ():
                    if key in spec.environments and holds(spec.environments[key]):
                        return SimultaneousContact(name, contact_name(contact), key)
        return None

    return Feature(phrase, "controllers.{0.controller}.contacts", without, find)


def _controller(
    phrase: str, key: str, without: str, holds: Callable[[ControllerSpec], object]
) -> Feature[Spec]:
    """Return the feature of the first such controller, at one of its keys."""
    return Feature(
        phrase,
        f"controllers.{{0}}{key}",
        without,
        lambda s: _first(name for name, c in s.controllers.items() if holds(c)),
    )


def _first(found: Iterable[T]) -> T | None:
    return next(iter(found), None)


def _bleeding(spec: Spec) -> str | None:
    """Return a controller with an integral that others leave to bleed."""
    all_alike = len({c.bleeds for c in spec.controllers.values()}) < 2
    return None if all_alike else _first(n for n, c in spec.controllers.items() if c.bleeds)


def _dwell(spec: Spec) -> str | None:
    """Return the key of a dwell time."""
    return _first(at[0] for at, _ in spec.switching.dwell_times())


def _sampled_dwell(spec: Spec) -> str | None:
    """Return it beside samples, where rules about single contacts are refused as such."""
    counted = spec.sampling is not None and not spec.switching.names_contacts
    return _dwell(spec) if counted else None


def _damped_force(spec: Spec) -> tuple[str, str] | None:
    """Return a controller of a force that takes the velocity, and the first such environment."""
    for name, controller in spec.controllers.items():
        laws = ((key, spec.environments.get(key)) for key in touched_in(controller.contacts))
        damped = (key for key, e in laws if e and not (e.is_spring or e.law.remembers))
        if controller.holds_force and (key := _first(damped)):
            return name, key
    return None


def _constants(spec: Spec) -> Iterator[tuple[str, ...]]:
    """Yield the ranges that are constant, by the keys that lead to them."""
    yield from (at for at, q in spec.ranges.items() if not (q.varies or q.fixed))
    yield from (at for at, times in spec.late_times.items() if times.is_constant)


# Every one of them is asked of an interaction design.
_F = Feature[Spec]
SAMPLED = _given("a sampled loop", "sampling", "leave sampling out")
CONTINUOUS = _F(
    "continuous time",
    "",
    "add `sampling: {{period: 2 ms, delay: 0}}`",
    lambda s: s.sampling is None,
)
TWO_PERIODS = _F(
    "an outer_period",
    "sampling.outer_period",
    "leave outer_period out",
    lambda s: s.sampling is not None and s.sampling.round > 1,
)
MISSES = _given("missed deadlines", "sampling.misses", "leave misses out")
ZEROED = _F(
    "a command of zero where a deadline is missed",
    "sampling.misses.command",
    "write `command: hold`",
    lambda s: (misses := s.sampling and s.sampling.misses) and misses.command == "zero",
)
TIMED = _F(
    "the {0[1]}",
    "{0[0]}.{0[1]}",
    "leave {0[1]} out; where it is the force that is old, write `delay`",
    lambda s: s.late_at,
)
LOSABLE = _F("loss of contact", "contact", "use `contact: kept`", lambda s: s.contact == "losable")
NOT_KEPT = _F(
    "contact that may be lost", "contact", "write `contact: kept`", lambda s: s.contact != "kept"
)
GIVEN_LOOP = _given(
    "a closed motion loop that the spec states",
    "motion_loop.transfer_function",
    "leave transfer_function out",
)
STREAMED = _F(
    "a {0}",
    "{0}",
    "write actuator and motion_loop",
    lambda s: _first(k for k in s.drives if s.followed),
)
VELOCITIES = _given(
    "a velocity_interface",
    "velocity_interface",
    "write position_interface, or actuator and motion_loop",
)
PLACED = _given("a position_interface", "position_interface", "write velocity_interface")
TORQUES = _given(
    "a torque_interface",
    "torque_interface",
    "write actuator and motion_loop, with controllers of type impedance",
)
MOTOR_RANGE = _F(
    "a range of the {0[1]} of the {0[0]}",
    "{0[0]}.{0[1]}",
    "give the nominal {0[1]} only",
    lambda s: _first(at for at, item in s.motor_ranges.items() if not item.fixed),
)
CONSTANT_TISSUE = _F(
    "the constant {0[2]} of {0[1]!r}",
    "environments.{0[1]}.{0[2]}.varies",
    "leave varies out of the {0[2]} of {0[1]}",
    lambda s: _first(at for at in _constants(s) if at[0] == "environments"),
)
CONSTANT_MOTOR = _F(
    "the constant {0[1]} of the {0[0]}",
    "{0[0]}.{0[1]}.varies",
    "leave varies out of {0[1]}",
    lambda s: _first(at for at in _constants(s) if at[0] != "environments"),
)
LOADED = _given("a load of the motor", "actuator.load_inertia", "leave load_inertia out")

HAND = _contacted(
    "{0.name!r}, a hand with a mass,",
    "use a kelvin-voigt environment, which has no mass",
    lambda e: e.law.has_mass,
)
MEMORY = _contacted(
    "{0.name!r}, which remembers,",
    "use elastic or kelvin-voigt environments",
    lambda e: e.law.remembers,
)
RESTLESS = _contacted(
    "{0.name!r}, which has no rest position,",
    "use another environment",
    lambda e: not e.law.has_rest,
)
PRELOADED = _contacted(
    "{0.name!r}, known within its preload only,",
    "use elastic or kelvin-voigt environments",
    lambda e: e.preloaded,
)
OTHER_TISSUE = _F(
    "several environments",
    "environments",
    "write a spec for each environment",
    lambda s: len(s.touched) > 1,
)
ANY_CONTACT = _controller(
    "{0!r}, which takes contact as it comes,", "", "leave {0} out", lambda c: not c.contacts
)
DAMPED = _contacted(
    "{0.name!r}, which has damping,", "use an elastic environment", lambda e: not e.is_spring
)
TISSUE_RANGE = _contacted(
    "the range of environment {0.name!r}",
    "give the environment its nominal values only",
    lambda e: not e.fixed,
    at="environments.{0.name}",
)
AT_ONCE = _controller(
    "several things that {0!r} touches at once",
    ".contacts",
    "let every contact be one environment",
    lambda c: any(not isinstance(contact, str) for contact in c.contacts),
)
HEAVY_AT_ONCE = _at_once(
    "{0.name!r}, which remembers or has a mass, touched at once with others",
    "use elastic or kelvin-voigt environments there",
    lambda e: e.law.remembers or e.law.has_mass,
)
LAGGING_AT_ONCE = _at_once(
    "{0.name!r} alone, which has damping or a preload, while {0.contact} are touched at once",
    "use elastic environments there",
    lambda e: not e.is_losable,
)
SEVERAL_CONTACTS = _F(
    "several contacts of {0!r}",
    "controllers.{0}.contacts",
    "write a spec for each environment",
    lambda s: (
        not s.switching.names_contacts
        and _first(name for name, c in s.controllers.items() if len(c.contacts) > 1)
    ),
)

OTHERS = _controller(
    "{0!r}, which is not of type impedance,",
    ".type",
    "use controllers of type impedance",
    lambda c: c.commands != "velocity" and not c.makes_torques,
)
DAMPED_FORCE = _F(
    "force control by {0[0]!r} in contact with {0[1]!r}, which has damping,",
    "controllers.{0[0]}",
    "use an elastic environment for force controllers",
    _damped_force,
)
SPRUNG = _controller("the spring Kt of {0}", ".Kt", "leave Kt out", lambda c: c.sprung)
RELAXED = _controller(
    "{0!r}, an impedance controller without a spring,",
    ".Kt",
    "give every impedance controller a spring Kt",
    lambda c: c.commands == "velocity" and not c.sprung,
)
BLEEDING = _F(
    "{0!r}, whose integral bleeds,", "controllers.{0}.type", "use one kind of controller", _bleeding
)
IDLE = _given("a mixture of controllers", "idle_states", "use one kind of controller")
IDLE_RESET = _F(
    "a reset of idle states",
    "idle_states.reset",
    "remove reset",
    lambda s: s.idle_states is not None and s.idle_states.reset,
)
OFFSET = _controller(
    "the offset of {0!r}",
    ".offset",
    "use `offset: none`",
    lambda c: c.own_offset not in (None, "none"),
)
FILTER = _given("a filter of the force", "sensor.filter", "leave filter out")
UNFILTERED = _F(
    "a force without a filter",
    "sensor.filter",
    "add `sensor: {{filter: {{cutoff: 30 Hz}}}}`",
    lambda s: not FILTER.find(s),
)

DISTURBED = _given("bounds under disturbances", "disturbances", "leave disturbances out")
COMMAND = _given("a velocity command", "disturbances.command", "leave command out")
ANGLE = _given("the rounding of angles", "disturbances.largest_angle", "leave largest_angle out")
RULES = _F(
    "rules of switching",
    "switching",
    "use `switching: arbitrary`, which allows for more",
    lambda s: not s.switching.is_arbitrary,
)
DWELL = _F(
    "a dwell time", "switching.{0}", "leave {0} out", lambda s: s.sampling is None and _dwell(s)
)
SAMPLED_DWELL = _F("a dwell time", "switching.{0}", "leave {0} out", _sampled_dwell)
LONGEST_STAY = _F(
    "a longest dwell time",
    "switching.longest_dwell_time",
    "leave longest_dwell_time out",
    lambda s: bool(_sampled_dwell(s)) and s.switching.longest_dwell_time is not None,
)
CONTACT_RULES = _F(
    "rules of switching about controllers in one contact each",
    "switching",
    "name controllers alone in the rules",
    lambda s: s.switching.names_contacts,
)
SATURATED = _given("decay although signals saturate", "goals.initial_force", "remove the goal")

SLIDING = _F(
    "a prismatic axis", "axis", "write `axis: rotary`", lambda s: s.axis is AxisType.PRISMATIC
)
LIMITED = _given(
    "a largest command of a motor", "limits.command", "leave command out of the limits"
)
MODE_LOGIC = _given("mode_logic", "mode_logic", "leave mode_logic out")
