"""Parallel control: the gains are given, and where they are stable is decided exactly."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.controller_design import Controller
from nrs_design.design.laws.law import AbstractControllerAnalysis, LawDesign, Task, choose_given
from nrs_design.design.parallel import coefficients, unstable_stiffness
from nrs_design.proof.bounds import lower, lower_float, upper, upper_float
from nrs_design.spec import ParallelControllerSpec


@dataclass(frozen=True)
class ParallelAnalysis(AbstractControllerAnalysis):
    """One parallel controller.

    Parameters
    ----------
    name, achieved
        As for `AbstractControllerAnalysis`; no goals are measured.
    Kp, Ki : Fraction
        That ship, in rad/(N m) and rad/(N m s).
    stiffness : float
        Of nominal contact, in N m/rad.
    decided : bool
        Whether stability is decided for every stiffness: for motion loops of second order.
    unstable : tuple of (Fraction, Fraction or None), or None
        The stiffness in N m/rad for which the loop is not stable, in constant contact.
    """

    Kp: Fraction
    Ki: Fraction
    stiffness: float
    decided: bool
    unstable: tuple[Fraction, Fraction | None] | None

    @property
    def unstable_text(self) -> str:
        """The stiffness that is not stable, in words; ends are rounded away from it."""
        if not self.decided:
            return "not decided"
        if self.unstable is None:
            return "none"
        low, high = self.unstable
        return f"above {lower(low)}" if high is None else f"{lower(low)} to {upper(high)}"

    @property
    def unstable_ends(self) -> list[float | None] | None:
        """The ends of that stiffness as numbers."""
        if self.unstable is None:
            return None
        low, high = self.unstable
        return [lower_float(low), None if high is None else upper_float(high)]


def analyze(task: Task, given: ParallelControllerSpec, controller: Controller) -> ParallelAnalysis:
    """Decide for which stiffness the gains are stable.

    Parameters
    ----------
    task : Task
        With the motion loop.
    given : ParallelControllerSpec
        What the spec says of the controller.
    controller : Controller
        With the gains that ship.
    """
    Kp, Ki = (controller.law.gains[name] for name in ("Kp", "Ki"))
    known = coefficients(task.loop)
    decided = known is not None and min(known) >= 0 and min(known[:2]) > 0
    return ParallelAnalysis(
        controller.name,
        (),
        Kp,
        Ki,
        task.stiffness(given),
        decided,
        unstable_stiffness(task.loop, Kp, Ki) if decided else None,
    )


DESIGN = LawDesign(choose_given, analyze)
