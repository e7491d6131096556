"""Preparation of a record for a fit: used samples, and zeros of deflection and force."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.errors import DataError
from nrs_design.identification.numeric import Array, Flags, runs
from nrs_design.identification.statistics import span
from nrs_design.identification.tissue.contact import (
    DetectedContact,
    find_contact,
    find_cycles,
    inner,
    surface,
)
from nrs_design.identification.tissue.settings import Preparation
from nrs_design.models.contact.motion import Motion
from nrs_design.proof.text import counted

FEWEST = 50
# Least number of used samples of a thinned record.
_LEAST_USED = 4 * FEWEST
# So near to the position of contact, as a part of the travel, a sample may be in air or not.
_EDGE = 0.02
# Farther away, the lost samples would matter more than a few in air.
_FARTHEST = 0.25
# Air shows a drift: least samples, least part of the record, and least samples of contact between.
_FEWEST_IN_AIR, _AIR_SPAN, _LEAST_CONTACT = 30, 0.3, 20
# A record that begins at this part of its deflection need not begin relaxed.
_LOADED = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """A record as it is fitted."""

    record: TissueRecord  # The original record
    preparation: Preparation  # The settings
    motion: Motion  # Deflection of the tissue, positive into it and 0 in air; n samples
    position: Array  # Shape (n,). The same, but negative in air.
    force: Array  # Shape (n,). On the tissue in N (N m), with any tare.
    fit_mask: Flags  # Shape (n,). Samples that are fitted.
    touching: Flags  # Shape (n,). Samples in contact.
    reference: float  # Position that the deflection is counted from, m (rad)
    side: int  # 1 if the tissue is where positions are larger, else -1
    contact: DetectedContact | None  # None if no air shows, or was not looked for
    drift: bool  # Whether the tare is fitted as moving
    cuts: tuple[str, ...]  # Unused samples with reasons, as sentences
    cycles: tuple[slice, ...]  # Loading cycles, among all samples

    @property
    def unrested(self) -> tuple[slice, ...]:
        """Stretches in contact that may not begin at rest: touches, a loaded or a cut start.

        A touch begins where the position of contact is, which is known with an error; what was
        before ``start``, or before a pause, no sample tells.
        """
        loaded = float(self.motion.deflection[0]) > _LOADED * float(self.motion.deflection.max())
        is_cut = self.preparation.start or self.record.pauses
        if self.contact is None and not loaded and not is_cut:
            return ()
        return tuple(slice(a, b) for a, b in runs(self.touching) if self.fit_mask[a:b].any())

    @property
    def measured(self) -> Array:
        """Force of the samples that are used."""
        return self.force[self.fit_mask]

    @property
    def deflection(self) -> Array:
        """Deflection of the samples that are used."""
        return self.motion.deflection[self.fit_mask]

    @property
    def duration(self) -> float:
        """From first to last sample, in s."""
        return float(self.motion.time[-1] - self.motion.time[0])

    @property
    def step(self) -> float:
        """Usual time between samples in s."""
        return float(np.median(self.motion.steps))

    @property
    def span(self) -> float:
        """Range of the force that is used, in N (N m)."""
        return float(np.ptp(self.measured))

    @property
    def remarks(self) -> tuple[str, ...]:
        """Contact, drift and unused parts, in words."""
        texts = []
        if self.contact is not None:
            part = 100 * float(np.mean(~self.touching))
            texts.append(
                f"{counted(len(self.contact.touches), 'touch')}; {part:.0f} % of it is air"
            )
        elif self.preparation.contact == "auto":
            texts.append(
                "no air shows: all of it is taken as in contact, and a tare that moves with time "
                "would pass for relaxation"
            )
        if self.drift:
            texts.append("the tare is fitted as moving in proportion to time")
        return (*texts, *self.cuts)

    def thinned(self, count: int) -> Trial:
        """Return the trial with at most `most` samples, or more if few of them are used."""
        stride = min(-(-len(self.force) // count), max(1, int(self.fit_mask.sum()) // _LEAST_USED))
        if stride == 1:
            return self
        pick = slice(None, None, stride)
        motion = Motion(self.motion.time[pick], self.motion.deflection[pick])
        names = ("position", "force", "fit_mask", "touching")
        return replace(self, motion=motion, **{name: getattr(self, name)[pick] for name in names})


def prepare(record: TissueRecord, preparation: Preparation | None = None) -> Trial:
    """Cut a record to what can be fitted; too little left is a `DataError`.

    Air and drift are looked for by default, and the zeros of force and deflection are fitted.
    """
    settings = preparation or Preparation()
    window, cuts = _window(record, settings)
    contact = find_contact(window) if settings.contact == "auto" else None
    x, time = window.motion.deflection, window.motion.time
    side = _side(x) if contact is None else contact.side
    reference = side * float(np.min(side * x)) if contact is None else contact.zero
    deflection = position = side * (x - reference)
    fit_mask = touching = np.ones(len(x), bool)
    if contact is not None:
        width = _EDGE * float(np.ptp(x))
        deflection, touching = surface(time, position, contact.touches, width)
        edge = _edge(position, width, contact)
        edge |= touching & ~inner(touching)
        free = contact.tissue_side & ~touching & ~edge
        cuts += _unused_text(time, edge, "at the edge of contact")
        cuts += _unused_text(
            time, free, "no contact yet: the tissue has not come back from a touch"
        )
        fit_mask = ~edge & ~free
    if fit_mask.sum() < FEWEST or np.ptp(x[fit_mask]) == 0:
        raise DataError(
            f"{fit_mask.sum()} samples in {len(x)} are left to fit, at least {FEWEST} are needed",
            path=record.source.path,
            remedy="record longer, or say by --set contact=given, start=S or end=S what to use",
        )
    drift = _shows_drift(time, fit_mask & ~touching)
    return Trial(
        record, settings, Motion(time, deflection), position, side * window.force, fit_mask,
        touching, reference, side, contact, drift, tuple(cuts), find_cycles(deflection),
    )  # fmt: skip


def _shows_drift(time: Array, air: Flags) -> bool:
    """Tell whether there is air before and after a contact, far enough apart.

    Where there is, the drift is fitted, however small: one that is left out because no test sees it
    would still move the tare, by more than the interval of a tare that is taken to rest (Leeb and
    Poetscher 2005, on inference after a choice of the model). Within one stretch of air, a tissue
    that is soft at first would pass for a drift.
    """
    rows = np.flatnonzero(air)
    if len(rows) < _FEWEST_IN_AIR or np.ptp(time[rows]) < _AIR_SPAN * np.ptp(time):
        return False
    return bool(np.diff(rows).max() >= _LEAST_CONTACT)


def _edge(position: Array, width: float, contact: DetectedContact) -> Flags:
    """Find samples that may be in air or not.

    They are where the position of contact may lie by the noise, and a width beyond: its curve is
    none of the laws.
    """
    far = _FARTHEST * float(np.ptp(position))
    low, high = max(contact.ends[0], -far) - width, min(contact.ends[1], far) + width
    return np.asarray((position > low) & (position < high))


def _window(record: TissueRecord, settings: Preparation) -> tuple[TissueRecord, list[str]]:
    time = record.motion.time
    start = -np.inf if settings.start is None else settings.start
    end = np.inf if settings.end is None else settings.end
    mask = (time >= start) & (time <= end)
    if mask.sum() < FEWEST:
        raise DataError(
            f"{mask.sum()} samples lie between start and end, at least {FEWEST} are needed",
            path=record.source.path,
            remedy=f"the record lasts from 0 s to {time[-1]:.6g} s",
        )
    motion = Motion(time[mask], record.motion.deflection[mask])
    force = (-record.force if settings.negate else record.force)[mask]
    window = replace(record, motion=motion, force=force)
    return window, _unused_text(time, ~mask, "outside start and end")


def _side(x: Array) -> int:
    """Take the tissue where positions are larger, unless all of them are negative."""
    return -1 if x.max() < 0.05 * np.ptp(x) and x.min() < -0.5 * np.ptp(x) else 1


def _unused_text(time: Array, flags: Flags, reason: str) -> list[str]:
    """Return a text about unused samples, if there are some."""
    unused_times = time[flags]
    if not len(unused_times):
        return []
    times = span(unused_times[0], unused_times[-1], "s")
    return [f"{counted(len(unused_times), 'sample')} at {times}: {reason}"]
