from nrs_design.spec.describe import describe

from .samples import FORCE, IMPEDANCE, interaction, spoiled, switched


def test_the_largest_command_is_shown_where_it_is_given() -> None:
    assert not any(name == "limits.command" for name, *_ in describe(interaction(IMPEDANCE)))
    text = spoiled(IMPEDANCE, "bandwidth: 2 Hz", "bandwidth: 2 Hz, command: 4000 rpm")
    assert ("limits.command", "4000 rpm", "4000", "rpm") in describe(interaction(text))


def test_force_controllers() -> None:
    rows = describe(interaction(FORCE))
    assert ("controllers.force.proportional_gain", "0.02 rad/(N*m)", "0.02", "rad/(N*m)") in rows
    assert ("controllers.position.type", "position", "", "") in rows
    text = spoiled(FORCE, "proportional_gain: 0.02 rad/(N*m)", "damping_ratio: 2/3")
    assert ("controllers.force.damping_ratio", "2/3", "0.666667", "") in describe(interaction(text))


def test_motion_loop_options() -> None:
    loop = (
        "  derivative_gain: 2060 rpm*s/rad\n  zero: 56.9706 1/s\n"
        "  transfer_function: {numerator: [0.99, 56.82], denominator: [0.0351, 1.99, 1/3]}\n"
    )
    rows = describe(interaction(spoiled(IMPEDANCE, "limits:", loop + "limits:")))
    assert ("motion_loop.zero", "56.9706 1/s", "56.9706", "1/s") in rows
    assert ("motion_loop.derivative_gain", "2060 rpm*s/rad", "2060", "rpm*s/rad") in rows
    name = "motion_loop.transfer_function.denominator"
    assert (name, "[0.0351, 1.99, 1/3]", "[0.0351, 1.99, 0.333333]", "") in rows


def test_parameters_rules_and_resets() -> None:
    text = """\
kind: switched-system
name: sample
time: discrete
parameters:
  k: {nominal: 43, range: ["1/3", 90]}
  m: {nominal: 1, range: [0.5, 2], varies: false}
  r: {nominal: 2}
modes:
  - {name: a, A: [[0, 1], [-2 - k, -1]]}
  - {name: b, A: [[m - r*2]]}
switching: {transitions: [[a, b], [b, a]]}
resets:
  - {from: a, to: b, map: [[1, 0]]}
  - {from: b, to: a, map: [[1], [0]]}
"""
    rows = describe(switched(text))
    assert ("switching.transitions", "a to b, b to a", "2", "") in rows
    assert ("parameters.k", "43", "43", "") in rows
    assert ("parameters.k.range", "[1/3, 90]", "[0.333333, 90]", "") in rows
    assert ("parameters.k.varies", "true", "arbitrarily fast", "") in rows
    assert ("parameters.m.varies", "false", "unknown, but constant", "") in rows
    assert [row for row in rows if row.name.startswith("parameters.r")] == [
        ("parameters.r", "2", "2", "")
    ]
    assert ("modes[0]", "a", "2 x 2, k", "") in rows
    assert ("modes[1]", "b", "1 x 1, m, r", "") in rows
    assert ("resets[0]", "a to b", "1 x 2", "") in rows
    assert ("resets[1]", "b to a", "2 x 1", "") in rows
