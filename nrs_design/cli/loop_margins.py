"""What `certify-switching --margin` says about delay, period and disturbances."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nrs_design.cli.printing import say

if TYPE_CHECKING:
    from nrs_design.search.loop_margin import Bracket, LoopMargins


def loop_summary(margins: LoopMargins) -> dict[str, Any]:
    """Return what ``--json`` prints; every double is on the side that stays true.

    Parameters
    ----------
    margins : LoopMargins
        As `nrs_design.pipeline.run_loop_margins` finds them.
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


def print_loop_margins(margins: LoopMargins | None) -> None:
    """Print what was found; nothing where a spec has neither samples nor disturbances.

    Parameters
    ----------
    margins : LoopMargins or None
        As `nrs_design.pipeline.run_loop_margins` finds them.
    """
    from nrs_design.proof.bounds import nearly, rounded_down

    if margins is None:
        return
    if margins.delay is not None:
        say(f"  longest delay of the force sample: {_said(margins.delay, 'samples')}")
    if margins.period is not None:
        said = _said(margins.period, "s")
        say(f"  period: {said} (each for itself, nothing is said of those in between)")
    if margins.command is not None:
        limit, bounds = margins.command.limit, margins.command.bounds
        kept = ", ".join(
            f"|{name}| <= {rounded_down(kept, unit)}" for name, (kept, _, unit) in bounds.items()
        )
        broken = ", ".join(nearly(end, unit) for _, end, unit in bounds.values())
        say(
            f"  limit of {nearly(limit, 'N*m')}: proved to be kept for {kept}; a simulated run "
            f"reaches it at {broken}"
        )


def _said(bracket: Bracket, unit: str) -> str:
    from nrs_design.proof.bounds import nearly

    proved, refuted = bracket.proved, bracket.refuted
    said = "none is proved" if proved is None else f"{nearly(proved, unit)} is proved"
    none = "no refutation was found"
    return f"{said}, " + (none if refuted is None else f"{nearly(refuted, unit)} is refuted")
