"""Arms in URDF for tests, with numbers that are made up."""

import numpy as np

from tests.support import ROOT

EXAMPLE = ROOT / "docs/examples/arm.urdf"


def inertial(rng):
    """Return the inertial of a body that there could be: of a few points with mass."""
    points, masses = rng.normal(size=(6, 3)) * 0.1, rng.uniform(0.1, 1, 6)
    center = masses @ points / masses.sum()
    r = points - center
    tensor = sum(m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(masses, r, strict=True))
    (xx, xy, xz), (_, yy, yz), (*_, zz) = tensor
    return (
        f'<inertial><origin xyz="{center[0]} {center[1]} {center[2]}" '
        f'rpy="{rng.uniform(-1, 1)} {rng.uniform(-1, 1)} {rng.uniform(-1, 1)}"/>'
        f'<mass value="{masses.sum()}"/><inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="{xy}" '
        f'ixz="{xz}" iyz="{yz}"/></inertial>'
    )


def random_tree(seed, joints=7):
    """Return a tree of joints that turn and slide about any axis, with links fixed to them."""
    rng = np.random.default_rng(seed)
    lines = ['<robot name="tree"><link name="l0"/>']
    for i in range(1, joints + 1):
        parent = i - 1 if rng.random() < 0.7 else int(rng.integers(0, i))
        kind = "prismatic" if rng.random() < 0.25 else "revolute"
        axis, xyz, rpy = rng.normal(size=(3, 3))
        lines.append(f'<link name="l{i}">{inertial(rng)}</link>')
        lines.append(
            f'<joint name="q{i}" type="{kind}"><parent link="l{parent}"/><child link="l{i}"/>'
            f'<origin xyz="{xyz[0]} {xyz[1]} {xyz[2]}" rpy="{rpy[0]} {rpy[1]} {rpy[2]}"/>'
            f'<axis xyz="{axis[0]} {axis[1]} {axis[2]}"/>'
            '<limit lower="-3" upper="3" velocity="1" effort="1"/></joint>'
        )
    lines.append(f'<link name="tool">{inertial(rng)}</link>')
    xyz, rpy = rng.normal(size=(2, 3))
    lines.append(
        f'<joint name="fixed" type="fixed"><parent link="l{joints}"/><child link="tool"/>'
        f'<origin xyz="{xyz[0]} {xyz[1]} {xyz[2]}" rpy="{rpy[0]} {rpy[1]} {rpy[2]}"/></joint>'
    )
    return "\n".join([*lines, "</robot>"])
