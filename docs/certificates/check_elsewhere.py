"""Re-check a certificate of nrs-design, schema 9, with nothing but Python's own integers.

Usage: python check_elsewhere.py CERTIFICATE.json. Exit code: 0 if every statement holds, 1 if one
does not, 3 if one is not checked here. format.md says what each number means and what must hold.
The sentences are not read; whose modes the file holds is what `nrs-design verify` adds.
"""

import hashlib
import json
import sys
from collections import Counter, namedtuple
from fractions import Fraction as F
from itertools import combinations_with_replacement, product
from math import lcm

# Vectors have entries by key: monomials of the states, as (2,) for the third, and what acts beside.
# M z comes after z, of which n entries are the state, or is its derivative in a flow. Facts are
# (name, a, b): of each name, all (a z)(b z) add up to nothing positive.
Step = namedtuple("Step", "mode source target n M flow facts over time")


def need(truth, words, error=ValueError):
    if not truth:
        raise error(words)


def ratio(text):
    need(str(F(text)) == text and text[0] != "-", "a number is no ratio")
    return F(text)


def need_distinct(keys):
    need({*keys} <= names and len({*keys}) == len(keys), "it names something else, or one twice")


def definite(terms, semi=False):
    """Tell whether the sum of w a'b over terms (w, a, b) is positive (semi)definite."""
    units, factor, whole = {}, lcm(*(F(w).denominator for w, *_ in terms)), Counter()
    for key, x in (entry for _, *pair in terms for v in pair for entry in v.items()):
        units[key] = lcm(units.get(key, 1), F(x).denominator)
    for w, *pair in terms:
        a, b = ([(key, int(x * units[key])) for key, x in v.items() if x] for v in pair)
        for (i, x), (j, y) in product(a, b):
            whole[i, j] += int(w * factor) * x * y
    M, q = [[whole[i, j] for j in units] for i in units], 1
    if not M or [list(column) for column in zip(*M, strict=True)] != M:
        return False
    while M:  # Elimination without fractions (Bareiss)
        k = (max if semi else min)(range(len(M)), key=lambda i: M[i][i])
        p, rest = M[k][k], [i for i in range(len(M)) if i != k]
        if p <= 0:
            return semi and not any(map(any, M))
        M, q = [[(p * M[i][j] - M[i][k] * M[k][j]) // q for j in rest] for i in rest], p
    return True


def combined(row, vectors):
    result = Counter()
    for key, weight in row.items():
        for other, entry in vectors[key].items():
            result[other] += weight * entry
    return result


def table(o, rows, columns):
    N, q = o["numerators"], o["denominator"]
    need(q > 0 and len(N) == rows and {*map(len, N)} == {columns}, "a matrix is of another shape")
    return {(i,): {(j,): F(x, q) for j, x in enumerate(row)} for i, row in enumerate(N)}


def form(rows, n, d=1, kept=64):  # On the monomials of n states; those of the first are kept
    basis = list(combinations_with_replacement(range(n), d))
    full = {a: dict(zip(basis, row, strict=True)) for a, row in zip(basis, rows, strict=True)}
    return {a: {b: full[a][b] for b in basis if max(b) < kept} for a in basis if max(a) < kept}


def own(form, weight=1):
    return [(weight, {a: 1}, row) for a, row in form.items()]


def left(s, before, after, keeps):
    """Return the terms of what is left of a form before a step without that after it."""
    if not s.flow:
        return own(before, keeps) + [(-1, s.M[a], combined(after[a], s.M)) for a in after]
    moved = {a: Counter() for a in before}
    for a, vector in moved.items():
        for k, i in enumerate(a):
            for key, x in s.M[i,].items():
                vector[tuple(sorted((*a[:k], *a[k + 1 :], *key))) if a[1:] else key] += x
    images = {a: combined(row, moved) for a, row in before.items()}
    return own(before, -keeps) + own(images, -1) + [(-1, b, a) for _, a, b in own(images)]


def exponential(A, t):
    size, k, bound = t * max(sum(map(abs, row.values())) for row in A.values()), 0, F(1)
    need(size < 99, "so long a stay", NotImplementedError)
    E = term = {i: {i: F(1)} for i in A}
    while k < 2 * size or bound > F(1, 2**300):
        k, bound = k + 1, bound * size / (k + 1)
        term = {i: combined({j: x * t / k for j, x in A[i].items()}, term) for i in A}
        E = {i: combined({0: 1, 1: 1}, [E[i], term[i]]) for i in A}
    return E, bound  # Of a row's error: of the terms left, each is at most half of the one before


def acting(k, rounds):
    mode, facts, M = every[k], [], {i: {**row} for i, row in A[every[k]["name"]].items()}
    for number, item in enumerate(o.get("roundings", []) if rounds else [], 1):
        act, width = f"rounding {number}", n + len(o.get("channels", []))
        need(len(item["columns"]) == len(item["rows"]) == len(every), "a mode has no column or row")
        q = {key: x for key, x in table(item["rows"][k], 1, width)[0,].items() if key in M}
        for i, entry in table(item["columns"][k], n, 1).items():
            M[i][act] = entry[0,]
        facts += [(act, {act: 1}, {act: 1}), (act, {key: -x for key, x in q.items()}, q)]
    for row in [*M.values(), *(v for _, *pair in facts for v in pair)] * (k >= count):
        need(row.pop((n - 1,), 0) == (row is M[n - 1,] and not flow), "free, but pushed")
    return Step(mode["name"], "modes", "modes", n, M, flow, facts, mode["denominator"], 1)


def steps_in_contact(lost, rounds):
    """Yield every step under arbitrary switching, between contact and flight if it is lost."""
    need(uniform and not rules.get("resets"), "resets, or modes of unlike size, are not covered")
    for k in range(len(every) if lost else count):
        s, last = acting(k, rounds), (n - 1,)
        rows = {i: row for i, row in s.M.items() if i != last}
        if k >= count:
            s = s._replace(n=n - 1, source="free")
            yield from [s._replace(M=rows, target="free"), s, s._replace(M=rows)][: 3 - 2 * flow]
            continue
        facts = [*s.facts, ("lost", {last: 1}, s.M[last]), ("lost", s.M[last], {last: 1})]
        yield from [s, s._replace(M=rows, target="free", facts=facts)][: 1 + (lost and not flow)]


def steps_by_mode(leaving, rate):
    """Yield every step of a system that keeps rules of switching; its places are the modes."""
    stays, resets, moves = (rules.get(key, []) for key in ("stays", "resets", "transitions"))
    ways = [[r["source"], r["target"]] for r in resets]
    for keys in [leaving, [a for a, _ in stays], *ways, *([a, b] for a, b in moves)]:
        need_distinct(keys)
    for a in names - {*leaving}:
        yield Step(a, a, a, len(A[a]), A[a], flow, [], 1, 1)
    for a, b in product(names, names):
        if a == b or [a, b] not in rules.get("transitions", [[a, b]]):
            continue
        stay = dict(stays).get(a, {"shortest": rules.get("dwell_time", "0")})
        first = max(ratio(stay.get("shortest", "0")), not flow)
        last = ratio(stay["longest"]) if a in leaving else first
        need(0 <= first <= last and (flow or first % 1 == last % 1 == 0), "a stay is odd")
        need(last <= 4096, "so long a stay", NotImplementedError)
        for reset in [r for r, way in zip(resets, ways, strict=True) if way == [a, b]] or [None]:
            jump = table(reset, len(A[b]), len(A[a])) if reset else {i: {i: F(1)} for i in A[a]}
            need(jump.keys() == A[b].keys(), "a switch has no reset that fits")
            if flow:
                E, e = exponential({i: {**A[a][i], i: A[a][i][i] + rate} for i in A[a]}, first)
                e *= max(sum(map(abs, row.values())) for row in jump.values())
                jump = {i: combined(row, E) for i, row in jump.items()}
                facts = [("error", {i: -e * (1 + e)}, {i: 1}) for i in E]
                yield Step(a, a, b, len(E), jump, False, facts, 1, 0)
            for stay in range(1, 1 + int(last) * (not flow)):
                jump = {i: combined(row, A[a]) for i, row in jump.items()}
                if stay >= first:
                    yield Step(a, a, b, len(A[a]), jump, False, [], 1, stay)


def check_graph(told):
    stays, d, rate = told.get("stays"), told.get("degree", 1), ratio(told["rate"])
    nodes = [(k, *map(node.get, ("place", "form"))) for k, node in enumerate(told["nodes"])]
    multipliers, added = told.get("multipliers", []), told.get("vanishing", [])
    values = {(m["fact"], m.get("target")): m["value"] for m in multipliers}
    lost = stays is None and "free" in [place for _, place, _ in nodes]
    known = not (stays and flow and stays.get("leaving")) and (d == 1 or (flow and stays is None))
    need(known and "edges" not in told, "shape", NotImplementedError)
    need(d >= 1 and rate > 0 and (flow or rate < 1), "the rate is none of decay")
    if stays is None:
        steps = list(steps_in_contact(lost, any(fact[:8] == "rounding" for fact, _ in values)))
        more = required and not lost
    else:
        steps = list(steps_by_mode(stays.get("leaving", []), rate))
        more = values or required or "fixed_ends" in rules
    need(not more, "contact, or what is between the ends of a range, is not covered")
    sizes, facts = {s.source: s.n for s in steps}, {fact for s in steps for fact, *_ in s.facts}
    wanted = {s.target for s in steps} | ({*sizes} if stays is None else names)
    need({*sizes} == {p for _, p, _ in nodes} >= wanted, "a place has no form, or no step")
    need(len(nodes) == len(sizes) or not flow, "there are more forms")
    odd = [m for m in multipliers if m["value"] < 0 or m["fact"] not in facts - {"error"} or d > 1]
    need(not odd and len(values) == len(multipliers), "a multiplier is odd")
    for _, place, rows in nodes:
        need(definite(own(form(rows, sizes[place], d))), "a form is not positive definite")
    flat = [form(rows, sizes[place], d, n - 1) for _, place, rows in nodes if lost and flow]
    need(flat[:1] == flat[1:], "it jumps where contact is lost")
    for s, (_, source, rows), (b, target, others) in product(steps, nodes, nodes):
        if (source, target) == (s.source, s.target):
            keeps = 2 * d * rate if s.flow else rate ** (2 * s.time)
            after = form(others, sizes[target], d, len(s.M))
            terms = left(s, form(rows, sizes[source], d), after, keeps)
            G, M = (max(abs(x) for v in Q.values() for x in v.values()) for Q in (after, s.M))
            values["error", None] = max(s.n, len(s.M)) ** 3 * G * (2 * M + 1)  # Its effect, at most
            terms += [(values.get((f, b), values.get((f, None), 0)), *pair) for f, *pair in s.facts]
            if d > 1:
                N, total = form(added.pop(0), s.n, d), Counter()
                for u, v in product(N, N):
                    total[tuple(sorted(u + v))] += N[u][v]
                need(not any(total.values()), "a form does not vanish")
                terms += own(N, F(1, (keeps * s.over).denominator * s.over))
            need(definite(terms, semi=not s.time), f"it rises in mode {s.mode}")
    need(not added, "more forms vanish than there are steps")


def check_no_common_quadratic(told):
    terms = []
    for name, L in told["factors"]:
        for column in zip(*L, strict=True):
            x = dict(zip(A[name], column, strict=True))
            y = {i: sum(a * x[j] for j, a in row.items()) for i, row in A[name].items()}
            terms += [(1, y, x), (1, x, y)] if flow else [(1, y, y), (-1, x, x)]
    need_distinct([name for name, _ in told["factors"]])
    need(uniform and definite(terms), "the sum")


def check_constants_quadratic(told):
    """Where y = A x, 2 (x'F + y'G) (y - A x) is zero; with it V falls for every x and y."""
    P, rate = [form(Q, n) for Q in told["functions"]], ratio(told["rate"])
    sets = rules["fixed_ends"]
    need(uniform and not (required or rules.get("resets")), "contact, or resets, are not covered")
    need(sorted(k for ends in sets for k in {*ends}) == sorted(names), "the modes are not ends")
    need(rate > 0 and (flow or rate < 1), "the rate is none of decay")
    need(all(definite(own(Q)) for Q in P), "a form is not positive definite")
    for ends, pair in zip(sets, told["multipliers"], strict=True):
        (first, second), y = (form(M, n) for M in pair), {(j,): {(n + j,): 1} for j in range(n)}
        for name, Q in zip(ends, P, strict=True):
            terms = own(Q, -2 * rate if flow else rate**2)
            for i, row in Q.items():
                rises = [(row, y[i]), (y[i], row)] if flow else [(y[i], combined(row, y))]
                zero = {**y[i], **{j: -x for j, x in A[name][i].items()}}
                times = {**{j: first[j][i] for j in y}, **combined({j: second[j][i] for j in y}, y)}
                terms += [(-1, *v) for v in rises] + [(1, zero, times), (1, times, zero)]
            need(definite(terms), f"it rises in mode {name}")


sys.tracebacklimit = 0  # What is wrong is said in one line
with open(sys.argv[1], encoding="utf-8") as file:
    o = json.load(file, parse_float=int)  # Refuses fractions
signed = {key: o[key] for key in o.keys() - {"id", "origin"}}
text = json.dumps(signed, sort_keys=True, separators=(",", ":"))
need(hashlib.sha256(text.encode()).hexdigest() == o["id"], "it was altered")
need(o["schema"][-2:] == "/9" and o["time"] in ("continuous", "discrete"), "another schema")
n, contact, flow = len(o["states"]), o.get("contact", {}), o["time"] == "continuous"
kinds = ("graph", "no-common-quadratic", "constants-quadratic")
kinds = () if {"clock", "pulls", "couplings"} & {*o, *contact} else kinds
unknown = [statement["kind"] for statement in o["statements"] if statement["kind"] not in kinds]
for kind in unknown:
    print(f"{kind}: not checked here (this kind, turns, pulls or axes)", flush=True)
rules = {} if o["switching"] == "arbitrary" else {**o["switching"]}
required = contact.get("required")
times = [rules.get("dwell_time", "0"), *(t for _, s in rules.get("stays", []) for t in s.values())]
texts = [item["name"] for item in o.get("roundings", [])]
texts += [item["id"] for item in [*o["assumptions"], contact.get("loss", {"id": ""})]]
need([*map(ratio, times)] and {*map(type, texts)} == {str}, "a field is missing, or odd")
count, every = len(o["modes"]), o["modes"] + contact.get("free", [])
A = {m["name"]: table(m, k, k) for m in every for k in [len(m["numerators"])]}
sizes, names = {*map(len, A.values())}, {*[*A][:count]}
need(count and len(A) == len(every) and {*map(type, A)} == {str}, "odd names")
need(max(sizes) == n and (len(every) > count or "contact" not in o), "odd modes")
uniform, codes, verdict = len(sizes) == 1, {3} if unknown else set(), "inconclusive"
for statement in [item for item in o["statements"] if item["kind"] in kinds]:
    kind, code, words = statement["kind"], 0, "holds"
    try:
        globals()[f"check_{kind}".replace("-", "_")](statement)
        verdict = verdict if kind.startswith("no-") else "proved"
    except NotImplementedError as error:
        code, words = 3, f"not checked here ({error})"
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        code, words = 1, f"DOES NOT HOLD: {error}"
    print(f"{kind}: {words}")
    codes.add(code)
sys.exit(1 if 1 in codes or not codes else 3 if 3 in codes else o["verdict"] != verdict)
