"""From the switching rules of a spec to those of the assembled modes, and to words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import permutations, product

from nrs_design.errors import AssemblyError
from nrs_design.spec import ResetSpec, SwitchingSpec
from nrs_design.switched.matrix import RationalMatrix
from nrs_design.switched.parameters import Corner, Parameter, pair_ends
from nrs_design.switched.system import Reset, Switching

MAX_ASSEMBLED_TRANSITIONS = 200_000
MAX_LISTED = 20

Groups = Mapping[str, Sequence[Corner]]
Transition = tuple[str, str]


def assemble_switching(
    rules: SwitchingSpec, groups: Groups, resets: Sequence[ResetSpec] = ()
) -> Switching:
    """Carry the rules of a spec over to the assembled modes.

    Corners and contacts of one name follow each other freely, because parameters and environment
    move as they like. Switches between names are allowed, and reset, for all their corners. The
    ends of a constant parameter never follow each other.

    Parameters
    ----------
    rules : SwitchingSpec
        In terms of the names of the spec.
    groups : mapping
        What each name stands for, in the order of the assembled modes.
    resets : sequence of ResetSpec
        In terms of the same names.

    Raises
    ------
    AssemblyError
        If the rules become too many.
    """
    ends = tuple(pair for corners in groups.values() for pair in pair_ends(corners))
    dwell = Fraction(0) if rules.dwell_time is None else rules.dwell_time.value
    transitions = None
    if rules.transitions is not None or ends:
        named = rules.transitions
        pairs: Iterator[Transition] = iter(named) if named is not None else permutations(groups, 2)
        transitions = _limited(_expand(pairs, groups, free=True))
    assembled = tuple(
        Reset(*pair, RationalMatrix.from_rows(reset.map))
        for reset in resets
        for pair in _expand([(reset.source, reset.target)], groups, free=False)
    )
    return Switching(dwell, transitions, assembled, ends)
