"""Records, from the library."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from nrs_design.wings import load_wing


def identify(
    records: str | Path | Iterable[str | Path], kind: str = "tissue", *, law: str | None = None
) -> Any:
    """Fit a tissue or an actuator to records, with 95 % intervals.

    Parameters
    ----------
    records : path-like or iterable of path-like
        CSV files; see `nrs-design identify` for their columns.
    kind : {"tissue", "actuator"}
        What they are records of. Resistance and torque of an actuator are said for the motor of
        thesis table 4.1; gain, time constant, friction and dead time depend on no data sheet.
    law : str, optional
        Of the tissue; by default the one that the records speak for.

    Returns
    -------
    TissueIdentification or ActuatorIdentification
        Of `nrs_design.identification`, with the choice, its intervals and what is doubtful.

    Raises
    ------
    DataError
        If a file is no such record, or there is no such kind or law.

    Examples
    --------
    >>> import nrs_design as nrs
    >>> found = nrs.identify([f"specs/data/silicone-soft-{i}.csv" for i in (1, 2, 3)])
    >>> found.chosen.law.name, len(found.doubts)
    ('elastic', 0)
    """
    files = [records] if isinstance(records, str | Path) else [*records]
    library = load_wing("identification", "library")
    return library.identify_records([Path(file) for file in files], kind, law)
