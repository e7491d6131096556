"""The re-check of a certificate file."""

from __future__ import annotations

from pathlib import Path

from nrs_design.certificates.verify import Verification
from nrs_design.certificates.verify import verify as verify_file
from nrs_design.spec import read_spec


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
        Its `fault` says why the certificate is rejected, None if it is valid. What is shown,
        ``certificate.verdict``, may be a refutation; true in a condition if it is a proof.

    Raises
    ------
    SpecError, CertificateError
        If a file cannot be read at all.
    """
    return verify_file(Path(certificate), None if spec is None else read_spec(spec))
