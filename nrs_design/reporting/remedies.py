"""Section "What would help": margins of a proof, or next steps as commands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict, refutes_in_contact
from nrs_design.models.axis import unit as shown_unit
from nrs_design.pipeline.blocked import blocked_lines
from nrs_design.pipeline.certification import Result, find_relief
from nrs_design.pipeline.margins import ProofMargins
from nrs_design.proof.bounds import nearly, rounded_down, rounded_up
from nrs_design.proof.mode import Time
from nrs_design.reporting.document import Bullets, Section
from nrs_design.spec import InteractionDesignSpec, RobotSpec
from nrs_design.spec.switching import LONGEST_DWELL

if TYPE_CHECKING:
    from nrs_design.pipeline.blocked import Blocked
    from nrs_design.search.margin import Bracket, MarginBrackets

REMEDIES = "What would help"
MARGINS = "Margins of the proof"
_DESIGN = (
    "Change the design: narrower parameter ranges or fewer contacts per controller, more damping, "
    "modes that are more alike; a longer dwell time or fewer transitions, where the machine can "
    "enforce them."
)


def remedies_section(
    result: Result,
    margins: ProofMargins | None,
    blocked: Blocked | None = None,
) -> Section | None:
    """Report the margins of the proof and the next steps; None without either."""
    lists = {"Gains that would hold": find_relief(result)}
    if blocked is not None:
        path = Path(result.loaded.path.name)
        lists["Why it is not proved"] = blocked_lines(blocked, path)
    margins = margins or ProofMargins()
    sentences = tuple(f"{line[0].upper()}{line[1:]}." for line in margin_lines(margins))
    lists["How far a proof reaches"] = sentences
    box, dwell = margins.box is not None, margins.dwell is not None
    if steps := next_steps(result, margin=box, shortest_dwell=dwell):
        lists["Next steps"] = (*steps[:-1], _DESIGN, steps[-1])
    blocks = tuple(Bullets(title, items) for title, items in lists.items() if items)
    return Section(REMEDIES if steps else MARGINS, blocks) if blocks else None


def margin_lines(margins: ProofMargins) -> Iterator[str]:
    """Yield a sentence, in small letters and without its full stop, for each margin."""
    if margins.box is not None:
        yield f"largest box: {_box_text(margins.box)}"
    if margins.loop is not None:
        yield from _loop_lines(margins.loop)
    if margins.dwell is not None:
        yield f"shortest dwell time: {_dwell_text(margins.dwell)}"


def _box_text(box: Bracket) -> str:
    outcome = f"; {box.end}" if box.end else ""
    if box.refuted is not None:
        contact = _contact_phrase(box.refuted_in)
        outcome = f"; scaled by {rounded_up(box.refuted)} they are refuted{contact}"
    if box.proved is None or box.proof is None:
        return f"not even the nominal values are proved{outcome}"
    return (
        f"scaled by {rounded_down(box.proved)} about their nominal values, all ranges are proved "
        f"({box.proof.method}){outcome}"
    )


def _dwell_text(dwell: Bracket) -> str:
    proved = f"no proof up to {LONGEST_DWELL} s, where the search ended"
    if dwell.proved is not None and dwell.proof is not None:
        proved = f"{rounded_up(dwell.proved, 's')} is proved ({dwell.proof.method})"
    refuted = "" if dwell.proved == 0 else "; no dwell time was refuted"
    if dwell.refuted is not None:
        end = rounded_down(dwell.refuted, "s")
        refuted = f"; {end} and all shorter ones are refuted{_contact_phrase(dwell.refuted_in)}"
    return f"{proved}{refuted}"


def _loop_lines(loop: MarginBrackets) -> Iterator[str]:
    caveat = "" if loop.command is None else "; without disturbances, no bound was looked at"
    if loop.delay is not None:
        refuted = f"refuted from *{_contact_phrase(loop.delay.refuted_in)}"
        ends = _ends(loop.delay, _samples, "proved up to *", refuted)
        yield f"longest delay of the force sample: {ends}{caveat}"
    if loop.period is not None:
        refuted = f"* is refuted{_contact_phrase(loop.period.refuted_in)}"
        ends = _ends(loop.period, lambda seconds: nearly(seconds, "s"), "* is proved", refuted)
        yield f"period: {ends} (each for itself, nothing is said of those in between{caveat})"
    if loop.command is not None:
        bounds = loop.command.bounds.items()
        ranges = ", ".join(
            f"|{name}| <= {rounded_down(end, unit)}" for name, (end, _, unit) in bounds
        )
        broken = ", ".join(nearly(end, unit) for _, (_, end, unit) in bounds)
        yield (
            f"limit of {nearly(loop.command.limit, shown_unit('N*m'))}: proved to be kept for "
            f"{ranges}; a simulated run reaches it at {broken}"
        )


def _ends(
    bracket: Bracket, format_number: Callable[[Fraction], str], proved: str, refuted: str
) -> str:
    """Return proved and refuted ends of a bracket; a number replaces the star of each text.

    Where nothing is refuted, say where the search ended.
    """
    first, second = bracket.proved, bracket.refuted
    success = "none is proved" if first is None else proved.replace("*", format_number(first), 1)
    failure = bracket.end if second is None else refuted.replace("*", format_number(second), 1)
    return f"{success}, {failure}"


def _contact_phrase(contact: str) -> str:
    """Say in which contact alone something is refuted, if it is not in any."""
    return f" {contact}" if contact else ""


def _samples(count: Fraction) -> str:
    return f"{count} sample{'s' * (count != 1)}"


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
    is_unstable_mode = evidence is not None and evidence.names_unstable_mode
    if is_unstable_mode:
        yield (
            "A mode is not stable by itself, so no rule of switching helps: change the gains of "
            "its controller, or narrow the range that makes it unstable."
        )
    if certification.verdict is Verdict.INCONCLUSIVE:
        yield f"Search longer: {command} --budget 600 (or more --memory, or a --max-degree)"
    if spec.has_ranges and not margin:
        yield f"Find the largest ranges that are proved: {command} --margin"
    if not is_unstable_mode and not shortest_dwell and _takes_dwell(result):
        yield f"Find the shortest dwell time that is proved: {command} --shortest-dwell"
    if isinstance(spec, InteractionDesignSpec):
        has_velocity_command = any(c.commands == "velocity" for c in spec.controllers.values())
        command = "optimize" if has_velocity_command else "tune"
        yield f"See which gains the goals allow: nrs-design {command} {name}"


def _takes_dwell(result: Result) -> bool:
    """Tell whether a shortest dwell time can be searched."""
    spec, system = result.loaded.spec, result.certification.system
    assert not isinstance(spec, RobotSpec), "a robot spec has no modes to certify"
    lasting = len(system.lasting_modes()) == len(system.modes)
    return system.time is Time.CONTINUOUS and lasting and spec.find_dwell_obstacle() is None
