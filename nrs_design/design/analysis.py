"""Choose every gain of an interaction design, and compute what the gains achieve.

Gains are rounded to the numbers that ship; poles, cost and margins are for people to judge.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.float32 import round_float32, round_significant
from nrs_design.controllers.laws import NO_MOTION, ProportionalDerivative
from nrs_design.design.doubts import doubt_same
from nrs_design.design.laws import LAW_DESIGNS
from nrs_design.design.laws.force import ForceAnalysis
from nrs_design.design.laws.impedance import ImpedanceAnalysis
from nrs_design.design.laws.law import AbstractControllerAnalysis, Task, naming
from nrs_design.design.laws.torque_impedance import TorqueAnalysis
from nrs_design.design.root_locus import (
    MotionLoopResponse,
    PdDesign,
    design_pd,
    motion_loop_response,
)
from nrs_design.design.transfer import TransferFunction
from nrs_design.errors import DesignError
from nrs_design.models.plant import Plant
from nrs_design.spec import Doubt, InteractionDesignSpec, doubt_spec
from nrs_design.spec.controllers import contact_names
from nrs_design.spec.plausible import worst_first


def design_controllers(spec: InteractionDesignSpec, plant: Plant) -> ControllerDesign:
    """Choose the motion gains by root locus, then every compliant controller on top of them."""
    motion = _motion(spec)
    task = Task(spec, plant, motion)
    controllers = []
    for name, given in spec.controllers.items():
        with naming(name):
            law, optimum = LAW_DESIGNS[given.type].choose(task, given)
        controllers.append(
            Controller(name, law, given.environment, contact_names(given.contacts), optimum)
        )
    return ControllerDesign(motion, tuple(controllers), task.sensor, spec.command, spec.axis)


def root_locus_design(spec: InteractionDesignSpec) -> PdDesign | None:
    """Return the PD of the root locus, not rounded and without given values.

    None where the robot closes its own motion loop.
    """
    motor, loop = spec.actuator, spec.motion_loop
    if motor is None or loop is None:
        return None
    return design_pd(
        motor.gain.nominal.si,
        motor.time_constant.nominal.si,
        float(loop.damping_ratio),
        loop.settling_time.si,
    )


def _motion(spec: InteractionDesignSpec) -> ProportionalDerivative:
    given, digits = spec.motion_loop, spec.design.significant_digits
    target = root_locus_design(spec)
    if target is None or given is None:
        return NO_MOTION
    gain = given.derivative_gain
    Kd = round_significant(target.derivative_gain, digits) if gain is None else gain.exact
    zero = round_significant(target.zero, digits) if given.zero is None else given.zero.exact
    shipped = round_float32(Kd)
    motion = ProportionalDerivative(Kp=round_float32(shipped * zero), Kd=shipped)
    if motion.Kp <= 0 or motion.Kd <= 0:
        raise DesignError(
            "a gain of the motion controller is zero in single precision",
            remedy="ask for a larger derivative gain or zero, or a shorter settling time",
            at=("motion_loop",),
        )
    return motion


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

    # The PD of the root locus; None where the robot closes its own motion loop.
    wanted: PdDesign | None
    motion: TransferFunction  # The motion loop G in use
    motion_source: str  # ``designed`` or ``given``
    reached: MotionLoopResponse  # Poles, damping and overshoot that G really has
    # One for each controller that goals are for, law by law.
    measured: tuple[AbstractControllerAnalysis, ...]
    doubts: tuple[Doubt, ...]  # About the spec, and about all controllers together

    @property
    def impedance(self) -> tuple[ImpedanceAnalysis, ...]:
        """The impedance controllers."""
        return self._select(ImpedanceAnalysis)

    @property
    def force(self) -> tuple[ForceAnalysis, ...]:
        """The force controllers."""
        return self._select(ForceAnalysis)

    @property
    def torque(self) -> tuple[TorqueAnalysis, ...]:
        """The controllers that make torques."""
        return self._select(TorqueAnalysis)

    @property
    def tuned(self) -> tuple[AbstractControllerAnalysis, ...]:
        """All but the impedance controllers, whose gains are optimized instead."""
        return tuple(item for item in self.measured if item not in self.impedance)

    @property
    def warnings(self) -> tuple[Doubt, ...]:
        """Doubts about the spec and its design that no goal settles, the worst first."""
        return worst_first(
            (*self.doubts, *(doubt for item in self.measured for doubt in item.doubts()))
        )

    def _select(self, kind: type[E]) -> tuple[E, ...]:
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
