"""Ranges cut in parts: an unknown but constant value lies in one of them for ever."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from nrs_design.errors import AssemblyError

# Low and high ends of ranges, by their names.
Ends = Mapping[str, tuple[Fraction, Fraction]]
MAX_PARTS = 64


@dataclass(frozen=True, slots=True)
class RangeCut:
    """One part of some ranges becomes two, which share the value at which it is cut."""

    part: int  # Its number from zero; what is above the value becomes the last part
    name: str  # Of the range that is cut
    at: Fraction = field(metadata={"signed": True})


def cut_ranges(whole: Ends, cuts: Sequence[RangeCut]) -> list[Ends]:
    """Return the parts of some ranges, which together are all of them.

    An `AssemblyError` if there are too many, or a cut is not inside a part.
    """
    if len(cuts) >= MAX_PARTS:
        raise AssemblyError(f"ranges are cut in {len(cuts) + 1} parts, at most {MAX_PARTS} are")
    parts = [whole]
    for cut in cuts:
        part = parts[cut.part] if 0 <= cut.part < len(parts) else {}
        low, high = part.get(cut.name, (cut.at, cut.at))
        if not low < cut.at < high:
            raise AssemblyError(f"no part of a constant range is cut at {cut.name} = {cut.at}")
        parts[cut.part] = {**part, cut.name: (low, cut.at)}
        parts.append({**part, cut.name: (cut.at, high)})
    return parts
