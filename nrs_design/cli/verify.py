"""``nrs-design verify``: re-check a certificate, without a solver."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.options import Json, Quiet, SpecFile
from nrs_design.cli.printing import print_json


def verify(
    certificate: Annotated[Path, typer.Argument(metavar="CERT", help="Certificate file.")],
    spec: SpecFile,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Re-check a certificate against its spec in exact arithmetic, without any solver.

    Exit code 0: the proof holds. 1: the certificate is rejected, or it holds and refutes.

    Example: nrs-design verify reports/soft-tissue.cert.json specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.certificates.certificate import claim
    from nrs_design.certificates.verify import verify as verify_file
    from nrs_design.spec import read_spec

    outcome = verify_file(certificate, read_spec(spec))
    checked = outcome.certificate if outcome.fault is None else None
    verdict = checked.verdict if checked else "rejected"
    statement = claim(checked.system, checked.evidence) if checked else None
    if as_json:
        print_json(
            "verify",
            {
                "verdict": verdict,
                "fault": outcome.fault,
                "claim": statement,
                "gains": dict(checked.gains) if checked else None,
                "assumptions": list(checked.system.assumptions) if checked else None,
                "certificate": str(certificate),
                "certificate_id": checked.id if checked else None,
                "spec": str(spec),
            },
        )
    elif checked is None:
        print(f"REJECTED: {outcome.fault}")
    else:
        print(f"{verdict.upper()}: the certificate holds, checked exactly.")
        if not quiet:
            print(f"  {statement}")
            for name, gains in checked.gains.items():
                if gains:
                    print(f"  {name}: " + ", ".join(f"{k} = {v}" for k, v in gains.items()))
    raise typer.Exit(exit_codes.PROVED if verdict == "proved" else exit_codes.REFUTED)
