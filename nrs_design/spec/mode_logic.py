"""The mode logic of a spec: what it may say, and the rules of switching that follow from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Discriminator

from nrs_design.spec.controllers import ControllerSpec
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.environment_estimator import EstimatorSpec
from nrs_design.spec.faults import fault
from nrs_design.spec.switching import SwitchingSpec
from nrs_design.spec.threshold_logic import ThresholdLogicSpec

ModeLogicSpec = Annotated[ThresholdLogicSpec | EstimatorSpec, Discriminator("type")]
_REMEDY = "write `switching: mode-logic`, or rules that it keeps"


def rules_of(
    logic: ModeLogicSpec,
    controllers: Mapping[str, ControllerSpec],
    environments: Mapping[str, EnvironmentSpec],
) -> SwitchingSpec:
    """Return the switching signals that a mode logic can give.

    Parameters
    ----------
    logic : ThresholdLogicSpec or EstimatorSpec
        As the spec says.
    controllers : mapping of str to ControllerSpec
        That it chooses among.
    environments : mapping of str to EnvironmentSpec
        What they touch.

    Raises
    ------
    PydanticCustomError
        If it does not fit.
    """
    return logic.rules_among(controllers, environments)


def check_kept(
    logic: ModeLogicSpec | None,
    rules: SwitchingSpec,
    controllers: Mapping[str, ControllerSpec],
    environments: Mapping[str, EnvironmentSpec],
) -> None:
    """Refuse a logic that does not fit the controllers, or does not keep the declared rules.

    Parameters
    ----------
    logic : ThresholdLogicSpec, EstimatorSpec or None
        As the spec says.
    rules : SwitchingSpec
        Of the proof.
    controllers : mapping of str to ControllerSpec
        That the logic chooses among.
    environments : mapping of str to EnvironmentSpec
        What they touch.
    """
    if logic is None:
        return
    logic.check_names(controllers)
    kept = rules_of(logic, controllers, environments)
    if rules.names_contacts != kept.names_contacts and not rules.is_arbitrary:
        raise fault("the rules are not about what the mode logic decides", _REMEDY, "switching")
    for name in dict.fromkeys(end for pair in kept.transitions or () for end in pair):
        _check_stay(name, rules, kept)
    for pair in kept.transitions or ():
        if rules.transitions is not None and pair not in rules.transitions:
            raise fault(
                f"the mode logic may switch from {pair[0]} to {pair[1]}, the rules do not allow it",
                _REMEDY,
                "switching",
                "transitions",
            )


def _check_stay(name: str, rules: SwitchingSpec, kept: SwitchingSpec) -> None:
    (shortest, longest), (least, most) = rules.stay(name), kept.stay(name)
    if shortest is not None and (least is None or least.value < shortest.value):
        raise fault(
            f"the mode logic keeps {name} for {'no time' if least is None else least.text}, the "
            f"rules say {shortest.text}",
            f"{_REMEDY}; a `hold` in mode_logic keeps it longer",
            "switching",
            "dwell_time",
        )
    if longest is not None and (most is None or longest.value < most.value):
        raise fault(
            f"the mode logic leaves {name} {'at no time' if most is None else f'by {most.text}'}, "
            f"the rules say {longest.text}",
            _REMEDY,
            "switching",
            "longest_dwell_time",
        )
