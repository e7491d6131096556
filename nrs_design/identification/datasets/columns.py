"""Column names: a quantity, its unit, and an optional group, such as ``angle_rad_2``."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from math import pi
from pathlib import Path
from types import MappingProxyType

from nrs_design.errors import DataError

# Factor to SI for every unit that a quantity may be written in; the first is the SI unit. The
# command of the motor driver is in rpm and stays so.
UNITS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3},
        "deflection": {"m": 1.0, "mm": 1e-3},
        "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3},
        "angle": {"rad": 1.0, "mrad": 1e-3, "deg": pi / 180},
        "torque": {"Nm": 1.0, "mNm": 1e-3},
        "command": {"rpm": 1.0},
        "frequency": {"hz": 1.0, "khz": 1e3},
        "magnitude": {"db": 1.0},
        "phase": {"deg": pi / 180, "rad": 1.0},
    }
)


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a file: where it is, and what turns it into SI.

    Parameters
    ----------
    index : int
        Counted from 0.
    name : str
        In the file.
    factor : float
        SI value over number in the file.
    """

    index: int
    name: str
    factor: float


def standard_name(quantity: str) -> str:
    """Return the name of a column in SI, such as ``force_N``."""
    return f"{quantity}_{next(iter(UNITS[quantity]))}"


def parse_mapping(entries: Sequence[str]) -> dict[str, str]:
    """Read ``OURS=THEIRS`` entries of the option ``--map``.

    Returns
    -------
    dict
        From the name in the file to ours.

    Raises
    ------
    DataError
        If an entry is malformed, names no column of ours, or is there twice.
    """
    mapping: dict[str, str] = {}
    for entry in entries:
        ours, equals, theirs = (part.strip() for part in entry.partition("="))
        if not (ours and equals and theirs):
            raise DataError(f"--map {entry!r} is not a pair", remedy="write --map force_N=Fz")
        _split(ours, None, f"--map {entry!r}: ")
        if theirs in mapping or ours in mapping.values():
            raise DataError(f"--map {entry!r}: the column is mapped twice", remedy="keep one")
        mapping[theirs] = ours
    return mapping


def find_columns(
    header: Sequence[str],
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    path: Path,
    line: int,
) -> tuple[tuple[str, ...], dict[str, dict[str, Column]]]:
    """Find the columns of the first layout that a header has in full.

    Parameters
    ----------
    header : sequence of str
        Names in the file.
    layouts : sequence of tuple of str
        Quantities that belong together; the first one may be shared by all groups.
    mapping : mapping of str to str
        From a name in the file to ours.
    path, line
        Of the header, for errors.

    Returns
    -------
    layout : tuple of str
        The one that was found.
    groups : dict of str to dict of str to Column
        The columns of every group by quantity; the group without suffix is called ``""``.

    Raises
    ------
    DataError
        If a column is missing, is there twice, or has a wrong unit.
    """
    _check_mapped(mapping, header, path, line)
    wanted = {quantity for layout in layouts for quantity in layout}
    found = _grouped(header, wanted, mapping, path, line)
    for layout in layouts:
        groups = _complete(found, layout)
        if groups:
            return layout, groups
    raise _missing(found, header, layouts, path, line)


def _check_mapped(mapping: Mapping[str, str], header: Sequence[str], path: Path, line: int) -> None:
    for theirs in mapping:
        if theirs not in header:
            near = difflib.get_close_matches(theirs, header, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it has {_listed(header)}"
            raise DataError(
                f"there is no column {theirs!r} to map", path=path, line=line, remedy=hint
            )


def _grouped(
    header: Sequence[str],
    wanted: AbstractSet[str],
    mapping: Mapping[str, str],
    path: Path,
    line: int,
) -> dict[str, dict[str, Column]]:
    """Sort the columns of the wanted quantities by group and quantity."""
    found: dict[str, dict[str, Column]] = {}
    for index, name in enumerate(header):
        ours = mapping.get(name, name)
        if ours.partition("_")[0] not in wanted:
            continue
        quantity, unit, group = _split(ours, path, "", line)
        if quantity in found.setdefault(group, {}):
            raise DataError(
                f"the {quantity} is there twice ({found[group][quantity].name!r} and {name!r})",
                path=path,
                line=line,
                remedy="rename one of them, or tell groups apart by a suffix such as _1",
            )
        found[group][quantity] = Column(index, name, UNITS[quantity][unit])
    return found


def _complete(
    found: dict[str, dict[str, Column]], layout: tuple[str, ...]
) -> dict[str, dict[str, Column]]:
    shared = {layout[0]: found.get("", {}).get(layout[0])}
    groups: dict[str, dict[str, Column]] = {}
    for group, columns in found.items():
        available = {key: column for key, column in shared.items() if column} | columns
        if set(layout) <= set(available):
            groups[group] = {quantity: available[quantity] for quantity in layout}
    return groups


def _split(name: str, path: Path | None, prefix: str, line: int | None = None) -> tuple[str, ...]:
    """Take a name apart: quantity, unit, group."""
    quantity, _, rest = name.partition("_")
    unit, _, group = rest.partition("_")
    known = UNITS.get(quantity)
    if known is None:
        raise DataError(
            f"{prefix}{name!r} is no column of ours",
            path=path,
            line=line,
            remedy=f"these are {', '.join(map(standard_name, UNITS))}",
        )
    if unit not in known:
        fault = f"has the unit {unit!r}" if unit else "has no unit"
        units = " or ".join(f"{quantity}_{key}" for key in known)
        raise DataError(
            f"{prefix}the column {name!r} {fault}",
            path=path,
            line=line,
            remedy=f"expected {units}; --map gives a column another name",
        )
    return quantity, unit, group


def _missing(
    found: dict[str, dict[str, Column]],
    header: Sequence[str],
    layouts: Sequence[tuple[str, ...]],
    path: Path,
    line: int,
) -> DataError:
    present = {quantity for columns in found.values() for quantity in columns}
    nearest = min(layouts, key=lambda layout: len(set(layout) - present))
    missing = [standard_name(quantity) for quantity in nearest if quantity not in present]
    expected = " or ".join(", ".join(map(standard_name, layout)) for layout in layouts)
    return DataError(
        f"the columns {', '.join(missing) or 'of one group'} are missing: it has {_listed(header)}",
        path=path,
        line=line,
        remedy=f"expected {expected}; name foreign columns with --map force_N=NAME",
    )


def _listed(header: Sequence[str]) -> str:
    names = [name if len(name) <= 30 else name[:27] + "..." for name in header[:12]]
    return ", ".join(names) + (f" and {len(header) - 12} more" if len(header) > 12 else "")
