"""The modes of given matrices: one for each corner of their parameters, and outcome of a deadline.

A matrix that is affine in the parameters is, anywhere in the box, a convex combination of its
corners. What decreases in all corners in continuous time therefore decreases in the whole box.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain

from nrs_design.errors import AssemblyError, InternalError
from nrs_design.loop.located import ConstantParameter, MatrixMode, Spot, labelled_ends, spot_of
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import combine
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import FixedParameter, Stay, Switching
from nrs_design.spec import SwitchedSystemSpec
from nrs_design.spec.misses import MissesSpec, automaton_of
from nrs_design.spec.switched_system import ModeSpec

MAX_TRANSITIONS = 200_000
ONCE = Stay(Fraction(1), Fraction(1))


def read_parameters(spec: SwitchedSystemSpec, scale: Fraction) -> dict[str, Interval]:
    """Return the parameters of a spec, their ranges scaled about the nominal values."""
    return {
        name: Interval(p.nominal, *p.range, p.varies).scaled(scale)
        for name, p in spec.parameters.items()
    }


def constant_parameters(parameters: Mapping[str, Interval]) -> tuple[ConstantParameter, ...]:
    """Return the parameters that are unknown but constant."""
    return tuple(
        ConstantParameter(
            FixedParameter(name, interval.low, interval.high), (f"{name}-min", f"{name}-max")
        )
        for name, interval in parameters.items()
        if interval.is_constant
    )


def corner_modes(mode: ModeSpec, parameters: Mapping[str, Interval]) -> Iterator[MatrixMode]:
    """Yield the corners of one mode; parameters that it does not depend on make none.

    An `InternalError` if the matrix halfway is not the mean of the corners.
    """
    own = {name: interval for name, interval in parameters.items() if name in mode.parameters}
    others = {name: interval.nominal for name, interval in parameters.items()}
    corners = [(labels, mode.matrix(others | at)) for labels, at in labelled_ends(own)]
    middle = mode.matrix({name: interval.middle for name, interval in parameters.items()})
    mean = combine(*((Fraction(1, len(corners)), [*chain(*A)]) for _, A in corners))
    if [*chain(*middle)] != mean:
        raise InternalError(f"mode {mode.name} is not affine in the parameters")
    head, constants = Spot.named(mode.name), constant_parameters(parameters)
    for labels, A in corners:
        spot = head + spot_of(labels, own, constants)
        yield MatrixMode(mode.name, spot, "", RationalMatrix.from_rows(A))


def modes_with_misses(
    items: Sequence[MatrixMode], rule: MissesSpec
) -> tuple[tuple[MatrixMode, ...], Switching]:
    """Return the modes by the automaton state after them, and the allowed switches.

    What may follow depends on the state of the automaton alone, so a mode is named by the state
    that it leads to, such as ``miss/s3``. Corners of one mode may take turns at every step. All
    groups but that of a miss are hits. An `AssemblyError` if there are too many switches.
    """
    automaton = automaton_of(*rule.window)
    # Modes by miss and by the state after them, in the order of states.
    reached: dict[tuple[bool, int], tuple[MatrixMode, ...]] = {}
    for missed, targets in ((False, automaton.hit), (True, automaton.miss)):
        corners = [item for item in items if (item.group == rule.mode) is missed]
        for target in sorted({t for t in targets if t is not None}):
            reached[missed, target] = tuple(
                replace(item, spot=item.spot + Spot.named(f"s{target}")) for item in corners
            )
    transitions: list[tuple[str, str]] = []
    stays: list[tuple[str, Stay]] = []
    for (_, state), sources in reached.items():
        following = [(False, automaton.hit[state]), (True, automaton.miss[state])]
        after = [mode for missed, t in following if t is not None for mode in reached[missed, t]]
        names = {mode.name for mode in after}
        if (len(transitions) + len(sources) * len(after)) > MAX_TRANSITIONS:
            raise AssemblyError(
                f"the rule for misses makes more than {MAX_TRANSITIONS} switches",
                remedy="shorten its window, or declare fewer parameters",
                at=("misses",),
            )
        for source in sources:
            transitions += ((source.name, mode.name) for mode in after if mode is not source)
            if source.name not in names:
                stays.append((source.name, ONCE))
    modes = tuple(mode for corners in reached.values() for mode in corners)
    return modes, Switching(Fraction(1), tuple(transitions), stays=tuple(stays))
