"""What is known of signs holds along every motion; and it would not if a sign were another."""

from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.offset import offset_steps
from tests.proof.systems import bouncing, bouncing_in_steps, crowded, pushed
from tests.proof.truth import offset_moves

TRIALS = 300
LAGGING = "while the environment lags, mode free"


def steps_by_words(system):
    return {
        step.where: step
        for step in offset_steps(system, system.channels, 1, rounding=bool(system.roundings))
    }


def drawn(rng, size):
    return Fraction(rng.randint(-64, 64), 64) * size


def apply(rows, z):
    return [sum(a * b for a, b in zip(row, z, strict=True)) for row in rows]


def smallest(step, z):
    """Return the least product of a step at z, in the units of the system."""
    inner = [entry / unit for entry, unit in zip(z, step.units, strict=True)]

    def value(row):
        return sum(a * b for a, b in zip(row, inner, strict=False))

    return min(value(one) * value(other) for _, one, other in step.products)


def moved(system, rng, x, d):
    """Return the words of what happens in a step from x under d, and where it leads."""
    mode, free = rng.choice(list(enumerate(system.modes))), system.contact.free[0]
    touches = x[-1] > 0
    k, chosen = mode if touches else (len(system.modes), free)
    after = apply(chosen.A.fractions(), x)
    column = system.channels[0].columns[k].fractions()
    after = [a + b * d for a, (b,) in zip(after, column, strict=True)]
    lands = after[-1] > 0
    where = {
        (True, True): "in mode {}",
        (True, False): "where contact is lost in mode {}",
        (False, True): "where contact is made, mode {}",
        (False, False): "in free motion, mode {}",
    }[touches, lands]
    return where.format(chosen.name), after


@pytest.mark.parametrize("time", Time)
def test_steps_and_products_are_those_of_the_definition(time):
    """With several of everything, one disturbance left out and the others in another order."""
    system = crowded(time)
    channels = (system.channels[2], system.channels[0])
    steps = list(offset_steps(system, channels, 1, rounding=True))
    wanted = list(offset_moves(system, channels, rounding=True))
    assert [step.where for step in steps] == [move.where for move, _ in wanted]
    names = set()
    for step, (move, facts) in zip(steps, wanted, strict=True):
        units = list(step.units)
        for k, channel in enumerate(channels, step.states):
            units[k] *= channel.bound

        def plain(row, over=1, units=units):
            # A force is known over the state alone.
            whole = [*row, *(0 for _ in units[len(row) :])]
            return [Fraction(a, over) / unit for a, unit in zip(whole, units, strict=True)]

        assert [plain(row, step.over) for row in step.rows] == move.image
        assert [(name, plain(q, below)) for name, _, q, below in step.errors] == move.sizes
        assert [(plain(a), plain(b)) for _, a, b in step.products] == [(a, b) for _, a, b in facts]
        assert step.weights == (0, 0)
        pairs = zip(step.products, facts, strict=True)
        names |= {(name, wanted) for (name, *_), (wanted, *_) in pairs}
    # The same products have one multiplier.
    assert len(names) == len({name for name, _ in names}) == len({name for _, name in names})


@pytest.mark.parametrize("turned", [None, "after", "lost"])
def test_products_are_not_negative_along_motions(turned):
    """With the sign of one row turned round, some motion has a negative one."""
    system, rng = pushed(bouncing_in_steps()), Random(3)
    steps, least, seen = steps_by_words(system), Fraction(0), set()
    bound = system.channels[0].bound
    for _ in range(TRIALS):
        x = [drawn(rng, 1), drawn(rng, Fraction(1, 8))]
        d = rng.choice([-1, 1, Fraction(1, 3)]) * bound
        where, _ = moved(system, rng, x, d)
        step = steps[where]
        seen.add(where)
        z = [Fraction(1), *(x if step.source == "contact" else x[:-1]), d / bound]
        if turned is not None:
            products = [
                (name, [-entry for entry in row] if f"{turned}:" in name else row, other)
                for name, row, other in step.products
            ]
            step = replace(step, products=tuple(products))
        least = min(least, smallest(step, z))
    assert (least < 0) is (turned is not None)
    assert seen == set(steps)


@pytest.mark.parametrize("step_words", ["map", "flow"])
def test_a_lagging_environment_does_not_pull(step_words):
    """Where the force ``k delta + b delta'`` of the corner is negative, all products hold."""
    system = pushed(bouncing_in_steps(1) if step_words == "map" else bouncing(1))
    rng, found = Random(1), 0
    lagging = [s for s in offset_steps(system, system.channels, 1, rounding=False)
               if s.where == LAGGING]  # fmt: skip
    for step, q in zip(lagging, system.contact.pulls, strict=True):
        for _ in range(TRIALS):
            x = [drawn(rng, 1), abs(drawn(rng, 1))]
            (force,) = apply(q.fractions(), x)
            after = apply(system.contact.free[0].A.fractions(), x)[-1]
            if force <= 0 and (step.is_flow or after >= 0):
                found += 1
                assert smallest(step, [Fraction(1), *x, drawn(rng, 1)]) >= 0
    assert found > TRIALS // 4


def test_products_of_a_row_of_the_mode_have_one_multiplier_for_all_modes():
    """And no product has two rows of the mode in it: averages of modes would not be covered."""
    system = pushed(bouncing_in_steps())
    one, two = (steps_by_words(system)[f"in mode m{k}"] for k in range(2))
    assert system.modes[0].A != system.modes[1].A
    shared = {name for name, *_ in one.products} & {name for name, *_ in two.products}
    assert shared == {"in mode after: 0", "in mode after: 1", "in mode after: 2"}
    for step in (one, two):
        row = list(step.rows[-1])
        for name, first, other in step.products:
            assert (list(first) == row) is (name in shared)
            assert list(other) != row


def test_in_kept_contact_nothing_is_known_of_the_deflection():
    """Were its sign known as where contact is lost, ``x+ = -2 x + d`` would not grow."""
    system = pushed(replace(bouncing_in_steps(), contact=None))
    names = [[name for name, *_ in step.products] for step in steps_by_words(system).values()]
    assert names == [["in mode m0: 0"], ["in mode m1: 0"]]
