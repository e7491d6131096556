"""Robots that a spec may describe and that cannot exist."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.errors import DesignError, PoseError
from nrs_design.robot.models.body import MASSLESS, point_mass
from nrs_design.robot.models.dynamics import mass_matrix
from nrs_design.robot.models.robot import Workspace
from nrs_design.robot.models.soundness import examine_inertia


def test_eigenvalues_of_the_robot(robot):
    found = examine_inertia(robot)
    assert (np.diff(found) > 0).all()
    M = mass_matrix(robot, robot.home)
    assert [found.sum(), found.prod()] == pytest.approx([np.trace(M), np.linalg.det(M)])


def test_the_platform_alone_is_enough(robot):
    assert (examine_inertia(robot.without_links()) > 0).all()


def test_nothing_with_mass(robot):
    with pytest.raises(DesignError, match="is singular"):
        examine_inertia(replace(robot.without_links(), platform=MASSLESS))


def test_a_mass_that_one_motion_leaves_at_rest(robot):
    # In the pivot: turning the endoscope about it moves nothing.
    at_pivot = point_mass(1.0, (0.0, 0.0, -float(robot.home[2])))
    with pytest.raises(DesignError, match="moves no mass"):
        examine_inertia(replace(robot.without_links(), platform=at_pivot))


def test_a_workspace_out_of_reach(robot):
    far = Workspace(robot.workspace.phi, robot.workspace.psi, (0.5, 0.6))
    with pytest.raises(PoseError, match="overstretched"):
        examine_inertia(replace(robot, workspace=far))
