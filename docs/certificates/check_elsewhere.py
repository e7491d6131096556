"""Re-check a certificate of nrs-design, schema 8, with nothing but Python's own fractions.

Usage: python check_elsewhere.py CERTIFICATE.json. Exit code: 0 if every statement holds, 1 if one
does not, 3 if one is not checked here. Whose modes the file holds is what `nrs-design verify` adds.
"""

import hashlib
import json
import sys
from collections import Counter
from fractions import Fraction as F
from itertools import combinations_with_replacement


def positive_definite(M):
    if not M or transposed(M) != M:
        return False
    while M:
        (pivot, *row), *below = M
        if pivot <= 0:
            return False
        M = [[a - F(c) / pivot * b for a, b in zip(r, row, strict=True)] for c, *r in below]
    return True


def transposed(A):
    return [list(column) for column in zip(*A, strict=True)]


def times(A, B):
    return [[sum(a * b for a, b in zip(r, c, strict=True)) for c in transposed(B)] for r in A]


def plus(A, B, weight=1):
    return [[a + weight * b for a, b in zip(*rows, strict=True)] for rows in zip(A, B, strict=True)]


def decrease(A, Q, rate, discrete):
    minus_QA = [[-entry for entry in row] for row in times(Q, A)]
    if discrete:
        return plus(times(transposed(A), minus_QA), Q, rate**2)
    return plus(plus(minus_QA, transposed(minus_QA)), Q, -2 * rate)


def grown(polynomial, row):
    """Multiply a polynomial (coefficients by sorted indices) by the linear form of a row."""
    result = Counter()
    for term, value in polynomial.items():
        for j, entry in enumerate(row):
            result[tuple(sorted((*term, j)))] += value * entry
    return result


def lift(A, basis, discrete):
    """Return L with z+ = L z, or by the product rule z' = L z, for the monomials z of a basis."""
    rows = []
    for monomial in basis:
        image, slope = Counter({(): 1}), Counter()
        for k, i in enumerate(monomial):
            image = grown(image, A[i])
            slope.update(grown({monomial[:k] + monomial[k + 1 :]: 1}, A[i]))
        rows.append([(image if discrete else slope)[term] for term in basis])
    return rows


def falls(A, q, N, Q, d, rate, discrete):
    """Tell whether z' Q z decreases in the mode A, with a form z' N z added that must be zero."""
    basis, form = list(combinations_with_replacement(range(len(A)), d)), Counter()
    for a, row in zip(basis, N, strict=True):
        for b, entry in zip(basis, row, strict=True):
            form[tuple(sorted(a + b))] += entry
    speed = rate**d if discrete else d * rate
    # N is stored times the number that clears the denominators of the decrease.
    factor = (q**d * speed.denominator) ** 2 if discrete else q * (2 * speed * q).denominator
    total = plus(N, decrease(lift(A, basis, discrete), Q, speed, discrete), factor)
    return not any(form.values()) and positive_definite(total)


def holds(statement, modes, free, discrete):
    """Tell whether a statement is true of the modes; None if that is not checked here."""
    if statement["kind"] == "no-common-quadratic":
        total = []
        for name, L in statement["factors"]:
            A, X = modes[name][0], times(L, transposed(L))
            AX = times(A, X)
            term = plus(times(AX, transposed(A)), X, -1) if discrete else plus(AX, transposed(AX))
            total = plus(total, term) if total else term
        return positive_definite(total)
    # Graphs of one form for all modes; those of several, and what holds on their steps, are not.
    others = {"multipliers", "edges", "stays"} & statement.keys()
    if not free or statement["kind"] != "graph" or others or len(statement["nodes"]) != 1:
        return None
    Q, d = statement["nodes"][0]["form"], statement.get("degree", 1)
    rate = F(statement["rate"])
    decays = 0 < rate < 1 if discrete else rate > 0
    if not modes or d < 1 or not decays or not positive_definite(Q):
        return False
    forms = statement.get("vanishing", [[[0] * len(Q)] * len(Q)] * len(modes))
    pairs = zip(modes.values(), forms, strict=True)
    return all(falls(*mode, N, Q, d, rate, discrete) for mode, N in pairs)


with open(sys.argv[1], encoding="utf-8") as file:
    certificate = json.load(file)
signed = {key: certificate[key] for key in certificate.keys() - {"id", "origin"}}
text = json.dumps(signed, sort_keys=True, separators=(",", ":"))
if hashlib.sha256(text.encode()).hexdigest() != certificate["id"]:
    sys.exit("it was altered")
modes = {}
for mode in certificate["modes"]:
    q, rows = mode["denominator"], mode["numerators"]
    if mode["name"] in modes or q <= 0 or any(len(row) != len(rows) for row in rows):
        sys.exit("two modes have one name, or one is not square")
    modes[mode["name"]] = [[F(entry, q) for entry in row] for row in rows], q
free, discrete = certificate["switching"] == "arbitrary", certificate["time"] == "discrete"
free &= not certificate.get("contact", {}).get("required")
free &= not {"couplings", "clock"} & certificate.keys()
results, verdict = [], "inconclusive"
for statement in certificate["statements"]:
    results.append(holds(statement, modes, free, discrete))
    words = {True: "holds", False: "DOES NOT HOLD", None: "not checked here"}
    print(f"{statement['kind']}: {words[results[-1]]}")
    verdict = verdict if statement["kind"].startswith("no-") else "proved"
sys.exit(1 if False in results else 3 if None in results else certificate["verdict"] != verdict)
