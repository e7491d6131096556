"""What grows along a closed sequence of steps: simulated."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.bounds import lower, nearly
from nrs_design.proof.constant import value_text
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import worst_eigenvalue
from nrs_design.proof.switching import ARBITRARY
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.complex_plane import draw_eigenvalues
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import number, plural, roots
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.run import EUCLIDEAN, euclidean_norms, plane, witness
from nrs_design.simulation.norms import Array
from nrs_design.simulation.periodic import (
    PeriodicRun,
    mixture_matrix,
    one_period,
    periodic_run,
    steps_of_mixture,
)
from nrs_design.simulation.switched import SwitchedRun, alone, mode_eigenvalues, unstable_run

_LISTED = 24


class GrowingSequencePage(AbstractKindPage[GrowingSequence]):
    """The page of a mode, an average, a period, a motion in contact, or a value."""

    @property
    def name(self) -> str:
        """What it shows."""
        return self._page.name

    def meaning(self) -> tuple[str, ...]:
        """Say why it is enough."""
        return self._page.meaning()

    def limits(self) -> tuple[str, ...]:
        """Say what does not follow."""
        return self._page.limits()

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Follow the sequence."""
        return self._page.run()

    @property
    def _page(self) -> AbstractKindPage[GrowingSequence]:
        return _page_of(self.system, self.evidence)


def _page_of(
    system: SwitchedSystem, evidence: GrowingSequence
) -> AbstractKindPage[GrowingSequence]:
    if evidence.share is not None:
        return _ValuePage(system, evidence)
    if evidence.factor is not None:
        return _ContactPage(system, evidence)
    if evidence.doublings is not None:
        return _PeriodPage(system, evidence)
    return (_ModePage if len(evidence.steps) == 1 else _MixturePage)(system, evidence)


class _ModePage(AbstractKindPage[GrowingSequence]):
    """What one mode does by itself."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "a mode that is not stable"

    def meaning(self) -> tuple[str, ...]:
        """Say why one mode is enough."""
        region = "left half plane" if self.system.time is Time.CONTINUOUS else "unit disk"
        return (
            f"The mode has an eigenvalue outside the open {region}. Staying in this mode forever "
            "is one of the switching signals that the spec allows, so exponential stability under "
            f"{words.allowed_signals(self.system)} is impossible. The decision is exact; the "
            "eigenvalue is printed for the reader.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for the other modes."""
        return (
            words.NO_FORECAST,
            "Nothing is said about the other modes, nor about switching that avoids this mode or "
            "leaves it soon enough.",
            words.ON_THE_BORDER,
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Stay in the mode, from the eigenvector of its worst eigenvalue."""
        name = self.evidence.steps[0][0]
        modes = (*self.system.modes, *self.system.free_motions())
        index = next(i for i, mode in enumerate(modes) if mode.name == name)
        single = alone(replace(self.system, modes=modes), index)
        response = unstable_run(single, 0)
        eigenvalue = worst_eigenvalue(single.modes[0].A, single.time)
        growth, norms = _growth(single, response), euclidean_norms(response)
        run = Illustration(
            "run",
            f"Staying in mode {name}",
            f"Simulated from the eigenvector of the eigenvalue (about {eigenvalue}): the state "
            "does not decay. No other mode is used, which the switching allows.",
            draw_run(response, norms, growth, single, EUCLIDEAN),
        )
        return witness(run, *plane(single, response))


def _growth(system: SwitchedSystem, response: SwitchedRun) -> tuple[str, Array]:
    """Return how the worst eigenvalue of the one mode grows by itself, with its label."""
    values = np.linalg.eigvals(np.array(system.modes[0].A.floats()))
    if system.time is Time.CONTINUOUS:
        rate = float(values.real.max())
        return f"the eigenvalue alone, exp({rate:.4g} t)", np.exp(rate * response.time)
    factor = float(np.abs(values).max())
    return f"the eigenvalue alone, {factor:.4g}^t", factor**response.time


class _MixturePage(AbstractKindPage[GrowingSequence]):
    """The average and its eigenvalues, and a run that comes near to it."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "an average that is not stable"

    def meaning(self) -> tuple[str, ...]:
        """Say what an average has to do with switching."""
        return (
            "If the modes were exponentially stable under arbitrary switching, uniformly over all "
            "signals, then so would be every average of them, which fast switching comes near to. "
            "This average is not stable, so no such guarantee is possible. The decision is exact; "
            "the eigenvalue is printed for the reader.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for slow switching."""
        return (
            words.NO_FORECAST,
            "Nothing is said about slower switching: every mode alone may be stable, and a dwell "
            "time may make the family stable.",
            words.ON_THE_BORDER,
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Switch fast, with the shares of the average."""
        system, weights = self.system, self.evidence.steps
        average = np.linalg.eigvals(mixture_matrix(system, weights)).astype(complex)
        run = periodic_run(system, steps_of_mixture(system, weights))
        rate = float(average.real.max())
        line = (f"the average alone, exp({rate:.4g} t)", np.exp(rate * run.response.time))
        shares = tuple((name, str(w), number(float(w), 4)) for name, w in weights)
        return witness(
            Paragraph(f"Eigenvalues of the average: {roots(average.tolist(), 6)} 1/s."),
            Table("The average", ("Mode", "Share (exact)", "Share [1]"), shares),
            self._spectra(average),
            Illustration(
                "run",
                "Fast switching with these shares",
                f"Every mode has its share of each period of {run.period:.4g} s. The faster the "
                "switching, the nearer it comes to the average, the dashed line. "
                + _outcome(run, rate),
                draw_run(run.response, euclidean_norms(run.response), line, system, EUCLIDEAN),
            ),
            *plane(system, run.response),
        )

    def _spectra(self, average: NDArray[np.complex128]) -> Illustration:
        names = [name for name, _ in self.evidence.steps]
        modes = tuple(mode for mode in self.system.modes if mode.name in names)
        mixed = replace(self.system, modes=modes)
        return Illustration(
            "mixture",
            "Eigenvalues of the average",
            "The modes that have a share in it, and their average, which is not stable.",
            draw_eigenvalues(
                [*(mode.name for mode in modes), "average"],
                [*mode_eigenvalues(mixed), average],
                mixed.time,
                None,
            ),
        )


def _outcome(run: PeriodicRun, rate: float) -> str:
    if run.radius > 1 and rate > 0:
        return f"At this period the state grows by the factor {number(run.radius, 5)} each time."
    return (
        "The average is on the border of stability, so the run need not grow; but no rate of decay "
        "holds for all signals."
    )


class _PeriodPage(AbstractKindPage[GrowingSequence]):
    """The signal, one period of it, and how the state grows from period to period."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "a period that grows"

    def meaning(self) -> tuple[str, ...]:
        """Say why one signal is enough."""
        return (
            "The signal keeps every rule that the spec declares. Repeated forever, it multiplies "
            "some state by a factor above one in every period, so no stability of any kind can be "
            f"guaranteed under {words.allowed_signals(self.system)}. The matrix of one period is "
            "enclosed rigorously; a power of it has a trace that only an eigenvalue outside the "
            "unit circle can explain.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for other signals."""
        return (
            words.NO_FORECAST,
            "Nothing is said about other signals: a longer dwell time, fewer transitions or "
            "narrower ranges may make the family stable.",
            "Nothing is said about what saturation or friction would make of the growth.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Repeat the signal, from the direction that grows the most."""
        system, evidence = self.system, self.evidence
        index = {mode.name: k for k, mode in enumerate(system.modes)}
        steps = [(index[name], float(time)) for name, time in evidence.steps]
        run = periodic_run(system, steps, evidence.edges)
        first = one_period(run)
        periods = round(run.response.time[-1] / run.period)
        resets = " and the reset of each switch" if system.switching.resets else ""
        return witness(
            self._factor(run),
            self._steps(),
            Illustration(
                "run",
                f"The witness over {plural(periods, 'period')}",
                "Simulated from the direction that grows the most, with every mode for its time"
                f"{resets}. The dashed line is the growth per period, carried on.",
                draw_run(
                    run.response, euclidean_norms(run.response), _line(run), system, EUCLIDEAN
                ),
            ),
            Illustration(
                "one-period",
                "One period of the witness",
                "The first period of the same run: which mode is active when, and what it does to "
                "the norm.",
                draw_run(first, euclidean_norms(first), None, system, EUCLIDEAN),
            ),
            *plane(system, run.response),
        )

    @property
    def _unit(self) -> str:
        return "s" if self.system.time is Time.CONTINUOUS else "steps"

    def _factor(self, run: PeriodicRun) -> Paragraph:
        """Say how long a period is, and by which factor a state grows in it."""
        rate = number(math.log(run.radius) / run.period, 4)
        mean = f", a mean growth rate of {rate} 1/s" if self.system.time is Time.CONTINUOUS else ""
        return Paragraph(
            f"One period lasts {run.period:.6g} {self._unit} and has "
            f"{plural(len(self.evidence.steps), 'step')}. "
            f"Over one period some state grows by the factor {number(run.radius, 6)}{mean}. The "
            "certificate shows with rigorous enclosures that the factor is above one; these "
            "digits are floating point."
        )

    def _steps(self) -> Table:
        """List the modes of one period, their times, and the resets between them."""
        steps = self.evidence.steps
        names = [name for name, _ in steps]
        resets = self._resets(list(zip(names, (*names[1:], *names[:1]), strict=True)))
        columns = ("Step", "Mode", f"Time in it [{self._unit}]")
        rows: list[tuple[str, ...]] = [
            (str(k + 1), name, nearly(time)) for k, (name, time) in enumerate(steps[:_LISTED])
        ]
        title = "One period" + (f", its first {_LISTED} steps" if len(steps) > len(rows) else "")
        if not any(resets):
            return Table(title, columns, tuple(rows))
        then = tuple((*row, reset) for row, reset in zip(rows, resets, strict=False))
        return Table(title, (*columns, "Then"), then)

    def _resets(self, switches: Sequence[tuple[str, str]]) -> list[str]:
        """Say what each switch does to the state; nothing where it leaves it as it is."""
        maps, ways = self.system.switching.maps(), self.evidence.edges or (0,) * len(switches)
        texts = []
        for switch, way in zip(switches, ways, strict=True):
            count = len(maps.get(switch, ()))
            which = f"reset {way + 1} of {count}" if count > 1 else "reset"
            texts.append(f"{which} to {switch[1]}" if count else "")
        return texts


def _line(run: PeriodicRun) -> tuple[str, Array]:
    """Return the growth per period, carried on along a run, with its label."""
    label = f"factor {number(run.radius, 4)} per period"
    return label, np.exp(math.log(run.radius) * run.response.time / run.period)


class _ContactPage(AbstractKindPage[GrowingSequence]):
    """The sequence of contact and flight, and how the motion grows along it."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "a motion that grows while contact is lost and made"

    def meaning(self) -> tuple[str, ...]:
        """Say why one motion is enough."""
        return (
            "The motion makes its sequence of contact and flight by itself: the environment acts "
            "only where the deflection is positive, and never pulls. Larger each time, it goes on "
            "for ever, so no stability of any kind can be guaranteed under "
            f"{words.allowed_signals(self.system)} with contact that may be lost. Its factor and "
            "its direction are enclosed rigorously, and every sign is decided for the enclosure.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for other motions."""
        return (
            words.NO_FORECAST,
            "Nothing is said about other motions, nor about other sequences of modes.",
            "Nothing is said about what saturation or friction would make of the growth.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Repeat the sequence, along the motion that grows."""
        evidence, modes = self.evidence, self.system.every_mode
        system = self.system.with_modes(modes, self.system.states, ARBITRARY)
        index = {mode.name: k for k, mode in enumerate(modes)}
        assert evidence.factor is not None
        low = float(evidence.factor[0])
        continuous = system.time is Time.CONTINUOUS
        time, factor = (1 / max(low, 1e-9), math.e) if continuous else (1.0, low)
        steps = [(index[name], float(count) * time) for name, count in evidence.steps]
        run = periodic_run(system, steps, eigenvalue=factor)
        response = run.response
        growth = math.log(factor) * response.time / run.period
        line = (f"factor {number(factor, 4)} each time", np.exp(growth))
        rows = tuple((str(k), *map(str, step)) for k, step in enumerate(evidence.steps, 1))
        title = "The sequence" + (f", its first {_LISTED} parts" if len(rows) > _LISTED else "")
        unit = "1/s" if continuous else "each time"
        return witness(
            Table(title, ("Part", "Mode", "Steps"), rows[:_LISTED]),
            Illustration(
                "run",
                f"The witness over {plural(round(response.time[-1] / run.period), 'period')}",
                "Simulated from the enclosed direction, through contact and flight as the signs of "
                f"the motion say; it grows by {lower(evidence.factor[0])} {unit} at least.",
                draw_run(response, euclidean_norms(response), line, system, EUCLIDEAN),
            ),
        )


class _ValuePage(AbstractKindPage[GrowingSequence]):
    """The page of what is unstable, at that value of the parameter."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "a value of the parameter that is not stable"

    def meaning(self) -> tuple[str, ...]:
        """Say why one value is enough, and what happens there."""
        return (
            "The parameter is unknown and constant, so it may have this one value all the time. "
            "The matrices at this value are computed exactly.",
            *self._part.meaning(),
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for other values."""
        return (
            *self._part.limits(),
            "Nothing is said about other values of the parameter: a narrower range may be stable.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Draw the run of the part at this value."""
        share = self.evidence.share
        assert share is not None
        text = (
            f"{value_text(self.system, share)}: what follows is simulated at this "
            "value of the parameter, between the modes that are listed."
        )
        run = self._part.run()
        return Section(run.title, (Paragraph(text), *run.blocks))

    @property
    def _part(self) -> AbstractKindPage[GrowingSequence]:
        system, evidence = self.evidence.at_value(self.system)
        return _page_of(system, evidence)
