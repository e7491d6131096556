"""Export record of a design and its proof."""

from __future__ import annotations

import struct
from fractions import Fraction
from typing import Any

from nrs_design import __version__
from nrs_design.certificates.catalogue import sentences
from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gains import gains_of, idle_decay
from nrs_design.errors import CertificateError
from nrs_design.exporters.record import (
    CompliantController,
    ExportRecord,
    ForceFilter,
    Gain,
    IdleStates,
    MotionController,
    Package,
    Proof,
    SampleTime,
    SpecReference,
)
from nrs_design.proof.evidence.fields import rate_text
from nrs_design.proof.mode import Time
from nrs_design.proof.text import exact_text
from nrs_design.spec import InteractionDesignSpec, LoadedSpec


def build_record(
    design: ControllerDesign, certificate: Certificate, spec: InteractionDesignSpec
) -> ExportRecord:
    """Put a design and its proof together.

    The certificate was made or re-checked just now. A `CertificateError` if it proves nothing, or
    is about other gains.
    """
    fault = find_mismatch(design, certificate)
    if fault is not None:
        raise CertificateError(f"the certificate {fault}")
    system, evidence = certificate.system, certificate.evidence
    sampling = None if system.sample_time is None else spec.sampling
    covers_rounding = evidence is not None and evidence.covers_rounding
    return ExportRecord(
        **_contents(design, spec),
        spec=SpecReference(name=certificate.spec_name, sha256=certificate.spec_sha256),
        sample_time=None if sampling is None else SampleTime(exact=exact_text(sampling.step)),
        delay=None if sampling is None else sampling.delay,
        timing=_timing(spec),
        outside=outside_of(sampled=system.sample_time is not None, covers_rounding=covers_rounding),
        proof=_proof(certificate),
    )


def build_unproved(
    loaded: LoadedSpec, design: ControllerDesign, reason: str, period: Fraction, proof: Proof | None
) -> ExportRecord:
    """Describe a design that a processor is to run although, for a reason, that is not proved.

    The period is in s; `proof` is of something else, such as the loop in continuous time.
    """
    spec = loaded.spec
    assert isinstance(spec, InteractionDesignSpec)
    return ExportRecord(
        **_contents(design, spec),
        spec=SpecReference(name=spec.name, sha256=loaded.sha256),
        verdict="unproved",
        unproved=reason,
        sample_time=SampleTime(exact=exact_text(period)),
        delay=None if spec.sampling is None else spec.sampling.delay,
        timing=_timing(spec),
        outside=outside_of(sampled=False, covers_rounding=False) if proof else (NOTHING,),
        proof=proof,
    )


def _contents(design: ControllerDesign, spec: InteractionDesignSpec) -> dict[str, Any]:
    """Return the fields of a record that need no proof."""
    idle, low_pass = spec.idle_states, design.sensor.filter
    return {
        "package": Package(version=__version__),
        "motion": MotionController(gains=_gains(design, design.motion.name)),
        "controllers": tuple(
            CompliantController(
                name=controller.name,
                law=controller.law.name,
                environment=controller.environment,
                contacts=controller.contacts,
                gains=_gains(design, controller.name),
            )
            for controller in design.controllers
        ),
        "idle_states": None
        if idle is None
        else IdleStates(decay=_gain("decay", "1/s", idle_decay(idle)), reset=idle.reset),
        "offset": None if spec.offset == "none" else spec.offset,
        "force_filter": None
        if low_pass is None
        else ForceFilter(order=low_pass.order, pole=_gain("pole", "rad/s", low_pass.pole)),
    }


def _proof(certificate: Certificate) -> Proof:
    system, evidence = certificate.system, certificate.evidence
    rate = None if evidence is None else evidence.proved_rate(system)
    if evidence is None or rate is None:
        raise CertificateError("the certificate states no rate")
    unit = "1/s" if system.time is Time.CONTINUOUS else "1 per step"
    return Proof.model_validate(
        {
            "claim": evidence.claim(system),
            "certificate_id": certificate.id,
            "decay_rate": {
                "exact": str(rate),
                "rounded": rate_text(rate, system.time),
                "unit": unit,
            },
            "coordinates": certificate.coordinates,
            "assumptions": sentences(certificate.granted),
        }
    )


def find_mismatch(design: ControllerDesign, certificate: Certificate) -> str | None:
    """Say why a valid certificate does not cover a design; None if it does."""
    if certificate.verdict != "proved":
        return "does not prove stability"
    designed = gains_of(design)
    for name in designed.keys() | certificate.gains.keys():
        if dict(certificate.gains.get(name, {})) != designed.get(name):
            return f"is about other gains of {name} than the designed ones"
    return None


def _timing(spec: InteractionDesignSpec) -> str | None:
    """Say when commands take effect, and which are missed; None for every sample, at once."""
    sampling, texts = spec.sampling, []
    if sampling is None:
        return None
    if spec.late_at is not None:
        first, last = map(exact_text, spec.late)
        delay_text = f"{first} s" if first == last else f"{first} s to {last} s"
        texts.append(f"commands take effect {delay_text} after their sample")
        if sampling.jitter is not None:
            unsteady = exact_text(sampling.unsteady)
            texts[0] += f", and a period is up to {unsteady} s longer or shorter"
    if (misses := sampling.misses) is not None:
        instead = "the command before is held" if misses.command == "hold" else "the command is 0"
        texts.append(f"at most {misses} may be missed: no step is made then, and {instead}")
    return "; ".join(texts) or None


def _gains(design: ControllerDesign, name: str) -> tuple[Gain, ...]:
    units = design.units[name]
    return tuple(_gain(key, units[key], value) for key, value in design.laws[name].gains.items())


def _gain(name: str, unit: str, value: Fraction) -> Gain:
    return Gain(
        name=name,
        unit=unit,
        exact=exact_decimal(value),
        float32=float(value),
        float32_bits="0x" + struct.pack(">f", float(value)).hex(),
    )


NOTHING = "Everything: nothing is proved."
CONTINUOUS = (
    "Sampling and delay: the proof is about continuous time, and a program that runs the law in "
    "steps is not covered."
)
NOT_ROUNDED = (
    "Rounding: the proof is about the law computed without it, not about single-precision "
    "arithmetic."
)
UNMODELED_EFFECTS = (
    "Whatever a program does beside the law: clamps, saturation, rate limits, guards against wrong "
    "input, its start and its stop.",
    "Input and output: sensors, buses, drivers, clocks and schedulers, beyond what the assumptions "
    "say of them.",
    "Whether the program, its compiler and its processor compute the law with these numbers.",
)


def outside_of(*, sampled: bool, covers_rounding: bool) -> tuple[str, ...]:
    """Return the effects outside a proof."""
    if not sampled:
        return (CONTINUOUS, *UNMODELED_EFFECTS)
    return UNMODELED_EFFECTS if covers_rounding else (NOT_ROUNDED, *UNMODELED_EFFECTS)
