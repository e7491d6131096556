"""An arm from a URDF file: names, joints, limits and inertias, each checked before it is used.

http://wiki.ros.org/urdf/XML gives the format. Links that are fixed to each other are one body.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from xml.etree import ElementTree

import numpy as np

from nrs_design.errors import SpecError
from nrs_design.files import open_regular
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

MAX_BYTES = 4 * 2**20
_MOVING = ("revolute", "continuous", "prismatic")
# A principal moment of a rigid body is at most the sum of the two others, but for rounded digits.
_TRIANGLE = 1 + 1e-6


@dataclass(frozen=True, slots=True)
class _Joint:
    name: str
    kind: str
    parent: str
    child: str
    rotation: Floats
    place: Floats
    axis: Floats
    limits: tuple[float, float] | None


def read_arm(path: Path, tip: str, held: Mapping[str, float] = MappingProxyType({})) -> ArmTree:
    """Read an arm from URDF, or from MJCF, and which of its links is the tip.

    Parameters
    ----------
    path : Path
        A URDF or MJCF file.
    tip : str
        Name of a link.
    held : mapping of str to float
        Joints that do not move, and where they are held, in rad or m.

    Raises
    ------
    SpecError
        If the file is no URDF, has no such link, a joint that is not modelled, or a joint that
        moves nothing with an inertia.
    """
    root = _parsed(path)
    if root.tag == "mujoco":
        from nrs_design.robot.models.mjcf_arm import read_mjcf

        return read_mjcf(path, root, tip, held)
    links = {_text(path, link, "name"): link for link in root.findall("link")}
    joints = [_joint(path, element, held) for element in root.findall("joint")]
    for name in held:
        _check_known(path, name, [joint.name for joint in joints])
    if tip not in links:
        raise _wrong(path, f"there is no link {quoted(tip)}", did_you_mean(tip, list(links)))
    for joint in joints:
        for end in (joint.parent, joint.child):
            if end not in links:
                raise _wrong(
                    path, f"joint {quoted(joint.name)} names a link {quoted(end)} that there is not"
                )
    children = {joint.child for joint in joints}
    if len(children) < len(joints):
        raise _wrong(path, "a link has two joints to its parent: URDF describes trees")
    bases = [name for name in links if name not in children]
    if len(bases) != 1:
        raise _wrong(path, f"there are {len(bases)} links without a parent instead of one")
    return _Tree(path, links, joints).arm(root.get("name", path.stem), bases[0], tip)


@dataclass(frozen=True, slots=True)
class _Tree:
    path: Path
    links: dict[str, ElementTree.Element]
    joints: list[_Joint]

    def arm(self, name: str, base: str, tip: str) -> ArmTree:
        made: list[ArmJoint] = []
        found: dict[str, tuple[int, Floats, Floats]] = {}
        inertias: list[Floats] = []
        # A link: on which body it is, and where in the frame of that.
        waiting: list[tuple[str, int, Floats, Floats]] = [(base, -1, np.eye(3), np.zeros(3))]
        while waiting:
            link, body, rotation, place = waiting.pop(0)
            found[link] = body, rotation, place
            if body >= 0 and (own := self._inertia(link)) is not None:
                X = motion_transform(rotation, place)
                inertias[body] += X.T @ own @ X
            for joint in (j for j in self.joints if j.parent == link):
                rotated, moved = rotation @ joint.rotation, place + rotation @ joint.place
                if joint.kind == "fixed":
                    waiting.append((joint.child, body, rotated, moved))
                    continue
                if len(made) == MAX_JOINTS:
                    raise _wrong(self.path, f"more than {MAX_JOINTS} joints move")
                made.append(
                    ArmJoint(
                        joint.name,
                        body,
                        rotated,
                        moved,
                        joint.axis,
                        joint.kind == "prismatic",
                        joint.limits,
                        np.zeros((6, 6)),
                    )
                )
                inertias.append(np.zeros((6, 6)))
                waiting.append((joint.child, len(made) - 1, np.eye(3), np.zeros(3)))
        if found[tip][0] < 0:
            raise _wrong(self.path, f"no joint moves the tip {quoted(tip)}")
        joints = []
        for bare, inertia in zip(made, inertias, strict=True):
            if not inertia.any():
                raise _wrong(
                    self.path,
                    f"joint {quoted(bare.name)} moves a link without inertia",
                    "give its links `<inertial>` with mass and inertia",
                )
            joints.append(replace(bare, inertia=inertia))
        body, rotation, place = found[tip]
        return ArmTree(name, tuple(joints), body, rotation, place)

    def _inertia(self, name: str) -> Floats | None:
        """Return the spatial inertia of a link in its own frame; None where it says nothing."""
        element = self.links[name].find("inertial")
        if element is None:
            return None
        mass, tensor = element.find("mass"), element.find("inertia")
        if mass is None or tensor is None:
            raise _wrong(self.path, f"link {quoted(name)} has an inertial without mass or inertia")
        m = _number(self.path, mass, "value")
        xx, yy, zz, xy, xz, yz = (
            _number(self.path, tensor, key) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        )
        own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        moments = np.linalg.eigvalsh(own)
        if m == 0 and not own.any():
            return None
        if m <= 0 or moments[0] <= 0 or moments[2] > _TRIANGLE * (moments[0] + moments[1]):
            raise _wrong(
                self.path,
                f"the inertia of link {quoted(name)} is that of no rigid body",
                "its mass and principal moments are positive, and no moment is above the sum of "
                "the two others",
            )
        rotation, place = _origin(self.path, element)
        return spatial_inertia(m, place, rotation @ own @ rotation.T)


def _parsed(path: Path) -> ElementTree.Element:
    try:
        with open_regular(path) as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise _wrong(path, f"the file cannot be read ({error.strerror})") from error
    if len(content) > MAX_BYTES:
        raise _wrong(path, f"the file is larger than {MAX_BYTES} bytes")
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise _wrong(path, "a URDF has no document type and no entities")
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise _wrong(path, f"this is no XML: {error}") from error
    if root.tag not in ("robot", "mujoco"):
        raise _wrong(path, "this is neither URDF nor MJCF: its root is not `robot` or `mujoco`")
    return root


def _check_known(path: Path, name: str, known: list[str]) -> None:
    if name not in known:
        raise _wrong(path, f"there is no joint {quoted(name)}", did_you_mean(name, known))


def _joint(path: Path, element: ElementTree.Element, held: Mapping[str, float]) -> _Joint:
    name, kind = _text(path, element, "name"), _text(path, element, "type")
    if kind not in (*_MOVING, "fixed"):
        raise _wrong(
            path,
            f"joint {quoted(name)} is of type {quoted(kind)}, which is not modelled",
            f"use one of {', '.join((*_MOVING, 'fixed'))}",
        )
    if element.find("mimic") is not None and name not in held:
        raise _wrong(
            path,
            f"joint {quoted(name)} follows another one, which is not modelled",
            f"say where it is held, such as `{name}: 0 m`",
        )
    parent, child = (_end(path, element, name, key) for key in ("parent", "child"))
    given = element.find("axis")
    axis = np.array([1.0, 0, 0]) if given is None else _vector(path, given, "xyz")
    size = float(np.linalg.norm(axis))
    if kind != "fixed" and size == 0:
        raise _wrong(path, f"the axis of joint {quoted(name)} is zero")
    rotation, place = _origin(path, element)
    limit = element.find("limit")
    limits = None
    if kind in ("revolute", "prismatic"):
        if limit is None:
            raise _wrong(path, f"joint {quoted(name)} has no limit")
        low, high = (_number(path, limit, key, 0.0) for key in ("lower", "upper"))
        limits = low, high
    axis = axis / (size or 1.0)
    if name in held and kind != "fixed":
        if kind == "prismatic":
            place = place + rotation @ axis * held[name]
        else:
            rotation = rotation @ turned(axis, held[name])
        kind = "fixed"
    return _Joint(name, kind, parent, child, rotation, place, axis, limits)


def _end(path: Path, element: ElementTree.Element, name: str, key: str) -> str:
    end = element.find(key)
    if end is None:
        raise _wrong(path, f"joint {quoted(name)} has no {key}")
    return _text(path, end, "link")


def _origin(path: Path, element: ElementTree.Element) -> tuple[Floats, Floats]:
    """Return rotation and place of an origin; rpy turns about the fixed x, y and z."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(3), np.zeros(3)
    place = _vector(path, origin, "xyz")
    (sr, sp, sy), (cr, cp, cy) = (f(_vector(path, origin, "rpy")) for f in (np.sin, np.cos))
    rotation = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    return rotation, place


def _vector(path: Path, element: ElementTree.Element, key: str) -> Floats:
    text = element.get(key, "0 0 0")
    parts = text.split()
    if len(parts) != 3:
        raise _wrong(path, f"{quoted(text)} is not three numbers")
    return np.array([_float(path, part) for part in parts])


def _number(
    path: Path, element: ElementTree.Element, key: str, default: float | None = None
) -> float:
    text = element.get(key)
    if text is None:
        if default is None:
            raise _wrong(path, f"`{element.tag}` has no {key}")
        return default
    return _float(path, text)


def _float(path: Path, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise _wrong(path, f"{quoted(text)} is not a number", "run xacro first, if it is an input")
    return value


def _text(path: Path, element: ElementTree.Element, key: str) -> str:
    text = element.get(key)
    if not text:
        raise _wrong(path, f"`{element.tag}` has no {key}")
    return text


def _wrong(path: Path, message: str, remedy: str | None = None) -> SpecError:
    return SpecError(message, path=path, remedy=remedy or "correct the URDF, or name another one")
