"""From a file with several axes, and the model that it names, to the mobility of the arm."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import placed
from nrs_design.progress import Progress, silent
from nrs_design.proof.text import quoted
from nrs_design.robot.models.arm import ArmMobility, ArmTree, Floats, mobility
from nrs_design.robot.models.enclosure.arm import cover_mobility
from nrs_design.robot.models.urdf import read_arm
from nrs_design.spec.load import LoadedSpec, read_axes
from nrs_design.spec.task_space import file_of
from nrs_design.work import Allowance, Fuse

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.arm import ArmSpec

AXES = ("x", "y", "z", "rx", "ry", "rz")
SLIDING = AXES[:3]
# Poses that are tried, half of them with joints at the ends of their ranges; and how many of the
# worst go on, a few steps.
TRIED, KEPT, STEPS = 4096, 16, 12
# Numbers of a spec become doubles.
OUTWARD = 2.0**-40


@dataclass(frozen=True, slots=True)
class ArmInUse:
    """An arm, the inertias that its axes are given, and the box of its joint positions."""

    file: Path  # Of the axes
    model: Path  # URDF or MJCF
    arm: ArmTree
    names: tuple[str, ...]  # Of the axes
    inertias: Floats  # Shape (k,), in kg or kg m^2
    low: Floats  # Shape (n,), in rad or m
    high: Floats
    declared: tuple[float, float]  # Lowest and highest, rounded inwards

    @property
    def rows(self) -> list[int]:
        """Which rows of the Jacobian the axes are."""
        return [AXES.index(name) for name in self.names]


@dataclass(frozen=True, slots=True)
class FoundMobility:
    """The extremes that poses have, in floating point."""

    lowest: float
    highest: float
    # The joint positions.
    at_lowest: Floats
    at_highest: Floats


def read_arm_in_use(path: Path) -> ArmInUse:
    """Read all axes of a file, and the arm that their coupling names.

    Raises
    ------
    SpecError
        If the file or the model is wrong, or they do not fit.
    """
    loaded = read_axes(file_of(path))
    first, arm = loaded[0], loaded[0].arm
    if arm is None:
        raise DesignError(
            "no arm is named",
            path=first.path,
            remedy="add `arm: {model: arm.urdf, tip: tool0, joints: {...}}` to coupling",
        )
    names = tuple(str(item.path).rpartition("#")[2] for item in loaded)
    with placed(first):
        designs = [_design(item) for item in loaded]
        coupling = designs[0].coupling
        for design, name in zip(designs, names, strict=True):
            if design.coupling != coupling:
                _wrong(f"the coupling of {name} is not that of {names[0]}", "say it in common")
            _check_name(design, name)
        file = first.path.parent / arm.model
        held = {name: low.si for name, (low, high) in arm.joints.items() if low == high}
        tree = read_arm(file, arm.tip, held)
        low, high = _box(arm, tree)
        assert coupling is not None
        assert coupling.mobility is not None
        declared = coupling.mobility
    drives = [design.torque_interface for design in designs]
    inertias = [drive.inertia.nominal.exact for drive in drives if drive is not None]
    return ArmInUse(
        file_of(path),
        file,
        tree,
        names,
        np.array([float(J) for J in inertias]),
        low,
        high,
        (float(declared[0]) * (1 + OUTWARD), float(declared[1]) * (1 - OUTWARD)),
    )


def find_mobility(use: ArmInUse) -> FoundMobility:
    """Search poses for the extremes, in floating point; the seed is fixed."""
    rng, n = np.random.default_rng(1), use.arm.order
    box = use.low, use.high
    inside = rng.uniform(*box, (TRIED // 2, n))
    ends = np.where(rng.random((TRIED // 2, n)) < 0.5, *box)
    q = np.concatenate([inside, ends, [(use.low + use.high) / 2]])
    found = []
    for side, sign in ((0, 1.0), (-1, -1.0)):
        best = q[np.argsort(sign * _extreme(use, q, side))[:KEPT]]
        for step in range(STEPS):
            width = (use.high - use.low) * 0.5 ** (1 + step / 2)
            tried = best[:, None, :] + rng.uniform(-1, 1, (KEPT, 32, n)) * width
            pool = np.concatenate([best, np.clip(tried, *box).reshape(-1, n)])
            best = pool[np.argsort(sign * _extreme(use, pool, side))[:KEPT]]
        found.append((float(_extreme(use, best[:1], side)[0]), best[0]))
    (lowest, at_lowest), (highest, at_highest) = found
    return FoundMobility(lowest, highest, at_lowest, at_highest)


def judge_mobility(
    path: Path, budget: float, progress: Progress = silent, *, poses_only: bool = False
) -> ArmMobility:
    """Judge the mobility that a file declares, over the whole box of joint positions.

    Parameters
    ----------
    path : Path
        Of the axes, or one of them.
    budget : float
        Work, in units.
    progress : callable
        Told what is being done.
    poses_only : bool
        Only look for a pose that is beyond it; that there is none shows nothing.

    Raises
    ------
    SpecError
        If the file or the model is wrong.
    DesignError
        If they do not fit.
    """
    use = read_arm_in_use(path)
    progress("mobility: looking for the extremes")
    found = find_mobility(use)
    faults = _faults(use, found)

    def told(done: int, left: int) -> None:
        progress(f"mobility: {done} boxes shown, {left} left")

    shown = False
    if not faults and not poses_only:
        allowance, box = Allowance(budget, fuse=Fuse.of(budget)), (use.low, use.high)
        shown = cover_mobility(use.arm, use.inertias, use.rows, use.declared, box, allowance, told)
    ends = found.at_lowest, found.at_highest
    lowest, highest = (tuple(map(float, q)) for q in ends)
    return ArmMobility(
        use.arm.name,
        use.model,
        use.names,
        tuple(joint.name for joint in use.arm.joints),
        use.declared,
        (found.lowest, found.highest),
        (lowest, highest),
        (pose(use, ends[0]), pose(use, ends[1])),
        faults,
        shown,
    )


def _faults(use: ArmInUse, found: FoundMobility) -> tuple[str, ...]:
    """Say where a pose is beyond the declared mobility."""
    low, high = use.declared
    said = []
    for name, beyond, value, end, at in (
        ("lowest", found.lowest < low, found.lowest, low, found.at_lowest),
        ("highest", found.highest > high, found.highest, high, found.at_highest),
    ):
        if beyond:
            where = f"{value:.6g} {pose(use, at)}"
            said.append(f"the {name} mobility is said to be {end:.6g}, and is {where}")
    return tuple(said)


def pose(use: ArmInUse, q: Floats) -> str:
    """Say in words where the joints are."""
    each = zip(use.arm.joints, q, strict=True)
    return "at " + ", ".join(
        f"{j.name} {value:.4g} m" if j.slides else f"{j.name} {np.degrees(value):.4g} deg"
        for j, value in each
    )


def _extreme(use: ArmInUse, q: Floats, side: int) -> Floats:
    return np.asarray(np.linalg.eigvalsh(mobility(use.arm, q, use.inertias, use.rows))[:, side])


def _design(loaded: LoadedSpec) -> InteractionDesignSpec:
    assert loaded.spec.kind == "interaction-design"
    return loaded.spec


def _check_name(design: InteractionDesignSpec, name: str) -> None:
    if name not in AXES:
        _wrong(
            f"axis {quoted(name)} is none of the tip",
            f"call it {', '.join(AXES)}, or leave arm out",
        )
    if (design.axis == "prismatic") != (name in SLIDING):
        kind = "prismatic" if name in SLIDING else "rotary"
        _wrong(f"axis {name} is {kind}", f"write `axis: {kind}`, or call it otherwise")


def _box(arm: ArmSpec, model: ArmTree) -> tuple[Floats, Floats]:
    """Return the joint positions that are used, rounded outwards."""
    ends = []
    for joint in model.joints:
        if joint.name not in arm.joints:
            _wrong(
                f"nothing is said of joint {quoted(joint.name)}",
                f"add `{joint.name}: [lowest, highest]` to joints, or one value if it is held",
            )
        low, high = arm.joints[joint.name]
        if (low.unit.endswith("m")) != joint.slides:
            _wrong(
                f"joint {quoted(joint.name)} {'slides' if joint.slides else 'turns'}",
                f"write it in {'m or mm' if joint.slides else 'deg or rad'}",
            )
        if joint.limits is not None and not joint.limits[0] <= low.si <= high.si <= joint.limits[1]:
            _wrong(
                f"joint {quoted(joint.name)} is used beyond its limits, "
                f"{joint.limits[0]:.6g} to {joint.limits[1]:.6g} {'m' if joint.slides else 'rad'}",
                "use a range within the limits",
            )
        out = OUTWARD * max(abs(low.si), abs(high.si))
        ends.append((low.si - out, high.si + out))
    low, high = np.array(ends).T
    return low, high


def _wrong(message: str, remedy: str) -> NoReturn:
    raise DesignError(message, remedy=remedy, at=("coupling", "arm"))
