"""One quadratic function per mode, for dwell times, transition graphs and resets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence.fields import (
    Matrix,
    matrix_fields,
    rate_words,
    read_dyadic,
    read_integer,
    read_ratio,
    read_text,
)
from nrs_design.proof.evidence.flow import enclosed_form, power
from nrs_design.proof.evidence.function import AbstractFunction, is_square
from nrs_design.proof.exact import (
    MAX_WORK,
    IntegerMatrix,
    add,
    congruence,
    is_positive_semidefinite,
    is_symmetric,
    is_too_large,
    lyapunov_decrease,
    scaled,
    stein_decrease,
    step_decrease,
)
from nrs_design.proof.matrix import RationalMatrix, multiply
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Edge, Stay, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted

MAX_DWELL_STEPS = 4096
MAX_PIECES = 4096
MAX_ENCLOSED = 2**18
MAX_NAMED = 8
MAX_SWITCHES = 2**20
MAX_POWER_BITS = 10**6


@dataclass(frozen=True, slots=True)
class ModeQuadratic(AbstractFunction):
    """``V_i(x) = x' Q_i x`` decreases from switch to switch.

    With ``B_i = A_i + alpha I``, for every edge from i to j with reset map G, and a stay of t in i:
    ``exp(B_i t)' G' Q_j G exp(B_i t) <= Q_i``. Where V_i decreases in its own mode, it suffices to
    show this for the shortest stay (Geromel and Colaneri 2006, for a dwell time; thesis 5.13, for
    none). A mode that must be left may be unstable: there it is shown for every stay from the
    shortest to the longest. In discrete time ``A_i / rho`` and its powers.
    """

    kind: ClassVar[str] = "mode-quadratic"
    allows_unequal_modes: ClassVar[bool] = True

    # Mode names and the integer numerators of their Q_i, in the order of the modes.
    functions: tuple[tuple[str, Matrix], ...]
    denominator_log2: int  # All Q_i are these numerators over two to this power
    rate: Fraction  # alpha in 1/s, or rho per step
    # Modes in which V_i need not decrease, because they have a longest dwell time.
    leaving: tuple[str, ...] = ()
    # In continuous time, each stay in such a mode is enclosed in so many equal pieces.
    pieces: int = 1

    def fits(self, switching: Switching) -> bool:
        """Tell whether every mode in force is one of the modes.

        A constant parameter is anywhere between its ends, where a function for each end says
        nothing about it.
        """
        return not switching.fixed_ends

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: its bound has a constant factor anyway."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check shapes, rate, stays and, where a switch may come at once, the switches."""
        if [name for name, _ in self.functions] != [mode.name for mode in system.modes]:
            return "there is not one function for each mode"
        for mode, (_, Q) in zip(system.modes, self.functions, strict=True):
            if not is_square(Q, mode.A.shape[0]):
                return f"Q of mode {mode.name} has the wrong size"
        return (
            find_odd_switch(system)
            or self.find_rate_misfit(system.time)
            or self._find_odd_stay(system)
            or self._find_raising_switch(system)
        )

    def _find_odd_stay(self, system: SwitchedSystem) -> str | None:
        """Check that the stays to be shown are few, short and, in discrete time, whole."""
        stays = system.stays()
        if len(set(self.leaving)) < len(self.leaving) or not set(self.leaving) <= stays.keys():
            return "the modes that must be left are not those of the system"
        if any(stays[name].longest is None for name in self.leaving):
            return "a mode in which the function need not decrease has no longest dwell time"
        times = [stay.shortest for stay in stays.values()]
        times += [longest for stay in stays.values() if (longest := stay.longest) is not None]
        if max(times) > MAX_DWELL_STEPS:
            return "the dwell time is too long"
        if system.time is Time.DISCRETE and any(time.denominator != 1 for time in times):
            return "the dwell time is not a whole number of steps"
        enclosed = self.pieces * sum(e.source.name in self.leaving for e in system.edges())
        if not 1 <= self.pieces <= MAX_PIECES or enclosed > MAX_ENCLOSED:
            return "the stays are enclosed in too few or too many pieces"
        if system.time is Time.DISCRETE and _power_is_too_large(system, self):
            return "the dwell time is too long for such large numbers"
        return None

    def _find_raising_switch(self, system: SwitchedSystem) -> str | None:
        """Check the switches that may follow each other at once: exact, equality allowed."""
        Q, stays = dict(self.functions), system.stays()
        for edge in system.edges():
            if stays[edge.source.name].shortest > 0 or edge.source.name in self.leaving:
                continue
            jump = _jump(edge, Q)
            if is_too_large(jump):
                return f"the numbers at the switch from {edge.source.name} are too large to check"
            if not is_symmetric(jump) or not is_positive_semidefinite(jump):
                return f"the switch {_words(edge)} raises the function"
        return None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield every Q_i, and every decrease."""
        for name, Q in self.functions:
            yield f"Q of mode {name} is not symmetric and positive definite", Q
        yield from self.decreases(system)

    def decreasing_modes(self, system: SwitchedSystem) -> list[Mode]:
        """Return the mode in which each of the decreases begins, in their order.

        For discrete time, where every stay takes steps.
        """
        stays = system.stays()
        counts = {
            name: len(_steps(stay)) if name in self.leaving else 1 for name, stay in stays.items()
        }
        modes = [mode for mode in system.modes if mode.name not in self.leaving]
        return modes + [e.source for e in system.edges() for _ in range(counts[e.source.name])]

    def decreases(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield the decrease in every mode, and at the switches after every stay that counts."""
        form = lyapunov_decrease if system.time is Time.CONTINUOUS else stein_decrease
        Q, stays = dict(self.functions), system.stays()
        for mode in system.modes:
            A = mode.A
            if mode.name not in self.leaving:
                failure = f"V does not decrease at the claimed rate in mode {mode.name}"
                yield failure, form(A.numerators, A.denominator, Q[mode.name], self.rate)
        for edge in system.edges():
            stay = stays[edge.source.name]
            if edge.source.name in self.leaving:
                failure = f"after some stay, {_words(edge)} raises the function"
                yield from ((failure, form) for form in self._stay_forms(system, edge, stay, Q))
            elif stay.shortest > 0:
                failure = f"after the dwell time, {_words(edge)} raises the function"
                yield failure, self._form_after(system, edge, stay.shortest, stay.shortest, Q)

    def _stay_forms(
        self, system: SwitchedSystem, edge: Edge, stay: Stay, Q: Mapping[str, Matrix]
    ) -> Iterator[IntegerMatrix]:
        """Yield a form for each number of steps, or for each piece of the times in a mode."""
        if system.time is Time.DISCRETE:
            for steps in _steps(stay):
                yield self._form_after(system, edge, Fraction(steps), Fraction(steps), Q)
            return
        assert stay.longest is not None
        width = (stay.longest - stay.shortest) / self.pieces
        for k in range(self.pieces):
            begin = stay.shortest + k * width
            yield self._form_after(system, edge, begin, begin + width, Q)

    def _form_after(
        self,
        system: SwitchedSystem,
        edge: Edge,
        begin: Fraction,
        end: Fraction,
        Q: Mapping[str, Matrix],
    ) -> IntegerMatrix:
        """Return a matrix whose definiteness shows that no switch in that time raises V."""
        if system.time is Time.CONTINUOUS:
            return enclosed_form(edge, (begin, end), Q, self.rate)
        flow = power(edge.source.A, int(begin))
        jump = flow
        if edge.map is not None:
            jump = RationalMatrix.from_rows(multiply(edge.map.fractions(), flow.fractions()))
        image = congruence(jump.numerators, Q[edge.target.name])
        return step_decrease(Q[edge.source.name], image, jump.denominator, self.rate ** int(begin))

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution."""
        return bound_claim(system, self.rate)

    def spread(self, merged: SwitchedSystem, system: SwitchedSystem) -> Self:
        """Repeat the function of every mode for its equals, between which nothing changes."""
        forms = {mode.A: Q for mode, (_, Q) in zip(merged.modes, self.functions, strict=True)}
        return replace(self, functions=tuple((mode.name, forms[mode.A]) for mode in system.modes))

    def to_fields(self) -> dict[str, Any]:
        """Return the functions, the rate, and what is known of modes that must be left."""
        leaving = {"leaving": list(self.leaving), "pieces": self.pieces} if self.leaving else {}
        return {
            "functions": [
                {"mode": name, "Q": matrix_fields(Q, self.denominator_log2)}
                for name, Q in self.functions
            ],
            "rate": str(self.rate),
            **leaving,
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the functions, the rate, and what is said of modes that must be left."""
        functions, exponents = [], set()
        for item in fields["functions"]:
            Q, exponent = read_dyadic(item["Q"])
            functions.append((read_text(item["mode"]), Q))
            exponents.add(exponent)
        if len(exponents) != 1:
            raise ValueError("the functions do not share one denominator")
        leaving = tuple(read_text(name) for name in fields.get("leaving", ()))
        pieces = read_integer(fields.get("pieces", 1))
        return cls(tuple(functions), exponents.pop(), read_ratio(fields["rate"]), leaving, pieces)


def find_odd_switch(system: SwitchedSystem) -> str | None:
    """Say which switch has no reset between modes of different sizes, or one that does not fit.

    So many switches that checking them would take minutes are refused, too.
    """
    count, transitions = len(system.modes), system.switching.transitions
    switches = count * (count - 1) if transitions is None else len(transitions)
    switches += len(system.switching.resets)
    if switches > MAX_SWITCHES or switches * system.order**3 > MAX_WORK:
        return "there are too many switches to check"
    for edge in system.edges():
        given = edge.source.A.shape if edge.map is None else edge.map.shape
        if given != (edge.target.A.shape[0], edge.source.A.shape[0]):
            return f"the switch {_words(edge)} has no fitting reset"
    return None


def bound_claim(system: SwitchedSystem, rate: Fraction) -> str:
    """State a bound, up to a constant factor, on every solution that keeps the rules."""
    continuous = system.time is Time.CONTINUOUS
    law, bound = ("x' = A x", "exp(-alpha t)") if continuous else ("x+ = A x", "rho^t")
    return (
        f"Every solution of {law} under the declared switching ({signals_of(system)}) satisfies "
        f"|x(t)| <= c {bound} |x(0)| with {rate_words(rate, system.time)} and some constant c "
        "that is the same for all signals."
    )


def signals_of(system: SwitchedSystem) -> str:
    """Say which switching signals a system has."""
    switching = system.switching
    unit = "s" if system.time is Time.CONTINUOUS else "steps"
    parts = []
    if switching.dwell_time > 0:
        others = "each other mode" if switching.stays else "each mode"
        parts.append(f"{_time_words(Stay(switching.dwell_time), unit)} in {others}")
    parts += [f"{_time_words(stay, unit)} in {name}" for name, stay in switching.stays[:MAX_NAMED]]
    if len(switching.stays) > MAX_NAMED:
        parts.append(f"{len(switching.stays)} modes with dwell times of their own")
    if switching.transitions is not None:
        parts.append(counted(len(switching.transitions), "allowed transition"))
    if switching.resets:
        parts.append(counted(len(switching.resets), "reset"))
    return ", ".join(parts) or "arbitrary"


def _time_words(stay: Stay, unit: str) -> str:
    """Say how long a mode stays, rounded so that no other stay is claimed to be covered."""
    if stay.longest is None:
        return f"at least {rounded_up(stay.shortest, _unit(unit, stay.shortest))}"
    last = rounded_down(stay.longest, _unit(unit, stay.longest))
    return f"{rounded_up(stay.shortest)} to {last}" if stay.shortest > 0 else f"at most {last}"


def _unit(unit: str, time: Fraction) -> str:
    return "step" if unit == "steps" and time == 1 else unit


def _words(edge: Edge) -> str:
    return f"from {edge.source.name} to {edge.target.name}"


def _jump(edge: Edge, Q: Mapping[str, Matrix]) -> IntegerMatrix:
    """Return a positive multiple of ``Q_i - G' Q_j G``."""
    before, after, reset = Q[edge.source.name], Q[edge.target.name], edge.map
    if reset is None:
        return add(before, after, -1)
    left = scaled(before, reset.denominator**2)
    return add(left, congruence(reset.numerators, after), -1)


def _steps(stay: Stay) -> range:
    """Return the numbers of steps of a stay that ends, from the shortest to the longest."""
    assert stay.longest is not None
    return range(int(stay.shortest), int(stay.longest) + 1)


def _power_is_too_large(system: SwitchedSystem, evidence: ModeQuadratic) -> bool:
    """Tell whether the powers would take more than some seconds, one by one or all together."""
    numbers = [v for mode in system.modes for row in mode.A.numerators for v in row]
    numbers += [mode.A.denominator for mode in system.modes]
    bits = max(abs(v).bit_length() for v in (*numbers, evidence.rate.denominator))
    stays, total, largest = system.stays(), 0, 0
    for edge in system.edges():
        stay = stays[edge.source.name]
        if edge.source.name in evidence.leaving:
            total += sum(_steps(stay))
            largest = max(largest, _steps(stay)[-1])
        largest = max(largest, int(stay.shortest))
    work = system.order**3 * bits
    return largest * bits > MAX_POWER_BITS or largest * work > MAX_WORK or total * work > MAX_WORK
