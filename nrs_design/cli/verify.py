"""``nrs-design verify``: re-check a certificate, without a solver."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.printing import is_quiet, say, wants_details
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.exporters.deployed import DeployedFiles
    from nrs_design.spec import LoadedSpec, Spec


@command("verify")
def verify(
    certificate: Annotated[Path, typer.Argument(metavar="CERT", help="Certificate file.")],
    spec: Annotated[
        Path | None,
        typer.Argument(
            metavar="SPEC",
            show_default=False,
            help="The spec whose modes they must be; without it, only the proof is checked.",
        ),
    ] = None,
    deployed: Annotated[
        Path | None,
        typer.Option(
            metavar="PLACE",
            help="Folder of exported files, or one of them (C, monitor, CMake, FMU): they must be "
            "what is exported with the certificate.",
        ),
    ] = None,
) -> Answer:
    """Re-check a certificate in exact arithmetic, and that its modes are those of a spec.

    No solver runs. Without a spec, the proof is checked for the modes that the certificate holds,
    and the answer says so: whose modes they are is then not known, and gains, coordinates and
    assumptions, which nothing holds against anything, are not printed.

    Gains that the spec leaves to a design are those of the file, if they are within what the spec
    allows; `gate` holds them against the design. -v lists them.

    With --deployed, every file of a folder that a processor runs must be, byte for byte, what is
    exported with the certificate by this release; files of another release are named as such. The
    answer says first what was compared and what was not. How the files are compiled is not looked
    at: the exported self-test tells whether your compiler and processor compute the law.

    Exit code 0: the proof holds. 1: the certificate is rejected, or it holds and refutes, or the
    deployed files are others. 3: it holds, but decides nothing.

    Example: nrs-design verify reports/soft-tissue.cert.json specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.certificates.prove import read_document
    from nrs_design.certificates.verify import verify_document

    if spec is None and deployed is not None:
        raise typer.BadParameter("needs a SPEC, whose law it is", param_hint="--deployed")
    document = read_document(certificate)
    loaded = None if spec is None else take_spec(spec)
    outcome = verify_document(document, loaded)
    checked = outcome.certificate if outcome.fault is None else None
    found = _deployed(deployed, loaded, checked)
    rejected = checked is None or (found is not None and bool(found.differences))
    verdict = "rejected" if checked is None or rejected else checked.verdict
    brief = is_quiet()

    def facts() -> dict[str, Any]:
        from nrs_design.api.recheck import Recheck

        return {
            **Recheck(certificate, spec, outcome).to_dict(),
            "verdict": verdict,
            "deployed": None if deployed is None else str(deployed),
            "differences": None if found is None else list(found.differences),
            "compared": None if found is None else [file.name for file in found.compared],
            "not_compared": None if found is None else found.left_out,
        }

    def show() -> None:
        if checked is None:
            say(f"REJECTED: {outcome.fault}", verdict="rejected")
            return
        # The deployed files come first: a proof of other numbers is no good news.
        if deployed is not None and found is not None:
            _print_deployed(deployed, found)
        if not brief:
            _print(checked, None if loaded is None else loaded.spec)

    code = exit_codes.VERDICT_CODES.get(verdict, exit_codes.REFUTED)
    return Answer(facts, show, code, loud=rejected)


_NEXT = {
    "refuted": "next: change gains or ranges; nrs-design report SPEC says what would help",
    "inconclusive": "next: search longer, or narrow ranges; nrs-design report SPEC says how",
}


def _deployed(
    deployed: Path | None, loaded: LoadedSpec | None, checked: Certificate | None
) -> DeployedFiles | None:
    """Compare deployed files with a valid certificate; None without files or certificate."""
    if deployed is None or loaded is None or checked is None:
        return None
    from nrs_design.exporters.deployed import compare_deployed
    from nrs_design.pipeline.design import wrong_kind
    from nrs_design.spec import InteractionDesignSpec

    if not isinstance(loaded.spec, InteractionDesignSpec):
        problem = f"a spec of kind {loaded.spec.kind} has no gains that could be deployed"
        raise wrong_kind(loaded, problem, "leave --deployed out")
    if not deployed.exists():
        raise NrsDesignError(
            "there is no such file or folder",
            path=deployed,
            remedy="--deployed names what `nrs-design export` has written",
        )
    return compare_deployed(deployed, loaded.spec, checked)


def _print_deployed(place: Path, deployment: DeployedFiles) -> None:
    if deployment.differences:
        say(f"REJECTED: {place} is not what the certificate is about", verdict="rejected")
        for line in deployment.differences:
            say(f"  {line}")
        return
    description = f"{len(deployment.compared)} files of {place}" if place.is_dir() else str(place)
    say(
        f"deployed: {description}: as exported with the certificate, byte for byte; not compared: "
        f"{deployment.left_out}"
    )


def _print(certificate: Certificate, spec: Spec | None) -> None:
    from nrs_design.certificates.brief import brief

    verdict, contact = certificate.verdict, certificate.refuted_in
    refuted = "" if contact is None else f" (refuted {contact})"
    subject = "this spec, checked exactly"
    if spec is None:
        subject = "the modes in the file, checked exactly; name a SPEC to compare them with"
    say(f"{verdict.upper()}{refuted} for {subject}", verdict=verdict)
    for statement in certificate.statements:
        whole = statement.claim(certificate.system)
        say(f"  {whole if wants_details() else brief(statement, certificate.system)}")
    if verdict in _NEXT:
        say(_NEXT[verdict])
    if spec is not None and wants_details():
        _print_gains(certificate)


def _print_gains(certificate: Certificate) -> None:
    from nrs_design.certificates.units import gain_units

    units = gain_units(certificate)
    for name, gains in certificate.gains.items():
        if gains:
            gain_texts = (f"{gain} = {value} {units[name][gain]}" for gain, value in gains.items())
            say(f"  {name}: {', '.join(gain_texts)}")
