"""Forgeries of certificates that ship, which no checker may take for a proof."""

import json
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

from nrs_design.certificates.certificate import Certificate, to_document
from tests.proof.systems import genuine
from tests.support import ROOT
from tests.tables import table

SHIPPED = sorted((ROOT / "reports").glob("*.cert.json"))
QUADRATIC, POLYNOMIAL = "commuting", "dayawansa-martin-6"
CONSTANT = "unknown-constant"  # It holds functions of a constant parameter, which no page knows
POLYNOMIALS = ("degree", "vanishing")  # Fields of theirs alone
Document = dict[str, Any]
Change = Callable[[Document], object]


def shipped(name):
    return json.loads((ROOT / "reports" / f"{name}.cert.json").read_text())


def first(document):
    return document["statements"][0]


def claim_a_little_more(document):
    """Beyond what is found: rates of shipped certificates are near to the largest."""
    faster = Fraction(9, 10) if document["time"] == "discrete" else Fraction(11, 10)
    first(document)["rate"] = str(faster * Fraction(first(document)["rate"]))


def name_twice(document):
    document["modes"][1]["name"] = document["modes"][0]["name"]


def widen_mode(document):
    for row in document["modes"][0]["numerators"]:
        row.append(0)


def leave_out_the_proof(document):
    document["statements"] = [s for s in document["statements"] if s["kind"].startswith("no-")]


def fill_vanishing(document):
    """Definite whatever the modes do, were it not for the check that it vanishes."""
    huge = 10**40
    for N in first(document)["vanishing"]:
        for i, row in enumerate(N):
            row[i] += huge


def coarsen(document):
    """Round forms so that little is left of them."""
    for node in first(document)["nodes"]:
        most = max(abs(entry) for row in node["form"] for entry in row)
        node["form"] = [[round(entry / most * 4) for entry in row] for row in node["form"]]


def grow_in_flight(document):
    free = document["contact"]["free"][0]
    free["numerators"][0][0] += 1000 * free["denominator"]


def require_contact(document):
    """A function for kept contact is not enough where its loss must be covered."""
    document["contact"]["required"] = True
    first(document)["nodes"].pop()


def stay_longer(document):
    for name, stay in document["switching"]["stays"]:
        if name != "works":
            stay["longest"] = "40"


def swap_forms(document):
    a, b, *_ = first(document)["nodes"]
    a["form"], b["form"] = b["form"], a["form"]


def turn_over(document):
    """Modes that grow, and functions that do so faster: they fall below zero."""
    for mode in document["modes"]:
        mode.update(numerators=[[5, 0], [0, 5]], denominator=1)
    P, F, G = ([[scale, 0], [0, scale]] for scale in (-10, -10, 1))
    first(document).update(functions=[P, P], multipliers=[[F, G]])


def add_unpaired(document):
    """An unstable mode at no corner."""
    alone = {**document["modes"][0], "name": "alone"}
    document["modes"].append({**alone, "numerators": [[5, 0], [0, 5]]})


def reset_at_corners(document):
    a, b = document["switching"]["fixed_ends"][0]
    reset = {"source": a, "target": b, "numerators": [[9, 0], [0, 9]], "denominator": 1}
    document["switching"]["resets"] = [reset]


def lose_contact(document):
    free = {"name": "air", "numerators": [[-1, 0], [1, 0]], "denominator": 1}
    document["contact"] = {"free": [free], "required": True}


def follow_nobody(document):
    """One unstable mode, which is said to be left: there is no switch, and so no step."""
    states, document["modes"] = len(document["states"]), document["modes"][:1]
    mode = document["modes"][0]
    mode["numerators"] = [[5 * (i == j) for j in range(states)] for i in range(states)]
    mode["denominator"] = 1
    statement = {**first(document), "nodes": [], "stays": {"leaving": [mode["name"]]}}
    document["statements"] = [{k: statement[k] for k in statement if k not in POLYNOMIALS}]


def leave_by_no_switch(document):
    """Beside the others an unstable mode that no switch leads to or from."""
    alone = {**document["modes"][0], "name": "alone"}
    alone["numerators"] = [[5 * entry for entry in row] for row in alone["numerators"]]
    document["modes"].append(alone)
    first(document)["stays"] = {"leaving": ["alone"]}


def key_of(box: Any, part: str) -> Any:
    return int(part) if isinstance(box, list) else part


def places(box: Any, parts: list[str]) -> Iterator[tuple[Any, Any]]:
    """Yield where a path leads: the list or mapping that holds a value, and its key there."""
    part, *below = parts
    keys = range(len(box)) if part == "*" else [key_of(box, part)]
    for key in keys:
        if below:
            yield from places(box[key], below)
        else:
            yield box, key


def scaled(value: Any, said: dict[str, Any]) -> Any:
    """Return a number, or a ratio as text, times one number and plus another."""
    if isinstance(value, list):
        return [scaled(entry, said) for entry in value]
    changed = Fraction(value) * said.get("times", 1) + said.get("plus", 0)
    return str(changed) if isinstance(value, str) else int(changed)


def edit(box: Any, key: Any, said: dict[str, Any]) -> None:
    match said:
        case {"to": value}:
            box[key] = value
        case {"popped": _}:
            box[key].pop()
        case {"dropped": _}:
            del box[key]
        case {"reversed": _}:
            box[key].reverse()
        case {"doubled": _}:
            box[key] *= 2
        case _:
            box[key] = scaled(box[key], said)


def attack(name: str, said: dict[str, Any]) -> Change:
    """Return what a row of the table does to a certificate."""

    def change(document: Document) -> None:
        if "multiplier" in said:
            for item in first(document)["multipliers"]:
                if item["fact"] == said["multiplier"]:
                    edit(item, "value", said)
        for path in said.get("at", "").split():
            for box, key in places(document, path.split(".")):
                edit(box, key, said)

    change.__name__ = name.replace(" ", "_")
    return change if said else globals()[change.__name__]


TABLE = {
    name: [attack(*row) for row in rows.items()]
    for name, rows in table(Path(__file__).with_name("attacks.yaml")).items()
}
DEAR = "soft-tissue-sampled"
ATTACKS: list[tuple[str, Change]] = [
    *((name, change) for name in (QUADRATIC, POLYNOMIAL) for change in TABLE["everywhere"]),
    *((name, c) for name, all_ in TABLE.items() if name not in ("everywhere", DEAR) for c in all_),
]
DEAR_ATTACKS: list[tuple[str, Change]] = [(DEAR, change) for change in TABLE[DEAR]]


# Shapes that do not ship, by their names in `tests.proof.systems`: what both checkers know, and
# what a page knows alone.
BOTH = (
    "conewise-polynomial",
    "conewise-quadratic, discrete",
    "conewise-quadratic",
    "mode-quadratic, one way",
    "mode-quadratic, rectangular",
    "mode-quadratic, steps",
    "mode-quadratic, left",
    "mode-quadratic, two ways",
    "no-common-quadratic, discrete",
)
PAGE_ALONE = (
    "common-polynomial, discrete",
    "mode-polynomial",
    "periodic-quadratic",
    "periodic-quadratic, rounding",
)


def found(example):
    """Return the certificate of what a search finds for an example."""
    system, evidence = genuine(example)
    return to_document(Certificate("family", "0" * 64, None, {}, system, (evidence,), "0.1.0"))


def named(value):
    """Name a case by its certificate and its change."""
    return getattr(value, "__name__", value)
