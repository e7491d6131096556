"""A design that is proved and of no use: it meets no requirement that is not among its goals."""

USELESS = """\
kind: interaction-design
name: holder
actuator: {gain: 6.2e-4 rad/s/rpm, time_constant: 28 ms}
motion_loop: {damping_ratio: 0.707, settling_time: 0.12 s}
limits: {velocity: 10 deg/s, torque: 0.5 N*m, bandwidth: 2 Hz}
environments:
  tissue: {model: elastic, stiffness: 600 N/m, lever_arm: 0.18 m}
controllers:
  insert:
    type: impedance
    environment: tissue
    Mt: 0.01 kg*m^2
    Bt: {min: 7 N*m*s/rad, max: 20 N*m*s/rad}
  withdraw:
    type: impedance
    environment: tissue
    Mt: 0.01 kg*m^2
    Bt: {min: 7 N*m*s/rad, max: 20 N*m*s/rad}
  limit: {type: force, environment: tissue, proportional_gain: 0.015 rad/(N*m)}
switching: arbitrary
idle_states: {decay: 20 1/s}
"""
