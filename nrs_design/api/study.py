"""A spec file, and what can be done with it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design import pipeline
from nrs_design.api.decision import Decision
from nrs_design.errors import DesignError
from nrs_design.search.certification import Limits
from nrs_design.search.gradient_settings import Gradient
from nrs_design.search.method import Method
from nrs_design.spec import LoadedSpec, read_spec

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.exporters.export import Export
    from nrs_design.exporters.state_space import StateSpaces
    from nrs_design.pipeline.scenarios import Simulated


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
