"""What the simulation of tracking takes for granted, and what it leaves out."""

from __future__ import annotations

LEFT_OUT = (
    "compliance of the capstan's cable, of the links and of the joints",
    "backlash of the gearhead, and its efficiency (at most 70 %, thesis table 4.1)",
    "friction in passive joints and springs; viscous friction beyond that in the motor's gain",
    "static friction above the Coulomb value, and friction that varies with position or load",
    "limits of the driver's voltage, current and speed, and steps of its command",
    "computation delay, filters and errors of the encoder beyond its counts, noise",
    "differences between the robot's model and the robot, beyond the simplified dynamics",
)
