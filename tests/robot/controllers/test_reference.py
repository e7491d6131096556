import numpy as np

from nrs_design.robot.controllers import JointReference


def test_one_tick_of_some_robots():
    whole = JointReference(*np.arange(3 * 24.0).reshape(3, 4, 2, 3))
    part = whole.at(2).of([1])
    assert part.position.tolist() == [[15, 16, 17]]
    assert part.velocity.tolist() == [[39, 40, 41]]
    assert part.acceleration.tolist() == [[63, 64, 65]]
