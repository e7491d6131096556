"""Chapters 6.3 and 6.4: what was measured on the robot, shown and never asserted."""

from __future__ import annotations

from nrs_design.reproduction.comparison import Comparison, hardware_only

IMPEDANCE = "N m s/rad"
# Quantity, section, print, unit.
MEASUREMENTS = (
    ("impedance tracking RMSE, phi", "6.3.1.2", "0.0595", IMPEDANCE),
    ("impedance tracking RMSE, psi", "6.3.1.2", "0.0444", IMPEDANCE),
    ("withdrawal time without and with switching, phi 5 deg/s", "6.3.2.3", "0.75, 0.61", "s"),
    ("withdrawal time without and with switching, phi 3 deg/s", "6.3.2.3", "0.53, 0.41", "s"),
    ("withdrawal time without and with switching, psi 5 deg/s", "6.3.2.3", "0.09, 0.07", "s"),
    ("withdrawal time without and with switching, psi 3 deg/s", "6.3.2.3", "0.16, 0.13", "s"),
    ("gain in withdrawal time by switching", "6.3.2.3", "20", "%"),
    ("peak torque at a limit of 0.3 N m, phi", "6.3.3.3", "0.35", "N m"),
    ("steady-state torque error, phi and psi", "6.3.3.3", "2, 12", "%"),
    ("impedance RMSE in soft and stiff contact, phi", "6.4.2", "0.12335, 0.4621", IMPEDANCE),
    ("impedance RMSE in soft and stiff contact, psi", "6.4.2", "0.5333, 0.17", IMPEDANCE),
)


def rows() -> tuple[Comparison, ...]:
    """List the measurements."""
    return tuple(hardware_only(*measurement) for measurement in MEASUREMENTS)
