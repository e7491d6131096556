"""The one file that knows every stage: spec, plant, design, switched system, certificate."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design import __version__
from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.gains import gains_of
from nrs_design.errors import DesignError, NrsDesignError
from nrs_design.models.plant import build_plant
from nrs_design.spec import InteractionDesignSpec, LoadedSpec, RobotSpec, read_spec
from nrs_design.switched.assemble import assemble

if TYPE_CHECKING:
    from nrs_design.certificates.certify import Certification, Method
    from nrs_design.design.evidence import DesignEvidence
    from nrs_design.models.robot import Robot

Progress = Callable[[str], None]


def _silent(step: str) -> None:
    """Report no progress."""


@dataclass(frozen=True)
class Result:
    """One spec, all the way through.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec and where it came from.
    design : ControllerDesign or None
        The gains that ship; None for given matrices.
    coordinates : str or None
        Of the assembled modes; None for given matrices.
    certification : Certification
        The verdict with every attempt.
    certificate : Certificate or None
        What may be written to a file; None if the verdict is inconclusive.
    """

    loaded: LoadedSpec
    design: ControllerDesign | None
    coordinates: str | None
    certification: Certification
    certificate: Certificate | None


@contextmanager
def _placed(loaded: LoadedSpec) -> Iterator[None]:
    """Add the spec's path to errors from stages that know the spec but not its file."""
    try:
        yield
    except NrsDesignError as error:
        error.path = error.path or loaded.path
        raise


def run_robot(path: Path) -> tuple[LoadedSpec, RobotSpec, Robot]:
    """Read a robot spec and build the robot.

    Raises
    ------
    SpecError
        If the file is wrong.
    DesignError
        If it describes something else than a robot.
    """
    from nrs_design.models.robot import build_robot

    loaded = read_spec(path)
    if not isinstance(loaded.spec, RobotSpec):
        raise DesignError(
            f"a {loaded.spec.kind} spec describes no robot",
            path=path,
            remedy="name a spec of kind robot; `nrs-design init robot` writes one",
        )
    return loaded, loaded.spec, build_robot(loaded.spec)


def run_design(loaded: LoadedSpec) -> ControllerDesign | None:
    """Design the controllers of a spec; None for given matrices.

    Raises
    ------
    DesignError
        If a requirement cannot be met within its bounds, or the spec describes a robot only.
    """
    if isinstance(loaded.spec, RobotSpec):
        raise DesignError(
            "a robot spec has no controllers that are switched, so there is nothing to certify",
            path=loaded.path,
            remedy="use `nrs-design robot check SPEC`, or a spec of kind interaction-design",
        )
    if not isinstance(loaded.spec, InteractionDesignSpec):
        return None
    from nrs_design.design.design import design_controllers

    with _placed(loaded):
        return design_controllers(loaded.spec, build_plant(loaded.spec))


def run_evidence(loaded: LoadedSpec, design: ControllerDesign) -> DesignEvidence:
    """Compute what a design achieves.

    Raises
    ------
    TypeError
        If the spec gives matrices, so that there is no design.
    """
    from nrs_design.design.evidence import examine_design

    if not isinstance(loaded.spec, InteractionDesignSpec):
        raise TypeError("given matrices have no design")
    return examine_design(loaded.spec, build_plant(loaded.spec), design)


def run_certification(
    loaded: LoadedSpec,
    *,
    method: Method | None = None,
    coordinates: str | None = None,
    optimize_rate: bool = True,
    progress: Progress = _silent,
) -> Result:
    """Take a spec all the way to a verdict.

    Parameters
    ----------
    loaded : LoadedSpec
        As `nrs_design.spec.read_spec` gives it.
    method : Method, optional
        Search method; all of them in turn by default.
    coordinates : {"deflection", "force"}, optional
        Overrides what the spec says.
    optimize_rate : bool
        Look for the largest provable decay rate.
    progress : callable
        Told the name of each step.

    Raises
    ------
    DesignError, AssemblyError
        If the spec has no design, or its modes make no switched system.
    """
    from nrs_design.certificates.certify import Method as Methods
    from nrs_design.certificates.certify import certify

    progress("design")
    design = run_design(loaded)
    if isinstance(loaded.spec, InteractionDesignSpec):
        coordinates = coordinates or loaded.spec.coordinates
    gains = gains_of(design) if design else {}
    with _placed(loaded):
        system = assemble(loaded.spec, gains, coordinates)
    certification = certify(
        system, method or Methods.AUTO, optimize_rate=optimize_rate, progress=progress
    )
    certificate = (
        Certificate(
            spec_name=loaded.spec.name,
            spec_sha256=loaded.sha256,
            coordinates=coordinates,
            gains=gains,
            system=system,
            evidence=certification.evidence,
            version=__version__,
        )
        if certification.evidence
        else None
    )
    return Result(loaded, design, coordinates, certification, certificate)
