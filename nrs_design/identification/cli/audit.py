"""``nrs-design audit``: compare a log of the running robot with its spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import detail, progress, say
from nrs_design.identification.cli.identify import ColumnMap, read_all

if TYPE_CHECKING:
    from nrs_design.identification.running.judge import RunJudgement

_EXIT = {
    "inside": exit_codes.PROVED,
    "outside": exit_codes.REFUTED,
    "inconclusive": exit_codes.INCONCLUSIVE,
}


@command("audit")
def audit(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Log of the running robot.")],
    spec: Annotated[Path, typer.Argument(metavar="SPEC", help="The spec that it runs by.")],
    certificate: Annotated[
        Path | None,
        typer.Option(metavar="CERT", help="Certificate of that spec; without it, none is proved."),
    ] = None,
    columns: ColumnMap = None,
) -> Answer:
    """Tell whether a run stayed inside what was proved: times, stiffness, delay, command, force.

    Columns, as far as they are there: time_s; angle_rad and torque_Nm (or deflection_m and
    force_N); velocity_rad_s; the command in the unit of the spec (command_rpm, _V, _A, _counts; of
    a robot _rad_s, _rad, _Nm); mode, the name of the controller in force. The stiffness is tested
    where the spec says by `monitoring` how far readings are off. What cannot be judged is said.

    Exit code 0: inside. 1: left. 3: not everything could be judged, or the spec is not proved.

    Example: nrs-design audit run.csv soft-tissue.nrs.yaml --certificate soft-tissue.cert.json
    """
    from nrs_design.identification.reporting.running import run_facts
    from nrs_design.identification.running.bounds import proof_of, read_run_bounds
    from nrs_design.identification.running.judge import judge_run
    from nrs_design.identification.running.log import read_run
    from nrs_design.identification.write_spec import check_turning
    from nrs_design.spec import read_spec

    loaded = read_spec(spec)
    check_turning(loaded.spec, loaded.path)
    bounds = read_run_bounds(loaded)
    reason, losable = proof_of(certificate, loaded)
    (run,) = read_all([log], read_run, columns or [])
    with progress("judging"):
        judgement = judge_run(run, bounds, proved=not reason, losable=losable)
    return Answer(
        lambda: run_facts(judgement, loaded, certificate, reason),
        lambda: _print(judgement, loaded.spec.name, reason),
        _EXIT[judgement.verdict],
    )


def _print(judgement: RunJudgement, name: str, reason: str) -> None:
    from nrs_design.identification.reporting.running import CLAIMS, first_violation
    from nrs_design.identification.reporting.view import SYNTHETIC

    if judgement.log.source.synthetic:
        say(SYNTHETIC)
    if reason:
        say(f"UNPROVED SPEC: {reason}; its ranges are only declared.")
    say(f"{name}: {judgement.verdict.upper()}: {CLAIMS[judgement.verdict]}")
    if first := first_violation(judgement):
        say(first)
    for c in judgement.checks:
        limits = f" (allowed: {c.allowed})" if c.allowed else ""
        say(f"{c.name}: {c.status}: {c.measured}{limits}")
    for basis in dict.fromkeys(c.basis for c in judgement.checks if c.basis):
        names = ", ".join(c.name for c in judgement.checks if c.basis == basis)
        detail(f"bound of {names}: {basis}")
