"""Position control: nothing is chosen, and nothing is measured."""

from __future__ import annotations

from nrs_design.controllers.laws import PositionControl
from nrs_design.design.laws.law import Choice, LawDesign, Task
from nrs_design.spec import PositionControllerSpec


def choose(task: Task, given: PositionControllerSpec) -> Choice:
    """Return the law, which has no gain."""
    return PositionControl(), None


DESIGN = LawDesign(choose)
