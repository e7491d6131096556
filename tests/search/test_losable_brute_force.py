"""Proofs through the loss of contact against brute force: random loops, simulated by the words.

The oracle knows the model, not the conditions: while the deflection is positive a mode in contact
maps the state, or, where some force between the corners would pull, a free mode does; otherwise a
free mode does. Where modes take turns, those of the step do.
"""

from __future__ import annotations

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.contact import Contact
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence import FormsOnGraph, InvariantEllipsoid, OffsetEllipsoid
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certify import Limits, certify
from nrs_design.search.ladder import applicable_methods
from nrs_design.search.method import Method
from tests.proof.graphs import shape_of
from tests.proof.systems import matrix

LIMITS = Limits(max_degree=2, budget=3.0, optimize_rate=True)
ROOM = 1 + 1e-9
ATTACKED = {
    "conewise-mode-quadratic",
    "conewise-quadratic",
    "offset-ellipsoid",
    "periodic-quadratic",
}


def drawn(seed: int) -> SwitchedSystem:
    """Draw a sampled mass on a spring that it may leave: states velocity, another, deflection.

    Of every three loops one has damping that does not pull, one takes turns, one is disturbed.
    """
    rng = np.random.default_rng(seed)
    turns, damped, pushed = seed % 3 == 1, seed % 3 == 2, seed % 3 == 0

    def flight() -> np.ndarray:
        inner = rng.uniform(-0.5, 0.5, (2, 2)) + np.diag(rng.uniform(0, 0.7, 2))
        return np.array(
            [[*inner[0], 0], [*inner[1], 0], [rng.uniform(0.1, 0.4), rng.uniform(-0.1, 0.1), 1]]
        )

    free = [flight() for _ in range(2)]
    springs = rng.uniform(0.05, 0.8, 2)
    damping = rng.uniform(0, 0.5, 2) if damped else np.zeros(1)
    forces = [np.array([b, 0, k]) for k in springs for b in damping]
    # The force slows the velocity, and the other state a little.
    pushes = [np.array([1, rng.uniform(-0.2, 0.2), rng.uniform(0, 0.3)]) for _ in free]
    maps = [F - np.outer(p, q) for F, p in zip(free, pushes, strict=True) for q in forces]

    def modes(name: str, matrices: list[np.ndarray]) -> tuple[Mode, ...]:
        return tuple(Mode(f"{name}{i}", rounded(A)) for i, A in enumerate(matrices))

    contact = Contact(modes("f", free), tuple(map(rounded_row, forces)) if damped else ())
    touching = modes("c", maps)
    clock = None
    if turns:
        names = [m.name for m in touching[: len(forces)]] + ["f0"]
        clock = Clock(int(rng.integers(2, 4)), tuple(names))
    channels, outputs = (), ()
    if pushed:
        columns = tuple(rounded_column(rng.uniform(-1, 1, 3)) for _ in (*maps, *free))
        channels = (Channel("push", "N", matrix([[1]]).fractions()[0][0], columns),)
        outputs = (Output("force", "N", tuple(map(rounded_row, forces))),)
    states = ("velocity", "other", "delta")
    return SwitchedSystem(
        name=f"drawn-{seed}",
        time=Time.DISCRETE,
        states=states,
        modes=touching,
        assumptions=(),
        contact=contact,
        channels=channels,
        outputs=outputs,
        clock=clock,
    )


def rounded(A: np.ndarray):
    return matrix([[f"{round(100 * entry)}/100" for entry in row] for row in A.tolist()])


def rounded_row(q: np.ndarray):
    return rounded(q[None, :])


def rounded_column(b: np.ndarray):
    return rounded(b[:, None])


class Oracle:
    """All that may happen to some states at once in a step, with corners and averages of them."""

    def __init__(self, system: SwitchedSystem, rng: np.random.Generator) -> None:
        self.system, self.rng = system, rng
        self.touching = [(m.name, np.array(m.A.floats())) for m in system.modes]
        self.free = [(m.name, np.array(m.A.floats())) for m in system.contact.free]
        self.pulls = [np.array(q.floats())[0] for q in system.contact.pulls]
        self.columns = [[np.array(c.floats())[:, 0] for c in ch.columns] for ch in system.channels]

    def on_turn(self, step: int) -> tuple[list, list]:
        """Return the numbered modes of a step, in contact and free."""
        clock = self.system.clock
        numbered = list(enumerate([*self.touching, *self.free]))
        if clock is not None:
            numbered = [
                m for m in numbered if (m[1][0] in clock.first) == (step % clock.length == 0)
            ]
        count = len(self.touching)
        return [m for m in numbered if m[0] < count], [m for m in numbered if m[0] >= count]

    def averaged(self, modes: list) -> tuple[np.ndarray, list]:
        """Return one mode, or the average of two, with the columns of what disturbs."""
        i, j = self.rng.integers(len(modes), size=2)
        share = self.rng.choice([0.0, 1.0, self.rng.uniform()])
        (a, (_, A)), (b, (_, B)) = modes[i], modes[j]
        columns = [share * c[a] + (1 - share) * c[b] for c in self.columns]
        return share * A + (1 - share) * B, columns

    def step(self, x: np.ndarray, step: int, pushes: float) -> np.ndarray:
        """Return where states of shape (m, 3) may go, one way for each call."""
        touching, free = self.on_turn(step)
        (C, c), (F, f) = self.averaged(touching), self.averaged(free)
        contact = x[:, 2] > 0
        if self.pulls:
            share = self.rng.dirichlet(np.ones(len(self.pulls)))
            # Where a force of the moment would pull, there is none.
            contact &= x @ (share @ np.array(self.pulls)) > 0
        d = pushes * self.rng.choice([-1.0, 1.0], (len(x), len(self.columns)))
        there = x @ C.T + sum((np.outer(d[:, i], b) for i, b in enumerate(c)), 0 * x)
        away = x @ F.T + sum((np.outer(d[:, i], b) for i, b in enumerate(f)), 0 * x)
        return np.where(contact[:, None], there, away)


def states(rng: np.random.Generator, count: int) -> np.ndarray:
    """Draw states, a third of them next to the surface, where contact is lost and made."""
    x = rng.normal(size=(count, 3))
    x[: count // 3, 2] *= 1e-3
    return x


def size(Q, denominator_log2: int, x: np.ndarray) -> np.ndarray:
    w = np.column_stack([x[:, :2], np.maximum(x[:, 2], 0)])
    return np.einsum("ni,ij,nj->n", w, np.array(Q, dtype=float) / 2.0**denominator_log2, w)


def inside(evidence: InvariantEllipsoid, w: np.ndarray) -> np.ndarray:
    """Return what is at most one in the ellipsoid."""
    Q = np.array(evidence.Q, dtype=float)
    if not isinstance(evidence, OffsetEllipsoid):
        return np.einsum("ni,ij,nj->n", w, Q / 2.0**evidence.denominator_log2, w)
    z = np.column_stack([np.ones(len(w)), w])
    return 1 - np.einsum("ni,ij,nj->n", z, Q / Q[0, 0], z)


def largest(evidence: FormsOnGraph, x: np.ndarray, step: int) -> np.ndarray:
    """Return the norm of the claim, squared: the largest of all functions of contact, or free."""
    scale = 2.0**evidence.denominator_log2
    turns = {node.place.partition(" ")[2] for node in evidence.nodes}
    at = "" if turns == {""} else f" {step % len(turns)}"
    each = [
        np.max(
            [
                np.einsum("ni,ij,nj->n", w, np.array(Q, dtype=float), w)
                for place, Q in evidence.nodes
                if place == f"{named}{at}"
            ],
            axis=0,
        )
        for named, w in (("modes", x), ("free", x[:, :2]))
    ]
    return np.where(x[:, 2] > 0, *each) / scale


def attack(system: SwitchedSystem, evidence, rng: np.random.Generator, rounds: int = 60) -> None:
    """Try to break what a function or an ellipsoid claims of single steps, and of long runs."""
    oracle = Oracle(system, rng)
    x = states(rng, 300)
    if isinstance(evidence, InvariantEllipsoid):
        # From rest, whatever pushes: inside for ever.
        x = np.zeros((300, 3))
        rows = [np.array(q.floats())[0] for q in system.outputs[0].rows]
        for step in range(4 * rounds):
            x = oracle.step(x, step, 1.0)
            w = np.column_stack([x[:, :2], np.maximum(x[:, 2], 0)])
            assert (inside(evidence, w) <= ROOM).all()
            assert max(np.abs(w @ q).max() for q in rows) <= float(evidence.level) * ROOM
        return
    rate = float(evidence.rate) ** 2
    for step in range(rounds):
        moved = oracle.step(x, step, 0.0)
        now, then = largest(evidence, x, step), largest(evidence, moved, step + 1)
        assert (then <= rate * now * ROOM + 1e-300).all()
        # Some go on, others begin anew.
        x = np.where((rng.uniform(size=len(x)) < 0.5)[:, None], moved, states(rng, len(x)))


def growth(system: SwitchedSystem, rng: np.random.Generator) -> float:
    """Return how large the largest of many random runs is after a while, without pushes."""
    oracle = Oracle(system, rng)
    x = states(rng, 400)
    for step in range(240):
        x = oracle.step(x, step, 0.0)
        # What flies off is at rest: only what w holds counts.
        x[:, 2] = np.where(x[:, 2] < -1, -1, x[:, 2])
    return float(np.abs(np.column_stack([x[:, :2], np.maximum(x[:, 2], 0)])).max())


def assert_true(seed: int) -> tuple[Verdict, set[str]]:
    system = drawn(seed)
    assert find_contradiction(system) is None
    result, rng = certify(system, limits=LIMITS), np.random.default_rng(seed)
    kinds, statements = set(), [*result.statements]
    if Method.CONEWISE_MODE_QUADRATIC in applicable_methods(system):
        own = certify(system, Method.CONEWISE_MODE_QUADRATIC, LIMITS)
        statements += own.statements
    for evidence in statements:
        if shape_of(evidence) in ATTACKED:
            attack(system, evidence, rng)
            kinds.add(shape_of(evidence))
    if result.verdict is Verdict.PROVED and result.evidence.covers_lost_contact:
        assert growth(system, rng) < 1e3
    return result.verdict, kinds


def test_random_loops_that_lose_contact():
    found = [assert_true(seed) for seed in range(6)]
    assert set().union(*(kinds for _, kinds in found)) == ATTACKED
    assert [verdict for verdict, _ in found].count(Verdict.PROVED) > 3


@pytest.mark.slow
def test_many_more_random_loops_that_lose_contact():
    for seed in range(6, 70):
        assert_true(seed)
