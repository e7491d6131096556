"""The spec of an interaction design: one robot, its environments and its controllers."""

from __future__ import annotations

from nrs_design.spec.check import Feature, find_faults, not_together
from nrs_design.spec.combinations import CHANGING, COMBINATIONS
from nrs_design.spec.interaction_checks import INTERACTION_CHECKS
from nrs_design.spec.interaction_doubts import INTERACTION_DOUBTS
from nrs_design.spec.interaction_parts import AbstractInteractionSpec
from nrs_design.spec.switching import DwellObstacle


class InteractionDesignSpec(AbstractInteractionSpec):
    """Controllers to be designed for the contact with given environments."""

    checks = INTERACTION_CHECKS
    warnings = INTERACTION_DOUBTS

    def combines(self, feature: Feature[AbstractInteractionSpec]) -> bool:
        """Tell whether a feature combines with all features of the spec."""
        return not any(
            all(part is feature or part.find(self) for part in row.features)
            for row in COMBINATIONS
            if feature in row.features
        )

    def find_dwell_obstacle(self) -> DwellObstacle | None:
        """Say why no dwell time can be claimed for this spec, or None."""
        form = "a dwell time beside {}: not modelled"
        rows = [not_together(*features, form=form) for features in CHANGING]
        found = find_faults(rows, self)
        return DwellObstacle(found[0]["message"], found[0]["remedy"]) if found else None
