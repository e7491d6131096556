"""What ``--json`` prints about margins; every double is on the side that stays true."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.pipeline.margins import ProofMargins
    from nrs_design.search.loop_margin import Bracket, MarginBrackets


def margins_summary(margins: ProofMargins) -> dict[str, Any]:
    """Return the margins that were asked for, with the exact numbers beside the doubles."""
    from nrs_design.proof.bounds import lower_float, upper_float

    box, dwell = margins.box, margins.dwell
    content: dict[str, Any] = {}
    if box is not None:
        content["margin"] = {
            "proved_scale": None if box.proved is None else lower_float(box.proved),
            "proved_scale_exact": None if box.proved is None else str(box.proved),
            "refuted_scale": None if box.refuted is None else upper_float(box.refuted),
            "refuted_scale_exact": None if box.refuted is None else str(box.refuted),
            "refuted_in": box.refuted_in or None,
            "why_not_refuted": box.end or None,
            "method": box.proof.method if box.proof else None,
        }
    if dwell is not None:
        content["shortest_dwell"] = {
            "proved": None if dwell.proved is None else upper_float(dwell.proved),
            "proved_exact": None if dwell.proved is None else str(dwell.proved),
            "refuted": None if dwell.refuted is None else lower_float(dwell.refuted),
            "refuted_exact": None if dwell.refuted is None else str(dwell.refuted),
            "refuted_in": dwell.refuted_in or None,
            "longest_tried": lower_float(dwell.longest),
            "unit": "s",
            "method": dwell.proof.method if dwell.proof else None,
        }
    if margins.loop is not None:
        content["loop_margins"] = loop_summary(margins.loop)
    return content


def loop_summary(margins: MarginBrackets) -> dict[str, Any]:
    """Return those of delay, period and disturbances.

    Parameters
    ----------
    margins : MarginBrackets
        As `nrs_design.pipeline.margins.run_proof_margins` finds them.
    """
    from nrs_design.proof.bounds import lower_float, upper_float

    content: dict[str, Any] = {}
    if margins.delay is not None:
        content["delay"] = {**_ends(margins.delay), "unit": "samples"}
    if margins.period is not None:
        content["period"] = {**_ends(margins.period), "unit": "s"}
    if margins.command is not None:
        content["force_limit"] = {
            "limit": float(margins.command.limit),
            "unit": "N*m",
            "disturbances": [
                {
                    "name": name,
                    "unit": unit,
                    "kept_up_to": lower_float(kept),
                    "broken_in_simulation_at": upper_float(broken),
                }
                for name, (kept, broken, unit) in margins.command.bounds.items()
            ],
        }
    return content


def _ends(bracket: Bracket) -> dict[str, float | str | None]:
    from nrs_design.proof.bounds import lower_float, upper_float

    proved, refuted = bracket.proved, bracket.refuted
    return {
        "proved": None if proved is None else lower_float(proved),
        "refuted": None if refuted is None else upper_float(refuted),
        "refuted_in": bracket.refuted_in or None,
        "why_not_refuted": bracket.end or None,
    }
