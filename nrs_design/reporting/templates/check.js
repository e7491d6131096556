// Decides from the numbers of the certificate in the page whether its statements hold: integers
// only, no network. What each number means, and what must hold, is docs/certificates/format.md.
// A vector has entries by key: monomials of the states ("2", "0,2") and what acts beside them.
const check = (() => {
  class Unchecked extends Error {}
  const need = (truth, words) => { if (!truth) throw new Error(words); };
  const known = (truth, words) => { if (!truth) throw new Unchecked(words); };
  const abs = (x) => (x < 0n ? -x : x);
  const gcd = (a, b) => { while (b) [a, b] = [b, a % b]; return abs(a); };
  const lcm = (a, b) => a / gcd(a, b) * b;
  const range = (n) => [...Array(Number(n)).keys()];
  const times = (A, B) => A.map((row) => B[0].map((_, j) => row.reduce((sum, x, k) => sum + x * B[k][j], 0n)));
  const unit = (n, one = 1n) => range(n).map((i) => range(n).map((j) => (i === j ? one : 0n)));
  const size = (A) => A.map((row) => row.reduce((sum, x) => sum + abs(x), 0n)).reduce((a, b) => (a > b ? a : b));

  function ratio(text) {
    need(typeof text === "string" && /^\d+(\/\d+)?$/.test(text), "a number is no ratio");
    const [n, d = 1n] = text.split("/").map(BigInt);
    need(d > 0n, "a number is no ratio");
    return [n / gcd(n, d), d / gcd(n, d)];
  }

  // JSON whose numbers are integers of any length; texts are marked, so that no text is taken for one.
  function parse(text) {
    const marked = text.replace(/"(?:[^"\\]|\\.)*"|-?\d[\d.eE+-]*/g, (m) => (m[0] === '"' ? `"$${m.slice(1)}` : `"${m}"`));
    const plain = (v) => Array.isArray(v) ? v.map(plain)
      : typeof v === "string" ? (v[0] === "$" ? v.slice(1) : BigInt(v))
        : v && typeof v === "object" ? Object.fromEntries(Object.entries(v).map(([k, x]) => [k.slice(1), plain(x)])) : v;
    return plain(JSON.parse(marked));
  }

  // Whether the sum of w a'b over terms [w, a, b] is positive (semi)definite: elimination as by Bareiss.
  function definite(terms, semi = false) {
    const at = new Map([...new Set(terms.flatMap(([, a, b]) => [...a.keys(), ...b.keys()]))].map((key, k) => [key, k]));
    let M = range(at.size).map(() => range(at.size).map(() => 0n)), previous = 1n;
    for (const [w, a, b] of terms) for (const [i, x] of a) if (w * x) for (const [j, y] of b) M[at.get(i)][at.get(j)] += w * x * y;
    if (!M.length || M.some((row, i) => row.some((x, j) => x !== M[j][i]))) return false;
    while (M.length) {
      const k = M.reduce((best, row, i) => ((semi ? row[i] > M[best][best] : row[i] < M[best][best]) ? i : best), 0);
      const pivot = M[k][k], rest = range(M.length).filter((i) => i !== k), next = rest.map(() => []);
      if (pivot <= 0n) return semi && M.every((row) => row.every((x) => !x));
      rest.forEach((i, a) => rest.slice(a).forEach((j, b) => {
        next[a][a + b] = next[a + b][a] = (pivot * M[i][j] - M[i][k] * M[k][j]) / previous;
      }));
      [M, previous] = [next, pivot];
    }
    return true;
  }

  function combined(weights, vectors) {
    const sum = new Map();
    weights.forEach((w, k) => { if (w) for (const [key, x] of vectors[k]) sum.set(key, (sum.get(key) ?? 0n) + w * x); });
    return sum;
  }

  const sorted = (key) => key.split(",").map(Number).sort((a, b) => a - b).join();

  function multiplied(left, right) {
    const product = new Map();
    for (const [a, x] of left) for (const [b, y] of right) {
      const key = sorted(`${a},${b}`);
      product.set(key, (product.get(key) ?? 0n) + x * y);
    }
    return product;
  }

  // All monomials of a degree, the first state's highest power first, as lists of indices.
  const monomials = (n, d, least = 0) => d === 0 ? [[]]
    : range(n - least).flatMap((i) => monomials(n, d - 1, i + least).map((rest) => [i + least, ...rest]));

  // A form on the monomials of n states; those of the first `kept` states alone.
  function form(rows, n, d = 1, kept = n) {
    const basis = monomials(n, d), chosen = range(basis.length).filter((k) => Math.max(...basis[k]) < kept);
    need(rows.length === basis.length && rows.every((row) => row.length === basis.length), "a form has another size");
    return { basis: chosen.map((k) => basis[k]), rows: chosen.map((i) => chosen.map((j) => rows[i][j])) };
  }

  const plain = ({ basis, rows }) => rows.map((row, k) => [1n, new Map([[basis[k].join(), 1n]]), new Map(row.map((x, j) => [basis[j].join(), x]))]);
  const positive = (Q) => definite(plain(Q));

  function table(o, rows, columns) {
    const { numerators: N, denominator: d } = o;
    need(d > 0n && N.length === rows && N.every((row) => row.length === columns), "a matrix is of another shape");
    return { N, d };
  }

  const vector = ({ N, d }, i = 0) => new Map(N[i].map((x, j) => [`${j}`, [x, d]]));
  const step = (mode, source, target, A, flow, time) =>
    ({ mode, source, target, n: A.N[0].length, M: A.N.map((_, i) => vector(A, i)), flow, facts: [], over: A.d, time });

  // The terms of what must be positive definite: forms before and after a step, the share that a map
  // keeps (of a flow, twice its rate), multipliers of the facts as ratios, and what vanishes.
  function terms(s, before, after, keeps, multiplier = () => [0n, 1n], vanishing = null) {
    const units = new Map(), facts = s.facts.map(([fact, ...rest]) => [multiplier(fact), ...rest]).filter(([[m]]) => m);
    for (const v of [...s.M, ...facts.flatMap(([, , a, b]) => [a, b])]) for (const [key, [x, d]] of v) units.set(key, lcm(units.get(key) ?? 1n, d / gcd(x, d)));
    const whole = (v) => new Map([...v].map(([key, [x, d]]) => [key, x * units.get(key) / d]));
    const M = s.M.map(whole), of = (a) => a.reduce((product, i) => product * units.get(`${i}`), 1n);
    const own = ({ basis, rows }) => rows.map((row, k) => [new Map([[basis[k].join(), of(basis[k])]]), new Map(row.map((x, j) => [basis[j].join(), x * of(basis[j])]))]);
    const scale = vanishing ? vanishing.scale : 1n;
    const factor = [keeps[1], scale, ...facts.map(([[, d]]) => d)].reduce(lcm), share = factor / keeps[1] * keeps[0];
    const ways = (a) => (s.flow ? a.map((_, k) => a.map((i, j) => (j === k ? M[i] : new Map([[`${i}`, units.get(`${i}`)]])))) : [a.map((i) => M[i])]);
    const image = (a) => { const all = ways(a).map((way) => way.reduce(multiplied)); return combined(all.map(() => 1n), all); };
    const moved = (s.flow ? before : after).basis.map(image);
    const made = own(before).map(([a, row]) => [s.flow ? -share : share, a, row]);
    if (s.flow) {
      before.rows.forEach((row, k) => { const [, a] = made[k], b = combined(row, moved); made.push([-factor, a, b], [-factor, b, a]); });
    }
    if (!s.flow) after.rows.forEach((row, k) => made.push([-factor, moved[k], combined(row, moved)]));
    for (const [[m, d], sign, a, b] of facts) made.push([factor / d * m * sign, whole(a), whole(b)]);
    if (vanishing) for (const [a, row] of own(vanishing)) made.push([factor / scale, a, row]);
    return made;
  }

  // Matrices over two to BITS with a bound on the sums of rows of what they are wrong by.
  const BITS = 1200n, ONE = 1n << BITS;
  const ball = ({ N, d }) => ({ N: N.map((row) => row.map((x) => x * ONE / d)), e: BigInt(N.length) });
  const product = (X, Y) => ({
    N: times(X.N, Y.N).map((row) => row.map((x) => x >> BITS)),
    e: (size(X.N) * Y.e + X.e * size(Y.N) + X.e * Y.e >> BITS) + BigInt(X.N.length) + 1n,
  });
  // exp(A t) by a Taylor series of 250 terms, of an exponent of at most a quarter, and squaring.
  function exponential({ N, d }, [p, q]) {
    const n = BigInt(N.length), halvings = BigInt((4n * size(N) * p / (d * q) + 4n).toString(2).length);
    const X = ball({ N: N.map((row) => row.map((x) => x * p)), d: d * q << halvings });
    let E = { N: unit(N.length, ONE), e: 0n };
    for (let k = 250n; k > 0n; k--) {
      const next = product(X, E);
      E = { N: next.N.map((row, i) => row.map((x, j) => x / k + (i === j ? ONE : 0n))), e: next.e / k + n + 1n };
    }
    E.e += 1n; // The terms from the 251st on
    for (let k = 0n; k < halvings; k++) E = product(E, E);
    return E;
  }

  function read(o) {
    const contact = o.contact ?? {}, every = [...o.modes, ...(contact.free ?? [])], n = o.states.length, count = o.modes.length;
    need(["continuous", "discrete"].includes(o.time), "its time is odd");
    const S = { o, n, count, every, flow: o.time === "continuous", rules: o.switching === "arbitrary" ? {} : o.switching };
    S.A = every.map((mode) => table(mode, mode.numerators.length, mode.numerators.length));
    S.names = every.map((mode) => mode.name);
    need(count && new Set(S.names).size === every.length, "two modes have one name");
    S.uniform = S.A.every(({ N }) => N.length === n);
    S.pulls = (contact.pulls ?? []).map((q) => table(q, 1, n));
    need(!o.contact || (every.length > count && S.uniform && n > 1), "contact is lost, but nothing is free");
    for (const { N, d } of S.A.slice(count)) need(N.every((row, i) => row[n - 1] === (i === n - 1 && !S.flow ? d : 0n)), "free, but the deflection acts");
    S.required = contact.required === true;
    S.losable = S.required || "flights" in o;
    S.named = (kind) => range((o[`${kind}s`] ?? []).length).map((i) => `${kind} ${i + 1}`);
    S.fixed = S.rules.fixed_ends ?? [];
    need(!S.fixed.length || S.fixed.flat().sort().join("\n") === S.names.slice(0, count).sort().join("\n"), "the modes are not the ends of a parameter");
    return S;
  }

  // What mode k does to the state, and to what is active beside it.
  function acting(S, k, active) {
    const { o, n } = S, s = step(S.names[k], "modes", "modes", S.A[k], S.flow, 1), one = (act) => new Map([[act, [1n, 1n]]]);
    need(S.A[k].N.length === n, "modes are of unlike sizes");
    for (const act of active) {
      const [kind, number] = act.split(" "), item = o[`${kind}s`][number - 1], column = table(item.columns[k], n, 1);
      s.M.forEach((row, i) => row.set(act, [column.N[i][0], column.d]));
      s.facts.push([act, 1n, one(act), one(act)]);
      if (kind === "channel") continue;
      const keys = [...range(n).map(String), ...S.named("channel"), ...(kind === "coupling" ? S.named("rounding") : [])];
      const all = [...vector(table(item.rows[k], 1, keys.length)).values()].map((x, j) => [keys[j], x]);
      need(k < S.count || !all[n - 1][1][0], "free, but the deflection acts");
      const q = new Map(all.filter(([key], j) => j < n || active.includes(key)));
      s.facts.push([act, -1n, q, q]);
    }
    return s;
  }

  const without = (v, key) => new Map([...v].filter(([other]) => other !== key));

  // Every step under arbitrary switching, between contact and free motion if contact is lost.
  function stepsInContact(S, lost, active) {
    const { n, flow } = S, last = `${n - 1}`, steps = [], delta = new Map([[last, [1n, 1n]]]);
    const crossing = (s, ...known) => ({ ...s, facts: [...s.facts, ...known.flatMap(([fact, c]) => [[fact, 1n, delta, c], [fact, 1n, c, delta]])] });
    const left = (s) => ({ ...s, M: s.M.slice(0, -1), target: "free" });
    need(S.uniform, "modes are of unlike sizes");
    S.every.forEach((mode, k) => {
      const s = acting(S, k, active);
      if (k < S.count) return steps.push(s, ...(lost && !flow ? [crossing(left(s), ["lost", s.M[n - 1]])] : []));
      if (!lost) return 0;
      const flight = { ...s, n: n - 1, source: "free", M: s.M.map((v) => without(v, last)), facts: s.facts.map(([f, w, a, b]) => [f, w, without(a, last), without(b, last)]) };
      steps.push(left(flight), ...(flow ? [] : [flight, { ...left(flight), target: "modes" }]));
      S.pulls.forEach((q, i) => {
        const pull = `pull ${i + 1}`, whole = vector({ N: q.N, d: 1n });
        steps.push(...(flow ? [crossing(s, [`${pull} ${s.mode}`, vector(q)])]
          : [crossing(s, [pull, whole]), crossing(left(s), [`${pull} lost`, whole], [`lost ${pull}`, s.M[n - 1]])]));
      });
      return 0;
    });
    return steps;
  }

  function stepsInTurns(S, lost, active) {
    const steps = stepsInContact(S, lost, active), { length, first } = S.o.clock ?? {};
    if (!S.o.clock) return steps;
    need(!S.flow && length > 1n && S.o.switching === "arbitrary", "modes take turns without steps");
    return range(length).flatMap((k) => steps.filter((s) => first.includes(s.mode) === (k === 0))
      .map((s) => ({ ...s, source: `${s.source} ${k}`, target: `${s.target} ${(k + 1) % Number(length)}` })));
  }

  function stay(S, name) {
    const own = Object.fromEntries(S.rules.stays ?? [])[name] ?? { shortest: S.rules.dwell_time ?? "0" };
    const first = ratio(own.shortest ?? "0"), last = "longest" in own ? ratio(own.longest) : null;
    if (!S.flow && first[0] < first[1]) [first[0], first[1]] = [1n, 1n];
    need(!last || first[0] * last[1] <= last[0] * first[1], "a mode must be left before it may be");
    need(S.flow || (first[1] === 1n && (!last || last[1] === 1n)), "a stay is not a whole number of steps");
    return [first, last];
  }

  // Every step of a system that keeps rules of switching: its places are the modes.
  function stepsByMode(S, leaving, rate) {
    const steps = [], { transitions, resets = [] } = S.rules;
    S.names.forEach((name, k) => { if (!leaving.includes(name)) steps.push(step(name, name, name, S.A[k], S.flow, 1)); });
    S.names.forEach((a, k) => S.names.forEach((b, l) => {
      if (a === b || (transitions && !transitions.some(([from, to]) => from === a && to === b))) return;
      const [first, last] = stay(S, a), { N, d } = S.A[k], n = N.length, ways = resets.filter((r) => r.source === a && r.target === b);
      known(!(S.flow && leaving.includes(a)), "stays of any length in continuous time");
      need(!leaving.includes(a) || last, "a mode need not be left");
      for (const reset of ways.length ? ways : [null]) {
        let jump = reset ? table(reset, S.A[l].N.length, n) : { N: unit(n), d: 1n };
        need(jump.N.length === S.A[l].N.length, "a switch has no reset that fits");
        if (S.flow) {
          const [p, q] = rate, E = exponential({ N: N.map((row, i) => row.map((x, j) => x * q + (i === j ? p * d : 0n))), d: d * q }, first);
          if (first[0] === 0n) Object.assign(E, { N: unit(n, ONE), e: 0n });
          const s = step(a, a, b, { N: times(jump.N, E.N), d: ONE * jump.d }, false, 0), one = (i) => new Map([[`${i}`, [1n, 1n]]]);
          steps.push({ ...s, error: [E.e * size(jump.N), ONE * jump.d], facts: range(n).map((i) => ["error", -1n, one(i), one(i)]) });
        }
        for (let count = 1n; !S.flow && count <= (leaving.includes(a) ? last : first)[0]; count++) {
          jump = { N: times(jump.N, N), d: jump.d * d };
          if (count >= first[0]) steps.push(step(a, a, b, jump, false, Number(count)));
        }
      }
    }));
    return steps;
  }

  // What an error of M in a step does to the function after it, at most.
  function wrong(s, { rows }) {
    const n = BigInt(Math.max(s.n, s.M.length)), most = (all) => all.reduce((a, b) => (a > b ? a : b)), entries = s.M.flatMap((v) => [...v.values()]);
    return [s.error[0] * n ** 3n * most(rows.flat().map(abs)) * (2n * most(entries.map(([x, d]) => abs(x) / d + 1n)) + 1n), s.error[1]];
  }

  // A form that must vanish for all states, with what it was multiplied by.
  function vanish(s, N, d, keeps, rate) {
    const sum = new Map();
    N.rows.forEach((row, i) => row.forEach((x, j) => { const key = sorted(`${N.basis[i]},${N.basis[j]}`); sum.set(key, (sum.get(key) ?? 0n) + x); }));
    need([...sum.values()].every((x) => !x), "a form that must vanish does not");
    const below = s.M.flatMap((v) => [...v.values()]).map(([x, q]) => q / gcd(x, q)).reduce(lcm);
    const scale = s.flow ? s.over * (keeps[1] / gcd(keeps[0] * s.over, keeps[1])) : (below * rate[1] ** BigInt(s.time)) ** BigInt(2 * d);
    return { ...N, scale };
  }

  function graph(S, o) {
    const { stays, degree = 1n, multipliers = [] } = o, d = Number(degree), rate = ratio(o.rate), added = [...(o.vanishing ?? [])];
    known(!("edges" in o), "edges to some nodes");
    need(d >= 1 && rate[0] > 0n && (S.flow || rate[0] < rate[1]), "the rate is none of decay");
    const has = (kind) => multipliers.some(({ fact }) => fact.startsWith(kind));
    const active = ["rounding", "coupling"].filter(has).flatMap(S.named), coupled = has("coupling");
    const lost = !stays && o.nodes.some(({ place }) => place.startsWith("free"));
    const steps = stays ? stepsByMode(S, stays.leaving ?? [], rate) : stepsInTurns(S, lost, active);
    const sizes = Object.fromEntries(steps.map((s) => [s.source, s.n])), places = new Set(o.nodes.map(({ place }) => place));
    need(places.size === Object.keys(sizes).length && steps.every((s) => places.has(s.source) && places.has(s.target)), "a place has no form");
    need(o.nodes.length === places.size || !(S.flow || coupled), "there are more forms than places");
    if (stays) need(!(S.required || S.o.couplings || S.o.clock || S.fixed.length || multipliers.length || (S.flow && d > 1)), "more happens than stays");
    else {
      need(!S.rules.resets, "resets are not covered");
      need(lost || !S.required, "the loss of contact is not covered");
      need(coupled ? !S.o.clock : !S.o.couplings, "what axes do to each other is not covered");
      need(d === 1 || !(multipliers.length || (lost && (!S.flow || S.pulls.length))), "no such polynomial");
    }
    const facts = new Set(steps.flatMap((s) => s.facts.map(([fact]) => fact))), values = new Map();
    for (const { fact, value, target = null } of multipliers) {
      need(facts.has(fact) && value >= 0n && !values.has(`${fact}/${target}`), "a multiplier is odd");
      need(target === null || !fact.startsWith("coupling"), "the multiplier of a coupling is one for all");
      values.set(`${fact}/${target}`, value);
    }
    for (const { place, form: rows } of o.nodes) need(positive(form(rows, sizes[place], d)), `a form at ${place} is not positive definite`);
    if (lost && S.flow) {
      const [a, b] = ["modes", "free"].map((place) => form(o.nodes.find((node) => node.place === place).form, sizes[place], d, S.n - 1).rows.flat());
      need(a.every((x, k) => x === b[k]), "it jumps where contact is lost");
    }
    for (const s of steps) for (const from of o.nodes) o.nodes.forEach((to, b) => {
      if (from.place !== s.source || to.place !== s.target) return;
      const before = form(from.form, sizes[s.source], d), after = form(to.form, sizes[s.target], d, s.M.length);
      const power = BigInt(2 * d * s.time), keeps = s.flow ? [2n * degree * rate[0], rate[1]] : [rate[0] ** power, rate[1] ** power];
      const m = (fact) => (fact === "error" ? wrong(s, after) : [values.get(`${fact}/${b}`) ?? values.get(`${fact}/null`) ?? 0n, 1n]);
      const vanishing = d > 1 && s.time ? vanish(s, form(added.shift() ?? [], s.n, d), d, keeps, rate) : null;
      const made = terms(s, before, after, keeps, m, vanishing);
      need(definite(made, !s.time), `it rises in mode ${s.mode}`);
    });
    need(!added.length, "more forms vanish than there are steps");
    const shown = S.flow ? `exp(-alpha t) with alpha = ${o.rate} 1/s` : `rho^t with rho = ${o.rate} per step`;
    return `decay like ${shown}${lost ? ", through loss of contact" : ""}${has("rounding") ? ", with rounding" : ""}${coupled ? ", of all axes" : ""}`;
  }

  function noCommonQuadratic(S, { factors }) {
    need(S.uniform && factors.every(([name]) => S.names.indexOf(name) in S.o.modes), "the factors are not those of modes");
    const used = factors.map(([name, L]) => [S.A[S.names.indexOf(name)], L]), common = used.map(([{ d }]) => d).reduce(lcm);
    const made = used.flatMap(([{ N, d }, L]) => L[0].flatMap((_, j) => {
      need(L.length === S.n, "a factor has another size");
      const x = L.map((row) => [row[j]]), X = new Map(x.map(([e], i) => [i, e])), Y = new Map(times(N, x).map(([e], i) => [i, e])), w = common / d;
      return S.flow ? [[w, X, Y], [w, Y, X]] : [[w * w, Y, Y], [-common * common, X, X]];
    }));
    need(definite(made), "the sum over the modes is not positive definite");
    return "no common quadratic function exists";
  }

  function parameterQuadratic(S, o) {
    const [low, high] = [o.low, o.high].map((rows) => form(rows, S.n)), [p, q] = ratio(o.rate), at = (name) => acting(S, S.names.indexOf(name), []);
    need(S.flow && p > 0n && S.fixed.length && !S.rules.resets && !(S.required || S.o.couplings || S.o.clock), "it is about other systems");
    need(positive(low) && positive(high), "Q is not positive definite");
    for (const [a, b] of S.fixed) {
      // Over one common denominator, so that all terms are multiplied alike.
      const over = lcm(at(a).over, at(b).over), units = new Map(range(S.n).map((i) => [`${i}`, [0n, over]]));
      const falls = (name, Q) => terms({ ...at(name), facts: [["units", 1n, units, units]] }, Q, Q, [2n * p, q], () => [1n, 1n]);
      for (const made of [falls(a, low), falls(b, high), [...falls(a, high), ...falls(b, low)]]) need(definite(made), `it rises between ${a} and ${b}`);
    }
    return `decay like exp(-alpha t) with alpha = ${o.rate} 1/s at every constant value of the parameter`;
  }

  const CHECKS = { graph: [graph, "proved"], "no-common-quadratic": [noCommonQuadratic, ""], "parameter-quadratic": [parameterQuadratic, "proved"] };

  // What is shown, in words, or why not, for every statement of a certificate, as its text.
  return (text) => {
    const o = parse(text), verdicts = new Set();
    need(o.schema === "nrs-design/certificate/8", "it is of another schema");
    const results = o.statements.map((statement) => {
      const [decide, verdict] = Object.hasOwn(CHECKS, statement.kind) ? CHECKS[statement.kind] : [];
      try {
        known(decide, `${statement.kind} is not checked here`);
        const shown = decide(read(o), statement);
        verdicts.add(verdict);
        return [true, shown];
      } catch (error) {
        return [error instanceof Unchecked ? null : false, `${statement.kind}: ${error.message}`];
      }
    });
    return { results, verdict: o.verdict, agrees: verdicts.has("proved") ? o.verdict === "proved" : o.verdict === "inconclusive", modes: o.modes.length, free: o.contact?.free?.length ?? 0 };
  };
})();

// What the page says must be what the certificate says, and that must be what the id stands for.
async function findAltered(text) {
  const said = [...document.querySelectorAll(".claim, .remark")].map((p) => p.textContent);
  const { verdict, statements } = JSON.parse(text), claims = statements.map(({ claim }) => claim);
  if (document.querySelector(".badge").textContent !== verdict) return "the verdict of the page is not that of the certificate";
  if (said.slice(verdict === "inconclusive" ? 1 : 0).some((words) => !claims.includes(words))) return "a sentence of the page is not one of the certificate";
  const hash = [...new Uint8Array(await crypto.subtle.digest("SHA-256", new TextEncoder().encode(text)))];
  const id = hash.map((byte) => byte.toString(16).padStart(2, "0")).join("");
  const named = [...document.querySelectorAll("dd")].some((dd) => dd.textContent === id);
  return named ? null : "the numbers are not those of the certificate id of the page";
}

async function judge(text) {
  const altered = await findAltered(text);
  if (altered) return ["bad", `Refused: ${altered}.`];
  const began = performance.now(), { results, agrees, modes, free } = check(text);
  const time = ((performance.now() - began) / 1000).toPrecision(2), wrong = results.filter(([holds]) => holds === false);
  if (wrong.length) return ["bad", `Refused: ${wrong.map(([, words]) => words).join("; ")}.`];
  const open = results.filter(([holds]) => holds === null).map(([, words]) => words);
  if (!agrees && !open.length) return ["bad", "Refused: the verdict does not follow from what is shown."];
  const shown = results.filter(([holds]) => holds).map(([, words]) => words);
  const about = `${modes} modes${free ? ` in contact and ${free} of free motion` : ""}`;
  const held = shown.length ? `Holds for the ${about} in this page, checked in ${time} s: ${shown.join("; ")}.` : "";
  const left = open.length ? `Not checked here: ${open.join("; ")}.` : "";
  const rest = "Not checked: whose modes these are (nrs-design verify does that), what the sentences make of it, and all other numbers and figures. Who changed a page could change this check, too.";
  return [open.length ? "unknown" : "good", [held, left, rest].filter(Boolean).join(" ")];
}

function addCheck(text) {
  const bar = document.createElement("div"), told = document.createElement("output");
  const press = button("Check", "Check the proof from the numbers in this page", () => {
    told.textContent = "Checking ...";
    setTimeout(async () => {
      const [state, words] = await judge(text).catch((error) => ["bad", `Refused: ${error.message}.`]);
      Object.assign(told, { className: state, textContent: words });
    });
  });
  bar.className = "tools";
  bar.id = "check";
  bar.append(told, press);
  document.querySelector(".claim").after(bar);
}

addCheck(document.getElementById("numbers").textContent);
