"""Errors of records."""

from __future__ import annotations

from nrs_design.errors import NrsDesignError


class DataError(NrsDesignError):
    """Measured data that cannot be used as they are."""

    rule = "NRS006"
