"""What is proved of a spec where not all of it is."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

from nrs_design.certificates.certificate import Verdict
from nrs_design.pipeline.certification import Result, assemble_spec
from nrs_design.pipeline.design import Progress, silent
from nrs_design.pipeline.margins import quick_limits
from nrs_design.proof.noun import dataclass
from nrs_design.search.certification import Limits


@dataclass(frozen=True, slots=True)
class Subset:
    """What is proved of a spec where not all of it is.

    Parameters
    ----------
    left_out : tuple of str
        Parts of the spec that the proof is not about.
    claim : str
        What is proved without them.
    """

    left_out: tuple[str, ...]
    claim: str


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
    from nrs_design.models.plant import build_plant
    from nrs_design.search.certify import certify
    from nrs_design.spec.aspects import aspects_of

    designed = result.designed
    if designed is None or result.certification.verdict is Verdict.PROVED:
        return ()
    quick = quick_limits(result, limits)
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
                found.append(Subset(left_out, decided.evidence.claim(system)))
        if found:
            return tuple(found)
    return ()
