"""Evidence of stability: forms on the state, how they decrease, and a run below their bound."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from nrs_design.proof.bounds import at_most
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.offers import Form, Offer, Page
from nrs_design.reporting.evidence.runs import (
    Greedy,
    bounded_run,
    freely_switched,
    ruled_run,
    slowest_in_a_round,
    trials_per_step,
)
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.norms import (
    Array,
    Norm,
    clipped,
    modes_at_corner,
    polynomial_norm,
    quadratic_norm,
    scaled_matrices,
)
from nrs_design.simulation.switched import fine_step, mode_rates, sampled_direction, worst_direction

# Larger matrices, and more of them, do not fit on a page.
_MAX_ORDER, _TABLES = 8, 2


def norms_of(forms: Sequence[Form], order: int) -> list[Norm]:
    """Return the root of each form; quadratic ones are all divided by the same number."""
    if forms[0].degree == 1:
        return [quadratic_norm(Q) for Q in scaled_matrices(*(form.Q for form in forms))]
    return [polynomial_norm(form.Q, form.degree, order) for form in forms]


def largest_norm(forms: Sequence[Form], order: int) -> Norm:
    """Return the largest root of the forms in contact, and in free motion of those for it.

    Without forms for free motion, those in contact hold there with the deflection at zero.
    """
    norms = norms_of(forms, order)
    touching = [norm for norm, form in zip(norms, forms, strict=True) if not form.free]
    free = [norm for norm, form in zip(norms, forms, strict=True) if form.free]

    def contact_norm(states: Array) -> Array:
        return np.asarray(np.max([norm(states) for norm in touching], axis=0))

    def everywhere(states: Array) -> Array:
        flying = np.max([norm(states[..., :-1]) for norm in free], axis=0)
        return np.asarray(np.where(states[..., -1] > 0, contact_norm(states), flying))

    return everywhere if free else contact_norm


def step_norms(forms: Sequence[Form], system: SwitchedSystem) -> list[Norm]:
    """Return the norm of every step of a round; in free motion without the deflection."""
    norms = norms_of(forms, system.order)
    return norms if system.contact is None else [clipped(norm) for norm in norms]


def matrix_tables(forms: Sequence[Form], states: tuple[str, ...]) -> list[Table]:
    """Return the matrices of the first quadratic forms as tables, if a page holds them."""
    if forms[0].degree > 1:
        return []
    matrices = scaled_matrices(*(form.Q for form in forms))
    named_matrices = list(zip(forms, matrices, strict=True))[:_TABLES]
    return [
        _table(form.name, Q, states[: len(Q)]) for form, Q in named_matrices if len(Q) <= _MAX_ORDER
    ]


def _table(name: str, Q: Array, states: tuple[str, ...]) -> Table:
    rows = tuple((name, *(number(v, 5) for v in row)) for name, row in zip(states, Q, strict=True))
    return Table(f"Q{name and f' of {name}'}, divided by the largest entry", ("", *states), rows)


# A run in the norm of a polynomial, or of many functions, tries no more modes.
_MODES = 32
_MONOMIALS = (
    "V = z' Q z, z being all monomials of degree {degree} in the states. For every decrease it "
    "holds a form in z that vanishes identically; added to the decrease, it makes a positive "
    "definite matrix. The level curves of V need not be ellipses, as those of a quadratic function "
    "are."
)


def functions_page(system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer) -> Page:
    """Return the matrices, the rate of every mode in them, and a run."""
    functions = _Functions(system, evidence, offer)
    return Page(
        functions.name, functions.meaning, functions.limits, functions.run, functions.sections
    )


@dataclass(frozen=True)
class _Functions:
    system: SwitchedSystem
    evidence: AbstractEvidence
    offer: Offer

    @property
    def name(self) -> str:
        """Degree and scope of the functions."""
        degree = 2 * self._form.degree
        text = "quadratic function" if degree == 2 else f"polynomial of degree {degree}"
        if self.system.clock is not None:
            text += f" of each {_turn(self.system.clock)}"
        elif len(self._touching) > 1:
            text += " of each mode"
        elif not self._covers_contact_loss:
            text = f"common {text}"
        return text + " for contact and free motion" * self._covers_contact_loss

    @property
    def meaning(self) -> tuple[str, ...]:
        """State function, bound, assumptions and decision."""
        system = self.system
        sentences = list(
            words.function(
                system,
                covers_contact_loss=self._covers_contact_loss,
                has_several=len(self._touching) > 1,
            )
        )
        if self._ruled:
            sentences += (
                words.ruled_bound(system),
                *words.needed_rules(system, self.offer.leaving),
            )
        else:
            sentences += (words.free_bound(system), *words.unneeded_constant(system))
            sentences += words.unneeded_rules(system)
        return (*sentences, words.decision(system, ruled=self._ruled))

    @property
    def limits(self) -> tuple[str, ...]:
        """Name inadmissible signals and inputs that move the equilibrium."""
        signal_limits = (
            words.outside_the_rules(self.system, self.offer.leaving) if self._ruled else ()
        )
        return (
            *signal_limits,
            *words.function_limits(self.system, covers_contact_loss=self._covers_contact_loss),
        )

    def sections(self) -> tuple[Section, ...]:
        """Show the forms of the certificate."""
        tables = matrix_tables(self._touching, self.system.states)
        return (Section(EVIDENCE, (Paragraph(self._text()), *tables)),)

    def run(self) -> Section:
        """Draw a run below the bound."""
        system, forms, rate = self.system, self.offer.forms, float(self._rate)
        if self._ruled:
            return ruled_run(system, forms, rate, leaving=bool(self.offer.leaving))
        if system.clock is not None:
            norms = step_norms(forms, system)
            greedy = Greedy(system, system, norms, slowest_in_a_round(system, norms), rate)
            return bounded_run(greedy, "in the norm of its step")
        norm, label = largest_norm(forms, system.order), "(largest norm)"
        trials = trials_per_step(system)
        if len(forms) == 1 and self._form.degree == 1:
            label, (Q,) = "in the norm of Q", scaled_matrices(self._form.Q)
            played = freely_switched(system, Q, trials)
            initial = worst_direction(played, Q)
        else:
            label = f"in V^(1/{2 * self._form.degree})" if len(forms) == 1 else label
            played = freely_switched(system, None, min(trials, _MODES))
            initial = sampled_direction(played, norm, fine_step(played))
        if self._covers_contact_loss:
            played = replace(played, contact=system.contact)
            norm = norm if any(form.free for form in forms) else clipped(norm)
            initial = initial if initial[-1] > 0 else -initial
        return bounded_run(Greedy(system, played, norm, initial, rate), label)

    @property
    def _form(self) -> Form:
        return self.offer.forms[0]

    @property
    def _touching(self) -> tuple[Form, ...]:
        return tuple(form for form in self.offer.forms if not form.free)

    @property
    def _covers_contact_loss(self) -> bool:
        return self.system.contact is not None and self.evidence.covers_lost_contact

    @property
    def _ruled(self) -> bool:
        return not self.evidence.bounds_at_once and not self.evidence.covers_mixtures

    @property
    def _rate(self) -> Fraction:
        rate = self.evidence.proved_rate(self.system)
        assert rate is not None  # it shows stability
        return rate

    def _text(self) -> str:
        """State the content of the certificate and the constant in the Euclidean norm."""
        forms, touching = self.offer.forms, self._touching
        function_owner = "mode" if self.system.clock is None else _turn(self.system.clock)
        text = "The certificate holds one function for all modes"
        if len(touching) > 1:
            text = f"The certificate holds {len(touching)} functions, one for each {function_owner}"
        if len(forms) > len(touching):
            text += f" in contact, and {len(forms) - len(touching)} for free motion"
        if self._form.degree > 1:
            return f"{text}: {_MONOMIALS.format(degree=self._form.degree)}"
        text += (
            f": x' Q x. Numbers are written with denominator 2^{self.offer.denominator_log2}; here "
            "matrices are divided by the largest entry of any."
        )
        if self._covers_contact_loss or self.system.clock is not None or self.offer.leaving:
            return text
        matrices = scaled_matrices(*(form.Q for form in forms))
        spectra = np.array([np.linalg.eigvalsh(Q)[[0, -1]] for Q in matrices])
        c = math.sqrt(spectra.max() / spectra.min())
        size = f"{at_most(Fraction(c))} (floating point)" if np.isfinite(c) else "beyond floats"
        return (
            f"{text} In the Euclidean norm of the states, in their units, the bound holds with a "
            f"constant c in front: c {size}."
        )


def _turn(clock: Clock) -> str:
    """Say what there is a function of."""
    if clock.counts_stays:
        return "sample of a stay"
    return "step of a round" if clock.is_round else "state of the rule for misses"


_CONSTANT = (
    "These parameters must be constant: one value each in all modes and at all times. Which "
    "values, need not be known. With two more matrices for each mode the condition is affine in "
    "what depends on them, so the corners of their ranges decide for all values between."
)
_TEXT = (
    "The certificate holds P at the corners of the constant parameters, and two more matrices for "
    "each mode, which are not shown. They are written with denominator 2^{}; here all P are "
    "divided by the largest entry."
)


def constants_page(system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer) -> Page:
    """Return the page of P at every corner of the constant parameters, with free switching."""
    norm_note = "Which norm |x| is, depends on the values of the constant parameters."
    text = Paragraph(_TEXT.format(offer.denominator_log2))
    return Page(
        "quadratic function of constant parameters",
        (
            f"{words.free_bound(system)} {norm_note}",
            _CONSTANT,
            *words.unneeded_rules(system),
            words.decision(system),
        ),
        ("A constant parameter that changes while the system moves, however slowly.",),
        lambda: _run_at_corner(system, evidence, offer),
        lambda: (Section(EVIDENCE, (text, *matrix_tables(offer.forms, system.states))),),
        "however fast they change, the constant ones excepted",
    )


def _run_at_corner(system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer) -> Section:
    """Draw a run at the corner where the decay is slowest."""
    forms = scaled_matrices(*(form.Q for form in offer.forms))
    corners = [modes_at_corner(system, k) for k in range(len(forms))]
    slowest = max if system.time is Time.DISCRETE else min
    rates = [slowest(mode_rates(corner, P)) for corner, P in zip(corners, forms, strict=True)]
    k = rates.index(slowest(rates))
    fixed, P, proved = corners[k], forms[k], evidence.proved_rate(system)
    assert proved is not None  # it shows stability
    played = freely_switched(fixed, P, trials_per_step(fixed))
    return bounded_run(
        Greedy(fixed, played, quadratic_norm(P), worst_direction(played, P), float(proved)),
        "in the norm of P at this corner",
        f"The constant parameters stay at corner {k + 1}, where the decay is slowest. ",
    )
