"""Decide the stability of a switched system: searches propose, and here the exact check decides."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

from nrs_design.certificates.certificate import Verdict, common_quadratic_of, refuted_in, verdict_of
from nrs_design.certificates.goals import rate_per_second
from nrs_design.certificates.second_opinion import agrees
from nrs_design.errors import DISAGREE, DesignError, InternalError
from nrs_design.progress import Progress, silent
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import attempted, check_again, take_candidate
from nrs_design.search.certification import Attempt, Certification, Limits
from nrs_design.search.family import Family, floats_in_silence, rate_limit
from nrs_design.search.ladder import applicable_methods, steps
from nrs_design.search.method import Method
from nrs_design.search.statements import asides
from nrs_design.search.structure import merge_equal_modes, triangular_blocks
from nrs_design.search.work import Allowance, Fuse

# Share of the remaining budget for a faster decay rate than the rate of the first proof.
FASTER_SHARE = 0.5
SUSPICIOUS, ENCLOSURE = "suspicious modes", "enclosure of the ranges"
WIDE = (
    "is not stable, and no loop of the spec need be there: nothing that covers the enclosure can "
    "be proved; narrow the ranges"
)


@dataclass(frozen=True)
class _Task:
    """Request for a search, with its budget."""

    method: Method
    limits: Limits
    allowance: Allowance
    progress: Progress


def certify(
    system: SwitchedSystem,
    method: Method = Method.AUTO,
    limits: Limits | None = None,
    progress: Progress = silent,
) -> Certification:
    """Prove or refute uniform exponential stability under arbitrary switching.

    Equal modes are merged, and a family that is block triangular in a common order of the states is
    decided block by block. Then the rungs are climbed, cheapest first, until one decides. Every
    statement has passed the exact check, and flint's second opinion as far as that goes
    (`nrs_design.certificates.second_opinion`).

    A `DesignError` if the method does not apply; a `ClockError` if the clock stopped the search:
    what it would have found is not known; an `InternalError` if two exact computations disagree.
    """
    limits = limits or Limits()
    allowance = _allowance(limits)
    if method is not Method.AUTO and method not in applicable_methods(system):
        raise DesignError(
            f"the method {method} does not apply to this kind of switching and time",
            remedy="use --method auto",
        )
    simple = system.switching.is_arbitrary and system.is_uniform and system.clock is None
    merged = merge_equal_modes(system) if simple else system
    task = _Task(method, limits, allowance, progress)
    # Loss of contact and rounding errors couple the blocks.
    simple = simple and system.contact is None and system.flights is None
    simple = simple and not system.roundings
    blocks = triangular_blocks(merged) if simple else (tuple(range(system.order)),)
    if len(blocks) == 1:
        result = _climb(merged, task)
    else:
        parts = [
            _certify_block(merged, block, replace(task, allowance=allowance.part(1 / left)))
            for left, block in zip(range(len(blocks), 0, -1), blocks, strict=True)
        ]
        result = _combine(merged, blocks, parts)
    statements = _spread_statements(result.statements, merged, system)
    if result.verdict is Verdict.PROVED and limits.more:
        for name, search, part in asides(system, allowance):
            progress(name)
            found, attempt = attempted(name, search, system, part)
            statements += () if found is None else (found,)
            result = replace(result, attempts=(*result.attempts, attempt))
    if merged is not system or len(blocks) > 1:
        check_again(statements, system)
    if not all(agrees(system, statement) for statement in statements):
        raise InternalError(DISAGREE)
    with floats_in_silence():
        limit = rate_limit(system)
    return replace(result, system=system, statements=statements, rate_limit=limit)


def refuted_at_once(system: SwitchedSystem, limits: Limits | None = None) -> str | None:
    """Tell in which contact a mode, or a round of two, grows: of those that are suspected.

    Floating point suspects, exact tests decide. Empty for any contact, None if none grows.
    """
    from nrs_design.search.period import search_rounds
    from nrs_design.search.unstable_mode import examine_suspicious_modes

    with floats_in_silence():
        family = Family.of(system, _allowance(limits or Limits()))
    search = examine_suspicious_modes if system.clock is None else search_rounds
    evidence, _ = take_candidate(partial(search, family), system, family.allowance)
    if evidence is None:
        return None
    if not agrees(system, evidence):
        raise InternalError(DISAGREE)
    return refuted_in(system, (evidence,)) or ""


def _allowance(limits: Limits) -> Allowance:
    return Allowance(limits.budget, limits.memory, Fuse.of(limits.budget))


def _certify_block(system: SwitchedSystem, block: tuple[int, ...], task: _Task) -> Certification:
    """Certify the family of one diagonal block."""
    from nrs_design.proof.evidence.block_triangular import diagonal_block

    full = diagonal_block(system, block)
    merged = merge_equal_modes(full)
    result = _climb(merged, task)
    return replace(
        result, system=full, statements=_spread_statements(result.statements, merged, full)
    )


def _climb(system: SwitchedSystem, task: _Task) -> Certification:
    """Try one rung after the other until one decides, or the budget is used up."""
    method, limits, allowance = task.method, task.limits, task.allowance
    with floats_in_silence():
        family = Family.of(system, allowance, optimize_rate=limits.optimize_rate)
    attempts: list[Attempt] = []
    remarks: list[AbstractEvidence] = []
    best: tuple[str, AbstractEvidence] | None = None

    def known() -> frozenset[Shows]:
        statements = remarks if best is None else (best[1], *remarks)
        return frozenset(evidence.shown(system) for evidence in statements)

    for name, search in steps(system, method, limits, allowance, known):
        if attempts and family.allowance.left <= 0:
            spent = f"not begun: the budget of {allowance.total:g} is used up (--budget)"
            attempts.append(Attempt(name, spent, 0.0))
            break
        task.progress(name)
        evidence, attempt = attempted(name, partial(search, family), system, family.allowance)
        attempts.append(attempt)
        if evidence is None:
            # Nothing that covers the enclosure holds, and no loop of the spec need be there.
            if method is not Method.PERIOD and (corner := _unstable_corner(name, family)):
                attempts.append(Attempt(ENCLOSURE, f"mode {corner} {WIDE}", 0.0))
                break
            continue
        # Growth by a pull of the environment does not end the search.
        if evidence.shown(system) in (Shows.NO_COMMON_QUADRATIC, Shows.INSTABILITY_IN_CONTACT):
            remarks.append(evidence)
            continue
        if best is None and _may_be_faster(evidence, system, limits):
            # Later rungs need a part of the budget.
            family = replace(family, allowance=allowance.part(FASTER_SHARE))
        if best is None or _is_faster(evidence, best[1], system):
            best = name, evidence
        if not _may_be_faster(best[1], system, limits):
            break
    if best is None:
        return _conclude(system, str(method), tuple(remarks), tuple(attempts))
    return _conclude(system, best[0], (best[1], *remarks), tuple(attempts))


def _may_be_faster(evidence: AbstractEvidence, system: SwitchedSystem, limits: Limits) -> bool:
    """Tell whether the required decay rate is not proved yet, and within reach."""
    required_rate, rate = limits.decay_rate, evidence.proved_rate(system)
    if required_rate is None or not limits.optimize_rate or evidence.shows is not Shows.STABILITY:
        return False
    shown = rate_per_second(rate, system)
    if shown is None or shown >= required_rate:
        return False
    with floats_in_silence():
        limit = rate_per_second(rate_limit(system), system)
    return limit is None or limit > required_rate


def _is_faster(candidate: AbstractEvidence, best: AbstractEvidence, system: SwitchedSystem) -> bool:
    """Tell whether a proof shows more decay than another, of all that the other is about."""
    rates = [rate_per_second(item.proved_rate(system), system) for item in (candidate, best)]
    if rates[0] is None or rates[1] is None or rates[0] <= rates[1]:
        return False
    return all(
        getattr(candidate, ability) >= getattr(best, ability)
        for ability in ("covers_lost_contact", "covers_rounding", "covers_clock")
    )


def _unstable_corner(rung: str, family: Family) -> str | None:
    """Name a mode that is not stable and need not be attained, after it has been looked for."""
    if rung != SUSPICIOUS or not family.system.enclosures:
        return None
    from nrs_design.search.unstable_mode import find_unstable_corner

    with floats_in_silence():
        return find_unstable_corner(family)


def _conclude(
    system: SwitchedSystem,
    method: str,
    statements: tuple[AbstractEvidence, ...],
    attempts: tuple[Attempt, ...],
) -> Certification:
    status = common_quadratic_of(system, statements)
    return Certification(
        system, verdict_of(system, statements), status, method, statements, attempts
    )


def _spread_statements(
    statements: tuple[AbstractEvidence, ...], merged: SwitchedSystem, system: SwitchedSystem
) -> tuple[AbstractEvidence, ...]:
    """Carry evidence over from merged modes to all modes."""
    if merged is system:
        return statements
    return tuple(statement.spread(merged, system) for statement in statements)


def _combine(
    system: SwitchedSystem, blocks: tuple[tuple[int, ...], ...], parts: list[Certification]
) -> Certification:
    """Put the certifications of the diagonal blocks together."""
    from nrs_design.proof.evidence import BlockTriangular

    attempts = tuple(
        replace(attempt, step=f"block {k + 1}: {attempt.step}")
        for k, part in enumerate(parts)
        for attempt in part.attempts
    )
    statements: list[AbstractEvidence] = []
    refuted = [k for k, part in enumerate(parts) if part.verdict is Verdict.REFUTED]
    deciding = tuple((k, part.evidence) for k, part in enumerate(parts) if part.evidence)
    if refuted:
        statements.append(BlockTriangular(blocks, ((refuted[0], parts[refuted[0]].statements[0]),)))
    elif len(deciding) == len(blocks):
        statements.append(BlockTriangular(blocks, deciding))
    for k, part in enumerate(parts):
        for statement in part.statements:
            if statement.shows is Shows.NO_COMMON_QUADRATIC:
                statements.append(BlockTriangular(blocks, ((k, statement),)))
    method = "blocks: " + ", ".join(dict.fromkeys(part.method for part in parts))
    return _conclude(system, method, tuple(statements), attempts)
