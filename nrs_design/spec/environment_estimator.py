"""Which of two environments is touched, told by stiffness while the axis moves (thesis 6.4).

Torque over travel, between two samples, is the stiffness up to noise, age and encoder steps. From
a travel on that these cannot hide, it is on the right side of the middle between both ranges. A
segment across a change may say anything, and no more than two segments can lie across one, as none
is shorter than the age of the torque: so two in a row that agree decide, once for each change.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from pydantic import Field

from nrs_design.proof.bounds import upper
from nrs_design.proof.text import exact_text
from nrs_design.spec.controllers import ControllerSpec
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.faults import fault
from nrs_design.spec.model import SpecModel
from nrs_design.spec.quantity_fields import Angle, AngularVelocity, Duration
from nrs_design.spec.switching import DwellTime, SwitchingSpec
from nrs_design.spec.threshold_logic import TorqueSignalSpec

DIGITS = 4


class EstimatorSignalsSpec(SpecModel):
    """What the estimator sees."""

    torque: TorqueSignalSpec = Field(description="torque of the environment on the robot")
    position_step: Angle = Field(
        description="resolution of the measured angle of the axis in rad: an error of half a step"
    )


class EstimatorSpec(SpecModel):
    """Two controllers, each for one environment, and an estimator that tells which is touched."""

    type: Literal["estimator"] = Field(
        description="estimator: torque over travel tells which environment is touched"
    )
    signals: EstimatorSignalsSpec = Field(description="what the estimator sees, and how well")
    period: Duration = Field(description="time between two steps of the estimator in s")
    slowest_speed: AngularVelocity = Field(
        description="from a change of the environment to the decision, the axis moves in one "
        "direction, at least so fast, in rad/s"
    )
    shortest_contact: Duration = Field(
        description="shortest time in s from one change of the environment to the next"
    )

    @property
    def thresholds(self) -> None:
        """There are none that a program could follow."""
        return

    def lost_names(self, controllers: Mapping[str, object]) -> tuple[str, ...]:
        """Return none: it names no controller."""
        return ()

    def rules_among(
        self, controllers: Mapping[str, ControllerSpec], environments: Mapping[str, EnvironmentSpec]
    ) -> SwitchingSpec:
        """Return the rules that it keeps among them, or report why it keeps none."""
        return decide(self, controllers, environments).rules()


@dataclass(frozen=True, slots=True)
class EstimatorDecision:
    """How an estimator decides, and how late."""

    # softer, stiffer: controllers for the two environments.
    softer: str
    stiffer: str
    environments: tuple[str, str]  # The softer and the stiffer one
    limit: Fraction  # Stiffness in N m/rad from which on it is the stiffer one
    travel: Fraction  # Measured travel of a segment at least, in rad
    delay: Fraction  # From a change to the decision at most, in s, rounded up
    stay: Fraction  # Time that remains until the next change at least, in s, rounded down

    def rules(self) -> SwitchingSpec:
        """Return the switching signals: right for long, wrong for the delay of the decision."""
        soft, stiff = self.environments
        right = f"{self.softer}/{soft}", f"{self.stiffer}/{stiff}"
        wrong = f"{self.softer}/{stiff}", f"{self.stiffer}/{soft}"
        stay = DwellTime(f"{exact_text(self.stay)} s", self.stay, "s")
        delay = DwellTime(f"{exact_text(self.delay)} s", self.delay, "s")
        return SwitchingSpec(
            dwell_time=dict.fromkeys(right, stay),
            longest_dwell_time=dict.fromkeys(wrong, delay),
            transitions=(
                (right[0], wrong[0]),
                (wrong[0], right[1]),
                (right[1], wrong[1]),
                (wrong[1], right[0]),
            ),
        )


def decide(
    estimator: EstimatorSpec,
    controllers: Mapping[str, ControllerSpec],
    environments: Mapping[str, EnvironmentSpec],
) -> EstimatorDecision:
    """Derive how an estimator decides.

    Parameters
    ----------
    estimator : EstimatorSpec
        What it sees.
    controllers : mapping of str to ControllerSpec
        Two, each for another environment, that may both touch either.
    environments : mapping of str to EnvironmentSpec
        Springs.

    Raises
    ------
    PydanticCustomError
        If nothing can be told, or not before the next change.
    """
    (soft, softer), (stiff, stiffer) = _ordered(controllers, environments)
    below = environments[soft].exact_at_pivot()["stiffness"].high
    above = environments[stiff].exact_at_pivot()["stiffness"].low
    if below >= above:
        raise fault(
            f"no stiffness tells {soft!r} from {stiff!r}: their ranges overlap",
            "narrow the ranges, or prove arbitrary switching without an estimator",
            "mode_logic",
        )
    torque, age = estimator.signals.torque, estimator.signals.torque.age.exact
    slowest = estimator.slowest_speed
    if slowest.not_above * environments[stiff].exact_at_pivot()["stiffness"].high > (
        torque.largest_rate.not_below
    ):
        raise fault(
            f"at {slowest.text} the torque of {stiff!r} changes faster than the largest_rate, "
            f"{torque.largest_rate.text}: both cannot hold",
            "declare a largest_rate that is no less than the stiffness times the highest speed",
            "mode_logic",
            "signals",
            "torque",
            "largest_rate",
        )
    noise = torque.noise.not_below + torque.largest_rate.not_below * age
    error = estimator.signals.position_step.not_below / 2
    travel = 4 * (noise + error * above) / (above - below)
    moving = (travel + 2 * error) / slowest.not_above
    segment = max(moving, age) + estimator.period.exact
    delay = Fraction(upper(age + 3 * segment, DIGITS))
    contact = estimator.shortest_contact
    stay = contact.exact - delay
    if stay <= 0:
        raise fault(
            f"a decision may take {upper(delay)} s, but the environment may change every "
            f"{contact.text}",
            "declare a longer shortest_contact, a higher slowest_speed, or less noise",
            "mode_logic",
            "shortest_contact",
        )
    return EstimatorDecision(
        softer, stiffer, (soft, stiff), (below + above) / 2, travel, delay, stay
    )


def _ordered(
    controllers: Mapping[str, ControllerSpec], environments: Mapping[str, EnvironmentSpec]
) -> list[tuple[str, str]]:
    """Return environment and controller, the softer environment first."""
    own = {c.environment: name for name, c in controllers.items() if c.environment is not None}
    both = {frozenset(c.contacts) for c in controllers.values()}
    if len(controllers) != 2 or len(own) != 2 or both != {frozenset(own)}:
        raise fault(
            "an estimator tells two environments apart, with a controller for each: both must list "
            "both environments as contacts",
            "write `contacts: [a, b]` in two controllers, one with `environment: a`, one with "
            "`environment: b`",
            "mode_logic",
        )
    for name in own:
        if not environments[name].is_losable:
            raise fault(
                f"{name!r} is {environments[name].model}: an estimator tells springs apart",
                "use elastic environments",
                "environments",
                name,
                "model",
            )
    return sorted(
        own.items(), key=lambda item: environments[item[0]].exact_at_pivot()["stiffness"].nominal
    )
