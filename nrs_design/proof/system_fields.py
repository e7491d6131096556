"""The switched system in a certificate file: its exact modes and its rules of switching."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from nrs_design.proof.channels import Channel, Coupling, Output, Rounding
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.evidence.fields import (
    MAX_INTEGER_BITS,
    read_integer,
    read_ratio,
    read_text,
)
from nrs_design.proof.exact import bit_length
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import ARBITRARY, Clock, FixedParameter, Reset, Stay, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import quoted

if TYPE_CHECKING:
    from nrs_design.proof.saturation import Saturation

# The word for switching without rules.
WITHOUT_RULES = "arbitrary"
# Deciding a form for every mode takes about rows^3 steps each on their numbers: a minute at this.
MAX_FAMILY_WORK = 10**10
# There is a function for every step of a round.
MAX_ROUND = 100

Fields = dict[str, Any]


def system_fields(system: SwitchedSystem) -> Fields:
    """Return what a certificate says about its system, apart from the name.

    Raises
    ------
    ValueError
        If a number of a mode or a reset has more digits than a file holds.
    """
    return {
        "time": str(system.time),
        "states": list(system.states),
        "modes": _mode_fields(system.modes),
        "switching": _switching_fields(system.switching),
        **({} if system.contact is None else {"contact": _contact_fields(system.contact)}),
        **({} if system.flights is None else {"flights": _flight_fields(system.flights)}),
        **_channel_fields(system),
        **({} if system.sample_time is None else {"sample_time": str(system.sample_time)}),
        **({} if system.clock is None else {"clock": _clock_fields(system.clock)}),
        **({} if system.axes is None else {"axes": system.axes}),
        **_saturation_fields(system),
        "assumptions": list(system.assumptions),
    }


def read_system(name: str, fields: Mapping[str, Any]) -> SwitchedSystem:
    """Read the system that `system_fields` has written.

    Parameters
    ----------
    name : str
        Of the spec that it comes from.
    fields : mapping
        Of a certificate; other keys are not looked at.

    Raises
    ------
    KeyError, TypeError, ValueError
        If a field is missing or malformed, a matrix has no shape or no positive denominator, two
        modes have one name, or the modes are too large to check.
    """
    modes = _read_modes(fields["modes"])
    states = _read_texts(fields["states"])
    _check_modes(modes, len(states))
    contact = _read_contact(fields["contact"]) if "contact" in fields else None
    if contact is not None:
        _check_work(contact.free * (1 + len(contact.pulls)))
    return SwitchedSystem(
        name=name,
        time=Time(read_text(fields["time"])),
        states=states,
        modes=modes,
        assumptions=_read_texts(fields["assumptions"]),
        switching=_read_switching(fields["switching"]),
        contact=contact,
        channels=tuple(
            Channel(
                read_text(item["name"]),
                read_text(item["unit"]),
                read_ratio(item["bound"]),
                tuple(_read_matrix(column) for column in _read_list(item["columns"])),
            )
            for item in _read_list(fields.get("channels", []))
        ),
        outputs=tuple(
            Output(
                read_text(item["name"]),
                read_text(item["unit"]),
                tuple(_read_matrix(row) for row in _read_list(item["rows"])),
                None if item["limit"] is None else read_ratio(item["limit"]),
            )
            for item in _read_list(fields.get("outputs", []))
        ),
        sample_time=read_ratio(fields["sample_time"]) if "sample_time" in fields else None,
        roundings=tuple(Rounding(*part) for part in _read_parts(fields, "roundings")),
        couplings=tuple(Coupling(*part) for part in _read_parts(fields, "couplings")),
        clock=_read_clock(fields["clock"]) if "clock" in fields else None,
        axes=read_integer(fields["axes"]) if "axes" in fields else None,
        saturation=_read_saturation(fields["saturation"]) if "saturation" in fields else None,
        flights=_read_flights(fields["flights"]) if "flights" in fields else None,
    )


def _check_modes(modes: Sequence[Mode], states: int) -> None:
    sizes = [len(mode.A.numerators) for mode in modes]
    if len({mode.name for mode in modes}) < len(modes):
        raise ValueError("two modes have the same name")
    if any(mode.A.shape[0] != mode.A.shape[1] for mode in modes):
        raise ValueError("a mode is not square")
    if not sizes or max(sizes) != states:
        raise ValueError("the largest mode does not have the states that are named")
    _check_work(modes)


def _check_work(modes: Iterable[Mode]) -> None:
    matrices = (mode.A.numerators for mode in modes)
    if sum(len(N) ** 3 * bit_length(N) for N in matrices) > MAX_FAMILY_WORK:
        raise ValueError("the modes are too large to check")


def _mode_fields(modes: Sequence[Mode]) -> list[Fields]:
    return [{"name": mode.name, **_matrix_fields(mode.A)} for mode in modes]


def _read_modes(value: object) -> tuple[Mode, ...]:
    return tuple(Mode(read_text(item["name"]), _read_matrix(item)) for item in _read_list(value))


def _channel_fields(system: SwitchedSystem) -> Fields:
    """Return disturbances, outputs, roundings and couplings, if there are any."""
    channels = [
        {
            "name": channel.name,
            "unit": channel.unit,
            "bound": str(channel.bound),
            "columns": [_matrix_fields(column) for column in channel.columns],
        }
        for channel in system.channels
    ]
    outputs = [
        {
            "name": item.name,
            "unit": item.unit,
            "rows": [_matrix_fields(row) for row in item.rows],
            "limit": _text(item.limit),
        }
        for item in system.outputs
    ]
    every = {
        "channels": channels,
        "outputs": outputs,
        "roundings": _part_fields(system.roundings),
        "couplings": _part_fields(system.couplings),
    }
    return {key: value for key, value in every.items() if value}


def _part_fields(parts: Sequence[Rounding | Coupling]) -> list[Fields]:
    return [
        {
            "name": item.name,
            "columns": [_matrix_fields(column) for column in item.columns],
            "rows": [_matrix_fields(row) for row in item.rows],
        }
        for item in parts
    ]


def _read_parts(
    fields: Mapping[str, Any], key: str
) -> Iterable[tuple[str, tuple[RationalMatrix, ...], tuple[RationalMatrix, ...]]]:
    for item in _read_list(fields.get(key, [])):
        columns = tuple(_read_matrix(column) for column in _read_list(item["columns"]))
        yield read_text(item["name"]), columns, tuple(map(_read_matrix, _read_list(item["rows"])))


def _saturation_fields(system: SwitchedSystem) -> Fields:
    if system.saturation is None:
        return {}
    signals = [
        {
            "name": signal.name,
            "unit": signal.unit,
            "limit": str(signal.limit),
            "columns": [_matrix_fields(column) for column in signal.columns],
            "rows": [_matrix_fields(row) for row in signal.rows],
        }
        for signal in system.saturation.signals
    ]
    start = system.saturation.start
    begun = {
        "name": start.name,
        "unit": start.unit,
        "states": [_matrix_fields(state) for state in start.states],
        "wanted": _text(start.wanted),
    }
    return {"saturation": {"signals": signals, "start": begun}}


def _read_saturation(fields: Mapping[str, Any]) -> Saturation:
    from nrs_design.proof.saturation import CutOff, Saturation, Start

    signals = (
        CutOff(
            read_text(item["name"]),
            read_text(item["unit"]),
            read_ratio(item["limit"]),
            tuple(_read_matrix(column) for column in _read_list(item["columns"])),
            tuple(_read_matrix(row) for row in _read_list(item["rows"])),
        )
        for item in _read_list(fields["signals"])
    )
    begun = fields["start"]
    start = Start(
        read_text(begun["name"]),
        read_text(begun["unit"]),
        tuple(_read_matrix(state) for state in _read_list(begun["states"])),
        None if begun["wanted"] is None else read_ratio(begun["wanted"]),
    )
    return Saturation(tuple(signals), start)


def _contact_fields(contact: Contact) -> Fields:
    return {
        "free": _mode_fields(contact.free),
        "pulls": [_matrix_fields(row) for row in contact.pulls],
        "required": contact.required,
        **({"pushed": True} if contact.pushed else {}),
        "loss": str(contact.loss),
    }


def _flight_fields(flights: Flights) -> Fields:
    return {
        "touching": list(flights.touching),
        "flying": list(flights.flying),
        "pulls": [_matrix_fields(row) for row in flights.pulls],
    }


def _read_flights(fields: Mapping[str, Any]) -> Flights:
    pulls = tuple(_read_matrix(item) for item in _read_list(fields["pulls"]))
    return Flights(_read_texts(fields["touching"]), _read_texts(fields["flying"]), pulls)


def _read_contact(fields: Mapping[str, Any]) -> Contact:
    pulls = tuple(_read_matrix(item) for item in _read_list(fields["pulls"]))
    required = fields["required"]
    if not isinstance(required, bool):
        raise TypeError("whether the loss of contact must be covered is not true or false")
    pushed = fields.get("pushed", False)
    if not isinstance(pushed, bool):
        raise TypeError("whether a constant force pushes in is not true or false")
    loss = read_text(fields["loss"])
    return Contact(_read_modes(fields["free"]), pulls, required, pushed, loss)


def _clock_fields(clock: Clock) -> Fields:
    return {"length": clock.length, "first": list(clock.first)}


def _read_clock(fields: Mapping[str, Any]) -> Clock:
    length = read_integer(fields["length"])
    if not 2 <= length <= MAX_ROUND:
        raise ValueError(f"a round has from 2 to {MAX_ROUND} steps")
    return Clock(length, _read_texts(fields["first"]))


def _switching_fields(switching: Switching) -> Fields | str:
    if switching.is_arbitrary:
        return WITHOUT_RULES
    parameter, transitions = switching.fixed_parameter, switching.transitions
    return {
        "dwell_time": str(switching.dwell_time),
        "stays": [
            {"mode": name, "shortest": str(stay.shortest), "longest": _text(stay.longest)}
            for name, stay in switching.stays
        ],
        "transitions": None if transitions is None else [list(pair) for pair in transitions],
        "resets": [
            {"from": reset.source, "to": reset.target, **_matrix_fields(reset.map)}
            for reset in switching.resets
        ],
        "constant": [list(pair) for pair in switching.fixed_ends],
        "parameter": None
        if parameter is None
        else {"name": parameter.name, "low": str(parameter.low), "high": str(parameter.high)},
    }


def _read_switching(fields: Any) -> Switching:
    if fields == WITHOUT_RULES:
        return ARBITRARY
    transitions, parameter = fields["transitions"], fields["parameter"]
    return Switching(
        dwell_time=read_ratio(fields["dwell_time"]),
        transitions=None if transitions is None else _read_pairs(transitions),
        resets=tuple(
            Reset(read_text(item["from"]), read_text(item["to"]), _read_matrix(item))
            for item in _read_list(fields["resets"])
        ),
        fixed_ends=_read_pairs(fields["constant"]),
        fixed_parameter=None
        if parameter is None
        else FixedParameter(
            read_text(parameter["name"]),
            _read_signed(parameter["low"]),
            _read_signed(parameter["high"]),
        ),
        stays=tuple(
            (read_text(item["mode"]), _read_stay(item)) for item in _read_list(fields["stays"])
        ),
    )


def _read_stay(fields: Mapping[str, Any]) -> Stay:
    longest = fields["longest"]
    return Stay(read_ratio(fields["shortest"]), None if longest is None else read_ratio(longest))


def _matrix_fields(A: RationalMatrix) -> Fields:
    if max(bit_length(A.numerators), A.denominator.bit_length()) > MAX_INTEGER_BITS:
        raise ValueError("a number of a mode or a reset has more digits than a certificate holds")
    return {"numerators": [list(row) for row in A.numerators], "denominator": A.denominator}


def _read_matrix(fields: Mapping[str, Any]) -> RationalMatrix:
    rows = tuple(
        tuple(read_integer(entry) for entry in _read_list(row))
        for row in _read_list(fields["numerators"])
    )
    denominator = read_integer(fields["denominator"])
    if denominator <= 0 or not rows or not rows[0] or len(set(map(len, rows))) != 1:
        raise ValueError("a matrix has rows of different lengths, or no positive denominator")
    return RationalMatrix(rows, denominator)


def _read_signed(value: object) -> Fraction:
    """Read a ratio of integers, such as -3/8."""
    text = read_text(value)
    return -read_ratio(text[1:]) if text.startswith("-") else read_ratio(text)


def _read_pairs(value: object) -> tuple[tuple[str, str], ...]:
    return tuple((read_text(first), read_text(second)) for first, second in _read_list(value))


def _read_texts(value: object) -> tuple[str, ...]:
    return tuple(read_text(item) for item in _read_list(value))


def _read_list(value: object) -> list[Any]:
    if not isinstance(value, list):
        raise TypeError(f"expected a list, not {quoted(str(value))}")
    return value


def _text(number: Fraction | None) -> str | None:
    return None if number is None else str(number)
