"""The base of all spec models."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class SpecModel(BaseModel):
    """Frozen, with no key beyond the declared ones."""

    # Validators are built on first use: a command pays only for the kind of spec that it reads.
    model_config = ConfigDict(
        extra="forbid", frozen=True, arbitrary_types_allowed=True, defer_build=True
    )
