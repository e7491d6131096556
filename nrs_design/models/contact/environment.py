"""What the endoscope touches: tissue, tool or hand, with the range of its parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

from nrs_design.errors import AssemblyError, InternalError
from nrs_design.models.contact.elastic import Elastic
from nrs_design.models.contact.kelvin_voigt import KelvinVoigt
from nrs_design.models.contact.law import AbstractLinearLaw, AbstractNonlinearLaw
from nrs_design.models.interval import Interval


@dataclass(frozen=True, slots=True)
class Environment:
    """A linear environment, seen as a rotation about the pivot (thesis 2.5)."""

    name: str  # As in the spec
    law: type[AbstractLinearLaw]  # Law of force and deflection
    # Ranges of the parameters in the order of the law: N m/rad and N m s/rad.
    ranges: tuple[Interval, ...]
    # Environments that are touched at once.
    parts: tuple[Environment, ...] = ()
    each_losable: bool = False  # Each part may separate alone
    # Nonlinear law, which the linear one replaces within a preload.
    nonlinear: type[AbstractNonlinearLaw] | None = None

    @property
    def preloaded(self) -> bool:
        """Whether the ranges hold for deflections off the surface only: contact is kept."""
        return self.nonlinear is not None or any(part.preloaded for part in self.parts)

    @property
    def depends(self) -> bool:
        """Whether stiffness and damping are coupled, so that some corners may not occur."""
        return self.preloaded or (self.each_losable and bool(self.law.parallel_damping))

    @property
    def parameters(self) -> dict[str, Interval]:
        """The ranges by the names of the parameters."""
        return dict(zip(self.law.parameters(), self.ranges, strict=True))

    def evaluate(self, values: Mapping[str, Fraction]) -> AbstractLinearLaw:
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
    def load(self) -> tuple[Interval, Interval]:
        """Ranges of all that a sampled loop takes of it: stiffness and damping, in that order.

        In N m/rad and N m s/rad. An `AssemblyError` if its law has another force.
        """
        for law in self.corners:
            _ = law.load
        damping = self.parameters.get(self.law.parallel_damping, Interval.point(Fraction(0)))
        return self.stiffness, damping

    @property
    def memory_rates(self) -> tuple[Interval, Interval] | None:
        """Ranges of the memory rates of the law in 1/s; None without memory."""
        law_rates = [law.memory_rates for law in (self.nominal, *self.corners)]
        found = [rates for rates in law_rates if rates is not None]
        if not found:
            return None
        decays, follow_rate = (Interval(r[0], min(r), max(r)) for r in zip(*found, strict=True))
        return decays, follow_rate

    def scaled(self, scale: Fraction) -> Environment:
        """Return the environment with its ranges stretched about the nominal values.

        A parameter that the law does not admit any more is an `AssemblyError`.
        """
        if self.parts:
            parts = tuple(part.scaled(scale) for part in self.parts)
            return touch_at_once(parts, losable=self.each_losable)
        ranges = tuple(interval.scaled(scale) for interval in self.ranges)
        triples = zip(self.law.parameters(), self.law.kinds, ranges, strict=True)
        for parameter, kind, interval in triples:
            if fault := self.law.find_fault(parameter, interval.low):
                raise AssemblyError(
                    f"with its ranges scaled by {float(scale):.6g}, environment {self.name} "
                    f"reaches a {kind} {fault}",
                    remedy="scale the ranges by less",
                )
        return replace(self, ranges=ranges)


def touch_at_once(parts: tuple[Environment, ...], *, losable: bool) -> Environment:
    """Return the sum of several springs and dampers that are touched at once.

    Where each may be lost on its own, they are touched from one side, each from where its own
    surface is. With a_j the depth at which part j is met, 0 for the first, the force at the depth
    delta > 0 is ``sum k_j max(0, delta - a_j) = k delta``, and k is at least the stiffness of the
    first part and at most the sum, whatever the a_j are and however the k_j move.
    """
    if odd := [part.name for part in parts if part.law.has_mass or part.law.has_memory]:
        raise InternalError(f"mass or memory of {odd[0]} would be left out")
    stiffness, dampings = zip(*(part.load for part in parts), strict=True)
    total = _sum(stiffness)
    if losable:
        total = Interval(total.nominal, min(k.low for k in stiffness), total.high)
    name = "+".join(part.name for part in parts)
    damped = any(part.law.parallel_damping for part in parts)
    law, ranges = (KelvinVoigt, (total, _sum(dampings))) if damped else (Elastic, (total,))
    return Environment(name, law, ranges, parts, losable)


def _sum(intervals: Sequence[Interval]) -> Interval:
    ends = ((i.nominal, i.low, i.high) for i in intervals)
    nominal, low, high = (sum(values, Fraction(0)) for values in zip(*ends, strict=True))
    return Interval(nominal, low, high)
