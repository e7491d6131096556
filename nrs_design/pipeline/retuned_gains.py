"""One box of dampings that may be retuned while the robot runs, around the gains that ship.

The same share for all impedance controllers, in whole per cent. A proof for a box is one for every
smaller one, so the largest share is bracketed and bisected. Each proof has passed the exact check,
and meets the goals of the certificate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from nrs_design.axis import unit
from nrs_design.certificates.certificate import Verdict
from nrs_design.certificates.goals import certified_goals
from nrs_design.controllers.float32 import shortest_decimal
from nrs_design.errors import AssemblyError, DesignError
from nrs_design.pipeline.certification import Result, run_certification, search_limits
from nrs_design.pipeline.design import Designed, placed
from nrs_design.progress import Progress, silent
from nrs_design.proof.text import exact_text
from nrs_design.spec import LoadedSpec
from nrs_design.spec.document import parse_document
from nrs_design.spec.load import respecified
from nrs_design.spec.spec_document import SpecDocument

# Shares in per cent: the first that is tried, and the largest.
FIRST, LARGEST = 8, 64
# Of the search at one share.
BUDGET = 3.0


@dataclass(frozen=True, slots=True)
class RetunedGains:
    """Dampings that may change as fast as they like within a proved box."""

    share: Fraction  # Around the gains that ship; 0 if nothing wider was proved
    beyond: int | None  # Smallest share in per cent that was tried and not proved; None if none
    ranges: dict[str, tuple[Fraction, Fraction]]  # Of Bt of each controller, N m s/rad
    result: Result | None  # Of the spec with these ranges; None at share 0
    goals: bool  # Whether goals of the proof had to be met, too


def run_retuned_gains(
    designed: Designed, progress: Progress = silent, name: str | None = None
) -> RetunedGains:
    """Find the largest share by which all dampings may be retuned at once.

    Parameters
    ----------
    designed : Designed
        The spec, and the gains that ship.
    progress : callable
        Told each share that is tried.
    name : str, optional
        What the spec with the ranges is called; by default as it is.

    Raises
    ------
    DesignError
        If there is no impedance controller, or a gain has a range already.
    """
    with placed(designed.loaded):
        names = _retunable(designed)
    proved: dict[int, Result] = {}

    def is_proved(percent: int) -> bool:
        progress(f"Bt retuned by {percent} %")
        loaded = with_gain_ranges(designed, names, percent, name)
        given, goals = search_limits(loaded.spec), designed.spec.goals
        rate = goals is not None and goals.decay_rate is not None
        limits = replace(given, optimize_rate=rate, budget=min(given.budget, BUDGET))
        try:
            result = run_certification(loaded, limits=limits)
        except AssemblyError:
            return False
        met = all(goal.met for goal in certified_goals(loaded.spec, result.certificate))
        if result.certification.verdict is not Verdict.PROVED or not met:
            return False
        proved[percent] = result
        return True

    low, high = bracket_share(is_proved)
    while high - low > 1 and high <= LARGEST:
        middle = (low + high) // 2
        low, high = (middle, high) if is_proved(middle) else (low, middle)
    share = Fraction(low, 100)
    gains = {n: Fraction(_shipped(designed, n, "Bt")) for n in names}
    ranges = {n: (Bt * (1 - share), Bt * (1 + share)) for n, Bt in gains.items()}
    beyond = high if high <= LARGEST else None
    asked = any(certified_goals(designed.spec, None))
    return RetunedGains(share, beyond, ranges, proved.get(low), asked)


def bracket_share(is_proved: Callable[[int], bool]) -> tuple[int, int]:
    """Return a share in per cent that is proved, or 0, and one that is not, or is beyond all.

    Parameters
    ----------
    is_proved : callable
        Decides a share.
    """
    percent = FIRST
    if is_proved(percent):
        while 2 * percent <= LARGEST and is_proved(2 * percent):
            percent *= 2
        return percent, 2 * percent
    return 0, percent


def _shipped(designed: Designed, controller: str, gain: str) -> str:
    """Return a gain as a spec gives it: the shortest decimal of its single-precision number."""
    return shortest_decimal(designed.design.laws[controller].gains[gain])


def with_gain_ranges(
    designed: Designed, names: Sequence[str], percent: int, name: str | None
) -> LoadedSpec:
    """Return the spec with its gains given, and ranges of the dampings.

    Parameters
    ----------
    designed : Designed
        The spec, and the gains that ship.
    names : sequence of str
        The controllers.
    percent : int
        Half the width of each range.
    name : str or None
        Of the spec; None leaves it.
    """
    document = SpecDocument(designed.loaded)
    if name is not None:
        document.put(document.root, "name", name)
    share = Fraction(percent, 100)
    for controller in names:
        node = document.root["controllers"][controller]
        mass, damping = (_shipped(designed, controller, gain) for gain in ("Mt", "Bt"))
        Bt, way = Fraction(damping), unit("N*m*s/rad")
        ends = [f"{exact_text(Bt * side)} {way}" for side in (1 - share, 1 + share)]
        document.put(node, "Mt", f"{mass} {unit('kg*m^2')}")
        document.put(node, "Bt", {"nominal": f"{damping} {way}", "range": ends})
    text = document.text()
    root = parse_document(text, designed.loaded.path)
    return replace(respecified(designed.loaded, root), text=text)


def _retunable(designed: Designed) -> Sequence[str]:
    """Return the impedance controllers of a spec."""
    controllers = designed.spec.controllers
    names = [name for name, given in controllers.items() if given.type == "impedance"]
    for name in names:
        if any(gain.range is not None for gain in controllers[name].gains().values()):
            raise DesignError(
                f"{name} declares where its gains may be retuned already",
                remedy="see how far they stretch: nrs-design certify-switching --margin",
                at=("controllers", name),
            )
    if not names:
        raise DesignError(
            "there is no impedance controller whose damping could be retuned",
            remedy="leave --retune out",
        )
    return names
