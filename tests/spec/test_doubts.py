"""Specs that are valid and probably not meant."""

from nrs_design.spec import doubt_spec, parse_spec
from tests.spec.samples import FORCE, IMPEDANCE, SWITCHED, spoiled


def doubts(text):
    return list(doubt_spec(parse_spec(text)))


def test_an_environment_that_no_controller_touches():
    """Those of a contact are touched; given matrices have none."""
    for sample in (IMPEDANCE, FORCE):
        (doubt,) = doubts(sample)
        assert doubt.at == ("environments", "hand")
        assert "environment hand is touched by no controller" in str(doubt)
    text = spoiled(IMPEDANCE, "environment: soft", "environment: soft\n    contacts: [soft, hand]")
    assert doubts(text) == doubts(SWITCHED) == []


LOGIC = """\
mode_logic:
  type: thresholds
  start: position
  signals:
    torque: {noise: 0.002 N*m, age: 4 ms, largest_rate: 6.2 N*m/s}
  switches:
    - {from: position, to: force, torque: {above: THRESHOLD}}
    - {from: force, to: position, torque: {below: 0.1 N*m}}
"""


def test_a_threshold_above_the_largest_torque():
    """At the limit is not above it."""
    for threshold, count in (("0.3 N*m", 1), ("0.3001 N*m", 2)):
        logic = LOGIC.replace("THRESHOLD", threshold)
        found = doubts(FORCE.replace("switching:", f"{logic}switching:"))
        assert len(found) == count
    assert found[-1].at == ("mode_logic", "switches")
    assert "switch 1 of the mode logic" in str(found[-1])
    assert "0.3001 N*m, above limits.torque of 0.3 N*m" in str(found[-1])


def test_a_delay_that_is_not_declared():
    """One sample of 2 ms: a goal of 2 ms is met by it, one of 4 ms by no proof."""
    for goal, count in (("2 ms", 1), ("4 ms", 2)):
        more = f"sampling: {{period: 2 ms, delay: [0, 1]}}\ngoals: {{delay: {goal}}}\nswitching:"
        found = doubts(IMPEDANCE.replace("switching:", more))
        assert len(found) == count
    assert found[-1].at == ("goals", "delay")
    assert "force samples are declared to be at most 0.002 s" in str(found[-1])


def test_a_command_that_cannot_reach_the_speed_limit():
    """8 deg/s is 0.139626 rad/s, and 288.39 rpm with the gain of the thesis."""
    for command, count in (("289 rpm", 1), ("288 rpm", 2)):
        limits = f"bandwidth: 2 Hz, command: {command}"
        found = doubts(spoiled(IMPEDANCE, "bandwidth: 2 Hz", limits))
        assert len(found) == count
    assert found[-1].at == ("limits", "command")
    assert "0.13944096 rad/s" in str(found[-1])


def test_bounds_for_smaller_commands_than_the_limit_lets_through():
    """What is exported saturates at limits.velocity, 8 deg/s; bounds are for the disturbance."""
    for command, count in (("8 deg/s", 1), ("7.999 deg/s", 2), ("0.1 rad/s", 2), ("0.2 rad/s", 1)):
        more = f"sampling: {{period: 2 ms, delay: 0}}\ndisturbances: {{command: {command}}}\n"
        found = doubts(f"{IMPEDANCE}{more}")
        assert len(found) == count
        if count == 2:
            assert found[-1].at == ("disturbances", "command")
            assert f"up to {command}, and limits.velocity lets them be 8 deg/s" in str(found[-1])


def test_a_loop_that_given_gains_do_not_make():
    """With 2060 rpm*s/rad and 56.9706 1/s the loop of the thesis has 0.707 and 140.6 ms."""
    given = "\n  derivative_gain: 2060 rpm*s/rad\n  zero: 56.9706 1/s"
    for ratio, count in (("0.707", 1), ("0.68", 1), ("0.2", 2)):
        found = doubts(spoiled(IMPEDANCE, "damping_ratio: 0.707", f"damping_ratio: {ratio}{given}"))
        assert len(found) == count
    assert "the loop that ships has 0.707 and 0.1406 s" in str(found[-1])


def test_the_largest_gain_of_a_range_counts():
    text = IMPEDANCE.replace(
        "gain: 4.8417e-4 rad/s/rpm",
        "gain: {nominal: 4.8417e-4 rad/s/rpm, range: [4.8e-4 rad/s/rpm, 4.9e-4 rad/s/rpm]}",
    ).replace("bandwidth: 2 Hz", "bandwidth: 2 Hz, command: 286 rpm")
    assert len(doubts(text)) == 1


def test_a_size_that_no_surgical_robot_has():
    """A slip of a unit is valid, and is asked about: 24 m for 0.24 m, 35.1 s for 35.1 ms."""
    for old, new, at, said in (
        ("lever_arm: 0.24 m", "lever_arm: 240 m", ("environments", "soft", "lever_arm"), "240 mm"),
        ("time_constant: 0.0351 s", "time_constant: 35.1 s", ("actuator", "time_constant"),
         "35.1 ms"),
        ("torque: 0.3 N*m", "torque: 3000 N*m", ("limits", "torque"), "3000 mN*m or 3000 N*mm"),
        ("velocity: 8 deg/s", "velocity: 480 rad/s", ("limits", "velocity"), "480 deg/s"),
    ):  # fmt: skip
        found = [doubt for doubt in doubts(spoiled(IMPEDANCE, old, new)) if doubt.at == at]
        assert len(found) == 1
        assert f"is that its unit? did you mean {said}?" in str(found[0])


def test_bounds_are_not_proved_beside_two_periods_or_misses():
    pushed = f"{IMPEDANCE}\ndisturbances: {{command: 8 deg/s}}\nsampling: {{period: 2 ms, delay: 0"
    assert [d.at for d in doubts(f"{pushed}}}\n")] == [("environments", "hand")]
    for more in ("outer_period: 4 ms", "misses: {consecutive: 1, command: hold}"):
        _, doubt = doubts(f"{pushed}, {more}}}\n")
        assert doubt.at == ("disturbances",)
        assert "no bound" in str(doubt)


def test_what_is_valid_and_not_proved_in_continuous_time():
    """`certify-switching` stops at these; that `check` calls them valid is not all that it says."""
    lost = f"{FORCE}\ncontact: losable\n"
    assert "loss of contact beside 'position'" in str(doubts(lost)[-1])
    assert doubts(f"{lost}sampling: {{period: 2 ms, delay: 0}}\n") == doubts(FORCE)
    pushed = f"{IMPEDANCE}\ndisturbances: {{command: 8 deg/s}}\n"
    sprung = spoiled(pushed, "    Bt:", "    Kt: 0.5 N*m/rad\n    Bt:")
    assert "a velocity command beside the spring Kt" in str(doubts(sprung)[-1])
    assert [doubt.at for doubt in doubts(pushed)] == [("environments", "hand")]
