"""Gains with their proof, as the library gives them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.api.optimum import Optimum
from nrs_design.api.result import AbstractResult, Figures
from nrs_design.certificates.ownership import check_certificate
from nrs_design.errors import DesignError
from nrs_design.exporters import known_format
from nrs_design.exporters.write import check_places, places, write_export
from nrs_design.pipeline.design import placed

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.exporters.export import Export
    from nrs_design.exporters.record import ExportRecord
    from nrs_design.spec import LoadedSpec


@dataclass(frozen=True, repr=False)
class Exported(AbstractResult):
    """Exported gains with their proof, or the reason for none."""

    loaded: LoadedSpec
    export: Export  # What may be exported

    @property
    def name(self) -> str:
        """Name of the spec."""
        return self.loaded.spec.name

    @property
    def verdict(self) -> str:
        """``proved``, ``refuted``, ``inconclusive``; ``rejected`` of a certificate that fails."""
        return self.export.verdict

    @property
    def reason(self) -> str:
        """Why nothing may be exported; empty if something may."""
        return self.export.reason

    @property
    def record(self) -> ExportRecord | None:
        """Exported gains, exactly and as float32, with their proof."""
        return self.export.record

    @property
    def certificate(self) -> Certificate | None:
        """The proof of the record, or what refutes it."""
        return self.export.certificate

    def save(self, folder: str | Path, format: str = "json") -> tuple[Path, ...]:
        """Write the certificate and the files of a format.

        The format is as `nrs-design export --list` names it. Files of the format are returned;
        ``NAME.cert.json`` is beside them. A DesignError if nothing may be exported, or a processor
        is to run what is proved in continuous time only.
        """
        file_format, place, record = known_format(format), Path(folder), self.export.shipped()
        if file_format.executable and record.sample_time is None:
            raise DesignError(
                "the proof is in continuous time, and a processor runs this format",
                remedy="add `sampling: {period: 2 ms, delay: 1}` to the spec",
            )
        files = places(file_format, self.name, place)
        proof = next(iter(files.values())).parent / f"{self.name}.cert.json"
        check_places(file_format, files, self.name)
        check_certificate(self.loaded.path, proof)
        with placed(self.loaded):
            write_export(self.export, format, files, proof, self.loaded.path)
        return tuple(files.values())

    def _axis(self) -> object:
        return None if self.export.spec is None else self.export.spec.axis

    def _facts(self) -> dict[str, Any]:
        return {
            "spec": self.name,
            "verdict": self.verdict,
            "reason": self.reason or None,
            "file": None,
            "files": [],
            "certificate": None,
            "record": self.record.model_dump(mode="json", by_alias=True) if self.record else None,
        }

    def _drawings(self) -> Figures:
        designed = self.export.designed
        return [] if designed is None else Optimum(designed).drawings()

    def _headline(self) -> str:
        return f"{self.name}: {self.verdict if self else f'not exported, {self.verdict}'}"

    def _rows(self) -> Iterator[Sequence[str]]:
        designed = self.export.designed
        if designed is None:
            yield "", ""
            yield "why", self.reason
            return
        yield "controller", "gain", "value", "unit"
        yield from Optimum(designed).gain_rows()

    def __bool__(self) -> bool:
        """Return True if the exported design is proved."""
        return self.verdict == "proved"
