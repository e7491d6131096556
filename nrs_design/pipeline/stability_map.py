"""For which stiffness and which age of the force sample a sampled loop is proved or refuted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import DesignError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.interval import Interval
from nrs_design.models.plant import Plant
from nrs_design.pipeline.certification import Result, assemble_spec
from nrs_design.pipeline.design import placed
from nrs_design.pipeline.margins import quick_limits
from nrs_design.progress import Progress, silent
from nrs_design.search.certification import Certification, Limits

# The largest stiffness of every contact, over the declared one.
FACTORS = (
    *(Fraction(eighths, 8) for eighths in (1, 2, 4, 6, 8, 9, 10, 12)),
    *map(Fraction, (2, 3, 4, 8, 16)),
)
# A force that is older makes the state longer, and the search slower.
ROWS = 6


@dataclass(frozen=True, slots=True)
class StabilityMap:
    """Verdicts over the range of stiffness and the range of ages of the force sample."""

    shortest: int  # Shortest age in samples; every cell has all ages from here to its own
    delays: tuple[int, ...]  # Longest ages
    # Upper end of the stiffness of every contact over the declared one.
    factors: tuple[Fraction, ...]
    verdicts: Mapping[tuple[int, int], Verdict]  # By the places of delay and factor
    # Name, lower end of the stiffness in every cell, and declared upper end, in N m/rad.
    contacts: tuple[tuple[str, Fraction, Fraction], ...]
    delay: int  # Longest declared age
    # In which contact alone some cells are refuted, where its loss must be covered; or empty.
    refuted_in: str = ""


def run_stability_map(
    result: Result, limits: Limits | None = None, progress: Progress = silent
) -> StabilityMap:
    """Decide the loop of a spec over stiffness and delay, without what disturbs it.

    A cell takes every stiffness from the declared lower end to its own upper end, and every age
    from the shortest declared one to its own; gains and all else are those of the spec. Of a
    refuted spec, all cells begin at a lower end that is far below the declared upper one. Cells are
    nested, so few of them are searched.

    Parameters
    ----------
    result : Result
        Of the spec as it stands; its design is kept.
    limits : Limits, optional
        How far the searches go each time; the decay rate is not optimized.
    progress : callable
        Told which cell is decided.

    Raises
    ------
    DesignError
        If the loop is not sampled, or its contacts are no plain springs and dampers.
    """
    from nrs_design.search.certify import certify
    from nrs_design.search.staircase import decide_staircase
    from nrs_design.spec.sampling import LONGEST_DELAY

    designed = result.designed
    if designed is None or designed.spec.sampling is None:
        with placed(result.loaded):
            raise DesignError(
                "a map of stiffness and delay is for sampled loops",
                remedy="add `sampling: {period: 2 ms, delay: [0, 1]}` to an interaction design",
                at=("kind",),
            )
    spec, sampling = designed.spec, designed.spec.sampling
    touched = designed.plant.among(designed.design.contacts)
    if any(environment.parts or environment.preloaded for environment in touched):
        with placed(result.loaded):
            raise DesignError(
                "a map of stiffness and delay is for contacts that are touched one at a time, and "
                "not within a preload",
                remedy="leave --map out",
                at=("environments",),
            )
    shortest, declared = sampling.delay
    longest = min(max(declared + 1, shortest + ROWS - 1), LONGEST_DELAY)
    delays = tuple(range(shortest, longest + 1))
    quick, weaker = quick_limits(result, limits), dict[str, None]()

    def settled(found: Certification) -> Verdict:
        """Take what is refuted in kept contact for refuted, and keep that it is."""
        if found.refuted_in is None:
            return found.verdict
        weaker[found.refuted_in] = None
        return Verdict.REFUTED

    known = settled(result.certification)
    # What is refuted may be too stiff.
    softer = FACTORS[0] if known is Verdict.REFUTED else None
    contacts = tuple(
        (e.name, min(e.stiffness.low, (softer or 1) * e.stiffness.high), e.stiffness.high)
        for e in touched
    )
    factors = tuple(f for f in FACTORS if all(f * high >= low for _, low, high in contacts))

    def decide(cell: tuple[int, int]) -> Verdict:
        delay, factor = delays[cell[0]], factors[cell[1]]
        if delay == declared and factor == 1 and softer is None:
            return known
        progress(f"delay {delay}, stiffness times {factor}")
        changed = {"sampling": sampling.model_copy(update={"delay": (shortest, delay)})}
        plain = spec.model_copy(update=changed | {"disturbances": None})
        other = replace(designed, spec=plain, plant=as_stiff(designed.plant, contacts, factor))
        system = assemble_spec(result.loaded, other)
        return settled(certify(system, limits=quick))

    verdicts = decide_staircase(len(delays), len(factors), decide)
    where = " or ".join(weaker)
    return StabilityMap(shortest, delays, factors, verdicts, contacts, declared, where)


def as_stiff(
    plant: Plant, contacts: tuple[tuple[str, Fraction, Fraction], ...], factor: Fraction
) -> Plant:
    """Return a plant whose contacts are stiffer, or softer.

    Parameters
    ----------
    plant : Plant
        The plant.
    contacts : tuple of (str, Fraction, Fraction)
        Names, lower ends, and upper ends that count one.
    factor : Fraction
        On the upper ends.
    """
    ends = {name: (low, factor * high) for name, low, high in contacts}
    changed = (_stiff(e, *ends[e.name]) if e.name in ends else e for e in plant.environments)
    return replace(plant, environments=tuple(changed))


def _stiff(environment: Environment, low: Fraction, high: Fraction) -> Environment:
    at = environment.law.parameters().index(environment.law.front)
    ranges = list(environment.ranges)
    ranges[at] = Interval(min(max(ranges[at].nominal, low), high), low, high, ranges[at].varies)
    return replace(environment, ranges=tuple(ranges))
