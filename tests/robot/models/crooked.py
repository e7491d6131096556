"""A robot without any symmetry, for whatever must hold of every robot of the family."""

from dataclasses import replace

import numpy as np

from nrs_design.robot.models.body import rigid_body


def crooked(robot):
    """Give a robot oblique axes, centers off the links, and a tilt."""
    rng = np.random.default_rng(5)

    def body(mass):
        A = rng.normal(0, 0.02, (3, 3))
        second = A @ A.T
        return rigid_body(mass, rng.normal(0, 0.05, 3), np.trace(second) * np.eye(3) - second)

    changes = [
        {"azimuth": -0.9, "l0": 0.21, "l1": 0.14, "l2": 0.2},
        {"azimuth": 0.7, "l0": 0.19, "l3": 0.19},
        {"azimuth": 0.1, "l1": 0.13, "l3": 0.205},
    ]
    legs = tuple(
        replace(leg, crank=body(0.1), coupler=body(0.2), arm=body(0.3), axis_inertia=1e-3, **change)
        for leg, change in zip(robot.legs, changes, strict=True)
    )
    return replace(robot, legs=legs, platform=body(0.8), base_tilt=-0.5)
