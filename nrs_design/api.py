"""The library at the door: what ``import nrs_design as nrs`` offers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design import pipeline
from nrs_design.certificates.certificate import dump
from nrs_design.certificates.verify import Verification
from nrs_design.certificates.verify import verify as verify_file
from nrs_design.errors import DesignError, NrsDesignError, OutputError, SpecError
from nrs_design.given.matrices import (
    exact_matrix,
    read_matrix,
    read_number,
    read_rows,
    time_of,
)
from nrs_design.given.system import name_modes, spec_of_matrices
from nrs_design.output import CERTIFICATE, PAGE, write_output
from nrs_design.ownership import check_certificate, origin_of
from nrs_design.proof.exact import TooLargeError
from nrs_design.proof.lyapunov import LyapunovCheck, check_quadratic
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import Mode
from nrs_design.search.certification import Attempt, Limits
from nrs_design.search.gradient_settings import Gradient as Gradient
from nrs_design.search.method import Method
from nrs_design.spec import LoadedSpec, read_spec

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.exporters.export import Export
    from nrs_design.exporters.state_space import StateSpaces
    from nrs_design.pipeline.scenarios import Simulated
    from nrs_design.proof.evidence import AbstractEvidence
    from nrs_design.reporting import Report

DEFAULT_NAME = "switched-system"


@dataclass(frozen=True)
class Decision:
    """A verdict on stability under switching, with all that carries it.

    Parameters
    ----------
    result : nrs_design.pipeline.Result
        The spec with its design, its exact modes, every attempt and the certificate.
    """

    result: pipeline.Result

    @property
    def verdict(self) -> str:
        """``proved``, ``refuted`` or ``inconclusive``."""
        return str(self.result.certification.verdict)

    @property
    def common_quadratic(self) -> str:
        """Whether a common quadratic function exists: ``exists``, ``impossible``, ``unknown``."""
        return str(self.result.certification.common_quadratic)

    @property
    def decay_rate(self) -> Fraction | None:
        """The proved rate: alpha in 1/s, in discrete time rho per step; None without a proof."""
        evidence = self.evidence
        return evidence.proved_rate(self.result.certification.system) if evidence else None

    @property
    def evidence(self) -> AbstractEvidence | None:
        """The statement that decides the verdict; None if it is inconclusive."""
        return self.result.certification.evidence

    @property
    def claim(self) -> str:
        """What is claimed about stability, in words."""
        from nrs_design.reporting.sections.head import claim_of

        return claim_of(self.result.certification)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What the claim takes for granted."""
        return self.result.certification.system.assumptions

    @property
    def attempts(self) -> tuple[Attempt, ...]:
        """Every step of the search: what was tried, how it ended, and its time in s."""
        return self.result.certification.attempts

    def state_spaces(self) -> dict[str, Any]:
        """Return every mode by name, as a ``StateSpace`` of python-control.

        Inputs are the disturbances of the spec, if it names any, outputs the states; dt is the
        sample time in s. Entries are the doubles next to the exact numbers of the proof.
        """
        from nrs_design.exporters.state_space import mode_state_spaces

        return mode_state_spaces(self.result.certification.system)

    def plot(self, name: str | None = None) -> Figure:
        """Return a figure of the report: the run beside its bound, or another one by name.

        Raises
        ------
        DesignError
            If there is no figure of that name; the message lists those that there are.
        """
        figures = {item.name: item.figure for item in self._page().illustrations}
        default = "run" if "run" in figures else next(iter(figures), None)
        chosen = default if name is None else name
        if chosen is None or chosen not in figures:
            raise DesignError(
                f"there is no figure {chosen!r}", remedy=f"figures here: {', '.join(figures)}"
            )
        return figures[chosen]

    def report(self, file: str | Path | None = None) -> str:
        """Return the report as one HTML page, and write it if a file is named.

        Raises
        ------
        OutputError
            If the file cannot be written.
        """
        from nrs_design.reporting import render_html

        page = render_html(self._page())
        if file is not None:
            write_output(Path(file), page, replaces=PAGE)
        return page

    def save(self, folder: str | Path) -> Path:
        """Write ``NAME.cert.json``, and the spec beside it if no file holds it as it was decided.

        Returns
        -------
        Path
            The certificate, which `nrs_design.verify` checks against the spec.

        Raises
        ------
        OutputError
            If nothing was shown, so that there is no certificate, or a file cannot be written, or
            another spec stands in its place; or if a file is named, not a folder.
        """
        place, loaded = Path(folder), self.result.loaded
        if place.suffix == ".json":
            raise OutputError(
                f"is the name of a file; the certificate is {loaded.spec.name}.cert.json",
                path=place,
                remedy=f"name the folder for it, such as {str(place.parent)!r}",
            )
        if self.result.certificate is None:
            raise OutputError(
                "nothing was proved or refuted, so there is no certificate",
                path=place,
                remedy="search longer, with a larger budget or max_degree",
            )
        file, spec = place / f"{loaded.spec.name}.cert.json", loaded.path
        if not _holds(spec, loaded):
            spec = place / loaded.path.name
        check_certificate(spec, file)
        if not spec.exists():
            write_output(spec, loaded.text)
        elif not _holds(spec, loaded):
            raise OutputError(
                "exists already and is another spec, so it is not overwritten",
                path=spec,
                remedy="choose another folder or another name",
            )
        origin = origin_of(spec, file)
        write_output(file, dump(self.result.certificate, origin), replaces=CERTIFICATE)
        return file

    def _page(self) -> Report:
        from nrs_design.reporting import build_report

        analysis = None
        if self.result.designed is not None:
            try:
                analysis = pipeline.run_analysis(self.result.designed)
            except DesignError:
                # Where a nominal loop has no margins, the page has none.
                analysis = None
        return build_report(self.result, analysis)

    def __str__(self) -> str:
        """Say verdict and claim."""
        return f"{self.result.loaded.spec.name}: {self.verdict.upper()}\n{self.claim}"

    def _repr_html_(self) -> str:
        """Show verdict, claim and assumptions in a notebook."""
        items = "".join(f"<li>{escape(text)}</li>" for text in self.assumptions)
        return (
            f"<p><strong>{escape(self.result.loaded.spec.name)}: {self.verdict.upper()}</strong>"
            f"</p><p>{escape(self.claim)}</p>"
            f"<details><summary>taken for granted</summary><ul>{items}</ul></details>"
        )


@dataclass(frozen=True)
class Study:
    """One spec file and what can be done with it.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec with its text and hash.
    """

    loaded: LoadedSpec

    def design(self) -> ControllerDesign | None:
        """Design the controllers; None where the spec gives matrices.

        Raises
        ------
        DesignError
            If a requirement cannot be met within its bounds.
        """
        designed = pipeline.run_design(self.loaded)
        return None if designed is None else designed.design

    def state_spaces(self) -> StateSpaces:
        """Design, and return actuator, motion loop and controllers for python-control.

        In continuous time, at nominal values, in SI units; the closed loops are those of
        `Decision.state_spaces`.

        Raises
        ------
        DesignError
            If the spec gives matrices, which have no parts, or a requirement cannot be met.

        Examples
        --------
        >>> import nrs_design as nrs
        >>> parts = nrs.load("specs/neuroboscope/soft-tissue.nrs.yaml").state_spaces()
        >>> float(round(-parts.controllers["insertion"].dcgain(), 4))  # 1/Bt
        0.4651
        """
        designed = pipeline.run_design(self.loaded)
        if designed is None:
            raise pipeline.wrong_kind(
                self.loaded,
                f"a spec of kind {self.loaded.spec.kind} has no actuator and no controllers",
                "use a spec of kind interaction-design; certify() has the state spaces of modes",
            )
        from nrs_design.exporters.state_space import design_state_spaces

        return design_state_spaces(designed)

    def certify(
        self,
        *,
        method: str = "auto",
        coordinates: str | None = None,
        budget: float | None = None,
        max_degree: int | None = None,
        gradient: Gradient | None = None,
    ) -> Decision:
        """Design, assemble and decide; see `certify` for the options.

        Parameters
        ----------
        method, coordinates, budget, max_degree, gradient
            As for `certify`; coordinates (for designs) are those of the spec by default.

        Raises
        ------
        DesignError, AssemblyError
            If the spec has no design, or its modes make no switched system.
        """
        limits = _limits(budget, max_degree, gradient)
        result = pipeline.run_certification(
            self.loaded, method=_method(method), coordinates=coordinates, limits=limits
        )
        return Decision(result)

    def simulate(
        self,
        *scenarios: str,
        engine: str | None = None,
        period: float | None = None,
        delay: int | None = None,
    ) -> tuple[Simulated, ...]:
        """Simulate scenarios of the spec, or the one of a spec that has none.

        Parameters
        ----------
        *scenarios : str
            Names; by default all.
        engine : {"exact", "sampled", "mujoco"}, optional
            By default sampled where the spec has sampling or tissue is not linear, else exact.
        period, delay : float and int, optional
            Of the sampled engine, in s and in samples; by default those of the spec.

        Raises
        ------
        DesignError, DataError
            If the spec is no interaction design, or a scenario cannot be simulated.

        Examples
        --------
        >>> import nrs_design as nrs
        >>> study = nrs.load("docs/examples/scenarios.nrs.yaml")
        >>> (one,) = study.simulate("profile-of-the-thesis")
        >>> bool(abs(one.run.response["torque"]).max() < 0.3)
        True
        """
        if engine not in (None, "exact", "sampled", "mujoco"):
            remedy = "write exact, sampled or mujoco"
            raise DesignError(f"there is no engine {engine!r}", remedy=remedy)
        designed = pipeline.run_design(self.loaded)
        if designed is None:
            raise pipeline.wrong_kind(
                self.loaded,
                f"a spec of kind {self.loaded.spec.kind} describes no interaction",
                "use a spec of kind interaction-design",
            )
        if engine is None and (period is not None or delay is not None):
            engine = "sampled"
        from nrs_design.pipeline.scenarios import Runs, run_scenarios

        return tuple(run_scenarios(designed, Runs(tuple(scenarios), engine, period, delay)))

    def export(self, certificate: str | Path | None = None) -> Export:
        """Return the gains that ship with their proof, or why there are none.

        Parameters
        ----------
        certificate : path-like, optional
            A certificate to be re-checked; without it the design is certified afresh.

        Raises
        ------
        DesignError
            If the spec has no gains.
        CertificateError
            If the given file is not a certificate.
        """
        from nrs_design.exporters.export import export_design

        return export_design(self.loaded, None if certificate is None else Path(certificate))


def load(path: str | Path) -> Study:
    """Read and validate a spec file.

    Raises
    ------
    SpecError
        With path, line, column, message and remedy.

    Examples
    --------
    >>> import nrs_design as nrs
    >>> study = nrs.load("specs/neuroboscope/soft-tissue.nrs.yaml")
    >>> study.certify().verdict
    'proved'
    """
    return Study(read_spec(path))


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
    gradient: Gradient | None = None,
) -> Decision:
    """Prove or refute that a switched linear system is uniformly exponentially stable.

    Parameters
    ----------
    modes : sequence or mapping of matrices
        ``x' = A x`` each, shape (n, n), in 1/s, or ``x+ = A x``: NumPy arrays, nested lists of
        numbers, fractions or texts such as ``"0.1"`` and ``"1/3"``, or state spaces of
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
        Seconds that the search may take.
    max_degree : int, optional
        Highest degree of a polynomial function.
    gradient : Gradient, optional
        Settings of the gradient iteration, for the method ``"gradient"``.

    Returns
    -------
    Decision
        With verdict, decay rate, evidence, assumptions and attempts.

    Raises
    ------
    SpecError
        If the input is wrong.

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
    return Study(loaded).certify(
        method=method, budget=budget, max_degree=max_degree, gradient=gradient
    )


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

    Raises
    ------
    SpecError
        If the input is wrong.

    Examples
    --------
    >>> import nrs_design as nrs
    >>> nrs.check_lyapunov([[[0, 1], [-2, -3]]], [[5, 1], [1, 1]]).holds
    True
    """
    named = name_modes(modes)
    axis = time_of(list(named.values()), time)
    exact = [Mode(label, read_matrix(A, f"mode {label}")) for label, A in named.items()]
    alpha = None if rate is None else read_number(rate, "rate")
    try:
        return check_quadratic(exact, _symmetric_part(P), axis, alpha)
    except TooLargeError as error:
        raise NrsDesignError(
            str(error), remedy="give fewer modes, or numbers with fewer digits"
        ) from None
    except ValueError as error:
        raise NrsDesignError(str(error), remedy="correct the matrices or the rate") from None


def verify(certificate: str | Path, spec: str | Path | None = None) -> Verification:
    """Re-check a certificate file, exactly and without a solver.

    Parameters
    ----------
    certificate : path-like
        The file.
    spec : path-like, optional
        The spec that it must belong to. Without it the proof is checked for the modes that the
        file holds, whosever they are.

    Returns
    -------
    Verification
        Its fault is None if the certificate holds.

    Raises
    ------
    SpecError, CertificateError
        If a file cannot be read at all.
    """
    return verify_file(Path(certificate), None if spec is None else read_spec(spec))


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


def _holds(path: Path, loaded: LoadedSpec) -> bool:
    """Tell whether a file says what a spec says."""
    try:
        return read_spec(path).sha256 == loaded.sha256
    except SpecError:
        return False


def _method(name: str) -> Method:
    if name not in set(Method):
        raise DesignError(f"there is no method {name!r}", remedy=f"one of {', '.join(Method)}")
    return Method(name)


def _limits(
    budget: float | None, max_degree: int | None, gradient: Gradient | None = None
) -> Limits:
    limits = Limits(gradient=gradient or Gradient())
    if budget is not None:
        limits = replace(limits, budget=budget)
    return limits if max_degree is None else replace(limits, max_degree=max_degree)
