"""The robot as a tree with cut loops for Pinocchio: a peer, and an independent oracle in the tests.

Nothing but link lengths, inertias and the configuration comes from the package: the velocities and
accelerations of the passive joints, and the forces in the cut loops, are found from Pinocchio's own
Jacobians and drift terms.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from nrs_design.robot.models.body import Body
from nrs_design.robot.models.geometry import posture
from nrs_design.robot.models.robot import Leg, Robot

Array = NDArray[np.float64]
X, Y, Z = np.eye(3)
ALIGNED = pin.LOCAL_WORLD_ALIGNED


class Tree:
    """Three open chains: plane, crank, coupler, arm; the platform moves with the middle arm."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.model = pin.Model()
        self.model.gravity.linear = np.array(robot.gravity_vector)
        # Joints are added depth-first: Pinocchio numbers the velocities in that order.
        self.tips = [
            self._leg(leg, loads) for leg, loads in zip(robot.legs, robot.loads, strict=True)
        ]
        self.data = self.model.createData()
        self.actuated = [0, 4, 9]
        self.passive = [i for i in range(self.model.nv) if i not in self.actuated]

    def _leg(self, leg: Leg, loads: tuple[Body, ...]) -> int:
        a = np.array(leg.axis)
        base = pin.SE3(np.column_stack([a, Z, np.cross(a, Z)]), np.zeros(3))
        joint = self._joint(0, pin.JointModelRX(), base)
        rotor = pin.Inertia(0.0, np.zeros(3), np.diag([leg.axis_inertia, 0.0, 0.0]))
        self.model.appendBodyToJoint(joint, rotor, pin.SE3.Identity())
        for length, body in zip((leg.l0, leg.l1, leg.l2), loads, strict=True):
            joint = self._joint(joint, pin.JointModelRZ(), pin.SE3(np.eye(3), length * X))
            inertia = pin.Inertia(body.mass, body.center_of_mass, body.inertia)
            self.model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
        tip = pin.SE3(np.eye(3), leg.l3 * X)
        return self.model.addFrame(pin.Frame(f"{leg.name} tip", joint, 0, tip, pin.OP_FRAME))

    def _joint(self, parent: int, joint: Any, placement: Any) -> int:
        return self.model.addJoint(parent, joint, placement, f"joint {self.model.njoints}")

    def configuration(self, pose: ArrayLike) -> Array:
        """Return the angles of all joints at a pose, or at each of a list; shape (..., 12)."""
        closed = posture(self.robot, pose)
        angles = []
        for leg in closed.legs:
            a = leg.leg.axis
            W = closed.W
            beta = np.arctan2(leg.sin_beta, leg.cos_beta)
            kappa = np.arctan2(leg.sin_kappa, leg.cos_kappa)
            gamma = np.arctan2(leg.sin_gamma, leg.cos_gamma)
            alpha = np.arctan2(a[1] * W[0] - a[0] * W[1], W[2])
            angles += [alpha, beta, kappa - beta, gamma + np.pi / 2 - kappa]
        return np.stack(angles, axis=-1)

    def gap(self, q: Array) -> float:
        """Distance of the side tips from the middle tip, and sines of the angles between axes."""
        pin.framesForwardKinematics(self.model, self.data, q)
        left, right, middle = (self.data.oMf[tip] for tip in self.tips)
        return max(
            max(
                np.linalg.norm(side.translation - middle.translation),
                np.linalg.norm(np.cross(side.rotation[:, 1], middle.rotation[:, 1])),
            )
            for side in (left, right)
        )

    def constraints(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Jacobian and drift of: side tips at the middle tip, side arms hinged about W."""
        pin.forwardKinematics(self.model, self.data, q, v, 0 * v)
        pin.computeJointJacobians(self.model, self.data, q)
        pin.updateFramePlacements(self.model, self.data)
        J = [pin.getFrameJacobian(self.model, self.data, tip, ALIGNED).copy() for tip in self.tips]
        drift, spin = [], []
        for tip in self.tips:
            a = pin.getFrameClassicalAcceleration(self.model, self.data, tip, ALIGNED)
            drift.append(np.concatenate([a.linear, a.angular]))
            spin.append(pin.getFrameVelocity(self.model, self.data, tip, ALIGNED).angular)
        across = self.data.oMf[self.tips[2]].rotation[:, [0, 2]].T
        rows, rest = [], []
        for side in (0, 1):
            rows += [J[side][:3] - J[2][:3], across @ (J[side][3:] - J[2][3:])]
            turning = np.cross(spin[2], across) @ (spin[side] - spin[2])
            rest += [
                drift[side][:3] - drift[2][:3],
                across @ (drift[side][3:] - drift[2][3:]) + turning,
            ]
        return np.vstack(rows), np.concatenate(rest)

    def full_motion(
        self, q: Array, velocity: ArrayLike, acceleration: ArrayLike
    ) -> tuple[Array, Array]:
        """Velocities and accelerations of all joints, from those of the motors."""
        pick = np.eye(self.model.nv)[self.actuated]
        J, _ = self.constraints(q, np.zeros(self.model.nv))
        v = _solve(np.vstack([J, pick]), np.concatenate([np.zeros(len(J)), velocity]))
        J, drift = self.constraints(q, v)
        return v, _solve(np.vstack([J, pick]), np.concatenate([-drift, acceleration]))

    def torque(self, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> Array:
        """Closed-loop inverse dynamics: no torque but at the motors, loops held together."""
        q = self.configuration(pose)
        v, a = self.full_motion(q, velocity, acceleration)
        tree = pin.rnea(self.model, self.data, q, v, a).copy()
        J, _ = self.constraints(q, v)
        force = _solve(J[:, self.passive].T, tree[self.passive])
        return (tree - J.T @ force)[self.actuated]


def _solve(matrix: Array, right: Array) -> Array:
    """Solve an equation that has one row too many: the robot is overconstrained."""
    solution, *_ = np.linalg.lstsq(matrix, right, rcond=1e-10)
    assert np.allclose(matrix @ solution, right, atol=1e-9)
    return solution
