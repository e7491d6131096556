"""What `optimize --retune` does and says."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from nrs_design.axis import unit
from nrs_design.cli.certified_gains import name_for, write_certified
from nrs_design.cli.granted import print_granted
from nrs_design.cli.printing import note, progress, say
from nrs_design.proof.bounds import lower, lower_float, upper, upper_float

if TYPE_CHECKING:
    from nrs_design.pipeline import Designed
    from nrs_design.pipeline.retuned_gains import RetunedGains


@dataclass(frozen=True, slots=True)
class RetunedBox:
    """The box of dampings, and where its spec and certificate were written."""

    found: RetunedGains
    # spec, certificate: files that were written; None if none.
    spec: Path | None
    certificate: Path | None

    @classmethod
    def of(cls, designed: Designed, out: Path | None) -> Self:
        """Find the box around the gains that ship, and write it where there is one.

        Parameters
        ----------
        designed : Designed
            The spec with its gains.
        out : Path or None
            The spec with the ranges.

        Raises
        ------
        DesignError
            If there is nothing to retune.
        OutputError
            If a file cannot be written.
        """
        from nrs_design.pipeline.retuned_gains import run_retuned_gains

        name = None if out is None else name_for(designed.loaded, out)
        with progress(f"retuned gains of {designed.spec.name}") as step:
            found = run_retuned_gains(designed, step, name)
        if out is None:
            return cls(found, None, None)
        if found.result is None:
            note("nothing is written: no box is proved")
            return cls(found, None, None)
        return cls(found, out, write_certified(found.result, out))

    def facts(self) -> dict[str, Any]:
        """Return the same for JSON, in SI units; ends are rounded inwards."""
        found = self.found
        return {
            "share": lower_float(found.share),
            "not_proved_at": None if found.beyond is None else found.beyond / 100,
            "Bt": {
                name: [upper_float(low), lower_float(high)]
                for name, (low, high) in found.ranges.items()
            },
            "unit": unit("N*m*s/rad"),
            "spec": None if self.spec is None else str(self.spec),
            "certificate": None if self.certificate is None else str(self.certificate),
        }

    def show(self) -> None:
        """Print the box."""
        found = self.found
        if found.result is None:
            goals = ", with the goals of the proof" if found.goals else ""
            say(
                f"Bt may not be retuned: within ±{found.beyond} % of all controllers{goals}, "
                "not proved"
            )
            return
        ends = ", ".join(
            f"{name} {upper(low)} to {lower(high)}" for name, (low, high) in found.ranges.items()
        )
        percent = int(found.share * 100)
        say(f"PROVED: Bt may be retuned while running, within ±{percent} %: {ends}")
        if found.beyond is not None:
            say(f"of all controllers at once; ±{found.beyond} % was tried and is not proved")
        print_granted(found.result)
