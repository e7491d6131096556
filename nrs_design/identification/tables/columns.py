"""Which columns of a file belong together."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from nrs_design.errors import DataError
from nrs_design.identification.tables.names import (
    UNITS,
    Name,
    read_name,
    standard_name,
    stated_unit,
)

# Returns an error about a file.
Fail = Callable[..., DataError]


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a file: its place, and its factor to SI."""

    index: int  # Counted from 0
    name: str  # In the file
    factor: float  # SI value over number in the file
    unit: str  # The unit that its values have then


def parse_mapping(entries: Sequence[str]) -> dict[str, str]:
    """Read ``OURS=THEIRS`` entries of ``--map``; return standard names by names in the file."""
    mapping: dict[str, str] = {}
    for entry in entries:
        ours, equals, theirs = (part.strip() for part in entry.partition("="))
        if not (ours and equals and theirs):
            raise DataError(f"--map {entry!r} is not a pair", remedy="write --map force_N=Fz")
        _split(ours, DataError, f"--map {entry!r}: ")
        if theirs in mapping or ours in mapping.values():
            raise DataError(f"--map {entry!r}: the column is mapped twice", remedy="keep one")
        mapping[theirs] = ours
    return mapping


def find_columns(
    header: Sequence[str],
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    path: Path,
    line: int | None,
    optional: tuple[str, ...] = (),
) -> tuple[tuple[str, ...], dict[str, Column]]:
    """Return the first layout that a header has in full, and its columns by quantity.

    What the user has mapped decides between layouts, then their order.
    """
    fail = partial(DataError, path=path, line=line)
    _check_mapped(mapping, header, fail)
    wanted = {quantity for layout in layouts for quantity in layout} | set(optional)
    named = {_split(ours, fail).quantity for ours in mapping.values()}
    found: dict[str, Column] = {}
    faults: list[DataError] = []
    for index, text in enumerate(header):
        name = read_name(mapping.get(text, text))
        # A mapped column takes precedence over others with a name of the same quantity.
        if name is None or name.quantity not in wanted:
            continue
        if text not in mapping and name.quantity in named:
            continue
        if not name.known:
            faults.append(_unknown_unit(name, text, "", fail))
            # What would be judged must not fall away in silence.
            if name.quantity in optional:
                raise faults[-1]
            continue
        if name.quantity in found:
            first = found[name.quantity].name
            raise fail(
                f"the {name.quantity} is there twice ({first!r} and {text!r})",
                remedy="rename one of them, or choose with --map "
                f"{standard_name(name.quantity)}=NAME",
            )
        found[name.quantity] = Column(index, text, name.factor, name.read_as)
    for layout in sorted(layouts, key=lambda quantities: len(named - set(quantities))):
        if set(layout) <= found.keys():
            taken = (*layout, *(key for key in optional if key in found))
            return layout, {quantity: found[quantity] for quantity in taken}
    raise faults[0] if faults else _missing(found, header, layouts, fail)


def _check_mapped(mapping: Mapping[str, str], header: Sequence[str], fail: Fail) -> None:
    for theirs, ours in mapping.items():
        if theirs not in header:
            near = difflib.get_close_matches(theirs, header, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it has {_listed(header)}"
            raise fail(f"there is no column {theirs!r} to map", remedy=hint)
        check_stated(theirs, theirs, ours, fail)


def check_stated(theirs: str, text: str, ours: str, fail: Fail) -> None:
    """Refuse a mapping whose unit contradicts a text about the column, such as its name."""
    name = _split(ours, fail)
    unit = stated_unit(text, name.quantity)
    if unit in (None, name.unit) or name.unit in ("", "any"):
        return
    if unit in UNITS[name.quantity]:
        right = f"{name.quantity}_{unit}"
        remedy = f"write --map '{right}={theirs}', or rename the column if its unit is wrong"
    else:
        remedy = f"map another column; if this is one in {name.unit}, correct its name"
    raise fail(
        f"--map '{ours}={theirs}': the column {theirs!r} says {unit}, and {ours} is in {name.unit}",
        remedy=remedy,
    )


def _split(text: str, fail: Fail, prefix: str = "") -> Name:
    """Take a name of ours apart, and check its unit."""
    name = read_name(text)
    if name is None:
        raise fail(
            f"{prefix}{text!r} is no column of ours",
            remedy=f"these are {', '.join(map(standard_name, UNITS))}",
        )
    if not name.known:
        raise _unknown_unit(name, text, prefix, fail)
    return name


def _unknown_unit(name: Name, text: str, prefix: str, fail: Fail) -> DataError:
    fault = f"has the unit {name.unit!r}" if name.unit else "has no unit"
    units = " or ".join(f"{name.quantity}_{key}" for key in UNITS[name.quantity])
    return fail(
        f"{prefix}the column {text!r} {fault}",
        remedy=f"expected {units}; --map gives a column another name",
    )


def _missing(
    present: Collection[str], header: Sequence[str], layouts: Sequence[tuple[str, ...]], fail: Fail
) -> DataError:
    nearest = min(layouts, key=lambda layout: len(set(layout).difference(present)))
    missing = [_called(quantity) for quantity in nearest if quantity not in present]
    expected = " or ".join(", ".join(map(_called, layout)) for layout in layouts)
    return fail(
        f"the columns {', '.join(missing)} are missing: it has {_listed(header)}",
        remedy=f"expected {expected}, in these units or others; name foreign columns with --map "
        f"{missing[0]}=NAME",
    )


def _called(quantity: str) -> str:
    """Return what a user calls a column: two are named by options."""
    options = {"input": "the column of --command", "output": "the column of --measured"}
    return options.get(quantity) or standard_name(quantity)


def _listed(header: Sequence[str]) -> str:
    names = [name if len(name) <= 30 else name[:27] + "..." for name in header[:12]]
    return ", ".join(names) + (f" and {len(header) - 12} more" if len(header) > 12 else "")
