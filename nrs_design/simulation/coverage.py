"""Events of a run that a certified bound does not cover."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from nrs_design.proof.evidence.abstract import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.build_scenario import logic_control
from nrs_design.simulation.run import Run
from nrs_design.simulation.scenario import Errors, Scenario
from nrs_design.spec import InteractionDesignSpec

# The same number after a conversion may be a rounding above.
_ROUNDING = 1 + 1e-12


@dataclass(frozen=True, slots=True)
class Coverage:
    """A checked statement about the system of a spec, and a run of a scenario."""

    spec: InteractionDesignSpec
    system: SwitchedSystem
    statement: AbstractEvidence
    scenario: Scenario
    run: Run

    def uncovered(self) -> Iterator[str]:
        """Yield the events of the run that a bound does not cover."""
        scenario, run = self.scenario, self.run
        bound = self.statement.bound(self.system)
        assert bound is not None
        limits = {channel.name: float(channel.bound) for channel in bound.channels}
        errors = scenario.errors
        acting = {
            "velocity command": _largest_command(scenario, run),
            "friction": errors.friction,
            "encoder error": errors.encoder_step / 2,
            "force error": errors.force_step / 2,
        }
        for name, size in acting.items():
            if size > limits.get(name, 0.0) * _ROUNDING:
                yield f"the {name} exceeds the bound of the proof"
        if errors.friction:
            yield "friction may change its sign within a period"
        angles = None if self.spec.disturbances is None else self.spec.disturbances.largest_angle
        signals = (name for name in ("angle", "reference") if name in run.response.signals)
        if angles is not None and any(abs(run.response[n]).max() > angles.si for n in signals):
            yield "the angle exceeds the bound of the proof"
        if errors.force_noise:
            yield "the noise of the torque has no bound"
        if errors.jitter:
            yield "samples are late, and the proof takes none for late"
        yield from self._sampling()
        yield from self._differences()

    def undecayed(self) -> Iterator[str]:
        """Yield why a certified rate does not cover the end of the run."""
        if end_of_command(self.scenario) is None:
            yield "the command does not come to an end before the run does"
        if self.scenario.errors != Errors():
            yield "friction, resolutions, noise or jitter go on acting"
        if self.run.engine != "exact":
            yield "the rounding of angle and reference goes on acting"
        yield from self._sampling()
        yield from self._differences()

    def _differences(self) -> Iterator[str]:
        """Yield how the run differs from every run that the proof covers."""
        spec, run, statement = self.spec, self.run, self.statement
        angles = None if spec.disturbances is None else spec.disturbances.largest_angle
        if any(controller.commands != "velocity" for controller in spec.controllers.values()):
            yield "the run is not one of impedance control alone"
        if run.engine != "exact" and (angles is None or not statement.covers_rounding):
            yield "the law is rounded to single precision, and the proof does not take up all of it"
        if run.saturated:
            yield "the motor's command met its limit, and the proof knows none"
        if run.refused:
            yield "the law refused samples, and the proof knows no such step"
        if self.system.contact is None or not statement.covers_lost_contact:
            # Each run begins in free motion.
            yield "the run makes or loses contact, and the proof assumes constant contact"
        yield from self._surroundings()
        control = self.scenario.control
        # A run without switches breaks one rule only: a longest dwell time.
        left = spec.switching.longest_dwell_time is not None
        changes = bool(control.switches or control.schedule)
        ruled = not spec.switching.is_arbitrary and (changes or left)
        if ruled and (spec.mode_logic is None or control != logic_control(spec)):
            yield "nothing makes the run keep the rules of switching"

    def _sampling(self) -> Iterator[str]:
        """Yield a reason if period or delay differ from the proof."""
        sampling, run = self.spec.sampling, self.run
        if sampling is None or run.sampling is None:
            if run.sampling is not None or sampling is not None:
                yield f"the proof is not about the {run.engine} loop"
            return
        period, youngest, oldest = run.sampling
        shortest, longest = sampling.delay
        equal_periods = period == float(sampling.period.exact) and run.outer == float(
            sampling.outer
        )
        if not equal_periods or youngest < shortest or oldest > longest:
            yield "period or delay are not those of the proof"

    def _surroundings(self) -> Iterator[str]:
        """Yield how the surfaces of the run differ from those of the proof."""
        if len(self.scenario.surfaces) > 1:
            yield "there are several surfaces, and the proof is about one"
        for surface in self.scenario.surfaces:
            name = surface.environment
            if surface.element is None:
                yield f"{name} is nonlinear, and the proof is about a box of linear ones"
            if any(name not in c.contacts for c in self.spec.controllers.values()):
                yield f"{name} is no contact of every controller"


def end_of_command(scenario: Scenario) -> float | None:
    """Return the time in s after which the command is zero; None if the run ends before."""
    profile, start = scenario.profile, None
    for piece in reversed(profile.pieces):
        if piece.value or piece.slope or profile.mean:
            break
        start = piece.start
    return None if start is None or start >= scenario.duration else start


def _largest_command(scenario: Scenario, run: Run) -> float:
    """Return the largest command; a sinusoid may have its peak between two instants."""
    profile = scenario.profile
    peak = float(abs(run.response["hand"]).max())
    if not profile.omega:
        return peak
    (piece,) = profile.pieces
    return max(peak, abs(profile.mean) + abs(piece.slope / profile.omega))
