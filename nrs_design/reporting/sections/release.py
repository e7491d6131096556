"""Force, deflection and velocity in their units, along a run that looks bad."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.certificates.certificate import Verdict
from nrs_design.pipeline.release import physical_outputs
from nrs_design.proof.system import Time
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.release import Panel, draw_release
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds import page_of
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.release import certified, simulate_release, watched

if TYPE_CHECKING:
    from nrs_design.pipeline import Result
    from nrs_design.search.certification import Certification
    from nrs_design.simulation.norms import Array

_MODES = 24
_TEXT = (
    "The axis is pressed in, at rest, until the stiffest contact pushes back with the largest "
    "torque of the spec, and let go. Of several adversaries, who take at every step the mode after "
    "which force, velocity or the norm of the proof is largest, the run is shown that comes "
    "furthest. It is the worst found, not the worst there is; floating point, no part of the proof."
)
_SAMPLED = (
    " It is shown at the samples, without what the arithmetic rounds; force samples on their way "
    "hold the torque of the start."
)
_ONE_MODE = " Rules forbid to switch at any time, so one mode holds throughout."
_ONE_AXIS = " It is that of one axis on which the others do not act."
_UNPROVED = " Stability is not proved: that this run comes to rest is no sign of it."
_BOUND = (
    "The dashed lines follow from the certificate, from this start, for every switching signal; "
    "they are evaluated in floating point. Where contact is lost, that of the deflection is for "
    "penetration alone."
)
_NO_BOUND = "The certificate bounds none of these in their units."


def release_section(result: Result) -> Section | None:
    """Show a run in physical units; None where the state does not hold the deflection."""
    outputs = physical_outputs(result)
    if outputs is None:
        return None
    Q, rate = _proved(result.certification)
    system = hardest_modes(result.certification.system, Q, _MODES)
    run = simulate_release(system, outputs, Q)
    losable = system.contact is not None
    force, velocity = outputs.shares(run.state, losable=losable)
    penetration = np.eye(system.order)[-1:]
    rows = (outputs.force, penetration, outputs.velocity[None, :])
    bounds = [
        None if Q is None else certified(row, Q, outputs.start, rate, run.time) for row in rows
    ]
    turn = 180 / math.pi
    panels = (
        Panel("Torque [N·m]", force * outputs.largest_force, outputs.largest_force, bounds[0]),
        Panel(
            "Deflection [deg]",
            turn * run.state[:, -1:],
            None,
            _turned(bounds[1]),
            one_sided=losable,
        ),
        Panel(
            "Velocity [deg/s]",
            turn * outputs.largest_velocity * velocity[:, None],
            turn * outputs.largest_velocity,
            _turned(bounds[2]),
        ),
    )
    names = [mode.name for mode in watched(system).modes]
    more = _SAMPLED if system.time is Time.DISCRETE else ""
    more += "" if system.switching.is_arbitrary else _ONE_MODE
    more += _ONE_AXIS if system.couplings else ""
    more += "" if result.certification.verdict is Verdict.PROVED else _UNPROVED
    return Section(
        "Force, deflection and velocity",
        (
            Paragraph(_TEXT + more),
            _table(panels),
            Illustration(
                "release",
                "After being pressed in and let go",
                _NO_BOUND if Q is None else _BOUND,
                draw_release(run, panels, names),
            ),
        ),
    )


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
    return None if values is None else np.asarray(180 / math.pi * values)


def _table(panels: tuple[Panel, ...]) -> Table:
    rows = tuple(
        (
            panel.label,
            number(float(np.abs(panel.values).max())),
            "–" if panel.limit is None else number(panel.limit),
            "–" if panel.bound is None else number(1.001 * float(panel.bound.max())),
        )
        for panel in panels
    )
    columns = ("", "Largest in this run", "Limit of the spec", "Certified from this start")
    return Table("Largest values", columns, rows)
