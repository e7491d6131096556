// Decides from the numbers of the certificate in the page whether its statements hold, in integers alone, with no network. What each
// number means, and what must hold, is in docs/certificates/format.md. Vectors are maps from monomials of the states ("2", "0,2"),
// and from what acts beside them ("rounding 1"), to ratios [n, d], or to integers.
const check = (() => {
  class Unchecked extends Error {}
  const need = (truth, words, Kind = Error) => { if (!truth) throw new Kind(words); }, known = (truth, words) => need(truth, words, Unchecked);
  const abs = (x) => (x < 0n ? -x : x), larger = (a, b) => (a > b ? a : b), add = (a, b) => a + b, one = (key) => new Map([[`${key}`, [1n, 1n]]]);
  const gcd = (a, b) => { while (b) [a, b] = [b, a % b]; return abs(a); }, lcm = (a, b) => a / gcd(a, b) * b, range = (n) => [...Array(Number(n)).keys()];
  const times = (A, B) => A.map((row) => B[0].map((_, j) => row.reduce((sum, x, k) => sum + x * B[k][j], 0n)));
  const unit = (n, one = 1n) => range(n).map((i) => range(n).map((j) => (i === j ? one : 0n)));
  const size = (A) => A.map((row) => row.map(abs).reduce(add)).reduce(larger);
  const total = (entries) => entries.reduce((sum, [key, x]) => sum.set(key, (sum.get(key) ?? 0n) + x), new Map());
  const sorted = (...keys) => keys.join().split(",").map(Number).sort((a, b) => a - b).join();
  const multiplied = (left, right) => total([...left].flatMap(([a, x]) => [...right].map(([b, y]) => [sorted(a, b), x * y])));
  function ratio(text) {
    const [n, d = 1n] = /^\d+(\/\d+)?$/.test(text) ? text.split("/").map(BigInt) : [1n, 0n];
    return need(gcd(n, d) === 1n && text === (text.includes("/") && d > 1n ? `${n}/${d}` : `${n}`), "a number is no ratio"), [n, d];
  }
  const distinct = (keys, names) => need(new Set(keys).size === keys.length && keys.every((key) => names.includes(key)), "it names something else, or one twice");
  // JSON whose numbers are integers of any length; texts are marked, so that none of them is taken for a number.
  function parse(text) {
    const marked = text.replace(/"(?:[^"\\]|\\.)*"|-?\d[\d.eE+-]*/g, (m) => (m[0] === '"' ? `"$${m.slice(1)}` : `"${m}"`));
    const unmarked = (v) => Array.isArray(v) ? v.map(unmarked) : typeof v === "string" ? (v[0] === "$" ? v.slice(1) : BigInt(v)) : v && typeof v === "object" ? Object.fromEntries(Object.entries(v).map(([key, x]) => [key.slice(1), unmarked(x)])) : v;
    return unmarked(JSON.parse(marked));
  }
  // Whether the sum of w a'b over terms [w, a, b] of integers is positive (semi)definite: elimination as by Bareiss.
  function definite(terms, semi = false) {
    const at = new Map([...new Set(terms.flatMap(([, a, b]) => [...a.keys(), ...b.keys()]))].map((key, k) => [key, k]));
    let M = range(at.size).map(() => range(at.size).map(() => 0n)), previous = 1n;
    for (const [w, a, b] of terms.map(([w, a, b]) => [w, a, [...b].map(([key, y]) => [at.get(key), w * y])])) if (w) for (const [key, x] of a) if (x) for (const [j, y] of b) M[at.get(key)][j] += x * y;
    if (!M.length || M.some((row, i) => row.some((x, j) => x !== M[j][i]))) return false;
    while (M.length) {
      const k = M.reduce((best, row, i) => ((semi ? row[i] > M[best][best] : row[i] < M[best][best]) ? i : best), 0);
      const pivot = M[k][k], rest = range(M.length).filter((i) => i !== k), next = rest.map(() => []);
      if (pivot <= 0n) return semi && M.every((row) => row.every((x) => !x));
      rest.forEach((i, a) => rest.slice(a).forEach((j, b) => { next[a][a + b] = next[a + b][a] = (pivot * M[i][j] - M[i][k] * M[k][j]) / previous; }));
      [M, previous] = [next, pivot];
    }
    return true;
  }
  // All monomials of a degree as lists of indices, the first state's highest power first.
  const monomials = (n, d, least = 0) => d === 0 ? [[]] : range(n - least).flatMap((i) => monomials(n, d - 1, i + least).map((rest) => [i + least, ...rest]));
  // A form on the monomials of n states; those of the first `kept` states alone.
  function form(rows, n, d = 1, kept = n) {
    const basis = monomials(n, d), chosen = range(basis.length).filter((k) => Math.max(...basis[k]) < kept);
    need(rows.length === basis.length && rows.every((row) => row.length === basis.length), "a form has another size");
    return { basis: chosen.map((k) => basis[k]), rows: chosen.map((i) => chosen.map((j) => rows[i][j])) };
  }
  // Its terms, with every monomial counted in a unit.
  const own = ({ basis, rows }, w, of = () => 1n) => rows.map((row, k) =>
    [w, new Map([[basis[k].join(), of(basis[k])]]), new Map(row.map((x, j) => [basis[j].join(), x * of(basis[j])]))]);
  function table({ numerators: N, denominator: d }, rows, columns) {
    need(d > 0n && N.length === rows && N.every((row) => row.length === columns), "a matrix is of another shape");
    return { N, d };
  }
  const vector = ({ N, d }, i = 0) => new Map(N[i].map((x, j) => [`${j}`, [x, d]]));
  const step = (mode, source, target, A, flow, time) => ({ mode, source, target, n: A.N[0].length, M: A.N.map((_, i) => vector(A, i)), flow, facts: [], over: A.d, time });
  // The terms of what must be positive definite: forms before and after a step, the share that a map keeps (of a flow, twice its rate), multipliers
  // of the facts [name, sign, a, b], of which sign (a z)(b z) adds up to nothing positive, and a form that vanishes; all in units that make integers.
  function terms(s, before, after, keeps, multiplier, vanishing = null) {
    const units = new Map(), facts = s.facts.map(([fact, ...rest]) => [multiplier(fact), ...rest]);
    for (const v of [...s.M, ...facts.flatMap(([, , a, b]) => [a, b])]) for (const [key, [x, d]] of v) units.set(key, lcm(units.get(key) ?? 1n, d / gcd(x, d)));
    const whole = (v) => new Map([...v].map(([key, [x, d]]) => [key, x * units.get(key) / d]));
    const M = s.M.map(whole), of = (a) => a.map((i) => units.get(`${i}`)).reduce((x, y) => x * y), scale = vanishing?.scale ?? 1n;
    const factor = [keeps[1], scale, ...facts.map(([[, d]]) => d)].reduce(lcm), share = factor / keeps[1] * keeps[0];
    const still = (i) => new Map([[`${i}`, units.get(`${i}`)]]), power = (vectors) => vectors.reduce((x, y) => multiplied(x, y));
    const derivative = (a) => total(a.flatMap((_, k) => [...power(a.map((i, j) => (j === k ? M[i] : still(i))))]));
    const moved = s.flow ? before.basis.map(derivative) : after.basis.map((a) => power(a.map((i) => M[i])));
    const image = (row) => total(row.flatMap((w, k) => (w ? [...moved[k]].map(([key, x]) => [key, w * x]) : [])));
    const made = own(before, s.flow ? -share : share, of);
    if (s.flow) made.push(...before.rows.map(image).flatMap((b, k) => [[-factor, made[k][1], b], [-factor, b, made[k][1]]]));
    else made.push(...after.rows.map((row, k) => [-factor, moved[k], image(row)]));
    for (const [[m, d], sign, a, b] of facts) made.push([factor / d * m * sign, whole(a), whole(b)]);
    return vanishing ? [...made, ...own(vanishing, factor / scale, of)] : made;
  }
  // Matrices over two to BITS with a bound on the sums of rows of what they are wrong by.
  const BITS = 1200n, ONE = 1n << BITS;
  const product = ({ N, e }, Y) => ({ N: times(N, Y.N).map((row) => row.map((x) => x >> BITS)), e: (size(N) * Y.e + e * size(Y.N) + e * Y.e >> BITS) + BigInt(N.length) + 1n });
  // exp(A t) by 250 terms of a Taylor series, of an exponent of at most a quarter, and by squaring.
  function exponential({ N, d }, [p, q]) {
    const n = BigInt(N.length), halvings = BigInt((4n * size(N) * p / (d * q) + 4n).toString(2).length);
    const X = { N: N.map((row) => row.map((x) => x * p * ONE / (d * q << halvings))), e: n };
    let E = { N: unit(N.length, ONE), e: 0n };
    const next = (k, { N: rows, e }) => ({ N: rows.map((row, i) => row.map((x, j) => x / k + (i === j ? ONE : 0n))), e: e / k + n + 1n });
    for (let k = 250n; k > 0n; k--) E = next(k, product(X, E));
    E.e += 1n;
    for (let k = 0n; k < halvings; k++) E = product(E, E);
    return E;
  }
  function read(o) {
    const contact = o.contact ?? {}, every = [...o.modes, ...(contact.free ?? [])], n = o.states.length, count = o.modes.length;
    need(["continuous", "discrete"].includes(o.time) && (o.switching === "arbitrary" || o.switching instanceof Object), "its time or switching is odd");
    const S = { o, n, count, flow: o.time === "continuous", rules: o.switching === "arbitrary" ? {} : o.switching, required: contact.required === true };
    S.A = every.map((mode) => table(mode, mode.numerators.length, mode.numerators.length));
    Object.assign(S, { names: every.map((mode) => mode.name), uniform: S.A.every(({ N }) => N.length === n) });
    S.named = (kind) => range((o[`${kind}s`] ?? []).length).map((i) => `${kind} ${i + 1}`);
    need(count && new Set(S.names).size === every.length && S.names.every((name) => typeof name === "string"), "two modes have one name");
    need(S.A.map(({ N }) => N.length).reduce(larger) === n, "the modes have other states");
    need(!o.contact || (every.length > count && S.uniform && n > 1), "contact is lost, but nothing is free");
    need(S.A.slice(count).every(({ N, d }) => N.every((row, i) => row[n - 1] === (i === n - 1 && !S.flow ? d : 0n))), "free, but the deflection acts");
    [S.rules.dwell_time ?? "0", ...(S.rules.stays ?? []).flatMap(([, stay]) => Object.values(stay))].forEach(ratio);
    need([...(o.roundings ?? []).map(({ name }) => name), ...[...o.assumptions, contact.loss ?? { id: "" }].map(({ id }) => id)].every((text) => typeof text === "string"), "a name is missing, or odd");
    known(!contact.pulls, "an environment that could pull");
    known(!o.couplings, "axes that act on each other");
    return S;
  }
  // What mode k does to the state, and to what is active beside it.
  function acting(S, k, active) {
    const { o, n } = S, s = step(S.names[k], "modes", "modes", S.A[k], S.flow, 1);
    need(s.n === n, "modes are of unlike sizes");
    for (const act of active) {
      const [kind, number] = act.split(" "), item = o[`${kind}s`][number - 1], column = table(item.columns[k], n, 1);
      s.M.forEach((row, i) => row.set(act, [column.N[i][0], column.d]));
      s.facts.push([act, 1n, one(act), one(act)]);
      need(item.columns.length === S.A.length && item.rows.length === S.A.length, "a mode has no column or row");
      const keys = [...range(n).map(String), ...S.named("channel")];
      const all = [...vector(table(item.rows[k], 1, keys.length)).values()].map((x, j) => [keys[j], x]);
      need(k < S.count || !all[n - 1][1][0], "free, but the deflection acts");
      const q = new Map(all.filter(([key], j) => j < n || active.includes(key)));
      s.facts.push([act, -1n, q, q]);
    }
    return s;
  }
  // Every step under arbitrary switching, between contact and free motion if contact is lost; where modes take turns, in turn.
  function stepsInContact(S, lost, active) {
    const { n, flow, o: { clock } } = S, last = `${n - 1}`, steps = [], without = (v) => new Map([...v].filter(([key]) => key !== last));
    const left = (s) => ({ ...s, M: s.M.slice(0, -1), target: "free" });
    S.names.slice(0, lost ? undefined : S.count).forEach((_, k) => {
      const s = acting(S, k, active), c = s.M[n - 1];
      if (k < S.count) {
        const facts = [...s.facts, ["lost", 1n, one(last), c], ["lost", 1n, c, one(last)]];
        return steps.push(s, ...(lost && !flow ? [{ ...left(s), facts }] : []));
      }
      const facts = s.facts.map(([fact, sign, a, b]) => [fact, sign, without(a), without(b)]);
      const flight = { ...s, n: n - 1, source: "free", M: s.M.map(without), facts };
      return steps.push(left(flight), ...(flow ? [] : [flight, { ...left(flight), target: "modes" }]));
    });
    if (!clock) return steps;
    const { length, first, more = [], ahead = range(length).map((k) => (k ? [-1n, BigInt(k + 1) % length] : [1n, -1n])) } = clock, named = [first, ...more], groups = [S.names.slice(0, S.count), S.names.slice(S.count)], kind = (name) => named.concat([[name]]).findIndex((own) => own.includes(name)), kinds = named.length + 1, count = (names) => new Set(names.map(kind)).size;
    distinct(named.flat(), S.names);
    need(!flow && length > 1n && S.o.switching === "arbitrary" && ahead.length === Number(length), "modes take turns without steps");
    need(groups.every((names) => !names.length || count(names) === kinds) && (S.o.enclosures ?? []).every((names) => count(names) === 1), "a turn has no mode");
    need(ahead.every((leads) => leads.length === kinds && leads.some((to) => to >= 0n) && leads.every((to) => to >= -1n && to < length)), "an automaton is odd");
    return ahead.flatMap((leads, k) => steps.map((s) => ({ ...s, source: `${s.source} ${k}`, target: `${s.target} ${leads[kind(s.mode)]}` })).filter(({ mode }) => leads[kind(mode)] >= 0n));
  }
  // Every step of a system that keeps rules of switching: its places are the modes.
  function stepsByMode(S, leaving, [p, q]) {
    const steps = [], { transitions, resets = [], stays = [], dwell_time: dwell = "0" } = S.rules, names = S.names.slice(0, S.count);
    need([...stays, ...(transitions ?? [])].every((pair) => pair.length === 2), "a stay or a switch is no pair");
    for (const keys of [leaving, stays.map(([name]) => name), ...resets.map((r) => [r.source, r.target]), ...(transitions ?? [])]) distinct(keys, names);
    names.forEach((name, k) => { if (!leaving.includes(name)) steps.push(step(name, name, name, S.A[k], S.flow, 1)); });
    names.forEach((a, k) => names.forEach((b, l) => {
      if (a === b || (transitions && !transitions.some(([from, to]) => from === a && to === b))) return;
      const { N, d } = S.A[k], n = N.length, ways = resets.filter((r) => r.source === a && r.target === b), left = leaving.includes(a);
      const own = new Map(stays).get(a) ?? { shortest: dwell }, shortest = ratio(own.shortest ?? "0"), first = S.flow || shortest[0] >= shortest[1] ? shortest : [1n, 1n];
      const last = left ? ratio(own.longest) : first;
      need(first[0] * last[1] <= last[0] * first[1] && (S.flow || first[1] * last[1] === 1n), "a stay is odd");
      known(last[0] <= 4096n * last[1], "so long a stay");
      for (const reset of ways.length ? ways : [null]) {
        let jump = reset ? table(reset, S.A[l].N.length, n) : { N: unit(n), d: 1n };
        need(jump.N.length === S.A[l].N.length, "a switch has no reset that fits");
        if (S.flow) {
          const shifted = N.map((row, i) => row.map((x, j) => x * q + (i === j ? p * d : 0n)));
          const E = first[0] ? exponential({ N: shifted, d: d * q }, first) : { N: unit(n, ONE), e: 0n }, error = [E.e * size(jump.N), ONE * jump.d];
          need(error[0] < error[1], "an exponential is too large");
          steps.push({ ...step(a, a, b, { N: times(jump.N, E.N), d: error[1] }, false, 0), error, facts: range(n).map((i) => ["error", -1n, one(i), one(i)]) });
        }
        for (let count = 1n; !S.flow && count <= last[0]; count++) {
          jump = { N: times(jump.N, N), d: jump.d * d };
          if (count >= first[0]) steps.push(step(a, a, b, jump, false, Number(count)));
        }
      }
    }));
    return steps;
  }
  // What an error of M in a step does to the function after it, at most.
  function wrong({ n, M, error }, { rows }) {
    const most = M.flatMap((v) => [...v.values()].map(([x, d]) => abs(x) / d + 1n)).reduce(larger);
    return [error[0] * BigInt(Math.max(n, M.length)) ** 3n * rows.flat().map(abs).reduce(larger) * (2n * most + 1n), error[1]];
  }
  // A form that must vanish for all states, with what it was multiplied by.
  function vanish(s, N, d, [p, q], rate) {
    const sum = total(N.rows.flatMap((row, i) => row.map((x, j) => [sorted(N.basis[i], N.basis[j]), x]))).values();
    need([...sum].every((x) => !x), "a form that must vanish does not");
    const below = s.M.flatMap((v) => [...v.values()].map(([x, e]) => e / gcd(x, e))).reduce(lcm);
    return { ...N, scale: s.flow ? s.over * (q / gcd(p * s.over, q)) : (below * rate[1] ** BigInt(s.time)) ** BigInt(2 * d) };
  }
  function graph(S, o) {
    const { stays, degree = 1n, multipliers = [], nodes } = o, d = Number(degree), rate = ratio(o.rate), added = [...(o.vanishing ?? [])];
    known(!("edges" in o) && !(S.flow && stays?.leaving?.length), "edges to some nodes, or stays of any length in continuous time");
    need(d >= 1 && rate[0] > 0n && (S.flow || rate[0] < rate[1]), "the rate is none of decay");
    const rounds = multipliers.some(({ fact }) => fact.startsWith("rounding")), { clock } = S.o;
    const lost = !stays && nodes.some(({ place }) => place.startsWith("free")), active = rounds ? S.named("rounding") : [];
    const steps = stays ? stepsByMode(S, stays.leaving ?? [], rate) : stepsInContact(S, lost, active);
    const sizes = Object.fromEntries(steps.map((s) => [s.source, s.n])), places = new Set(nodes.map(({ place }) => place));
    need(places.size === Object.keys(sizes).length && [...steps.flatMap((s) => [s.source, s.target]), ...(stays ? S.names.slice(0, S.count) : [])].every((place) => places.has(place)), "a place has no form, or no step");
    need(nodes.length === places.size || !S.flow, "there are more forms than places");
    const whole = stays ? !(S.required || clock || S.rules.fixed_ends || multipliers.length || (S.flow && d > 1)) : !S.rules.resets && (lost || !S.required);
    need(whole && (d === 1 || !(multipliers.length || (lost && !S.flow))), "contact, turns, resets or what is between the ends of a range is not covered");
    const facts = new Set(steps.flatMap((s) => s.facts.map(([fact]) => fact))), values = new Map();
    for (const { fact, value, target = null } of multipliers) {
      need(facts.has(fact) && fact !== "error" && value >= 0n && !values.has(`${fact}/${target}`), "a multiplier is odd");
      values.set(`${fact}/${target}`, value);
    }
    for (const node of nodes) need(definite(own(form(node.form, sizes[node.place], d), 1n)), `a form at ${node.place} is not positive definite`);
    const flat = new Map(nodes.filter(() => lost && S.flow).map((node) => [`${node.place.split(" ")[1]}/${form(node.form, sizes[node.place], d, S.n - 1).rows.join()}`, 1]));
    need(flat.size <= (lost && S.flow ? 1 : 0), "it jumps where contact is lost");
    for (const s of steps) for (const from of nodes) nodes.forEach((to, b) => {
      if (from.place !== s.source || to.place !== s.target) return;
      const after = form(to.form, sizes[s.target], d, s.M.length), power = BigInt(2 * d * s.time);
      const keeps = s.flow ? [2n * degree * rate[0], rate[1]] : [rate[0] ** power, rate[1] ** power];
      const m = (fact) => (fact === "error" ? wrong(s, after) : [values.get(`${fact}/${b}`) ?? values.get(`${fact}/null`) ?? 0n, 1n]);
      const vanishing = d > 1 && s.time ? vanish(s, form(added.shift() ?? [], s.n, d), d, keeps, rate) : null;
      need(definite(terms(s, form(from.form, sizes[s.source], d), after, keeps, m, vanishing), !s.time), `it rises in mode ${s.mode}`);
    });
    need(!added.length, "more forms vanish than there are steps");
    const shown = S.flow ? `exp(-alpha t) with alpha = ${o.rate} 1/s` : `rho^t with rho = ${o.rate} per step`;
    return `decay like ${shown}${lost ? ", through loss of contact" : ""}${rounds ? ", with rounding" : ""}`;
  }
  function noCommonQuadratic(S, { factors }) {
    distinct(factors.map(([name]) => name), S.names.slice(0, S.count));
    need(S.uniform && factors.every(([, L]) => L.length === S.n), "the factors are not those of modes");
    need(factors.every(([, L, ...more]) => L.every((row) => row.length === L[0].length) && !more.length), "a factor has no shape");
    const used = factors.map(([name, L]) => [S.A[S.names.indexOf(name)], L]), common = used.map(([{ d }]) => d).reduce(lcm);
    need(definite(used.flatMap(([{ N, d }, L]) => L[0].flatMap((_, j) => {
      const x = L.map((row) => [row[j]]), [X, Y] = [x, times(N, x)].map((v) => new Map(v.map(([e], i) => [i, e]))), w = common / d;
      return S.flow ? [[w, X, Y], [w, Y, X]] : [[w * w, Y, Y], [-common * common, X, X]];
    }))), "the sum over the modes is not positive definite");
    return "no common quadratic function exists";
  }
  const CHECKS = { graph: [graph, "proved"], "no-common-quadratic": [noCommonQuadratic, ""] };
  // For every statement of a certificate: whether it holds (null: not checked here), and what it says or why not.
  return (text) => {
    const o = parse(text), shown = new Set();
    need(o.schema === "nrs-design/certificate/9" && o.statements.length, "it is of another schema, or says nothing");
    const results = o.statements.map(({ kind, ...statement }) => {
      try {
        known(Object.hasOwn(CHECKS, kind), "this kind");
        const [decide, verdict] = CHECKS[kind], words = decide(read(o), statement);
        return shown.add(verdict) && [true, words];
      } catch (error) { return [error instanceof Unchecked ? null : false, `${kind} (${error.message})`]; }
    });
    return { results, agrees: o.verdict === (shown.has("proved") ? "proved" : "inconclusive"), modes: o.modes.length, free: o.contact?.free?.length ?? 0 };
  };
})();
