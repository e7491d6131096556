"""What the designed gains achieve: poles, cost and margins, for people to judge."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.design.design import root_locus_design
from nrs_design.design.doubts import doubt_same
from nrs_design.design.laws import LAW_DESIGNS
from nrs_design.design.laws.force import ForceAnalysis
from nrs_design.design.laws.impedance import ImpedanceAnalysis
from nrs_design.design.laws.law import AbstractControllerAnalysis, Task
from nrs_design.design.laws.torque_impedance import TorqueAnalysis
from nrs_design.design.root_locus import MotionLoopResponse, PdDesign, motion_loop_response
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.plant import Plant
from nrs_design.spec import Doubt, InteractionDesignSpec, doubt_spec, worst_first

__all__ = [
    "AbstractControllerAnalysis",
    "DesignAnalysis",
    "ForceAnalysis",
    "ImpedanceAnalysis",
    "TorqueAnalysis",
    "analyze_design",
]

E = TypeVar("E", bound=AbstractControllerAnalysis)


@dataclass(frozen=True, slots=True)
class DesignAnalysis:
    """Everything a person wants to see beside the gains."""

    # What the root locus asks for; None where the robot closes its own motion loop.
    wanted: PdDesign | None
    motion: TransferFunction  # The motion loop G in use
    motion_source: str  # Whether G follows from the PD gains, or the spec states it
    reached: MotionLoopResponse  # Poles, damping and overshoot that G really has
    # One for each controller that goals are for, law by law.
    measured: tuple[AbstractControllerAnalysis, ...]
    doubts: tuple[Doubt, ...]  # About the spec, and about all controllers together

    @property
    def impedance(self) -> tuple[ImpedanceAnalysis, ...]:
        """The impedance controllers."""
        return self._of(ImpedanceAnalysis)

    @property
    def force(self) -> tuple[ForceAnalysis, ...]:
        """The force controllers."""
        return self._of(ForceAnalysis)

    @property
    def torque(self) -> tuple[TorqueAnalysis, ...]:
        """The controllers that make torques."""
        return self._of(TorqueAnalysis)

    @property
    def tuned(self) -> tuple[AbstractControllerAnalysis, ...]:
        """All but the impedance controllers, whose gains are optimized instead."""
        return tuple(item for item in self.measured if item not in self.impedance)

    @property
    def warnings(self) -> tuple[Doubt, ...]:
        """What is doubtful about the spec and its design, and no goal speaks of it, worst first."""
        return worst_first(
            (*self.doubts, *(doubt for item in self.measured for doubt in item.doubts()))
        )

    def _of(self, kind: type[E]) -> tuple[E, ...]:
        return tuple(item for item in self.measured if isinstance(item, kind))


def analyze_design(
    spec: InteractionDesignSpec, plant: Plant, design: ControllerDesign
) -> DesignAnalysis:
    """Compute poles, costs and margins of a design; an unstable nominal loop is a `DesignError`."""
    task = Task(spec, plant, design.motion)
    stated = spec.motion_loop is None or spec.motion_loop.transfer_function is not None
    return DesignAnalysis(
        wanted=root_locus_design(spec),
        motion=task.motion,
        motion_source="given" if stated else "designed",
        reached=motion_loop_response(task.motion),
        measured=tuple(_measured(task, design)),
        doubts=(*doubt_spec(spec), *doubt_same(spec, design)),
    )


def too_stiff(
    spec: InteractionDesignSpec, plant: Plant, design: ControllerDesign
) -> Iterator[Doubt]:
    """Yield the contacts that are too stiff for their controllers, and what would hold.

    It needs no margins, so a nominal loop may be unstable.
    """
    task = Task(spec, plant, design.motion)
    for controller in design.controllers:
        find = LAW_DESIGNS[controller.law.name].too_stiff
        if find is not None:
            yield from find(task, spec.controllers[controller.name], controller)


def _measured(task: Task, design: ControllerDesign) -> Iterator[AbstractControllerAnalysis]:
    for kind, law in LAW_DESIGNS.items():
        for controller in design.controllers:
            if law.analyze is not None and controller.law.name == kind:
                yield law.analyze(task, task.spec.controllers[controller.name], controller)
