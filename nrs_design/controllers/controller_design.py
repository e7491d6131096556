"""The result of design: every gain of one robot axis, and where each controller acts."""

from __future__ import annotations

from dataclasses import dataclass

from nrs_design.controllers.laws import Law, ProportionalDerivative


@dataclass(frozen=True, slots=True)
class Controller:
    """One compliant controller.

    Parameters
    ----------
    name : str
        As in the spec.
    law : Law
        Its law with the gains that ship.
    environment : str or None
        The environment that it was designed for.
    contacts : tuple of str
        The environments that it may touch while it is active; empty for position control.
    """

    name: str
    law: Law
    environment: str | None
    contacts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ControllerDesign:
    """All gains of one axis.

    Parameters
    ----------
    motion : ProportionalDerivative
        The motion controller below the compliant ones.
    controllers : tuple of Controller
        In the order of the spec.
    """

    motion: ProportionalDerivative
    controllers: tuple[Controller, ...]
