"""The export record: the gains that ship, and the proof that covers them. JSON is its dump."""

from __future__ import annotations

import json
import struct
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from nrs_design import __version__
from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gains import gains_of, idle_decay
from nrs_design.controllers.sensor import LowPass
from nrs_design.errors import CertificateError
from nrs_design.exporters.outside import outside_of
from nrs_design.proof.evidence.fields import rate_text
from nrs_design.proof.system import Time
from nrs_design.proof.text import exact_text
from nrs_design.spec import IdleStatesSpec, InteractionDesignSpec, LoadedSpec
from nrs_design.spec.controllers import Offset

Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class _Frozen(BaseModel):
    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, populate_by_name=True, allow_inf_nan=False
    )


class Gain(_Frozen):
    """One gain, three times the same number.

    ``exact`` is its exact decimal, ``float32`` the JSON number that reads back as the same
    single-precision number, and ``float32_bits`` that number's bits in hexadecimal.
    """

    name: str
    unit: str
    exact: str
    float32: float
    float32_bits: str = Field(pattern="^0x[0-9a-f]{8}$")

    @model_validator(mode="after")
    def _check_agreement(self) -> Gain:
        bits = int(self.float32_bits, 16)
        held: float = struct.unpack(">f", bits.to_bytes(4, "big"))[0]
        # The text tells -0 from 0.
        if repr(held) != repr(self.float32) or exact_decimal(Fraction(self.float32)) != self.exact:
            raise ValueError(f"the three forms of gain {self.name} are not the same number")
        return self


class MotionController(_Frozen):
    """The PD controller of the motion loop, ``delta = Kp e + Kd e'``."""

    law: Literal["motion"] = "motion"
    gains: tuple[Gain, ...]


class CompliantController(_Frozen):
    """One controller, with what it was designed for and what it may touch."""

    name: str
    law: str
    environment: str | None
    contacts: tuple[str, ...]
    gains: tuple[Gain, ...]


class IdleStates(_Frozen):
    """What the states of impedance controllers do while another kind of controller is active.

    The robot must do it: the proof is about controllers that let them decay, or reset them.
    """

    decay: Gain
    reset: bool


class ForceFilter(_Frozen):
    """The low-pass of the force signal: so many equal lags in a row, each with this pole."""

    order: int
    pole: Gain


class SpecReference(_Frozen):
    """The spec that the design belongs to."""

    name: str
    sha256: Sha256


class DecayRate(_Frozen):
    """The certified rate: exactly, and as a short decimal on its safe side.

    In continuous time alpha in 1/s, in discrete time rho per step.
    """

    exact: str
    rounded: str
    unit: Literal["1/s", "1 per step"] = "1/s"


class Proof(_Frozen):
    """What is proved about these gains, and by which certificate."""

    verdict: Literal["proved"] = "proved"
    claim: str
    certificate_id: Sha256
    decay_rate: DecayRate
    coordinates: Literal["deflection", "force"]
    assumptions: tuple[str, ...]


class SampleTime(_Frozen):
    """Time from one sample to the next, exactly as the spec or the command states it."""

    exact: str
    unit: Literal["s"] = "s"


class Package(_Frozen):
    """What made the record."""

    name: Literal["nrs-design"] = "nrs-design"
    version: str


class ExportRecord(_Frozen):
    """A design, complete, with its proof: what every format says is in it.

    ``verdict`` is about what the file is for: an executable file is proved only where its sampled
    loop is, at its sample time; without that it is made on request only, and ``unproved`` says why.
    """

    schema_id: Literal["nrs-design/export/1"] = Field(default="nrs-design/export/1", alias="schema")
    package: Package
    spec: SpecReference
    motion: MotionController
    controllers: tuple[CompliantController, ...] = Field(min_length=1)
    # Only where impedance controllers stand beside others.
    idle_states: IdleStates | None = None
    # Only where force controllers have one.
    offset: Literal["reference", "measured"] | None = None
    # Only where the force passes through one on its way to the controllers.
    force_filter: ForceFilter | None = None
    verdict: Literal["proved", "unproved"] = "proved"
    unproved: str | None = None
    # Only where a processor samples the loop.
    sample_time: SampleTime | None = None
    # Smallest and largest age of the force sample, in samples.
    delay: tuple[int, int] | None = None
    # What no proof covers.
    outside: tuple[str, ...]
    # Unproved, it is there where something else than the sampled loop is proved.
    proof: Proof | None = None

    @model_validator(mode="after")
    def _check_verdict(self) -> ExportRecord:
        proved = self.verdict == "proved"
        if proved != (self.unproved is None) or (proved and self.proof is None):
            raise ValueError(
                "the verdict is neither proved with a proof, nor unproved for a reason"
            )
        return self


def build_record(
    design: ControllerDesign,
    certificate: Certificate,
    idle: IdleStatesSpec | None,
    offset: Offset = "none",
    delay: tuple[int, int] | None = None,
) -> ExportRecord:
    """Put a design and its proof together.

    Parameters
    ----------
    design : ControllerDesign
        The gains that ship.
    certificate : Certificate
        Made or re-checked just now; it must prove stability of exactly these gains.
    idle : IdleStatesSpec or None
        Of the spec that the certificate is about.
    offset : {"none", "reference", "measured"}
        Where its force controllers take X_i from.
    delay : (int, int), optional
        Smallest and largest age of the force sample of that spec.

    Raises
    ------
    CertificateError
        If the certificate proves nothing, or is about other gains.
    """
    fault = find_mismatch(design, certificate)
    if fault is not None:
        raise CertificateError(f"the certificate {fault}")
    system = certificate.system
    return ExportRecord(
        **_contents(design, idle, offset),
        spec=SpecReference(name=certificate.spec_name, sha256=certificate.spec_sha256),
        sample_time=_sample_time(system.sample_time),
        delay=delay,
        outside=outside_of(sampled=system.sample_time is not None),
        proof=_proof(certificate),
    )


def build_unproved(
    loaded: LoadedSpec, design: ControllerDesign, reason: str, period: Fraction, proof: Proof | None
) -> ExportRecord:
    """Describe a design that a processor is to run although that is not proved.

    Parameters
    ----------
    loaded : LoadedSpec
        An interaction design.
    design : ControllerDesign
        Its gains.
    reason : str
        Why it is not proved.
    period : Fraction
        Sample time in s.
    proof : Proof or None
        What is proved of something else, such as the loop in continuous time.
    """
    spec = loaded.spec
    assert isinstance(spec, InteractionDesignSpec)
    return ExportRecord(
        **_contents(design, spec.idle_states, spec.offset),
        spec=SpecReference(name=spec.name, sha256=loaded.sha256),
        verdict="unproved",
        unproved=reason,
        sample_time=_sample_time(period),
        delay=None if spec.sampling is None else spec.sampling.delay,
        outside=outside_of(sampled=False) if proof else ("Everything: nothing is proved.",),
        proof=proof,
    )


def _contents(
    design: ControllerDesign, idle: IdleStatesSpec | None, offset: Offset
) -> dict[str, Any]:
    """Return what ships, whatever is known of it."""
    return {
        "package": Package(version=__version__),
        "motion": MotionController(gains=_gains(design, design.motion.name)),
        "controllers": tuple(
            CompliantController.model_validate(
                {
                    "name": controller.name,
                    "law": controller.law.name,
                    "environment": controller.environment,
                    "contacts": controller.contacts,
                    "gains": _gains(design, controller.name),
                }
            )
            for controller in design.controllers
        ),
        "idle_states": None if idle is None else _idle_states(idle),
        "offset": None if offset == "none" else offset,
        "force_filter": _force_filter(design.sensor.filter),
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
            "decay_rate": DecayRate.model_validate(
                {"exact": str(rate), "rounded": rate_text(rate, system.time), "unit": unit}
            ),
            "coordinates": certificate.coordinates,
            "assumptions": system.assumptions,
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


def dump_record(record: ExportRecord) -> str:
    """Return the JSON text of a record."""
    return json.dumps(record.model_dump(mode="json", by_alias=True), indent=2) + "\n"


def _sample_time(period: Fraction | None) -> SampleTime | None:
    return None if period is None else SampleTime(exact=exact_text(period))


def schema_text() -> str:
    """Return the JSON Schema (draft 2020-12) that every record keeps, as the text of a file."""
    described = ExportRecord.model_json_schema(mode="serialization")
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "nrs-design export",
    }
    return json.dumps(head | described | head, indent=2) + "\n"


def _idle_states(idle: IdleStatesSpec) -> IdleStates:
    return IdleStates(decay=_gain("decay", "1/s", idle_decay(idle)), reset=idle.reset)


def _force_filter(low_pass: LowPass | None) -> ForceFilter | None:
    if low_pass is None:
        return None
    return ForceFilter(order=low_pass.order, pole=_gain("pole", "rad/s", low_pass.pole))


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
