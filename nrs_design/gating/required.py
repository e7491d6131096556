"""What a spec asks of its design: a lock file must say how each of it ended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from nrs_design.gating.rules import GOAL, RESPONSE_GOAL, SCENARIO_LIMIT, STIFFNESS_RANGE
from nrs_design.spec.goals import OF_THE_CERTIFICATE, ONLY_FOR

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec, Spec

Asked = tuple[str, str]  # The id of a rule, and the subject
_RESPONSES = ("transparency", "accuracy")
# A design without margins has this in the place of all that is asked of controllers.
_NO_MARGINS = (STIFFNESS_RANGE.id, "controllers")


def find_missing(spec: Spec, locked: Mapping[Asked, str]) -> tuple[Asked, ...]:
    """Return what a spec asks of its design, and is not locked, each with its status."""
    if spec.kind != "interaction-design":
        return ()
    # What could not be judged stands for all that was asked of it, and is never met.
    unjudged = {one for one, status in locked.items() if status != "met"}
    asked = () if _NO_MARGINS in unjudged else tuple(_of_controllers(spec))
    limits = (one for one in _of_scenarios(spec) if (one[0], one[1].split(":")[0]) not in unjudged)
    return tuple(one for one in (*asked, *limits) if one not in locked)


def _of_scenarios(spec: InteractionDesignSpec) -> Iterator[Asked]:
    for name, scenario in spec.scenarios.items():
        for quantity in () if scenario.limits is None else scenario.limits.named:
            yield SCENARIO_LIMIT.id, f"{name}: {quantity}"


def _of_controllers(spec: InteractionDesignSpec) -> Iterator[Asked]:
    sampling = spec.sampling
    # A force that is sampled more often than the motion loop has no such limit.
    limited = sampling is None or sampling.outer >= sampling.period.exact
    for name, controller in spec.controllers.items():
        if controller.limits_stiffness and limited:
            yield STIFFNESS_RANGE.id, name
        given = (spec.goals, getattr(controller, "goals", None))
        keys = {key for goals in given if goals is not None for key, _ in goals.given()}
        for key in sorted(keys - OF_THE_CERTIFICATE):
            if "goals" in type(controller).model_fields and ONLY_FOR.get(key, controller.type) == (
                controller.type
            ):
                yield (RESPONSE_GOAL if key in _RESPONSES else GOAL).id, f"{name}: {key}"
