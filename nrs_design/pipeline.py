"""The one file that knows every stage: spec, plant, design, switched system, certificate."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design import __version__
from nrs_design.certificates.certificate import Certificate, Gains, Verdict
from nrs_design.errors import AssemblyError, DesignError, NrsDesignError
from nrs_design.proof.bounds import nearly
from nrs_design.proof.noun import dataclass
from nrs_design.proof.system import SwitchedSystem, Time
from nrs_design.search.allowance import GIGABYTE
from nrs_design.search.certification import Certification, Limits
from nrs_design.search.method import Method
from nrs_design.spec import LoadedSpec, read_spec

if TYPE_CHECKING:
    from nrs_design.certificates.verify import Verification
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.controllers.operations import StepLaw
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.models.plant import Plant
    from nrs_design.models.robot import Robot
    from nrs_design.search.loop_margin import Bracket, CommandMargin, LoopMargins
    from nrs_design.search.margin import BoxMargin, DwellMargin
    from nrs_design.search.method_run import MethodRun
    from nrs_design.simulation.release import Outputs
    from nrs_design.simulation.run import Run
    from nrs_design.simulation.scenario import Scenario
    from nrs_design.spec import InteractionDesignSpec, RobotSpec, Spec
    from nrs_design.spec.sampling import SamplingSpec

Progress = Callable[[str], None]

# Seconds for each of the boxes that a search for the largest one tries.
MARGIN_BUDGET = 10.0


def _silent(step: str) -> None:
    """Report no progress."""


@dataclass(frozen=True, slots=True)
class Designed:
    """An interaction design with all that follows from its spec alone.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec and where it came from.
    spec : InteractionDesignSpec
        What it says.
    plant : Plant
        That it describes; the later stages take this one.
    design : ControllerDesign
        The gains that ship.
    """

    loaded: LoadedSpec
    spec: InteractionDesignSpec
    plant: Plant
    design: ControllerDesign


@dataclass(frozen=True, slots=True)
class Result:
    """One spec, all the way through.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec and where it came from.
    designed : Designed or None
        The plant and the gains that ship; None for given matrices.
    coordinates : str or None
        Of the assembled modes; None for given matrices.
    certification : Certification
        The verdict with every attempt.
    certificate : Certificate or None
        What may be written to a file; None if nothing was shown.
    """

    loaded: LoadedSpec
    designed: Designed | None
    coordinates: str | None
    certification: Certification
    certificate: Certificate | None

    @property
    def design(self) -> ControllerDesign | None:
        """The gains that ship; None for given matrices."""
        return None if self.designed is None else self.designed.design


@dataclass(frozen=True, slots=True)
class Simulated:
    """A scenario that has been simulated.

    Parameters
    ----------
    scenario : Scenario
        In SI.
    run : Run
        As far as it came.
    metrics : mapping
        Of the run, in SI.
    """

    scenario: Scenario
    run: Run
    metrics: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class CertifiedBound:
    """A certified bound beside a run.

    Parameters
    ----------
    output, unit : str
        What is bounded.
    level : float
        Not below what is proved.
    uncovered : tuple of str
        What happens in the run that the proof says nothing about; empty if the bound holds for it.
    """

    output: str
    unit: str
    level: float
    uncovered: tuple[str, ...]


@contextmanager
def placed(loaded: LoadedSpec) -> Iterator[None]:
    """Add path, line and column to errors from stages that know the spec but not its file."""
    try:
        yield
    except NrsDesignError as error:
        if error.path is None and error.at:
            place = loaded.place(*error.at)
            error.line, error.column = place.line, place.column
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
    if loaded.spec.kind != "robot":
        raise wrong_kind(
            loaded,
            f"a spec of kind {loaded.spec.kind} describes no robot",
            "name a spec of kind robot; `nrs-design init robot` writes one",
        )
    with placed(loaded):
        return loaded, loaded.spec, build_robot(loaded.spec)


def run_robot_laws(spec: RobotSpec, robot: Robot) -> dict[str, StepLaw]:
    """Design the motion control of a robot, and write its laws out as operations.

    Raises
    ------
    DesignError
        If the spec lacks something, or its numbers contradict each other.
    PoseError
        If the robot does not reach the motions that the table of corrections is made for.
    """
    from nrs_design.design.robot_laws import design_robot_laws

    return design_robot_laws(spec, robot)


def check_bounds(
    path: Path, budget: float, progress: Progress = _silent
) -> tuple[Path, tuple[str, ...]]:
    """Compute again what the bounds of a robot claim.

    Parameters
    ----------
    path : Path
        The spec of the robot.
    budget : float
        Time for each of the bounds in s.
    progress : callable
        Told the name of each step.

    Returns
    -------
    Path
        The file of the bounds.
    tuple of str
        What is wrong with them; nothing if they hold.

    Raises
    ------
    SpecError
        If the robot, or the file of its bounds, cannot be read.
    DesignError
        If the time was over before something was decided.
    """
    from nrs_design.models.robot import confirm_bounds
    from nrs_design.spec.robot_bounds import bounds_file, read_bounds

    loaded, _, robot = run_robot(path)
    file = bounds_file(path)
    bounds, document = read_bounds(file)
    if bounds.sha256 != loaded.sha256:
        return file, ("the robot has changed since its bounds were computed",)
    with placed(loaded):
        return file, tuple(confirm_bounds(robot, document, budget, progress))


def wrong_kind(loaded: LoadedSpec, message: str, remedy: str) -> DesignError:
    """Return the error that a command raises about a kind of spec that it is not for.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec.
    message : str
        What is wrong.
    remedy : str
        What to do about it.
    """
    place = loaded.place("kind")
    return DesignError(
        message, path=loaded.path, line=place.line, column=place.column, remedy=remedy
    )


def run_design(loaded: LoadedSpec) -> Designed | None:
    """Build the plant of a spec and design its controllers; None for given matrices.

    Raises
    ------
    DesignError
        If a requirement cannot be met within its bounds, or the spec describes a robot only.
    """
    if loaded.spec.kind == "robot":
        raise wrong_kind(
            loaded,
            "a robot spec has no controllers that are switched, so there is nothing to certify",
            "use `nrs-design robot check SPEC`, or a spec of kind interaction-design",
        )
    spec = loaded.spec
    if spec.kind != "interaction-design":
        return None
    from nrs_design.design.design import design_controllers
    from nrs_design.models.plant import build_plant

    with placed(loaded):
        plant = build_plant(spec)
        return Designed(loaded, spec, plant, design_controllers(spec, plant))


def run_analysis(designed: Designed) -> DesignAnalysis:
    """Compute what a design achieves.

    Raises
    ------
    DesignError
        If a nominal loop is unstable, so that it has no margins.
    """
    from nrs_design.design.analysis import analyze_design

    with placed(designed.loaded):
        return analyze_design(designed.spec, designed.plant, designed.design)


@dataclass(frozen=True, slots=True)
class Runs:
    """How scenarios are run; None leaves what the spec says.

    Parameters
    ----------
    names : tuple of str
        Which; empty for all.
    engine : {"exact", "sampled"} or None
        By default sampled where the spec has sampling or tissue is not linear, else exact.
    period : float or None
        Of the sampled engine, in s; 2 ms where nothing says it.
    delay : int or None
        Age of its force samples, in samples; none where nothing says it.
    max_steps : int or None
        Of each run.
    """

    names: tuple[str, ...] = ()
    engine: str | None = None
    period: float | None = None
    delay: int | None = None
    max_steps: int | None = None


def run_scenarios(
    designed: Designed, wanted: Runs | None = None, progress: Progress = _silent
) -> Iterator[Simulated]:
    """Simulate scenarios of a spec; a spec without any has one of its own.

    Parameters
    ----------
    designed : Designed
        The spec, its plant and its gains.
    wanted : Runs, optional
        Which, and how.
    progress : callable
        Told the name of each run, and how far it is.

    Yields
    ------
    Simulated
        One run after the other.

    Raises
    ------
    DesignError, DataError
        If there is no such scenario, or it cannot be simulated.
    """
    from nrs_design.simulation.exact import simulate_exactly
    from nrs_design.simulation.run import MAX_STEPS
    from nrs_design.simulation.sampled import simulate_sampled
    from nrs_design.simulation.summary import summarize

    wanted, spec = wanted or Runs(), designed.spec
    timed = spec.model_copy(update={"sampling": _sampling(spec, wanted)})
    with placed(designed.loaded):
        for scenario in _scenarios(designed, wanted.names):
            # A law of tissue that is not linear has no exponential.
            nonlinear = any(surface.element is None for surface in scenario.surfaces)
            usual = "sampled" if spec.sampling is not None or nonlinear else "exact"
            sampled = (wanted.engine or usual) == "sampled"
            run = (simulate_sampled if sampled else simulate_exactly)(
                timed if sampled else spec,
                designed.plant,
                designed.design,
                scenario,
                max_steps=wanted.max_steps or MAX_STEPS,
                tell=partial(_tell, progress, scenario.name),
            )
            yield Simulated(scenario, run, summarize(spec, scenario, run))


def _sampling(spec: InteractionDesignSpec, wanted: Runs) -> SamplingSpec:
    """Return the sampling of a spec, changed as is wanted."""
    from nrs_design.spec.sampling import SamplingSpec

    usual = SamplingSpec.model_validate({"period": "2 ms", "delay": "0"})
    changes: dict[str, object] = {}
    if wanted.period is not None:
        text = {"period": f"{wanted.period!r} s", "delay": "0"}
        changes["period"] = SamplingSpec.model_validate(text).period
    if wanted.delay is not None:
        changes["delay"] = (wanted.delay, wanted.delay)
    return (spec.sampling or usual).model_copy(update=changes)


def _tell(progress: Progress, name: str, step: str) -> None:
    progress(f"{name}, {step}")


def _scenarios(designed: Designed, names: Sequence[str]) -> list[Scenario]:
    from nrs_design.simulation.build_scenario import build_scenario, default_scenario
    from nrs_design.spec.faults import did_you_mean

    spec, plant, path = designed.spec, designed.plant, designed.loaded.path
    if not spec.scenarios:
        own = default_scenario(spec, plant)
        if set(names) <= {own.name}:
            return [own]
    for name in names:
        if name not in spec.scenarios:
            remedy = did_you_mean(name, spec.scenarios) if spec.scenarios else "add scenarios"
            raise DesignError(f"the spec has no scenario {name!r}", remedy=remedy)
    folder = Path() if path is None else path.parent
    return [
        build_scenario(spec, plant, name, spec.scenarios[name], folder)
        for name in names or spec.scenarios
    ]


def run_bounds(
    designed: Designed, certificate: Certificate, simulated: Simulated
) -> tuple[CertifiedBound, ...]:
    """Hold what is certified against a run.

    Parameters
    ----------
    designed : Designed
        The spec and its plant.
    certificate : Certificate
        Checked, of that spec.
    simulated : Simulated
        A run of that spec.
    """
    from nrs_design.proof.bounds import upper_float
    from nrs_design.simulation.coverage import uncovered

    system, found = certificate.system, []
    for statement in certificate.statements:
        bound = statement.bound(system)
        # One bound for each output is about all disturbances at once.
        if bound is None or set(bound.channels) != set(system.channels):
            continue
        reasons = uncovered(designed.spec, system, statement, simulated.scenario, simulated.run)
        level = upper_float(bound.level)
        found.append(CertifiedBound(bound.output.name, bound.output.unit, level, tuple(reasons)))
    return tuple(found)


def read_certificate(file: Path, designed: Designed) -> Certificate:
    """Return what a certificate file holds, checked exactly against the spec.

    Raises
    ------
    CertificateError
        If it is none, or does not hold for this spec.
    """
    from nrs_design.certificates.verify import verify
    from nrs_design.errors import CertificateError

    found = verify(file, designed.loaded, plant=designed.plant)
    if found.certificate is None or found.fault is not None:
        raise CertificateError(
            str(found.fault), path=file, remedy="make it anew with certify-switching"
        )
    return found.certificate


def find_relief(result: Result) -> tuple[str, ...]:
    """Return what would hold of a refuted design whose contacts are too stiff for its gains."""
    designed = result.designed
    if designed is None or result.certification.verdict is not Verdict.REFUTED:
        return ()
    from nrs_design.design.analysis import too_stiff

    return tuple(map(str, too_stiff(designed.spec, designed.plant, designed.design)))


@dataclass(frozen=True, slots=True)
class Overrides:
    """What a command sets about the search, over what the spec says; None leaves it.

    Parameters
    ----------
    max_degree : int or None
        Highest degree of a polynomial function.
    budget : float or None
        Time in s.
    memory : float or None
        In GB.
    """

    max_degree: int | None = None
    budget: float | None = None
    memory: float | None = None


def limits_of(spec: Spec, overrides: Overrides | None = None, optimize_rate: bool = True) -> Limits:
    """Return how far the search goes: by default, as the spec says, or as a command sets it.

    Parameters
    ----------
    spec : Spec
        Whose `certification` section counts.
    overrides : Overrides, optional
        What a command sets instead.
    optimize_rate : bool
        Look for the largest provable decay rate, not only for some.
    """
    limits, asked = Limits(optimize_rate=optimize_rate), overrides or Overrides()
    declared = None if spec.kind == "robot" else spec.certification
    if declared is not None and declared.max_degree is not None:
        limits = replace(limits, max_degree=declared.max_degree)
    if declared is not None and declared.budget is not None:
        limits = replace(limits, budget=float(declared.budget.exact))
    if asked.max_degree is not None:
        limits = replace(limits, max_degree=asked.max_degree)
    if asked.budget is not None:
        limits = replace(limits, budget=asked.budget)
    if asked.memory is not None:
        limits = replace(limits, memory=asked.memory * GIGABYTE)
    return limits


def run_certification(
    loaded: LoadedSpec,
    *,
    method: Method = Method.AUTO,
    coordinates: str | None = None,
    limits: Limits | None = None,
    progress: Progress = _silent,
) -> Result:
    """Take a spec all the way to a verdict.

    Parameters
    ----------
    loaded : LoadedSpec
        As `nrs_design.spec.read_spec` gives it.
    method : Method
        One rung of the search, or all of them in turn.
    coordinates : {"deflection", "force"}, optional
        Overrides what the spec says.
    limits : Limits, optional
        How far the searches go; by default as the spec says.
    progress : callable
        Told the name of each step.

    Raises
    ------
    DesignError, AssemblyError
        If the spec has no design, or its modes make no switched system.
    """
    from nrs_design.search.certify import certify

    progress("design")
    designed = run_design(loaded)
    if designed is not None:
        coordinates = coordinates or designed.spec.coordinates
    with placed(loaded):
        system = _assemble(loaded, designed, coordinates)
    certification = certify(system, method, limits or limits_of(loaded.spec), progress)
    certificate = (
        Certificate(
            spec_name=loaded.spec.name,
            spec_sha256=loaded.sha256,
            coordinates=coordinates,
            gains=_gains(designed),
            system=system,
            statements=certification.statements,
            version=__version__,
        )
        if certification.statements
        else None
    )
    return Result(loaded, designed, coordinates, certification, certificate)


def run_comparison(
    loaded: LoadedSpec,
    limits: Limits,
    coordinates: str | None = None,
    progress: Progress = _silent,
) -> tuple[SwitchedSystem, tuple[MethodRun, ...]]:
    """Compare the gradient iteration with the LMI on the modes of a spec.

    Parameters
    ----------
    loaded : LoadedSpec
        As `nrs_design.spec.read_spec` gives it.
    limits : Limits
        How far each search goes.
    coordinates : {"deflection", "force"}, optional
        Overrides what the spec says.
    progress : callable
        Told the name of each step.

    Returns
    -------
    SwitchedSystem
        The exact modes.
    tuple of MethodRun
        The LMI first.

    Raises
    ------
    DesignError, AssemblyError
        If the spec has no design, or its modes make no switched system that both methods are for.
    """
    from nrs_design.search.certify import certify
    from nrs_design.search.comparison import compare_methods

    designed = run_design(loaded)
    if designed is not None:
        coordinates = coordinates or designed.spec.coordinates
    with placed(loaded):
        system = _assemble(loaded, designed, coordinates)
        runs = compare_methods(partial(certify, system), limits, progress)
        return system, runs


def _gains(designed: Designed | None) -> Gains:
    if designed is None:
        return {}
    from nrs_design.controllers.gains import gains_of

    return gains_of(designed.design)


def _assemble(
    loaded: LoadedSpec,
    designed: Designed | None,
    coordinates: str | None,
    scale: Fraction = Fraction(1),
) -> SwitchedSystem:
    """Assemble either kind of spec, with its ranges stretched by a scale."""
    from nrs_design.switched.assemble import assemble, assemble_matrices

    if designed is not None:
        return assemble(designed.spec, designed.plant, designed.design, coordinates, scale)
    # A robot has no design either, but no way here.
    assert loaded.spec.kind == "switched-system"
    if coordinates is not None:
        raise AssemblyError("given matrices have neither gains nor coordinates")
    return assemble_matrices(loaded.spec, scale)


def run_verification(file: Path, result: Result) -> Verification:
    """Re-check a certificate file against the spec of a result, whose plant is in hand.

    Raises
    ------
    CertificateError
        If the file cannot be read as a certificate at all.
    """
    from nrs_design.certificates.verify import verify

    plant = None if result.designed is None else result.designed.plant
    return verify(file, result.loaded, plant=plant)


def run_margin(
    result: Result, limits: Limits | None = None, progress: Progress = _silent
) -> BoxMargin:
    """Find the largest box around the nominal values that still has a proof.

    Parameters
    ----------
    result : Result
        Of the spec as it stands; its design is kept.
    limits : Limits, optional
        How far the searches go at each scale; the decay rate is not optimized.
    progress : callable
        Told the name of each step.

    Raises
    ------
    DesignError
        If the spec declares no range.
    """
    from nrs_design.search.certify import certify
    from nrs_design.search.margin import find_margin

    spec = result.loaded.spec
    if not spec.has_ranges:
        given = "modes" if result.design is None else "environments"
        with placed(result.loaded):
            raise DesignError(
                "the spec declares no range, so there is no box to stretch",
                remedy="give an environment or a parameter a range",
                at=(given,),
            )
    limits = limits or limits_of(result.loaded.spec)
    quick = replace(limits, optimize_rate=False, budget=min(limits.budget, MARGIN_BUDGET))

    def assemble_at(scale: Fraction) -> SwitchedSystem:
        progress(f"box scaled by {nearly(scale)}")
        return _assemble(result.loaded, result.designed, result.coordinates, scale)

    return find_margin(
        assemble_at, lambda system: certify(system, limits=quick), result.certification
    )


def run_loop_margins(
    result: Result, limits: Limits | None = None, progress: Progress = _silent
) -> LoopMargins | None:
    """Find how far delay, period and disturbances stretch; None where a spec has none of them.

    Parameters
    ----------
    result : Result
        Of the spec as it stands; its design is kept.
    limits : Limits, optional
        How far the searches go each time; the decay rate is not optimized.
    progress : callable
        Told the name of each step.
    """
    from nrs_design.search.loop_margin import LoopMargins

    spec = None if result.designed is None else result.designed.spec
    if spec is None or (spec.sampling is None and spec.disturbances is None):
        return None
    limits = limits or limits_of(result.loaded.spec)
    quick = replace(limits, optimize_rate=False, budget=min(limits.budget, MARGIN_BUDGET))
    delay = period = None
    if result.designed is not None and spec.sampling is not None:
        delay, period = _sampling_margins(result.designed, spec.sampling, result, quick, progress)
    return LoopMargins(delay, period, _command_margin(result))


@dataclass(frozen=True, slots=True)
class Subset:
    """What is proved of a spec where not all of it is.

    Parameters
    ----------
    left_out : tuple of str
        Parts of the spec that the proof is not about.
    claim : str
        What is proved without them.
    """

    left_out: tuple[str, ...]
    claim: str


def run_subsets(
    result: Result, limits: Limits | None = None, progress: Progress = _silent
) -> tuple[Subset, ...]:
    """Find what is proved with as few parts of the spec left out as possible; nothing if all is.

    Parameters
    ----------
    result : Result
        Of the spec as it stands; its design is kept.
    limits : Limits, optional
        How far the searches go each time; the decay rate is not optimized.
    progress : callable
        Told what is left out.
    """
    from nrs_design.models.plant import build_plant
    from nrs_design.search.certify import certify
    from nrs_design.spec.aspects import aspects_of

    designed = result.designed
    if designed is None or result.certification.verdict is Verdict.PROVED:
        return ()
    limits = limits or limits_of(result.loaded.spec)
    quick = replace(limits, optimize_rate=False, budget=min(limits.budget, MARGIN_BUDGET))
    aspects = aspects_of(designed.spec)
    for count in range(1, len(aspects) + 1):
        found = []
        for left_out in combinations(aspects, count):
            progress(f"without {' and '.join(left_out)}")
            spec = designed.spec.model_copy(update={"disturbances": None})
            for name in left_out:
                spec = aspects[name](spec)
            other = replace(designed, spec=spec, plant=build_plant(spec))
            system = _assemble(result.loaded, other, result.coordinates)
            decided = certify(system, limits=quick)
            if decided.verdict is Verdict.PROVED and decided.evidence is not None:
                found.append(Subset(left_out, decided.evidence.claim(system)))
        if found:
            return tuple(found)
    return ()


def _sampling_margins(
    designed: Designed,
    sampling: SamplingSpec,
    result: Result,
    limits: Limits,
    progress: Progress,
) -> tuple[Bracket, Bracket]:
    """Decide the loop at other delays and other periods, without what disturbs it."""
    from nrs_design.search.certify import certify
    from nrs_design.search.loop_margin import find_longest_delay, find_longest_period
    from nrs_design.spec.sampling import LONGEST_DELAY

    known = result.certification.verdict

    def decide(changes: Mapping[str, object], what: str) -> Verdict:
        progress(what)
        changed = sampling.model_copy(update=changes)
        spec = designed.spec.model_copy(update={"sampling": changed, "disturbances": None})
        other = replace(designed, spec=spec)
        return certify(_assemble(result.loaded, other, result.coordinates), limits=limits).verdict

    def at_delay(longest: int) -> Verdict:
        if longest == sampling.delay[1]:
            return known
        return decide({"delay": (sampling.delay[0], longest)}, f"delay {longest}")

    def at_period(period: Fraction) -> Verdict | None:
        if period == sampling.period.exact:
            return known
        changes = {
            name: replace(given, value=period * given.value / sampling.period.exact)
            for name in ("period", "outer_period")
            if (given := getattr(sampling, name)) is not None
        }
        try:
            return decide(changes, f"period {period} s")
        except NrsDesignError:
            return None

    delay = find_longest_delay(*sampling.delay, LONGEST_DELAY, at_delay)
    return delay, find_longest_period(sampling.period.exact, at_period)


def _command_margin(result: Result) -> CommandMargin | None:
    """Hold the bound on the force against an adversary's run."""
    from nrs_design.certificates.bounds import bound_on
    from nrs_design.search.loop_margin import command_margin
    from nrs_design.simulation.disturbed import worst_output

    system = result.certification.system
    found = bound_on(system, result.certification.statements, "force") if system.channels else None
    return None if found is None else command_margin(found, worst_output(system, found))


def run_shortest_dwell(
    result: Result, limits: Limits | None = None, progress: Progress = _silent
) -> DwellMargin:
    """Find the shortest dwell time with a proof, whatever dwell time the spec declares.

    Parameters
    ----------
    result : Result
        Of the spec as it stands.
    limits : Limits, optional
        How far the searches go at each dwell time; the decay rate is not optimized.
    progress : callable
        Told the name of each step.

    Raises
    ------
    DesignError
        In discrete time, or if something may change between two switches, or if the spec declares
        longest dwell times, which would bound the shortest one.
    """
    from nrs_design.search.certify import certify
    from nrs_design.search.margin import find_shortest_dwell

    known = result.certification
    system = known.system
    _refuse_dwell(result.loaded, system.time)
    if len(system.lasting_modes()) < len(system.modes):
        with placed(result.loaded):
            raise DesignError(
                "a shortest dwell time is not searched beside longest ones",
                remedy="leave longest_dwell_time out, or declare the dwell_time and certify that",
                at=("switching", "longest_dwell_time"),
            )
    limits = limits or limits_of(result.loaded.spec)
    quick = replace(limits, optimize_rate=False, budget=min(limits.budget, MARGIN_BUDGET))

    def decide(candidate: SwitchedSystem) -> Certification:
        progress(f"dwell time {nearly(candidate.switching.dwell_time, 's')}")
        return certify(candidate, limits=quick)

    return find_shortest_dwell(system, decide, known)


def physical_outputs(result: Result) -> Outputs | None:
    """Return force and velocity as rows over the state, with the limits of the spec.

    None where the state of the system does not hold the deflection of a contact, or a run from it
    would need rules that are not kept: in discrete time, for controllers that command a position,
    and for laws with a memory.

    Parameters
    ----------
    result : Result
        Of the certification.
    """
    designed, system = result.designed, result.certification.system
    if designed is None or system.time is not Time.CONTINUOUS or not system.is_uniform:
        return None
    rules, contacts = system.switching, designed.design.contacts
    plain = all(c.law.commands == "velocity" for c in designed.design.controllers)
    ruled = bool(rules.resets) or (system.contact is not None and not rules.is_arbitrary)
    heavy = any(environment.law.has_mass for environment in designed.plant.among(contacts))
    if not plain or ruled or heavy or not contacts or system.states[-1] != "delta [rad]":
        return None
    import numpy as np

    from nrs_design.models.motion_loop import realize
    from nrs_design.simulation.release import Outputs
    from nrs_design.switched.commanded import outputs_of
    from nrs_design.switched.joint import Joint

    spec, plant, motion = designed.spec, designed.plant, designed.design.motion
    joint = Joint.of(plant, motion)
    loop = realize(plant.motion_loop(motion.Kp, motion.Kd)) if joint is None else joint.nominal
    force, velocity = outputs_of(system.order, loop, spec, plant.among(contacts))
    return Outputs(
        np.array([row.floats()[0] for row in force.rows]),
        np.array(velocity.rows[0].floats()[0]),
        spec.limits.torque.si,
        spec.limits.velocity.si,
    )


@dataclass(frozen=True, slots=True)
class ProofMargins:
    """How far a proof reaches, as far as that was asked for.

    Parameters
    ----------
    loop : LoopMargins or None
        Of delay, period and disturbances.
    box : BoxMargin or None
        Of the declared ranges.
    dwell : DwellMargin or None
        Of the time between switches.
    """

    loop: LoopMargins | None = None
    box: BoxMargin | None = None
    dwell: DwellMargin | None = None


def run_proof_margins(
    result: Result,
    limits: Limits,
    progress: Progress = _silent,
    *,
    margin: bool,
    shortest_dwell: bool,
) -> ProofMargins:
    """Find the margins that a command asks for.

    Parameters
    ----------
    result : Result
        Of the spec as it stands.
    limits : Limits
        How far the searches go each time; the decay rate is not optimized.
    progress : callable
        Told the name of each step.
    margin : bool
        Those of ranges, delay, period and disturbances; of ranges alone, a spec must have some.
    shortest_dwell : bool
        That of the time between switches.

    Raises
    ------
    DesignError
        If the spec has nothing that such a margin is about.
    """
    loop = run_loop_margins(result, limits, progress) if margin else None
    ranged = loop is None or result.loaded.spec.has_ranges
    return ProofMargins(
        loop=loop,
        box=run_margin(result, limits, progress) if margin and ranged else None,
        dwell=run_shortest_dwell(result, limits, progress) if shortest_dwell else None,
    )


def _refuse_dwell(loaded: LoadedSpec, time: Time) -> None:
    """Stop where a dwell time would say nothing, by the rule that a spec with one must keep."""
    if time is not Time.CONTINUOUS:
        raise DesignError(
            "a shortest dwell time is for continuous time",
            path=loaded.path,
            remedy="in discrete time, declare a dwell_time in steps and certify that",
        )
    assert loaded.spec.kind != "robot"  # It has no modes, hence no certification.
    if obstacle := loaded.spec.find_dwell_obstacle():
        raise DesignError(obstacle.message, path=loaded.path, remedy=obstacle.remedy)
