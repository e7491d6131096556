"""From a verdict and its evidence to the obligations of one spec."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.certificates.bounds import bound_on, bounds_summary
from nrs_design.certificates.certificate import (
    Certificate,
    Verdict,
    deciding,
    refuted_in,
    refutes_in_contact,
)
from nrs_design.certificates.goals import certified_goals
from nrs_design.certificates.units import gain_units
from nrs_design.design.measures import GoalStanding
from nrs_design.errors import DesignError
from nrs_design.gating import rules
from nrs_design.gating.obligations import Caution, Obligation, SpecOutcome, Status
from nrs_design.models.axis import unit
from nrs_design.proof.bounds import lower, upper
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import rate_text
from nrs_design.proof.evidence.growing_sequence import decides
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.spectrum import affordable, is_stable, worst_eigenvalue
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import LoadedSpec, doubt_spec
from nrs_design.spec.edits import Keys, node_at

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline.scenarios import Simulated
    from nrs_design.search.certification import Certification


# A goal that is not judged fails the gate.
_ENDS = {
    GoalStanding.MET: Status.MET,
    GoalStanding.NOT_JUDGED: Status.INCONCLUSIVE,
    GoalStanding.MISSED: Status.MISSED,
}
# Metric and unit of what a scenario may limit.
_PEAKS = {
    "torque": ("peak_torque", "N*m"),
    "deflection": ("peak_depth", "rad"),
    "velocity": ("peak_velocity", "rad/s"),
}


@dataclass(frozen=True)
class Examiner:
    """Makes obligations about one spec, each with its place."""

    loaded: LoadedSpec  # The spec

    def obligation(
        self, rule: rules.Rule, subject: str, status: Status, message: str, keys: Keys
    ) -> Obligation:
        """Return an obligation about the value at some keys of this spec; one line."""
        place = self.loaded.place(*keys)
        return Obligation(
            rule, self.loaded.path, subject, status, message, place.line, place.column
        )

    def keys_of_mode(self, name: str) -> Keys:
        """Return the keys of a given mode, or of the controller of an assembled mode."""
        # Labels have no slash: behind a slash stands the contact, or the corner of a box.
        label, spec = name.partition("/")[0], self.loaded.spec
        modes = [mode.name for mode in spec.modes] if spec.kind == "switched-system" else []
        return ("modes", modes.index(label)) if label in modes else ("controllers", label)

    def keys_of_goal(self, controller: str, key: str) -> Keys:
        """Return the keys of a goal of a controller, or of the same goal of the whole spec."""
        keys: Keys = ("controllers", controller, "goals", key)
        return ("goals", key) if node_at(self.loaded.root, keys) is None else keys

    def caution(self, message: str, *keys: str | int) -> Caution:
        """Return a caution about something in this spec, by the keys that lead there."""
        at = self.loaded.place(*keys)
        return Caution(self.loaded.path, message, at.line, at.column, at=keys)

    def outcome(
        self,
        decided: Certification | Certificate,
        file: Path | None,
        certificate: Certificate | None,
        obligations: Iterable[Obligation],
        cautions: Iterable[Caution],
    ) -> SpecOutcome:
        """Return the outcome of a spec whose switched system was decided.

        File and certificate are what was written or re-checked; None if nothing was shown.
        """
        rate, rate_name = certified_rate(certificate)
        return SpecOutcome(
            path=self.loaded.path,
            obligations=tuple(obligations),
            sha256=self.loaded.sha256,
            verdict=str(decided.verdict),
            refuted_in=decided.refuted_in,
            common_quadratic=str(decided.common_quadratic),
            rate=rate,
            rate_name=rate_name,
            modes=len(decided.system.modes),
            certificate=file,
            certificate_id=None if certificate is None else certificate.id,
            gains={} if certificate is None else certificate.gains,
            units={} if certificate is None else gain_units(certificate),
            bounds=bounds_summary(decided.system, decided.statements),
            cautions=tuple(cautions),
        )

    def stability(
        self, system: SwitchedSystem, statements: Sequence[AbstractEvidence], searched: str
    ) -> tuple[Obligation, ...]:
        """Return NRS101 for every mode, and NRS102 for the system, from checked statements.

        What was searched is for the message of an inconclusive verdict.
        """
        evidence = deciding(system, statements)
        proved = evidence is not None and evidence.shows is Shows.STABILITY
        lasting = {mode.name for mode in system.lasting_modes()}
        modes = tuple(
            self._mode(mode, system, proved=proved, affordable=fits, lasts=mode.name in lasting)
            for mode, fits in affordable(system.modes)
        )
        if evidence is None:
            status = Status.INCONCLUSIVE
            message = f"neither a proof nor a refutation was found ({searched})"
            if (growing := refutes_in_contact(system, statements)) is not None:
                place = refuted_in(system, statements)
                message = f"refuted {place}, which decides nothing where contact may be lost: "
                message += growing.claim(system)
        else:
            status = Status.PROVED if proved else Status.REFUTED
            message = evidence.claim(system)
        return (*modes, self.system(status, message))

    def system(self, status: Status, message: str) -> Obligation:
        """Return NRS102: the verdict on the whole system."""
        return self.obligation(rules.SWITCHING_STABLE, "system", status, message, ("switching",))

    def _mode(
        self, mode: Mode, system: SwitchedSystem, *, proved: bool, affordable: bool, lasts: bool
    ) -> Obligation:
        """Say whether a mode is stable; one with a longest dwell time need not be."""
        name, time = f"mode {mode.name}", system.time
        region = "Hurwitz" if time is Time.CONTINUOUS else "Schur"
        # Staying in a mode is a switching signal: a proof covers it, no need to decide again.
        if (proved and lasts) or (affordable and is_stable(mode.A, time)):
            status, message = Status.PROVED, f"{name} is {region}"
        elif not lasts:
            unstable = f"is not {region}, but it must be left in time"
            message = f"{name} {unstable if affordable else 'must be left in time, stable or not'}"
            status = Status.MET
        elif not affordable:
            status = Status.INCONCLUSIVE
            message = f"the numbers of {name} are too large to decide"
        else:
            status = Status.REFUTED
            eigenvalue = worst_eigenvalue(mode.A, time)
            message = f"{name} is not {region} (eigenvalue about {eigenvalue})"
            if not decides(system, mode.name):
                status = Status.INCONCLUSIVE
                message += f", which is growth {_open_growth(system, mode.name)}"
        keys = self.keys_of_mode(mode.name)
        return self.obligation(rules.MODE_STABLE, mode.name, status, message, keys)

    def nothing_to_certify(self) -> SpecOutcome:
        """Return the outcome of a valid spec that makes no claim about switching."""
        message = f"a valid {self.loaded.spec.kind} spec; it has nothing to certify"
        obligation = self.obligation(rules.SPEC, "spec", Status.MET, message, ("kind",))
        return SpecOutcome(self.loaded.path, (obligation,), self.loaded.sha256, certifiable=False)

    def certificate(self, file: Path, fault: str | None) -> Obligation:
        """Return NRS104 from the outcome of a re-check; None says that the certificate holds."""
        outcome = "holds, checked exactly" if fault is None else f"is rejected: {fault}"
        status, message = _status(fault is None), f"{file.as_posix()} {outcome}"
        return self.obligation(rules.CERTIFICATE_HOLDS, "certificate", status, message, ("name",))

    def no_margins(self, error: DesignError) -> Obligation:
        """Return NRS103 for a design that is unstable at nominal stiffness, so has no margins."""
        message = f"design goal: {error.message}{self._contact_text} (floating point, not a proof)"
        place = ("controllers",)
        return self.obligation(rules.STIFFNESS_RANGE, "controllers", self._missed, message, place)

    @property
    def _missed(self) -> Status:
        """Status of a loop that is unstable in kept contact; open where contact may be lost."""
        return Status.INCONCLUSIVE if self._contact_text else Status.MISSED

    @property
    def _contact_text(self) -> str:
        spec = self.loaded.spec
        losable = spec.kind == "interaction-design" and spec.contact == "losable"
        return ", in kept contact" if losable else ""

    def stiffness_ranges(self, analysis: DesignAnalysis) -> Iterator[Obligation]:
        """Yield NRS103 for every impedance controller."""
        for item in analysis.impedance:
            highest, limit = item.highest_stiffness, item.lowest_limit
            if isnan(limit):
                continue
            is_below = highest < limit
            proportion = (
                ", all parameters in proportion" if item.problem.loop.contact.has_memory else ""
            )
            proportion += "" if is_below else self._contact_text
            verb = "stays below" if is_below else "reaches"
            message = (
                f"design goal: the stiffness of {item.given.environment}, up to {highest:.6g} "
                f"{unit('N*m/rad')}, {verb} the limit {limit:.6g} {unit('N*m/rad')} of controller "
                f"{item.name}{proportion}, "
                "at the worst corner of the other ranges (floating point, not a proof)"
            )
            status, place = Status.MET if is_below else self._missed, ("controllers", item.name)
            yield self.obligation(rules.STIFFNESS_RANGE, item.name, status, message, place)

    def goals(self, analysis: DesignAnalysis) -> Iterator[Obligation]:
        """Yield NRS106 for every goal of every controller."""
        for item in analysis.measured:
            for found in item.judged_goals:
                assert found.goal is not None, "of those that have one"
                measure = found.measure
                reached = f"{found.text} at worst, in {found.where}"
                message = (
                    f"design goal: {measure.title} of controller {item.name} is "
                    f"{found.where if isnan(found.value) else reached}; "
                    f"{measure.goal_text(found.goal)} is wanted ({found.basis})"
                )
                subject = f"{item.name}: {measure.goal}"
                place, status = self.keys_of_goal(item.name, measure.goal), _ENDS[found.standing]
                yield self.obligation(rules.GOAL, subject, status, message, place)

    def certified_goals(self, certificate: Certificate | None) -> Iterator[Obligation]:
        """Yield NRS108 for every goal to be proved."""
        for goal in certified_goals(self.loaded.spec, certificate):
            # The text of the goal `largest` is complete without a number.
            goal_text = "" if goal.wanted == "largest" else f"; {goal.wanted} is wanted"
            status = Status.PROVED if goal.met else Status.INCONCLUSIVE
            subject, said = f"system: {goal.key}", goal.said + goal_text
            yield self.obligation(rules.CERTIFIED_GOAL, subject, status, said, goal.place)

    def scenario(self, name: str, simulated: Simulated) -> Iterator[Obligation]:
        """Yield NRS109 for every limit of a scenario, held against one of its runs."""
        scenario, run = simulated.scenario, simulated.run
        early = "" if run.stopped is None else f", stopped early ({run.stopped})"
        for quantity, limit in scenario.limits.items():
            metric, unit = _PEAKS[quantity]
            peak = float(simulated.metrics[metric])
            is_met = run.stopped is None and peak <= limit
            message = (
                f"simulated: the largest {quantity} of scenario {scenario.name} is "
                f"{upper(Fraction(peak))} {unit}, its limit {limit:.6g} {unit}{early} "
                f"({run.engine} engine, floating point: one run, not a proof)"
            )
            place = ("scenarios", name, "limits", quantity)
            subject = f"{scenario.name}: {quantity}"
            yield self.obligation(rules.SCENARIO_LIMIT, subject, _status(is_met), message, place)

    def no_scenario(self, name: str, error: DesignError) -> Obligation:
        """Return NRS109 for a scenario with limits that cannot be simulated."""
        message = f"simulated: {error.message} (no run, so no limit is met)"
        keys: Keys = ("scenarios", name)
        return self.obligation(rules.SCENARIO_LIMIT, name, Status.MISSED, message, keys)

    def identified(self) -> Iterator[Obligation]:
        """Yield NRS107 for everything whose identification is in doubt."""
        spec = self.loaded.spec
        if spec.kind != "interaction-design":
            return
        for at, item in spec.identified.items():
            if not item.doubts:
                continue
            message = f"the identification of {at[-1]} is in doubt: {'; '.join(item.doubts)}"
            accepted, key = item.accept_doubt is not None, "doubts"
            if accepted:
                key, message = "accept_doubt", f"{message}; accepted because: {item.accept_doubt}"
            yield self.obligation(rules.NOT_DOUBTED, at[-1], _status(accepted), message, (*at, key))

    def contact(self, certificate: Certificate | None) -> Iterator[Caution]:
        """Yield that contact must be kept, where the spec does not say whether it is."""
        spec = self.loaded.spec
        if certificate is None or spec.kind != "interaction-design" or spec.contact is not None:
            return
        evidence = certificate.evidence
        covered = evidence is not None and evidence.covers_lost_contact
        if certificate.verdict == Verdict.PROVED and not covered:
            message = (
                "proved for contact that is kept: its loss is not covered; write `contact: kept` "
                "if it is, or `contact: losable` to insist"
            )
            yield self.caution(message, "kind")

    def limits(self, certificate: Certificate | None) -> Iterator[Caution]:
        """Yield a caution if the proved torque exceeds its limit without a goal for the torque."""
        spec = self.loaded.spec
        if certificate is None or spec.kind != "interaction-design":
            return
        if spec.goals is not None and spec.goals.peak_torque is not None:
            return
        bound = bound_on(certificate.system, certificate.statements, "force")
        limit = None if bound is None else bound.output.limit
        if bound is not None and limit is not None and bound.level > limit:
            unit = bound.output.unit
            message = (
                f"the limit of {lower(limit)} {unit} is not shown to be kept: up to "
                f"{upper(bound.level)} {unit} are proved under all disturbances at once; "
                "`goals: peak_torque` asks for it"
            )
            yield self.caution(message, "limits", "torque")

    def cautions(self, analysis: DesignAnalysis | None) -> Iterator[Caution]:
        """Yield what is doubtful about the spec and its design, worst first."""
        doubts = doubt_spec(self.loaded.spec) if analysis is None else analysis.warnings
        for doubt in doubts:
            yield replace(self.caution(str(doubt), *doubt.at), beyond=doubt.beyond)


def _open_growth(system: SwitchedSystem, mode: str) -> str:
    """Say why growth of a mode leaves open what happens where contact is lost."""
    if system.flights is not None and mode in system.flights.flying:
        return "of free motion, until it comes to the surface"
    return "for which the environment would have to pull"


def _status(is_met: bool) -> Status:
    return Status.MET if is_met else Status.MISSED


def certified_rate(certificate: Certificate | None) -> tuple[str | None, str | None]:
    """Return text and name of the certified rate; None without a proof."""
    if certificate is None or certificate.evidence is None:
        return None, None
    time, rate = certificate.system.time, certificate.evidence.proved_rate(certificate.system)
    if rate is None:
        return None, None
    return rate_text(rate, time), "alpha" if time is Time.CONTINUOUS else "rho"
