"""The units of the gains that a certificate lists."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.errors import CertificateError
from nrs_design.proof.text import quoted

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate


def gain_units(certificate: Certificate) -> dict[str, dict[str, str]]:
    """Return the unit of every gain, by controller; the motor's follows from what is assumed."""
    if not certificate.gains:
        return {}
    # Controllers are slow to load; a certificate of given matrices needs no controllers.
    from nrs_design.controllers.controller_design import units_of
    from nrs_design.loop.assumptions import find_command_unit
    from nrs_design.models.axis import COMMAND_UNITS, find_axis

    system = certificate.system
    command = find_command_unit(system.assumptions)
    if command not in COMMAND_UNITS:
        raise CertificateError(f"it has commands in {quoted(command)}, which no motor takes")
    return units_of(certificate.gains, command, find_axis(system.states))
