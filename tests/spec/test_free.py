"""Gains that are free beside Mt and Bt, by factors on what the spec gives."""

from .samples import FORCE, IMPEDANCE, interaction

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
