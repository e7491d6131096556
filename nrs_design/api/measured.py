"""Records, from the library."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from nrs_design.api.identified import Identification
from nrs_design.wings import load_wing


def identify(
    records: str | Path | Iterable[str | Path],
    kind: str = "tissue",
    *,
    law: str | None = None,
    columns: Mapping[str, str] | None = None,
) -> Identification:
    """Find a tissue, an actuator or a delay in records, with 95 % intervals.

    Parameters
    ----------
    records : path-like or iterable of path-like
        CSV files; see `nrs-design identify` for their columns. Of a delay, one.
    kind : {"tissue", "actuator", "delay"}
        What they are records of. Resistance and torque of an actuator are said for the motor of
        thesis table 4.1; gain, time constant, friction and dead time depend on no data sheet.
    law : str, optional
        Of the tissue; by default the one that the records speak for.
    columns : mapping of str to str, optional
        Foreign names of columns, as in ``{"force_N": "Fz"}``; of a delay, also which columns are
        its ``command`` and what was ``measured``.

    Raises
    ------
    DataError
        If a file is no such record, or there is no such kind, law or column.

    Examples
    --------
    >>> import nrs_design as nrs
    >>> found = nrs.identify([f"specs/data/silicone-soft-{i}.csv" for i in (1, 2, 3)])
    >>> found.chosen, list(found.ranges), found.ranges["k"].unit, found.doubts
    ('elastic', ['k'], 'N/m', ())
    """
    files = [records] if isinstance(records, str | Path) else [*records]
    library = load_wing("identification", "api.library")
    found: Identification = library.identify_records(files, kind, law, columns or {})
    return found
