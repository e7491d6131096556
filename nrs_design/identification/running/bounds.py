"""Bounds of a spec that a log can show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from nrs_design.certificates.verify import verify
from nrs_design.controllers.sector import Sector, sector_of
from nrs_design.errors import CertificateError, DesignError
from nrs_design.proof.evidence import Shows
from nrs_design.spec import InteractionDesignSpec, LoadedSpec, SwitchingSpec


@dataclass(frozen=True, slots=True)
class RunBounds:
    """What a run may do."""

    # Shortest and longest time in each controller, in s.
    dwell_times: Mapping[str, tuple[float, float]]
    transitions: frozenset[tuple[str, str]] | None  # Allowed switches; None allows all
    names_contacts: bool  # Whether rules name contacts, which no log shows
    torque: float  # Largest torque in N m
    delay: float | None  # Required delay margin in s
    # Lever arm in m for linear columns; None if the environments declare no or several arms.
    lever_arm: float | None
    period: float | None  # Sample period of the proof in s; None for a proof in continuous time
    # Declared contact: True if losable, False if kept, None if not declared.
    losable: bool | None
    command: str  # Unit of the motor's command
    # Assumed deflections of each environment, as text.
    preloads: Mapping[str, str] = field(default_factory=dict)
    # Saturation level of the driver, in the unit of the command; None if unknown.
    saturates: float | None = None
    # Sector condition on torque and angle of every row, or the reason for its absence.
    sector: Sector | str = ""
    oldest: float = 0.0  # How old a torque may be in its row, in s
    latency: str = ""  # Delay from sample to command, as text; empty without a delay
    proved: bool = False  # Whether a valid certificate proves the spec

    @property
    def source(self) -> str:
        """Return the source of the bounds; without a certificate it does not mention a proof."""
        return "the proof" if self.proved else "the spec, which is not proved"

    @property
    def assumption_basis(self) -> str:
        """The basis of what no check shows."""
        return f"taken for granted by {self.source}"


def read_run_bounds(loaded: LoadedSpec) -> RunBounds:
    """Read the bounds out of the spec of an interaction design."""
    spec = loaded.spec
    if not isinstance(spec, InteractionDesignSpec):
        raise DesignError(
            f"a spec of kind {spec.kind} has no bounds to compare a log with",
            path=loaded.path,
            remedy="name a spec of kind interaction-design",
        )
    return bounds_of_spec(spec)


def proof_of(certificate: Path | None, loaded: LoadedSpec) -> tuple[str, bool]:
    """Say why the spec is not proved, and whether a proof holds while contact is lost.

    The reason is empty if the certificate proves it; one that is rejected is a `CertificateError`.
    """
    if certificate is None:
        return "no certificate is named", False
    outcome = verify(certificate, loaded)
    if outcome.certificate is None or outcome.fault is not None:
        raise CertificateError(
            f"the certificate is rejected: {outcome.fault}",
            path=certificate,
            remedy="create a new certificate with certify-switching --out, or name its spec",
        )
    verdict, statements = outcome.certificate.verdict, outcome.certificate.statements
    if verdict != "proved":
        return f"its certificate says {verdict}", False
    # A proof of a spec with losable contact covers lost contact, whatever its evidence.
    is_required = loaded.spec.kind == "interaction-design" and loaded.spec.contact == "losable"
    covered = any(s.shows is Shows.STABILITY and s.covers_lost_contact for s in statements)
    return "", is_required or covered


def bounds_of_spec(spec: InteractionDesignSpec) -> RunBounds:
    """Return the bounds of a design; see `read_run_bounds`."""
    arms = {e.lever_arm.si for e in spec.environments.values() if e.lever_arm is not None}
    rules = spec.switching.of_a_run
    transitions = rules.transitions
    margin = spec.goals.min_delay_margin if spec.goals else None
    return RunBounds(
        dwell_times={name: _stay(rules, name) for name in spec.controllers},
        transitions=None if transitions is None else frozenset(transitions),
        names_contacts=spec.switching.names_contacts,
        torque=spec.limits.torque.si,
        delay=None if margin is None else margin.si,
        lever_arm=arms.pop() if len(arms) == 1 else None,
        period=_period(spec),
        losable=None if spec.contact is None else spec.contact == "losable",
        command=spec.command,
        preloads={
            name: " to ".join(end.text for end in preload)
            for name in spec.touched
            if (preload := spec.environments[name].preload_range) is not None
        },
        saturates=None if spec.limits.command is None else spec.limits.command.si,
        sector=sector_of(spec),
        oldest=0.0 if spec.sampling is None else float(spec.sampling.oldest),
        latency=_latency_text(spec),
    )


def _latency_text(spec: InteractionDesignSpec) -> str:
    if spec.late_at is None:
        return ""
    first, last = (f"{float(end):g} s" for end in spec.late)
    return first if first == last else f"{first} to {last}"


def _period(spec: InteractionDesignSpec) -> float | None:
    """Return when the law runs; of two periods, a log does not say which it has."""
    sampling = spec.sampling
    return None if sampling is None or sampling.round > 1 else sampling.period.si


def _stay(rules: SwitchingSpec, name: str) -> tuple[float, float]:
    shortest, longest = rules.stay(name)
    return (
        float(shortest.value) if shortest else 0.0,
        float(longest.value) if longest else float("inf"),
    )
