"""The re-check of a certificate file."""

from __future__ import annotations

from pathlib import Path

from nrs_design.api.recheck import Recheck
from nrs_design.certificates.verify import verify as verify_file
from nrs_design.spec import read_spec


def verify(certificate: str | Path, spec: str | Path | None = None) -> Recheck:
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
    Recheck
        Its `fault` says why the certificate is rejected, None if it is valid. Its
        `verdict` may be ``refuted``; true in a condition if it is a proof.

    Raises
    ------
    SpecError, CertificateError
        If a file cannot be read at all.
    """
    file = Path(certificate)
    if spec is None:
        return Recheck(file, None, verify_file(file))
    return Recheck(file, Path(spec), verify_file(file, read_spec(spec)))
