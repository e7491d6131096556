"""The sampled loop: its modes, what is taken for granted, and how contact is lost.

That a period is what the pages say is asked in tests/oracle.
"""

from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.catalogue import catalogue_kind, omitted, sentence
from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.mode import Time
from nrs_design.search.certify import Limits, certify
from tests.loop.support import assembled, sampled
from tests.proof.graphs import shape_of
from tests.support import FORCE_LIMIT, ROOT, SOFT_TISSUE
from tests.tables import by_rows, entry, spec_text

SAMPLED = "{period: 2 ms, delay: 0}"
OLDER = "{period: 2 ms, delay: [0, 1]}"
TOLERANCE = entry(__file__, "tolerance")
BT = "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad"
SPRUNG = (BT, f"Kt: 0.5 N*m/rad\n    {BT}")


def test_modes_and_states_of_the_thesis_robot():
    system = sampled(OLDER)
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
    assert "nominal-motor" in kinds_of(system)
    assert "motor" not in kinds_of(system)


def kinds_of(system):
    return {catalogue_kind(item).id for item in system.assumptions}


def test_a_tolerance_of_the_motor_gives_its_corners():
    system = sampled(OLDER, *TOLERANCE)
    # Controllers, ages of the sample, ends of k and Km, and a triangle of E and s.
    assert len(system.modes) == 2 * 2 * 2 * 2 * 3
    assert "motor" in kinds_of(system)
    assert "nominal-motor" not in kinds_of(system)


def test_a_loop_that_is_stable_with_every_motor_is_not_refuted():
    """The fourth corner of the box, of no motor, has an eigenvalue of size 1.01."""
    wide = "0.0351 s", "{nominal: 0.0351 s, range: [0.0319 s, 0.0386 s]}"
    system = sampled("{period: 20 ms, delay: 0}", wide, text=FORCE_LIMIT)
    largest = max(abs(np.linalg.eigvals(mode.A.floats())).max() for mode in system.modes)
    assert largest == pytest.approx(0.93227, abs=1e-4)
    assert certify(system, limits=Limits(optimize_rate=False)).verdict is Verdict.PROVED


def test_with_a_spring_free_motion_is_a_mode_like_others():
    system = sampled(f"{SAMPLED}\ncontact: losable", SPRUNG)
    assert sum("/free/" in mode.name for mode in system.modes) == 4
    assert not any("free" in mode.name for mode in sampled(SAMPLED, SPRUNG).modes)


DAMPED = (
    "model: elastic",
    "model: kelvin-voigt\n    damping: {nominal: 1 N*s/m, range: [0 N*s/m, 3 N*s/m]}",
)


DAMPED_TOOL = "  tool: {model: kelvin-voigt, stiffness: 5 N*m/rad, damping: 0.3 N*m*s/rad}\n"
DRIVE = "  drive: {type: impedance, environment: tool, Mt: 0.01 kg*m^2, Bt: 2.15 N*m*s/rad}\n"


def test_a_damped_environment_lags_instead_of_pulling():
    """Four forces, at the ends of k and b; in the air, and while it lags, no force is sampled."""
    system = sampled("{period: 2 ms, delay: 1}", DAMPED)
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
    assert "would have to pull" in sentence(system.contact.loss)
    assert system.contact.loss not in system.assumptions


def test_beside_what_is_damped_a_spring_still_pushes():
    """What flies at a positive deflection because a damped force would pull is not in a spring."""
    both = (
        ("environments:\n", f"environments:\n{DAMPED_TOOL}"),
        ("controllers:\n", f"controllers:\n{DRIVE}"),
    )
    for system in (sampled(SAMPLED, *both), assembled(SOFT_TISSUE, *both)):
        assert find_contradiction(system) is None
        forces = [row for q in system.contact.pulls for row in q.fractions()]
        springs = [row for row in forces if not any(row[:-1]) and row[-1] > 0]
        assert len(springs) == 2
        assert len(forces) == 3


def test_a_faster_outer_loop_holds_the_command():
    sampling = "{period: 2 ms, outer_period: 0.1 ms, delay: [0, 1]}"
    system = sampled(sampling)
    assert find_contradiction(system) is None
    assert system.sample_time == Fraction(1, 10_000)
    assert "u held" in system.states
    assert system.clock.length == 20
    first = {name for name in system.clock.first if "free" not in name}
    # Two controllers, two delays, two ends of k, two bounds on exp(-h/tau), in and between rounds.
    assert (len(first), len(system.modes), len(system.contact.free)) == (16, 32, 16)


def test_a_slower_outer_loop_holds_the_reference():
    system = sampled("{period: 2 ms, outer_period: 6 ms, delay: 1}", DAMPED)
    assert find_contradiction(system) is None
    assert (system.clock.length, system.sample_time) == (3, Fraction(1, 500))
    assert "u held" not in system.states
    between = [m for m in system.modes if m.name not in system.clock.first]
    assert [m.name for m in between] == ["motion/flow-0", "motion/flow-1"]
    free = [m.name for m in system.contact.free if m.name not in system.clock.first]
    assert free == ["motion/free/flow-0", "motion/free/flow-1"]


def test_with_a_spring_free_motion_takes_its_turns():
    sampling = "{period: 2 ms, outer_period: 1 ms, delay: 0}\ncontact: losable"
    system = sampled(sampling, SPRUNG)
    assert system.contact is None
    assert find_contradiction(system) is None
    assert sum("/free/" in name for name in system.clock.first) == 4


def test_one_period_written_twice_is_one_and_a_latency_of_nothing_is_none():
    once = sampled("{period: 2 ms, delay: 1}")
    assert sampled("{period: 2 ms, outer_period: 2 ms, delay: 1}") == once
    late = sampled("{period: 2 ms, delay: 1, latency: 0 s}")
    assert (late.modes, late.states) == (once.modes, once.states)


@pytest.mark.slow
@by_rows("sampling", "verdict", "least", verdict=Verdict)
def test_two_periods_of_the_thesis_robot(sampling, verdict, least):
    """Insertion and withdrawal in soft tissue, switched at will, contact losable."""
    system = sampled(sampling)
    result = certify(system)
    assert result.verdict is verdict
    evidence = result.evidence
    assert evidence.find_fault(system) is None
    if least is None:
        assert evidence.kind == "growing-sequence"
    else:
        assert shape_of(evidence) == "periodic-quadratic"
        assert (1 - evidence.rate) / system.sample_time > Fraction(least)


@pytest.mark.slow
@pytest.mark.parametrize(("nominal", "ends", "delay"), [("1", ("0", "3"), 0), ("5", ("5", "9"), 1)])
def test_damped_contact_that_is_lost_is_proved(nominal, ends, delay):
    ranged = f"[{ends[0]} N*s/m, {ends[1]} N*s/m]"
    damping = f"{{nominal: {nominal} N*s/m, range: {ranged}}}"
    changed = DAMPED[0], f"model: kelvin-voigt\n    damping: {damping}"
    system = sampled(f"{{period: 2 ms, delay: {delay}}}\ncontact: losable", changed)
    result = certify(system)
    assert result.verdict is Verdict.PROVED
    assert result.evidence.covers_rounding
    assert (1 - result.evidence.rate) / system.sample_time > Fraction("2.2")


MIXED = ROOT / "docs/examples/mixed-controllers.nrs.yaml"


def test_position_and_force_control_share_the_motion():
    system = sampled(OLDER, text=FORCE_LIMIT)
    assert system.states == ("omega [rad/s]", "e before [rad]", "F 1 before [N*m]", "delta [rad]")
    # Two ends of exp(-T/tau); in contact two ends of k, for force control two delays besides.
    assert len(system.modes) == 2 + 4 + 8
    assert find_contradiction(system) is None


def test_what_position_control_touches_is_sampled():
    """With the sample of the moment nobody uses it; an older one acts after a switch to force."""
    system = sampled("{period: 2 ms, delay: 1}", text=FORCE_LIMIT)
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    touching, free = modes["position/soft/k-max/flow-0"], modes["position/flow-0"]
    assert [row for i, row in enumerate(touching) if i != 2] == [
        row for i, row in enumerate(free) if i != 2
    ]
    assert free[2] == [0] * 4
    assert touching[2] == [0, 0, 0, Fraction("768.17") * Fraction("0.24") ** 2]
    at_once = sampled(SAMPLED, text=FORCE_LIMIT)
    assert [m.name for m in at_once.modes if "position" in m.name] == [
        "position/flow-0",
        "position/flow-1",
    ]


def test_contact_lost_under_force_control_is_a_mode_without_force():
    """What unilateral contact does to the sample, max(0, k delta), lies between the two."""
    losable = "contact: kept", "contact: losable"
    system = sampled(OLDER, losable, text=FORCE_LIMIT)
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    free = {name for name in modes if name.startswith("force/free/")}
    assert len(free) == 4
    assert len(modes) == 2 + 4 + 8 + 4
    # With the sample of the moment, it is position control; with an older one, that still acts.
    assert modes["force/free/delay-0/flow-0"] == modes["position/flow-0"]
    late, pushed = modes["force/free/delay-1/flow-0"], modes["position/flow-0"]
    assert [row[2] for row in late] != [row[2] for row in pushed]
    assert [row[:2] + row[3:] for row in late] == [row[:2] + row[3:] for row in pushed]
    found = certify(system)
    assert found.verdict is Verdict.PROVED
    assert found.evidence.covers_rounding


def test_a_reset_zeroes_what_an_admittance_leaves():
    """They are idle while others are in force, and the reference is one of them."""
    assert not sampled(SAMPLED, text=MIXED).switching.resets
    reset = ("{decay: 20 1/s}", "{decay: 20 1/s, reset: true}")
    system = sampled(SAMPLED, reset, text=MIXED)
    assert (system.states[0], system.states[3]) == ("reference [rad]", "vm [rad/s]")
    pairs = {(r.source.split("/")[0], r.target.split("/")[0]) for r in system.switching.resets}
    assert pairs == {("insertion", "approach"), ("insertion", "hold")}
    for item in system.switching.resets:
        kept = [[Fraction(int(i == j not in (0, 3))) for j in range(5)] for i in range(5)]
        assert item.map.fractions() == kept


STREAMED = ROOT / "docs/examples/ur-like.nrs.yaml"


def test_a_robot_that_closes_the_loop_of_the_thesis_has_its_modes():
    """G given as a velocity_interface, or as the transfer function of the motion loop."""
    G = "transfer_function: {numerator: [28.4, 1619], denominator: [1, 57, 1619]}"
    head, _, rest = STREAMED.read_text(encoding="utf-8").partition("velocity_interface:\n")
    rest = rest.partition("\n\n")[2].partition("sampling:")[0]
    stated = (
        "actuator: {gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}\n"
        f"motion_loop: {{damping_ratio: 0.707, settling_time: 0.1404 s, {G}}}\n"
    )
    drives = (f"velocity_interface: {{{G}}}\n", f"position_interface: {{{G}}}\n", stated)
    one, *others = (assembled(head + drive + rest).modes for drive in drives)
    assert others == [one, one]


TWO_TISSUES = spec_text("two-tissues")


def test_another_tissue_may_be_touched_within_a_period():
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
    system = sampled("{period: 1 ms, delay: 0}", text=TWO_TISSUES)
    worst = max(abs(np.linalg.eigvals(mode.A.floats())).max() for mode in system.modes)
    assert 0 <= worst - grows < 5e-4


def test_contact_comes_within_a_period_of_a_controller_that_names_none():
    """A motor with a load feels any share of it, from nothing on."""
    load = TOLERANCE[1][0], f"{TOLERANCE[1][0]}\n  load_inertia: 0.02 kg*m^2"
    system = sampled(SAMPLED, load, text=FORCE_LIMIT)
    i, j = (system.states.index(name) for name in ("omega [rad/s]", "delta [rad]"))
    own = [(m.name, m.A.floats()[i][j]) for m in system.modes if m.name.startswith("position/")]
    touched, air = ([v for n, v in own if ("/soft" in n) is soft] for soft in (True, False))
    assert min(touched) < min(air) <= max(touched)


@pytest.mark.parametrize(
    ("contact", "kept"), [("contact: kept", True), ("", True), ("contact: losable", False)]
)
def test_torques_that_take_contact_for_granted_say_so(contact, kept):
    system = sampled("{period: 1 ms, delay: 0}", ("contact: kept", contact), text=TWO_TISSUES)
    assert ("loss of contact" in omitted(system.assumptions)) is kept


@by_rows("drive", "tissue", "bounded")
def test_no_bound_on_a_velocity_that_jumps_after_the_sample(drive, tissue, bounded):
    """At a sample it has decayed to exp(-4) of what it was: no such bound is about the robot."""
    damping = ", damping: 1 N*m*s/rad" if tissue == "kelvin-voigt" else ""
    text = (
        f"kind: interaction-design\nname: jumps\ntitle: A fast robot\n{drive}\n"
        "limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}\nenvironments:\n"
        f"  tissue: {{model: {tissue}, stiffness: 5 N*m/rad{damping}}}\ncontrollers:\n"
        "  firm: {type: impedance, environment: tissue, Mt: 0.02 kg*m^2, Bt: 2 N*m*s/rad}\n"
        "disturbances: {command: 8 deg/s}\nswitching: arbitrary\ncontact: kept"
    )
    system = sampled(SAMPLED, text=text)
    assert [output.name for output in system.outputs] == bounded
