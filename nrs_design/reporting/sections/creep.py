"""Lasting errors of the force signal, and the creep that they cause."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.axis import AxisType, current, labelled
from nrs_design.controllers.sensor import Sensor
from nrs_design.proof.bounds import upper
from nrs_design.reporting.document import Bullets, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis, ImpedanceAnalysis
    from nrs_design.pipeline import Designed
    from nrs_design.spec import LoadedSpec

_MEANING = (
    "An admittance without a spring integrates a lasting error F0 of the force: in free motion the "
    "robot creeps at F0/Bt. A spring Kt ends that at the angle F0/Kt.",
    "The bounds are exact numbers rounded up, for a constant error, at the worst gains of their "
    "ranges. A force beyond F0 overcomes the creep; in contact, F0 shifts the point of rest.",
    "Noise has no bound: the standard deviation of the velocity of the admittance is shown, for "
    "white noise in continuous time, in floating point.",
)
# Above 180/pi.
_DEGREES = Fraction("57.29577951308232088")


def creep_section(designed: Designed, analysis: DesignAnalysis) -> Section | None:
    """Show the errors of the force signal and the creep, where the spec says how large they are."""
    items = [item for item in analysis.impedance if item.creep is not None]
    if not items:
        return None
    sensor = designed.design.sensor
    share = designed.spec.limits.velocity.si
    columns = (
        "Controller",
        labelled("Creep, at most [deg/s]"),
        "Part of the largest command [%]",
        labelled("Way, at most [deg]"),
        labelled("Noise of the velocity, rms [deg/s]"),
    )
    rows = tuple(
        tuple(linked(designed.loaded, cell, "controllers", item.name) for cell in _row(item, share))
        for item in items
    )
    blocks = (
        _errors(designed.loaded, sensor),
        Table("Creep in free motion", columns, rows),
        Bullets("", _MEANING),
    )
    return Section("Force signal and creep", blocks)


def _errors(loaded: LoadedSpec, sensor: Sensor) -> Table:
    columns: tuple[str, ...] = ("What lasts", labelled("Torque about the pivot, at most [N·m]"))
    if sensor.arm:
        columns = (*columns, "As a force at the contact point [N]")
    errors = {**sensor.errors, "together, F0": sensor.lasting}
    rows = tuple(
        (
            name,
            *(
                linked(loaded, upper(e / arm, 4), "sensor")
                for arm in (1, *((sensor.arm,) if sensor.arm else ()))
            ),
        )
        for name, e in errors.items()
    )
    return Table("Errors of the force signal", columns, rows)


def _row(item: ImpedanceAnalysis, largest: float) -> tuple[str, ...]:
    creep = item.creep
    assert creep is not None
    fine = _DEGREES if current() is AxisType.ROTARY else Fraction(1000)
    angle = "grows as long as it lasts" if creep.angle is None else upper(creep.angle * fine, 4)
    part = 100 * float(creep.velocity) / largest
    noise = "–" if creep.noise is None else number(current().fine * creep.noise, 3)
    return (item.name, upper(creep.velocity * fine, 4), number(part, 3), angle, noise)
