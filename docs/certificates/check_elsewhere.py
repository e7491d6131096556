"""Re-check a certificate of nrs-design, schema 8, with nothing but Python's own integers.

Usage: python check_elsewhere.py CERTIFICATE.json. Exit code: 0 if every statement holds, 1 if one
does not, 3 if one is not checked here. format.md says what each number means and what must hold.
The sentences are not read; whose modes the file holds is what `nrs-design verify` adds.

Vectors have an entry by key: monomials of the states, such as (2,) for the third state, and names
of what acts beside them. Matrices and forms have a vector by monomial.
"""

import hashlib
import json
import sys
from collections import Counter, namedtuple
from fractions import Fraction as F
from itertools import combinations_with_replacement, product
from math import lcm

# M z comes after z, of which n entries are the state, or is its derivative in a flow. Facts are
# (name, a, b): of each name, all (a z)(b z) add up to nothing positive.
Step = namedtuple("Step", "mode source target n M flow facts over time")


def need(truth, words, error=ValueError):
    if not truth:
        raise error(words)


def definite(terms, semi=False):
    """Tell whether the sum of w a'b over terms (w, a, b) is positive (semi)definite.

    Every entry is counted in its least whole unit, and eliminated without fractions (Bareiss).
    """
    units, factor, whole = {}, lcm(*(F(w).denominator for w, *_ in terms)), Counter()
    for key, x in (entry for _, *pair in terms for v in pair for entry in v.items()):
        units[key] = lcm(units.get(key, 1), F(x).denominator)
    for w, *pair in terms:
        a, b = ([(key, int(x * units[key])) for key, x in v.items() if x] for v in pair)
        for (i, x), (j, y) in product(a, b):
            whole[i, j] += int(w * factor) * x * y
    M, previous = [[whole[i, j] for j in units] for i in units], 1
    if not M or [list(column) for column in zip(*M, strict=True)] != M:
        return False
    while M:
        k = (max if semi else min)(range(len(M)), key=lambda i: M[i][i])
        pivot, rest = M[k][k], [i for i in range(len(M)) if i != k]
        if pivot <= 0:
            return semi and not any(map(any, M))
        M = [[(pivot * M[i][j] - M[i][k] * M[k][j]) // previous for j in rest] for i in rest]
        previous = pivot
    return True


def combined(row, vectors):
    """Return the sum of vectors, each with the weight that a row has for its key."""
    result = Counter()
    for key, weight in row.items():
        for other, entry in vectors[key].items():
            result[other] += weight * entry
    return result


def composed(left, right):
    return {i: combined(row, right) for i, row in left.items()}


def table(o, rows, columns):
    """Read a matrix of a shape."""
    N, q = o["numerators"], o["denominator"]
    need(q > 0 and len(N) == rows and {*map(len, N)} == {columns}, "a matrix is of another shape")
    return {(i,): {(j,): F(x, q) for j, x in enumerate(row)} for i, row in enumerate(N)}


def form(rows, n, d=1, kept=64):
    """Read a form on the monomials of n states; those of the first states are kept."""
    basis = list(combinations_with_replacement(range(n), d))
    full = {a: dict(zip(basis, row, strict=True)) for a, row in zip(basis, rows, strict=True)}
    return {a: {b: full[a][b] for b in basis if max(b) < kept} for a in basis if max(a) < kept}


def left(s, before, after, keeps):
    """Return the terms of what is left of a form before a step without that after it."""
    terms = [(keeps * (-1) ** s.flow, a, row) for _, a, row in terms_of(before)]
    if not s.flow:
        return terms + [(-1, s.M[a], combined(row, s.M)) for a, row in after.items()]
    moved = {a: Counter() for a in before}
    for a, k in ((a, k) for a in before for k in range(len(a))):
        for key, x in s.M[a[k],].items():
            moved[a][tuple(sorted((*a[:k], *a[k + 1 :], *key))) if a[1:] else key] += x
    images = composed(before, moved)
    return terms + [(-1, *p) for a in before for p in (({a: 1}, images[a]), (images[a], {a: 1}))]


def terms_of(form):
    return [(1, {a: 1}, row) for a, row in form.items()]


def exponential(A, t):
    """Return the exponential of A t, and a bound on what a row of it is wrong by, in all."""
    size, k, bound = t * max(sum(map(abs, row.values())) for row in A.values()), 0, F(1)
    E = term = {i: {i: F(1)} for i in A}
    while k < 2 * size or bound > F(1, 2**300):
        k, bound = k + 1, bound * size / (k + 1)
        term = composed({i: {j: x * t / k for j, x in row.items()} for i, row in A.items()}, term)
        E = {i: combined({0: 1, 1: 1}, [E[i], term[i]]) for i in A}
    return E, bound  # Of the terms left, each is at most half of the one before


class System:
    """The modes of a certificate, and the steps that they may take."""

    def __init__(self, o):
        contact, self.n, self.flow = (
            o.get("contact", {}),
            len(o["states"]),
            o["time"] == "continuous",
        )
        self.o, self.count, self.every = o, len(o["modes"]), o["modes"] + contact.get("free", [])
        self.rules = {} if o["switching"] == "arbitrary" else o["switching"]
        sizes = [len(mode["numerators"]) for mode in self.every]
        self.A = {m["name"]: table(m, k, k) for m, k in zip(self.every, sizes, strict=True)}
        need(self.count and len(self.A) == len(sizes), "two modes have one name")
        need(not contact or len(sizes) > self.count, "contact is lost, but nothing is free")
        self.uniform, self.required = {*sizes} == {self.n}, contact.get("required")
        self.foreign = "clock" in o or "pulls" in contact

    def named(self, *kinds):
        return [f"{kind} {i + 1}" for kind in kinds for i in range(len(self.o.get(f"{kind}s", [])))]

    def acting(self, k, active):
        """Return what mode k does to the state and to what is active beside it."""
        mode, facts, n, last = self.every[k], [], self.n, (self.n - 1,)
        M = {i: {**row} for i, row in self.A[mode["name"]].items()}
        for act in active:
            kind, number = act.split()
            item = self.o[f"{kind}s"][int(number) - 1]
            keys = [*M, *self.named("channel", *["rounding"] * (kind == "coupling"))]
            q = dict(zip(keys, table(item["rows"][k], 1, len(keys))[0,].values(), strict=True))
            q = {key: x for key, x in q.items() if key in M or key in active}
            for i, entry in table(item["columns"][k], n, 1).items():
                M[i][act] = entry[0,]
            facts += [(act, {act: 1}, {act: 1}), (act, {key: -x for key, x in q.items()}, q)]
        if k >= self.count:
            rows = [*M.values(), *(v for _, *pair in facts for v in pair)]
            still = [row.pop(last, 0) for row in rows]
            need(
                still == [0] * (n - 1) + [1 - self.flow] + [0] * 2 * len(facts), "free, but pushed"
            )
        return Step(mode["name"], "modes", "modes", n, M, self.flow, facts, mode["denominator"], 1)

    def steps_in_contact(self, lost, active):
        """Yield every step under arbitrary switching, between contact and flight if it is lost."""
        need(self.uniform and not self.rules.get("resets"), "resets are not covered")
        for k in range(len(self.every) if lost else self.count):
            s, last = self.acting(k, active), (self.n - 1,)
            rows = {i: row for i, row in s.M.items() if i != last}
            if k < self.count:
                yield s
                crossing = [("lost", {last: 1}, s.M[last]), ("lost", s.M[last], {last: 1})]
                if lost and not self.flow:
                    yield s._replace(M=rows, target="free", facts=s.facts + crossing)
            else:
                s = s._replace(n=self.n - 1, source="free")
                yield s._replace(M=rows, target="free")
                yield from [] if self.flow else [s, s._replace(M=rows)]

    def steps_by_mode(self, leaving, rate):
        """Yield every step of a system that keeps rules of switching; its places are the modes."""
        rules, maps = self.rules, {}
        for reset in rules.get("resets", []):
            maps.setdefault((reset["source"], reset["target"]), []).append(reset)
        for name, A in self.A.items():
            if name not in leaving:
                yield Step(name, name, name, len(A), A, self.flow, [], 1, 1)
        for a, b in product(self.A, self.A):
            if a == b or [a, b] not in rules.get("transitions", [[a, b]]):
                continue
            A, stay = self.A[a], {"shortest": rules.get("dwell_time", 0)}
            stay = dict(rules.get("stays", [])).get(a, stay)
            first = max(F(stay.get("shortest", 0)), not self.flow)
            last = F(stay["longest"]) if a in leaving else first
            need(0 <= first <= last and (self.flow or first % 1 == last % 1 == 0), "odd stays")
            need(not (self.flow and a in leaving), "stays of any length", NotImplementedError)
            for reset in maps.get((a, b), [None]):
                jump = table(reset, len(self.A[b]), len(A)) if reset else {i: {i: F(1)} for i in A}
                need(jump.keys() == self.A[b].keys(), "a switch has no reset that fits")
                if self.flow:
                    E, error = exponential({i: {**A[i], i: A[i][i] + rate} for i in A}, first)
                    error *= max(sum(map(abs, row.values())) for row in jump.values())
                    wrong, jump = [("error", {i: -error}, {i: 1}) for i in A], composed(jump, E)
                    yield Step(a, a, b, len(A), jump, False, wrong, 1, 0)
                for count in range(1, 1 + int(last) * (not self.flow)):
                    jump = composed(jump, A)
                    if count >= first:
                        yield Step(a, a, b, len(A), jump, False, [], 1, count)


def check_graph(S, o):
    """Check that every step leads from every form to smaller ones."""
    stays, d, rate, added = o.get("stays"), o.get("degree", 1), F(o["rate"]), o.get("vanishing", [])
    nodes = [(k, node["place"], node["form"]) for k, node in enumerate(o["nodes"])]
    values = {(m["fact"], m.get("target")): m["value"] for m in o.get("multipliers", [])}
    covered = {fact.split()[0] for fact, _ in values}
    lost = stays is None and "free" in [place for _, place, _ in nodes]
    plain = not S.foreign and "edges" not in o and (d == 1 or (S.flow and stays is None))
    need(plain, "turns, pulls, edges", NotImplementedError)
    need(d >= 1 and 0 < rate and (S.flow or rate < 1), "the rate is none of decay")
    active = S.named(*(kind for kind in ("rounding", "coupling") if kind in covered))
    if stays is None:
        steps = list(S.steps_in_contact(lost, active))
        need(lost or not S.required, "the loss of contact is not covered")
        need("coupling" in covered or "couplings" not in S.o, "other axes are not covered")
    else:
        steps = list(S.steps_by_mode(stays.get("leaving", []), rate))
        need(not (values or S.required or "couplings" in S.o), "more than switching is not covered")
        need("fixed_ends" not in S.rules, "what is between the ends of a range is not covered")
    sizes, facts = {s.source: s.n for s in steps}, {fact for s in steps for fact, *_ in s.facts}
    need({*sizes} == {p for _, p, _ in nodes} >= {s.target for s in steps}, "a place has no form")
    need(len(nodes) == len(sizes) or not (S.flow or "coupling" in covered), "there are more forms")
    need(all(m >= 0 and f in facts - {"error"} for (f, _), m in values.items()), "odd multipliers")
    need(len(values) == len(o.get("multipliers", [])) and (d == 1 or not values), "odd multipliers")
    need(all(to is None or f[:8] != "coupling" for f, to in values), "odd multipliers")
    for _, place, rows in nodes:
        need(definite(terms_of(form(rows, sizes[place], d))), f"a form at {place} is not positive")
    if lost and S.flow:
        flat = [form(rows, sizes[place], d, S.n - 1) for _, place, rows in nodes]
        need(flat[0] == flat[1], "it jumps where contact is lost")
    for s, (_, source, rows), (b, target, others) in product(steps, nodes, nodes):
        if (source, target) != (s.source, s.target):
            continue
        keeps = 2 * d * rate if s.flow else rate ** (2 * s.time)
        after = form(others, sizes[target], d, len(s.M))
        terms = left(s, form(rows, sizes[source], d), after, keeps)
        G, M = (max(abs(x) for v in A.values() for x in v.values()) for A in (after, s.M))
        wrong = max(s.n, len(s.M)) ** 3 * G * (2 * M + 1)  # What an error of M does, at most
        for f, x, y in s.facts:
            terms.append(
                (wrong if f == "error" else values.get((f, b), values.get((f, None), 0)), x, y)
            )
        if d > 1:
            N, total, scale = form(added.pop(0), s.n, d), Counter(), (keeps * s.over).denominator
            for u, v in product(N, N):
                total[tuple(sorted(u + v))] += N[u][v]
            need(not any(total.values()), "a form does not vanish")
            terms += [(F(1, scale * s.over), x, y) for _, x, y in terms_of(N)]
        need(definite(terms, semi=not s.time), f"it rises in mode {s.mode}")
    need(not added, "more forms vanish than there are steps")


def check_no_common_quadratic(S, o):
    terms = []
    for name, L in o["factors"]:
        for column in zip(*L, strict=True):
            x = dict(zip(S.A[name], column, strict=True))
            y = {i: sum(a * x[j] for j, a in row.items()) for i, row in S.A[name].items()}
            terms += [(1, y, x), (1, x, y)] if S.flow else [(1, y, y), (-1, x, x)]
    need(S.uniform and definite(terms), "the sum over the modes is not positive definite")


def check_parameter_quadratic(S, o):
    """Check both forms, and three sums for the two ends of every mode."""
    Q, rate, ends = (
        [form(o[end], S.n) for end in ("low", "high")],
        F(o["rate"]),
        S.rules["fixed_ends"],
    )
    need(S.flow and rate > 0 and sorted(sum(ends, [])) == sorted(S.A), "the modes are not ends")
    steps = {s.mode: s for s in S.steps_in_contact(False, [])}
    need(not (S.foreign or S.required or "couplings" in S.o), "more is not covered")
    for a, b in ends:
        low, high = ([left(steps[end], q, q, 2 * rate) for q in Q] for end in (a, b))
        for terms in (*map(terms_of, Q), low[0], high[1], low[1] + high[0]):
            need(definite(terms), f"it rises between {a} and {b}")


def main(path):
    with open(path, encoding="utf-8") as file:
        o = json.load(file)
    signed = {key: o[key] for key in o.keys() - {"id", "origin"}}
    text = json.dumps(signed, sort_keys=True, separators=(",", ":"))
    if hashlib.sha256(text.encode()).hexdigest() != o["id"]:
        sys.exit("it was altered")
    checks = {
        "graph": (check_graph, "proved"),
        "no-common-quadratic": (check_no_common_quadratic, "inconclusive"),
        "parameter-quadratic": (check_parameter_quadratic, "proved"),
    }
    codes, verdicts = set(), set()
    for statement in o["statements"]:
        kind = statement["kind"]
        try:
            need(kind in checks, "this kind", NotImplementedError)
            checks[kind][0](System(o), statement)
            code, words = 0, "holds"
            verdicts.add(checks[kind][1])
        except NotImplementedError as error:
            code, words = 3, f"not checked here: {error}"
        except (ArithmeticError, LookupError, TypeError, ValueError) as error:
            code, words = 1, f"DOES NOT HOLD: {error}"
        codes.add(code)
        print(f"{kind}: {words}")
    return next(
        code for code in (1, 3, int(o["verdict"] != max(verdicts))) if code in codes or not code
    )


sys.exit(main(sys.argv[1]))
