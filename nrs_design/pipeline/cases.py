"""Cut the ranges of constants in parts, until each has a proof of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from nrs_design.models.cut import MAX_PARTS, Ends, RangeCut, cut_ranges
from nrs_design.proof.constant import value_at
from nrs_design.proof.switching import ARBITRARY, FixedParameter
from nrs_design.search.cases import ProvedCase
from nrs_design.search.certification import Limits
from nrs_design.work import Allowance, Fuse, NotAffordableError

if TYPE_CHECKING:
    from nrs_design.pipeline.design import Designed

CASES = "cases"
# Share of the budget for all parts together.
ALL_PARTS = 0.5
# Work to assemble modes, and to check that corners suffice: most of it is about their pairs.
PER_PAIR = 1.5e-4
# Of the largest end of a whole range, which a part is compared with beside its own ends: of two
# parts that reach zero, the shorter one counts as shorter.
ZERO_AT = Fraction(1, 8)


@dataclass(frozen=True, slots=True)
class Cases:
    """Parts of ranges, each with its proof; without cuts there is none of them all."""

    outcome: str
    work: float
    cuts: tuple[RangeCut, ...] = ()
    proved: tuple[ProvedCase, ...] = field(default=(), repr=False)


def find_cases(designed: Designed, constants: Sequence[FixedParameter], limits: Limits) -> Cases:
    """Cut the constant ranges of a design until each part is proved, or one cannot be.

    With a goal for the decay, until each decays so; where that cannot be, at any rate.
    """
    from nrs_design.loop.assemble import closed_part
    from nrs_design.search.certify import prove_together
    from nrs_design.spec.build_plant import build_conditions

    conditions = build_conditions(designed.spec)
    (drive,) = designed.spec.drives
    allowance = Allowance(ALL_PARTS * limits.budget, limits.memory, Fuse.of(limits.budget))

    def proved_at(part: Ends, wanted: Fraction | None) -> ProvedCase | str:
        if allowance.left <= 0:
            raise NotAffordableError(
                f"the budget of {allowance.total:g} for all parts is used up (--budget)"
            )
        system = closed_part(conditions, designed.plant, designed.design, drive, part)
        system = replace(system, switching=ARBITRARY)
        allowance.charge(PER_PAIR * len(system.modes) ** 2)
        proof, outcome = prove_together(system, allowance, wanted)
        return outcome if proof is None else (system, proof)

    found = Cases("", 0.0)
    for wanted in dict.fromkeys((limits.decay_rate, None)):
        try:
            cuts, proved, outcome = _cut(constants, partial(proved_at, wanted=wanted))
        except NotAffordableError as reason:
            cuts, proved, outcome = (), (), str(reason)
        found = Cases(outcome, allowance.charged, cuts, proved)
        if cuts:
            break
    return found


def _cut(
    constants: Sequence[FixedParameter], proved_at: Callable[[Ends], ProvedCase | str]
) -> tuple[tuple[RangeCut, ...], tuple[ProvedCase, ...], str]:
    """Cut parts without a proof, as long as there is one at their middle; that of all first."""
    whole = {p.name: (p.low, p.high) for p in constants}
    cuts: list[RangeCut] = []
    proved: dict[int, ProvedCase] = {}
    todo = [0]
    while todo:
        index = todo.pop()
        part = cut_ranges(whole, cuts)[index]
        if cuts and not isinstance(found := proved_at(part), str):
            proved[index] = found
            continue
        # Halfway in the coordinate in which modes are affine.
        parts = {p.name: replace(p, low=part[p.name][0], high=part[p.name][1]) for p in constants}
        middles = {name: value_at(p, Fraction(1, 2)) for name, p in parts.items()}
        found = proved_at({name: (at, at) for name, at in middles.items()})
        if isinstance(found, str):
            where = " and ".join(f"{name} = {float(at):.4g}" for name, at in middles.items())
            return (), (), f"none at {where}: {found}"
        if len(cuts) + 1 >= MAX_PARTS:
            return (), (), f"of {MAX_PARTS} parts of the constant ranges, not all have a proof"
        name = max(whole, key=lambda name: _length(part[name], whole[name]))
        cuts.append(RangeCut(index, name, middles[name]))
        todo += [index, len(cuts)]
    outcome = f"each of {len(proved)} parts of the constant ranges has a proof"
    return tuple(cuts), tuple(proved[k] for k in sorted(proved)), outcome


def _length(ends: tuple[Fraction, Fraction], whole: tuple[Fraction, Fraction]) -> Fraction:
    """Return how long a range is for its size."""
    sizes = sum(map(abs, ends)) + ZERO_AT * max(map(abs, whole))
    return (ends[1] - ends[0]) / sizes
