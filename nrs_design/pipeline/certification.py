"""From a spec to a verdict: the switched system, the search, the certificate."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design import __version__
from nrs_design.certificates.certificate import Certificate, Gains, Verdict, common_quadratic_of
from nrs_design.errors import AssemblyError, DesignError
from nrs_design.pipeline.design import Designed, for_goal, placed
from nrs_design.progress import Progress, silent
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Attempt, Certification, Limits
from nrs_design.search.method import Method
from nrs_design.search.work import GIGABYTE
from nrs_design.spec import LoadedSpec

if TYPE_CHECKING:
    from nrs_design.certificates.verify import Verification
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.proof.evidence import AbstractEvidence
    from nrs_design.spec import Spec


@dataclass(frozen=True, slots=True)
class Result:
    """Spec, design and certificate."""

    loaded: LoadedSpec  # The spec and where it came from
    designed: Designed | None  # The plant and the gains that ship; None for given matrices
    certification: Certification  # The verdict with every attempt
    certificate: Certificate | None  # None without statements

    @property
    def design(self) -> ControllerDesign | None:
        """The gains that ship; None for given matrices."""
        return None if self.designed is None else self.designed.design

    @property
    def briefs(self) -> tuple[tuple[AbstractEvidence, str], ...]:
        """Every statement with what it shows, in a few words."""
        from nrs_design.certificates.brief import brief

        environments = () if self.designed is None else self.designed.spec.environments.values()
        given = (environment.lever_arm for environment in environments)
        # The force is largest at the shortest arm.
        arm = min((length.exact for length in given if length is not None), default=None)
        system, statements = self.certification.system, self.certification.statements
        return tuple((statement, brief(statement, system, arm)) for statement in statements)

    @property
    def omits(self) -> tuple[str, ...]:
        """Effects outside the model, in a few words each."""
        from nrs_design.certificates.catalogue import omitted

        return omitted(self.certification.granted)


@dataclass(frozen=True, slots=True)
class Overrides:
    """Limits of the search from a command; None keeps those of the spec."""

    max_degree: int | None = None  # Highest degree of a polynomial function
    budget: float | None = None  # Work, in units
    memory: float | None = None  # In GB


def search_limits(
    spec: Spec, overrides: Overrides | None = None, optimize_rate: bool = True
) -> Limits:
    """Return the limits of the search, from defaults, spec and command."""
    limits, options = Limits(optimize_rate=optimize_rate), overrides or Overrides()
    section = None if spec.kind == "robot" else spec.certification
    for source in (section, options):
        if source is not None and source.max_degree is not None:
            limits = replace(limits, max_degree=source.max_degree)
        if source is not None and source.budget is not None:
            limits = replace(limits, budget=float(source.budget))
    if options.memory is not None:
        limits = replace(limits, memory=options.memory * GIGABYTE)
    goals = spec.goals if spec.kind == "interaction-design" else None
    if goals is not None and goals.decay_rate is not None:
        limits = replace(limits, decay_rate=goals.decay_rate.exact)
    return limits


def certify_design(
    loaded: LoadedSpec,
    designed: Designed | None,
    *,
    method: Method = Method.AUTO,
    limits: Limits | None = None,
    progress: Progress = silent,
) -> Result:
    """Take a design to a verdict; method and limits are by default as its spec says.

    Where the goal `delay` asks for an older force than the spec declares, that is proved of it, if
    all goals that gains are chosen by are met then; it holds of the younger one.
    """
    from nrs_design.search.certify import certify

    limits = limits or search_limits(loaded.spec)

    def certified(designed: Designed | None) -> Certification:
        with placed(loaded):
            system = assemble_spec(loaded, designed)
        return certify(system, method, limits, progress)

    older: tuple[Attempt, ...] = ()
    try:
        wide = None if designed is None else for_goal(designed)
        if designed is not None and wide is not None:
            found = certified(wide)
            if (result := _find_older(designed, wide, found)) is not None:
                return result
            older = tuple(replace(a, step=f"{a.step}, older force") for a in found.attempts)
    except (DesignError, AssemblyError):
        pass  # Outside the model there is no proof.
    found, points = certified(designed), ""
    if found.is_open and designed is not None and designed.spec.sampling is not None:
        points, found = _refute_at_points(designed, found, limits, progress)
    found = replace(found, attempts=(*older, *found.attempts))
    return Result(loaded, designed, found, certificate_of(loaded, designed, found, points))


def _refute_at_points(
    designed: Designed, certification: Certification, limits: Limits, progress: Progress
) -> tuple[str, Certification]:
    """Look for growth at points of the ranges, which their enclosure does not refute."""
    from nrs_design.loop.assemble import POINTS, assemble
    from nrs_design.search.certify import certify

    limits = replace(limits, budget=limits.budget / 4)
    for points in POINTS:
        with placed(designed.loaded):
            system = assemble(designed.spec, designed.plant, designed.design, points=points)
        if system.modes == certification.system.modes:
            continue
        found = certify(system, Method.PERIOD, limits, progress)
        attempts = tuple(replace(a, step=f"{a.step}, at {points}") for a in found.attempts)
        certification = replace(certification, attempts=(*certification.attempts, *attempts))
        if found.verdict is Verdict.REFUTED or found.refuted_in is not None:
            return points, replace(found, attempts=certification.attempts)
    return "", certification


def _find_older(designed: Designed, wide: Designed, certification: Certification) -> Result | None:
    """Return the result for an older force, or None if it misses a goal."""
    assert wide.spec.sampling is not None, "a delay is of samples"
    good = tuple(item for item in certification.statements if item.shows.is_good)
    status = common_quadratic_of(certification.system, good)
    certification = replace(certification, statements=good, common_quadratic=status)
    certificate = certificate_of(designed.loaded, designed, certification)
    if certificate is None:
        return None
    certificate = replace(certificate, ages=wide.spec.sampling.delay)
    result = Result(designed.loaded, designed, certification, certificate)
    return result if meets_goals(result) else None


def meets_goals(result: Result) -> bool:
    """Tell whether a spec is proved, with the goals that gains are chosen by."""
    from nrs_design.certificates.goals import certified_goals
    from nrs_design.controllers.gains import STEERING

    goals = certified_goals(result.loaded.spec, result.certificate)
    proved = result.certification.verdict is Verdict.PROVED
    return proved and all(goal.met for goal in goals if goal.key in STEERING)


def certificate_of(
    loaded: LoadedSpec, designed: Designed | None, certification: Certification, points: str = ""
) -> Certificate | None:
    """Return the certificate; None without statements."""
    if not certification.statements:
        return None
    return Certificate(
        spec_name=loaded.spec.name,
        spec_sha256=loaded.sha256,
        coordinates=None if designed is None else designed.spec.coordinates,
        gains=gains_text(designed),
        system=certification.system,
        statements=certification.statements,
        version=__version__,
        points=points,
    )


def recorded_certification(
    certificate: Certificate, file: Path, seconds: float = 0.0
) -> Certification:
    """Return a checked certificate as the result of a search."""
    from nrs_design.certificates.certificate import verdict_of
    from nrs_design.search.family import floats_in_silence, rate_limit

    outcome = f"{file.name}: each of its statements was checked again exactly"
    with floats_in_silence():
        limit = rate_limit(certificate.system)
    return Certification(
        certificate.system,
        verdict_of(certificate.system, certificate.statements),
        certificate.common_quadratic,
        "certificate",
        certificate.statements,
        (Attempt("certificate", outcome, seconds),),
        limit,
    )


def gains_text(designed: Designed | None) -> Gains:
    """Return the gains that ship as exact decimals, by controller; none of given matrices."""
    if designed is None:
        return {}
    from nrs_design.controllers.gains import gains_of

    return gains_of(designed.design)


def is_of_gains(gains: Gains, designed: Designed | None) -> bool:
    """Tell whether gains, such as those of a certificate, are those that a design ships."""
    return {name: dict(values) for name, values in gains.items()} == gains_text(designed)


def assemble_spec(
    loaded: LoadedSpec, designed: Designed | None, scale: Fraction = Fraction(1)
) -> SwitchedSystem:
    """Assemble either kind of spec, with its ranges stretched by a scale."""
    from nrs_design.loop.assemble import assemble, assemble_matrices

    if designed is not None:
        return assemble(designed.spec, designed.plant, designed.design, scale)
    # A robot has no design either, but no way here.
    assert loaded.spec.kind == "switched-system"
    return assemble_matrices(loaded.spec, scale)


def run_verification(file: Path, result: Result) -> Verification:
    """Re-check a certificate file against the spec of a result, whose plant is in hand.

    What cannot be read as a certificate at all is a `CertificateError`.
    """
    from nrs_design.certificates.verify import verify

    plant = None if result.designed is None else result.designed.plant
    return verify(file, result.loaded, plant=plant)


def find_relief(result: Result) -> tuple[str, ...]:
    """Return advice on gains for a refuted design with too stiff contacts.

    It may be refuted in kept contact alone.
    """
    designed = result.designed
    certification = result.certification
    refuted = certification.verdict is Verdict.REFUTED or certification.refuted_in is not None
    if designed is None or not refuted:
        return ()
    from nrs_design.design.analysis import too_stiff

    return tuple(map(str, too_stiff(designed.spec, designed.plant, designed.design)))
