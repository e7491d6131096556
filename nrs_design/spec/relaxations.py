"""Relaxations of single lines of a spec, after which less has to be proved.

Every change is one that a person could write into the file: an end of a range nearer to the nominal
value, a shorter delay, a dwell time, a key left out. Whether the result is a valid spec is for
`nrs_design.spec.load.respecified` to say.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import ceil, floor, log2

from nrs_design.proof.text import counted, exact_text
from nrs_design.spec.document import Data, Node, to_data
from nrs_design.spec.edits import Edit, Keys, in_one_line, node_at
from nrs_design.spec.exact import parse_exact
from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.load import LoadedSpec
from nrs_design.spec.parameters import ParameterSpec
from nrs_design.spec.quantity_fields import RangedQuantity
from nrs_design.spec.switched_system import SwitchedSystemSpec
from nrs_design.spec.switching import LONGEST_DWELL
from nrs_design.spec.units import parse_unit

# Steps from the nominal value to an end of a range: six halvings.
PARTS = 64
# Number of steps from the longest tried dwell time down to the shortest, and per factor of two.
DWELLS = 256
PER_OCTAVE = 16
# Least ratio of the longest tried dwell time to the time constant of the slowest mode, up to
# LONGEST_DWELL. With a declared dwell time: ratio to this time, which is step LONGER.
TIMES = 64
LONGER = PER_OCTAVE * 6
DWELL_DIGITS = 3
MOST_STEPS = 32
UP, DOWN, WITHIN, WITH, WITHOUT = "up to", "down to", "within", "with", "without"

# Factors by which the damping of all controllers rises and their force gains fall; mildest first.
CALMER = ((2, 1), (1, 2), (2, 2), (4, 2), (2, 4), (4, 4))
GIVEN_GAINS = ("Bt", "proportional_gain", "integral_gain")


@dataclass(frozen=True, slots=True)
class RelaxationSteps:
    """Graded relaxation of a spec line: step 0 is weakest, step `size` is the declared value."""

    word: str  # Before what is proved: up to, down to, within, with, without
    value_at: Callable[[int], Data | None]  # Value in the spec at a step; None: the key is removed
    label_at: Callable[[int], str]  # Text of the relaxed value
    requested: str  # Text of the declared value
    size: int = 0  # Where nothing lies between, 0


@dataclass(frozen=True, slots=True)
class SpecRelaxation:
    """A line of a spec, and its possible relaxations."""

    at: Keys  # The place
    weakest: RelaxationSteps  # Its step 0 is the weakest
    # Ask for more than that at 0 already; the first one that is proved there is looked at further.
    alternatives: tuple[RelaxationSteps, ...] = ()
    # True: a proof holds for another loop or needs more assumptions. False: a proof covers a part
    # of the declared requirement.
    changes_model: bool = False

    def edit(self, form: RelaxationSteps, step: int) -> Edit:
        """Return what is written at a step."""
        return self.at, form.value_at(step)


def iterate_relaxations(loaded: LoadedSpec, slowest: float | None) -> Iterator[SpecRelaxation]:
    """Yield the relaxations of single lines of a spec, the mildest first.

    `slowest` is the decay rate of the slowest mode in 1/s: it says which dwell times are tried.
    """
    spec, root = loaded.spec, loaded.root
    if isinstance(spec, SwitchedSystemSpec):
        for name in spec.parameters:
            yield from _range(root, ("parameters", name))
        yield from _constants({("parameters", name): p for name, p in spec.parameters.items()})
        yield from _dwell(spec.switching.is_arbitrary, root, slowest, spec.time == "discrete")
        yield from _single(("modes",), len(spec.modes))
    elif isinstance(spec, InteractionDesignSpec):
        yield from _of_interaction(spec, root, slowest)


def _constants(
    ranges: Mapping[tuple[str, ...], ParameterSpec | RangedQuantity],
) -> Iterator[SpecRelaxation]:
    """Yield ranges whose number could be a constant."""
    for at, written in ranges.items():
        if written.varies and not written.fixed:
            yield _with((*at, "varies"), "false", "true")


def _single(at: Keys, count: int) -> Iterator[SpecRelaxation]:
    """Yield the items of a list, where there are several."""
    return (_without((*at, index)) for index in range(count if count > 1 else 0))


def _of_interaction(
    spec: InteractionDesignSpec, root: Node, slowest: float | None
) -> Iterator[SpecRelaxation]:
    for name in sorted(spec.touched):
        for key in ("exponent", *spec.environments[name].ranges):
            yield from _range(root, ("environments", name, key))
    for at in spec.motor_ranges:
        yield from _range(root, at)
    yield from _constants(spec.ranges)
    if spec.sampling is not None:
        yield from _delay(*spec.sampling.delay)
        yield from _times(root, ("sampling", "latency"))
        if spec.sampling.jitter is not None:
            yield _without(("sampling", "jitter"), changes_model=True)
    for drive in spec.drives:
        yield from _times(root, (drive, "dead_time"))
    if spec.contact == "losable":
        yield _with(("contact",), "kept", "losable")
    if spec.sampling is None:
        yield from _dwell(spec.switching.is_arbitrary, root, slowest, discrete=False)
    yield from _left_out(spec)


def calmer(loaded: LoadedSpec, more: int, less: int) -> tuple[SpecRelaxation, ...]:
    """Return the given gains of a spec with the damping multiplied and the other gains reduced.

    They are changed together: one controller alone seldom keeps the others from being proved.
    """
    less_force = Fraction(1, less)
    factors = dict(zip(GIVEN_GAINS, (Fraction(more), less_force, less_force), strict=True))
    root = loaded.root
    controllers = _said(root, ("controllers",))
    if not isinstance(loaded.spec, InteractionDesignSpec) or not isinstance(controllers, dict):
        return ()
    places = (("controllers", name, key) for name in controllers for key in factors)
    given = {at: said for at in places if (said := _said(root, at)) is not None}
    return tuple(
        _with(at, _scaled(said, factors[at[-1]]), in_one_line(said), changes_model=True)
        for at, said in given.items()
        if factors[at[-1]] != 1
    )


def _scaled(given: Data, factor: Fraction) -> Data:
    """Multiply a quantity, or both bounds of one."""
    if isinstance(given, dict):
        return {key: _scaled(value, factor) for key, value in given.items()}
    assert isinstance(given, str), "a gain is a quantity or has bounds"
    return " ".join((exact_text(_number(given) * factor), *given.split(" ", 1)[1:]))


def _left_out(spec: InteractionDesignSpec) -> Iterator[SpecRelaxation]:
    """Yield the parts that may be removed as a whole."""
    for name, controller in spec.controllers.items():
        yield from _single(("controllers", name, "contacts"), len(controller.contacts))
    if len(spec.controllers) > 1:
        for name in spec.controllers:
            yield _without(("controllers", name))
    if spec.disturbances is not None:
        yield _without(("disturbances",))
    if spec.idle_states is not None and spec.idle_states.reset:
        yield _without(("idle_states", "reset"), changes_model=True)
    if spec.sensor is not None and spec.sensor.filter is not None:
        # A sensor that declares only a filter is removed as a whole.
        alone = spec.sensor.model_fields_set == {"filter"}
        yield _without(("sensor",) if alone else ("sensor", "filter"), changes_model=True)
    for key in ("outer_period", "misses"):
        if getattr(spec.sampling, key, None) is not None:
            yield _without(("sampling", key), changes_model=key == "outer_period")


def _with(at: Keys, said: Data, asked: str, *, changes_model: bool = False) -> SpecRelaxation:
    way = RelaxationSteps(WITH, lambda _: said, lambda _: in_one_line(said), asked)
    return SpecRelaxation(at, way, changes_model=changes_model)


def _without(at: Keys, *, changes_model: bool = False) -> SpecRelaxation:
    form = RelaxationSteps(WITHOUT, lambda _: None, lambda _: "", "")
    return SpecRelaxation(at, form, changes_model=changes_model)


def _range(root: Node, at: Keys) -> Iterator[SpecRelaxation]:
    """Yield the range of a quantity, if one is written; the center is its nominal value."""
    part = _said(root, at)
    if not isinstance(part, dict) or not isinstance(part.get("range"), tuple):
        return
    low, high = map(str, part["range"])
    middle = str(part.get("nominal", ""))
    if not middle or _number(low) >= _number(high, low):
        return
    others: tuple[RelaxationSteps, ...] = ()
    if _number(low, middle) < _number(middle) < _number(high, middle):
        others = (
            _widening(UP, (low, middle), (low, high)),
            _widening(DOWN, (middle, high), (low, high)),
        )
    yield SpecRelaxation((*at, "range"), _widening(WITHIN, (middle, middle), (low, high)), others)


def _widening(word: str, least: tuple[str, str], ends: tuple[str, str]) -> RelaxationSteps:
    """Return the steps from a narrow range to a wide one, named by the end that moves."""

    def value(step: int) -> tuple[str, str]:
        low, high = (_between(*way, step) for way in zip(least, ends, strict=True))
        return low, high

    def label(said: tuple[str, str]) -> str:
        return in_one_line(said) if word == WITHIN else said[word == UP]

    return RelaxationSteps(word, value, lambda k: label(value(k)), label(ends), PARTS)


def _between(middle: str, end: str, step: int) -> str:
    """Return a decimal not beyond so many parts of the way from the center to an end."""
    if step == PARTS:
        return end
    center, last = _number(middle, end), _number(end)
    way = last - center
    if not step or not way:
        return middle
    number = center + way * step / PARTS
    # A unit of the last digit is no more than a tenth of a step.
    unit = Fraction(10) ** _exponent(abs(way) / (10 * PARTS))
    rounded = (floor(number / unit) if way > 0 else ceil(number / unit)) * unit
    if (rounded - center) * way <= 0:
        return middle
    return " ".join((exact_text(rounded), *end.split(" ", 1)[1:]))


def _exponent(number: Fraction) -> int:
    """Return the largest n with ``10**n <= number``."""
    n = len(str(number.numerator)) - len(str(number.denominator))
    return n if Fraction(10) ** n <= number else n - 1


def _number(text: str, unit_of: str = "") -> Fraction:
    """Return the number of a quantity, in the unit of another one if that is named."""
    number, _, unit = text.partition(" ")
    value = parse_exact(number)
    other = unit_of.partition(" ")[2]
    if not unit or not other or unit.strip() == other.strip():
        return value
    return value * parse_unit(unit.strip()).factor / parse_unit(other.strip()).factor


def _times(root: Node, at: Keys) -> Iterator[SpecRelaxation]:
    """Yield a written range of times: the shortest time asks for the least."""
    part = _said(root, at)
    if isinstance(part, dict):
        at, part = (*at, "range"), part.get("range")
    if not isinstance(part, tuple) or len(part) != 2:
        return
    low, high = map(str, part)
    if _number(low, high) < _number(high):
        yield SpecRelaxation(at, _widening(UP, (low, low), (low, high)))


def _delay(least: int, most: int) -> Iterator[SpecRelaxation]:
    at: Keys = ("sampling", "delay")
    asked = counted(most, "sample")
    if least < most:
        # Firmware cannot make a sample newer, but it can hold fresh samples back to the oldest
        # age.
        held = f"{asked} always, fresh ones held back"
        yield SpecRelaxation(at, RelaxationSteps(WITH, lambda _: str(most), lambda _: held, asked))
        form = RelaxationSteps(
            UP,
            lambda k: (str(least), str(least + k)),
            lambda k: counted(least + k, "sample"),
            asked,
            most - least,
        )
        yield SpecRelaxation(at, form)
    elif most:
        form = RelaxationSteps(WITH, str, lambda k: counted(k, "sample"), asked, most)
        yield SpecRelaxation(at, form, changes_model=True)


def _dwell(
    arbitrary: bool, root: Node, slowest: float | None, discrete: bool
) -> Iterator[SpecRelaxation]:
    """Yield a dwell time for a spec without one, or a longer one for all modes."""
    at: Keys = ("switching",)
    given = _said(root, (*at, "dwell_time"))
    if arbitrary and _said(root, at) == "arbitrary":
        if discrete:
            form = _dwell_form(MOST_STEPS - 2, lambda step: f"{MOST_STEPS - step} steps")
            yield SpecRelaxation(at, form)
        elif slowest is not None and slowest > 0:
            longest = min(Fraction(2) ** ceil(log2(TIMES / slowest)), Fraction(LONGEST_DWELL))
            yield SpecRelaxation(at, _dwell_form(DWELLS, partial(_seconds_at, longest)))
    elif isinstance(given, str) and not discrete and _number(given, "1 s") * TIMES < LONGEST_DWELL:
        shortest = _number(given, "1 s")

        def longer(step: int) -> str:
            return given if step == LONGER else _seconds_at(shortest * TIMES, step)

        form = RelaxationSteps(WITH, longer, longer, given, LONGER)
        yield SpecRelaxation((*at, "dwell_time"), form)


def _dwell_form(size: int, text: Callable[[int], str]) -> RelaxationSteps:
    def says(step: int) -> Data:
        return "arbitrary" if step > size else {"dwell_time": text(step)}

    return RelaxationSteps(WITH, says, lambda k: f"dwell_time: {text(k)}", "arbitrary", size + 1)


def _seconds_at(longest: Fraction, step: int) -> str:
    """Return the longest time, halved once in so many steps, rounded up to few digits."""
    halves, rest = divmod(step, PER_OCTAVE)
    time = longest / 2**halves * Fraction(2 * PER_OCTAVE - rest, 2 * PER_OCTAVE)
    unit = Fraction(10) ** (_exponent(time) - DWELL_DIGITS + 1)
    return f"{exact_text(ceil(time / unit) * unit)} s"


def _said(root: Node, at: Keys) -> Data | None:
    """Return the value of a document at a place, or None without one."""
    node = node_at(root, at)
    return None if node is None else to_data(node)
