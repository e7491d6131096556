"""Which columns of a file belong together."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from nrs_design.errors import DataError
from nrs_design.identification.tables.names import (
    UNITS,
    Name,
    read_name,
    read_stamp,
    standard_name,
    stated_unit,
)

# Returns an error about a file.
Fail = Callable[..., DataError]


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a file: where it is, and what turns it into SI."""

    index: int  # Counted from 0
    name: str  # In the file
    factor: float  # SI value over number in the file
    unit: str  # The unit that its values have then


def parse_mapping(entries: Sequence[str]) -> dict[str, str]:
    """Read ``OURS=THEIRS`` entries of the option ``--map``: from the name in the file to ours."""
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
) -> tuple[tuple[str, ...], dict[str, dict[str, Column]]]:
    """Return the first layout that a header has in full, and its columns by group and quantity.

    What the user has mapped decides between layouts, then their order. The group without a suffix
    is called ``""``; the first quantity of a layout may be shared by all groups.
    """
    fail = partial(DataError, path=path, line=line)
    _check_mapped(mapping, header, fail)
    wanted = {quantity for layout in layouts for quantity in layout} | set(optional)
    named = {_split(ours, fail).quantity for ours in mapping.values()}
    found, faults = _grouped(header, wanted, named, mapping, fail)
    for quantity, error in faults:
        # What was mapped, or would be judged, must not fall away in silence.
        if quantity in optional:
            raise error
    for layout in sorted(layouts, key=lambda quantities: len(named - set(quantities))):
        groups = _complete(found, layout, optional)
        if groups:
            return layout, groups
    raise faults[0][1] if faults else _missing(found, header, layouts, fail)


def _check_mapped(mapping: Mapping[str, str], header: Sequence[str], fail: Fail) -> None:
    for theirs in mapping:
        if theirs not in header:
            near = difflib.get_close_matches(theirs, header, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"it has {_listed(header)}"
            raise fail(f"there is no column {theirs!r} to map", remedy=hint)
    for theirs, ours in mapping.items():
        check_stated(theirs, stated_unit(theirs, _split(ours, fail).quantity), ours, fail)


def check_stated(theirs: str, unit: str | None, ours: str, fail: Fail) -> None:
    """Refuse a mapping whose unit contradicts the name of the column."""
    name = _split(ours, fail)
    if unit in (None, name.unit) or name.unit in ("", "any"):
        return
    if unit in UNITS[name.quantity]:
        right = "_".join(filter(None, (name.quantity, unit, name.group)))
        remedy = f"write --map '{right}={theirs}', or rename the column if its unit is wrong"
    else:
        remedy = f"map another column; if this is one in {name.unit}, correct its name"
    raise fail(
        f"--map '{ours}={theirs}': the column {theirs!r} says {unit}, and {ours} is in {name.unit}",
        remedy=remedy,
    )


def _grouped(
    header: Sequence[str],
    wanted: AbstractSet[str],
    named: AbstractSet[str],
    mapping: Mapping[str, str],
    fail: Fail,
) -> tuple[dict[str, dict[str, Column]], list[tuple[str, DataError]]]:
    """Sort the columns of the wanted quantities; also return those whose unit is not known.

    Quantities that are named by a mapping come from no other column.
    """
    found: dict[str, dict[str, Column]] = {}
    faults: list[tuple[str, DataError]] = []
    full = {
        (name.group, name.quantity)
        for text in header
        if (name := read_name(mapping.get(text, text))) and not name.loose
    }
    for index, text in enumerate(header):
        ours = mapping.get(text)
        name = read_name(text if ours is None else ours)
        # A mapped column takes precedence over others with a name of the same quantity.
        if name is None or name.quantity not in wanted or (ours is None and name.quantity in named):
            continue
        if name.loose and (name.group, name.quantity) in full:
            continue
        if not name.known:
            faults.append((name.quantity, _unknown_unit(name, text, "", fail)))
            continue
        if name.quantity in found.setdefault(name.group, {}):
            first = found[name.group][name.quantity].name
            raise fail(
                f"the {name.quantity} is there twice ({first!r} and {text!r})",
                remedy="rename one of them, tell groups apart by a suffix such as _1, or choose "
                f"with --map {standard_name(name.quantity)}=NAME",
            )
        found[name.group][name.quantity] = Column(index, text, name.factor, name.read_as)
    if "time" in wanted and not any("time" in group for group in found.values()):
        # The first time stamp of a bag is taken for the time.
        for index, text in enumerate(header):
            if stamp := read_stamp(text):
                found.setdefault("", {})["time"] = Column(index, text, stamp.factor, stamp.read_as)
                break
    return found, faults


def _complete(
    found: dict[str, dict[str, Column]], layout: tuple[str, ...], optional: tuple[str, ...]
) -> dict[str, dict[str, Column]]:
    shared = {key: column for key, column in found.get("", {}).items() if key == layout[0]}
    groups: dict[str, dict[str, Column]] = {}
    for group, columns in found.items():
        available = shared | columns
        if set(layout) <= set(available):
            taken = (*layout, *(key for key in optional if key in available))
            groups[group] = {quantity: available[quantity] for quantity in taken}
    return groups


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
    found: dict[str, dict[str, Column]],
    header: Sequence[str],
    layouts: Sequence[tuple[str, ...]],
    fail: Fail,
) -> DataError:
    present = {quantity for columns in found.values() for quantity in columns}
    nearest = min(layouts, key=lambda layout: len(set(layout) - present))
    missing = [_called(quantity) for quantity in nearest if quantity not in present]
    expected = " or ".join(", ".join(map(_called, layout)) for layout in layouts)
    example = missing[0] if missing else "force_N"
    quantity = example.rpartition("_")[0]
    others = [f"{quantity}_{key}" for key in UNITS.get(quantity, ())]
    named = " or ".join(name for name in others if name != example)
    units = f" ({named} for another unit)" if named else ""
    return fail(
        f"the columns {', '.join(missing) or 'of one group'} are missing: it has {_listed(header)}",
        remedy=f"expected {expected}; name foreign columns with --map {example}=NAME{units}",
    )


def _called(quantity: str) -> str:
    """Return what a user calls a column: two are named by options."""
    options = {"input": "the column of --command", "output": "the column of --measured"}
    return options.get(quantity) or standard_name(quantity)


def _listed(header: Sequence[str]) -> str:
    names = [name if len(name) <= 30 else name[:27] + "..." for name in header[:12]]
    return ", ".join(names) + (f" and {len(header) - 12} more" if len(header) > 12 else "")
