"""What is proved when parts of a spec are left out, where all of it is not proved."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

from nrs_design.certificates.certificate import Verdict
from nrs_design.pipeline.certification import Result, assemble_spec
from nrs_design.pipeline.design import Designed
from nrs_design.pipeline.margins import quick_limits
from nrs_design.progress import Progress, silent
from nrs_design.search.certification import Limits

# As `nrs_design.spec.aspects` names it.
_OUTER = "the outer_period"


@dataclass(frozen=True, slots=True)
class Subset:
    """What is proved when parts of a spec are left out, where all of it is not proved."""

    left_out: tuple[str, ...]  # Parts of the spec that the proof is not about
    claim: str  # What is proved without them; empty where nothing is that was looked for
    needs: tuple[str, ...] = ()  # What that takes for granted, and the spec as it stands does not


def are_wanted(result: Result) -> bool:
    """Tell whether the subsets that are proved are looked for without being asked for.

    They are for coupled axes beside sampling or disturbances, where all together is not proved; and
    for disturbances beside two periods, which no proof covers together: the decay is then proved
    without disturbances, and bounds for a common period.

    Parameters
    ----------
    result : Result
        Of the spec as it stands.
    """
    spec = None if result.designed is None else result.designed.spec
    if spec is None:
        return False
    verdict = result.certification.verdict
    if has_unbounded_turns(result):
        return verdict is not Verdict.REFUTED and result.certification.refuted_in is None
    beside = spec.sampling is not None or spec.disturbances is not None
    return spec.coupling is not None and beside and verdict is Verdict.INCONCLUSIVE


def has_unbounded_turns(result: Result) -> bool:
    """Tell whether a spec has disturbances and two periods, for which no bound is proved.

    Parameters
    ----------
    result : Result
        Of the spec as it stands.
    """
    system = result.certification.system
    return system.clock is not None and bool(system.channels)


def find_subsets(
    result: Result, limits: Limits | None = None, progress: Progress = silent
) -> tuple[Subset, ...] | None:
    """Return the subsets where `are_wanted`; None elsewhere.

    Parameters
    ----------
    result, limits, progress
        As for `run_subsets`.
    """
    return run_subsets(result, limits, progress) if are_wanted(result) else None


def subset_lines(subsets: tuple[Subset, ...]) -> tuple[str, ...]:
    """Say what is proved in part, and what each statement takes for granted besides.

    Parameters
    ----------
    subsets : tuple of Subset
        As `run_subsets` finds them for a spec that is not proved.
    """
    if not subsets:
        return ("nothing is proved with parts of the spec left out either",)
    return tuple(map(_line, subsets))


def _line(item: Subset) -> str:
    left_out = " and ".join(item.left_out)
    if not item.claim:
        return f"not proved without {left_out} either: no bound under the disturbances was found"
    # Both loops run at other times then: what is left out changes what the robot does.
    of = "of another loop, " if _OUTER in item.left_out else ""
    needs = ("Then taken for granted besides:", *item.needs) if item.needs else ()
    return " ".join((f"proved {of}without {left_out}: {item.claim}", *needs))


def parts_title(result: Result) -> str:
    """Say what is not proved, above the list of what is.

    Parameters
    ----------
    result : Result
        Of the spec as it stands.
    """
    if result.certification.verdict is Verdict.PROVED and has_unbounded_turns(result):
        return (
            "NOT proved: any bound under the disturbances of the spec, since the loop has two "
            "periods; what is proved instead"
        )
    return "not proved together; with as little left out as possible"


def run_subsets(
    result: Result, limits: Limits | None = None, progress: Progress = silent
) -> tuple[Subset, ...]:
    """Find what is proved with as few parts of the spec left out as possible; nothing if all is.

    Parameters
    ----------
    result : Result
        Of the spec as it stands; its design is kept.
    limits : Limits, optional
        How far the searches go each time; the decay rate is not optimized.
    progress : callable
        Told what is left out.
    """
    from nrs_design.search.certify import certify
    from nrs_design.spec.aspects import aspects_of
    from nrs_design.spec.build_plant import build_plant

    designed = result.designed
    if designed is None:
        return ()
    quick = quick_limits(result, limits)
    if result.certification.verdict is Verdict.PROVED:
        return _bounds_apart(result, designed, quick, progress)
    aspects = aspects_of(designed.spec)
    for count in range(1, len(aspects) + 1):
        found = []
        for left_out in combinations(aspects, count):
            progress(f"without {' and '.join(left_out)}")
            spec = designed.spec.model_copy(update={"disturbances": None})
            for name in left_out:
                spec = aspects[name](spec)
            other = replace(designed, spec=spec, plant=build_plant(spec))
            system = assemble_spec(result.loaded, other, result.coordinates)
            decided = certify(system, limits=quick)
            if decided.verdict is Verdict.PROVED and decided.evidence is not None:
                known = set(result.certification.granted)
                needs = tuple(text for text in decided.granted if text not in known)
                found.append(Subset(left_out, decided.evidence.claim(system), needs))
        if found:
            return tuple(found)
    return ()


def _bounds_apart(
    result: Result, designed: Designed, limits: Limits, progress: Progress
) -> tuple[Subset, ...]:
    """Find the bounds of a common period where those of two periods are not proved."""
    from nrs_design.search.certify import certify
    from nrs_design.spec.aspects import with_common_period

    evidence = result.certification.evidence
    if not has_unbounded_turns(result) or evidence is None:
        return ()
    whole = result.certification.system
    decay = Subset(("the disturbances",), evidence.claim(whole))
    progress("with a common period")
    other = replace(designed, spec=with_common_period(designed.spec))
    system = assemble_spec(result.loaded, other, result.coordinates)
    decided = certify(system, limits=limits)
    bounds = [item for item in decided.statements if item.bound(system) is not None]
    if decided.verdict is not Verdict.PROVED or not bounds:
        return decay, Subset((_OUTER,), "")
    claims = " ".join(item.claim(system) for item in bounds)
    known = result.certification.granted
    needs = tuple(text for text in decided.granted if text not in known)
    return decay, Subset((_OUTER,), claims, needs)
