"""The conditions of steps on one quadratic form, and their semidefinite program (untrusted).

With z the state, disturbances and errors, a step holds if

    map   (1 - share) Q - M' Q M + sum m F > 0
    flow  -(Q M + M' Q) - share Q + sum m F > 0

for a multiplier m >= 0 of each fact, which adds the form F. This is linear in Q and m. The steps
are those of the exact check (`nrs_design.proof.steps`). In free motion, Q has no deflection.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.steps import CONTACT, FREE, ROUNDING, Acting, Step, steps_of
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.drawing import Error, FloatStep, Inequality, distinct
from nrs_design.search.rates import numerators, unscale
from nrs_design.search.sdp import SemidefiniteProgram, packed_columns, symmetric_basis
from nrs_design.search.work import Allowance

Array = NDArray[np.float64]

BITS = (30, 40, 50, 60)
SHARE = "share"


@dataclass(frozen=True)
class StepUnits:
    """Coordinates in which state, disturbances and errors are about one: ``x = T z``."""

    T: Array  # Shape (n, n). Its leading block is that of free motion.
    others: Array  # Units of the disturbances, then of the errors

    def rows(self, rows: Array, states: int) -> Array:
        """Return what rows over state, disturbances and errors are in these coordinates."""
        state_columns = rows[..., :states] @ self.T[:states, :states]
        return np.concatenate([state_columns, rows[..., states:] * self.others], axis=-1)

    def balanced(self, steps: Sequence[Step]) -> StepUnits:
        """Return units of errors in which gains from and to the state are equal."""
        count = max((len(step.errors) for step in steps), default=0)
        pushed, sizes = np.zeros(count), np.zeros(count)
        for step in steps:
            for k, error in enumerate(_inequality(step, self).errors):
                pushed[k] = max(pushed[k], float(np.linalg.norm(error.column)))
                sizes[k] = max(sizes[k], float(np.linalg.norm(error.q)))
        units = np.divide(sizes, pushed, out=np.ones(count), where=(sizes > 0) & (pushed > 0))
        others = self.others.copy()
        others[len(others) - count :] = np.sqrt(units)
        return replace(self, others=others)


def _inequality(step: Step, units: StepUnits) -> Inequality:
    """Return the inequality of a step, with the forms of all facts.

    A disturbance with a weight has the fact that it is at most one.
    """
    raw, n, after = FloatStep.of(step), step.states, len(step.rows)
    M = np.asarray(np.linalg.inv(units.T[:after, :after]) @ units.rows(raw.M, n), dtype=float)
    unit, facts = np.eye(M.shape[1]), dict[str, Array]()
    last = units.rows(unit[n - 1], n)
    for k, _ in enumerate(filter(None, step.weights)):
        facts[f"{SHARE} {k + 1}"] = np.outer(unit[n + k], unit[n + k])
    for name, c in raw.crossings:
        facts[name] = _symmetric_product(last, units.rows(c, n))
    for name, left, right in raw.products:
        facts[name] = -_symmetric_product(units.rows(left, n), units.rows(right, n))
    errors = []
    for name, i, q in raw.errors:
        row, e = units.rows(q, n), units.rows(unit[i], n)
        facts[name] = np.outer(e, e) - np.outer(row, row)
        errors.append(Error((name, None), M[:, i], row))
    forms = tuple(((name, None), form) for name, form in facts.items())
    kept, left_over = np.arange(n), np.arange(after)
    return Inequality(0, kept, 0, left_over, M, forms, tuple(errors), step.is_flow, 0.0, True)


def _symmetric_product(left_row: Array, right_row: Array) -> Array:
    return np.outer(left_row, right_row) + np.outer(right_row, left_row)


def plain_steps(
    system: SwitchedSystem, channels: Sequence[int] = (), *, rounding: bool
) -> list[Step]:
    """Return the steps of a system under disturbances, as `forms_of_one` asks them of a form."""
    acting = Acting(tuple(channels), (Fraction(1),) * len(channels), rounding)
    n = system.order
    return [
        step
        for step in steps_of(system, acting, 1, lost=True)
        if step.time and not (step.source == FREE and step.target == CONTACT and len(step.rows) < n)
    ]


@dataclass(frozen=True)
class Constraint:
    """Further constraint: ``constant + sum Q_k form_k + sum m F + level corner >= 0``.

    Without a corner, neither the level nor what is left to spare is in it.
    """

    constant: Array  # Shape (s, s)
    form: Array  # Shape (k, s, s). For every form of the basis.
    corner: Array | None = None
    multipliers: Mapping[str, Array] = field(default_factory=dict)

    @classmethod
    def bordered(cls, basis: Array, row: Array, corner: float, number: float = 0.0) -> Constraint:
        """Return ``[[Q, row'], [row, corner level + number]]``."""
        n = len(row)
        constant, last = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
        constant[:n, n] = constant[n, :n] = row
        constant[n, n], last[n, n] = number, corner
        return cls(constant, np.pad(basis, ((0, 0), (0, 1), (0, 1))), last)


@dataclass(frozen=True)
class FormSolution:
    """A solution in floating point."""

    Q: Array
    multipliers: dict[str, float]  # Multipliers of all steps
    last: float  # The level, or the negative margin

    def roundings(
        self, T: Array, scale: float = 1.0
    ) -> Iterator[tuple[Matrix, int, dict[str, int]]]:
        """Yield Q and multipliers in integers, with more and more digits.

        In the units of the system, where ``x = T z``, times a scale; with the logarithm of their
        denominator.
        """
        inverse = np.linalg.inv(T)
        Q = scale * inverse.T @ self.Q @ inverse
        size = np.abs(np.diag(Q))
        # In these units the diagonal is about one.
        shifts = -np.round(np.log2(np.where(size > 0, size, 1.0)) / 2).astype(np.int64)
        scaled_form = np.ldexp(Q, shifts[:, None] + shifts)
        values = scale * np.array([*self.multipliers.values()])
        for bits in BITS:
            rows, log2 = unscale(scaled_form, shifts, bits)
            known = zip(self.multipliers, numerators(values, log2), strict=True)
            yield rows, log2, dict(known)


@dataclass(frozen=True)
class OneForm:
    """The program of a form, of steps that floating point can tell apart."""

    order: int  # Entries of z that the form is of
    conditions: tuple[Inequality, ...]
    stands: dict[str, str]  # For each multiplier, its equal in the program
    scales: dict[str, float]  # Scales of the multipliers in the program

    @classmethod
    def of(
        cls, steps: Iterable[Step], units: StepUnits, additional: Mapping[str, float] | None = None
    ) -> OneForm:
        """Take the conditions of steps, and `more` multipliers with their scales."""
        edges = [_inequality(step, units) for step in steps]
        # Like steps have facts of other names.
        unnamed = [
            replace(edge, facts=tuple((("", k), form) for k, (_, form) in enumerate(edge.facts)))
            for edge in edges
        ]
        _, found = distinct(unnamed)
        representatives = {k: edges[found.index(k)] for k in sorted({*found})}
        equals, scales = dict[str, str](), dict[str, float]()
        for edge, k in zip(edges, found, strict=True):
            for ((name, _), _), ((other, _), form) in zip(
                edge.facts, representatives[k].facts, strict=True
            ):
                equals.setdefault(name, other)
                scales[other] = max(scales.get(other, 0.0), float(np.abs(form).max()))
        scales = {name: scale or 1.0 for name, scale in scales.items()} | dict(additional or {})
        return cls(
            len(units.T),
            tuple(representatives.values()),
            equals | {name: name for name in additional or {}},
            scales,
        )

    @property
    def basis(self) -> Array:
        """The forms that Q is a sum of."""
        return symmetric_basis(self.order)

    def solve(
        self,
        share: float,
        bounds: Sequence[Constraint],
        allowance: Allowance,
        level: float | None = None,
    ) -> FormSolution | None:
        """Minimize the level; or, for a given one, leave as much to spare as possible."""
        basis = self.basis
        place = {name: len(basis) + i for i, name in enumerate(self.scales)}
        last = len(basis) + len(place)
        program = SemidefiniteProgram(last + 1)

        def of_fact(name: str, form: Array) -> tuple[int, Array]:
            return place[name], packed_columns(form[None] / self.scales[name])

        for edge in self.conditions:
            weight_before, weight_after = (1.0, share) if edge.is_flow else (1 - share, 1.0)
            images = edge.images((0,), (self.order,), weight_before, weight_after)
            images += [of_fact(name, form) for (name, _), form in edge.facts]
            spared = np.eye(edge.size) * (level is not None)
            images.append((last, packed_columns(-spared[None])))
            program.add(0 * spared, images)
        for bound in bounds:
            images, constant, corner = (
                [(0, packed_columns(bound.form))],
                bound.constant,
                bound.corner,
            )
            images += [of_fact(*fact) for fact in bound.multipliers.items()]
            if corner is not None:
                spared = corner if level is None else np.eye(len(corner))
                images.append((last, packed_columns(-spared[None])))
                constant = constant if level is None else constant + level * corner
            program.add(constant, images)
        one = np.ones((1, 1))
        for column in place.values():
            program.add(0 * one, [(column, one)])
        if level is not None:
            program.add(one, [(last, -one)])
        maximum = program.maximize(allowance)
        # The last unknown is the margin, or the negative level.
        sign = -1 if level is None else 1
        if maximum is None or sign * maximum.x[-1] <= 0:
            return None
        x = maximum.x
        found = {name: float(x[place[name]] / scale) for name, scale in self.scales.items()}
        Q = np.asarray(np.tensordot(x[: len(basis)], basis, axes=1))
        multipliers = {name: found.get(other, 0.0) for name, other in self.stands.items()}
        return FormSolution(Q, multipliers, float(-x[-1]))


def of_roundings(multipliers: Mapping[str, int]) -> tuple[int, ...]:
    """Return the multipliers of roundings, in their order."""
    count = sum(name.startswith(ROUNDING) for name in multipliers)
    return tuple(multipliers[f"{ROUNDING} {k + 1}"] for k in range(count))
