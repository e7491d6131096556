"""Decide the stability of a switched system: the ladder of searches, cheapest first."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import islice, zip_longest
from time import perf_counter

from numpy.linalg import LinAlgError

from nrs_design.certificates.certificate import (
    Verdict,
    common_quadratic_of,
    verdict_of,
)
from nrs_design.errors import DISAGREE, DesignError, InternalError
from nrs_design.proof.evidence import (
    AbstractEvidence,
    BlockTriangular,
    Shows,
)
from nrs_design.proof.evidence.block_triangular import diagonal_block
from nrs_design.proof.evidence.common_polynomial import MAX_DEGREE, MAX_MONOMIALS
from nrs_design.proof.evidence.unstable_mode import affordable, is_stable
from nrs_design.proof.exact import TooLargeError
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.system import Mode, SwitchedSystem, Time
from nrs_design.search.allowance import Allowance, Cost, NotAffordableError
from nrs_design.search.certification import Attempt, Certification, Limits, Method
from nrs_design.search.checker import Checker
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.gradient_settings import Gradient
from nrs_design.search.limits import rate_limit
from nrs_design.search.mode_quadratic import functions_cost
from nrs_design.search.polynomial import highest_degree, polynomial_cost
from nrs_design.search.rungs import (
    Finding,
    Rung,
    decide_one_state,
    examine_every_mode,
    examine_suspicious_modes,
    prove_obstruction,
    search_by_gradient,
    search_by_lmi,
    search_mixture,
    search_mode_polynomial,
    search_mode_quadratic,
    search_parameter_quadratic,
    search_period,
    search_polynomial,
    search_preconditioned,
    search_raw,
    search_switching_at_values,
    search_value,
)
from nrs_design.search.structure import merge_equal_modes, stand_in, triangular_blocks

Progress = Callable[[str], None]

# Degrees that are tried before a search for growing periods, which is quicker than higher ones.
FIRST_DEGREES = 2


def certify(
    system: SwitchedSystem,
    method: Method = Method.AUTO,
    limits: Limits | None = None,
    progress: Progress = lambda step: None,
) -> Certification:
    """Prove or refute uniform exponential stability under arbitrary switching.

    Equal modes are merged, and a family that is block triangular in a common order of the states
    is decided block by block. Then the rungs are climbed, cheapest first, until one decides.

    Parameters
    ----------
    system : SwitchedSystem
        Exact modes.
    method : Method
        One rung, or all of them in turn.
    limits : Limits, optional
        How far to go.
    progress : callable
        Told the name of each rung as it begins.

    Returns
    -------
    Certification
        Every statement in it has passed the exact check, and flint's second opinion as far as
        that goes (`nrs_design.proof.second_opinion`).

    Raises
    ------
    DesignError
        If the method does not apply to the system, or settings of the gradient iteration do not
        apply to the method or the modes.
    InternalError
        If two exact computations disagree.
    """
    limits = limits or Limits()
    allowance = Allowance(limits.budget, limits.memory)
    if method is not Method.AUTO and method not in _applicable(system) | {Method.MODE_QUADRATIC}:
        raise DesignError(
            f"the method {method} does not apply to this kind of switching and time",
            remedy="use --method auto",
        )
    _check_gradient(system, method, limits.gradient)
    simple = system.switching.is_arbitrary and system.is_uniform
    merged = merge_equal_modes(system) if simple else system
    limits = _limits_for(merged, system, limits)
    blocks = triangular_blocks(merged) if simple else (tuple(range(system.order)),)
    checker = Checker(system)
    if len(blocks) == 1:
        checker_of_merged = checker if merged is system else Checker(merged)
        result = _climb(checker_of_merged, method, limits, allowance, progress)
    else:
        parts = [
            _certify_block(merged, block, method, limits, allowance.part(1 / left), progress)
            for left, block in zip(range(len(blocks), 0, -1), blocks, strict=True)
        ]
        result = _combine(merged, blocks, parts)
    statements = _spread(result.statements, merged, system)
    for statement in statements:
        if fault := checker.find_fault(statement):
            raise InternalError(f"the search returned evidence that does not hold: {fault}")
        if not agrees(system, statement):
            raise InternalError(DISAGREE)
    with floats_in_silence():
        limit = rate_limit(system)
    return replace(result, system=system, statements=statements, rate_limit=limit)


def _certify_block(
    system: SwitchedSystem,
    block: tuple[int, ...],
    method: Method,
    limits: Limits,
    allowance: Allowance,
    progress: Progress,
) -> Certification:
    """Certify the family of one diagonal block."""
    full = diagonal_block(system, block)
    merged = merge_equal_modes(full)
    limits = _limits_for(merged, full, limits)
    result = _climb(Checker(merged), method, limits, allowance, progress)
    return replace(
        result,
        system=full,
        statements=_spread(result.statements, merged, full),
    )


def _check_gradient(system: SwitchedSystem, method: Method, gradient: Gradient) -> None:
    """Refuse settings of the gradient iteration that would not be kept."""
    if gradient != Gradient() and method not in {Method.AUTO, Method.GRADIENT}:
        raise DesignError(
            f"the method {method} has no use for settings of the gradient iteration",
            remedy="use --method gradient, or leave them out",
        )
    names = [mode.name for mode in system.modes]
    if gradient.start is not None and gradient.start not in names:
        raise DesignError(
            f"the gradient iteration cannot start with mode {gradient.start!r}: there is none",
            remedy=f"one of {', '.join(names)}",
        )


def _limits_for(merged: SwitchedSystem, system: SwitchedSystem, limits: Limits) -> Limits:
    """Let the gradient iteration start with the mode that stands for the wanted one."""
    start = stand_in(limits.gradient.start, system, merged)
    return replace(limits, gradient=replace(limits.gradient, start=start))


def _climb(
    checker: Checker, method: Method, limits: Limits, allowance: Allowance, progress: Progress
) -> Certification:
    """Try one rung after the other until one decides, or the budget is used up."""
    system = checker.system
    with floats_in_silence():
        family = Family.checked_by(checker, allowance)
    attempts: list[Attempt] = []
    remarks: list[AbstractEvidence] = []
    for name, rung in _rungs(system, method, limits, allowance, remarks):
        start = perf_counter()
        if attempts and allowance.left <= 0:
            spent = f"not begun: the budget of {allowance.total:g} s is used up (--budget)"
            attempts.append(Attempt(name, spent, 0.0))
            break
        progress(name)
        evidence, outcome = _take(rung, family)
        attempts.append(Attempt(name, outcome, perf_counter() - start))
        if evidence is None:
            continue
        if evidence.shows is Shows.NO_COMMON_QUADRATIC:
            remarks.append(evidence)
            continue
        return _conclude(system, name, (evidence, *remarks), tuple(attempts))
    return _conclude(system, str(method), tuple(remarks), tuple(attempts))


def _rungs(
    system: SwitchedSystem,
    method: Method,
    limits: Limits,
    allowance: Allowance,
    remarks: list[AbstractEvidence],
) -> Iterator[tuple[str, Rung]]:
    """Yield the rungs, cheapest first; what has been shown so far decides what is worth trying."""
    wanted = _applicable(system) if method is Method.AUTO else {method}
    if system.is_uniform:
        yield "suspicious modes", examine_suspicious_modes
    if Method.LMI in wanted and system.order == 1:
        yield "one state", decide_one_state
    elif Method.LMI in wanted:
        yield "lmi", partial(search_by_lmi, optimize_rate=limits.optimize_rate)
    if Method.OBSTRUCTION in wanted:
        yield "obstruction", prove_obstruction
    if Method.LMI in wanted and system.order > 1 and not remarks:
        # The solver may have stalled: other coordinates, before giving up on quadratics.
        yield "lmi, raw", search_raw
        yield "lmi, preconditioned", search_preconditioned
    if Method.GRADIENT in wanted and not remarks:
        yield (
            "gradient",
            partial(
                search_by_gradient, settings=limits.gradient, optimize_rate=limits.optimize_rate
            ),
        )
    yield "every mode", examine_every_mode
    if Method.VALUE in wanted:
        yield "constant values", search_value
    if Method.PARAMETER_QUADRATIC in wanted:
        yield "parameter quadratic", search_parameter_quadratic
    if Method.MODE_QUADRATIC in wanted:
        yield "mode quadratic", search_mode_quadratic
    if Method.MIXTURE in wanted:
        yield "mixture", search_mixture
    ladders = []
    if Method.POLYNOMIAL in wanted:
        ladders.append(_common_polynomials(system, limits, allowance))
    if Method.MODE_POLYNOMIAL in wanted:
        ladders.append(_mode_polynomials(system, limits, allowance))
    for ladder in ladders:
        yield from islice(ladder, FIRST_DEGREES)
    if Method.PERIOD in wanted:
        yield "period", search_period
    if Method.VALUE in wanted:
        yield "switching at constant values", search_switching_at_values
    for rungs in zip_longest(*ladders):
        yield from (rung for rung in rungs if rung is not None)


def _common_polynomials(
    system: SwitchedSystem, limits: Limits, allowance: Allowance
) -> Iterator[tuple[str, Rung]]:
    """Yield common polynomials of rising degree."""
    search = partial(partial, search_polynomial, optimize_rate=limits.optimize_rate)
    cost = partial(polynomial_cost, system.order, len(system.modes))
    return _rising(
        "polynomial", system, limits, allowance, lambda d: (cost(d)[0], search(degree=d))
    )


def _mode_polynomials(
    system: SwitchedSystem, limits: Limits, allowance: Allowance
) -> Iterator[tuple[str, Rung]]:
    """Yield polynomials for each mode of rising degree."""
    search = partial(partial, search_mode_polynomial)
    cost = partial(functions_cost, system)
    name = "mode polynomial"
    return _rising(name, system, limits, allowance, lambda d: (cost(d)[0], search(degree=d)))


def _rising(
    name: str,
    system: SwitchedSystem,
    limits: Limits,
    allowance: Allowance,
    rung_of: Callable[[int], tuple[Cost, Rung]],
) -> Iterator[tuple[str, Rung]]:
    """Yield rungs of rising degree, and at last the reason why there is no higher one.

    Degrees rise while they are predicted to fit into what is left of the budget, so how far they
    rise does not depend on the machine. In one state, all forms of a degree are alike.
    """
    if system.order == 1:
        return
    for d in range(2, highest_degree(system.order) + 1):
        step = f"{name} of degree {2 * d}"
        if limits.max_degree is not None and 2 * d > limits.max_degree:
            yield step, _refuse(f"not tried: --max-degree is {limits.max_degree}")
            return
        cost, rung = rung_of(d)
        fits = allowance.affords(cost)
        yield step, rung
        if not fits:
            return
    held = f"a certificate holds at most {MAX_MONOMIALS} monomials and degree {MAX_DEGREE}"
    yield f"{name} of higher degree", _refuse(f"not tried: {held}")


def _refuse(reason: str) -> Rung:
    """Return a rung that is not tried."""
    return lambda family: (None, reason)


def _applicable(system: SwitchedSystem) -> set[Method]:
    """Return the rungs that can decide a system with its kind of switching."""
    switching = system.switching
    wanted = {Method.MODE_QUADRATIC}
    if system.time is Time.DISCRETE and not (switching.is_arbitrary or switching.fixed_ends):
        wanted |= {Method.MODE_POLYNOMIAL}
    left = affordable(_left_modes(system))
    if any(not (fits and is_stable(mode.A, system.time)) for mode, fits in left):
        return wanted | ({Method.PERIOD} if system.is_uniform else set())
    if system.is_uniform and not switching.resets:
        wanted |= {Method.LMI, Method.OBSTRUCTION, Method.POLYNOMIAL, Method.GRADIENT}
    if system.is_uniform:
        wanted |= {Method.PERIOD}
    if switching.is_arbitrary:
        wanted -= {Method.MODE_QUADRATIC} if system.time is Time.CONTINUOUS else set()
        wanted |= {Method.MIXTURE} if system.time is Time.CONTINUOUS else set()
    if switching.fixed_ends:
        wanted -= {Method.MODE_QUADRATIC}
        wanted |= {Method.PARAMETER_QUADRATIC}
        wanted |= {Method.VALUE} if system.is_uniform else set()
    return wanted


def _left_modes(system: SwitchedSystem) -> list[Mode]:
    """Return the modes that must be left: only these may be unstable."""
    lasting = {mode.name for mode in system.lasting_modes()}
    return [mode for mode in system.modes if mode.name not in lasting]


def _take(rung: Rung, family: Family) -> Finding:
    """Try one rung; where it is not affordable, or floating point fails, nothing is found."""
    try:
        with floats_in_silence():
            return rung(family)
    except TooLargeError as error:
        return None, f"not tried: {error}"
    except NotAffordableError as reason:
        return None, str(reason)
    except (LinAlgError, OverflowError) as error:
        return None, f"floating point failed ({error})"


def _conclude(
    system: SwitchedSystem,
    method: str,
    statements: tuple[AbstractEvidence, ...],
    attempts: tuple[Attempt, ...],
) -> Certification:
    status = common_quadratic_of(system, statements)
    return Certification(system, verdict_of(statements), status, method, statements, attempts)


def _spread(
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
