"""What `certify-switching --margin` says about delay, period and disturbances."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.search.loop_margin import Bracket, LoopMargins


def loop_summary(margins: LoopMargins) -> dict[str, Any]:
    """Return what ``--json`` prints; every double is on the side that stays true.

    Parameters
    ----------
    margins : LoopMargins
        As `nrs_design.pipeline.margins.run_loop_margins` finds them.
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


def _ends(bracket: Bracket) -> dict[str, float | None]:
    from nrs_design.proof.bounds import lower_float, upper_float

    proved, refuted = bracket.proved, bracket.refuted
    return {
        "proved": None if proved is None else lower_float(proved),
        "refuted": None if refuted is None else upper_float(refuted),
    }
