"""Force, deflection and velocity in their units, along a run that looks bad."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from nrs_design.axis import current, labelled
from nrs_design.certificates.certificate import Verdict
from nrs_design.pipeline.certification import Result
from nrs_design.pipeline.release import physical_outputs
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.evidence import page_of
from nrs_design.reporting.figures.bounded_run import BoundedSignal, draw_bounded_run
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.places import linked
from nrs_design.search.certification import Certification
from nrs_design.simulation.greedy import all_modes
from nrs_design.simulation.norms import Array
from nrs_design.simulation.release import Outputs, certified, simulate_release
from nrs_design.simulation.switched import SwitchedRun
from nrs_design.spec import LoadedSpec

_TITLE = "Force, deflection and velocity"
_MODES = 24
_TEXT = (
    "The axis is pressed in, at rest, until the stiffest contact pushes back with the largest "
    "torque of the spec, and let go. An adversary takes at every step the mode after which the "
    "norm of the proof is largest, or the velocity where none is proved. It is a bad run, not the "
    "worst there is; floating point, no part of the proof."
)
_SAMPLED = (
    "It is shown at the samples, without what the arithmetic rounds; force samples on their way "
    "hold the torque of the start."
)
_REMEMBERED = "Tissue with a memory is pressed in at once, before it relaxes."
_FOLLOWED = (
    "At the start, the commanded position jumps to the surface and the commanded force to zero; an "
    "operator would not command such jumps."
)
_TURNS = "Force samples and admittances take turns with the motion loop as the spec says."
_MISSES = "The adversary also chooses which deadlines are missed, as the rule of the spec allows."
_ANYWHERE = "Contact may be lost at any deflection; there is no torque then."
_NO_DEFLECTION = (
    "The deflection is no state: this tissue has no rest position, and its force follows from the "
    "stretch of its spring."
)
_ONE_MODE = "Rules forbid to switch at any time, so one mode holds throughout."
_LINEAR = "Nothing is cut off at a limit in it, whatever saturates on the robot."
_UNPROVED = "Stability is not proved: that this run comes to rest is no sign of it."
_BOUND = (
    "The dashed lines follow from the certificate, from this start, for every switching signal; "
    "they are evaluated in floating point. Where contact is lost, that of the deflection is for "
    "penetration alone."
)
_NO_BOUND = "From this kind of certificate, no bound in these units is evaluated here."
_NOTHING_PROVED = "Nothing is proved that would bound these."


def release_section(result: Result) -> Section | None:
    """Show a run in physical units, or say why not; None for given matrices."""
    outputs = physical_outputs(result)
    if outputs is None:
        return None
    if isinstance(outputs, str):
        return Section(_TITLE, (Paragraph(f"No run is shown in these units: {outputs}."),))
    Q, rate = _proved(result.certification)
    whole = result.certification.system
    # Modes that take turns are all needed, and where each has its row, they keep their places.
    few = whole.clock is None and len(outputs.velocity) == 1 and not outputs.free
    system = hardest_modes(whole, Q, _MODES) if few else whole
    run = simulate_release(system, outputs, Q)
    panels = _panels(result.loaded, system, outputs, run, Q, rate)
    names = [mode.name for mode in all_modes(system).modes]
    drawn = tuple(panel for panel, _ in panels)
    return Section(
        _TITLE,
        (
            Paragraph(_said(result, system, outputs)),
            _table(panels),
            Illustration(
                "release",
                "After being pressed in and let go",
                _bound_text(result.certification, Q),
                draw_bounded_run(run, drawn, names),
            ),
        ),
    )


def _said(result: Result, system: SwitchedSystem, outputs: Outputs) -> str:
    """Say where the run begins, what the adversary chooses, and what the run leaves out."""
    designed = result.designed
    assert designed is not None
    contacts = designed.plant.among(designed.design.contacts)
    position = any(c.law.commands == "position" for c in designed.design.controllers)
    texts = (
        (_TEXT, True),
        (_REMEMBERED, any(environment.law.remembers for environment in contacts)),
        (_FOLLOWED, position),
        (_SAMPLED, system.time is Time.DISCRETE),
        (_TURNS, system.clock is not None and system.clock.is_round),
        (_MISSES, system.clock is not None and not system.clock.is_round),
        (_ONE_MODE, not system.switching.is_arbitrary),
        (_ANYWHERE, bool(outputs.free)),
        (_NO_DEFLECTION, outputs.deflection is None),
        (_LINEAR, True),
        (_UNPROVED, result.certification.verdict is not Verdict.PROVED),
    )
    return " ".join(text for text, applies in texts if applies)


def _bound_text(certification: Certification, Q: Array | None) -> str:
    if Q is not None:
        return _BOUND
    return _NO_BOUND if certification.verdict is Verdict.PROVED else _NOTHING_PROVED


def _panels(
    loaded: LoadedSpec,
    system: SwitchedSystem,
    outputs: Outputs,
    run: SwitchedRun,
    Q: Array | None,
    rate: float,
) -> list[tuple[BoundedSignal, str]]:
    """Return the panels, each with its limit as text for the table."""
    losable = system.contact is not None
    force, velocity = outputs.shares(run, losable=losable)

    def bound(rows: Array) -> Array | None:
        return None if Q is None else certified(rows, Q, outputs.start, rate, run.time)

    def limit(value: float, key: str) -> str:
        return linked(loaded, number(value), "limits", key)

    torque, turn = outputs.largest_force, current().fine
    fastest = turn * outputs.largest_velocity
    panels = [
        (
            BoundedSignal(labelled("Torque [N·m]"), force * torque, torque, bound(outputs.force)),
            limit(torque, "torque"),
        )
    ]
    if outputs.deflection is not None:
        values = turn * (run.state @ outputs.deflection)[:, None]
        edge = _turned(bound(outputs.deflection[None, :]))
        panels.append(
            (
                BoundedSignal(labelled("Deflection [deg]"), values, None, edge, one_sided=losable),
                "–",
            )
        )
    speed = BoundedSignal(
        labelled("Velocity [deg/s]"),
        fastest * velocity[:, None],
        fastest,
        _turned(bound(outputs.velocity)),
    )
    return [*panels, (speed, limit(fastest, "velocity"))]


def _proved(certification: Certification) -> tuple[Array | None, float]:
    evidence = certification.evidence
    found = None if evidence is None else page_of(certification.system, evidence).quadratic()
    if found is None:
        return None, 0.0
    Q, rate = found
    system = certification.system
    if system.time is Time.DISCRETE:
        # The factor of a step, as a rate in 1/s.
        rate = -math.log(rate) / float(system.sample_time or 1)
    return Q, rate


def _turned(values: Array | None) -> Array | None:
    return None if values is None else np.asarray(current().fine * values)


def _table(panels: Sequence[tuple[BoundedSignal, str]]) -> Table:
    rows = tuple(
        (
            panel.label,
            number(float(np.abs(panel.values).max())),
            limit,
            "–" if panel.bound is None else number(1.001 * float(panel.bound.max())),
        )
        for panel, limit in panels
    )
    columns = ("", "Largest in this run", "Limit of the spec", "Certified from this start")
    return Table("Largest values", columns, rows)
