"""Ages of the force that a proof covers beyond those that the spec declares."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.spec.sampling import LONGEST_DELAY

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec, Spec

# Smallest and largest, in samples.
Ages = tuple[int, int]


def declaring_more(spec: Spec, ages: Ages) -> InteractionDesignSpec | None:
    """Return the spec as if it declared these ages; None if it has others, or none."""
    if spec.kind != "interaction-design" or spec.sampling is None:
        return None
    low, high = spec.sampling.delay
    covered = 0 <= ages[0] <= low and high <= ages[1] <= LONGEST_DELAY
    return declaring_ages(spec, ages) if covered else None


def declaring_ages(spec: InteractionDesignSpec, ages: Ages) -> InteractionDesignSpec:
    """Return the spec as if it declared other ages of the force."""
    assert spec.sampling is not None, "a delay is of samples"
    sampling = spec.sampling.model_copy(update={"delay": ages})
    return spec.model_copy(update={"sampling": sampling})
