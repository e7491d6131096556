"""Table of the pairs of features of an interaction design that are not modelled together."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from nrs_design.spec import features as has
from nrs_design.spec.check import Feature, Row, not_together
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec


def _rows() -> Iterator[Row[Spec]]:
    """Yield the row of each reason, for every choice among features in inner brackets."""
    for because, *names in has.TABLE["rows"]:
        choices = ([name] if isinstance(name, str) else name for name in names)
        for together in product(*choices):
            features = (getattr(has, name) for name in together)
            yield not_together(*features, because=because)


COMBINATIONS: tuple[Row[Spec], ...] = tuple(_rows())
# Quantities that may change while one controller is active: a dwell time beside them is refused.
CHANGING: tuple[tuple[Feature[Spec], ...], ...] = tuple(
    row.features[1:] for row in COMBINATIONS if row.features[0] is has.DWELL
)
