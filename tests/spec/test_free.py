"""Gains that are free beside Mt and Bt, by factors on what the spec gives."""

import pytest

from .samples import FORCE, IMPEDANCE, interaction, refusal

FREED = "design: {free: {%s}}\n"
BOUNDS = "{min: 0.6, max: 1.6}"


def test_free_gains_are_read():
    spec = interaction(IMPEDANCE + FREED % f"motion: {{Kp: {BOUNDS}, Kd: {BOUNDS}}}")
    (name, free), *others = spec.design.free.items()
    assert not others
    assert name == "motion"
    assert [(gain, float(b.min), float(b.max)) for gain, b in free.given()] == [
        ("Kp", 0.6, 1.6),
        ("Kd", 0.6, 1.6),
    ]
    # Nothing is free unless it is named.
    assert interaction(IMPEDANCE).design.free == {}
    assert interaction(FORCE + FREED % f"force: {{Kp: {BOUNDS}}}").design.free


@pytest.mark.parametrize(
    ("text", "free", "message"),
    [
        (IMPEDANCE, f"insertion: {{Kp: {BOUNDS}}}", "'insertion' has no gain Kp"),
        # It is given no spring that could be another one.
        (IMPEDANCE, f"insertion: {{Kt: {BOUNDS}}}", "'insertion' has no gain Kt"),
        (IMPEDANCE, f"motion: {{Kt: {BOUNDS}}}", "'motion' has no gain Kt"),
        (IMPEDANCE, f"other: {{Kp: {BOUNDS}}}", "'other' has no gain Kp"),
        (FORCE, f"position: {{Kp: {BOUNDS}}}", "'position' has no gain Kp"),
        (FORCE, f"force: {{Ki: {BOUNDS}}}", "'force' has no gain Ki"),
        (IMPEDANCE, f"insertion: {{Mt: {BOUNDS}}}", "unknown key"),
        (IMPEDANCE, "motion: {}", "no gain is named"),
        (IMPEDANCE, "motion: {Kp: {min: 2, max: 3}}", "the given gain itself is not within"),
        (IMPEDANCE, "motion: {Kp: {min: 1.5, max: 0.5}}", "the given gain itself is not within"),
        (IMPEDANCE, "motion: {Kp: {min: 0, max: 2}}", "0 is not positive"),
        (IMPEDANCE, "motion: {Kp: {max: 2}}", "min` is missing"),
    ],
)
def test_what_cannot_be_free(text, free, message):
    assert message in str(refusal(text + FREED % free))


@pytest.mark.parametrize(
    ("goal", "remedy"),
    [
        ("max_stiffness: 900 N/m", "goals are proved over the whole range"),
        ("motor_tolerance: 0.02", "ranges of gain and time_constant"),
        ("latency: 1 ms", "sampling"),
        ("passivity: 2 Hz", "no gains are chosen by it"),
    ],
)
def test_what_is_declared_is_no_goal(goal, remedy):
    (fault,) = refusal(f"{IMPEDANCE}goals: {{{goal}}}\n").faults
    assert "is no goal" in fault.message
    assert remedy in fault.remedy
