"""How far ranges, delay and dwell time reach until a proof is lost, in words."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.proof.bounds import nearly, rounded_down, rounded_up

if TYPE_CHECKING:
    from nrs_design.pipeline.margins import ProofMargins


def margin_lines(margins: ProofMargins) -> Iterator[str]:
    """Yield a sentence, in small letters and without its full stop, for each margin."""
    yield from _box_lines(margins)
    yield from _loop_lines(margins)
    yield from _dwell_lines(margins)


def _box_lines(margins: ProofMargins) -> Iterator[str]:
    box = margins.box
    if box is None:
        return
    if box.proved is None or box.proof is None:
        yield "largest box: not even the nominal values are proved"
        return
    beyond = ""
    if box.refuted is not None:
        beyond = f"; scaled by {rounded_up(box.refuted)} they are refuted"
    yield (
        f"largest box: scaled by {rounded_down(box.proved)} about their nominal values, all "
        f"ranges are proved ({box.proof.method}){beyond}"
    )


def _dwell_lines(margins: ProofMargins) -> Iterator[str]:
    dwell = margins.dwell
    if dwell is None:
        return
    proved = f"no proof up to {rounded_down(dwell.longest, 's')}, where the search ended"
    if dwell.proved is not None and dwell.proof is not None:
        proved = f"{rounded_up(dwell.proved, 's')} is proved ({dwell.proof.method})"
    refuted = "" if dwell.proved == 0 else "; no dwell time was refuted"
    if dwell.refuted is not None:
        refuted = f"; {rounded_down(dwell.refuted, 's')} and all shorter ones are refuted"
    yield f"shortest dwell time: {proved}{refuted}"


def _loop_lines(margins: ProofMargins) -> Iterator[str]:
    loop = margins.loop
    if loop is None:
        return
    more = "" if loop.command is None else "; without disturbances, no bound was looked at"
    if loop.delay is not None:
        said = _said(loop.delay.proved, loop.delay.refuted, "samples")
        yield f"longest delay of the force sample: {said}{more}"
    if loop.period is not None:
        said = _said(loop.period.proved, loop.period.refuted, "s")
        yield f"period: {said} (each for itself, nothing is said of those in between{more})"
    if loop.command is not None:
        limit, bounds = loop.command.limit, loop.command.bounds
        kept = ", ".join(
            f"|{name}| <= {rounded_down(kept, unit)}" for name, (kept, _, unit) in bounds.items()
        )
        broken = ", ".join(nearly(end, unit) for _, end, unit in bounds.values())
        yield (
            f"limit of {nearly(limit, 'N*m')}: proved to be kept for {kept}; a simulated run "
            f"reaches it at {broken}"
        )


def _said(proved: Fraction | None, refuted: Fraction | None, unit: str) -> str:
    said = "none is proved" if proved is None else f"{nearly(proved, unit)} is proved"
    none = "no refutation was found"
    return f"{said}, " + (none if refuted is None else f"{nearly(refuted, unit)} is refuted")
