"""Next steps where nothing was proved, as commands."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from shlex import quote

from nrs_design.certificates.certificate import Verdict, refutes_in_contact
from nrs_design.pipeline.certification import Result
from nrs_design.proof.mode import Time
from nrs_design.spec import ImpedanceControllerSpec, InteractionDesignSpec, RobotSpec


def next_steps(
    result: Result,
    *,
    margin: bool = False,
    shortest_dwell: bool = False,
    spec: Path | None = None,
) -> tuple[str, ...]:
    """Return next steps, the most promising first; none where stability is proved.

    What was looked for just now need not be told to be. Without its path, a spec is named by file
    name alone, which is the same wherever it lies.
    """
    verdict = result.certification.verdict
    if verdict is Verdict.PROVED:
        return ()
    name = quote(str(spec or result.loaded.path.name))
    steps = _steps(result, name, margin, shortest_dwell)
    return (*steps, "Do not ship this design: a gate must treat it as a failure.")


def _steps(result: Result, name: str, margin: bool, shortest_dwell: bool) -> Iterator[str]:
    certification, spec = result.certification, result.loaded.spec
    command = f"nrs-design certify-switching {name}"
    evidence = certification.evidence
    evidence = evidence or refutes_in_contact(certification.system, certification.statements)
    alone = evidence is not None and evidence.names_unstable_mode
    if alone:
        yield (
            "A mode is not stable by itself, so no rule of switching helps: change the gains of "
            "its controller, or narrow the range that makes it unstable."
        )
    if certification.verdict is Verdict.INCONCLUSIVE:
        yield f"Search longer: {command} --budget 600 (or more --memory, or a --max-degree)"
    if spec.has_ranges and not margin:
        yield f"Find the largest ranges that are proved: {command} --margin"
    if not alone and not shortest_dwell and _takes_dwell(result):
        yield f"Find the shortest dwell time that is proved: {command} --shortest-dwell"
    if isinstance(spec, InteractionDesignSpec):
        chosen = any(isinstance(c, ImpedanceControllerSpec) for c in spec.controllers.values())
        command = "optimize" if chosen else "tune"
        yield f"See which gains the goals allow: nrs-design {command} {name}"


def _takes_dwell(result: Result) -> bool:
    """Tell whether a shortest dwell time can be searched."""
    spec, system = result.loaded.spec, result.certification.system
    assert not isinstance(spec, RobotSpec)  # It has no modes, hence no certification.
    lasting = len(system.lasting_modes()) == len(system.modes)
    return system.time is Time.CONTINUOUS and lasting and spec.find_dwell_obstacle() is None
