"""Forgeries of certificates that ship, which no checker may take for a proof."""

import json
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from nrs_design.certificates.certificate import Certificate, to_document
from nrs_design.loop.cases import in_cases
from nrs_design.search.cases import joined
from tests.proof.systems import genuine
from tests.support import ROOT

SHIPPED = sorted((ROOT / "reports").glob("*.cert.json"))
QUADRATIC, POLYNOMIAL = "commuting", "dayawansa-martin-6"
SAMPLED, CONTACT = "soft-tissue-sampled", "soft-tissue"
RULED, DWELL, RESETS = "failing-controller", "geromel-colaneri", "force-limit-offset"
CONSTANT = "unknown-constant"  # It holds functions of a constant parameter, which no page knows
POLYNOMIALS = ("degree", "vanishing")  # Fields of theirs alone
Document = dict[str, Any]


def shipped(name):
    return json.loads((ROOT / "reports" / f"{name}.cert.json").read_text())


def first(document):
    return document["statements"][0]


def flip_sign(document):
    Q = first(document)["nodes"][0]["form"]
    Q[0][0] = -Q[0][0]


def break_symmetry(document):
    first(document)["nodes"][0]["form"][0][1] += 1


def claim_more(document):
    first(document)["rate"] = str(1000 * Fraction(first(document)["rate"]))


def claim_a_little_more(document):
    """Beyond what is found: rates of shipped certificates are near to the largest."""
    faster = Fraction(9, 10) if document["time"] == "discrete" else Fraction(11, 10)
    first(document)["rate"] = str(faster * Fraction(first(document)["rate"]))


def claim_nothing(document):
    first(document)["rate"] = "0"


def reverse_time(document):
    for row in document["modes"][0]["numerators"]:
        row[:] = [-entry for entry in row]


def name_twice(document):
    document["modes"][1]["name"] = document["modes"][0]["name"]


def turn_denominator(document):
    for mode in document["modes"]:
        mode["denominator"] = -mode["denominator"]
        mode["numerators"] = [[-entry for entry in row] for row in mode["numerators"]]


def make_oblong(document):
    document["modes"][0]["numerators"].pop()


def drop_all_modes(document):
    document["modes"] = []


def widen_mode(document):
    for row in document["modes"][0]["numerators"]:
        row.append(0)


def call_it_discrete(document):
    document["time"] = "discrete"


def call_it_timeless(document):
    document["time"] = "none"


def refute(document):
    document["verdict"] = "refuted"


def leave_out_the_proof(document):
    document["statements"] = [s for s in document["statements"] if s["kind"].startswith("no-")]


def change_schema(document):
    document["schema"] = "nrs-design/certificate/8"


def spoil_vanishing(document):
    first(document)["vanishing"][0][0][0] += 1


def fill_vanishing(document):
    """Definite whatever the modes do, were it not for the check that it vanishes."""
    huge = 10**40
    for N in first(document)["vanishing"]:
        for i, row in enumerate(N):
            row[i] += huge


def drop_vanishing(document):
    first(document)["vanishing"].pop()


def drop_mode(document):
    document["modes"].pop()


def drop_free_mode(document):
    document["contact"]["free"].pop()


def change_degree(document):
    first(document)["degree"] += 1


def spoil_factor(document):
    for _, L in document["statements"][1]["factors"]:
        L[0] = [0] * len(L[0])


def coarsen(document):
    """Round forms so that little is left of them."""
    for node in first(document)["nodes"]:
        most = max(abs(entry) for row in node["form"] for entry in row)
        node["form"] = [[round(entry / most * 4) for entry in row] for row in node["form"]]


def multiplier(fact, change):
    def changed(document):
        for item in first(document)["multipliers"]:
            if item["fact"] == fact:
                item["value"] = change(item["value"])

    changed.__name__ = f"{fact.replace(' ', '_')}_is_changed"
    return changed


def drop_multipliers(document):
    del first(document)["multipliers"]


def double_multipliers(document):
    first(document)["multipliers"] *= 2


def drop_column(document):
    document["roundings"][0]["columns"].pop()


def round_more(document):
    for row in document["roundings"][0]["rows"]:
        row["numerators"] = [[entry * 2**20 for entry in entries] for entries in row["numerators"]]


def push_in_flight(document):
    document["contact"]["free"][0]["numerators"][0][-1] = 1


def jump(document):
    first(document)["nodes"][1]["form"][0][0] += 1


def grow_in_flight(document):
    free = document["contact"]["free"][0]
    free["numerators"][0][0] += 1000 * free["denominator"]


def require_contact(document):
    """A function for kept contact is not enough where its loss must be covered."""
    document["contact"]["required"] = True
    first(document)["nodes"].pop()


def stay_for_good(document):
    del first(document)["stays"]["leaving"]


def stay_longer(document):
    for name, stay in document["switching"]["stays"]:
        if name != "works":
            stay["longest"] = "40"


def switch_sooner(document):
    document["switching"]["dwell_time"] = "1"


def stretch_reset(document):
    for reset in document["switching"]["resets"]:
        reset["numerators"] = [[3 * entry for entry in row] for row in reset["numerators"]]


def reset_nobody(document):
    document["switching"]["resets"][0]["target"] = "nobody"


def swap_forms(document):
    a, b, *_ = first(document)["nodes"]
    a["form"], b["form"] = b["form"], a["form"]


def swap_functions(document):
    first(document)["functions"].reverse()


def turn_over(document):
    """Modes that grow, and functions that do so faster: they fall below zero."""
    for mode in document["modes"]:
        mode.update(numerators=[[5, 0], [0, 5]], denominator=1)
    P, F, G = ([[scale, 0], [0, scale]] for scale in (-10, -10, 1))
    first(document).update(functions=[P, P], multipliers=[[F, G]])


def drop_multipliers_of_a_mode(document):
    first(document)["multipliers"].pop()


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


Change = Callable[[Document], object]
EVERYWHERE: tuple[Change, ...] = (
    flip_sign,
    break_symmetry,
    claim_more,
    claim_a_little_more,
    claim_nothing,
    reverse_time,
    name_twice,
    turn_denominator,
    make_oblong,
    widen_mode,
    drop_all_modes,
    call_it_discrete,
    call_it_timeless,
    change_schema,
    refute,
    leave_out_the_proof,
    follow_nobody,
)
ELSEWHERE: dict[str, tuple[Change, ...]] = {
    POLYNOMIAL: (
        spoil_vanishing,
        fill_vanishing,
        drop_vanishing,
        drop_mode,
        change_degree,
        spoil_factor,
    ),
    CONTACT: (jump, grow_in_flight, push_in_flight, require_contact, coarsen, claim_a_little_more),
    RULED: (stay_for_good, stay_longer, swap_forms, claim_a_little_more, leave_by_no_switch),
    DWELL: (switch_sooner, swap_forms, coarsen),
    RESETS: (stretch_reset, reset_nobody, swap_forms),
    CONSTANT: (
        swap_functions,
        turn_over,
        drop_multipliers_of_a_mode,
        add_unpaired,
        reset_at_corners,
        lose_contact,
        call_it_discrete,
        claim_nothing,
        claim_more,
        claim_a_little_more,
    ),
}
# These have more modes, and are dear.
LARGE: dict[str, tuple[Change, ...]] = {
    SAMPLED: (
        multiplier("lost", lambda m: 0),
        multiplier("rounding 1", lambda m: 0),
        multiplier("rounding 2", lambda m: -m),
        multiplier("rounding 3", lambda m: m * 10**6),
        drop_multipliers,
        double_multipliers,
        drop_column,
        drop_mode,
        drop_free_mode,
        round_more,
        push_in_flight,
        claim_a_little_more,
        coarsen,
    )
}
ATTACKS: list[tuple[str, Change]] = [
    *((name, change) for name in (QUADRATIC, POLYNOMIAL) for change in EVERYWHERE),
    *((name, change) for name, changes in ELSEWHERE.items() for change in changes),
]
DEAR_ATTACKS: list[tuple[str, Change]] = [
    (name, change) for name, changes in LARGE.items() for change in changes
]


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
    "cases: periodic-quadratic, rounding",
    "cases: conewise-quadratic",
    "cases: conewise-quadratic, discrete",
)


def found(example):
    """Return the certificate of what a search finds for an example; twice, if it is of cases."""
    *cases, name = example.split(": ")
    system, evidence = genuine(name)
    if cases:
        proofs = (evidence, evidence)
        system = in_cases(system, (system, system))
        evidence = joined(system, proofs)
    return to_document(Certificate("family", "0" * 64, None, {}, system, (evidence,), "0.1.0"))


def named(value):
    """Name a case by its certificate and its change."""
    return getattr(value, "__name__", value)
