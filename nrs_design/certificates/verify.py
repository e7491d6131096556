"""Re-check a certificate file: its proof, and that its modes are those of a spec.

The proof is that of the certificate's own modes (`nrs_design.certificates.prove`). The second step
assembles the modes from the spec and the designed gains; they, their names, the rules of switching
and the assumptions must be the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.certificates.certificate import is_of_growth
from nrs_design.certificates.prove import (
    Verification,
    check_document,
    confirmed,
    find_altered,
    held_system,
    prove,
    read_ages,
    read_certificate,
    read_document,
    read_gains,
    read_points,
)
from nrs_design.proof.system import SwitchedSystem

if TYPE_CHECKING:
    from nrs_design.models.plant import Plant
    from nrs_design.spec import InteractionDesignSpec, LoadedSpec, Spec

__all__ = ["Verification", "prove", "read_document", "verify", "verify_document"]


def verify(path: Path, spec: LoadedSpec | None = None, plant: Plant | None = None) -> Verification:
    """Re-check a certificate file, and whether it belongs to a spec, as read from its own file.

    Without a spec the proof is checked for the modes in the certificate, whosever they are. A file
    that is none at all is a `CertificateError`; flint that disagrees, an `InternalError`.
    """
    return verify_document(read_document(path), spec, plant)


def verify_document(
    document: Mapping[str, Any], spec: LoadedSpec | None = None, plant: Plant | None = None
) -> Verification:
    """Re-check a parsed certificate; spec and plant as for `verify`."""
    if spec is None:
        return prove(document)
    return confirmed(lambda: _verify(document, spec, plant))


def _verify(document: Mapping[str, Any], spec: LoadedSpec, plant: Plant | None) -> Verification:
    if (altered := find_altered(document)) is not None:
        return altered
    if (foreign := find_foreign(document, spec)) is not None:
        return Verification(None, foreign)
    from nrs_design.loop.assemble import assemble_from_text

    ages = read_ages(document)
    said = spec.spec if ages is None else _declaring_more(spec.spec, ages)
    if said is None:
        return Verification(None, "its ages of the force are not all those of the spec")
    gains = read_gains(document)
    system = assemble_from_text(said, gains, plant=plant, points=read_points(document))
    held = held_system(document)
    if not held.enclosures and not is_of_growth(read_certificate(document, system)):
        # Which modes are attained does not matter where nothing grows, and is left out there.
        held = replace(held, enclosures=system.enclosures)
    for field in fields(SwitchedSystem):
        if getattr(held, field.name) != getattr(system, field.name):
            return Verification(None, f"its field {field.name!r} is not that of the spec")
    return check_document(document, system)


def _declaring_more(spec: Spec, ages: tuple[int, int]) -> InteractionDesignSpec | None:
    """Return the spec as if it declared these ages of the force, in samples; None if it may not."""
    from nrs_design.spec.sampling import LONGEST_DELAY

    if spec.kind != "interaction-design" or spec.sampling is None:
        return None
    low, high = spec.sampling.delay
    covered = 0 <= ages[0] <= low and high <= ages[1] <= LONGEST_DELAY
    return spec.declaring_ages(ages) if covered else None


def find_foreign(document: Mapping[str, Any], spec: LoadedSpec) -> str | None:
    """Say why a certificate is not one for this spec."""
    if document.get("spec") != {"name": spec.spec.name, "sha256": spec.sha256}:
        return "it belongs to another spec, or the spec has changed since"
    wanted = getattr(spec.spec, "coordinates", None)
    if document.get("coordinates") != wanted:
        if document.get("coordinates") is None:
            return "it names no coordinates: it is about another law; verify it without the spec"
        return f"it is about other coordinates than {wanted}"
    return None
