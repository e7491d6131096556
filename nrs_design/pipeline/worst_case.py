"""From a design to the worst runs that an adversary finds, beside limits and certified bounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Certificate
from nrs_design.errors import AssemblyError, DesignError
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.design import Designed, placed
from nrs_design.progress import Progress, silent

if TYPE_CHECKING:
    from nrs_design.proof.system import SwitchedSystem
    from nrs_design.simulation.worst_case import WorstRun

_REMEDY = "use `simulate` without --worst-case, with a scenario for each controller"


@dataclass(frozen=True, slots=True)
class WorstCase:
    """The worst runs that an adversary found, beside limits and certified bounds."""

    system: SwitchedSystem  # That he played against
    runs: tuple[WorstRun, ...]  # One for each quantity: force, velocity and deflection
    limits: Mapping[str, float]  # Of these quantities, as far as the spec has any; SI
    bounds: Mapping[str, float]  # Not below what is certified; SI
    # Whether the spec says what disturbs; otherwise it is any command up to its limit.
    declared: bool


def run_worst_case(
    designed: Designed,
    certificate: Certificate | None = None,
    progress: Progress = silent,
) -> WorstCase:
    """Let an adversary choose everything that the spec leaves open, and keep the worst runs.

    The bounds of a checked certificate are held against them. What acts on the loop and is not
    modelled is a `DesignError`.
    """
    from nrs_design.simulation.worst_case import worst_runs
    from nrs_design.simulation.worst_outputs import certified_bounds, deflection_of, forces_by_mode

    spec = designed.spec
    progress("adversary")
    try:
        system = _commanded(designed)
        deflection = deflection_of(system)
        outputs = (*system.outputs, *(() if deflection is None else (deflection,)))
        touched = designed.plant.among(designed.design.contacts)
        allowed = {"force": forces_by_mode(system, touched)}
        runs = worst_runs(system, outputs, allowed)
    except (AssemblyError, ValueError) as error:
        message = error.message if isinstance(error, AssemblyError) else str(error)
        with placed(designed.loaded):
            raise DesignError(
                f"no worst case is searched for this spec: {message}",
                remedy=_REMEDY,
                at=("controllers",),
            ) from error
    return WorstCase(
        system,
        runs,
        {o.name: float(o.limit) for o in system.outputs if o.limit is not None}
        | {"force": spec.limits.torque.si, "velocity": spec.limits.velocity.si},
        {} if certificate is None else certified_bounds(certificate.system, certificate.statements),
        spec.disturbances is not None,
    )


def _commanded(designed: Designed) -> SwitchedSystem:
    """Return the loop under what the spec says disturbs it, else under any allowed command."""
    from nrs_design.spec.sampling import DisturbancesSpec

    spec = designed.spec
    placing = next((name for name, c in spec.controllers.items() if c.commands == "position"), None)
    if placing is not None:
        raise AssemblyError(
            f"{placing} is given a position, and a command that is held moves that on without "
            "end, so the force from rest grows as long as the run"
        )
    if spec.disturbances is not None:
        return assemble_spec(designed.loaded, designed)
    text = {"command": spec.limits.velocity.text}
    disturbances = DisturbancesSpec.model_validate(text)
    spec = spec.model_copy(update={"disturbances": disturbances})
    if spec.sampling is not None:
        return assemble_spec(designed.loaded, replace(designed, spec=spec))
    # In continuous time a run may be on tissue for which no bound is stated.
    from nrs_design.loop.assemble import state_of
    from nrs_design.loop.commanded import with_command
    from nrs_design.spec.build_plant import build_conditions

    conditions = build_conditions(spec)
    state = state_of(conditions, designed.plant, designed.design)
    system = assemble_spec(designed.loaded, designed)
    return with_command(system, state, disturbances.bounds(), conditions.torque)
