"""What a statement takes for granted about the mode logic of a spec, in words."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from nrs_design.proof.bounds import rounded_up
from nrs_design.spec.environment_estimator import EstimatorSpec, decide
from nrs_design.switched.assumption import Assumption
from nrs_design.switched.assumption_kinds import LOGIC, RULES

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.threshold_logic import ThresholdLogicSpec

_TIMER = LOGIC.says(
    "The dwell times are kept by the timer of the mode logic, whatever the signals do. How noisy, "
    "old and fast the signals are decides only whether it ever holds a switch back."
)
_ALONE = LOGIC.says(
    "The linear modes do not know which signals the logic sees: every switching signal that keeps "
    "these times is covered, also one that thresholds would not give."
)


def logic_texts(spec: InteractionDesignSpec) -> Iterator[Assumption]:
    """Say what keeps the rules of switching, where they are those of a mode logic."""
    if spec.mode_logic is None or spec.switching.is_arbitrary:
        return
    yield from _KEPT_BY[spec.mode_logic.type](spec, spec.mode_logic)
    yield _ALONE


def _threshold_texts(
    spec: InteractionDesignSpec, logic: ThresholdLogicSpec
) -> Iterator[Assumption]:
    yield _TIMER


def _estimator_texts(spec: InteractionDesignSpec, estimator: EstimatorSpec) -> Iterator[Assumption]:
    decision = decide(estimator, spec.controllers, spec.environments)
    torque = estimator.signals.torque
    yield RULES.says(
        "The environment that is touched does not change again within "
        f"{estimator.shortest_contact.text}. After a change the controller for the one before stays"
        f" active, for at most {rounded_up(decision.delay, 's')}: by then the estimator has "
        "decided.",
        f"changes of contact at least {estimator.shortest_contact.text} apart",
    )
    yield LOGIC.says(
        "That rests on an axis that moves in one direction at "
        f"{estimator.slowest_speed.text} or faster from the change to the decision (at rest "
        "nothing is decided, and nothing is claimed about a wrong controller that stays), on "
        f"torques known within {torque.noise.text} that are at most {torque.age.text} old and "
        f"change by at most {torque.largest_rate.text}, and on angles in steps of "
        f"{estimator.signals.position_step.text}."
    )


# What keeps the rules, by the type of the logic.
_KEPT_BY: Mapping[str, Callable[[InteractionDesignSpec, Any], Iterator[Assumption]]] = (
    MappingProxyType({"thresholds": _threshold_texts, "estimator": _estimator_texts})
)
