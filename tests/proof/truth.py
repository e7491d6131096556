"""Oracles: what each kind of evidence says, recomputed from its definition.

Fractions, NumPy, SciPy and flint only: no lift, no elimination and no enclosure of the package.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations_with_replacement, product
from math import lcm, prod
from random import Random

import numpy as np
from flint import fmpq, fmpq_mat
from scipy.linalg import expm

from nrs_design.proof import evidence as kinds
from nrs_design.proof.channels import Channel
from nrs_design.proof.constant import system_at
from nrs_design.proof.evidence.block_triangular import diagonal_block
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem

Rows = list[list[Fraction]]


def times(X: Rows, Y: Rows) -> Rows:
    return [[sum(a * b for a, b in zip(r, c, strict=True)) for c in transpose(Y)] for r in X]


def transpose(X: Rows) -> Rows:
    return [list(column) for column in zip(*X, strict=True)]


def combine(*terms: tuple[Fraction | int, Rows]) -> Rows:
    rows, columns = len(terms[0][1]), len(terms[0][1][0])
    return [
        [sum((w * X[i][j] for w, X in terms), Fraction(0)) for j in range(columns)]
        for i in range(rows)
    ]


def is_positive_multiple(form, wanted: Rows) -> bool:
    """Tell whether a matrix is another one times a number > 0."""
    pairs = [(Fraction(a), b) for rows in zip(form, wanted, strict=True)
             for a, b in zip(*rows, strict=True)]  # fmt: skip
    scale = next(a / b for a, b in pairs if b)
    return scale > 0 and all(a == scale * b for a, b in pairs)


def is_in_other_units(form, wanted: Rows) -> bool:
    """Tell whether a matrix is ``D W D`` for a diagonal D > 0; no W_ii is zero."""
    if len(form) != len(wanted):
        return False
    squares = [Fraction(row[i]) / wanted[i][i] for i, row in enumerate(form)]
    return all(square > 0 for square in squares) and all(
        form[i][j] * wanted[i][j] >= 0
        and form[i][j] ** 2 == squares[i] * squares[j] * wanted[i][j] ** 2
        for i, j in product(range(len(form)), repeat=2)
    )


def is_definite(M: Sequence[Sequence], *, strictly: bool = True) -> bool:
    """Tell by minors whether a matrix is symmetric and positive (semi)definite."""
    M, n = [list(row) for row in M], len(M)
    if any(len(row) != n for row in M) or transpose(M) != M:
        return False
    if strictly:
        return all(determinant([row[:k] for row in M[:k]]) > 0 for k in range(1, n + 1))
    chosen = ([i for i in range(n) if mask >> i & 1] for mask in range(1, 2**n))
    return all(determinant([[M[i][j] for j in kept] for i in kept]) >= 0 for kept in chosen)


def determinant(M: Rows) -> Fraction:
    return _fraction(fmpq_mat(len(M), len(M), [_fmpq(entry) for row in M for entry in row]).det())


def _fmpq(entry: Fraction | int) -> fmpq:
    return fmpq(*entry.as_integer_ratio())


def _fraction(number: fmpq) -> Fraction:
    return Fraction(int(number.p), int(number.q))


def decrease(A: Rows, Q: Rows, rate: Fraction, time: Time) -> Rows:
    """Return ``-(A'Q + QA + 2 rate Q)`` or ``rate^2 Q - A'QA``."""
    if time is Time.CONTINUOUS:
        return combine((-1, times(transpose(A), Q)), (-1, times(Q, A)), (-2 * rate, Q))
    return combine((rate**2, Q), (-1, times(transpose(A), times(Q, A))))


def is_stable_by_lyapunov(A: Rows, time: Time) -> bool:
    """A is Hurwitz iff ``A'P + PA = -I`` (Schur iff ``A'PA - P = -I``) has P > 0; in fractions."""
    n = range(len(A))
    pairs = [(i, j) for i in n for j in n if i <= j]
    units = [[[Fraction({r, c} == {*pair}) for c in n] for r in n] for pair in pairs]
    images = [decrease(A, E, Fraction(time is Time.DISCRETE), time) for E in units]
    entries = [_fmpq(image[i][j]) for i, j in pairs for image in images]
    left = fmpq_mat(len(pairs), len(pairs), entries)
    if left.det() == 0:
        return False
    P = left.solve(fmpq_mat(len(pairs), 1, [fmpq(int(i == j)) for i, j in pairs]))
    weights = [_fraction(P[k, 0]) for k in range(len(pairs))]
    return is_definite(combine(*zip(weights, units, strict=True)))


def is_rate(rate: Fraction, time: Time) -> bool:
    return rate > 0 and (time is Time.CONTINUOUS or rate < 1)


def holds(system: SwitchedSystem, evidence: kinds.AbstractEvidence) -> bool:
    """Tell whether what the numbers say is true for this system."""
    clocked = kinds.FormsOnGraph | kinds.GrowingSequence
    if system.clock is not None and not isinstance(evidence, clocked):
        return False
    return _ORACLES[type(evidence)](system, evidence)


def _saturated_ellipsoid(system: SwitchedSystem, item: kinds.SaturatedEllipsoid) -> bool:
    """Every choice of arguments and rows as a mode, from the loop without any signal."""
    what, contact, n = system.saturation, system.contact, system.order
    if what is None or system.switching.resets or (contact is not None and contact.pulls):
        return False
    if not is_rate(item.rate, system.time) or item.level <= 0:
        return False
    discrete, rounded = system.time is Time.DISCRETE, len(system.roundings) if item.roundings else 0
    numbers = [item.multipliers, item.roundings]
    counts = [int(contact is not None and discrete), rounded]
    if [*map(len, numbers)] != counts or any(v < 0 for part in numbers for v in part):
        return False
    signals, every = what.signals, (*system.modes, *(contact.free if contact else ()))
    modes, columns, rows = [], [[] for _ in system.roundings], []
    if len(item.H) not in (len(signals), len(signals) * (len(every) if discrete else 1)):
        return False
    if len(item.Q) != n or any(len(h) != n for h in item.H):
        return False
    for k, mode in enumerate(every):
        held = item.H if len(item.H) == len(signals) else item.H[k * len(signals) :]
        wide = [
            [*row, *(r.columns[k].fractions()[i][0] for r in system.roundings[:rounded])]
            for i, row in enumerate(mode.A.fractions())
        ]

        def given(replaced, k=k, held=held):
            found = []
            for i, signal in enumerate(signals):
                q = signal.rows[k].fractions()[0]
                off = signal.errors[k].fractions()[0] if rounded else []
                before = [[share * v for v in s] for share, s in zip(q[n:], found, strict=True)]
                argument = [sum(part) for part in zip([*q[:n], *off], *before, strict=True)]
                h = [Fraction(v, 2**item.H_denominator_log2) for v in held[i]]
                found.append([*h, *[Fraction(0)] * rounded] if i in replaced else argument)
            return found

        for mask in range(2 ** len(signals)):
            replaced = [i for i in range(len(signals)) if mask >> i & 1]
            B = wide
            for signal, new, old in zip(signals, given(replaced), given(()), strict=True):
                more = [[a - b for a, b in zip(new, old, strict=True)]]
                B = combine((1, B), (1, times(signal.columns[k].fractions(), more)))
            modes.append(Mode(f"{mode.name} {mask}", RationalMatrix.from_rows([r[:n] for r in B])))
            for j, found in enumerate(columns[:rounded]):
                found.append(RationalMatrix.from_rows([[row[n + j]] for row in B]))
            rows.append(k)
    first = len(modes) // len(every) * len(system.modes)
    cut = [
        replace(
            r,
            columns=tuple(columns[j]),
            rows=tuple(RationalMatrix.from_rows([r.rows[k].fractions()[0][:n]]) for k in rows),
        )
        for j, r in enumerate(system.roundings[:rounded])
    ]
    loop = replace(
        system,
        modes=tuple(modes[:first]),
        contact=None if contact is None else replace(contact, free=tuple(modes[first:])),
        roundings=tuple(cut),
        channels=(),
        saturation=None,
    )
    unit = Fraction(1, 2**item.denominator_log2)
    Q = [[v * unit for v in row] for row in item.Q]
    known = {"lost": item.multipliers[0] * unit} if item.multipliers else {}
    known |= {f"rounding {i}": v * unit for i, v in enumerate(item.roundings, 1)}
    steps = (m for m in moves(loop, lost=True, rounding=bool(rounded)) if m.strict)
    keeps = item.rate**2 if discrete else 2 * item.rate
    forms = [inequality(m, Q, Q, keeps, known.__getitem__) for m in steps]
    if not is_definite(Q) or not all(map(is_definite, forms)):
        return False
    for i, h in enumerate(item.H):
        row = [Fraction(v, 2**item.H_denominator_log2) for v in h]
        bordered = [[*q, v] for q, v in zip(Q, row, strict=True)] + [[*row, Fraction(0)]]
        limit = signals[i % len(signals)].limit
        if not -determinant(bordered) / determinant(Q) < limit**2:
            return False
    starts = [x.fractions() for x in what.start.states]
    return all(item.level**2 * times(transpose(x), times(Q, x))[0][0] < 1 for x in starts)


def _graph(system: SwitchedSystem, item: kinds.FormsOnGraph) -> bool:
    """What every step asks of the forms before and after it, from the definition."""
    if (
        not is_rate(item.rate, system.time)
        or min((m.value for m in item.multipliers), default=0) < 0
    ):
        return False
    if item.stays is not None:
        ruled = _mode_quadratic if item.degree == 1 else _polynomials
        return system.clock is None and ruled(system, item)
    lost = any(node.place.startswith("free") for node in item.nodes)
    if lost and system.contact is None:
        return False
    if item.degree > 1:
        return _polynomials(system, item, lost=lost)
    if not all(is_definite(node.form) for node in item.nodes):
        return False
    rounding = any(m.fact.startswith("rounding") for m in item.multipliers)
    turns = [None] if system.clock is None else list(range(system.clock.length))
    steps = [
        move for turn in turns for move in moves(system, turn=turn, lost=lost, rounding=rounding)
    ]
    taken: set[tuple[int, int, int]] = set()
    for k, a, b in edges_at(item, steps):
        taken.add((a, k, b))
        if not is_definite(edge_form(item, steps[k], a, b), strictly=steps[k].strict):
            return False
    return _leaves_no_word(item, steps, taken)


def edges_at(item: kinds.FormsOnGraph, steps: Sequence[Move]) -> Iterator[tuple[int, int, int]]:
    """Yield the number of each step with the nodes that it leads between."""
    places = [node.place for node in item.nodes]
    for k, move in enumerate(steps):
        for a, b in product(range(len(places)), repeat=2):
            joined = any(_joins(edge, a, move.mode, b) for edge in item.edges)
            there = (places[a], places[b]) == (move.source, move.target)
            if there and joined and (a == b or not move.flows):
                yield k, a, b


def edge_form(item: kinds.FormsOnGraph, move: Move, a: int, b: int) -> Rows:
    """Return the inequality of a graph for a step between two nodes."""

    def multiplier(fact: str) -> int:
        own = [m.value for m in item.multipliers if (m.fact, m.target) == (fact, b)]
        shared = [m.value for m in item.multipliers if (m.fact, m.target) == (fact, None)]
        return (own or shared or [0])[0]

    keeps = 2 * item.rate if move.flows else item.rate**2 if move.strict else Fraction(1)
    return inequality(move, item.nodes[a].form, item.nodes[b].form, keeps, multiplier)


def _joins(edge, a: int, mode: str, b: int) -> bool:
    return all(x is None or x == y for x, y in zip(edge, (a, mode, b), strict=True))


def _leaves_no_word(item: kinds.FormsOnGraph, steps, taken) -> bool:
    """Follow words of up to six steps from every place, by brute force."""
    runs = {(p, frozenset(k for k, n in enumerate(item.nodes) if n.place == p))
            for p in {step.source for step in steps}}  # fmt: skip
    for _ in range(6):
        following = set()
        for place, nodes in runs:
            for k, step in enumerate(steps):
                if step.source == place:
                    after = frozenset(b for a, j, b in taken if j == k and a in nodes)
                    if not after:
                        return False
                    following.add((step.target, after))
        runs = following
    return True


@dataclass(frozen=True)
class Move:
    """What a system may do at a place: a map, or the derivative of a flow."""

    where: str
    mode: str
    source: str
    target: str
    image: Rows  # Over the state before, disturbances, and errors
    states: int
    sizes: Sequence[tuple[str, list[Fraction]]]  # By name, the row that limits each error
    crossings: Sequence[tuple[str, list[Fraction]]]
    flows: bool
    strict: bool = True  # It takes some time


def moves(
    system: SwitchedSystem,
    *,
    lost: bool,
    turn: int | None = None,
    channels: Sequence[int] = (),
    rounding: bool = False,
) -> Iterator[Move]:
    """Yield maps (or flows) of the state, what acts and the errors, and what is known of them."""
    contact, n, flows = (
        system.contact if lost else None,
        system.order,
        system.time is Time.CONTINUOUS,
    )
    at = "" if turn is None else f" {turn}"
    pulls = () if contact is None else contact.pulls
    errors = [(f"rounding {i}", r) for i, r in enumerate(system.roundings, 1) if rounding]
    width = n + len(channels) + len(errors)

    def padded(row: Sequence[Fraction]) -> list[Fraction]:
        return [*row, *[Fraction(0)] * (width - len(row))]

    def size(row: list[Fraction]) -> list[Fraction]:
        return padded([*row[:n], *(row[n + i] for i in channels)])

    free = () if contact is None else contact.free
    for k, mode in enumerate((*system.modes, *free)):
        leads = None if turn is None else led(system.clock, turn, mode.name)
        if leads == -1:
            continue
        to = at if leads is None else f" {leads}"
        wide, count = mode.A.fractions(), len(system.modes)
        for part in (*(system.channels[i] for i in channels), *(part for _, part in errors)):
            wide = [
                [*row, *entry] for row, entry in zip(wide, part.columns[k].fractions(), strict=True)
            ]
        sizes = [(name, size(part.rows[k].fractions()[0])) for name, part in errors]

        def move(where, source, target, image, *crossings, mode=mode.name, sizes=sizes, to=to):
            flies = source == "free"
            if flies:
                image, rows = _without([*image], n - 1), _without([q for _, q in sizes], n - 1)
                sizes = [(name, q) for (name, _), q in zip(sizes, rows, strict=True)]
            after = at if flows else to
            where = where.format(mode) if turn is None else f"{where.format(mode)}, at step {turn}"
            places = source + at, target + after
            return Move(where, mode, *places, image, n - flies, sizes, crossings, flows)

        if k < count:
            yield move("in mode {}", "modes", "modes", wide)
            if contact is not None and not flows:
                crossing = ("lost", wide[-1])
                yield move("where contact is lost in mode {}", "modes", "free", wide[:-1], crossing)
            continue
        yield move("in free motion, mode {}", "free", "free", wide[:-1])
        if not flows:
            yield move("where contact is made, mode {}", "free", "modes", wide)
            surface = "where contact is made at the surface, mode {}"
            yield move(surface, "free", "modes", wide[:-1])
        for i, q in enumerate(pulls, 1):
            # The numerators of a force in discrete time.
            force = padded(q.fractions()[0] if flows else [Fraction(e) for e in q.numerators[0]])
            own = f"pull {i} {mode.name}" if flows else f"pull {i}"
            where = "while the environment lags, mode {}"
            yield move(where, "modes", "modes", wide, (own, force))
            if not flows:
                both = (f"pull {i} lost", force), (f"lost pull {i}", wide[-1])
                where = "where a lagging environment is left, mode {}"
                yield move(where, "modes", "free", wide[:-1], *both)
    if flows and contact is not None:
        for ends in (("modes", "free"), ("free", "modes")):
            yield Move("", "", *ends, identity(n - 1), n - 1, (), (), flows=False, strict=False)


def inequality(
    move: Move,
    before: Rows,
    after: Rows,
    keeps: Fraction,
    multiplier: Callable[[str], Fraction | int],
    weights: Sequence[Fraction] = (),
) -> Rows:
    """Return what a step asks of the forms before and after it, from the definition."""
    image, n = move.image, move.states
    size, m = len(image[0]) if move.strict else n, len(image)
    after = [list(row[:m]) for row in after[:m]]
    seen = identity(size)[:n]
    kept = times(transpose(seen), times([list(row[:n]) for row in before[:n]], seen))
    if move.flows:
        half = times(transpose(seen), times(after, image))
        form = combine((-1, half), (-1, transpose(half)), (-keeps, kept))
    else:
        form = combine((keeps, kept), (-1, times(transpose(image), times(after, image))))
    for i, weight in enumerate(weights, n):
        form[i][i] += weight
    for i, (fact, q) in enumerate(move.sizes, n + len(weights)):
        form = combine((1, form), (-multiplier(fact), times(transpose([q]), [q])))
        form[i][i] += multiplier(fact)
    for fact, row in move.crossings:
        cross = times([[entry] for entry in identity(size)[n - 1]], [row])
        form = combine((1, form), (multiplier(fact), cross), (multiplier(fact), transpose(cross)))
    return form


def _without(M: Rows, k: int) -> Rows:
    return [[*row[:k], *row[k + 1 :]] for row in M]


def _polynomials(system: SwitchedSystem, item: kinds.FormsOnGraph, *, lost: bool = False) -> bool:
    """Evaluate them at many states, before and after every step: in a flow, after a tiny one."""
    d, rate, functions, maps = item.degree, item.rate, dict(item.nodes), []
    flows, ruled = system.time is Time.CONTINUOUS, item.stays is not None
    # Beside the fastest mode, in whatever unit of time.
    speed = max(abs(v) for mode in system.modes for row in mode.A.fractions() for v in row) or 1
    tiny = 1 / (10**15 * Fraction(speed))
    if len(functions) < len(item.nodes) or item.multipliers or (lost and not flows):
        return False
    for mode in (*system.modes, *(system.contact.free if lost else ())):
        A, place, keeps = mode.A.fractions(), mode.name if ruled else "modes", rate ** (2 * d)
        if mode not in system.modes:
            A, place = [row[:-1] for row in A[:-1]], "free"
        if flows:
            A, keeps = combine((1, identity(len(A))), (tiny, A)), 1 - 2 * d * rate * tiny
        left = ruled and mode.name in item.stays.leaving
        maps += [] if left else [(place, place, A, keeps)]
        for a, b, G in edges_of(system) if ruled else ():
            stays = _stays(system.time, *bounds_of(system, a), leaving=left) if a == place else ()
            maps += [(a, b, _after(G, A, stay), keeps**stay) for stay in stays]

    def value(place: str, x: Sequence[Fraction]) -> Fraction:
        # In integers over one denominator, which take a tenth of the time of fractions.
        whole, Q = lcm(*(entry.denominator for entry in x)), functions[place]
        z = [prod(p) for p in combinations_with_replacement([int(whole * e) for e in x], d)]
        form = sum(a * Q[i][j] * b for i, a in enumerate(z) for j, b in enumerate(z))
        return Fraction(form, whole ** (2 * d))

    random = Random(0)
    if {*functions} != {source for source, *_ in maps}:
        return False
    for source, target, M, keeps in maps * 40:
        x = [Fraction(random.randint(-99, 99)) for _ in M[0]]
        if source == "free" and value(source, x) != value("modes", [*x, Fraction(0)]):
            return False
        (after,) = transpose(times(M, transpose([x])))
        if any(x) and (value(source, x) <= 0 or value(target, after) >= keeps * value(source, x)):
            return False
    return True


def _invariant_ellipsoid(system: SwitchedSystem, item: kinds.InvariantEllipsoid) -> bool:
    """For the state and a constant one: what raises V only if a disturbance is too large."""
    named = [c for name in item.channels for c in system.channels if c.name == name]
    output = next((o for o in system.outputs if o.name == item.output), None)
    discrete, a = system.time is Time.DISCRETE, sum(item.shares)
    if not named or len(named) < len(item.channels) or output is None:
        return False
    if len(item.Q) != system.order or len(item.shares) != len(named):
        return False
    if item.level <= 0 or min(item.shares) <= 0 or (discrete and a >= 1):
        return False
    if item.roundings and len(item.roundings) != len(system.roundings):
        return False
    scale = Fraction(1, 2**item.denominator_log2)
    Q = combine((scale, [list(map(Fraction, row)) for row in item.Q]))
    acting = {
        "channels": [system.channels.index(channel) for channel in named],
        "rounding": bool(item.roundings),
    }
    steps = list(moves(system, lost=True, **acting))
    crossings = dict.fromkeys(fact for move in steps for fact, _ in move.crossings)
    if len(crossings) != len(item.multipliers):
        return False
    known = dict(zip(crossings, item.multipliers, strict=True))
    known |= {f"rounding {i}": entry for i, entry in enumerate(item.roundings, 1)}
    if min(known.values(), default=0) < 0:
        return False
    weights = [share / c.bound**2 for share, c in zip(item.shares, named, strict=True)]
    forms = [Q] + [
        inequality(move, Q, Q, 1 - a if discrete else a, lambda fact: scale * known[fact], weights)
        for move in steps
        if move.strict
    ]
    for q in output.rows:
        row = q.fractions()[0]
        outer = [[x * y for y in row] for x in row]
        forms.append(combine((item.level**2, Q), (-1, outer)))
    return all(map(is_definite, forms))


def _offset_ellipsoid(system: SwitchedSystem, item: kinds.OffsetEllipsoid) -> bool:
    named = [c for name in item.channels for c in system.channels if c.name == name]
    discrete, n = system.time is Time.DISCRETE, system.order
    if not named or len(named) < len(item.channels):
        return False
    if item.output not in {output.name for output in system.outputs}:
        return False
    if system.contact is None or len(item.Q) != n + 1:
        return False
    if len(item.shares) != 1 or item.shares[0] <= 0 or (discrete and item.shares[0] >= 1):
        return False
    if item.roundings and len(item.roundings) != len(system.roundings):
        return False
    if item.level <= 0 or item.Q[0][0] > 0 or min(*item.multipliers, *item.roundings, 0) < 0:
        return False
    return all(map(is_definite, offset_forms(system, item)))


def offset_forms(system: SwitchedSystem, item: kinds.OffsetEllipsoid) -> Iterator[Rows]:
    """For a one, the state and what acts: what raises W only if a sign is not as it must be.

    If there is not one multiplier for each fact, a form comes last that is not definite.
    """
    named = [c for name in item.channels for c in system.channels if c.name == name]
    output = next(o for o in system.outputs if o.name == item.output)
    scale = Fraction(1, 2**item.denominator_log2)
    W = combine((scale, [list(map(Fraction, row)) for row in item.Q]))
    yield [row[1:] for row in W[1:]]
    share = item.shares[0]
    keeps = 1 - share if system.time is Time.DISCRETE else share
    known = {f"rounding {i}": scale * entry for i, entry in enumerate(item.roundings, 1)}
    left, used = list(item.multipliers), {}

    def of(name: object) -> Fraction:
        if name not in used:
            used[name] = left.pop(0) if left else -1
        return scale * used[name]

    for move, facts in offset_moves(system, named, rounding=bool(item.roundings)):
        form = inequality(move, W, W, keeps, known.__getitem__, [Fraction(0)] * len(named))
        for name, a, b in facts:
            cross = times([[entry] for entry in a], [b])
            form = combine((1, form), (-of(name), cross), (-of(name), transpose(cross)))
        yield form
    for k, row in enumerate(output.rows):
        for sign in (1, -1):
            form = [[Fraction(entry) for entry in line] for line in W]
            form[0][0] += item.level
            added = [-sign * entry / 2 for entry in row.fractions()[0]]
            added[-1] -= of((k, sign)) / 2
            for i, entry in enumerate(added, 1):
                form[0][i] += entry
                form[i][0] += entry
            yield form
    if left or -1 in used.values():
        yield [[Fraction(-1)]]


def offset_moves(
    system: SwitchedSystem, named: Sequence[Channel], *, rounding: bool
) -> Iterator[tuple[Move, list[tuple[object, list[Fraction], list[Fraction]]]]]:
    """Yield every move that takes time, over a one and the rest, with products that are known."""
    discrete = system.time is Time.DISCRETE
    acting = [system.channels.index(channel) for channel in named]
    for move in moves(system, lost=True, channels=acting, rounding=rounding):
        if not move.strict or (move.where.startswith("where contact is made at the surface")):
            continue
        rows, m = [[Fraction(0), *row] for row in move.image], move.states + 1
        one = [Fraction(i == 0) for i in range(len(rows[0]))]
        image = [one if discrete else [0 * entry for entry in one], *rows]
        sizes = [(name, [0, *q]) for name, q in move.sizes]
        wide = replace(move, image=image, states=m, sizes=sizes, crossings=())
        within = []
        for k, channel in enumerate(named, m):
            for sign in (1, -1):
                within.append([1 if i == 0 else sign / channel.bound * (i == k)
                               for i in range(len(one))])  # fmt: skip
        deep = [[Fraction(i == m - 1) for i in range(len(one))]] * (move.source == "modes")
        pairs = list(zip(within[::2], within[1::2], strict=True))
        pairs += [(delta, side) for delta in deep for side in within]
        facts = [((move.where, i), *pair) for i, pair in enumerate(pairs)]
        scales = [q.denominator if move.flows else 1 for q in system.contact.pulls]
        signs = []
        for name, row in move.crossings:
            by = scales[int(name.split()[1]) - 1] if name.startswith("pull") else 1
            signs.append((name, [0, *(-by * entry for entry in row)]))
        if discrete and move.target == "modes":
            signs.append(("after", rows[-1]))
        for name, row in signs:
            for i, other in enumerate((*deep, *within)):
                facts.append(((move.where.removesuffix(move.mode), name, i), row, other))
        yield wide, facts


def _no_common_quadratic(system: SwitchedSystem, item: kinds.NoCommonQuadratic) -> bool:
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    n = system.order
    total = [[Fraction(0)] * n for _ in range(n)]
    for name, L in item.factors:
        A, X = modes[name], times(L, transpose(L))
        if system.time is Time.CONTINUOUS:
            total = combine((1, total), (1, times(A, X)), (1, times(X, transpose(A))))
        else:
            total = combine((1, total), (1, times(times(A, X), transpose(A))), (-1, X))
    names = [name for name, _ in item.factors]
    return len(set(names)) == len(names) and is_definite(total)


def _constants_quadratic(system: SwitchedSystem, item: kinds.ConstantsQuadratic) -> bool:
    """Sample the weights; with each of them the decrease is that of a common quadratic."""
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    n = len(item.functions)
    single = [[Fraction(k == v) for v in range(n)] for k in range(n)]
    mixed = [[(a + b) / 2 for a, b in zip(*pair, strict=True)] for pair in product(single, single)]
    tilted = [[Fraction(k * v % 7 + 1) for v in range(n)] for k in range(1, 9)]
    for w in (*single, *mixed, *([v / sum(row) for v in row] for row in tilted)):
        P = combine(*zip(w, item.functions, strict=True))
        matrices = [
            combine(*zip(w, (modes[name] for name in corners), strict=True))
            for corners in system.switching.fixed_ends
        ]
        forms = [decrease(A, P, item.rate, system.time) for A in matrices]
        if not all(map(is_definite, [P, *forms])):
            return False
    return is_rate(item.rate, system.time)


def edges_of(system: SwitchedSystem) -> list[tuple[str, str, Rows]]:
    """List source, target and map of all switches, from the rules themselves."""
    sizes = {mode.name: len(mode.A.numerators) for mode in system.modes}
    found = []
    for a, b in product(sizes, repeat=2):
        allowed = system.switching.transitions
        if a == b or (allowed is not None and (a, b) not in allowed):
            continue
        resets = [
            r.map.fractions() for r in system.switching.resets if (r.source, r.target) == (a, b)
        ]
        found += [(a, b, G) for G in resets or [identity(sizes[a])]]
    return found


def bounds_of(system: SwitchedSystem, mode: str) -> tuple[Fraction, Fraction | None]:
    for name, stay in system.switching.stays:
        if name == mode:
            return stay.shortest, stay.longest
    return system.switching.dwell_time, None


def identity(n: int) -> Rows:
    return [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]


def _mode_quadratic(system: SwitchedSystem, item: kinds.FormsOnGraph) -> bool:
    """From entry to entry, after every stay that counts: all up to the longest, or the shortest."""
    Q: Mapping[str, Rows] = dict(item.nodes)
    time = system.time
    if set(Q) != {m.name for m in system.modes} or not is_rate(item.rate, time):
        return False
    for mode in system.modes:
        form = decrease(mode.A.fractions(), Q[mode.name], item.rate, time)
        if not is_definite(Q[mode.name]):
            return False
        if mode.name not in item.stays.leaving and not is_definite(form):
            return False
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    return all(
        _does_not_raise(modes[a], G, Q[a], Q[b], item.rate, time, stay)
        for a, b, G in edges_of(system)
        for stay in _stays(time, *bounds_of(system, a), leaving=a in item.stays.leaving)
    )


def _stays(time, shortest, longest, *, leaving) -> list[Fraction]:
    if time is Time.DISCRETE:
        shortest = max(shortest, Fraction(1))
    if not leaving:
        return [shortest]
    assert longest is not None
    if time is Time.DISCRETE:
        return [Fraction(k) for k in range(int(shortest), int(longest) + 1)]
    return [shortest + (longest - shortest) * Fraction(k, 64) for k in range(65)]


def _after(G: Rows, A: Rows, steps: Fraction) -> Rows:
    for _ in range(int(steps)):
        G = times(G, A)
    return G


def _does_not_raise(A, G, before, after, rate, time, stay) -> bool:
    if time is Time.DISCRETE:
        jump = _after(G, combine((1 / rate, A)), stay)
        image = times(transpose(jump), times(after, jump))
        return is_definite(combine((1, before), (-1, image)))
    if stay == 0:
        image = times(transpose(G), times(after, G))
        return is_definite(combine((1, before), (-1, image)), strictly=False)
    jump = _floats(G) @ expm((_floats(A) + float(rate) * np.eye(len(A))) * float(stay))
    form = _floats(before) - jump.T @ _floats(after) @ jump
    return bool(np.linalg.eigvalsh(form).min() > -1e-9 * np.abs(_floats(before)).max())


def _floats(rows) -> np.ndarray:
    return np.array([[float(entry) for entry in row] for row in rows])


def _growing_sequence(system: SwitchedSystem, item: kinds.GrowingSequence) -> bool:
    if item.shares:
        return _grows_at_value(system, item)
    if item.factor is not None:
        return _grows_in_contact(system, item)
    if item.doublings is not None:
        return _grows_in_a_period(system, item)
    if len(item.steps) == 1:
        return _is_unstable_mode(system, item.steps[0][0])
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    mean = combine(*((w, modes[name]) for name, w in item.steps))
    proper = all(w >= 0 for _, w in item.steps) and sum(w for _, w in item.steps) == 1
    return proper and not is_stable_by_lyapunov(mean, system.time)


def _is_unstable_mode(system: SwitchedSystem, name: str) -> bool:
    if system.clock is not None:
        return False
    A = next((mode.A.fractions() for mode in system.modes if mode.name == name), None)
    if A is None:
        # In the air, the deflection is not looked at.
        (whole,) = (m.A.fractions() for m in system.contact.free if m.name == name)
        A = [row[:-1] for row in whole[:-1]]
    return bounds_of(system, name)[1] is None and not is_stable_by_lyapunov(A, system.time)


def _grows_in_contact(system: SwitchedSystem, item: kinds.GrowingSequence) -> bool:
    """Follow every eigenvector of the sequence, as contact is lost and made."""
    contact, flights = system.contact, system.flights
    free = () if contact is None else contact.free
    pulls = (contact or flights).pulls
    felt = {m.name for m in free} if flights is None else set(flights.flying)
    touching = {m.name for m in system.modes} if flights is None else set(flights.touching)
    matrices = {m.name: np.array(m.A.floats()) for m in (*system.modes, *free)}
    names = [name for name, count in item.steps for _ in range(int(count))]
    if system.clock is not None and not goes_on(system.clock, names):
        return False
    M = np.eye(system.order)
    for name in names:
        M = matrices[name] @ M
    low, high = map(float, item.factor)
    limit = 0.0 if system.time is Time.CONTINUOUS else 1.0
    if low < limit or (system.time is Time.CONTINUOUS and len(names) > 1):
        return False

    def keeps(x: np.ndarray) -> bool:
        for name in names:
            forces = [float(np.array(row.floats())[0] @ x) for row in pulls]
            touches = x[-1] > 0 and all(force > 0 for force in forces)
            flies = x[-1] < 0 or (bool(forces) and all(force < 0 for force in forces))
            if (name in touching and not touches) or (name in felt and not flies):
                return False
            x = matrices[name] @ x
        return True

    for value, vector in zip(*_eigen(M), strict=True):
        near = low * (1 - 1e-9) <= value.real <= high * (1 + 1e-9) and abs(value.imag) < 1e-12
        if near and any(keeps(sign * vector.real) for sign in (1, -1)):
            return True
    return False


def _eigen(M: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    values, vectors = np.linalg.eig(M)
    return values, vectors.T


def _grows_in_a_period(system: SwitchedSystem, item: kinds.GrowingSequence) -> bool:
    """Walk round the period: switches are edges, stays within their bounds, and it grows."""
    modes = {mode.name: _floats(mode.A.fractions()) for mode in system.modes}
    product_ = np.eye(system.order)
    names = [name for name, _ in item.steps]
    if system.clock is not None and not _takes_turns(system, item):
        return False
    for k, (name, dwell) in enumerate(item.steps):
        shortest, longest = bounds_of(system, name)
        following = names[(k + 1) % len(names)]
        # One mode alone is never left.
        shortest = shortest if len(names) > 1 else 0
        if dwell <= 0 or dwell < shortest or (longest is not None and dwell > longest):
            return False
        if following == name and longest is not None:
            return False
        if system.time is Time.CONTINUOUS:
            product_ = expm(modes[name] * float(dwell)) @ product_
        else:
            product_ = np.linalg.matrix_power(modes[name], int(dwell)) @ product_
        if following != name:
            ways = [G for a, b, G in edges_of(system) if (a, b) == (name, following)]
            way = item.edges[k] if item.edges else 0
            if not 0 <= way < len(ways):
                return False
            product_ = _floats(ways[way]) @ product_
    return bool(np.abs(np.linalg.eigvals(product_)).max() > 1 - 1e-9)


def _takes_turns(system: SwitchedSystem, item: kinds.GrowingSequence) -> bool:
    """Write every step down, and find a state in which the period may begin for ever."""
    assert system.clock is not None
    return goes_on(system.clock, [name for name, n in item.steps for _ in range(int(n))])


def led(clock: Clock, state: int, name: str) -> int:
    """Return where a mode leads from a state; -1 where it is not its turn."""
    kinds = [clock.first, *clock.more, (name,)]
    kind = next(k for k, own in enumerate(kinds) if name in own)
    if clock.ahead:
        return clock.ahead[state][kind]
    return (state + 1) % clock.length if (kind == 0) == (state == 0) else -1


def goes_on(clock: Clock, names: Sequence[str]) -> bool:
    """Tell whether steps may be repeated from some state, as often as there are states."""
    for state in range(clock.length):
        for name in [*names] * clock.length:
            state = state if state == -1 else led(clock, state, name)
        if state != -1:
            return True
    return False


def _grows_at_value(system: SwitchedSystem, item: kinds.GrowingSequence) -> bool:
    """The system at a value, which is told apart in test_constant.py, is one without parameters."""
    if not all(0 <= share <= 1 for share in item.shares):
        return False
    return holds(system_at(system, item.shares), replace(item, shares=()))


def _block_triangular(system: SwitchedSystem, item: kinds.BlockTriangular) -> bool:
    order = [state for block in item.blocks for state in block]
    if sorted(order) != list(range(system.order)):
        return False
    where = {state: k for k, block in enumerate(item.blocks) for state in block}
    for mode in system.modes:
        for i, j in product(range(system.order), repeat=2):
            if where[i] > where[j] and mode.A.numerators[i][j] != 0:
                return False
    covered = {k for k, _ in item.parts}
    complete = covered == set(range(len(item.blocks))) or str(item.shows) != "stability"
    return complete and all(
        holds(diagonal_block(system, item.blocks[k]), part) for k, part in item.parts
    )


_ORACLES = {
    kinds.ConstantsQuadratic: _constants_quadratic,
    kinds.FormsOnGraph: _graph,
    kinds.GrowingSequence: _growing_sequence,
    kinds.InvariantEllipsoid: _invariant_ellipsoid,
    kinds.NoCommonQuadratic: _no_common_quadratic,
    kinds.OffsetEllipsoid: _offset_ellipsoid,
    kinds.SaturatedEllipsoid: _saturated_ellipsoid,
    kinds.BlockTriangular: _block_triangular,
}
