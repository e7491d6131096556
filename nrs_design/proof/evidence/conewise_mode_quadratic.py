"""One quadratic function per mode, in contact and free, while contact comes and goes in steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence.conewise_quadratic import NO_CONTACT
from nrs_design.proof.evidence.fields import (
    Matrix,
    matrix_fields,
    rate_words,
    read_dyadic,
    read_integer,
    read_ratio,
    read_text,
)
from nrs_design.proof.evidence.function import AbstractFunction, is_square
from nrs_design.proof.exact import (
    MAX_WORK,
    IntegerMatrix,
    congruence,
    stein_factor,
    step_decrease,
)
from nrs_design.proof.matrix import leading, with_crossing
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted

Functions = tuple[tuple[str, Matrix], ...]
Forms = Iterator[tuple[str, IntegerMatrix]]


@dataclass(frozen=True, slots=True)
class ConewiseModeQuadratic(AbstractFunction):
    """``V_i(x) = x' Q_i x`` in contact and ``V_f(y) = y' R_f y`` free decrease in every step.

    The i or f of a state is the mode that takes the next step. With N the rows of y of a map and c
    that of delta:

    - contact to contact: ``rho^2 Q_i - A_i' Q_j A_i > 0``;
    - contact to free: ``rho^2 Q_i - N_i' R_f N_i + lambda_f (e c_i + c_i' e') > 0`` with one
      lambda >= 0 for each f, since there ``delta c_i x <= 0``;
    - free to free: ``rho^2 R_f - N_f' R_g N_f > 0``;
    - free to contact: the depth after landing lies between 0 and ``c y``, V_j is convex in it, so
      both ends suffice: ``rho^2 R_f - (N_f, c_f)' Q_j (N_f, c_f) > 0`` and
      ``rho^2 R_f - N_f' Q_j,yy N_f > 0``;

    for all i, j in contact and f, g free. A convex combination of modes has that of their
    functions, and the conditions hold for it: they are affine in the functions, and concave in a
    map. So the largest of all functions decreases too, whatever comes next.
    """

    kind: ClassVar[str] = "conewise-mode-quadratic"
    bounds_at_once: ClassVar[bool] = True
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True

    # touching, flying: names and integer numerators of the Q_i, shape (n, n), and R_f, shape (n -
    # 1, n - 1), in the order of the modes.
    touching: Functions
    flying: Functions
    denominator_log2: int  # All of them, and the multipliers, are over two to this power
    rate: Fraction  # The rho per step
    multipliers: tuple[int, ...]  # The lambda_f

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: the largest of all functions is convex in contact, and free."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that contact can be lost in steps, shapes, and the signs of the multipliers."""
        contact, n = system.contact, system.order
        if contact is None:
            return NO_CONTACT
        if system.time is not Time.DISCRETE:
            return "functions of each mode for lost contact are for discrete time"
        if contact.pulls:
            return "in discrete time, an environment that could pull is not covered"
        given = [name for name, _ in self.touching], [name for name, _ in self.flying]
        if given != ([m.name for m in system.modes], [m.name for m in contact.free]):
            return "there is not one function for each mode"
        if not all(is_square(Q, n) for _, Q in self.touching):
            return f"a function in contact is not a {n} x {n} matrix"
        if not all(is_square(R, n - 1) for _, R in self.flying):
            return f"a function of free motion is not a {n - 1} x {n - 1} matrix"
        if len(self.multipliers) != len(contact.free) or min(self.multipliers) < 0:
            return "there is not one multiplier >= 0 for each free mode"
        if 2 * (len(system.modes) + len(contact.free)) ** 2 * n**3 > MAX_WORK:
            return "there are too many modes to check"
        return self.find_rate_misfit(system.time)

    def forms(self, system: SwitchedSystem) -> Forms:
        """Yield the functions, and the decreases over every step."""
        contact = system.contact
        assert contact is not None  # find_misfit
        for name, Q in (*self.touching, *self.flying):
            yield f"the function of mode {name} is not symmetric and positive definite", Q
        for where, form in (*self._from_contact(system.modes), *self._from_flight(contact)):
            yield f"V does not decrease at the claimed rate {where}", form

    def _from_contact(self, modes: tuple[Mode, ...]) -> Forms:
        """Yield the decreases over a step in contact."""
        for mode, (name, Q) in zip(modes, self.touching, strict=True):
            N, d = mode.A.numerators, mode.A.denominator
            for after, image in self.touching:
                form = step_decrease(Q, congruence(N, image), d, self.rate)
                yield f"in mode {name}, then {after}", form
            # The factor of a form over the denominator of its last row is an integer.
            whole = stein_factor(d, self.rate) // d
            for (after, image), weight in zip(self.flying, self.multipliers, strict=True):
                form = step_decrease(Q, congruence(N[:-1], image), d, self.rate)
                crossing = [whole * weight * entry for entry in N[-1]]
                where = f"where contact is lost in mode {name}, then {after}"
                yield where, with_crossing(form, len(N) - 1, crossing)

    def _from_flight(self, contact: Contact) -> Forms:
        """Yield the decreases over a step of free motion."""
        for mode, (name, R) in zip(contact.free, self.flying, strict=True):
            N, d = [row[:-1] for row in mode.A.numerators], mode.A.denominator
            for after, image in self.flying:
                form = step_decrease(R, congruence(N[:-1], image), d, self.rate)
                yield f"in free motion, mode {name}, then {after}", form
            for after, Q in self.touching:
                for how, rows, landed in (("", N, Q), (" at the surface", N[:-1], leading(Q))):
                    form = step_decrease(R, congruence(rows, landed), d, self.rate)
                    yield f"where contact is made{how}, mode {name}, then {after}", form

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution, with contact or without."""
        return (
            "Every solution of x+ = A x, with contact lost and made again at any time and "
            f"switching arbitrarily among {counted(len(self.touching), 'mode')} in contact and "
            f"{counted(len(self.flying), 'mode')} of free motion, satisfies "
            f"|w(t)| <= rho^t |w(0)| with {rate_words(self.rate, system.time)}, where w holds the "
            "states other than the deflection, and the deflection where it is positive, and |w| is "
            "the largest of all sqrt(w' Q w), in free motion of all sqrt(y' R y). Where free "
            "motion ends is not claimed."
        )

    def spread(self, merged: SwitchedSystem, system: SwitchedSystem) -> Self:
        """Repeat the function of every mode in contact for its equals."""
        own = {m.A: Q for m, (_, Q) in zip(merged.modes, self.touching, strict=True)}
        touching = tuple((mode.name, own[mode.A]) for mode in system.modes)
        rest = self.flying, self.denominator_log2, self.rate, self.multipliers
        return type(self)(touching, *rest)

    def to_fields(self) -> dict[str, Any]:
        """Return the functions, the rate and the multipliers."""
        return {
            **{key: self._listed(getattr(self, key)) for key in ("touching", "flying")},
            "rate": str(self.rate),
            "multipliers": list(self.multipliers),
        }

    def _listed(self, functions: Functions) -> list[dict[str, Any]]:
        return [
            {"mode": name, "Q": matrix_fields(Q, self.denominator_log2)} for name, Q in functions
        ]

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the functions, the rate and the multipliers; they say nothing without contact."""
        if system.contact is None:
            raise ValueError(NO_CONTACT)
        found: dict[str, Functions] = {}
        exponents = set()
        for key in ("touching", "flying"):
            read = [(read_text(item["mode"]), *read_dyadic(item["Q"])) for item in fields[key]]
            found[key] = tuple((name, Q) for name, Q, _ in read)
            exponents |= {exponent for _, _, exponent in read}
        if len(exponents) != 1:
            raise ValueError("the functions do not share one denominator")
        multipliers = tuple(read_integer(entry) for entry in fields["multipliers"])
        rate = read_ratio(fields["rate"])
        return cls(found["touching"], found["flying"], exponents.pop(), rate, multipliers)
