"""What the endoscope touches: tissue, tool or hand, with the range of its parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from nrs_design.errors import AssemblyError
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.spec.interval import Interval


@dataclass(frozen=True, slots=True)
class Environment:
    """A linear environment, seen as a rotation about the pivot (thesis 2.5).

    Parameters
    ----------
    name : str
        As in the spec.
    law : type of AbstractLinearLaw
        What relates its force to its deflection.
    ranges : tuple of Interval
        Of the parameters, in the order of the law: N m/rad and N m s/rad.
    """

    name: str
    law: type[AbstractLinearLaw]
    ranges: tuple[Interval, ...]

    @property
    def parameters(self) -> dict[str, Interval]:
        """The ranges by the names of the parameters."""
        return dict(zip(self.law.parameters(), self.ranges, strict=True))

    def at(self, values: Mapping[str, Fraction]) -> AbstractLinearLaw:
        """Return the law at values of its parameters, by name; other names are left alone."""
        return self.law(*(values[name] for name in self.law.parameters()))

    @property
    def nominal(self) -> AbstractLinearLaw:
        """The law at the nominal parameters."""
        return self.law(*(interval.nominal for interval in self.ranges))

    @property
    def corners(self) -> Iterator[AbstractLinearLaw]:
        """The law at every corner of the ranges, the last parameter turning fastest."""
        for ends in product(*(interval.ends for interval in self.ranges)):
            yield self.law(*(value for _, value in ends))

    @property
    def stiffness(self) -> Interval:
        """Range of the stiffness that a sudden motion meets, in N m/rad."""
        return self.ranges[self.law.parameters().index(self.law.front)]

    @property
    def creep(self) -> Interval | None:
        """Range of the rate in 1/s at which it creeps back without force; None if at once."""
        rates = [rate for law in (self.nominal, *self.corners) if (rate := law.creep) is not None]
        return Interval(rates[0], min(rates), max(rates)) if rates else None

    def scaled(self, scale: Fraction) -> Environment:
        """Return the environment with its ranges stretched about the nominal values.

        Raises
        ------
        AssemblyError
            If a parameter would reach a value that the law does not admit.
        """
        ranges = tuple(interval.scaled(scale) for interval in self.ranges)
        for index, interval in enumerate(ranges):
            if self.law.admits(index, interval.low):
                continue
            raise AssemblyError(
                f"with its ranges scaled by {float(scale):.6g}, environment {self.name} reaches a "
                f"{self.law.kinds[index]} that no elastic or damped material has",
                remedy="scale the ranges by less",
            )
        return Environment(self.name, self.law, ranges)
