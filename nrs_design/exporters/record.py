"""The export record: the gains that ship, and the proof that covers them. JSON is its dump."""

from __future__ import annotations

import json
import struct
from fractions import Fraction
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from nrs_design.controllers.float32 import exact_decimal

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
        stored: float = struct.unpack(">f", bits.to_bytes(4, "big"))[0]
        # The text tells -0 from 0.
        if (
            repr(stored) != repr(self.float32)
            or exact_decimal(Fraction(self.float32)) != self.exact
        ):
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
    """What the states of impedance and pi-force controllers do while others are active.

    The robot must do it: the proof is about controllers that let them decay, or reset them. The
    integral of a pi-force controller stays in the command of the motion loop meanwhile.
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
    coordinates: Literal["deflection"]
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
    # Only for impedance controllers together with other controllers.
    idle_states: IdleStates | None = None
    # Only where force controllers have one.
    offset: Literal["reference", "measured"] | None = None
    # Only if the force signal is filtered before the controllers.
    force_filter: ForceFilter | None = None
    verdict: Literal["proved", "unproved"] = "proved"
    unproved: str | None = None
    # Only where a processor samples the loop.
    sample_time: SampleTime | None = None
    # Smallest and largest age of the force sample, in samples.
    delay: tuple[int, int] | None = None
    # Text on the delay of commands, on jitter and on missed deadlines; None without them.
    timing: str | None = None
    # What no proof covers.
    outside: tuple[str, ...]
    # In an unproved record: a proof about another loop, such as the one in continuous time.
    proof: Proof | None = None

    @model_validator(mode="after")
    def _check_verdict(self) -> ExportRecord:
        proved = self.verdict == "proved"
        if proved != (self.unproved is None) or (proved and self.proof is None):
            raise ValueError(
                "the verdict is neither proved with a proof, nor unproved for a reason"
            )
        return self


def dump_record(record: ExportRecord) -> str:
    """Return the JSON text of a record."""
    return json.dumps(record.model_dump(mode="json", by_alias=True), indent=2) + "\n"


def record_schema_text() -> str:
    """Return the JSON Schema (draft 2020-12) that every record keeps, as the text of a file."""
    described = ExportRecord.model_json_schema(mode="serialization")
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "nrs-design export"}
    return json.dumps(head | described | head, indent=2) + "\n"


def header_lines(record: ExportRecord) -> tuple[str, ...]:
    """Return the head of a file: origin, verdict, sample time, units, effects outside the proof.

    Every line is one sentence or one ``key: value``; none holds a line break.
    """
    proof = record.proof
    certificate = "none" if proof is None else proof.certificate_id
    verdict = "PROVED" if record.unproved is None else f"UNPROVED: {record.unproved}"
    return (
        f"nrs-design {record.package.version}, {record.schema_id}",
        f"spec: {record.spec.name}, sha256 {record.spec.sha256}",
        f"certificate: {certificate}",
        f"verdict: {verdict}",
        *(() if proof is None else (f"claim: {proof.claim}",)),
        f"sample time: {_sample_time(record)}",
        "units: SI; each gain has its unit beside it, which names that of the motor",
        *(f"outside the proof: {text}" for text in record.outside),
    )


def _sample_time(record: ExportRecord) -> str:
    if record.sample_time is None:
        return "none, the statement is about continuous time"
    text = f"{record.sample_time.exact} s"
    if record.delay is None:
        return text
    lowest, highest = record.delay
    ages = str(lowest) if lowest == highest else f"{lowest} to {highest}"
    text = f"{text}, force sample {ages} sample{'' if highest == 1 else 's'} old"
    return text if record.timing is None else f"{text}; {record.timing}"
