"""From a design to runs: of its scenarios, with certified bounds beside, and the worst ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from nrs_design.errors import AssemblyError, DesignError, NrsDesignError
from nrs_design.models.axis import find_axis
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.design import Designed, placed, run_analysis
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import upper
from nrs_design.proof.channels import Output
from nrs_design.spec import Doubt

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.proof.system import SwitchedSystem
    from nrs_design.simulation.run import Run
    from nrs_design.simulation.scenario import Scenario
    from nrs_design.simulation.worst_case import WorstRun
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.sampling import SamplingSpec


@dataclass(frozen=True, slots=True)
class Simulated:
    """A scenario that has been simulated."""

    scenario: Scenario  # In SI
    run: Run  # Up to its end
    metrics: Mapping[str, Any]  # Metrics of the run, in SI


@dataclass(frozen=True, slots=True)
class Runs:
    """Settings of runs; None keeps those of the spec."""

    names: tuple[str, ...] = ()  # Which; empty for all
    # By default sampled where the spec has sampling or tissue is not linear, else exact.
    engine: str | None = None
    period: float | None = None  # Period of the sampled engine, in s; 2 ms by default
    delay: int | None = None  # Age of its force samples, in samples; zero by default
    max_steps: int | None = None  # Limit of each run
    # Of force, filter and admittance, in s; that of the motion loop where nothing says it.
    outer_period: float | None = None


def run_scenarios(
    designed: Designed, wanted: Runs | None = None, progress: Progress = silent
) -> Iterator[Simulated]:
    """Simulate scenarios one by one; a spec without any has a default one."""
    wanted = wanted or Runs()
    with placed(designed.loaded):
        for scenario in scenarios_of(designed, wanted):
            yield _simulate(designed, scenario, wanted, progress)


def run_judgement(designed: Designed) -> DesignAnalysis:
    """Analyze a design, with doubts about torques of its runs."""
    found = run_analysis(designed)
    return replace(found, doubts=(*found.doubts, *_doubt_runs(designed)))


def judged_if_stable(
    designed: Designed | None, report: Callable[[str], object] = lambda _: None
) -> DesignAnalysis | None:
    """Analyze a design; None without a design, and, with a message, if a loop is unstable."""
    try:
        return None if designed is None else run_judgement(designed)
    except DesignError as error:
        report(error.message)
        return None


def _doubt_runs(designed: Designed) -> Iterator[Doubt]:
    """Yield the runs whose torque is beyond the limit of the spec; what cannot be run has none."""
    try:
        runs = tuple(run_scenarios(designed))
    except NrsDesignError:
        return
    limit, unit = designed.spec.limits.torque, designed.spec.axis.unit("N*m")
    for one in runs:
        peak = one.metrics["peak_torque"]
        # A limit of the scenario itself is judged by the gate.
        if "torque" not in one.scenario.limits and peak > limit.si:
            text = (
                f"simulated, {one.scenario.name}: a torque of {upper(Fraction(peak), 4)} {unit}, "
            )
            text += f"beyond limits.torque of {limit.text}"
            yield Doubt(("limits", "torque"), text, beyond=peak / limit.si)


def _simulate(
    designed: Designed, scenario: Scenario, wanted: Runs, progress: Progress
) -> Simulated:
    """Simulate a scenario, and measure the run."""
    from nrs_design.simulation.exact import simulate_exactly
    from nrs_design.simulation.metrics import summarize
    from nrs_design.simulation.run import MAX_STEPS
    from nrs_design.simulation.sampled import simulate_sampled

    spec, engine = designed.spec, wanted.engine or _usual(designed.spec, scenario)
    given, max_steps = (designed.plant, designed.design, scenario), wanted.max_steps or MAX_STEPS

    def tell(step: str) -> None:
        progress(f"{scenario.name}, {step}")

    if engine == "exact":
        run = simulate_exactly(spec, *given, max_steps=max_steps, progress=tell)
    else:
        timed = spec.model_copy(update={"sampling": _sampling(spec, wanted)})
        run = simulate_sampled(timed, *given, max_steps=max_steps, progress=tell)
    return Simulated(scenario, run, summarize(spec, scenario, run))


def _usual(spec: InteractionDesignSpec, scenario: Scenario) -> str:
    """Return the engine for a scenario: a law of tissue that is not linear has no exponential."""
    nonlinear = any(surface.element is None for surface in scenario.surfaces)
    return "sampled" if spec.sampling is not None or nonlinear else "exact"


def _sampling(spec: InteractionDesignSpec, wanted: Runs) -> SamplingSpec:
    """Return the sampling of a spec, changed as is wanted."""
    from nrs_design.spec.sampling import SamplingSpec

    usual = SamplingSpec.model_validate({"period": "2 ms", "delay": "0"})
    changes: dict[str, object] = {}
    for key, value in (("period", wanted.period), ("outer_period", wanted.outer_period)):
        if value is not None:
            text = {"period": f"{value!r} s", "delay": "0"}
            changes[key] = SamplingSpec.model_validate(text).period
    if wanted.delay is not None:
        changes["delay"] = (wanted.delay, wanted.delay)
    return (spec.sampling or usual).model_copy(update=changes)


def scenarios_of(designed: Designed, wanted: Runs) -> list[Scenario]:
    """Return the scenarios that are wanted, in SI."""
    from nrs_design.simulation.build_scenario import build_scenario, default_scenario

    spec, plant = designed.spec, designed.plant
    return [
        build_scenario(spec, plant, name, spec.scenarios[name])
        if spec.scenarios
        else default_scenario(spec, plant)
        for name in names_of(spec, wanted)
    ]


def names_of(spec: InteractionDesignSpec, wanted: Runs) -> Sequence[str]:
    """Return the names of the wanted scenarios; a spec without any has a default one."""
    from nrs_design.simulation.build_scenario import DEFAULT
    from nrs_design.spec.faults import did_you_mean

    known = tuple(spec.scenarios) or (DEFAULT,)
    for name in wanted.names:
        if name not in known:
            remedy = did_you_mean(name, known)
            raise DesignError(f"the spec has no scenario {name!r}", remedy=remedy)
    return wanted.names or known


@dataclass(frozen=True, slots=True)
class CertifiedBound:
    """A certified bound beside a run."""

    # output, unit: what is bounded.
    output: str
    unit: str
    level: float  # Not below what is proved
    uncovered: tuple[str, ...]  # Events of the run outside the proof; empty if the bound holds


@dataclass(frozen=True, slots=True)
class CertifiedRate:
    """A certified rate of decay beside a run."""

    rate: float  # Conservative: in 1/s, or the factor per sample
    unit: str  # ``1/s``, or empty for a factor
    attained: bool  # True if the rate itself is proved, not only slower ones
    start: float | None  # From when on nothing is commanded, in s; None where the run ends before
    uncovered: tuple[str, ...]  # Reasons why the rate does not apply from then on; empty if it does


def hold_bounds(
    designed: Designed, certificate: Certificate, simulated: Simulated
) -> tuple[CertifiedBound, ...]:
    """Return the certified bounds with the reasons why they do not apply to a run."""
    from nrs_design.proof.bounds import upper_float
    from nrs_design.simulation.coverage import Coverage

    system, found = certificate.system, []
    for statement in certificate.statements:
        bound = statement.bound(system)
        # One bound for each output is about all disturbances at once.
        if bound is None or set(bound.channels) != set(system.channels):
            continue
        coverage = Coverage(designed.spec, system, statement, simulated.scenario, simulated.run)
        reasons, level = tuple(coverage.uncovered()), upper_float(bound.level)
        found.append(CertifiedBound(bound.output.name, bound.output.unit, level, reasons))
    return tuple(found)


def hold_rate(
    designed: Designed, certificate: Certificate, simulated: Simulated
) -> CertifiedRate | None:
    """Return the certified rate, if any, with the reasons why it does not apply to a run."""
    from nrs_design.proof.bounds import lower_float, upper_float
    from nrs_design.proof.evidence.abstract import Shows
    from nrs_design.proof.mode import Time
    from nrs_design.simulation.coverage import Coverage, end_of_command

    system, one = certificate.system, simulated
    evidence = certificate.evidence
    proved = None if evidence is None else evidence.proved_rate(system)
    if evidence is None or evidence.shows is not Shows.STABILITY or proved is None:
        return None
    continuous = system.time is Time.CONTINUOUS
    beside = Coverage(designed.spec, system, evidence, one.scenario, one.run)
    return CertifiedRate(
        (lower_float if continuous else upper_float)(proved),
        "1/s" if continuous else "",
        evidence.attains_rate,
        end_of_command(one.scenario),
        tuple(beside.undecayed()),
    )


@dataclass(frozen=True, slots=True)
class WorstCase:
    """Worst runs of an adversary, beside limits and certified bounds."""

    system: SwitchedSystem  # That he played against
    runs: tuple[WorstRun, ...]  # One for each quantity: force, velocity and deflection
    limits: Mapping[str, float]  # Of these quantities, as far as the spec has any; SI
    bounds: Mapping[str, float]  # Not below what is certified; SI
    # Whether the spec says what disturbs; otherwise it is any command up to its limit.
    declared: bool

    @property
    def found(self) -> Sequence[Mapping[str, Any]]:
        """The worst value of each quantity, its limit and its bound, as facts in SI."""
        return [self._found(run) for run in self.runs]

    def _found(self, run: WorstRun) -> dict[str, Any]:
        name = run.output.name
        limit, bound = self.limits.get(name), self.bounds.get(name)
        return {
            "output": name,
            "unit": run.output.unit,
            "worst_found": run.value,
            "limit": limit,
            "certified_bound": bound,
            "bound_over_found": None if bound is None or not run.value else bound / run.value,
            "exceeds_limit": limit is not None and run.value > limit,
            "duration": float(run.time[-1]),
        }


def run_worst_case(
    designed: Designed, certificate: Certificate | None = None, progress: Progress = silent
) -> WorstCase:
    """Let an adversary choose everything that the spec leaves open, and keep the worst runs.

    The bounds of a checked certificate are held against them. What acts on the loop and is not
    modelled is a `DesignError`.
    """
    from nrs_design.simulation.worst_case import worst_runs

    spec = designed.spec
    progress("adversary")
    try:
        system = _commanded(designed)
        outputs = (*system.outputs, *_deflection(system))
        runs = worst_runs(
            system, outputs, designed.plant.select_environments(designed.design.contacts)
        )
    except (AssemblyError, ValueError) as error:
        message = error.message if isinstance(error, AssemblyError) else str(error)
        with placed(designed.loaded):
            raise DesignError(
                f"no worst case is searched for this spec: {message}",
                remedy="use `simulate` without --worst-case, with a scenario for each controller",
                at=("controllers",),
            ) from error
    return WorstCase(
        system,
        runs,
        {o.name: float(o.limit) for o in system.outputs if o.limit is not None}
        | {"force": spec.limits.torque.si, "velocity": spec.limits.velocity.si},
        {} if certificate is None else _certified_bounds(certificate),
        spec.disturbances is not None,
    )


def _deflection(system: SwitchedSystem) -> Iterator[Output]:
    """Yield the deflection as an output, where it is a state."""
    from nrs_design.proof.matrix import RationalMatrix
    from nrs_design.simulation.worst_case import DEFLECTION

    axis = find_axis(system.states)
    delta = axis.label("delta [rad]")
    if delta in system.states:
        row = RationalMatrix.from_rows([[int(state == delta) for state in system.states]])
        yield Output(DEFLECTION, axis.unit("rad"), (row,))


def _certified_bounds(certificate: Certificate) -> dict[str, float]:
    """Return certified bounds on every output and on the deflection, rounded up.

    Bounds under all disturbances at once count. Where the force is a stiffness times the
    deflection, the bound holds for every stiffness in its range, so also for the highest.
    """
    from nrs_design.certificates.bounds import bound_on
    from nrs_design.proof.bounds import upper_float
    from nrs_design.simulation.worst_case import DEFLECTION

    found: dict[str, float] = {}
    for output in certificate.system.outputs:
        bound = bound_on(certificate.system, certificate.statements, output.name)
        if bound is None:
            continue
        found[output.name] = upper_float(bound.level)
        rows = [row.fractions()[0] for row in output.rows]
        if output.name == "force" and not any(any(row[:-1]) for row in rows):
            found[DEFLECTION] = upper_float(bound.level / max(abs(row[-1]) for row in rows))
    return found


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
    from nrs_design.loop.close_loop import add_command
    from nrs_design.loop.shared_state import shared_state
    from nrs_design.spec.build_plant import build_conditions

    conditions = build_conditions(spec)
    state = shared_state(conditions, designed.plant, designed.design)
    system = assemble_spec(designed.loaded, designed)
    return add_command(system, state, disturbances.bounds(), conditions.torque)
