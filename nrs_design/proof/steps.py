"""TRUSTED: the steps of a system, and what each asks of the forms before and after it.

A step leads from one place to another. With z the state before it and, behind the state, what
disturbs it (d) and what its arithmetic rounds (r), the state after it is ``M z`` (a map), or
``M z`` is its derivative (a flow). What is known besides are *facts*:

- an error: ``e^2 <= (q z)^2``, for an entry e of r;
- a crossing: ``delta (c z) <= 0``, with delta the last state: contact is lost, or would pull;
- a product: ``(l z) (r z) >= 0``, as neither factor is negative; the forms below then have
  ``- sum 2 m (l z) (r z)`` as well (see `nrs_design.proof.offset`).

With F before and G after the step and a multiplier m >= 0 for each fact, positive definiteness of

    map:  keeps F + sum weight_i d_i^2 - M' G M + sum m (e^2 - (q z)^2) + sum 2 m delta (c z)
    flow: -(F M + M' F + keeps F) + sum weight_i d_i^2 + sum m (e^2 - (q z)^2) + sum 2 m delta (c z)

says that a map keeps that share of the function, and a flow decreases at half that rate, but for
the disturbances, for every error within its limit (S-procedure). Multipliers are the same for all
modes, which keeps the forms concave in the maps.

Forms are written in integers. In a map every entry of z is counted in a unit of its own, the least
in which M, the q and the c are integers. With these units on the diagonal of D, a form F becomes
``D F D``, which is positive definite iff F is. One denominator for all of them would make the
integers several times as long.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import gcd, isqrt, lcm

from nrs_design.proof.exact import IntegerMatrix, Product, add, congruence, multiply, transpose
from nrs_design.proof.matrix import RationalMatrix, identity, leading, with_crossing
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem

# Where a step begins and ends. Where contact is kept, or there is none, nothing is known of the
# sign of the last state. Where contact may be lost, the last state is the deflection: in contact it
# is positive, and in free motion it is not.
KEPT, CONTACT, FREE = "kept", "contact", "free"

# Names of facts; numbers count from one, in the order of the system.
ROUNDING, LOST, PULL = "rounding", "lost", "pull"

Row = Sequence[int]


@dataclass(frozen=True, slots=True)
class Acting:
    """Disturbances and roundings that act on the state during a step."""

    channels: tuple[int, ...] = ()  # Disturbances, by their number in the system
    weights: tuple[Fraction, ...] = ()  # One for each of them
    rounding: bool = False  # What the arithmetic rounds


@dataclass(frozen=True, slots=True)
class Stays:
    """How stays in a mode are followed."""

    # Modes of which every stay is one step, as they have a longest dwell time.
    leaving: tuple[str, ...] = ()
    pieces: int = 1  # In continuous time, the lengths of such a stay are cut in so many pieces


@dataclass(frozen=True, slots=True)
class Step:
    """One thing that a system may do at a place, in integers."""

    where: str  # In words
    mode: str  # That is in force
    source: str  # The place before
    target: str  # The place after
    states: int  # Number of states before the step; they are first in z
    units: Row  # Units of the entries of z
    rows: IntegerMatrix  # M in these units, times `over`
    over: int = 1  # One for a map
    # Name, index of e in z, q in these units, and a positive denominator of q (one for a map).
    errors: tuple[tuple[str, int, Row, int], ...] = ()
    # Name, c in these units, and its denominator.
    crossings: tuple[tuple[str, Row, int], ...] = ()
    # Name, l and r in these units, without a denominator; the form has ``-2 m (l z) (r z)``.
    products: tuple[tuple[str, Row, Row], ...] = ()
    weights: tuple[Fraction, ...] = ()  # Weights of the disturbances, which follow the state in z
    is_flow: bool = False
    time: int = 1  # Steps that a map takes; a switch at once takes none

    @property
    def facts(self) -> tuple[str, ...]:
        """Names of what is known."""
        known = (self.errors, self.crossings, self.products)
        return tuple(str(fact[0]) for facts in known for fact in facts)

    def form(
        self,
        before: IntegerMatrix,
        after: IntegerMatrix,
        keeps: Fraction,
        multiplier: Callable[[str], int] = lambda fact: 0,
        log2: int = 0,
        multiply: Product = multiply,
    ) -> IntegerMatrix:
        """Return what must be positive definite, times a positive number.

        `before` and `after` are numerators over ``2^log2``, as multipliers of facts are, of the
        functions of the state before, and of what `rows` give; `keeps` is what is left of the
        function after a map, or twice the rate of a flow. Only a search has reason to ask for
        another way to multiply.
        """
        if self.is_flow:
            form, factor = self._flowing(before, keeps, log2, multiply)
        else:
            image = congruence(self.rows, after, multiply)
            form, factor = add(self._left(before, keeps, log2), image, -1), 1
        for name, i, q, divisor in self.errors:
            m = multiplier(name)
            form[i][i] += factor * m * self.units[i] ** 2
            weight = m * (factor // divisor**2)
            entries = [(j, entry) for j, entry in enumerate(q) if entry]
            for a, left in entries:
                for b, right in entries:
                    form[a][b] -= weight * left * right
        last = self.states - 1
        for name, c, divisor in self.crossings:
            weight = multiplier(name) * (factor // divisor) * self.units[last]
            form = with_crossing(form, last, [weight * entry for entry in c])
        for name, row, other in self.products:
            weight = -factor * multiplier(name)
            for i, entry in enumerate(row):
                if entry:
                    form = with_crossing(form, i, [weight * entry * right for right in other])
        return form

    def _left(self, before: IntegerMatrix, keeps: Fraction, log2: int) -> list[list[int]]:
        """Return the form of a map without what comes after it and without facts."""
        units = self.units
        form = [[0] * len(units) for _ in units]
        p, q = keeps.as_integer_ratio()
        for i, row in enumerate(before):
            for j, entry in enumerate(row):
                form[i][j] = units[i] * units[j] // q * p * entry
        for i, weight in enumerate(self.weights, len(before)):
            form[i][i] = int(weight * units[i] ** 2) << log2
        return form

    def _flowing(
        self, F: IntegerMatrix, keeps: Fraction, log2: int, multiply: Product
    ) -> tuple[list[list[int]], int]:
        """Return the form of a flow without facts, times a positive integer, and that integer."""
        p, q = (keeps * self.over).as_integer_ratio()
        below = [b**2 for *_, b in self.errors] + [b for *_, b in self.crossings]
        below += [weight.denominator for weight in self.weights]
        factor = lcm(q * self.over, *below)
        scale = factor // (q * self.over)
        FM, more_states = multiply(F, self.rows), len(self.units) - len(F)
        FM += [[0] * len(self.units) for _ in range(more_states)]
        square = [[*row, *[0] * more_states] for row in F] + FM[len(F) :]
        double, share = -scale * q, scale * p
        form = [
            [double * (a + b) - share * entry for a, b, entry in zip(*rows, strict=True)]
            for rows in zip(FM, transpose(FM), square, strict=True)
        ]
        for i, weight in enumerate(self.weights, len(F)):
            form[i][i] = int(weight * factor) << log2
        return form, factor


def map_step(
    where: str, mode: str, places: tuple[str, str], A: RationalMatrix, grain: int, time: int = 1
) -> Step:
    """Return a map that nothing acts on; every unit is a multiple of the grain."""
    d, columns = A.denominator, transpose(A.numerators)
    units = [lcm(grain, d // gcd(d, *column)) for column in columns]
    rows = [
        [unit * entry // d for entry in column] for unit, column in zip(units, columns, strict=True)
    ]
    return Step(where, mode, *places, len(units), units, transpose(rows), time=time)


def flow_step(where: str, mode: str, place: str, A: RationalMatrix) -> Step:
    """Return a flow that nothing acts on; A is of the derivative."""
    n, denominator = len(A.numerators), A.denominator
    return Step(where, mode, place, place, n, (1,) * n, A.numerators, denominator, is_flow=True)


def grain_of(keeps: Fraction) -> int:
    """Return the least natural number known with a square that the denominator divides."""
    below = keeps.denominator
    root = isqrt(below)
    return root if root * root == below else below


def steps_of(system: SwitchedSystem, acting: Acting, grain: int, *, lost: bool) -> Iterator[Step]:
    """Yield every step of a system under arbitrary switching, between contact and free motion.

    The modes are of one size; every unit of a map is a multiple of the grain. Contact is kept
    unless it is `lost` and made, as the system says how.
    """
    contact = system.contact if lost else None
    place, free = (KEPT, ()) if contact is None else (CONTACT, contact.free)
    flows, n = system.time is Time.CONTINUOUS, system.order
    for k, mode in enumerate(system.modes):
        step = _step(system, k, mode, acting, grain, place)
        yield step
        if contact is not None and not flows:
            yield replace(
                step,
                where=f"where contact is lost in mode {mode.name}",
                target=FREE,
                rows=step.rows[:-1],
                crossings=((LOST, step.rows[-1], 1),),
            )
    for k, mode in enumerate(free, len(system.modes)):
        step = _step(system, k, mode, acting, grain, place)
        flight = _undeflected(step, n - 1)
        inner = replace(
            flight, where=f"in free motion, mode {mode.name}", rows=flight.rows[:-1], target=FREE
        )
        yield inner
        if not flows:
            landing = f"where contact is made, mode {mode.name}"
            yield replace(flight, where=landing, target=CONTACT)
            # The depth after landing is between zero and the last row. The function is convex in
            # it, so both ends suffice; at the surface it is this.
            surface = f"where contact is made at the surface, mode {mode.name}"
            yield replace(inner, where=surface, target=CONTACT)
        yield from _lagging(system, step, flows=flows)
    if contact is not None and flows:
        for word, places in (("lost", (CONTACT, FREE)), ("made", (FREE, CONTACT))):
            where = f"where contact is {word} at the surface"
            yield map_step(where, "", places, identity(n - 1), 1, time=0)


def _lagging(system: SwitchedSystem, step: Step, *, flows: bool) -> Iterator[Step]:
    """Yield the steps of a free mode while the deflection is positive and a force would pull."""
    forces = () if system.contact is None else system.contact.pulls
    for k, q in enumerate(forces, 1):
        (row,) = q.numerators
        force = [f * u for f, u in zip(row, step.units, strict=False)]
        pull = f"{PULL} {k}"
        where = f"while the environment lags, mode {step.mode}"
        if flows:
            # The fact says nothing about the mode, so that every mode may have its multiplier.
            known = (f"{pull} {step.mode}", force, q.denominator)
            yield replace(step, where=where, crossings=(known,))
            continue
        # The numerators of the force are as good as the force.
        yield replace(step, where=where, crossings=((pull, force, 1),))
        yield replace(
            step,
            where=f"where a lagging environment is left, mode {step.mode}",
            target=FREE,
            rows=step.rows[:-1],
            crossings=((f"{pull} {LOST}", force, 1), (f"{LOST} {pull}", step.rows[-1], 1)),
        )


def _step(
    system: SwitchedSystem, k: int, mode: Mode, acting: Acting, grain: int, place: str
) -> Step:
    """Return what the k-th mode does at a place; free modes come after those in contact."""
    n, flows = system.order, system.time is Time.CONTINUOUS
    items = system.roundings if acting.rounding else ()
    parts = [mode.A, *(system.channels[i].columns[k] for i in acting.channels)]
    parts += [item.columns[k] for item in items]
    columns = [(column, M.denominator) for M in parts for column in transpose(M.numerators)]
    sizes = []
    for item in items:
        (entries,) = item.rows[k].numerators  # Over the state and all disturbances
        q = [*entries[:n], *(entries[n + i] for i in acting.channels)]
        sizes.append(([*q, *(0 for _ in columns[len(q) :])], item.rows[k].denominator))
    if flows:
        units, over = [1] * len(columns), lcm(*(d for _, d in columns))
    else:
        grains = [grain] * n + [weight.denominator for weight in acting.weights] + [1] * len(items)
        units, over = (
            [
                lcm(unit, d // gcd(d, *column), *(e // gcd(e, q[j]) for q, e in sizes))
                for j, (unit, (column, d)) in enumerate(zip(grains, columns, strict=True))
            ],
            1,
        )
    errors = []
    for i, (q, below) in enumerate(sizes):
        # The units of a map are such that these are integers.
        left = below if flows else 1
        q = [unit * entry * left // below for unit, entry in zip(units, q, strict=True)]
        errors.append((f"{ROUNDING} {i + 1}", len(columns) - len(items) + i, q, left))
    rows = [
        [unit * over * entry // d for entry in column]
        for unit, (column, d) in zip(units, columns, strict=True)
    ]
    return Step(
        f"in mode {mode.name}",
        mode.name,
        place,
        place,
        n,
        units,
        transpose(rows),
        over,
        tuple(errors),
        weights=acting.weights,
        is_flow=flows,
    )


def _undeflected(step: Step, k: int) -> Step:
    """Return a step from free motion, where the k-th state is zero."""
    errors = tuple((name, i - 1, _without(q, k), below) for name, i, q, below in step.errors)
    return replace(
        step,
        source=FREE,
        states=k,
        units=_without(step.units, k),
        rows=[_without(row, k) for row in step.rows],
        errors=errors,
    )


def _without(row: Row, k: int) -> list[int]:
    return [*row[:k], *row[k + 1 :]]


def forms_of_one(
    steps: Iterable[Step],
    Q: Sequence[Sequence[int]],
    keeps: Fraction,
    multiplier: Callable[[str], int],
    log2: int,
) -> Iterator[tuple[str, IntegerMatrix]]:
    """TRUSTED: yield what every step that takes time asks of one form, with where it is.

    In free motion it is the form without the deflection. Where free motion ends at the surface both
    are one, and no more is asked than where it goes on.
    """
    inner = leading(Q)
    for step in steps:
        before = inner if step.source == FREE else Q
        after = Q if len(step.rows) == len(Q) else inner
        ends = step.source == FREE and step.target == CONTACT and after is inner
        if step.time and not ends:
            yield step.where, step.form(before, after, keeps, multiplier, log2)


def by_fact(
    names: Iterable[str], multipliers: Iterable[int], roundings: Iterable[int]
) -> Callable[[str], int]:
    """TRUSTED: return the multiplier of each fact: of those named, and of every rounding."""
    known = dict(zip(names, multipliers, strict=True))
    known |= {f"{ROUNDING} {k}": m for k, m in enumerate(roundings, 1)}
    return known.__getitem__


def find_odd_multiplier(*given: tuple[Sequence[int], int, str]) -> str | None:
    """TRUSTED: say that a multiplier is negative, or that they are not as many as they should be.

    They are given with that number, and with what each of them belongs to, in words.
    """
    for multipliers, count, each in given:
        if len(multipliers) != count:
            return f"there is not one multiplier for each {each}"
        if min(multipliers, default=0) < 0:
            return "a multiplier is negative"
    return None


def multiplier_names(system: SwitchedSystem) -> tuple[str, ...]:
    """Return the facts that hold where contact is lost, as steps of a system name them."""
    contact = system.contact
    if contact is None:
        return ()
    pulls = range(1, len(contact.pulls) + 1)
    if system.time is Time.CONTINUOUS:
        return tuple(f"{PULL} {k} {mode.name}" for mode in contact.free for k in pulls)
    own = (
        name for k in pulls for name in (f"{PULL} {k}", f"{PULL} {k} {LOST}", f"{LOST} {PULL} {k}")
    )
    return (LOST, *own)
