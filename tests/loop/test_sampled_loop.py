"""The sampled loop: its modes, what is taken for granted, and how contact is lost."""

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.catalogue import catalogue_kind, omitted
from nrs_design.certificates.certificate import Verdict
from nrs_design.loop.assemble import assemble
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.runs import run_design
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certify import Limits, certify
from nrs_design.spec import read_spec
from tests.proof.graphs import shape_of
from tests.support import FORCE_LIMIT, ROOT, SOFT_TISSUE, words_of

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
    path: Path, sampling: str | None, *changes: tuple[str, str], text: str = TEXT
) -> SwitchedSystem:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = path / "sampled.nrs.yaml"
    added = "" if sampling is None else f"\nsampling: {sampling}\n"
    path.write_text(f"{text}{added}", encoding="utf-8")
    designed = run_design(read_spec(path))
    assert designed is not None
    return assemble(designed.spec, designed.plant, designed.design)


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
    assert find_contradiction(system) is None
    terms = ["e", "Kp e", "D (e - e before)", "a vm", "b F", "T (v - vm)"]
    assert [item.name for item in system.roundings] == terms
    texts = " ".join(words_of(system))
    assert "0 to 1 sample old" in texts
    assert "D (e - e before) 3" in texts
    assert "without jitter" in texts
    assert "Kd/T = 1030000" in texts
    assert "nominal-motor" in kinds_of(system)
    assert "motor" not in kinds_of(system)


def kinds_of(system):
    return {catalogue_kind(item).id for item in system.assumptions}


def test_a_tolerance_of_the_motor_gives_its_corners(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: [0, 1]}", *TOLERANCE)
    # Controllers, ages of the sample, ends of k and Km, and a triangle of E and s.
    assert len(system.modes) == 2 * 2 * 2 * 2 * 3
    assert "may change at every sample, not in between" in " ".join(words_of(system))
    assert "motor" in kinds_of(system)
    assert "nominal-motor" not in kinds_of(system)


def test_a_loop_that_is_stable_with_every_motor_is_not_refuted(tmp_path):
    """The fourth corner of the box, of no motor, has an eigenvalue of size 1.01."""
    tenth = ("0.0351 s", "{nominal: 0.0351 s, range: [0.0319 s, 0.0386 s]}")
    text = FORCE_LIMIT.read_text(encoding="utf-8")
    system = system_of(
        tmp_path,
        "{period: 20 ms, delay: 0}",
        tuple(f"time_constant: {tau}" for tau in tenth),
        text=text,
    )
    largest = max(abs(np.linalg.eigvals(mode.A.floats())).max() for mode in system.modes)
    assert largest == pytest.approx(0.93197, abs=1e-4)
    assert certify(system, limits=Limits(optimize_rate=False)).verdict is Verdict.PROVED


def test_with_a_spring_free_motion_is_a_mode_like_others(tmp_path):
    sprung = (BT, "Kt: 0.5 N*m/rad\n    " + BT)
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}\ncontact: losable", sprung)
    assert system.contact is None
    assert sum("/free/" in mode.name for mode in system.modes) == 4
    assert "at any moment" in " ".join(words_of(system))
    kept = system_of(tmp_path, "{period: 2 ms, delay: 0}", sprung)
    assert "before the reference moves on" in " ".join(words_of(kept))
    assert not any("free" in mode.name for mode in kept.modes)


BT = "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad"


DAMPED = (
    "model: elastic",
    "model: kelvin-voigt\n    damping: {nominal: 1 N*s/m, range: [0 N*s/m, 3 N*s/m]}",
)


ONCE = (
    ("environment: soft\n", "environment: soft\n    contacts: [[soft, other]]\n"),
    (
        "environments:\n",
        "environments:\n  other:\n    model: kelvin-voigt\n    damping: 1 N*s/m\n"
        "    stiffness: 100 N/m\n    lever_arm: 0.24 m\n",
    ),
)
DOUBTFUL = (
    (
        "time_constant: 0.0351 s",
        'time_constant: 0.0351 s\n  doubts: ["dead time"]\n  accept_doubt: it is short',
    ),
    ("    model: elastic", "    model: elastic\n    linearized_about: 2 mm"),
)


@pytest.mark.parametrize(
    ("contact", "changes", "kept", "said"),
    [
        ("", (), False, "all modes in contact then rest at one point"),
        ("\ncontact: kept", (), True, "Contact is not lost"),
        ("\ncontact: kept", (), True, "all modes then rest at one point"),
        ("", (DAMPED, *ONCE), True, "touched at once with others"),
        ("", DOUBTFUL, False, "actuator is in doubt: dead time; accepted because: it is short"),
        ("", DOUBTFUL, False, "soft is the linearization about 2 mm"),
    ],
)
def test_whether_contact_is_lost_and_what_is_taken_for_granted(
    tmp_path, contact, changes, kept, said
):
    system = system_of(tmp_path, f"{{period: 2 ms, delay: 0}}{contact}", *changes)
    assert (system.contact is None) == kept
    assert said in " ".join(words_of(system))


DAMPED_TOOL = "  tool: {model: kelvin-voigt, stiffness: 5 N*m/rad, damping: 0.3 N*m*s/rad}\n"
DRIVE = "  drive: {type: impedance, environment: tool, Mt: 0.01 kg*m^2, Bt: 2.15 N*m*s/rad}\n"


def test_a_damped_environment_lags_instead_of_pulling(tmp_path):
    """Four forces, at the ends of k and b; in the air, and while it lags, no force is sampled."""
    system = system_of(tmp_path, "{period: 2 ms, delay: 1}", DAMPED)
    assert find_contradiction(system) is None
    assert len(system.contact.pulls) == 4
    speed, last = system.states.index("omega [rad/s]"), system.order - 1
    corners = set()
    for q in system.contact.pulls:
        (row,) = q.fractions()
        assert {i for i, entry in enumerate(row) if entry} <= {speed, last}
        corners.add((float(row[last]), float(row[speed])))
    arm = 0.24**2
    k, b = (720.56 * arm, 768.17 * arm), (0.0, 3 * arm)
    assert np.array(sorted(corners)) == pytest.approx(np.array([(x, y) for x in k for y in b]))
    sample = system.states.index("F 1 before [N*m]")
    assert all(not any(mode.A.numerators[sample]) for mode in system.contact.free)
    assert "would have to pull" in system.contact.loss
    assert system.contact.loss not in system.assumptions


def test_beside_what_is_damped_a_spring_still_pushes(tmp_path):
    """What flies at a positive deflection because a damped force would pull is not in a spring."""
    both = (
        ("environments:\n", f"environments:\n{DAMPED_TOOL}"),
        ("controllers:\n", f"controllers:\n{DRIVE}"),
    )
    for sampling in ("{period: 2 ms, delay: 0}", None):
        system = system_of(tmp_path, sampling, *both)
        assert find_contradiction(system) is None
        forces = [row for q in system.contact.pulls for row in q.fractions()]
        springs = [row for row in forces if not any(row[:-1]) and row[-1] > 0]
        assert len(springs) == 2
        assert len(forces) == 3


def test_a_faster_outer_loop_holds_the_command(tmp_path):
    sampling = "{period: 2 ms, outer_period: 0.1 ms, delay: [0, 1]}"
    system = system_of(tmp_path, sampling)
    assert find_contradiction(system) is None
    assert system.sample_time == Fraction(1, 10_000)
    assert "u held" in system.states
    assert system.clock.length == 20
    first = {name for name in system.clock.first if "free" not in name}
    # Two controllers, two delays, two ends of k, two bounds on exp(-h/tau), in and between rounds.
    assert (len(first), len(system.modes), len(system.contact.free)) == (16, 32, 16)
    held = system.states.index("u held")
    for mode in (*system.modes, *system.contact.free):
        row = mode.A.fractions()[held]
        keeps = [Fraction(int(i == held)) for i in range(system.order)]
        assert (
            (row == keeps) == ("admittance" in mode.name) == (mode.name not in system.clock.first)
        )
    texts = " ".join(words_of(system))
    assert "The motion loop runs every 0.002 s" in texts
    assert "the admittance runs every 0.0001 s" in texts
    assert "counted in samples of the admittance" in texts
    # The law is discretized with the period that it runs with.
    assert "Kd/T = 1030000" in texts
    T = Fraction(float(np.float32(1e-4)))
    command = system.states.index("vm [rad/s]")
    assert {mode.A.fractions()[0][command] for mode in system.modes} == {-T}


def test_a_slower_outer_loop_holds_the_reference(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, outer_period: 6 ms, delay: 1}", DAMPED)
    assert find_contradiction(system) is None
    assert (system.clock.length, system.sample_time) == (3, Fraction(1, 500))
    assert "u held" not in system.states
    between = [m for m in system.modes if m.name not in system.clock.first]
    assert [m.name for m in between] == ["motion/flow-0", "motion/flow-1"]
    free = [m.name for m in system.contact.free if m.name not in system.clock.first]
    assert free == ["motion/free/flow-0", "motion/free/flow-1"]
    n = system.order
    for mode in between:
        A = mode.A.fractions()
        for state in ("vm [rad/s]", "F 1 before [N*m]"):
            i = system.states.index(state)
            assert A[i] == [Fraction(int(i == j)) for j in range(n)]
        # The reference, e + delta, stays.
        assert [a + b for a, b in zip(A[0], A[-1], strict=True)] == [1, *[0] * (n - 2), 1]


def test_with_a_spring_free_motion_takes_its_turns(tmp_path):
    sprung = (BT, "Kt: 0.5 N*m/rad\n    " + BT)
    sampling = "{period: 2 ms, outer_period: 1 ms, delay: 0}\ncontact: losable"
    system = system_of(tmp_path, sampling, sprung)
    assert system.contact is None
    assert find_contradiction(system) is None
    assert sum("/free/" in name for name in system.clock.first) == 4


def test_one_period_written_twice_is_one_and_a_latency_of_nothing_is_none(tmp_path):
    once = system_of(tmp_path, "{period: 2 ms, delay: 1}")
    assert system_of(tmp_path, "{period: 2 ms, outer_period: 2 ms, delay: 1}") == once
    late = system_of(tmp_path, "{period: 2 ms, delay: 1, latency: 0 s}")
    assert (late.modes, late.states) == (once.modes, once.states)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sampling", "verdict", "least"),
    [
        ("{period: 2 ms, outer_period: 0.1 ms, delay: 0}", Verdict.PROVED, "1"),
        ("{period: 2 ms, outer_period: 4 ms, delay: 0}", Verdict.PROVED, "0.7"),
        ("{period: 2 ms, outer_period: 10 ms, delay: 3}", Verdict.REFUTED, None),
    ],
)
def test_two_periods_of_the_thesis_robot(tmp_path, sampling, verdict, least):
    """Insertion and withdrawal in soft tissue, switched at will, contact losable."""
    system = system_of(tmp_path, sampling)
    result = certify(system, limits=Limits(optimize_rate=False))
    assert result.verdict is verdict
    evidence = result.evidence
    assert evidence.find_fault(system) is None
    if least is None:
        assert evidence.kind == "growing-sequence"
    else:
        assert shape_of(evidence) == "periodic-quadratic"
        assert (1 - evidence.rate) / system.sample_time > Fraction(least)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("nominal", "ends", "delay", "least"), [("1", ("0", "3"), 0, "2.2"), ("5", ("5", "9"), 1, "1")]
)
def test_damped_contact_that_is_lost_is_proved(tmp_path, nominal, ends, delay, least):
    ranged = f"[{ends[0]} N*s/m, {ends[1]} N*s/m]"
    damping = f"{{nominal: {nominal} N*s/m, range: {ranged}}}"
    changed = DAMPED[0], f"model: kelvin-voigt\n    damping: {damping}"
    system = system_of(tmp_path, f"{{period: 2 ms, delay: {delay}}}\ncontact: losable", changed)
    result = certify(system, limits=Limits(optimize_rate=delay == 0))
    assert result.verdict is Verdict.PROVED
    assert result.evidence.covers_rounding
    assert (1 - result.evidence.rate) / system.sample_time > Fraction(least)


FORCE = FORCE_LIMIT.read_text(encoding="utf-8")
MIXED = (ROOT / "docs/examples/mixed-controllers.nrs.yaml").read_text(encoding="utf-8")


def test_position_and_force_control_share_the_motion(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: [0, 1]}", text=FORCE)
    assert system.states == ("omega [rad/s]", "e before [rad]", "F 1 before [N*m]", "delta [rad]")
    # Two ends of exp(-T/tau); in contact two ends of k, for force control two delays besides.
    assert len(system.modes) == 2 + 4 + 8
    assert system.contact is None
    assert find_contradiction(system) is None
    texts = " ".join(words_of(system))
    assert "Contact is not lost while force is controlled" in texts
    assert "set the reference before the error is formed" in texts
    assert "Kp of force = 0.0199999995529651641845703125" in texts
    assert "Kp F 5" in texts


def test_what_position_control_touches_is_sampled(tmp_path):
    """With the sample of the moment nobody uses it; an older one acts after a switch to force."""
    system = system_of(tmp_path, "{period: 2 ms, delay: 1}", text=FORCE)
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    touching, free = modes["position/soft/k-max/flow-0"], modes["position/flow-0"]
    assert [row for i, row in enumerate(touching) if i != 2] == [
        row for i, row in enumerate(free) if i != 2
    ]
    assert free[2] == [0] * 4
    assert touching[2] == [0, 0, 0, Fraction("768.17") * Fraction("0.24") ** 2]
    assert "anything that other controllers touch may be touched" in " ".join(words_of(system))
    at_once = system_of(tmp_path, "{period: 2 ms, delay: 0}", text=FORCE)
    assert [m.name for m in at_once.modes if "position" in m.name] == [
        "position/flow-0",
        "position/flow-1",
    ]


def test_contact_lost_under_force_control_is_a_mode_without_force(tmp_path):
    """What unilateral contact does to the sample, max(0, k delta), lies between the two."""
    losable = FORCE.replace("contact: kept", "contact: losable")
    system = system_of(tmp_path, "{period: 2 ms, delay: [0, 1]}", text=losable)
    assert system.contact is None
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    free = {name for name in modes if name.startswith("force/free/")}
    assert len(free) == 4
    assert len(modes) == 2 + 4 + 8 + 4
    # With the sample of the moment, it is position control; with an older one, that still acts.
    assert modes["force/free/delay-0/flow-0"] == modes["position/flow-0"]
    late, pushed = modes["force/free/delay-1/flow-0"], modes["position/flow-0"]
    assert [row[2] for row in late] != [row[2] for row in pushed]
    assert [row[:2] + row[3:] for row in late] == [row[:2] + row[3:] for row in pushed]
    texts = " ".join(words_of(system))
    assert "free motion, in which a force sample is zero" in texts
    assert "environment would pull" not in texts
    found = certify(system)
    assert found.verdict is Verdict.PROVED
    assert found.evidence.covers_rounding


def test_an_admittance_beside_others_leaves_its_states_idle(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}", text=MIXED)
    assert system.states[0] == "reference [rad]"
    assert not system.switching.resets
    idle = next(mode for mode in system.modes if mode.name.startswith("approach")).A.fractions()
    left = Fraction(np.float32(np.exp(-20 * 0.002)).item())
    assert idle[0] == [left, *[0] * (system.order - 1)]
    assert idle[3][3] == left
    assert all(row[0] == 0 == row[3] for i, row in enumerate(idle) if i not in (0, 3))
    assert "a sample leaves d = 0.96078944" in " ".join(words_of(system))


def test_a_reset_zeroes_what_an_admittance_leaves(tmp_path):
    reset = ("{decay: 20 1/s}", "{decay: 20 1/s, reset: true}")
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}", reset, text=MIXED)
    pairs = {(r.source.split("/")[0], r.target.split("/")[0]) for r in system.switching.resets}
    assert pairs == {("insertion", "approach"), ("insertion", "hold")}
    for item in system.switching.resets:
        kept = [[Fraction(int(i == j not in (0, 3))) for j in range(5)] for i in range(5)]
        assert item.map.fractions() == kept
    assert "they are set to zero first" in " ".join(words_of(system))


def radius(system, wanted="insertion"):
    """Return the largest eigenvalue of the modes of one controller, by size."""
    modes = [mode for mode in system.modes if mode.name.startswith(wanted)]
    return max(abs(np.linalg.eigvals(mode.A.floats())).max() for mode in modes)


@pytest.mark.parametrize("late", ["1 ms", "0.3 ms", "2 ms", "2.7 ms", "5 ms"])
def test_a_constant_latency_has_the_roots_of_the_split_period(tmp_path, late):
    """Each part of a period by its own exponential, in floating point and by hand."""
    system = system_of(tmp_path, f"{{period: 2 ms, delay: 0, latency: {late}}}")
    T, tau, Km, k = 0.002, 0.0351, 4.8417e-4, 768.17 * 0.24**2
    L = float(late.split()[0]) / 1000
    whole, part = divmod(L, T)
    whole = round(whole)
    A = np.array([[-1 / tau, 0.0], [1.0, 0.0]])

    def over(time):
        block = np.zeros((3, 3))
        block[:2, :2], block[0, 2] = A * time, Km / tau * time
        made = expm(block)
        return made[:2, :2], made[:2, 2]

    (F1, G1), (F2, G2) = over(part), over(T - part)
    mode = next(mode for mode in system.modes if "insertion/soft/k-max" in mode.name)
    numbers = {
        name: float(value)
        for text in [" ".join(words_of(system))]
        for name, value in re.findall(r"(Kp|Kd/T|\w of insertion) = ([0-9.]+[0-9])", text)
    }
    a, b, step = (numbers[f"{name} of insertion"] for name in "abT")
    # State: reference, speed, angle, error before, velocity, commands before.
    n, memory = 5 + whole + 1, 5
    M = np.zeros((n, n))
    Kp, D = numbers["Kp"], numbers["Kd/T"]
    command = np.zeros(n)
    command[[0, 2, 3]] = Kp + D, -(Kp + D), -D
    older, newer = memory + whole, memory + whole - 1
    into = np.zeros((2, n))
    into[:, 1:3] = F2 @ F1
    into += np.outer(F2 @ G1, np.eye(n)[older])
    into += np.outer(G2, command if whole == 0 else np.eye(n)[newer])
    M[1:3] = into
    M[0, 0], M[0, 4] = 1, -step
    M[3, 0], M[3, 2] = 1, -1
    M[4, 4], M[4, 2] = a, b * k
    M[memory] = command
    for j in range(whole):
        M[memory + 1 + j, memory + j] = 1
    wanted = abs(np.linalg.eigvals(M)).max()
    assert abs(np.linalg.eigvals(mode.A.floats())).max() == pytest.approx(wanted, abs=1e-9)


STREAMED = (ROOT / "docs/examples/ur-like.nrs.yaml").read_text(encoding="utf-8")
SAMPLING = "{period: 2 ms, delay: 1, latency: 1 ms}"


def streamed(path, sampling, *changes):
    plain = (("[3 ms, 4 ms]", "3 ms"), ("{nominal: 0.03 s, range: [0.027 s, 0.033 s]}", "0.03 s"))
    text = STREAMED.replace(f"sampling: {SAMPLING}\n", "")
    assert text != STREAMED
    return system_of(path, sampling, *plain, *changes, text=text)


def numbers_of(system, controller, names):
    said = " ".join(words_of(system))
    return [float(re.search(rf"{n} of {controller} = ([0-9.]+[0-9])", said)[1]) for n in names]


@pytest.mark.parametrize("sampling", ["{period: 2 ms, delay: 0}", SAMPLING])
@pytest.mark.parametrize("Mt", ["0.01", "0"])
def test_a_streamed_velocity_has_the_roots_of_its_lag(tmp_path, sampling, Mt):
    """The velocity of after the sample is the command; the rest is by exponentials and by hand."""
    system = streamed(tmp_path, sampling, ("0.01 kg*m^2", f"{Mt} kg*m^2"))
    T, tau, k = 0.002, 0.03, 780 * 0.24**2
    late = 0.003 + (0.001 if "latency" in sampling else 0.0)
    whole, part = (round(late // T), late % T)
    old = int("delay: 1" in sampling)
    A = np.array([[-1 / tau, 0.0], [1.0, 0.0]])

    def over(time):
        block = np.zeros((3, 3))
        block[:2, :2], block[0, 2] = A * time, time / tau
        made = expm(block)
        return made[:2, :2], made[:2, 2]

    (F1, G1), (F2, G2) = over(part), over(T - part)
    a, b = (
        numbers_of(system, "firm", "ab") if Mt != "0" else (0.0, *numbers_of(system, "firm", "b"))
    )
    # State: speed, angle, velocity of the admittance, force before, commands before.
    n = 4 + whole + 1
    M, unit = np.zeros((n, n)), np.eye(n)
    force = unit[3] if old else k * unit[1]
    velocity = a * unit[2] + b * force
    M[2], M[3], M[4] = velocity, k * unit[1], -velocity
    for j in range(whole):
        M[5 + j, 4 + j] = 1
    older, newer = unit[4 + whole], unit[3 + whole] if whole else -velocity
    if not part:
        older = newer
    M[:2, :2] = F2 @ F1
    M[:2] += np.outer(F2 @ G1, older) + np.outer(G2, newer)
    wanted = abs(np.linalg.eigvals(M)).max()
    assert radius(system, "firm/tissue/k-max") == pytest.approx(wanted, abs=1e-9)
    assert system.states[0] == "omega [rad/s]"
    assert "e [rad]" not in system.states


def test_a_robot_that_closes_the_loop_of_the_thesis_has_its_modes(tmp_path):
    """G given as a velocity_interface, or as the transfer function of the motion loop."""
    G = "transfer_function: {numerator: [28.4, 1619], denominator: [1, 57, 1619]}"
    text = STREAMED.replace("sampling: {period: 2 ms, delay: 1, latency: 1 ms}\n", "")
    head, _, rest = text.partition("velocity_interface:\n")
    rest = rest.partition("\n\n")[2]
    stated = (
        "actuator: {gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}\n"
        f"motion_loop: {{damping_ratio: 0.707, settling_time: 0.1404 s, {G}}}\n"
    )
    systems = []
    for drive in (f"velocity_interface: {{{G}}}\n", f"position_interface: {{{G}}}\n", stated):
        path = tmp_path / "one.nrs.yaml"
        path.write_text(f"{head}{drive}{rest}", encoding="utf-8")
        loaded = read_spec(path)
        systems.append(assemble_spec(loaded, run_design(loaded)))
    assert systems[0].modes == systems[1].modes == systems[2].modes


TWO_TISSUES = """\
kind: interaction-design
name: two-tissues
title: Torques, and two tissues in turn
torque_interface: {inertia: 0.2 kg*m^2, friction: 0.5 N*m*s/rad}
limits: {velocity: 8 deg/s, torque: 3 N*m, bandwidth: 2 Hz}
environments:
  soft: {model: elastic, stiffness: 10 N*m/rad}
  hard: {model: elastic, stiffness: 60 N*m/rad}
controllers:
  heavy: {type: torque-impedance, environment: soft, contacts: [soft, hard], stiffness: 20 N*m/rad,
          damping: 6 N*m*s/rad, inertia_ratio: 3}
switching: arbitrary
contact: kept"""


def test_another_tissue_may_be_touched_within_a_period(tmp_path):
    """The hard one at every sample, the soft one after it: what is taken off F is too much.

    By hand, every period ``J omega' = K/R e + D/(R T) (e - e before) + (1 - 1/R) 60 delta - 10
    delta - B omega``.
    """
    J, B, K, D, R, step = 0.2, 0.5, 20.0, 6.0, 3.0, 1e-3
    G = np.array([[0, 1, 0], [-10 / J, -B / J, 1 / J], [0, 0, 0]])
    E = expm(G * step)
    u = np.array([-K / R - D / (R * step) + (1 - 1 / R) * 60, 0, -D / (R * step)])
    own = np.array([*(E[:2, :2] @ np.eye(2, 3) + np.outer(E[:2, 2], u)), [-1, 0, 0]])
    grows = abs(np.linalg.eigvals(own)).max()
    assert grows > 1.006
    system = system_of(tmp_path, "{period: 1 ms, delay: 0}", text=TWO_TISSUES)
    worst = max(radius(system, mode.name) for mode in system.modes)
    assert 0 <= worst - grows < 5e-4


def test_contact_comes_within_a_period_of_a_controller_that_names_none(tmp_path):
    """A motor with a load feels any share of it, from nothing on."""
    load = TOLERANCE[1][0], f"{TOLERANCE[1][0]}\n  load_inertia: 0.02 kg*m^2"
    text = FORCE_LIMIT.read_text(encoding="utf-8")
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}", load, text=text)
    i, j = (system.states.index(name) for name in ("omega [rad/s]", "delta [rad]"))
    own = [(m.name, m.A.floats()[i][j]) for m in system.modes if m.name.startswith("position/")]
    touched, air = ([v for n, v in own if ("/soft" in n) is soft] for soft in (True, False))
    assert min(touched) < min(air) <= max(touched)


@pytest.mark.parametrize(
    ("contact", "kept"), [("contact: kept", True), ("", True), ("contact: losable", False)]
)
def test_torques_that_take_contact_for_granted_say_so(tmp_path, contact, kept):
    text = TWO_TISSUES.replace("contact: kept", contact)
    system = system_of(tmp_path, "{period: 1 ms, delay: 0}", text=text)
    assert ("loss of contact" in omitted(system.assumptions)) is kept


@pytest.mark.parametrize(
    ("drive", "tissue", "bounded"),
    [
        ("position_interface: {time_constant: 0.5 ms}", "elastic", ["force"]),
        ("position_interface: {time_constant: 0.5 ms}", "kelvin-voigt", []),
        ("velocity_interface: {time_constant: 0.5 ms}", "kelvin-voigt", ["force", "velocity"]),
    ],
)
def test_no_bound_on_a_velocity_that_jumps_after_the_sample(tmp_path, drive, tissue, bounded):
    """At a sample it has decayed to exp(-4) of what it was: no such bound is about the robot."""
    damping = ", damping: 1 N*m*s/rad" if tissue == "kelvin-voigt" else ""
    text = (
        f"kind: interaction-design\nname: jumps\ntitle: A fast robot\n{drive}\n"
        "limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}\nenvironments:\n"
        f"  tissue: {{model: {tissue}, stiffness: 5 N*m/rad{damping}}}\ncontrollers:\n"
        "  firm: {type: impedance, environment: tissue, Mt: 0.02 kg*m^2, Bt: 2 N*m*s/rad}\n"
        "disturbances: {command: 8 deg/s}\nswitching: arbitrary\ncontact: kept"
    )
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}", text=text)
    assert [output.name for output in system.outputs] == bounded
