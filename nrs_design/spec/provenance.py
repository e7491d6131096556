"""Where an identified value comes from."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from nrs_design.spec.fields import Hash, Title
from nrs_design.spec.model import SpecModel

MAX_SOURCES = 1000


class ProvenanceSpec(SpecModel):
    """A file of measured data, as `nrs-design identify --write` notes it down."""

    file: Title = Field(description="name of the data file, one line, no unit")
    sha256: Hash = Field(description="SHA-256 of its bytes, 64 hexadecimal digits")
    data: Literal["measured", "synthetic"] = Field(
        description="measured, or synthetic: made by a simulation"
    )


Provenance = Annotated[tuple[ProvenanceSpec, ...], Field(max_length=MAX_SOURCES)]
PROVENANCE = "data files that the values were identified from, by nrs-design identify"
