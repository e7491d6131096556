"""The list of operations is the law of the certificate: its map and its roundings.

The certificate takes both from the list. Here the loop around it is written again, with inputs and
motor, and how often terms are rounded is counted by hand; `tests/switched/test_sampled_frame.py`
holds the same loop against simulations step by step.
"""

from fractions import Fraction

import numpy as np
from nrs_design.controllers.sampled import SampledForce, SampledMotion
from nrs_design.controllers.step_parts import StepFrame, StepLimits

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import Admittance, ProportionalDerivative
from nrs_design.controllers.sensor import LowPass
from nrs_design.controllers.step_analysis import (
    linear_forms,
)
from nrs_design.controllers.step_law import build_mixed_law, build_placed_law, build_step_law
from nrs_design.models.linear_form import combine, coordinates, zero
from nrs_design.switched.sampled_frame import INPUTS, Frame
from tests.controllers.roundings import term_counts

ONE = Fraction(1)
E, TAU, KM = Fraction("0.9446"), Fraction("0.0351"), Fraction("4.8417e-4")


def number(rng, low, high):
    return to_float32(Fraction(rng.uniform(low, high)))


def cases(seed, count=60):
    """Yield frames, sampled laws and the operations of the same law."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        period = Fraction(int(rng.integers(1, 21)), 1000)
        method = str(rng.choice(["exact", "euler"]))
        inert, sprung = bool(rng.integers(0, 2)), bool(rng.integers(0, 2))
        order, longest = int(rng.integers(0, 3)), int(rng.integers(0, 4))
        motion = ProportionalDerivative(number(rng, 1e3, 2e5), number(rng, 1, 4e3)).sampled(period)
        laws = {
            name: Admittance(
                number(rng, 0.1, 1) if inert else Fraction(0),
                number(rng, 0.1, 5),
                number(rng, 0.1, 9) if sprung else Fraction(0),
            ).sampled(period, method)
            for name in ("insertion", "withdrawal")
        }
        low_pass = LowPass(order, number(rng, 50, 500)).sampled(period) if order else None
        frame = Frame(period, motion, inert, longest, TAU, low_pass, sprung)
        yield frame, laws, build_step_law(StepFrame(motion, low_pass), laws)


def coordinates_of(frame, delay):
    """Inputs and states of the law in the coordinates of the frame, `INPUTS` at the end."""
    size, order = len(frame.states), 0 if frame.low_pass is None else frame.low_pass.order
    unit = coordinates(size + len(INPUTS) + len(frame.roundings))
    names = [name.split(" [")[0] for name in frame.states]
    state = dict(zip(names, unit, strict=False))
    command, _, encoder, sensor, _, angle = unit[size : size + len(INPUTS)]
    k, b = Fraction(700), Fraction(3)
    felt = combine((k, state["delta"]), (b, state["omega"]), (ONE, sensor))
    samples = [felt, *(state[f"F {j} before"] for j in range(1, frame.longest_delay + 1))]
    lags = {f"filtered_{i}": state[f"filtered {i} before"] for i in range(1, order + 1)}
    return {
        "angle": combine((ONE, state["delta"]), (ONE, encoder), (ONE, angle)),
        "torque": samples[delay],
        "velocity_command": command,
        "reference": combine((ONE, state["e"]), (ONE, state["delta"])),
        "error_before": state["e before"],
        "velocity": state.get("vm", zero(len(unit[0]))),
        "commanded": zero(len(unit[0])),
        **lags,
    }


def without_roundings(frame, row):
    return list(row[: len(frame.states) + len(INPUTS)])


def test_the_map_is_that_of_the_certificate():
    """The law and the motor after it are the rows of the sampled loop, in every entry."""
    for frame, laws, law in cases(31):
        delay = frame.longest_delay
        given = coordinates_of(frame, delay)
        size, period = len(frame.states), frame.period
        unit = coordinates(len(given["angle"]))
        omega, delta = unit[1], unit[size - 1]
        friction, reference_error = unit[size + 1], unit[size + 4]
        s = TAU * (1 - E)
        for mode, admittance in enumerate(laws.values()):
            values = {"Km": KM, "E": E, "k": Fraction(700), "b": Fraction(3)}
            expected = [without_roundings(frame, r) for r in frame.rows(admittance, delay, values)]
            forms = linear_forms(law, mode, given)
            drive = combine((ONE, forms["command"]), (ONE, friction))
            moved = combine((s, omega), (KM * (period - s), drive))
            angle = combine((ONE, delta), (ONE, moved))
            reference = combine((ONE, forms["next_reference"]), (ONE, reference_error))
            found = [
                combine((ONE, reference), (-ONE, angle)),
                combine((E, omega), (KM * (1 - E), drive)),
                forms[law.following["error_before"]],
            ]
            names = ["velocity"] * frame.has_inertia
            names += [f"filtered_{i + 1}" for i in range(len(given) - 7)]
            found += [forms[law.following[name]] for name in names]
            n = len(found)
            assert [without_roundings(frame, row) for row in found] == expected[:n]
            assert without_roundings(frame, angle) == expected[size - 1]


def test_the_roundings_are_those_of_the_certificate():
    for frame, _, law in cases(32):
        counted = term_counts(law)
        # A command beside a spring is not modelled in the sampled loop.
        assert counted.pop("T v", 1) == 1
        assert counted == frame.counts


WITH_INERTIA = {"e": 1, "Kp e": 2, "D (e - e before)": 3, "a vm": 2, "b F": 3, "T (v - vm)": 2}
WITHOUT_INERTIA = {"e": 1, "Kp e": 2, "D (e - e before)": 3, "b F": 2, "T (v - vm)": 2}


def test_the_table_of_roundings():
    """The numbers that docs/certificates/rounding.md explains."""
    found = {frame.has_inertia: term_counts(law) for frame, _, law in cases(33) if plain(frame)}
    assert found == {True: WITH_INERTIA, False: WITHOUT_INERTIA}


def test_the_roundings_of_filters_and_springs():
    """Counted by hand: a lag is two products and a sum, a spring a difference, product and sum."""
    for frame, _, law in cases(34):
        counted = term_counts(law)
        order = 0 if frame.low_pass is None else frame.low_pass.order
        force = {0: {"F": 1}, 1: {"p x1": 2, "q F": 3}}.get(
            order, {"p x2": 2, "q p x1": 4, "q q F": 5}
        )
        more = frame.sprung + 1 + frame.has_inertia
        wanted = {f"b {name}": count + more for name, count in force.items()}
        wanted |= {"b Kt r": 4 + frame.has_inertia} if frame.sprung else {}
        assert {k: n for k, n in counted.items() if k.startswith("b ")} == wanted


def plain(frame):
    return frame.low_pass is None and not frame.sprung


def test_a_saturation_changes_no_map_and_no_rounding():
    frame, laws, law = next(cases(36))
    limits = StepLimits(velocity=Fraction(1, 8), command=Fraction(4000))
    limited = build_step_law(StepFrame(frame.motion, frame.low_pass, limits), laws)
    given = coordinates_of(frame, 0)
    assert (
        linear_forms(limited, 0, given)["limited_command"] == linear_forms(law, 0, given)["command"]
    )
    assert term_counts(limited) == term_counts(law)


def placed_cases(seed, count=40):
    """Yield frames of position and force control, their laws, and the same as operations."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        period = Fraction(int(rng.integers(1, 21)), 1000)
        order, longest = int(rng.integers(0, 3)), int(rng.integers(0, 4))
        motion = SampledMotion(number(rng, 1e3, 2e5), number(rng, 1e3, 1e6))
        low_pass = LowPass(order, number(rng, 50, 500)).sampled(period) if order else None
        laws = {
            "position": SampledForce(Fraction(0)),
            "force": SampledForce(number(rng, 0.001, 0.1)),
        }
        frame = Frame(
            period, motion, False, longest, TAU, low_pass, integrates=False, takes_force=True
        )
        yield frame, laws, build_placed_law(StepFrame(motion, low_pass), laws)


def test_the_map_of_force_and_position_control_is_that_of_the_certificate():
    for frame, laws, law in placed_cases(37):
        delay, size = frame.longest_delay, len(frame.states)
        unit = coordinates(size + len(INPUTS) + len(frame.roundings))
        names = [name.split(" [")[0] for name in frame.states]
        state = dict(zip(names, unit, strict=False))
        _, friction, encoder, sensor, reference, angle = unit[size : size + len(INPUTS)]
        felt = combine(
            (Fraction(700), state["delta"]), (Fraction(3), state["omega"]), (ONE, sensor)
        )
        ages = [felt, *(state[f"F {j} before"] for j in range(1, delay + 1))]
        lags = {
            f"filtered_{i + 1}": state[f"filtered {i + 1} before"]
            for i in range(len(law.states) - 1)
        }
        given = {
            "angle": combine((ONE, state["delta"]), (ONE, encoder), (ONE, angle)),
            "torque": ages[delay],
            "position": reference,
            "wanted_torque": zero(len(felt)),
            "error_before": state["e before"],
            **lags,
        }
        values = {"Km": KM, "E": E, "k": Fraction(700), "b": Fraction(3)}
        s = TAU * (1 - E)
        for mode, placed in enumerate(laws.values()):
            expected = [without_roundings(frame, r) for r in frame.rows(placed, delay, values)]
            forms = linear_forms(law, mode, given)
            drive = combine((ONE, forms["command"]), (ONE, friction))
            moved = combine((s, state["omega"]), (KM * (frame.period - s), drive))
            found = [combine((E, state["omega"]), (KM * (1 - E), drive))]
            found += [forms[law.following[name]] for name in ("error_before", *lags)]
            assert [without_roundings(frame, row) for row in found] == expected[: len(found)]
            delta = combine((ONE, state["delta"]), (ONE, moved))
            assert without_roundings(frame, delta) == expected[size - 1]


def test_how_often_the_terms_of_force_control_are_rounded():
    """The force five times, as docs/certificates/rounding.md says: with the sum with X, too.

    Besides, what is proved adds the rounding of the error to that of all of its terms.
    """
    for frame, _, law in placed_cases(38):
        angles = {"X", "theta", "Kp Fd"}
        counted = term_counts(law, 1)
        assert {*counted} - angles == {*frame.counts} - {"e"}
        assert all(counted[name] == frame.counts[name] for name in {*counted} - angles)
        assert frame.low_pass is not None or frame.counts["Kp F"] == 5
        assert (counted["X"], counted["theta"]) == (1, 1)
        # In position control there is no force.
        assert term_counts(law, 0).items() <= frame.counts.items()


def mixed_cases(seed, count=40):
    """Yield frames of all kinds of control in one, their laws, and the same as operations."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        period = Fraction(int(rng.integers(1, 21)), 1000)
        order, longest = int(rng.integers(0, 3)), int(rng.integers(0, 4))
        inert = bool(rng.integers(0, 2))
        motion = SampledMotion(number(rng, 1e3, 2e5), number(rng, 1e3, 1e6))
        low_pass = LowPass(order, number(rng, 50, 500)).sampled(period) if order else None
        admittance = Admittance(number(rng, 0.1, 1) if inert else Fraction(0), number(rng, 0.1, 5))
        laws = {
            "position": SampledForce(Fraction(0)),
            "insertion": admittance.sampled(period, "exact"),
            "force": SampledForce(number(rng, 0.001, 0.1)),
        }
        idle = number(rng, 0.5, 0.99)
        frame = Frame(period, motion, inert, longest, TAU, low_pass, takes_force=True, idle=idle)
        yield frame, laws, build_mixed_law(StepFrame(motion, low_pass), laws, idle)


def mixed_coordinates(frame):
    """Inputs and states in the coordinates of a frame; of the position its rounding alone."""
    delay, size = frame.longest_delay, len(frame.states)
    unit = coordinates(size + len(INPUTS) + len(frame.roundings))
    state = dict(zip((name.split(" [")[0] for name in frame.states), unit, strict=False))
    command, _, encoder, sensor, reference, angle = unit[size : size + len(INPUTS)]
    felt = combine((Fraction(700), state["delta"]), (Fraction(3), state["omega"]), (ONE, sensor))
    ages = [felt, *(state[f"F {j} before"] for j in range(1, delay + 1))]
    nothing = zero(len(felt))
    lags = {
        f"filtered_{i}": state[f"filtered {i} before"]
        for i in (1, 2)
        if f"filtered {i} before" in state
    }
    given = {
        "angle": combine((ONE, state["delta"]), (ONE, encoder), (ONE, angle)),
        "torque": ages[delay],
        "velocity_command": command,
        "position": reference,
        "wanted_torque": nothing,
        "offset": state["reference"],
        "error_before": state["e before"],
        "velocity": state.get("vm", nothing),
    }
    return given | lags, state, unit


def test_the_map_of_all_kinds_of_control_is_that_of_the_certificate():
    """Of the mixed law, too: what is idle decays, and what is placed starts from the position."""
    for frame, laws, law in mixed_cases(42):
        given, state, unit = mixed_coordinates(frame)
        size = len(frame.states)
        friction, reference = unit[size + 1], unit[size + 4]
        values = {"Km": KM, "E": E, "k": Fraction(700), "b": Fraction(3)}
        for mode, sampled in enumerate(laws.values()):
            moves = not isinstance(sampled, SampledForce)
            # The certificate rounds the next reference of an admittance, and not the sum with X.
            at = given | {"position": zero(len(unit[0]))} if moves else given
            forms = linear_forms(law, mode, at)
            rows = frame.rows(sampled, frame.longest_delay, values)
            expected = [without_roundings(frame, row) for row in rows]
            drive = combine((ONE, forms["command"]), (ONE, friction))
            moved = combine(
                (TAU * (1 - E), state["omega"]), (KM * (frame.period - TAU * (1 - E)), drive)
            )
            found = [
                combine((ONE, forms["next_offset"]), (Fraction(moves), reference)),
                combine((E, state["omega"]), (KM * (1 - E), drive)),
            ]
            kept = ["error_before", *["velocity"] * frame.has_inertia]
            kept += [name for name in given if name.startswith("filtered")]
            found += [forms[law.following[name]] for name in kept]
            assert [without_roundings(frame, row) for row in found] == expected[: len(found)]
            delta = combine((ONE, state["delta"]), (ONE, moved))
            assert without_roundings(frame, delta) == expected[size - 1]


def test_no_term_of_a_mixed_law_is_rounded_more_often_than_is_proved():
    """In the modes that take part in them."""
    for frame, laws, law in mixed_cases(43):
        for mode, sampled in enumerate(laws.values()):
            counted = term_counts(law, mode)
            assert counted.pop("Kp Fd", 4) == 4
            assert {counted.pop(angle, 1) for angle in ("X", "theta")} == {1}
            if isinstance(sampled, SampledForce) and frame.has_inertia:
                # The coefficient a of the velocity is d where it is idle.
                assert counted.pop("a vm") == frame.counts["d vm"]
            assert all(count <= frame.counts[name] for name, count in counted.items())
