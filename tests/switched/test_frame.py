"""One period of the sampled loop: known answers, a simulation step by step, and its roundings."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.controllers.sampled import (
    UNIT,
    SampledAdmittance,
    SampledMotion,
    rounding_share,
)
from nrs_design.switched.frame import Frame


@pytest.mark.parametrize(
    ("Bt", "delay", "limit"),
    [("1.04", j, k) for j, k in ((0, 59.5), (1, 53.5), (2, 48.8), (5, 39.4))]
    + [("2.15", j, k) for j, k in ((0, 155), (1, 134), (2, 118), (5, 91))],
)
def test_largest_stable_stiffness(Bt, delay, limit):
    """Where the spectral radius of one mode reaches one, for Mt = 0.01 and T = 2 ms.

    Found by bisection with an independent program; a stiffness of three digits.
    """

    def radius(k: float) -> float:
        frame = _frame(delay)
        n = len(frame.states)
        A = np.array(frame.rows(_law(Bt), delay, _nominal(k)), dtype=float)[:n, :n]
        return float(np.abs(np.linalg.eigvals(A)).max())

    assert radius(limit * 0.99) < 1 < radius(limit * 1.01)


PERIOD = Fraction(1, 500)
TAU, KM = Fraction("0.0351"), Fraction("4.8417e-4")
MOTION = SampledMotion(Fraction("117359.43"), Fraction(1_030_000))


def _frame(delay: int, *, inertia: bool = True) -> Frame:
    return Frame(PERIOD, MOTION, inertia, delay, TAU)


def _law(Bt: str) -> SampledAdmittance:
    a = np.exp(-float(Bt) * 0.002 / 0.01)
    return SampledAdmittance(Fraction(a), Fraction((1 - a) / float(Bt)), PERIOD)


def _nominal(k: float, b: float = 0.0) -> dict[str, Fraction]:
    E = np.exp(-0.002 / 0.0351)
    return {"Km": KM, "E": Fraction(float(E)), "k": Fraction(k), "b": Fraction(b)}


def test_agrees_with_a_simulation_step_by_step():
    """The law and the motor one after the other, as a program runs them, at 1,000 random states."""
    rng = np.random.default_rng(13)
    for _ in range(1000):
        Kp, D = rng.uniform(1e3, 1e5), rng.uniform(0, 1e6)
        tau, Km, T = (
            rng.uniform(0.005, 0.1),
            rng.uniform(1e-5, 1e-3),
            rng.choice([0.001, 0.002, 0.01]),
        )
        k, b, a, gain = rng.uniform(0, 100, 4) * [1, 0.1, 0.01, 0.01]
        longest = int(rng.integers(0, 4))
        delay = int(rng.integers(0, longest + 1))
        inertia = bool(rng.integers(0, 2))
        law = SampledAdmittance(Fraction(a) if inertia else None, Fraction(gain), Fraction(T))
        frame = Frame(
            Fraction(T), SampledMotion(Fraction(Kp), Fraction(D)), inertia, longest, Fraction(tau)
        )
        values = {"Km": Km, "E": float(np.exp(-T / tau)), "k": k, "b": b}
        rows = frame.rows(law, delay, {key: Fraction(value) for key, value in values.items()})
        x = rng.normal(size=len(frame.states))
        e, omega, before, theta = x[0], x[1], x[2], x[-1]
        forces = [k * theta + b * omega, *x[3 + inertia : -1]]
        v = x[3] if inertia else gain * forces[delay]
        u = Kp * e + D * (e - before)
        held = np.zeros((3, 3))
        held[:2] = [[0, 1, 0], [0, -1 / tau, Km / tau]]
        moved = (expm(held * T) @ [theta, omega, u])[:2]
        reference = e + theta - T * v
        expected = [reference - moved[0], moved[1], e]
        expected += [a * v + gain * forces[delay]] if inertia else []
        expected += [*forces[:longest], moved[0]]
        got = np.array(rows, dtype=float)[: len(x), : len(x)] @ x
        assert got == pytest.approx(np.array(expected), rel=1e-9, abs=1e-9)


def exactly(number: np.float32) -> Fraction:
    return Fraction(float(number))


def test_single_precision_never_leaves_the_roundings():
    """1,000 random states and laws, computed in float32: every error is within its row.

    The operations of `nrs_design.controllers.sampled`, in numpy's single precision; what the exact
    law would have made of the same numbers is computed in fractions. Angles are exact here.
    """
    rng = np.random.default_rng(14)
    single = np.float32
    largest: dict[str, Fraction] = {}
    for _ in range(1000):
        inertia = bool(rng.integers(0, 2))
        Kp, D, a, b, T = (single(v) for v in rng.uniform(0.1, 2, 5) * [1e5, 1e6, 0.5, 0.2, 2e-3])
        e, before, v, force, command = (single(x) for x in rng.normal(size=5) * 0.1)
        true = exactly(force) * (1 + Fraction(rng.uniform(-1, 1)) * UNIT)
        exact_e = exactly(e) * (1 + Fraction(rng.uniform(-1, 1)) * UNIT)
        u = Kp * e + D * (e - before)
        velocity = v if inertia else b * force
        step = T * (command - velocity)
        kept = a * v + b * force
        law = SampledAdmittance(exactly(a) if inertia else None, exactly(b), exactly(T))
        motion = SampledMotion(exactly(Kp), exactly(D))
        frame = Frame(PERIOD, motion, inertia, 1, TAU)
        n = len(frame.states)
        values = {"Km": KM, "E": Fraction(94, 100), "k": Fraction(0), "b": Fraction(0)}
        rows = frame.rows(law, 1, values)[n:]
        state = [exact_e, Fraction(0), exactly(before), *([exactly(v)] * inertia)]
        state += [true, Fraction(0), exactly(command)]
        state += [Fraction(0)] * (len(rows[0]) - len(state))
        sizes = dict(
            zip(
                frame.roundings,
                (abs(sum(q * x for q, x in zip(row, state, strict=True))) for row in rows),
                strict=True,
            )
        )
        # The law commands what these errors, and these alone, add to the exact one.
        errors = {"e": exactly(e) - exact_e}
        drive = exactly(u) - exactly(Kp) * exactly(e)
        drive -= exactly(D) * (exactly(e) - exactly(before))
        both = {"u": (drive, sizes["Kp e"] + sizes["D (e - e before)"])}
        both["e"] = (errors["e"], sizes["e"])
        if inertia:
            moved = exactly(kept) - exactly(a) * exactly(v) - exactly(b) * true
            both["v"] = (moved, sizes["a vm"] + sizes["b F"])
            exact = exactly(v)
        else:
            exact = exactly(b) * true
        travelled = exactly(step) - exactly(T) * (exactly(command) - exact)
        allowed = sizes["T (v - vm)"] + (0 if inertia else exactly(T) * sizes["b F"])
        both["step"] = (travelled, allowed)
        for name, (error, size) in both.items():
            assert abs(error) <= size, name
            largest[name] = max(largest.get(name, Fraction(0)), abs(error) / size)
    # And they come near: what is allowed is not far too much.
    assert min(largest[name] for name in ("e", "u", "v", "step")) > Fraction(3, 10)


def test_the_share_of_many_roundings():
    """Not below n u / (1 - n u), of which no product of n factors 1 + u has more."""
    for n in range(1, 16):
        assert (1 + UNIT) ** n - 1 <= n * UNIT / (1 - n * UNIT) <= rounding_share(n)
        assert rounding_share(n) < n * UNIT * (1 + Fraction(1, 10**6))
    for n in (0, 16):
        with pytest.raises(ValueError, match="not counted"):
            rounding_share(n)
