"""Builder of small systems."""

from nrs_design.proof.switching import Reset
from tests.proof.systems import family as system
from tests.proof.systems import matrix

__all__ = ["reset", "system"]


def reset(source, target, rows):
    return Reset(source, target, matrix(rows))
