"""Systems with known answers, and what it means to agree with one."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ruamel.yaml import YAML

from nrs_design.controllers.laws import Admittance
from nrs_design.loop.assemble import GIVEN_MATRICES, assemble_from_text
from nrs_design.loop.modes import velocity_mode
from nrs_design.models.contact import KelvinVoigt
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certify import Certification, Verdict, certify
from nrs_design.spec import parse_exact, parse_spec
from nrs_design.thesis.switching import replace_by_force
from tests.loop.support import MOTION
from tests.support import holds

DATA = Path(__file__).parents[1] / "data" / "known_answers.yaml"


@dataclass(frozen=True)
class Known:
    system: SwitchedSystem
    common_quadratic: str
    stable: bool
    alpha: str | None = None
    degree: int | None = None


def names(*groups: str) -> list[str]:
    entries = read_groups()
    return [name for group in groups or entries for name in entries[group]]


@cache
def read_groups() -> dict[str, dict[str, dict]]:
    # The base loader keeps every scalar as text, so that no entry passes through a float.
    return YAML(typ="base").load(DATA.read_text(encoding="utf-8"))


def known(name: str, coordinates: str = "deflection") -> Known:
    groups = read_groups()
    group = next(group for group in groups if name in groups[group])
    entry = groups[group][name]
    if group == "robot":
        system = robot(name, entry["Mt"], entry["contacts"], coordinates)
    else:
        system = given(name, entry["A"], group)
    return Known(
        system,
        entry["common_quadratic"],
        entry["stable"] == "true",
        entry.get("alpha"),
        int(entry["degree"]) if "degree" in entry else None,
    )


def given(name, matrices, time="continuous") -> SwitchedSystem:
    modes = [{"name": f"m{i}", "A": A} for i, A in enumerate(matrices)]
    # JSON is YAML; entries stay texts.
    document = {"kind": "switched-system", "name": name, "time": time, "modes": modes}
    return assemble_from_text(parse_spec(json.dumps({**document, "switching": "arbitrary"})), {})


def robot(name, Mt, contacts, coordinates="deflection") -> SwitchedSystem:
    zero = parse_exact("0")
    modes = []
    for k, Bt in contacts:
        contact = KelvinVoigt(parse_exact(k), zero)
        rows = velocity_mode(MOTION, Admittance(parse_exact(Mt), parse_exact(Bt)), contact)
        if coordinates == "force":
            rows = replace_by_force(rows, MOTION, contact)
        modes.append(Mode(f"k={k} Bt={Bt}", RationalMatrix.from_rows(rows)))
    states = tuple(f"x{i}" for i in range(len(modes[0].A.numerators)))
    return SwitchedSystem(
        name=name,
        time=Time.CONTINUOUS,
        states=states,
        modes=tuple(modes),
        assumptions=GIVEN_MATRICES,
    )


def settle(name: str, coordinates: str = "deflection") -> Certification:
    """Certify, and insist on the whole truth.

    Every statement must pass the exact check and agree with its definition. It is asked once of
    each system, however many tests look at the answer.
    """
    return _settled(name, coordinates)


@cache
def _settled(name: str, coordinates: str) -> Certification:
    truth = known(name, coordinates)
    found = certify(truth.system)
    assert found.verdict is (Verdict.PROVED if truth.stable else Verdict.REFUTED)
    assert found.common_quadratic == truth.common_quadratic
    assert found.evidence is found.statements[0]
    for statement in found.statements:
        assert statement.find_fault(truth.system) is None
        assert holds(truth.system, statement)
    return found
