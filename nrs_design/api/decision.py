"""A verdict on stability under switching, as the library gives it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.api.proof_facts import blocked_facts, certification_facts, margins_facts
from nrs_design.api.result import AbstractResult, Figures, evidence_drawings, section_figures
from nrs_design.certificates.catalogue import sentences
from nrs_design.certificates.ownership import check_certificate, write_certificate
from nrs_design.errors import OutputError, SpecError
from nrs_design.output import PAGE, check_html, write_output
from nrs_design.pipeline.certification import Result
from nrs_design.pipeline.scenarios import judged_if_stable
from nrs_design.proof.text import counted
from nrs_design.search.certification import Attempt
from nrs_design.spec import LoadedSpec, read_spec

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nrs_design.pipeline.blocked import Blocked
    from nrs_design.pipeline.margins import ProofMargins
    from nrs_design.proof.evidence import AbstractEvidence
    from nrs_design.reporting import Report


@dataclass(frozen=True, slots=True)
class Further:
    """Margins and remedies, which a command searches after the verdict."""

    margins: ProofMargins
    blocked: Blocked | None
    relief: tuple[str, ...]
    steps: tuple[str, ...]

    def facts(self, spec: Path) -> dict[str, Any]:
        """Return the content of ``--json``."""
        return (
            margins_facts(self.margins)
            | {"relief": list(self.relief), "next_steps": list(self.steps)}
            | ({} if self.blocked is None else blocked_facts(self.blocked, spec))
        )

    def lines(self, loaded: LoadedSpec, *, verbose: bool) -> Iterator[str]:
        """Yield the findings in words; verbose: all details and remedies."""
        # A proved change of the spec is a better remedy than the others.
        is_helped = self.blocked is not None and bool(self.blocked.proved)
        if verbose or not is_helped:
            yield from (f"  {line}" for line in self.relief)
        margins = self.margins
        if any((margins.loop, margins.box, margins.dwell)):
            from nrs_design.reporting.remedies import margin_lines

            yield from (f"  {line}" for line in margin_lines(margins))
        if self.blocked is not None:
            from nrs_design.pipeline.blocked import blocked_lines

            yield from (f"  {line}" for line in blocked_lines(self.blocked, loaded.path))
        # Without -v, show the most promising step only, and none after another remedy.
        steps = self.steps if verbose else () if is_helped or self.relief else self.steps[:1]
        yield from (f"next: {line}" for line in steps)


@dataclass(frozen=True, repr=False)
class Decision(AbstractResult):
    """A verdict on stability under switching, with all that carries it."""

    result: Result  # The spec with its design, exact modes, every attempt and the certificate
    file: Path | None = None  # Path of the written certificate
    further: Further | None = None  # Margins and remedies

    @property
    def verdict(self) -> str:
        """``proved``, ``refuted`` or ``inconclusive``."""
        return str(self.result.certification.verdict)

    @property
    def refuted_in(self) -> str | None:
        """Contact in which alone the loop is refuted: ``in kept contact``, or None."""
        return self.result.certification.refuted_in

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
        """Claim about stability, in words."""
        from nrs_design.reporting.sections.head import claim_of

        return claim_of(self.result.certification)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Assumptions of the claim."""
        return sentences(self.result.certification.granted)

    @property
    def attempts(self) -> tuple[Attempt, ...]:
        """Every search step with its outcome and its time in s."""
        return self.result.certification.attempts

    def why(self) -> tuple[str, ...]:
        """Return the lines of the spec that prevent a proof; empty unless inconclusive.

        Single lines are changed, and the spec is certified again each time: that takes up to half
        of the budget of the spec. `nrs_design.pipeline.blocked.find_blocked` has all that is found.
        """
        from nrs_design.pipeline.blocked import blocked_lines, find_blocked

        found = find_blocked(self.result)
        return () if found is None else blocked_lines(found, self.result.loaded.path)

    def state_spaces(self) -> dict[str, Any]:
        """Return every mode by name, as a ``StateSpace`` of python-control.

        Inputs are the disturbances of the spec, if it names any, outputs the states; dt is the
        sample time in s. Entries are the doubles next to the exact numbers of the proof.
        """
        from nrs_design.exporters.state_space import mode_state_spaces

        return mode_state_spaces(self.result.certification.system)

    @property
    def P(self) -> NDArray[np.float64] | None:
        """The matrix of the function V = x' P x, shape (n, n), rounded to doubles.

        None unless one quadratic function decides; `evidence` has the exact numbers.
        """
        known = None if self.evidence is None else self.evidence.quadratic
        if known is None:
            return None
        import numpy as np

        form, power = known
        return np.array([[float(Fraction(entry, 2**power)) for entry in row] for row in form])

    def _axis(self) -> object:
        return getattr(self.result.loaded.spec, "axis", None)

    def _facts(self) -> dict[str, Any]:
        facts = certification_facts(self.result, self.file)
        path = self.result.loaded.path
        return facts if self.further is None else facts | self.further.facts(path)

    def lines(self, *, verbose: bool = False) -> Iterator[str]:
        """Yield verdict, claims and goals as lines; verbose: full claims and all attempts."""
        from nrs_design.certificates.goals import certified_goals

        found, result = self.result.certification, self.result
        open_ = "" if found.evidence is not None else ": no proof, and no signal that grows"
        if self.refuted_in is not None:
            open_ = f" (refuted {self.refuted_in}; open where contact may be lost)"
        yield f"{result.loaded.spec.name}: {self.verdict.upper()}{open_}"
        for statement, short in result.briefs:
            yield f"  {statement.claim(found.system) if verbose else short}"
        for attempt in self.attempts:
            # A bound that was wanted and not found must be visible.
            is_wanted = attempt.step.startswith(("bound on ", "decay under"))
            if verbose or (is_wanted and attempt.outcome != "found"):
                # Steps that were skipped took no time.
                took = f" ({attempt.work:.2g} of work, {attempt.seconds:.2g} s)"
                yield f"  {attempt.step}: {attempt.outcome}{took if attempt.seconds else ''}"
        for goal in certified_goals(result.loaded.spec, result.certificate):
            yield f"  {goal.line}"

    def _drawings(self) -> Figures:
        # The run with its bound comes first; figures of the design take longer.
        names = set()
        for name, draw in evidence_drawings(self.result.certification):
            names.add(name)
            yield name, draw
        yield from (
            (name, draw)
            for name, draw in section_figures(self._page().sections)
            if name not in names
        )

    def _headline(self) -> str:
        contact_note = "" if self.refuted_in is None else f" (refuted {self.refuted_in})"
        return f"{self.result.loaded.spec.name}: {self.verdict.upper()}{contact_note}"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "", ""
        yield "claim", self.claim
        yield "taken for granted", counted(len(self.assumptions), "thing")

    def report(self, file: str | Path | None = None) -> str:
        """Return the report as one HTML page, and write it if a file is named."""
        from nrs_design.reporting import render_html

        if file is not None:
            check_html(Path(file))
        page = render_html(self._page())
        if file is not None:
            write_output(Path(file), page, replaces=PAGE)
        return page

    def save(self, folder: str | Path) -> Path:
        """Write ``NAME.cert.json``, and the spec if no file has the same content.

        Return the certificate, which `nrs_design.verify` checks against the spec. An OutputError if
        nothing was shown, so that there is no certificate, or another spec stands in its place.
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
        write_certificate(self.result.certificate, spec, file)
        return file

    def _page(self) -> Report:
        from nrs_design.reporting import build_report

        return build_report(self.result, judged_if_stable(self.result.designed))

    def __bool__(self) -> bool:
        """Return True for a proof, False for a refutation and for an inconclusive search."""
        return self.verdict == "proved"

    def _repr_html_(self) -> str:
        """Show verdict, claim and assumptions in a notebook."""
        items = "".join(f"<li>{escape(text)}</li>" for text in self.assumptions)
        details = f"<details><summary>taken for granted</summary><ul>{items}</ul></details>"
        return super()._repr_html_() + details


def _holds(path: Path, loaded: LoadedSpec) -> bool:
    """Tell whether a file says what a spec says."""
    try:
        return read_spec(path).sha256 == loaded.sha256
    except SpecError:
        return False
