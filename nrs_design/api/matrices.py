"""What is decided about matrices of the user's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from nrs_design.api.decision import Decision
from nrs_design.api.exact import exact_matrix, read_matrix, read_number, read_rows, time_of
from nrs_design.api.lyapunov import LyapunovCheck, check_quadratic
from nrs_design.api.matrix_spec import name_modes, spec_of_matrices
from nrs_design.api.study import Study
from nrs_design.errors import NrsDesignError
from nrs_design.proof.exact import TooLargeError
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode

DEFAULT_NAME = "switched-system"


def certify(
    modes: Sequence[object] | Mapping[str, object],
    *,
    time: str | None = None,
    dwell_time: object = None,
    longest_dwell_time: object = None,
    transitions: Sequence[tuple[str, str]] | None = None,
    resets: Mapping[tuple[str, str], object] | None = None,
    parameters: Mapping[str, object] | None = None,
    name: str = DEFAULT_NAME,
    method: str = "auto",
    budget: float | None = None,
    max_degree: int | None = None,
) -> Decision:
    """Prove or refute that a switched linear system is uniformly exponentially stable.

    Parameters
    ----------
    modes : sequence or mapping of matrices
        ``x' = A x`` each, shape (n, n), in 1/s, or ``x+ = A x``: NumPy arrays, nested lists of
        numbers, fractions, decimals or texts such as ``"0.1"`` and ``"1/3"``, or state spaces of
        python-control, whose A is taken. A float is the binary number that it is. The keys of a
        mapping name the modes; otherwise they are m1, m2, ...
    time : {"continuous", "discrete"}, optional
        By default what the dt of the state spaces says, else continuous.
    dwell_time : number or str, or mapping from str to these, optional
        Shortest time in a mode, in s, or a number of steps: one for all modes, or by name. By
        default, switching is arbitrary.
    longest_dwell_time : number or str, or mapping from str to these, optional
        Time by which a mode must be left, so that it may be unstable.
    transitions : sequence of (str, str), optional
        Allowed switches; by default all.
    resets : mapping from (str, str) to matrix or list of matrices, optional
        ``x+ = G x`` at these switches, with any one of several G; others leave the state as it is.
    parameters : mapping from str to (low, high), optional
        Uncertain numbers that move at will in their ranges; entries of modes may then be texts that
        are affine in them, such as ``"-1 - k"``. A mapping with nominal, range and varies says
        more, as in a spec.
    name : str
        Of the files that the result saves.
    method : str
        One rung of the ladder, or all of them in turn.
    budget : float, optional
        Work that the search may take, in units of about a second: 60 by default.
    max_degree : int, optional
        Highest degree of a polynomial function.

    Returns
    -------
    Decision
        With verdict, decay rate, evidence, assumptions and attempts.

    Examples
    --------
    >>> import nrs_design as nrs
    >>> decision = nrs.certify([[[-1, -1], [1, -1]], [[-1, -5], ["1/5", -1]]])
    >>> decision.verdict, decision.common_quadratic
    ('proved', 'exists')
    """
    loaded = spec_of_matrices(
        modes,
        name=name,
        time=time,
        dwell_time=dwell_time,
        longest_dwell_time=longest_dwell_time,
        transitions=transitions,
        resets=resets,
        parameters=parameters,
    )
    return Study(loaded).certify(method=method, budget=budget, max_degree=max_degree)


def check_lyapunov(
    modes: Sequence[object] | Mapping[str, object],
    P: object,
    rate: object = None,
    *,
    time: str | None = None,
) -> LyapunovCheck:
    """Decide exactly whether ``x' P x`` is a common Lyapunov function, whoever proposes it.

    Parameters
    ----------
    modes : sequence or mapping of matrices, shape (n, n)
        As for `certify`.
    P : matrix, shape (n, n)
        From a solver, say. Only its symmetric part counts in ``x' P x``, so that part is taken.
    rate : number or str, optional
        Decide at this rate: alpha in 1/s, or rho per step in discrete time. Without it, decide
        whether V decreases at all, and find at what rate.
    time : {"continuous", "discrete"}, optional
        By default what the dt of the state spaces says, else continuous.

    Returns
    -------
    LyapunovCheck
        Strict, weak or neither; a proved rate; the failing mode with a vector that shows it.

    Examples
    --------
    >>> import nrs_design as nrs
    >>> nrs.check_lyapunov([[[0, 1], [-2, -3]]], [[5, 1], [1, 1]]).holds
    True
    """
    matrices = name_modes(modes)
    axis = time_of(list(matrices.values()), time)
    exact = [Mode(label, read_matrix(A, f"mode {label}")) for label, A in matrices.items()]
    alpha = None if rate is None else read_number(rate, "rate")
    try:
        return check_quadratic(exact, _symmetric_part(P), axis, alpha)
    except TooLargeError as error:
        raise NrsDesignError(
            str(error), remedy="give fewer modes, or numbers with fewer digits"
        ) from None
    except ValueError as error:
        raise NrsDesignError(str(error), remedy="correct the matrices or the rate") from None


def _symmetric_part(P: object) -> RationalMatrix:
    rows = read_rows(P, "P")
    if len(rows) != len(rows[0]):
        raise NrsDesignError(
            f"P is {len(rows)} x {len(rows[0])}, not square", remedy="give P as n x n"
        )
    n = len(rows)
    half = Fraction(1, 2)
    return exact_matrix(
        [[half * (rows[i][j] + rows[j][i]) for j in range(n)] for i in range(n)], "P"
    )
