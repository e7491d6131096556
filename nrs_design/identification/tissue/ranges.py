"""The range of a parameter that a proof shall cover; its coverage is a choice with a name.

- ``confidence``: the mean of the specimens.
- ``tolerance``: a share of all specimens like those of the records.
- ``prediction``: the specimen of the next record.

All hold the interval of every measured record too. Several parameters make a box: each side has
its share of the 5 % that may fail (Bonferroni), so that the box as a whole holds with 95 %.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from nrs_design.errors import DataError
from nrs_design.identification.numeric import Array
from nrs_design.identification.statistics import (
    Estimate,
    joint_level,
    student_quantile,
    tolerance_factor,
)
from nrs_design.spec.provenance import Coverage

_FEWEST = 2


def spread_ranges(
    coverage: Coverage, logarithms: Array, single: Sequence[Sequence[Estimate]]
) -> tuple[Estimate, ...]:
    """Return ranges that hold other specimens than those measured; one record does not tell them.

    The scatter between the records is that of the specimens and of the fits together, which errs
    to the wide side. Logarithms, shape (n, p), are taken as normal.
    """
    n, p = logarithms.shape
    check_spread(coverage, n)
    level = joint_level(p)
    if coverage == "tolerance":
        factor = tolerance_factor(n, share=level, confidence=level)
    else:
        factor = student_quantile(n - 1, level) * math.sqrt(1 + 1 / n)
    means, scatter = logarithms.mean(axis=0), logarithms.std(axis=0, ddof=1)
    halves = zip(means.tolist(), (factor * scatter).tolist(), strict=True)
    return hulls([Estimate.from_log(mean, half) for mean, half in halves], single)


def check_spread(coverage: Coverage, count: int) -> None:
    """Refuse one record, which does not tell how specimens differ."""
    if count < _FEWEST:
        raise DataError(
            f"a range for {coverage} needs several records, and there is one: it says nothing of "
            "the spread between specimens",
            remedy="give more records, or take --covers confidence",
        )


def hulls(pooled: Sequence[Estimate], single: Sequence[Sequence[Estimate]]) -> tuple[Estimate, ...]:
    """Widen the interval of each parameter to those of single records."""
    return tuple(
        Estimate(own.value, min(e.low for e in (own, *row)), max(e.high for e in (own, *row)))
        for own, *row in zip(pooled, *single, strict=True)
    )
