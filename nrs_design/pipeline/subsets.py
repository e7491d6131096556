"""What is proved beside two periods, or missed deadlines, under disturbances: no bound together.

The decay is proved without the disturbances, and bounds for a common period without misses.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from nrs_design.certificates.certificate import Verdict
from nrs_design.pipeline.certification import Result, assemble_spec
from nrs_design.pipeline.margins import quick_limits
from nrs_design.progress import Progress, silent
from nrs_design.search.certification import Limits

_OUTER, _MISSES = "the outer_period", "the missed deadlines"


@dataclass(frozen=True, slots=True)
class Subset:
    """What is proved when parts of a spec are left out, where all of it is not proved."""

    left_out: tuple[str, ...]  # Parts of the spec that the proof is not about
    claim: str  # What is proved without them; empty where nothing is that was looked for
    needs: tuple[str, ...] = ()  # What that takes for granted, and the spec as it stands does not


def has_unbounded_turns(result: Result) -> bool:
    """Tell whether a spec has disturbances beside two periods or misses: no bound is proved."""
    system = result.certification.system
    return system.clock is not None and bool(system.channels)


def find_subsets(
    result: Result, limits: Limits | None = None, progress: Progress = silent
) -> tuple[Subset, ...] | None:
    """Return decay and bounds apart, of a proved spec with both; None elsewhere."""
    designed, evidence = result.designed, result.certification.evidence
    proved = result.certification.verdict is Verdict.PROVED
    if designed is None or evidence is None or not proved or not has_unbounded_turns(result):
        return None
    from nrs_design.search.certify import certify

    decay = Subset(("the disturbances",), evidence.claim(result.certification.system))
    turns = result.certification.system.clock
    outer = turns is not None and turns.is_round
    part, key = (_OUTER, "outer_period") if outer else (_MISSES, "misses")
    progress("with a common period" if outer else "without misses")
    spec = designed.spec
    assert spec.sampling is not None
    # A delay that counted samples of the outer loop then counts those of the motion loop.
    sampling = spec.sampling.model_copy(update={key: None})
    spec = spec.model_copy(update={"sampling": sampling})
    other = replace(designed, spec=spec)
    system = assemble_spec(result.loaded, other)
    decided = certify(system, limits=quick_limits(result, limits))
    bounds = [item for item in decided.statements if item.bound(system) is not None]
    if decided.verdict is not Verdict.PROVED or not bounds:
        return decay, Subset((part,), "")
    claims = " ".join(item.claim(system) for item in bounds)
    known = result.certification.granted
    needs = tuple(text for text in decided.granted if text not in known)
    return decay, Subset((part,), claims, needs)


PARTS_TITLE = (
    "NOT proved: any bound under the disturbances of the spec, since the loop has two "
    "periods or misses deadlines; what is proved instead"
)


def subset_lines(subsets: tuple[Subset, ...]) -> tuple[str, ...]:
    """Say what is proved in part, and what each statement takes for granted besides."""
    return tuple(map(_line, subsets))


def _line(item: Subset) -> str:
    left_out = " and ".join(item.left_out)
    if not item.claim:
        return f"not proved without {left_out} either: no bound under the disturbances was found"
    # Both loops run at other times then: what is left out changes what the robot does.
    of = "of another loop, " if {_OUTER, _MISSES} & {*item.left_out} else ""
    needs = ("Then taken for granted besides:", *item.needs) if item.needs else ()
    return " ".join((f"proved {of}without {left_out}: {item.claim}", *needs))
