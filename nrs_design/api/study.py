"""A spec file, and what can be done with it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.api.audit import Audit
from nrs_design.api.decision import Decision
from nrs_design.api.exported import Exported
from nrs_design.api.optimum import Optimum
from nrs_design.api.simulation import Simulation
from nrs_design.api.worst import WorstFound
from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import Overrides, search_limits
from nrs_design.pipeline.design import placed
from nrs_design.pipeline.runs import (
    run_certification,
    run_design,
    run_interaction,
    run_interaction_of,
)
from nrs_design.search.certification import Limits
from nrs_design.search.method import Method
from nrs_design.spec import LoadedSpec, read_spec
from nrs_design.wings import load_wing

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.exporters.state_space import StateSpaces
    from nrs_design.pipeline.design import Designed
    from nrs_design.pipeline.scenarios import Runs
    from nrs_design.spec import Spec


@dataclass(frozen=True, repr=False)
class Study:
    """One spec file and what can be done with it.

    What cannot be done raises an error that says why: a DesignError if the spec gives matrices, or
    a requirement cannot be met; a CertificateError if a file is no certificate of the spec; a
    ClockError if the clock stopped a search, long after its budget of work should have.
    """

    loaded: LoadedSpec  # The spec with its text and hash

    def __repr__(self) -> str:
        """Name the spec and its kind."""
        return f"<Study of {self.loaded.spec.name}, {self.loaded.spec.kind}>"

    def design(self) -> ControllerDesign | None:
        """Design the controllers; None where the spec gives matrices."""
        designed = run_design(self.loaded)
        return None if designed is None else designed.design

    def optimize(self) -> Optimum:
        """Design the controllers; gains are floats with units, and margins come with them.

        Examples
        --------
        >>> import nrs_design as nrs
        >>> optimum = nrs.load("specs/neuroboscope/soft-tissue.nrs.yaml").optimize()
        >>> round(optimum.gains["insertion"]["Bt"], 4), optimum.units["insertion"]["Bt"]
        (2.15, 'N*m*s/rad')
        """
        return Optimum(run_interaction(self.loaded, "has nothing to optimize"))

    def report(self, file: str | Path | None = None) -> str:
        """Certify, and return the report as one HTML page; write it if a file is named."""
        return self.certify().report(file)

    def audit(self, log: str | Path, certificate: str | Path | None = None) -> Audit:
        """Judge whether a run of the robot stayed inside what was proved.

        Parameters
        ----------
        log : path-like
            CSV file of the run; see `nrs-design audit` for its columns.
        certificate : path-like, optional
            Checked against the spec; without one nothing is proved, and the judgement says so.

        Returns
        -------
        Audit
            With its verdict and every check.
        """
        file = None if certificate is None else Path(certificate)
        library = load_wing("identification", "api.library")
        audit_result: Audit = library.judge_log(Path(log), self.loaded, file)
        return audit_result

    def state_spaces(self) -> StateSpaces:
        """Design, and return actuator, motion loop and controllers for python-control.

        In continuous time, at nominal values, in SI units; the closed loops are those of
        `Decision.state_spaces`.

        Examples
        --------
        >>> import nrs_design as nrs
        >>> parts = nrs.load("specs/neuroboscope/soft-tissue.nrs.yaml").state_spaces()
        >>> float(round(-parts.controllers["insertion"].dcgain(), 4))  # 1/Bt
        0.4651
        """
        from nrs_design.exporters.state_space import design_state_spaces

        lacks = "has no actuator and no controllers"
        return design_state_spaces(run_interaction(self.loaded, lacks))

    def certify(
        self,
        *,
        method: str = "auto",
        budget: float | None = None,
        max_degree: int | None = None,
    ) -> Decision:
        """Design, assemble and decide; see `certify` for the options.

        Parameters
        ----------
        method, budget, max_degree
            As for `certify`.
        """
        limits = _limits(self.loaded.spec, budget, max_degree)
        result = run_certification(self.loaded, method=_method(method), limits=limits)
        return Decision(result)

    def simulate(
        self,
        *scenarios: str,
        engine: str | None = None,
        period: float | None = None,
        delay: int | None = None,
        certificate: str | Path | None = None,
    ) -> Simulation:
        """Simulate scenarios of the spec, or the default scenario of a spec without scenarios.

        Parameters
        ----------
        *scenarios : str
            Names; by default all.
        engine : {"exact", "sampled"}, optional
            By default sampled where the spec has sampling or tissue is not linear, else exact.
        period, delay : float and int, optional
            Of the sampled engine, in s and in samples; by default those of the spec.
        certificate : path-like, optional
            Checked against the spec; its bounds stand beside the runs.

        Returns
        -------
        Simulation
            One run after the other, by place or by name: ``simulation["shaken"]["torque"]``.

        Examples
        --------
        >>> import nrs_design as nrs
        >>> study = nrs.load("docs/examples/scenarios.nrs.yaml")
        >>> (run,) = study.simulate("profile-of-the-thesis")
        >>> bool(abs(run["torque"]).max() < 0.3), run.units["torque"], float(run.time[0])
        (True, 'N*m', 0.0)
        """
        from nrs_design.pipeline.scenarios import run_scenarios

        settings = _runs(scenarios, engine, period, delay)
        with placed(self.loaded):
            designed, proof = self._interaction(certificate)
            return Simulation.of(designed, tuple(run_scenarios(designed, settings)), proof)

    def worst_case(self, certificate: str | Path | None = None) -> WorstFound:
        """Let an adversary choose all that the spec leaves open, and return his worst runs.

        What he finds may happen in the model: a lower bound of the worst that may. There is a run
        for each quantity (force, velocity, deflection), beside limits and certified bounds, in SI.

        Parameters
        ----------
        certificate : path-like, optional
            Checked against the spec; its bounds stand beside the runs.

        Examples
        --------
        >>> import nrs_design as nrs
        >>> case = nrs.load("docs/examples/scenarios.nrs.yaml").worst_case()
        >>> case.worst["force"] > case.limits["force"]
        True
        """
        from nrs_design.pipeline.scenarios import run_worst_case

        with placed(self.loaded):
            designed, proof = self._interaction(certificate)
            case = run_worst_case(designed, proof)
        return WorstFound(designed, case)

    def export(self, certificate: str | Path | None = None) -> Exported:
        """Return the exported gains with their proof, or the reason for none; `save` writes files.

        Parameters
        ----------
        certificate : path-like, optional
            A certificate to be re-checked; without it the design is certified afresh.
        """
        from nrs_design.exporters.export import export_design

        file = None if certificate is None else Path(certificate)
        with placed(self.loaded):
            return Exported(self.loaded, export_design(self.loaded, file))

    def _interaction(self, certificate: str | Path | None) -> tuple[Designed, Certificate | None]:
        """Return the designed interaction, with the checked certificate if a file is named."""
        file = None if certificate is None else Path(certificate)
        return run_interaction_of(self.loaded, file, "describes no interaction")


def _runs(
    scenarios: tuple[str, ...], engine: str | None, period: float | None, delay: int | None
) -> Runs:
    """Return how scenarios are run; who names a period wants the sampled engine."""
    from nrs_design.pipeline.scenarios import Runs

    if engine not in (None, "exact", "sampled"):
        raise DesignError(f"there is no engine {engine!r}", remedy="write exact or sampled")
    from nrs_design.spec.sampling import LONGEST_DELAY

    if any(not isinstance(name, str) for name in scenarios):
        raise DesignError("a scenario has no name", remedy="give names: simulate('one', 'two')")
    if period is not None and not 1e-5 <= period <= 1:
        raise DesignError(f"the period is {period} s", remedy="give 1e-5 to 1 s")
    if delay is not None and not 0 <= delay <= LONGEST_DELAY:
        raise DesignError(f"the delay is {delay} samples", remedy=f"give 0 to {LONGEST_DELAY}")
    if engine is None and (period is not None or delay is not None):
        engine = "sampled"
    return Runs(scenarios, engine, period, delay)


def load(path: str | Path) -> Study:
    """Read and validate a spec file.

    A SpecError has path, line, column, message and remedy.

    Examples
    --------
    >>> import nrs_design as nrs
    >>> study = nrs.load("specs/neuroboscope/soft-tissue.nrs.yaml")
    >>> study.certify().verdict
    'proved'
    """
    return Study(read_spec(path))


def _method(name: str) -> Method:
    if name not in set(Method):
        raise DesignError(f"there is no method {name!r}", remedy=f"one of {', '.join(Method)}")
    return Method(name)


def _limits(spec: Spec, budget: float | None, max_degree: int | None) -> Limits:
    """Return the limits of the search: options, else those of the spec."""
    from nrs_design.spec.certification import HIGHEST_DEGREE

    if budget is not None and not 0 < budget < math.inf:
        raise DesignError(f"the budget is {budget}", remedy="give units of work above zero")
    if max_degree is not None and not 2 <= max_degree <= HIGHEST_DEGREE:
        raise DesignError(f"max_degree is {max_degree}", remedy=f"give 2 to {HIGHEST_DEGREE}")
    return search_limits(spec, Overrides(max_degree, budget))
