"""How far ranges, delay and dwell time reach until a proof is lost, in words."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING

from nrs_design.axis import unit
from nrs_design.proof.bounds import nearly, rounded_down, rounded_up
from nrs_design.reporting.document import Sentence
from nrs_design.reporting.sections.places import linked
from nrs_design.spec import InteractionDesignSpec

if TYPE_CHECKING:
    from nrs_design.pipeline.margins import ProofMargins
    from nrs_design.search.loop_margin import Bracket
    from nrs_design.spec import LoadedSpec, Spec
    from nrs_design.spec.misses import MissRuleSpec

# Makes a text lead to a place of the spec.
_At = Callable[..., str]


def margin_lines(margins: ProofMargins, loaded: LoadedSpec) -> Iterator[Sentence]:
    """Yield a sentence, in small letters and without its full stop, for each margin.

    Numbers lead to the lines of the spec that declare what they are about.
    """
    at, spec = partial(linked, loaded), loaded.spec
    design = isinstance(spec, InteractionDesignSpec)
    yield from _box_lines(margins, at, "environments" if design else "parameters")
    yield from _loop_lines(margins, at)
    yield from _dwell_lines(margins, at)
    yield from _misses_lines(margins, at, spec)


def _box_lines(margins: ProofMargins, at: _At, ranges: str) -> Iterator[Sentence]:
    box = margins.box
    if box is None:
        return
    beyond: tuple[str, ...] = (f"; {box.end}",) if box.end else ()
    if box.refuted is not None:
        refuted = at(rounded_up(box.refuted), ranges)
        beyond = ("; scaled by ", refuted, f" they are refuted{_in(box.refuted_in)}")
    if box.proved is None or box.proof is None:
        yield Sentence("largest box: not even the nominal values are proved", *beyond)
        return
    yield Sentence(
        "largest box: scaled by ",
        at(rounded_down(box.proved), ranges),
        f" about their nominal values, all ranges are proved ({box.proof.method})",
        *beyond,
    )


def _dwell_lines(margins: ProofMargins, at: _At) -> Iterator[Sentence]:
    dwell = margins.dwell
    if dwell is None:
        return
    longest = at(rounded_down(dwell.longest, "s"), "switching")
    proved: tuple[str, ...] = ("no proof up to ", longest, ", where the search ended")
    if dwell.proved is not None and dwell.proof is not None:
        shortest = at(rounded_up(dwell.proved, "s"), "switching")
        proved = (shortest, f" is proved ({dwell.proof.method})")
    refuted: tuple[str, ...] = () if dwell.proved == 0 else ("; no dwell time was refuted",)
    if dwell.refuted is not None:
        end = at(rounded_down(dwell.refuted, "s"), "switching")
        refuted = ("; ", end, f" and all shorter ones are refuted{_in(dwell.refuted_in)}")
    yield Sentence("shortest dwell time: ", *proved, *refuted)


def _misses_lines(margins: ProofMargins, at: _At, spec: Spec) -> Iterator[Sentence]:
    """State the most misses that are proved, and the fewest that are refuted."""
    bracket = margins.misses
    if bracket is None:
        return
    rule: MissRuleSpec | None
    keys: tuple[str, ...]
    if spec.kind == "switched-system":
        rule, keys, what = spec.misses, ("misses",), "steps"
    else:
        sampling = spec.sampling if spec.kind == "interaction-design" else None
        rule = None if sampling is None else sampling.misses
        keys, what = ("sampling", "misses"), "periods"
    if rule is None:
        return
    where = " in a row" if rule.of is None else f" of any {rule.of} {what} in a row"
    said = _ends(
        bracket, lambda n: at(str(n), *keys), f"proved up to *{where}", "refuted from * on"
    )
    yield Sentence("most missed deadlines: ", *said)


def _loop_lines(margins: ProofMargins, at: _At) -> Iterator[Sentence]:
    loop = margins.loop
    if loop is None:
        return
    more = "" if loop.command is None else "; without disturbances, no bound was looked at"
    if loop.delay is not None:
        refuted = f"refuted from *{_in(loop.delay.refuted_in)}"
        said = _ends(loop.delay, partial(_samples, at), "proved up to *", refuted)
        yield Sentence("longest delay of the force sample: ", *said, more)
    if loop.period is not None:
        refuted = f"* is refuted{_in(loop.period.refuted_in)}"
        said = _ends(loop.period, partial(_period, at), "* is proved", refuted)
        rest = f" (each for itself, nothing is said of those in between{more})"
        yield Sentence("period: ", *said, rest)
    if loop.command is not None:
        bounds = loop.command.bounds.items()
        kept = (
            (f"|{name}| <= ", at(rounded_down(end, unit), "disturbances", name))
            for name, (end, _, unit) in bounds
        )
        broken = ((at(nearly(end, unit), "disturbances", name),) for name, (_, end, unit) in bounds)
        yield Sentence(
            "limit of ",
            at(nearly(loop.command.limit, unit("N*m")), "limits", "torque"),
            ": proved to be kept for ",
            *_listed(kept),
            "; a simulated run reaches it at ",
            *_listed(broken),
        )


def _listed(items: Iterator[tuple[str, ...]]) -> list[str]:
    """Put commas between items of several parts."""
    return list(chain.from_iterable((", ", *item) for item in items))[1:]


def _ends(
    bracket: Bracket, shown: Callable[[Fraction], str], proved: str, refuted: str
) -> Iterator[str]:
    """Yield what is proved and what is refuted; a star in these texts is where the number stands.

    Where nothing is refuted, yield where the search ended.
    """
    for end, text, none in (
        (bracket.proved, proved, "none is proved"),
        (bracket.refuted, refuted, bracket.end),
    ):
        before, _, after = text.partition("*")
        yield from (none,) if end is None else (before, shown(end), after)
        yield ", " * (text is proved)


def _in(contact: str) -> str:
    """Say in which contact alone something is refuted, if it is not in any."""
    return f" {contact}" if contact else ""


def _samples(at: _At, count: Fraction) -> str:
    return at(f"{count} sample{'s' * (count != 1)}", "sampling", "delay")


def _period(at: _At, seconds: Fraction) -> str:
    return at(nearly(seconds, "s"), "sampling", "period")
