"""What the designed gains achieve: poles, cost and margins, for people to judge."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.design.design import root_locus_design
from nrs_design.design.laws import LAW_DESIGNS
from nrs_design.design.laws.force import ForceEvidence
from nrs_design.design.laws.impedance import ImpedanceEvidence
from nrs_design.design.laws.law import AbstractControllerEvidence, Task
from nrs_design.design.root_locus import MotionLoopResponse, PdDesign, motion_loop_response
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.plant import Plant
from nrs_design.spec import Doubt, InteractionDesignSpec

__all__ = [
    "AbstractControllerEvidence",
    "DesignEvidence",
    "ForceEvidence",
    "ImpedanceEvidence",
    "examine_design",
]

E = TypeVar("E", bound=AbstractControllerEvidence)


@dataclass(frozen=True, slots=True)
class DesignEvidence:
    """Everything a person wants to see beside the gains.

    Parameters
    ----------
    wanted : PdDesign
        What the root locus asks for.
    motion : TransferFunction
        The motion loop G in use.
    motion_source : {"designed", "given"}
        Whether G follows from the PD gains, or the spec states it.
    reached : MotionLoopResponse
        Poles, damping and overshoot that G really has.
    measured : tuple of AbstractControllerEvidence
        One for each controller that goals are for, law by law.
    """

    wanted: PdDesign
    motion: TransferFunction
    motion_source: str
    reached: MotionLoopResponse
    measured: tuple[AbstractControllerEvidence, ...]

    @property
    def impedance(self) -> tuple[ImpedanceEvidence, ...]:
        """The impedance controllers."""
        return self._of(ImpedanceEvidence)

    @property
    def force(self) -> tuple[ForceEvidence, ...]:
        """The force controllers."""
        return self._of(ForceEvidence)

    @property
    def tuned(self) -> tuple[AbstractControllerEvidence, ...]:
        """All but the impedance controllers, whose gains are optimized instead."""
        return tuple(item for item in self.measured if item not in self.impedance)

    @property
    def warnings(self) -> tuple[Doubt, ...]:
        """What is doubtful about the design, and no goal speaks of it."""
        return tuple(doubt for item in self.measured for doubt in item.doubts())

    def _of(self, kind: type[E]) -> tuple[E, ...]:
        return tuple(item for item in self.measured if isinstance(item, kind))


def examine_design(
    spec: InteractionDesignSpec, plant: Plant, design: ControllerDesign
) -> DesignEvidence:
    """Compute poles, costs and margins of a design.

    Parameters
    ----------
    spec : InteractionDesignSpec
        What was asked for.
    plant : Plant
        That it describes.
    design : ControllerDesign
        As `nrs_design.design.design.design_controllers` gives it.

    Raises
    ------
    DesignError
        If a nominal loop is unstable, so that it has no margins.
    """
    task = Task(spec, plant, plant.motion_loop(design.motion.Kp, design.motion.Kd))
    return DesignEvidence(
        wanted=root_locus_design(spec),
        motion=task.motion,
        motion_source="designed" if spec.motion_loop.transfer_function is None else "given",
        reached=motion_loop_response(task.motion),
        measured=tuple(_measured(task, design)),
    )


def _measured(task: Task, design: ControllerDesign) -> Iterator[AbstractControllerEvidence]:
    for kind, law in LAW_DESIGNS.items():
        for controller in design.controllers:
            if law.examine is not None and controller.law.name == kind:
                yield law.examine(task, task.spec.controllers[controller.name], controller)
