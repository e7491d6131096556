"""How far ranges, delay and dwell time reach until a proof is lost, in words."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.axis import unit as shown_unit
from nrs_design.proof.bounds import nearly, rounded_down, rounded_up
from nrs_design.spec.switching import LONGEST_DWELL

if TYPE_CHECKING:
    from nrs_design.pipeline.margins import ProofMargins
    from nrs_design.search.margin import Bracket
    from nrs_design.spec import Spec
    from nrs_design.spec.misses import MissRuleSpec


def margin_lines(margins: ProofMargins, spec: Spec) -> Iterator[str]:
    """Yield a sentence, in small letters and without its full stop, for each margin."""
    yield from _box_lines(margins)
    yield from _loop_lines(margins)
    yield from _dwell_lines(margins)
    yield from _misses_lines(margins, spec)


def _box_lines(margins: ProofMargins) -> Iterator[str]:
    box = margins.box
    if box is None:
        return
    beyond = f"; {box.end}" if box.end else ""
    if box.refuted is not None:
        beyond = f"; scaled by {rounded_up(box.refuted)} they are refuted{_in(box.refuted_in)}"
    if box.proved is None or box.proof is None:
        yield f"largest box: not even the nominal values are proved{beyond}"
        return
    yield (
        f"largest box: scaled by {rounded_down(box.proved)} about their nominal values, all ranges "
        f"are proved ({box.proof.method}){beyond}"
    )


def _dwell_lines(margins: ProofMargins) -> Iterator[str]:
    dwell = margins.dwell
    if dwell is None:
        return
    proved = f"no proof up to {LONGEST_DWELL} s, where the search ended"
    if dwell.proved is not None and dwell.proof is not None:
        proved = f"{rounded_up(dwell.proved, 's')} is proved ({dwell.proof.method})"
    refuted = "" if dwell.proved == 0 else "; no dwell time was refuted"
    if dwell.refuted is not None:
        end = rounded_down(dwell.refuted, "s")
        refuted = f"; {end} and all shorter ones are refuted{_in(dwell.refuted_in)}"
    yield f"shortest dwell time: {proved}{refuted}"


def _misses_lines(margins: ProofMargins, spec: Spec) -> Iterator[str]:
    """State the most misses that are proved, and the fewest that are refuted."""
    rule: MissRuleSpec | None
    if spec.kind == "switched-system":
        rule, what = spec.misses, "steps"
    else:
        sampling = spec.sampling if spec.kind == "interaction-design" else None
        rule, what = None if sampling is None else sampling.misses, "periods"
    if rule is None or margins.misses is None:
        return
    where = " in a row" if rule.of is None else f" of any {rule.of} {what} in a row"
    said = _ends(margins.misses, str, f"proved up to *{where}", "refuted from * on")
    yield f"most missed deadlines: {said}"


def _loop_lines(margins: ProofMargins) -> Iterator[str]:
    loop = margins.loop
    if loop is None:
        return
    more = "" if loop.command is None else "; without disturbances, no bound was looked at"
    if loop.delay is not None:
        refuted = f"refuted from *{_in(loop.delay.refuted_in)}"
        said = _ends(loop.delay, _samples, "proved up to *", refuted)
        yield f"longest delay of the force sample: {said}{more}"
    if loop.period is not None:
        refuted = f"* is refuted{_in(loop.period.refuted_in)}"
        said = _ends(loop.period, lambda seconds: nearly(seconds, "s"), "* is proved", refuted)
        yield f"period: {said} (each for itself, nothing is said of those in between{more})"
    if loop.command is not None:
        bounds = loop.command.bounds.items()
        kept = ", ".join(
            f"|{name}| <= {rounded_down(end, unit)}" for name, (end, _, unit) in bounds
        )
        broken = ", ".join(nearly(end, unit) for _, (_, end, unit) in bounds)
        yield (
            f"limit of {nearly(loop.command.limit, shown_unit('N*m'))}: proved to be kept for "
            f"{kept}; a simulated run reaches it at {broken}"
        )


def _ends(bracket: Bracket, shown: Callable[[Fraction], str], proved: str, refuted: str) -> str:
    """Return what is proved and what is refuted; a star in these texts is where the number stands.

    Where nothing is refuted, say where the search ended.
    """
    first, second = bracket.proved, bracket.refuted
    holds = "none is proved" if first is None else proved.replace("*", shown(first), 1)
    fails = bracket.end if second is None else refuted.replace("*", shown(second), 1)
    return f"{holds}, {fails}"


def _in(contact: str) -> str:
    """Say in which contact alone something is refuted, if it is not in any."""
    return f" {contact}" if contact else ""


def _samples(count: Fraction) -> str:
    return f"{count} sample{'s' * (count != 1)}"
