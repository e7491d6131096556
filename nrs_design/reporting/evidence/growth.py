"""Instability: a motion that does not decay; and why no common quadratic function exists."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nrs_design.proof.bounds import lower
from nrs_design.proof.constant import system_at
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import ARBITRARY
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.offers import Offer, Page, offer_of
from nrs_design.reporting.evidence.runs import EUCLIDEAN, Bound
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import number, roots
from nrs_design.simulation.periodic import (
    PeriodicRun,
    mixture_matrix,
    periodic_run,
    time_of_growth,
)
from nrs_design.simulation.switched import (
    SwitchedRun,
    all_modes,
    mode_eigenvalues,
    single_mode_system,
)

_TITLE = "Simulated witness"
_MODE = "a mode that is not stable"
_AVERAGE = "an average that is not stable"
_PERIOD = "a period that grows"
_CONTACT = "a motion that grows while contact is lost and made"
_MODE_TEXT = (
    "The mode has an eigenvalue outside the open {region}. Staying in this mode forever is one of "
    "the switching signals that the spec allows, so exponential stability under {signals} is "
    "impossible. The decision is exact; the eigenvalue is printed for the reader."
)
_AVERAGE_TEXT = (
    "If the modes were exponentially stable under arbitrary switching, uniformly over all signals, "
    "then so would be every average of them, which fast switching comes near to. This average is "
    "not stable, so no such guarantee is possible. The decision is exact; the eigenvalue is "
    "printed for the reader."
)
_PERIODIC = (
    "The signal keeps every rule that the spec declares. Repeated forever, it multiplies some "
    "state by a factor above one in every period, so no stability of any kind can be guaranteed "
    "under {signals}. The matrix of one period is enclosed rigorously; a power of it has a trace "
    "that only an eigenvalue outside the unit circle can explain."
)
_CONTACT_TEXT = (
    "The motion makes its sequence of contact and flight by itself: the environment acts only "
    "where the deflection is positive, and never pulls. Larger each time, it goes on for ever, so "
    "no stability of any kind can be guaranteed under {signals} with contact that may be lost. Its "
    "factor and its direction are enclosed rigorously, and every sign is decided for the enclosure."
)
_VALUE_TEXT = (
    "The parameter is unknown and constant, so it may have this one value all the time. The "
    "matrices at this value are computed exactly."
)
_VALUE_CAPTION = "Simulated at the value of the parameter that the claim names."
_FASTEST_CAPTION = (
    "Simulated from the direction that grows the most, with every mode for its time and every "
    "reset of its switches."
)
_CONTACT_CAPTION = (
    "Simulated from the enclosed direction, through contact and flight as the signs of the motion "
    "say."
)
_STAYING = (
    "Simulated from the eigenvector of the eigenvalue: the state does not decay. No other mode is "
    "used, which the switching allows."
)
_GROWTH_LINE = "The dashed line is the growth per period, carried on."
_VALUE_SCOPE = (
    "Nothing is said about other values of the parameter: a narrower range may be stable."
)
_SIGNAL_SCOPE = (
    "Nothing is said about slower switching, other signals and other motions: a longer dwell time, "
    "fewer transitions or narrower ranges, or modes that are left soon enough, may make the system "
    "stable."
)
_LINEAR = "Nothing is said about what saturation or friction would make of the growth."
_BORDER_NOTE = (
    "An eigenvalue exactly on the border means that states need not decay; they need not grow "
    "either."
)


def growth_page(system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer) -> Page:
    """Return why one motion is enough, and the run that repeats its sequence of modes."""
    if offer.shares:
        return _describe_constant_value(system, offer)
    run, caveat = _repeated, _LINEAR
    if offer.weights:
        name, meaning, run, caveat = _AVERAGE, _AVERAGE_TEXT, _average, _BORDER_NOTE
    elif offer.factor is not None:
        name, meaning = _CONTACT, _CONTACT_TEXT
    elif [time for _, time in offer.steps] == [0]:
        name, meaning, run, caveat = _MODE, _MODE_TEXT, _run_one_mode, _BORDER_NOTE
    else:
        name, meaning = _PERIOD, _PERIODIC
    region = "unit disk" if system.time is Time.DISCRETE else "left half plane"
    arbitrary = system.switching.is_arbitrary
    signals = "arbitrary switching" if arbitrary else "the declared switching"
    return Page(
        name,
        (meaning.format(signals=signals, region=region),),
        (words.NO_FORECAST, _SIGNAL_SCOPE, caveat),
        lambda: Section(_TITLE, tuple(run(system, offer))),
    )


def _describe_constant_value(system: SwitchedSystem, offer: Offer) -> Page:
    """Return the page of instability at one value of the constant parameters."""
    ((_, part),) = offer.parts
    page = growth_page(system_at(system, offer.shares), part, offer_of(part))
    run = page.run
    assert run is not None  # it shows instability
    return Page(
        "a value of the parameter that is not stable",
        (_VALUE_TEXT, *page.meaning),
        (*page.limits, _VALUE_SCOPE),
        lambda: Section(_TITLE, (Paragraph(_VALUE_CAPTION), *run().blocks)),
    )


def _run_one_mode(system: SwitchedSystem, offer: Offer) -> Iterator[Block]:
    """Stay in the mode, from the eigenvector of its worst eigenvalue."""
    ((name, _),) = offer.steps
    modes, discrete = (*system.modes, *system.free_motions()), system.time is Time.DISCRETE
    index = [mode.name for mode in modes].index(name)
    single = replace(
        single_mode_system(replace(system, modes=modes), index), switching=ARBITRARY, clock=None
    )
    (values,) = mode_eigenvalues(single)
    worst = complex(values[np.argmax(np.abs(values) if discrete else values.real)])
    response = periodic_run(single, [(0, time_of_growth(worst, single))]).response
    rate = math.log(abs(worst)) if discrete else worst.real
    label = f"{abs(worst):.4g}^t" if discrete else f"exp({worst.real:.4g} t)"
    line = (f"the eigenvalue alone, {label}", np.exp(rate * response.time))
    yield _illustrate(f"Staying in mode {name}", _STAYING, response, single, line)


def _average(system: SwitchedSystem, offer: Offer) -> Iterator[Block]:
    """Say where the eigenvalues of the average are."""
    values = np.linalg.eigvals(mixture_matrix(system, offer.weights)).astype(complex)
    yield Paragraph(f"Eigenvalues of the average: {roots(values.tolist(), 6)} 1/s.")


def _repeated(system: SwitchedSystem, offer: Offer) -> Iterator[Block]:
    """Repeat the sequence, from the direction that grows the most, or that keeps its signs."""
    discrete, start, edges, time = system.time is Time.DISCRETE, None, offer.edges, 1.0
    caption = _FASTEST_CAPTION
    if offer.factor is not None:
        system = all_modes(system)
        system = system.with_modes(system.modes, system.states, ARBITRARY)
        # In continuous time, the sequence has one mode, and `factor` is a rate in 1/s.
        start, edges, low = float(offer.factor), (), float(offer.factor)
        if not discrete:
            time, start = 1 / max(low, 1e-9), math.e
        unit = "each time" if discrete else "1/s"
        caption = f"{_CONTACT_CAPTION} It grows by {lower(offer.factor)} {unit} at least."
    names = [mode.name for mode in system.modes]
    steps = [(names.index(name), time * float(count)) for name, count in offer.steps]
    run = periodic_run(system, steps, edges, start)
    if offer.factor is None:
        yield _factor(run, len(steps), discrete=discrete)
    response = run.response
    periods = counted(round(response.time[-1] / run.period), "period")
    growth = np.exp(math.log(run.radius) * response.time / run.period)
    line = (f"factor {number(run.radius, 4)} per period", growth)
    caption = f"{caption} {_GROWTH_LINE}"
    yield _illustrate(f"The witness over {periods}", caption, response, system, line)


def _illustrate(
    title: str, caption: str, response: SwitchedRun, system: SwitchedSystem, line: Bound
) -> Illustration:
    norms = np.linalg.norm(response.state, axis=1)
    figure = draw_run(response, norms / norms[0], line, system, EUCLIDEAN)
    return Illustration("run", title, caption, figure)


def _factor(run: PeriodicRun, steps: int, *, discrete: bool) -> Paragraph:
    """Say how long a period is, and by which factor a state grows in it."""
    unit = "steps" if discrete else "s"
    rate = number(math.log(run.radius) / run.period, 4)
    mean = "" if discrete else f", a mean growth rate of {rate} 1/s"
    return Paragraph(
        f"One period lasts {run.period:.6g} {unit} and has {counted(steps, 'step')}. Over one "
        f"period some state grows by the factor {number(run.radius, 6)}{mean}. The certificate "
        "shows with rigorous enclosures that the factor is above one; these digits are floating "
        "point."
    )


_MAX_ROWS = 24
_MEANING = (
    "That no common quadratic function exists says nothing about stability: a function of another "
    "kind may exist."
)
_ARGUMENT = (
    "The certificate holds a positive semidefinite matrix X for some modes, such that the sum S of "
    "{} over them is positive definite. If some Q > 0 decreased in every mode, then the trace of "
    "Q S would be positive, and equal to the sum of the traces of X ({}), which is at most zero: a "
    "contradiction. A search for a common quadratic function can stop."
)
_TERMS = {
    Time.CONTINUOUS: ("A X + X A'", "A'Q + QA"),
    Time.DISCRETE: ("A X A' - X", "A'QA - Q"),
}


def obstruction_page(system: SwitchedSystem, _: AbstractEvidence, offer: Offer) -> Page:
    """Return the argument, and the modes that contradict each other."""

    def sections() -> tuple[Section, ...]:
        text = f"{_ARGUMENT.format(*_TERMS[system.time])} {_MEANING}"
        heaviest = offer.weights[:_MAX_ROWS]
        rows = tuple((name, number(float(share), 4)) for name, share in heaviest)
        scope = f", the {_MAX_ROWS} heaviest" if len(offer.weights) > _MAX_ROWS else ""
        title = f"Weight of the modes in the contradiction{scope}"
        table = Table(title, ("Mode", "Share of the trace of X [1]"), rows)
        return (Section("No common quadratic function", (Paragraph(text), table)),)

    name = "no common quadratic function exists"
    return Page(name, (_MEANING,), (), sections=sections)
