"""Simulated witnesses of instability: a mode, a period, an average, a value of a parameter."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from nrs_design.certificates.evidence import (
    AbstractEvidence,
    BlockTriangular,
    UnstableMixture,
    UnstableMode,
    UnstablePeriod,
    UnstableValue,
)
from nrs_design.certificates.evidence.unstable_mode import worst_eigenvalue
from nrs_design.certificates.evidence.unstable_value import value_text
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.complex_plane import draw_eigenvalues
from nrs_design.reporting.figures.run import draw_phase_plane, draw_run
from nrs_design.reporting.formatting import number, plural, roots
from nrs_design.reporting.sections.run import PATH, plane_axes
from nrs_design.simulation.norms import Array
from nrs_design.simulation.periodic import (
    PeriodicRun,
    mixture_matrix,
    one_period,
    periodic_run,
    steps_of_mixture,
)
from nrs_design.simulation.switched import TimeResponse, alone, eigenvalues, unstable_run
from nrs_design.spec.bounds import nearly
from nrs_design.switched.constant import system_at
from nrs_design.switched.system import SwitchedSystem, Time

_EUCLIDEAN = "|x(t)| / |x(0)|, Euclidean norm [1]"
_LISTED = 24


def witness_section(system: SwitchedSystem, evidence: AbstractEvidence) -> Section:
    """Simulate what the evidence of instability says.

    Evidence for one block is simulated in the whole family, which contains it.
    """
    if isinstance(evidence, BlockTriangular):
        evidence = evidence.parts[0][1]
    if isinstance(evidence, UnstableValue):
        text = (
            f"{value_text(system, evidence.share)}: what follows is simulated at this value of the "
            "parameter, between the modes that are listed."
        )
        inner = witness_section(system_at(system, evidence.share), evidence.part)
        return Section(inner.title, (Paragraph(text), *inner.blocks))
    blocks: tuple[Block, ...] = ()
    if isinstance(evidence, UnstableMode):
        blocks = _mode(system, evidence)
    elif isinstance(evidence, UnstablePeriod):
        blocks = _period(system, evidence)
    elif isinstance(evidence, UnstableMixture):
        blocks = _mixture(system, evidence)
    return Section("Simulated witness", blocks)


def _mode(system: SwitchedSystem, evidence: UnstableMode) -> tuple[Block, ...]:
    index = next(i for i, mode in enumerate(system.modes) if mode.name == evidence.mode)
    single = alone(system, index)
    response = unstable_run(single, 0)
    eigenvalue = worst_eigenvalue(single.modes[0].A, system.time)
    run = Illustration(
        "run",
        f"Staying in mode {evidence.mode}",
        f"Simulated from the eigenvector of the eigenvalue (about {eigenvalue}): the state does "
        "not decay. No other mode is used, which the switching allows.",
        draw_run(response, _norms(response), _growth(single, response), single, _EUCLIDEAN),
    )
    return (run, *_phase_plane(single, response))


def _growth(system: SwitchedSystem, response: TimeResponse) -> tuple[str, Array]:
    """Return how the worst eigenvalue of the one mode grows by itself, with its label."""
    values = np.linalg.eigvals(np.array(system.modes[0].A.floats()))
    if system.time is Time.CONTINUOUS:
        rate = float(values.real.max())
        return f"the eigenvalue alone, exp({rate:.4g} t)", np.exp(rate * response.time)
    factor = float(np.abs(values).max())
    return f"the eigenvalue alone, {factor:.4g}^t", factor**response.time


def _period(system: SwitchedSystem, evidence: UnstablePeriod) -> tuple[Block, ...]:
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    steps = [(index[name], float(time)) for name, time in evidence.steps]
    run = periodic_run(system, steps, evidence.edges)
    first = one_period(run)
    periods = round(run.response.time[-1] / run.period)
    line = _line(run)
    unit = "s" if system.time is Time.CONTINUOUS else "steps"
    count = plural(len(evidence.steps), "step")
    resets = " and the reset of each switch" if system.switching.resets else ""
    return (
        Paragraph(
            f"One period lasts {run.period:.6g} {unit} and has {count}. "
            f"Over one period some state grows by the factor {number(run.radius, 6)}"
            f"{_rate(run, system.time)}. The certificate shows with rigorous enclosures that the "
            "factor is above one; these digits are floating point."
        ),
        _steps_table(system, evidence, unit),
        Illustration(
            "run",
            f"The witness over {plural(periods, 'period')}",
            "Simulated from the direction that grows the most, with every mode for its time"
            f"{resets}. The dashed line is the growth per period, carried on.",
            draw_run(run.response, _norms(run.response), line, system, _EUCLIDEAN),
        ),
        Illustration(
            "one-period",
            "One period of the witness",
            "The first period of the same run: which mode is active when, and what it does to the "
            "norm.",
            draw_run(first, _norms(first), None, system, _EUCLIDEAN),
        ),
        *_phase_plane(system, run.response),
    )


def _line(run: PeriodicRun) -> tuple[str, Array]:
    label = f"factor {number(run.radius, 4)} per period"
    return label, np.exp(math.log(run.radius) * run.response.time / run.period)


def _rate(run: PeriodicRun, time: Time) -> str:
    rate = math.log(run.radius) / run.period
    return f", a mean growth rate of {number(rate, 4)} 1/s" if time is Time.CONTINUOUS else ""


def _steps_table(system: SwitchedSystem, evidence: UnstablePeriod, unit: str) -> Table:
    names = [name for name, _ in evidence.steps]
    resets = _resets(system, list(zip(names, (*names[1:], *names[:1]), strict=True)), evidence)
    head = ("Step", "Mode", f"Time in it [{unit}]", *(("Then",) if any(resets) else ()))
    rows = tuple(
        (str(k + 1), name, nearly(time), *((resets[k],) if any(resets) else ()))
        for k, (name, time) in enumerate(evidence.steps[:_LISTED])
    )
    more = len(evidence.steps) - len(rows)
    return Table("One period" + (f", its first {_LISTED} steps" if more else ""), head, rows)


def _resets(
    system: SwitchedSystem, switches: list[tuple[str, str]], evidence: UnstablePeriod
) -> list[str]:
    """Say for each step what its switch does to the state; nothing where it leaves it as it is."""
    maps, ways = system.switching.maps(), evidence.edges or (0,) * len(switches)
    texts = []
    for switch, way in zip(switches, ways, strict=True):
        count = len(maps.get(switch, ()))
        which = f"reset {way + 1} of {count}" if count > 1 else "reset"
        texts.append(f"{which} to {switch[1]}" if count else "")
    return texts


def _mixture(system: SwitchedSystem, evidence: UnstableMixture) -> tuple[Block, ...]:
    average = np.linalg.eigvals(mixture_matrix(system, evidence.weights)).astype(complex)
    steps = steps_of_mixture(system, evidence.weights)
    run = periodic_run(system, steps)
    rate = float(average.real.max())
    line = (f"the average alone, exp({rate:.4g} t)", np.exp(rate * run.response.time))
    names = [name for name, _ in evidence.weights]
    mixed = replace(system, modes=tuple(mode for mode in system.modes if mode.name in names))
    weights = tuple(
        (name, str(weight), number(float(weight), 4)) for name, weight in evidence.weights
    )
    return (
        Paragraph(f"Eigenvalues of the average: {roots(average.tolist(), 6)} 1/s."),
        Table("The average", ("Mode", "Share (exact)", "Share [1]"), weights),
        Illustration(
            "mixture",
            "Eigenvalues of the average",
            "The modes that have a share in it, and their average, which is not stable.",
            draw_eigenvalues(
                [*(mode.name for mode in mixed.modes), "average"],
                [*eigenvalues(mixed), average],
                system.time,
                None,
            ),
        ),
        Illustration(
            "run",
            "Fast switching with these shares",
            f"Every mode has its share of each period of {run.period:.4g} s. The faster the "
            "switching, the nearer it comes to the average, the dashed line. "
            + _outcome(run, rate),
            draw_run(run.response, _norms(run.response), line, system, _EUCLIDEAN),
        ),
        *_phase_plane(system, run.response),
    )


def _outcome(run: PeriodicRun, rate: float) -> str:
    if run.radius > 1 and rate > 0:
        return f"At this period the state grows by the factor {number(run.radius, 5)} each time."
    return (
        "The average is on the border of stability, so the run need not grow; but no rate of decay "
        "holds for all signals."
    )


def _norms(response: TimeResponse) -> Array:
    values = np.linalg.norm(response.state, axis=1)
    return np.asarray(values / values[0])


def _phase_plane(system: SwitchedSystem, response: TimeResponse) -> tuple[Illustration, ...]:
    if system.order != 2:
        return ()
    return (
        Illustration(
            "phase-plane",
            "The same run in the plane of the two states",
            f"{PATH} {plane_axes(system)}",
            draw_phase_plane(response, system),
        ),
    )
