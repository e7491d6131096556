"""Search for a motion that grows while contact is lost and made as the motion itself says.

Many motions are simulated at once, each with its own way to choose among the modes that the signs
of the moment allow: always the same, the one that makes it largest, or any. Where one of them comes
back to its direction and is larger, what it was in since is a sequence to propose.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby, islice, product

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.enclosure import characteristic_sign, precision
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.evidence.growth import Steps, growth_matrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import NOWHERE
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import Candidate, Candidates
from nrs_design.search.balance import scale_states
from nrs_design.search.family import Family, distinct_modes
from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]

NOTHING_GROWS = "no sequence of contact and flight that was tried grows and keeps its signs"
# Number of motions, steps of each, and largest length of a sequence.
MOTIONS, LENGTH, LONGEST = 192, 480, 160
# Numbers of motions that keep to two modes, and of greedy motions.
PAIRS, GREEDY = 96, 48
# Probability of a random choice of the others.
SHARE = 0.1
# Cosine of a direction that returns, and numbers of sequences that are examined and proposed.
MIN_COSINE, LOOKS, PROPOSED = 0.9, 2000, 8
# Size of a motion at rest in free space, which begins anew.
REST_SIZE = 1e-9
# Work of an entry of a matrix that is enclosed.
PER_ENTRY = 4e-6
# Relative distance of an eigenvalue from floating point, and halvings to enclose it.
BRACKET_WIDTH, HALVINGS = 1e-7, 120


def search_contact(family: Family) -> Candidates[GrowingSequence]:
    """Search for a mode that pushes in and grows, and for sequences of contact and flight."""
    loop, allowance = _Loop.of(family), family.allowance
    for mode in range(len(loop.names)):
        yield from loop.candidates([mode], allowance)
    if family.system.time is Time.CONTINUOUS:
        return "no mode has a real eigenvalue along which it grows and pushes in"
    size = loop.matrices[0].size
    allowance.take(
        Cost(2e-8 * MOTIONS * LENGTH * len(loop.names) * size, 64.0 * MOTIONS * LENGTH * size),
        "simulating the loss of contact",
    )
    sequences = islice(loop.sequences(), LOOKS)
    found = (c for sequence in sequences for c in loop.candidates(sequence, allowance))
    yield from islice(found, PROPOSED)
    return NOTHING_GROWS


@dataclass(frozen=True, slots=True)
class _Loop:
    """The modes in floating point, where each may be in force, and the forces."""

    system: SwitchedSystem  # The exact one
    names: tuple[str, ...]  # Names of the distinct modes
    matrices: Array  # Shape (m, n, n). Scaled.
    # touching, flying: shape (m,). Modes of contact, and modes of free motion.
    touching: NDArray[np.bool_]
    flying: NDArray[np.bool_]
    pulls: Array  # Shape (p, n). Forces.
    # Shape (states of the clock, m). Where each mode leads; `NOWHERE` if it may not be in force.
    turns: NDArray[np.int64]

    @classmethod
    def of(cls, family: Family) -> _Loop:
        system, flights = family.system, family.system.flights
        if flights is not None:
            touching, flying, rows = {*flights.touching}, {*flights.flying}, flights.pulls
        else:
            touching, flying = ({m.name for m in part} for part in (system.modes, system.free))
            rows = () if system.contact is None else system.contact.pulls
        all_modes, clock = system.every_mode, system.clock
        clock_kinds = (
            [0] * len(all_modes) if clock is None else clock.kind_of(m.name for m in all_modes)
        )
        turn_of = dict(zip((mode.name for mode in all_modes), clock_kinds, strict=True))
        kinds: dict[tuple[int, ...], list[Mode]] = {}
        for mode in all_modes:
            kind = mode.name in touching, mode.name in flying, turn_of[mode.name]
            kinds.setdefault(kind, []).append(mode)
        modes = [pair for group in kinds.values() for pair in distinct_modes(group)]
        names = tuple(mode.name for mode, _ in modes)
        pulls = [np.ldexp(np.array(row.floats())[0], family.exponents) for row in rows]
        turns = np.zeros((1, len(names)), dtype=np.int64)
        if clock is not None:
            kinds_of_modes = np.array([turn_of[name] for name in names])
            turns = np.full((clock.length, len(names)), NOWHERE)
            for turn, of_turn, target in clock.turns():
                turns[turn, kinds_of_modes == of_turn] = target
        return cls(
            system,
            names,
            scale_states(np.array([A for _, A in modes]), family.exponents),
            np.array([name in touching for name in names]),
            np.array([name in flying for name in names]),
            np.array(pulls).reshape(len(pulls), system.order),
            turns,
        )

    def allowed(self, x: Array) -> NDArray[np.bool_]:
        """Return which modes may be in force at states of shape (k, n); shape (k, m)."""
        delta, forces = x[:, -1], x @ self.pulls.T
        is_contact = (delta > 0) & (forces > 0).all(axis=1)
        flies = (delta <= 0) | ((forces <= 0).all(axis=1) & bool(len(self.pulls)))
        # Between pushing and pulling forces, contact and free motion are possible.
        unclear = ~(is_contact | flies)[:, None]
        is_consistent = is_contact[:, None] & self.touching | flies[:, None] & self.flying
        return is_consistent | unclear | ~(self.touching | self.flying)

    def sequences(self) -> Iterator[list[int]]:
        """Yield sequences of modes over which a motion returns to its direction, and is larger.

        What stays in one mode turns but little from step to step, and would crowd out the others.
        """
        choices, states, sizes, turns = self._simulated()
        clock = self.system.clock
        # A motion that misses deadlines may come back to a state of the rule at any step.
        round_ = len(self.turns) if clock is None or clock.is_round else 1
        known_sequences: set[tuple[int, ...]] = set()
        # Growth, by the motion and the number of steps.
        for end in range(LENGTH, LENGTH // 2, -max(1, LENGTH // 8)):
            end -= end % round_
            lengths = np.arange(round_, min(LONGEST, end) + 1, round_)
            cosines = np.einsum("ki,lki->lk", states[end], states[end - lengths])
            growth = sizes[end] - sizes[end - lengths]
            is_return = (cosines > MIN_COSINE) & (turns[end] == turns[end - lengths])
            growth = np.where(is_return, growth / lengths[:, None], -np.inf)
            order = np.argsort(-growth, axis=None)[: 2 * LOOKS]
            for place in order:
                k, motion = np.unravel_index(place, growth.shape)
                if not growth[k, motion] > 0:
                    break
                found = _find_repeated_part(
                    [int(i) for i in choices[end - lengths[k] : end, motion]]
                )
                if len(found) > 1 and tuple(found) not in known_sequences:
                    known_sequences.add(tuple(found))
                    yield found

    def _simulated(self) -> tuple[NDArray[np.int64], Array, Array, NDArray[np.int64]]:
        """Return chosen modes (steps, motions), directions, logarithms of sizes, and turns."""
        rng = np.random.default_rng(0)
        count, n = len(self.names), self.matrices.shape[1]
        pairs = [*product(np.flatnonzero(self.touching), np.flatnonzero(self.flying))]
        favoured = np.zeros((MOTIONS, count), dtype=bool)
        for motion in range(PAIRS if pairs else 0):
            favoured[motion, [*pairs[motion % len(pairs)]]] = True
        random = np.arange(MOTIONS) >= PAIRS + GREEDY
        x = rng.normal(size=(MOTIONS, n))
        x /= np.linalg.norm(x, axis=1)[:, None]
        choices = np.zeros((LENGTH, MOTIONS), dtype=np.int64)
        states, sizes = np.zeros((LENGTH + 1, MOTIONS, n)), np.zeros((LENGTH + 1, MOTIONS))
        states[0] = x
        turns = np.zeros((LENGTH + 1, MOTIONS), dtype=np.int64)
        for step in range(LENGTH):
            images = np.einsum("mij,kj->kmi", self.matrices, x)
            value = np.linalg.norm(images, axis=2)
            value = np.where(favoured, np.inf, value)
            guess = random[:, None] & (rng.uniform(size=(MOTIONS, 1)) < SHARE)
            value = np.where(guess, rng.uniform(size=value.shape), value)
            ahead = self.turns[turns[step]]
            possible = self.allowed(x) & (ahead != NOWHERE)
            # If no scheduled mode fits these signs, every scheduled mode is possible.
            possible |= ~possible.any(axis=1)[:, None] & (ahead != NOWHERE)
            choices[step] = np.where(possible, value, -np.inf).argmax(axis=1)
            x = images[np.arange(MOTIONS), choices[step]]
            turns[step + 1] = ahead[np.arange(MOTIONS), choices[step]]
            size = np.linalg.norm(x, axis=1)
            moving = np.column_stack([x[:, :-1], np.maximum(x[:, -1], 0)])
            rests = ~(np.linalg.norm(moving, axis=1) > REST_SIZE * size)
            x = np.where(rests[:, None], rng.normal(size=x.shape), x / size[:, None])
            x /= np.linalg.norm(x, axis=1)[:, None]
            sizes[step + 1] = np.where(rests, -np.inf, sizes[step] + np.log(size))
            sizes[step + 1] = np.where(np.isfinite(sizes[step + 1]), sizes[step + 1], 0.0)
            states[step + 1] = x
        return choices, states, sizes, turns

    def candidates(
        self, sequence: Sequence[int], allowance: Allowance
    ) -> Iterator[Candidate[GrowingSequence]]:
        """Yield a sequence, for every eigenvalue that grows along a motion with its signs."""
        M = self.matrices[sequence[0]]
        for mode in sequence[1:]:
            M = self.matrices[mode] @ M
            M = M / max(np.abs(M).max(), 1e-300) if len(sequence) > LONGEST else M
        if not np.isfinite(M).all():
            return
        limit = 1.0 if self.system.time is Time.DISCRETE else 0.0
        values, vectors = np.linalg.eig(M)
        for value, vector in zip(values, vectors.T, strict=True):
            if abs(value.imag) > 1e-9 * abs(value) or not value.real > limit:
                continue
            v = vector.real
            if any(self._keeps_signs(sequence, x) for x in (v, -v)):
                steps = tuple(
                    (self.names[mode], Fraction(len([*repeats])))
                    for mode, repeats in groupby(sequence)
                )
                sets = (self.system.enclosure_of(name) for name in {name for name, _ in steps})
                cost = Cost(PER_ENTRY * self.system.order**2 * sum(map(len, sets)))
                allowance.take(cost, "the enclosure of a sequence")
                factor = _bracket(self.system, steps, float(value.real))
                if factor is not None:
                    yield Candidate(GrowingSequence(steps, factor=factor))

    def _keeps_signs(self, sequence: Sequence[int], x: Array) -> bool:
        for mode in sequence:
            if not self.allowed(x[None])[0, mode]:
                return False
            x = self.matrices[mode] @ x
            x = x / max(float(np.abs(x).max()), 1e-300)
        return True


def _find_repeated_part(sequence: list[int]) -> list[int]:
    """Return what a sequence repeats."""
    count = len(sequence)
    return next(
        sequence[:k]
        for k in range(1, count + 1)
        if count % k == 0 and sequence[:k] * (count // k) == sequence
    )


def _bracket(
    system: SwitchedSystem, steps: Steps, value: float
) -> tuple[Fraction, Fraction] | None:
    """Return bounds of the eigenvalue near a value; None if no eigenvalue is found there."""
    limit = Fraction(system.time is Time.DISCRETE)
    low = max(Fraction(value * (1 - BRACKET_WIDTH)), limit)
    high = Fraction(value * (1 + BRACKET_WIDTH))
    with precision():
        M = growth_matrix(system, steps)
        sign_at_low = characteristic_sign(M, low)
        if sign_at_low * characteristic_sign(M, high) >= 0:
            return None
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            sign = characteristic_sign(M, middle)
            low, high = (
                (middle, high) if sign == sign_at_low else (low, middle) if sign else (low, high)
            )
    return low, high
