"""Merge what was identified into a spec, keeping its comments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal
from math import isfinite
from pathlib import Path
from typing import Any

from nrs_design.errors import SpecError
from nrs_design.identification.actuator.identify import ActuatorIdentification
from nrs_design.identification.delay.identify import DelayIdentification
from nrs_design.identification.errors import DataError
from nrs_design.identification.spec_document import Merged, SpecDocument
from nrs_design.identification.statistics import Estimate, few_digits, span
from nrs_design.identification.tables.table import Source
from nrs_design.identification.tissue.identify import TissueIdentification
from nrs_design.identification.tissue.tangent import Tangent
from nrs_design.models.axis import AxisType
from nrs_design.models.contact import (
    LAWS,
    LINEAR_LAWS,
    TISSUE_LAWS,
    AbstractLinearLaw,
    HuntCrossley,
)
from nrs_design.proof.text import counted
from nrs_design.spec import InteractionDesignSpec, LoadedSpec, parse_spec
from nrs_design.spec.features import MOTOR_RANGE
from nrs_design.spec.fields import MAX_TITLE
from nrs_design.spec.preload import FINEST, LARGEST, LEAST
from nrs_design.spec.provenance import MAX_DOUBTS
from nrs_design.spec.quantity_fields import RangedQuantity
from nrs_design.spec.sampling import LONGEST_DELAY

_DIGITS = 6
# Least number of records for the variation of specimens. A range that is narrower than the declared
# range by the second factor probably misses specimens.
FEW_RECORDS, MUCH_NARROWER = 3, 10
NARROWER = "narrower than the declared one"
# Ends are rounded outwards.
ROUNDING_SLACK = 1.01
_MODEL_OPTIONS = f"--model {' or --model '.join(TISSUE_LAWS)}"
# Keys that only a power law has in a spec.
_POWER_KEYS = ("exponent", "about", "preload")


def merge_tissue(
    loaded: LoadedSpec, result: TissueIdentification, environment: str | None, arm: str | None
) -> Merged:
    """Return a spec with the chosen law in one of its environments.

    Its range is written, which covers the pooled interval and that of every record. Linear records
    need a lever arm such as ``0.24 m``, by default the one of the spec. A range that gets narrower
    by few records, or by much, is a doubt.
    """
    model, tangent, rotational = result.model, result.tangent, result.rotational
    law, ranges = (model.law, model.ranges) if tangent is None else (tangent.law, tangent.ranges)
    name = _place(loaded, environment)
    target = check_interaction(loaded).environments[name]
    if not isinstance(law, AbstractLinearLaw):
        raise DataError(
            f"the law {law.name} has no place in a spec without a preload",
            remedy="say by --preload at which deflections, or choose one that has a place: "
            f"{_MODEL_OPTIONS}",
        )
    if not rotational and arm is None and target.lever_arm is None:
        raise SpecError(
            f"the environment {name} has no lever_arm, and the records are linear",
            path=loaded.path,
            remedy="give --lever-arm '0.24 m'",
        )
    if model.doubts and not all(map(_is_limited, ranges)):
        raise DataError(
            f"a range is unlimited, the records do not determine it: {model.doubts[0]}",
            remedy="choose a simpler law with --model, or record again as the message says",
        )
    document = SpecDocument(loaded)
    writer = _Writer(document, document.root["environments"][name], result.sources)
    narrow = writer.narrowed(target.ranges, dict(zip(law.keys, ranges, strict=True)))
    power = tangent is not None and has_place(tangent)
    if tangent is not None and power:
        ranges = tangent.power[:2]
    units = law.units(rotational=rotational)
    rows = zip(law.keys, ranges, units, strict=True)
    values: dict[str, object] = {key: _positive_range(e, unit, key) for key, e, unit in rows}
    if tangent is not None:
        length = "rad" if rotational else "m"
        ends = f"deflections of {span(tangent.low, tangent.high, length, 6)}"
        values |= _power_values(tangent, length) if power else {"linearized_about": ends}
    if rotational or arm is not None:
        values["lever_arm"] = arm
    values["range_covers"] = model.coverage
    writer.set_key("model", HuntCrossley.name if power else law.name)
    for key, value in values.items():
        writer.set_key(key, value)
    known = (key for other in LINEAR_LAWS.values() for key in other.keys)
    for key in {*known, *_POWER_KEYS, "linearized_about"} - values.keys():
        writer.set_key(key, None)
    doubts = writer.put_origin((*result.caveats, *narrow))
    writer.set_key("range_id", writer.identified().environments[name].values_id())
    return writer.merged(doubts)


def _power_values(tangent: Tangent, length: str) -> dict[str, object]:
    """Return the keys of a Hunt-Crossley law in addition to its tangent."""
    low, high = _exponent_range(tangent.power[2])
    nominal = min(max(round(Decimal(tangent.power[2].value), 3), low), high)
    return {
        "exponent": {"nominal": str(nominal), "range": [str(low), str(high)]},
        "about": f"{tangent.operating_point!r} {length}",
        "preload": [f"{end!r} {length}" for end in (tangent.low, tangent.high)],
    }


def merge_actuator(loaded: LoadedSpec, result: ActuatorIdentification) -> Merged:
    """Return a spec with the identified actuator and its intervals.

    Where the proof can cover ranges of the actuator, these are written; else the intervals stand
    beside the nominal values, for the record.
    """
    spec = check_actuator(loaded, result.unit)
    assert spec.actuator is not None, "as has been checked"
    document = SpecDocument(loaded)
    writer = _Writer(document, document.root["actuator"], result.sources)
    if result.unit != spec.actuator.command:
        writer.set_key("command", result.unit)
    covered = spec.combines(MOTOR_RANGE)
    ranges = result.fit.ranges if covered else (result.fit.gain, result.fit.time_constant)
    ranges_by_name = dict(zip(("gain", "time_constant"), ranges, strict=True))
    units = f"rad/s/{result.unit}", "s"
    narrow: Sequence[str] = ()
    if covered:
        declared_ranges = {name: getattr(spec.actuator, name) for name in ranges_by_name}
        narrow = writer.narrowed(declared_ranges, ranges_by_name)
    texts = {
        name: _positive_range(e, unit, name)
        for (name, e), unit in zip(ranges_by_name.items(), units, strict=True)
    }
    for name, value in texts.items():
        writer.set_key(name, value if covered else value["nominal"])
    intervals = {name: value["range"] for name, value in texts.items()}
    writer.set_key("intervals", None if covered else intervals)
    writer.set_key("range_covers", "confidence" if covered else None)
    dead_time = result.clear_dead_time if spec.takes_dead_time else None
    writer.set_key("dead_time", dead_time and _outwards(dead_time, "s")["range"])
    doubts = writer.put_origin((*(result.doubts if dead_time else result.caveats), *narrow))
    rewritten = writer.identified().actuator
    assert rewritten is not None
    writer.set_key("range_id", rewritten.values_id() if covered else None)
    return writer.merged(doubts)


def merge_sampling(loaded: LoadedSpec, result: DelayIdentification) -> Merged:
    """Return a spec of a sampled loop with the age of its force sample.

    A record that shows dynamics and no mere delay is a `DataError`.
    """
    spec = check_interaction(loaded)
    if spec.sampling is None:
        raise SpecError(
            "the spec has no sampling, and a delay counts in its periods",
            path=loaded.path,
            remedy="add `sampling: {period: 2 ms, delay: 0}`, with the period of your processor",
        )
    command, output = result.record.names
    if result.is_lag:
        raise DataError(
            f"{output} follows {command} by {result.fit.follower.name}: that is more than the "
            "age of a sample",
            remedy="name the force as measured by --command and the force that the law used by "
            "--measured; dynamics between them belong into the model",
        )
    low, high = result.periods(spec.sampling.outer)
    if high > LONGEST_DELAY:
        raise DataError(
            f"the force is up to {high} periods old, a spec takes {LONGEST_DELAY} at most",
            remedy="record longer or livelier forces, or sample with a longer period",
        )
    document = SpecDocument(loaded)
    writer = _Writer(document, document.root["sampling"], result.sources)
    writer.set_key("delay", low if low == high else [low, high])
    return writer.merged(writer.put_origin(result.caveats))


@dataclass(frozen=True, slots=True)
class _Writer:
    """Puts what was found into a part of a spec."""

    document: SpecDocument  # The spec
    node: Any  # The part
    sources: Sequence[Source]  # The records

    def set_key(self, key: str, value: object) -> None:
        """Set a key, or remove it for None; comments within a range stay."""
        old = self.node.get(key)
        if value is None:
            self.document.drop(self.node, key)
        elif isinstance(old, dict) and isinstance(value, dict):
            if isinstance(old.get("range"), list):
                old["range"][:] = value["range"]
            else:
                self.document.set_key(old, "range", value["range"])
            old["nominal"] = value["nominal"]
        else:
            self.document.set_key(self.node, key, value)

    def put_origin(self, caveats: Sequence[str]) -> Sequence[str]:
        """Note files and doubts, and return the doubts; a reason for others does not hold."""
        provenance = [
            {
                "file": source.path.name,
                "sha256": source.sha256,
                "data": "synthetic" if source.synthetic else "measured",
            }
            for source in self.sources
        ]
        before = list(self.node.get("doubts", ()))
        texts = [_one_line(caveat) for caveat in caveats]
        if [dict(item) for item in self.node.get("provenance", ())] == provenance:
            # The range that was declared before the same records is not there any more.
            old_doubts = [old for old in before if old.endswith(NARROWER)]
            texts, caveats = [*texts, *old_doubts], [*caveats, *old_doubts]
        if len(texts) > MAX_DOUBTS:
            count = len(texts) - MAX_DOUBTS + 1
            texts = [*texts[: MAX_DOUBTS - 1], f"and {count} more"]
        self.set_key("provenance", provenance)
        if texts != before:
            self.set_key("accept_doubt", None)
        self.set_key("doubts", texts or None)
        return caveats

    def merged(self, doubts: Sequence[str]) -> Merged:
        """Return the new spec, which the gate refuses for doubts that are not accepted."""
        return Merged(self.document.text(), tuple(doubts), "accept_doubt" in self.node)

    def narrowed(
        self, declared_ranges: Mapping[str, RangedQuantity], result: Mapping[str, Estimate]
    ) -> list[str]:
        """Return doubts about relative ranges that get narrower by few records or by much."""
        records = len({source.sha256 for source in self.sources})
        texts = []
        for key in sorted(result.keys() & declared_ranges.keys()):
            low, high = (end.si for end in declared_ranges[key].range)
            before = (high - low) / declared_ranges[key].nominal.si
            after = (result[key].high - result[key].low) / result[key].value
            if ROUNDING_SLACK * after < before and (
                records < FEW_RECORDS or MUCH_NARROWER * after <= before
            ):
                times = f"{before / after:.3g} times {NARROWER}"
                texts.append(f"{key}: the range from {counted(records, 'record')} is {times}")
        return texts

    def identified(self) -> InteractionDesignSpec:
        """Return the new spec, in which the part has no identity of its range yet."""
        self.set_key("range_id", None)
        new_spec = parse_spec(self.document.text())
        assert isinstance(new_spec, InteractionDesignSpec)
        return new_spec


def law_to_write(loaded: LoadedSpec, environment: str | None, requested: str | None) -> str:
    """Return the law to write into an environment: the declared one, unless the user names another.

    What cannot be fitted is refused.
    """
    name = _place(loaded, environment)
    law = requested or check_interaction(loaded).environments[name].model
    if law not in LAWS:
        raise SpecError(
            f"the environment {name} is a {law}, which no record of a press tells",
            path=loaded.path,
            remedy=f"name the law that shall replace it: {_MODEL_OPTIONS}",
        )
    return law


def check_actuator(loaded: LoadedSpec, unit: str) -> InteractionDesignSpec:
    """Refuse a spec that a motor with commands in this unit cannot go into."""
    spec = check_interaction(loaded)
    if spec.actuator is None or spec.motion_loop is None:
        raise SpecError(
            "the spec has no actuator: its robot closes its own motion loop",
            path=loaded.path,
            remedy="leave --write out, and copy the time constant into velocity_interface",
        )
    quantities = {
        "derivative_gain": spec.motion_loop.derivative_gain,
        "the largest command": spec.limits.command,
        "friction": None if spec.disturbances is None else spec.disturbances.friction,
    }
    for name, quantity in quantities.items():
        if quantity is not None and spec.actuator.command != unit:
            raise SpecError(
                f"the records are about commands in {unit}, and {name} is {quantity.text}",
                path=loaded.path,
                remedy=f"remove {name} before, and give it in {unit} afterwards; without "
                "derivative_gain the root locus chooses it",
            )
    return spec


def check_interaction(loaded: LoadedSpec) -> InteractionDesignSpec:
    """Refuse a spec that is no interaction design."""
    if not isinstance(loaded.spec, InteractionDesignSpec):
        raise SpecError(
            f"a spec of kind {loaded.spec.kind} has no place for identified values",
            path=loaded.path,
            remedy="write into a spec of kind interaction-design",
        )
    check_turning(loaded.spec, loaded.path)
    return loaded.spec


def check_turning(spec: object, path: Path) -> None:
    """Refuse a spec of an axis that slides: records are read as those of one that turns."""
    if isinstance(spec, InteractionDesignSpec) and spec.axis is AxisType.PRISMATIC:
        raise SpecError(
            "the axis is prismatic, and records are read as those of an axis that turns",
            path=path,
            remedy="identify without --write, and copy what is found in the units of the axis",
        )


def _place(loaded: LoadedSpec, environment: str | None) -> str:
    """Return the name of the environment to write to."""
    environments = check_interaction(loaded).environments
    names = list(environments)
    name = names[0] if environment is None and len(names) == 1 else environment
    if name not in names:
        fault = "there are several environments" if names else "there is no environment to write to"
        names_text = ", ".join(names) or "no environments"
        raise SpecError(
            f"no environment {name!r}" if name else fault,
            path=loaded.path,
            remedy=f"name one with --environment; the spec has {names_text}",
        )
    return name


def has_place(tangent: Tangent) -> bool:
    """Tell whether a spec can hold the power law: its exponent is at least 1."""
    low, high = _exponent_range(tangent.power[2])
    return low >= LEAST and high <= LARGEST


def _exponent_range(estimate: Estimate) -> tuple[Decimal, Decimal]:
    """Round the ends of the interval of an exponent outwards, as finely as a spec holds them."""
    step = Decimal(1) / FINEST
    if not _is_limited(estimate):
        return Decimal(0), Decimal("Infinity")
    return (
        Decimal(estimate.low).quantize(step, ROUND_FLOOR),
        Decimal(estimate.high).quantize(step, ROUND_CEILING),
    )


def _one_line(text: str) -> str:
    printable = "".join(letter if letter.isprintable() else " " for letter in text)
    return printable if len(printable) <= MAX_TITLE else f"{printable[: MAX_TITLE - 4]} ..."


def _outwards(estimate: Estimate, unit: str) -> dict[str, Any]:
    """Write an estimate of either sign, its ends rounded outwards."""
    low = few_digits(estimate.low, _DIGITS, ROUND_FLOOR)
    high = few_digits(estimate.high, _DIGITS, ROUND_CEILING)
    nominal = min(max(few_digits(estimate.value, _DIGITS, ROUND_HALF_EVEN), low), high)
    texts = [f"{_number_text(number)} {unit}" for number in (nominal, low, high)]
    return {"nominal": texts[0], "range": texts[1:]}


def _positive_range(estimate: Estimate, unit: str, name: str) -> dict[str, Any]:
    """Write a positive estimate; refuse one that the records do not tell."""
    if not _is_limited(estimate):
        raise DataError(
            f"the interval of the {name} is unlimited or reaches 0: the records do not tell it",
            remedy="choose a simpler law with --model, or record more",
        )
    return _outwards(estimate, unit)


def _is_limited(estimate: Estimate) -> bool:
    return isfinite(estimate.high) and estimate.low > 0


def _number_text(number: Decimal) -> str:
    usual = not number or 1e-3 <= number < 10**_DIGITS
    return f"{number:f}" if usual else f"{number.normalize():e}"
