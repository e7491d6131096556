"""One design of a trade-off: gains, what they cost, and what is proved of them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.bounds import bound_on
from nrs_design.certificates.goals import decay_rate
from nrs_design.design.objective import Objective
from nrs_design.pipeline.certification import Result, run_certification
from nrs_design.pipeline.design import Designed, run_analysis
from nrs_design.pipeline.written_gains import Written

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec


@dataclass(frozen=True, slots=True)
class TradeOffPoint:
    """Gains, what they cost, and what is proved of them."""

    share: Fraction | None  # By how much the cost might be above the least; None: the free optimum
    cost: float  # Summed over the controllers
    gains: Written  # What ships of the free ones
    result: Result  # Of the spec with these gains and ranges; its certificate was checked exactly
    rate: Fraction  # Proved, 1/s
    # Gains that `design.free` names and that are on a bound, and on which.
    at_bounds: tuple[tuple[str, str], ...] = ()

    @property
    def designed(self) -> Designed:
        """The spec with these gains."""
        assert self.result.designed is not None, "as it has gains"
        return self.result.designed

    @property
    def stiffness(self) -> dict[str, Fraction]:
        """Upper end of the stiffness of every contact, N m/rad."""
        touched = self.designed.plant.among(self.designed.design.contacts)
        return {environment.name: environment.stiffness.high for environment in touched}

    @property
    def delay(self) -> Fraction | None:
        """Age of the oldest force sample for which it is proved, s; None without samples."""
        sampling = self.designed.spec.sampling
        return None if sampling is None else sampling.oldest

    @property
    def force(self) -> Fraction | None:
        """Proved bound on the force under all disturbances of the spec, N m; None without any."""
        found = self.result.certificate
        bound = None if found is None else bound_on(found.system, found.statements, "force")
        return None if bound is None else bound.level

    @property
    def noise(self) -> float | None:
        """The largest of `noises`, rad/s per N m; None without samples."""
        gains = {
            name: {gain: float(value) for gain, value in law.gains.items()}
            for name, law in self.designed.design.laws.items()
        }
        return max(noises(self.designed, gains), default=None)

    def value(self, objective: Objective) -> float | None:
        """Return what it achieves, in SI units; of several contacts, the first one counts.

        Parameters
        ----------
        objective : Objective
            Of what.
        """
        found = {
            Objective.STIFFNESS: next(iter(self.stiffness.values()), None),
            Objective.DECAY_RATE: self.rate,
            Objective.DELAY: self.delay,
            Objective.PEAK_TORQUE: self.force,
            Objective.NOISE: self.noise,
        }[objective]
        return None if found is None else float(found)


def noises(designed: Designed, gains: dict[str, dict[str, float]]) -> list[float]:
    """Return what white noise of the force becomes in each impedance controller, rad/s per N m.

    Parameters
    ----------
    designed : Designed
        With the period of the admittances; without samples there is none.
    gains : dict
        By controller and name, SI units.
    """
    from nrs_design.design.admittance_noise import noise_gain

    sampling = designed.spec.sampling
    if sampling is None:
        return []
    period = float(sampling.outer)
    return [
        noise_gain(own["Mt"], own["Bt"], period, sampling.admittance)
        for own in gains.values()
        if "Bt" in own
    ]


def given_point(loaded: LoadedSpec) -> TradeOffPoint | None:
    """Return the design of a spec as it stands; None if nothing is proved of it.

    Parameters
    ----------
    loaded : LoadedSpec
        An interaction design.

    Raises
    ------
    DesignError
        If it has no gains, or its nominal loop is unstable.
    """
    result = run_certification(loaded)
    rate = decay_rate(result.certificate)
    if rate is None or result.designed is None:
        return None
    analysis, design = run_analysis(result.designed), result.designed.design
    gains = {
        (name, gain): f"{float(value):.6g} {design.units[name][gain]}"
        for name, law in design.laws.items()
        for gain, value in law.gains.items()
        if name in {item.name for item in analysis.impedance}
    }
    return TradeOffPoint(None, sum(item.cost for item in analysis.impedance), gains, result, rate)


def is_dominated(
    point: TradeOffPoint, others: list[TradeOffPoint], objectives: tuple[Objective, ...]
) -> bool:
    """Tell whether another design costs no more, is no worse in any objective, and better in one.

    Parameters
    ----------
    point : TradeOffPoint
        The design.
    others : list of TradeOffPoint
        All that are known.
    objectives : tuple of Objective
        What counts beside cost.
    """

    def losses(one: TradeOffPoint) -> list[float]:
        values = ((o, one.value(o)) for o in objectives)
        own = (v if o.is_smallest else -v for o, v in values if v is not None)
        return [one.cost, *own]

    mine = losses(point)
    return any(
        theirs != mine and all(a <= b for a, b in zip(theirs, mine, strict=True))
        for theirs in map(losses, others)
    )
