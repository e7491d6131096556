"""An arm from an MJCF file, as MuJoCo reads its bodies and joints.

Shapes, meshes and everything else is left out before, so that no inertia comes from a shape, and no
other file counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn
from xml.etree import ElementTree

import numpy as np

from nrs_design.errors import SpecError
from nrs_design.proof.text import quoted
from nrs_design.robot.models.arm import (
    MAX_JOINTS,
    ArmJoint,
    ArmTree,
    Floats,
    motion_transform,
    spatial_inertia,
    turned,
)
from nrs_design.spec.faults import did_you_mean

# What says where bodies are, how they move and what they weigh.
_KEPT = {"compiler", "option", "default", "worldbody", "body", "joint", "inertial", "site", "frame"}
_REFUSED = {
    "include": "a file that includes others",
    "freejoint": "a body that floats",
    "equality": "joints or bodies that are tied to each other",
    "tendon": "a tendon",
    "attach": "a model in the model",
    "replicate": "bodies that are repeated",
    "composite": "a composite body",
    "flexcomp": "a body that bends",
}


def read_mjcf(
    path: Path, root: ElementTree.Element, tip: str, held: Mapping[str, float]
) -> ArmTree:
    """Read an arm from a parsed MJCF file; see `nrs_design.robot.models.urdf.read_arm`.

    Parameters
    ----------
    path : Path
        Of the file, for errors.
    root : Element
        Its content.
    tip : str
        Name of a body or a site.
    held : mapping of str to float
        Joints that do not move, and where they are held, in rad or m.

    Raises
    ------
    SpecError
        If MuJoCo is missing, or the model has what is not modelled.
    """
    for name, what in _REFUSED.items():
        if root.find(f".//{name}") is not None:
            _wrong(path, f"{what} (`{name}`) is not modelled", "remove it from a copy of the file")
    for body in root.findall(".//worldbody//body"):
        if body.find("inertial") is None and body.find("geom") is not None:
            _wrong(
                path,
                f"body {quoted(body.get('name', ''))} has no inertial: its inertia would come from "
                "its shapes",
                "give it `<inertial pos mass diaginertia>`",
            )
    model = _compiled(path, _stripped(root))
    joints = [model.joint(i).name for i in range(model.njnt)]
    for name in held:
        if name not in joints:
            _wrong(path, f"there is no joint {quoted(name)}", did_you_mean(name, joints))
    return _arm(path, root.get("model", path.stem), model, tip, held)


def _stripped(root: ElementTree.Element) -> str:
    def kept(element: ElementTree.Element) -> ElementTree.Element:
        attributes = element.attrib
        if element.tag == "compiler":
            # Where other files are, and how shapes are weighed.
            known = ("angle", "autolimits", "eulerseq", "coordinate")
            attributes = {key: value for key, value in attributes.items() if key in known}
        copy = ElementTree.Element(element.tag, attributes)
        copy.extend(kept(child) for child in element if child.tag in _KEPT)
        return copy

    return ElementTree.tostring(kept(root), encoding="unicode")


def _compiled(path: Path, text: str) -> Any:
    try:
        mujoco = import_module("mujoco")
    except ImportError as error:
        _wrong(path, f"MJCF is read by MuJoCo, which cannot be loaded ({error})",
               "pip install 'nrs-design[mujoco]', or name a URDF")  # fmt: skip
    try:
        return mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        _wrong(path, f"MuJoCo cannot read it: {error}", "correct the MJCF, or name a URDF")


def _arm(path: Path, name: str, model: Any, tip: str, held: Mapping[str, float]) -> ArmTree:
    """Return the bodies that move; of each body of MuJoCo, on which of them it is, and where."""
    places: list[tuple[int, Floats, Floats]] = [(-1, np.eye(3), np.zeros(3))]
    made: list[ArmJoint] = []
    for b in range(1, model.nbody):
        body, rotation, place = places[model.body_parentid[b]]
        place = place + rotation @ model.body_pos[b]
        rotation = rotation @ _rotation(model.body_quat[b])
        if model.body_jntnum[b] > 1:
            _wrong(path, f"body {quoted(model.body(b).name)} has several joints",
                   "put bodies without mass between them, or name a URDF")  # fmt: skip
        if model.body_jntnum[b]:
            j = int(model.body_jntadr[b])
            joint, axis, at = model.joint(j).name, model.jnt_axis[j].copy(), model.jnt_pos[j].copy()
            slides = _slides(path, model, j)
            if joint in held:
                if slides:
                    place = place + rotation @ axis * held[joint]
                else:
                    R = turned(axis, held[joint])
                    place = place + rotation @ (at - R @ at)
                    rotation = rotation @ R
            else:
                if len(made) == MAX_JOINTS:
                    _wrong(path, f"more than {MAX_JOINTS} joints move", "hold some of them")
                limits = None
                if model.jnt_limited[j]:
                    limits = float(model.jnt_range[j][0]), float(model.jnt_range[j][1])
                armature = float(model.dof_armature[model.jnt_dofadr[j]])
                at_zero = place + rotation @ at
                inertia = np.zeros((6, 6))
                made.append(
                    ArmJoint(
                        joint, body, rotation, at_zero, axis, slides, limits, inertia, armature
                    )
                )
                body, rotation, place = len(made) - 1, np.eye(3), -at
        if body >= 0 and model.body_mass[b] > 0:
            R = _rotation(model.body_iquat[b])
            tensor = R @ np.diag(model.body_inertia[b]) @ R.T
            own = spatial_inertia(float(model.body_mass[b]), model.body_ipos[b], tensor)
            X = motion_transform(rotation, place)
            made[body].inertia[:] += X.T @ own @ X
        places.append((body, rotation, place))
    empty = next((joint.name for joint in made if not joint.inertia.any()), None)
    if empty is not None:
        _wrong(path, f"joint {quoted(empty)} moves a body without inertia", "give it an inertial")
    bodies = {model.body(b).name: places[b] for b in range(model.nbody)}
    for s in range(model.nsite):
        body, rotation, place = places[model.site_bodyid[s]]
        moved = place + rotation @ model.site_pos[s]
        bodies[model.site(s).name] = body, rotation @ _rotation(model.site_quat[s]), moved
    if tip not in bodies:
        known = did_you_mean(tip, [known for known in bodies if known])
        _wrong(path, f"there is no link {quoted(tip)}", known)
    body, rotation, place = bodies[tip]
    if body < 0:
        _wrong(path, f"no joint moves the tip {quoted(tip)}", "name a body behind a joint")
    return ArmTree(name, tuple(made), body, rotation, place)


def _slides(path: Path, model: Any, j: int) -> bool:
    kind, joint = int(model.jnt_type[j]), quoted(model.joint(j).name)
    if kind not in (2, 3):
        _wrong(path, f"joint {joint} neither slides nor turns about one axis", "use slide or hinge")
    if model.qpos0[model.jnt_qposadr[j]] != 0:
        _wrong(path, f"joint {joint} has a `ref`, so its position is counted from elsewhere",
               "remove ref, and count the position from where the body is drawn")  # fmt: skip
    return kind == 2


def _rotation(quaternion: Floats) -> Floats:
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _wrong(path: Path, message: str, remedy: str) -> NoReturn:
    raise SpecError(message, path=path, remedy=remedy)
