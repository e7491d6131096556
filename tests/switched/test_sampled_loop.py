"""The sampled loop: against a step-by-step simulation, known answers, and what is not modelled."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.controllers.sampled import (
    ROUNDINGS,
    UNIT,
    SampledAdmittance,
    SampledMotion,
    rounding_share,
)
from nrs_design.controllers.sensor import SampledLowPass
from nrs_design.errors import AssemblyError
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.pipeline import run_design
from nrs_design.proof.system import SwitchedSystem, Time
from nrs_design.spec import read_spec
from nrs_design.spec.interval import Interval
from nrs_design.switched.assemble import assemble
from nrs_design.switched.sampled_loop import Frame, motor_box
from tests.support import FORCE_LIMIT, SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
TOLERANCE = (
    (
        "gain: 4.8417e-4 rad/s/rpm",
        "gain: {nominal: 4.8417e-4 rad/s/rpm, "
        "range: [4.744866e-4 rad/s/rpm, 4.938534e-4 rad/s/rpm]}",
    ),
    (
        "time_constant: 0.0351 s",
        "time_constant: {nominal: 0.0351 s, range: [0.034398 s, 0.035802 s]}",
    ),
)


def system_of(
    path: Path, sampling: str, *changes: tuple[str, str], text: str = TEXT
) -> SwitchedSystem:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = path / "sampled.nrs.yaml"
    path.write_text(f"{text}\nsampling: {sampling}\n", encoding="utf-8")
    designed = run_design(read_spec(path))
    assert designed is not None
    return assemble(designed.spec, designed.plant, designed.design, "deflection")


def test_modes_and_states_of_the_thesis_robot(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: [0, 1]}")
    assert system.time is Time.DISCRETE
    assert system.sample_time == Fraction(1, 500)
    assert system.states == (
        "e [rad]",
        "omega [rad/s]",
        "e before [rad]",
        "vm [rad/s]",
        "F 1 before [N*m]",
        "delta [rad]",
    )
    # Two controllers, two delays, two ends of k, two bounds on exp(-T/tau).
    assert len(system.modes) == 16
    assert len(system.contact.free) == 8
    assert system.find_contradiction() is None
    assert [item.name for item in system.roundings] == [*ROUNDINGS]
    texts = " ".join(system.assumptions)
    assert "0 to 1 sample old" in texts
    assert "D (e - e before) 3" in texts
    assert "without jitter" in texts
    assert "Kd/T = 1030000" in texts


def test_a_tolerance_of_the_motor_gives_its_corners(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: [0, 1]}", *TOLERANCE)
    assert len(system.modes) == 64
    assert "may change at every sample" in " ".join(system.assumptions)


def test_without_inertia_there_is_no_velocity(tmp_path):
    system = system_of(
        tmp_path,
        "{period: 2 ms, delay: 0}",
        ("min: 0.01 kg*m^2, max: 1 kg*m^2", "min: 0 kg*m^2, max: 0 kg*m^2"),
    )
    assert system.order == 4


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
        Kt = float(rng.integers(0, 2) * rng.uniform(0, 10))
        law = SampledAdmittance(
            Fraction(a) if inertia else None, Fraction(gain), Fraction(T), Fraction(Kt)
        )
        order, p, q = int(rng.integers(0, 3)), rng.uniform(), rng.uniform()
        low_pass = SampledLowPass(order, Fraction(p), Fraction(q)) if order else None
        motion = SampledMotion(Fraction(Kp), Fraction(D))
        frame = Frame(Fraction(T), motion, inertia, longest, Fraction(tau), low_pass, Kt > 0)
        values = {"Km": Km, "E": float(np.exp(-T / tau)), "k": k, "b": b}
        rows = frame.rows(law, delay, {key: Fraction(value) for key, value in values.items()})
        x = rng.normal(size=len(frame.states))
        e, omega, before, theta = x[0], x[1], x[2], x[-1]
        forces = [k * theta + b * omega, *x[3 + inertia + order : -1]]
        filtered, felt = [], forces[delay]
        for lag in x[3 + inertia : 3 + inertia + order]:
            felt = p * lag + q * felt
            filtered.append(felt)
        felt += Kt * (e + theta)
        v = x[3] if inertia else gain * felt
        u = Kp * e + D * (e - before)
        held = np.zeros((3, 3))
        held[:2] = [[0, 1, 0], [0, -1 / tau, Km / tau]]
        moved = (expm(held * T) @ [theta, omega, u])[:2]
        reference = e + theta - T * v
        expected = [reference - moved[0], moved[1], e]
        expected += [a * v + gain * felt] if inertia else []
        expected += [*filtered, *forces[:longest], moved[0]]
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


def test_filter_and_spring_in_single_precision_stay_within_the_roundings():
    """Two lags and a spring, computed in float32: lags and velocity are off by what is allowed.

    From the same numbers, what the exact law makes of them is computed in fractions.
    """
    rng = np.random.default_rng(12)
    single = np.float32
    nearest = Fraction(0)
    for _ in range(200):
        inertia = bool(rng.integers(0, 2))
        p, q, a, b, Kt = (single(v) for v in rng.uniform(0.1, 1, 5) * [1, 1, 0.5, 0.2, 10])
        x1, x2, v, force, reference, start = (single(x) for x in rng.normal(size=6) * 0.1)
        true = exactly(force) * (1 + Fraction(rng.uniform(-1, 1)) * UNIT)
        moved = exactly(reference) - exactly(start)
        y1 = p * x1 + q * force
        y2 = p * x2 + q * y1
        pushed = b * (y2 + Kt * (reference - start))
        velocity = a * v + pushed if inertia else pushed
        step = SampledLowPass(2, exactly(p), exactly(q))
        law = SampledAdmittance(exactly(a) if inertia else None, exactly(b), PERIOD, exactly(Kt))
        frame = Frame(PERIOD, MOTION, inertia, 1, TAU, step, sprung=True)
        n, names = len(frame.states), list(frame.roundings)
        values = {"Km": KM, "E": Fraction(94, 100), "k": Fraction(0), "b": Fraction(0)}
        rows = frame.rows(law, 1, values)
        # The reference is e + delta, and the law takes the force that is one sample old.
        state = [moved, *[Fraction(0)] * 2, *([exactly(v)] * inertia), exactly(x1), exactly(x2)]
        state += [true, Fraction(0)]
        first = 3 + inertia
        state += [Fraction(0)] * (len(rows[0]) - len(state))
        sizes = [abs(sum(c * x for c, x in zip(row, state, strict=True))) for row in rows[n:]]
        exact = [sum(c * x for c, x in zip(row, state, strict=True)) for row in rows[:n]]
        pairs = [(exactly(y1), first), (exactly(y2), first + 1)]
        if inertia:
            pairs.append((exactly(velocity), 3))
        for found, i in pairs:
            columns = rows[i][-len(names) :]
            allowed = sum(abs(c) * size for c, size in zip(columns, sizes, strict=True))
            assert abs(found - exact[i]) <= allowed
            nearest = max(nearest, abs(found - exact[i]) / allowed)
        if not inertia:
            terms = [j for j, name in enumerate(names) if name.startswith("b ")]
            wanted = exactly(b) * (
                exactly(p) * exactly(x2)
                + exactly(q) * (exactly(p) * exactly(x1) + exactly(q) * true)
                + exactly(Kt) * moved
            )
            assert abs(exactly(velocity) - wanted) <= sum(sizes[j] for j in terms)
    assert nearest > Fraction(3, 10)


def test_the_share_of_many_roundings():
    """Not below n u / (1 - n u), of which no product of n factors 1 + u has more."""
    for n in range(1, 16):
        assert (1 + UNIT) ** n - 1 <= n * UNIT / (1 - n * UNIT) <= rounding_share(n)
        assert rounding_share(n) < n * UNIT * (1 + Fraction(1, 10**6))
    for n in (0, 16):
        with pytest.raises(ValueError, match="not counted"):
            rounding_share(n)


def test_a_spring_does_not_go_with_a_command_that_moves_on(tmp_path):
    """The state tells the displacement only while the reference stays where it is."""
    sprung = (BT, "Kt: 0.5 N*m/rad\n    " + BT)
    sampling = "{period: 2 ms, delay: 0}\ndisturbances: {command: 8 deg/s}"
    with pytest.raises(AssemblyError, match="the spring Kt draws") as caught:
        system_of(tmp_path, sampling, sprung)
    assert caught.value.at == ("disturbances", "command")


def test_with_a_spring_free_motion_is_a_mode_like_others(tmp_path):
    sprung = (BT, "Kt: 0.5 N*m/rad\n    " + BT)
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}\ncontact: losable", sprung)
    assert system.contact is None
    assert sum("/free/" in mode.name for mode in system.modes) == 4
    assert "at any moment" in " ".join(system.assumptions)
    kept = system_of(tmp_path, "{period: 2 ms, delay: 0}", sprung)
    assert "before the reference moves on" in " ".join(kept.assumptions)
    assert not any("free" in mode.name for mode in kept.modes)


def test_bounds_of_the_motor_hold_what_lies_between():
    """E and s at any time constant of the range lie within their axes."""
    tau = Interval(TAU, TAU * Fraction(9, 10), TAU * Fraction(11, 10))
    box = motor_box(ActuatorRanges(Interval.point(KM), tau, "rpm"), PERIOD).ranges
    Km, E, s = (box[symbol] for symbol in ("Km", "E", "s"))
    assert Km == Interval.point(KM)
    for share in np.linspace(0, 1, 50):
        value = float(tau.low + Fraction(float(share)) * (tau.high - tau.low))
        exponential = np.exp(-0.002 / value)
        assert float(E.low) <= exponential * (1 + 1e-12)
        assert exponential <= float(E.high) * (1 + 1e-12)
        assert float(s.low) <= value * (1 - exponential) * (1 + 1e-12)
        assert value * (1 - exponential) <= float(s.high) * (1 + 1e-12)


BT = "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad"
RANGED_SOFT = "{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([(f"{BT}}}", f"{BT}, range: [1 N*m*s/rad, 3 N*m*s/rad]}}")], "have ranges"),
        ([("model: elastic", "model: maxwell\n    damping: 20 N*s/m")], "remembers"),
        (
            [
                (RANGED_SOFT, "747.1461 N/m"),
                ("switching: arbitrary", "switching: {dwell_time: 1 s}"),
            ],
            "have dwell times",
        ),
    ],
)
def test_what_the_sampled_loop_does_not_model_is_refused(tmp_path, changes, said):
    with pytest.raises(AssemblyError, match=said) as caught:
        system_of(tmp_path, "{period: 2 ms, delay: 0}", *changes)
    assert "sampling" in caught.value.remedy
    assert caught.value.at


def test_other_controllers_are_refused(tmp_path):
    with pytest.raises(AssemblyError, match="is a position controller"):
        system_of(
            tmp_path, "{period: 2 ms, delay: 0}", text=FORCE_LIMIT.read_text(encoding="utf-8")
        )


def test_force_coordinates_are_refused(tmp_path):
    path = tmp_path / "sampled.nrs.yaml"
    path.write_text(f"{TEXT}\nsampling: {{period: 2 ms, delay: 0}}\n", encoding="utf-8")
    designed = run_design(read_spec(path))
    with pytest.raises(AssemblyError, match="do not apply to the sampled loop"):
        assemble(designed.spec, designed.plant, designed.design, "force")


def test_contact_is_kept_where_the_spec_says_so(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}\ncontact: kept")
    assert system.contact is None
    assert "Contact is not lost" in " ".join(system.assumptions)


def test_a_damped_environment_is_kept(tmp_path):
    damped = ("model: elastic", "model: kelvin-voigt\n    damping: 1 N*s/m")
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}", damped)
    assert system.contact is None
    assert "lags behind is not modelled" in " ".join(system.assumptions)


def test_loss_of_contact_with_damping_is_refused_where_the_spec_asks_for_it(tmp_path):
    damped = ("model: elastic", "model: kelvin-voigt\n    damping: 1 N*s/m")
    with pytest.raises(AssemblyError, match="loss of contact with soft, which has damp") as caught:
        system_of(tmp_path, "{period: 2 ms, delay: 0}\ncontact: losable", damped)
    assert "contact: kept" in caught.value.remedy
    assert caught.value.at == ("contact",)


def test_where_free_motion_rests_is_not_said(tmp_path):
    losable = system_of(tmp_path, "{period: 2 ms, delay: 0}")
    assert "all modes in contact then rest at one point" in " ".join(losable.assumptions)
    kept = system_of(tmp_path, "{period: 2 ms, delay: 0}\ncontact: kept")
    assert "all modes then rest at one point" in " ".join(kept.assumptions)


def test_doubts_about_identified_values_are_said(tmp_path):
    doubtful = (
        "time_constant: 0.0351 s",
        'time_constant: 0.0351 s\n  doubts: ["dead time"]\n  accept_doubt: it is short',
    )
    about = ("    model: elastic", "    model: elastic\n    linearized_about: 2 mm")
    texts = system_of(tmp_path, "{period: 2 ms, delay: 0}", doubtful, about).assumptions
    assert any("actuator is in doubt: dead time; accepted because: it is short" in t for t in texts)
    assert any("soft is the linearization about 2 mm" in text for text in texts)
