"use strict";
// The formulas of the calculators: pure functions of numbers, named as in Python, no page comes in.
// A Python function of arrays is here a function of one number; every one is compared with its original by a test.
const formulas = (() => {
  // ---- dda.scheme.spectral: one mode under the Newmark scheme, Omega = w dt, X = Omega^2 / (1 + alpha Omega^2) ------

  function x(omega, alpha) {
    const inverse = 1 / Math.max(omega, 1);
    return omega <= 1 ? omega ** 2 / (1 + alpha * omega ** 2) : 1 / (inverse ** 2 + alpha);
  }

  // trace = 1 + gg - (1/2 + gg delta) X
  function trace(omega, alpha, delta, gg = 1) {
    return 1 + gg - (0.5 + gg * delta) * x(omega, alpha);
  }

  // det = gg (1 + (1/2 - delta) X)
  function determinant(omega, alpha, delta, gg = 1) {
    return gg * (1 + (0.5 - delta) * x(omega, alpha));
  }

  // trace^2 - 4 det, arranged so that small Omega keeps its digits
  function discriminant(omega, alpha, delta, gg) {
    const X = x(omega, alpha), p = 0.5 + gg * delta;
    const b = 2 * (1 + gg) * p + 4 * gg * (0.5 - delta);
    return (1 - gg) ** 2 - X * (b - p * p * X);
  }

  // max |lambda| of lambda^2 - trace lambda + det = 0
  function spectral_radius(omega, alpha, delta, gg = 1) {
    const t = trace(omega, alpha, delta, gg), d = determinant(omega, alpha, delta, gg);
    const disc = discriminant(omega, alpha, delta, gg);
    return disc < 0 ? Math.sqrt(Math.abs(d)) : (Math.abs(t) + Math.sqrt(disc)) / 2;
  }

  // ln lambda = re +- i half (kind -1) or re +- half (kind 1); kind NaN where a root is not positive
  function logarithms(omega, alpha, delta, gg) {
    const X = x(omega, alpha), t = trace(omega, alpha, delta, gg), disc = discriminant(omega, alpha, delta, gg);
    const re = (Math.log(gg) + Math.log1p((0.5 - delta) * X)) / 2;
    if (disc < 0) return [re, Math.atan2(Math.sqrt(-disc), t), -1];
    const second = (1 + gg) * X / (1 - t / 2 + Math.sqrt(disc) / 2) / 2;
    const positive = t > 0 && determinant(omega, alpha, delta, gg) > 0;
    return [re, Math.log1p(-second) - re, positive ? 1 : NaN];
  }

  // xi = -re / sqrt(re^2 - kind half^2); at least 1 where overdamped, NaN where a root is not positive
  function damping_ratio(omega, alpha, delta, gg = 1) {
    const [re, half, kind] = logarithms(omega, alpha, delta, gg);
    return -re / Math.sqrt(re ** 2 - kind * half ** 2);
  }

  // w / w' - 1, w' dt = sqrt(re^2 - kind half^2)
  function period_elongation(omega, alpha, delta, gg = 1) {
    const [re, half, kind] = logarithms(omega, alpha, delta, gg);
    return omega / Math.sqrt(re ** 2 - kind * half ** 2) - 1;
  }

  // The Omega beyond which the scheme grows: a root passes -1, or (delta < 1/2) a complex pair leaves the unit circle.
  function critical_omega(alpha, delta, gg = 1) {
    const flip = 0.5 + gg * (2 * delta - 0.5) - 2 * alpha * (1 + gg);
    const spiral = gg * (0.5 - delta) - alpha * (1 - gg);
    const at_flip = flip > 0 ? 2 * (1 + gg) / flip : Infinity, at_spiral = spiral > 0 ? (1 - gg) / spiral : Infinity;
    return Math.sqrt(Math.min(at_flip, at_spiral));
  }

  // ---- validation.theory.spectra: the DDA block on two corner springs, mu = 0 ----------------------------------

  // Smaller root of the two-unknown problem of (v, ey): M = diag(m, m h^2/12), K = [[2p, -p h], [-p h, E h w + p h^2/2]]
  function dda_frequency({ width, height, density, young, stiffness }) {
    const m = density * width * height;
    const a = 2 * stiffness / m;
    const c = 12 * (young * width * height + stiffness * height * height / 2) / (m * height * height);
    const det = 2 * stiffness / m * 12 * young * width * height / (m * height * height), half = (a + c) / 2;
    return Math.sqrt(det / (half + Math.sqrt(half * half - det)));
  }

  // The other one, from det(K) / det(M) = w1^2 w2^2
  function contact_frequency(block) {
    const { width, height, density, young, stiffness } = block, m = density * width * height;
    return Math.sqrt(2 * stiffness / m) * Math.sqrt(12 * young * width / (m * height)) / dda_frequency(block);
  }

  // ---- validation.advice.search: all values of one parameter that give a function its target ------------------------

  const FLAT = 1e-12;  // relative; smaller turns of a function are rounding, not extrema

  function linspace(low, high, count) {
    return Array.from({ length: count }, (_, i) => i === count - 1 ? high : low + i * (high - low) / (count - 1));
  }

  function geomspace(low, high, count) {
    return linspace(Math.log(low), Math.log(high), count).map((value, i) => i ? Math.exp(value) : low);
  }

  // The last coordinate between a and b at which xi is defined
  function edge(xi, a, b) {
    let [inside, outside] = Number.isFinite(xi(a)) ? [a, b] : [b, a];
    for (let i = 0; i < 200; i++) {
      const middle = (inside + outside) / 2;
      if (middle === inside || middle === outside) break;
      if (Number.isFinite(xi(middle))) inside = middle; else outside = middle;
    }
    return inside;
  }

  // The parts of a grid on which xi is defined, with their edges to the last bit
  function defined(grid, xi) {
    const found = [];
    let part = null;
    grid.forEach((s, i) => {
      const ok = Number.isFinite(xi(s));
      if (ok && part === null) part = i ? [edge(xi, grid[i - 1], s)] : [];
      if (ok && s !== part[part.length - 1]) part.push(s);
      if (!ok && part !== null) {
        const last = edge(xi, grid[i - 1], s);
        if (last !== part[part.length - 1]) part.push(last);
        found.push(part);
        part = null;
      }
    });
    return part === null ? found : [...found, part];
  }

  // Indices of the local extrema, turns within rounding left out
  function turning_points(y) {
    const found = [];
    let low = 0, high = 0, rising = null;
    for (let i = 1; i < y.length; i++) {
      const size = FLAT * Math.max(Math.abs(y[i]), Math.abs(y[high]), Math.abs(y[low]));
      if (y[i] > y[high]) high = i;
      if (y[i] < y[low]) low = i;
      if (rising !== false && y[high] - y[i] > size) [found[found.length], rising, low] = [high, false, i];
      else if (rising !== true && y[i] - y[low] > size) [found[found.length], rising, high] = [low, true, i];
    }
    return found.filter((i) => i > 0 && i < y.length - 1);
  }

  // The extremum between three coordinates by golden sections
  function extremum(xi, [a, middle, b]) {
    const sign = xi(middle) >= Math.max(xi(a), xi(b)) ? -1 : 1, share = (Math.sqrt(5) - 1) / 2;
    for (let i = 0; i < 90; i++) {
      const left = b - share * (b - a), right = a + share * (b - a);
      if (sign * xi(left) < sign * xi(right)) b = right; else a = left;
    }
    const found = (a + b) / 2;
    return sign * xi(found) <= sign * xi(middle) ? found : middle;
  }

  // Intervals on which xi is defined and monotone
  function pieces(grid, xi) {
    const found = [];
    for (const s of defined(grid, xi)) {
      const turns = turning_points(s.map(xi)).map((i) => extremum(xi, s.slice(i - 1, i + 2)));
      const ends = [s[0], ...turns, s[s.length - 1]];
      for (let i = 1; i < ends.length; i++) if (ends[i] > ends[i - 1]) found.push([ends[i - 1], ends[i]]);
    }
    return found;
  }

  // The root of xi - target in a piece that brackets it, by halving to the last bit
  function root(xi, target, a, b) {
    const rising = xi(b) > xi(a);
    for (let i = 0; i < 2000; i++) {
      const middle = (a + b) / 2;
      if (middle === a || middle === b) break;
      if ((xi(middle) < target) === rising) a = middle; else b = middle;
    }
    return Math.abs(xi(a) - target) <= Math.abs(xi(b) - target) ? a : b;
  }

  // All coordinates at which xi is the target, and the least and the greatest xi that there is
  function search(grid, xi, target) {
    const all = pieces(grid, xi), solutions = [], ends = all.flat();
    for (const [a, b] of all) {
      const low = xi(a) - target, high = xi(b) - target;
      if (low * high <= 0 && (low || high)) {
        const s = root(xi, target, a, b), last = solutions[solutions.length - 1];
        if (last === undefined || Math.abs(s - last) > 1e-12) solutions.push(s);
      }
    }
    const by = (better) => ends.reduce((best, s) => best === null || better(xi(s), xi(best)) ? s : best, null);
    return { solutions, ends, least: by((u, v) => u < v), greatest: by((u, v) => u > v) };
  }

  // ---- validation.advice.advice: dt, gg or delta for a wanted damping ratio of the first axial mode ------------------

  const family = (delta) => (0.5 + delta) ** 2 / 4;  // alpha on the boundary of the paper's (14)

  const searches = {
    // over ln Omega at a fixed gg; no xi where the highest mode grows
    dt: ({ alpha, delta, gg }, frequency, highest) => ({
      grid: linspace(Math.log(1e-12), Math.log(1e8), 4000),
      xi: (s) => stable_ratio(Math.exp(s), alpha, delta, gg, highest / frequency),
      value: (s) => Math.exp(s) / frequency,
    }),
    // over -gg at the scene's step; close to 1 the grid follows 1 - gg
    gg: ({ alpha, delta, step }, frequency, highest) => ({
      grid: sorted([-1, ...geomspace(1e-15, 1 - 1e-12, 3000).map((away) => away - 1),
        ...geomspace(1e-12, 1e-3, 300).map((small) => -small)]),
      xi: (s) => stable_ratio(frequency * step, alpha, delta, -s, highest / frequency),
      value: (s) => -s,
    }),
    // over delta with alpha = (1/2 + delta)^2 / 4, at the scene's dt and gg
    scheme: ({ gg, step }, frequency) => ({
      grid: sorted([0.5, ...geomspace(1e-14, 1, 2000).map((more) => 0.5 + more), ...linspace(0.5, 1.5, 1000)]),
      xi: (s) => damping_ratio(frequency * step, family(s), s, gg),
      value: (s) => s,
    }),
  };

  function sorted(values) {
    return [...new Set(values)].sort((a, b) => a - b);
  }

  function stable_ratio(omega, alpha, delta, gg, highest) {
    const grows = spectral_radius(omega * highest, alpha, delta, gg) > 1 + 1e-12;
    return grows ? NaN : damping_ratio(omega, alpha, delta, gg);
  }

  // The values of dt [s], gg or delta, in increasing order, and what can be reached
  function advise(scheme, block, target, solve_for) {
    const frequency = dda_frequency(block), highest = Math.max(frequency, contact_frequency(block));
    const { grid, xi, value } = searches[solve_for](scheme, frequency, highest);
    const { solutions, ends, least, greatest } = search(grid, xi, target);
    const everywhere = ends.length > 0 && ends.every((s) => Math.abs(xi(s) - target) < 1e-15);
    const own = { dt: scheme.step, gg: scheme.gg, scheme: scheme.delta }[solve_for];
    const values = !solutions.length && everywhere ? [own] : solutions.map(value).sort((a, b) => a - b);
    const reach = least === null ? null : { least: xi(least), least_at: value(least),
      greatest: xi(greatest), greatest_at: value(greatest) };
    return { values, reach };
  }

  // ---- complex numbers [re, im] --------------------------------------------------------------------------------------

  const add = ([a, b], [c, d]) => [a + c, b + d];
  const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
  const scaled = (factor, [a, b]) => [factor * a, factor * b];
  const over = (z, [c, d]) => scaled(1 / (c * c + d * d), times(z, [c, -d]));
  const modulus = ([a, b]) => Math.hypot(a, b);

  // The root with a real part that is not negative
  function root_of([a, b]) {
    const size = Math.sqrt((Math.abs(a) + Math.hypot(a, b)) / 2);
    if (size === 0) return [0, b];
    const other = b / (2 * size);
    return a >= 0 ? [size, other] : [Math.abs(other), b < 0 || Object.is(b, -0) ? -size : size];
  }

  // arcsin z = atan(x / Re(u v)) + i asinh(Im(conj(u) v)) with u = sqrt(1 - z), v = sqrt(1 + z) (Kahan)
  function arcsin(z) {
    const u = root_of([1 - z[0], -z[1]]), v = root_of([1 + z[0], z[1]]);
    return [Math.atan2(z[0], times(u, v)[0]), Math.asinh(times([u[0], -u[1]], v)[1])];
  }

  // ---- validation.theory.waves: steady vibrations and waves under the scheme ------------------------------------------

  const GROWTH = 1e-9;  // of a wave over a block, by rounding

  // W2 = -(z - 1)(z - gg) m / (dt^2 [gg ((1 - gamma) + gamma z) + (1/2 - beta + beta z)(z - gg)]), z = e^{iw dt},
  // m = ((1 - am) z + am) / ((1 - af) z + af); the leapfrog: -(z - 1)(z - gg) / (dt^2 z)
  function squared_frequency(s, omega) {
    const { step, gg } = s, half = 0.5 * step * omega;
    const turn = times([0, 2 * Math.sin(half)], [Math.cos(half), Math.sin(half)]);  // z - 1 without subtraction
    const ahead = add([1 - gg, 0], turn), above = scaled(-1, times(turn, ahead));
    if (s.method === "leapfrog") return over(above, scaled(step ** 2, add([1, 0], turn)));
    const [{ am, af, beta, gamma }] = stages(s);
    const below = add(scaled(gg, add([1, 0], scaled(gamma, turn))), times(add([0.5, 0], scaled(beta, turn)), ahead));
    const mean = over(add([1, 0], scaled(1 - am, turn)), add([1, 0], scaled(1 - af, turn)));
    return over(times(above, mean), scaled(step ** 2, below));
  }

  // k of the wave e^{iwt - ikx} in welded blocks: 1 - cos(kh) = 2 sin^2(kh/2) = W2 rho h / (2 (M/h + W2 rho h / 6))
  function wavenumber({ height, density, young }, w2) {
    const inertia = scaled(density * height, w2);
    const opening = over(inertia, scaled(2, add([young / height, 0], scaled(1 / 6, inertia))));
    const found = scaled(2 / height, arcsin(root_of(scaled(0.5, opening))));
    const growing = found[1] * height > GROWTH;
    return growing ? [2 * Math.PI / height - found[0], -found[1]] : found;
  }

  // The steady ratio xi = -Im W / |W|, W = sqrt(W2) (validation.advice.rayleigh); a free vibration has damping_ratio
  function ratio(scheme, frequency) {
    const W = root_of(squared_frequency(scheme, 2 * Math.PI * frequency));
    return -W[1] / modulus(W);
  }

  // What becomes of a wave over a distance: share lost, periods late, steady ratio, w / Re k / c - 1
  // (validation.advice.wave_advice.Passage, validation.theory.waves.Column.travelled)
  function passage(column, scheme, frequency, distance) {
    const omega = 2 * Math.PI * frequency, speed = Math.sqrt(column.young / column.density);
    const k = wavenumber(column, squared_frequency(scheme, omega));
    return {
      loss: -Math.expm1(-Math.abs(k[1]) * distance),
      delay: (k[0] - omega / speed) * distance / (2 * Math.PI),
      damping: ratio(scheme, frequency),
      speed_error: omega / k[0] / speed - 1,
    };
  }

  // ---- fem_reference.events.restitution: a mass meets a penalty contact under the scheme -----------------------------

  const LIMIT = 100000, REST = 1e-18;  // steps in contact after which the mass is stuck; what is at rest

  // A in contact per depth of the predictor: Omega^2 / (1 + alpha Omega^2)
  function response(alpha, omega) {
    return 1 / (1 / omega / omega + alpha);
  }

  function mix(...terms) {
    return [0, 1].map((i) => terms.reduce((sum, [factor, line]) => sum + factor * line[i], 0));
  }

  // A step in contact: the next predictor, velocity, acceleration, and the velocity if contact ends; lines in theta
  function contact_step({ delta, gg }, stiffness, predicted, v, A) {
    const after = mix([-stiffness, predicted]);
    const speed = mix([gg, v], [1 - delta, A], [delta, after]);
    const following = mix([1, predicted], [0.5, after], [gg, speed]);
    return [following, speed, after, mix([gg, speed], [1 - delta, after])];
  }

  // All straight lines e = constant + slope theta of the restitution over the overshoot theta from 0 to gg
  function branches(scheme, omega) {
    const stiffness = response(scheme.alpha, omega), found = [];
    const pending = [[0, scheme.gg, [0, -1], [-1, 0], [0, 0], 0]];
    while (pending.length) {
      const [low, high, ...state] = pending.pop(), steps = state.pop();
      const [predicted, v, A, out] = contact_step(scheme, stiffness, ...state);
      const size = Math.max(...v.map(Math.abs), ...A.map(Math.abs));
      const zero = predicted[1] ? -predicted[0] / predicted[1] : low;
      for (const [a, b] of low < zero && zero < high ? [[low, zero], [zero, high]] : [[low, high]]) {
        if (predicted[0] + predicted[1] * ((a + b) / 2) >= 0) found.push({ low: a, high: b, constant: out[0], slope: out[1] });
        else if (size < REST || steps >= LIMIT) found.push({ low: a, high: b, constant: 0, slope: 0 });
        else pending.push([a, b, predicted, v, A, steps + 1]);
      }
    }
    return found.sort((a, b) => a.low - b.low);
  }

  // Mean, least, greatest and mean square of the restitution, theta uniform from 0 to gg
  function impact_statistics(scheme, omega) {
    let mean = 0, energy = 0, low = Infinity, high = -Infinity;
    for (const line of branches(scheme, omega)) {
      const width = (line.high - line.low) / scheme.gg, first = line.constant + line.slope * line.low;
      const last = line.constant + line.slope * line.high;
      mean += width * (first + last) / 2;
      energy += width * (first * first + first * last + last * last) / 3;
      low = Math.min(low, first, last);
      high = Math.max(high, first, last);
    }
    return { mean, low, high, energy };
  }

  // ---- validation.theory.landing ---------------------------------------------------------------------------------------

  // w_c = sqrt(8 p / m): at p >> E the base of the block of one strain moves with a quarter of its mass
  function base_frequency({ width, height, density, stiffness }) {
    return Math.sqrt(8 * stiffness / (density * width * height));
  }

  // ---- validation.theory.stages: schemes as tables of stages, in units of the step --------------------------------------

  const STAGE = { d_u: 1, d_g: 0, e_0: 0, e_g: 0, beta: 0, g_0: 0, g_g: 0, gamma: 0, am: 0, af: 0 };

  function one_stage(am, af, beta, gamma) {
    return { ...STAGE, e_0: 0.5 - beta, beta, g_0: 1 - gamma, gamma, am, af };
  }

  function generalised_alpha(am, af) {
    return one_stage(am, af, (1 - am + af) ** 2 / 4, 0.5 - am + af);
  }

  // The stages of a method: newmark by alpha and delta, the others by rho_inf
  function stages({ method, alpha, delta, rho_inf: r }) {
    if (method === "chung-hulbert") return [generalised_alpha((2 * r - 1) / (r + 1), r / (r + 1))];
    if (method === "hht") return [generalised_alpha(0, (1 - r) / (1 + r))];
    if (method === "wbz") return [generalised_alpha((r - 1) / (r + 1), 0)];
    if (method === "leapfrog") return [{ ...STAGE, e_0: 1, g_0: 1 }];
    if (method !== "composite") return [one_stage(0, 0, alpha, delta)];
    const split = r === 1 ? 0.5 : (2 - Math.sqrt(2 + 2 * r)) / (1 - r);
    const q1 = (r + 1) / (2 * split * (r - 1) + 4), q0 = (split - 1) * q1 + 0.5, q2 = 0.5 - split * q1;
    return [{ ...STAGE, d_u: split, e_0: split * split / 4, beta: split * split / 4, g_0: split / 2, gamma: split / 2 },
      { ...STAGE, d_u: q0 + q2, d_g: q1, e_0: q2 * q0, e_g: q2 * q1, beta: q2 * q2, g_0: q0, g_g: q1, gamma: q2 }];
  }

  // Linear solves of a step
  function solves({ method }) {
    return { leapfrog: 0, composite: 2 }[method] ?? 1;
  }

  // ---- validation.theory.stepping: the roots z of a step of any method at W = w dt -------------------------------------

  // Products and sums of polynomials, highest power first
  function product(p, q) {
    const found = Array(p.length + q.length - 1).fill(0);
    p.forEach((a, i) => q.forEach((b, j) => { found[i + j] += a * b; }));
    return found;
  }

  function sum(p, q) {
    const size = Math.max(p.length, q.length), at = (one, i) => one[i - size + one.length] ?? 0;
    return Array.from({ length: size }, (_, i) => at(p, i) + at(q, i));
  }

  // The polynomial of t = z - 1, which keeps the digits of small W
  function step_polynomial(s, omega) {
    const all = stages(s), [{ am, af, beta, gamma }] = all, gg = s.gg, square = omega * omega;
    if (s.method === "leapfrog") return [1, 1 - gg + square, square];
    if (all.length === 2) {
      const [{ d_u: split }, { g_0: q0, g_g: q1, gamma: q2 }] = all, half = [0, split * omega / 2];
      const middle = over(add([1, 0], half), add([1, 0], scaled(-1, half)));
      const R = over(add([1, q0 * omega], times([0, q1 * omega], middle)), [1, -q2 * omega]);
      const trace_ = (1 + gg) * R[0], det = gg * (R[0] * R[0] + R[1] * R[1]);
      return [1, 2 - trace_, 1 - trace_ + det];
    }
    const kinematics = sum(product([beta, 0.5], [1, 1 - gg]), [gg * gamma, gg]);
    if (am === 0 && af === 0) return sum([1, 1 - gg, 0], kinematics.map((value) => square * value));
    const inertia = product([1, 1 - gg, 0], [1 - am, 1]);
    return sum(inertia, product([1 - af, 1], kinematics).map((value) => square * value));
  }

  // A real root of a cubic, by halving to the last bit
  function real_root(p) {
    const value = (x) => p.reduce((all, one) => all * x + one, 0);
    let high = 1 + Math.max(...p.slice(1).map((one) => Math.abs(one / p[0]))), low = -high;
    const rising = p[0] > 0;
    for (let i = 0; i < 2000; i++) {
      const middle = (low + high) / 2;
      if (middle === low || middle === high) break;
      if ((value(middle) < 0) === rising) low = middle; else high = middle;
    }
    return low;
  }

  // The roots of a quadratic with real coefficients, without cancellation
  function quadratic([a, b, c]) {
    const disc = b * b - 4 * a * c;
    if (disc < 0) return [[-b / (2 * a), Math.sqrt(-disc) / (2 * Math.abs(a))], [-b / (2 * a), -Math.sqrt(-disc) / (2 * Math.abs(a))]];
    const far = -(b + (b < 0 ? -1 : 1) * Math.sqrt(disc)) / 2;
    return far === 0 ? [[0, 0], [0, 0]] : [[far / a, 0], [c / far, 0]];
  }

  const POLISHING = 3;

  function polished(p, t) {
    const slope = p.slice(0, -1).map((one, i) => one * (p.length - 1 - i));
    const value = (q, x) => q.reduce((all, one) => add(times(all, x), [one, 0]), [0, 0]);
    for (let i = 0; i < POLISHING; i++) {
      const below = value(slope, t);
      if (modulus(below) <= Number.EPSILON) break;
      const move = over(value(p, t), below);
      if (modulus(move) < modulus(t)) t = [t[0] - move[0], t[1] ? t[1] - move[1] : 0];
    }
    return t;
  }

  // z of a step, the complex pair first, else those of greatest modulus
  function roots(s, omega) {
    const p = step_polynomial(s, omega);
    let turns;
    if (p.length === 3) turns = quadratic(p);
    else {
      const real = real_root(p), b = p[1] + p[0] * real;
      turns = [[real, 0], ...quadratic([p[0], b, p[2] + b * real])];
    }
    const z = turns.map((t) => polished(p, t)).map(([re, im]) => [1 + re, im]);
    const rank = (one) => [one[1] === 0 ? 1 : 0, -modulus(one), -one[1]];
    return z.sort((one, other) => {
      const [a, b] = [rank(one), rank(other)];
      return a[0] - b[0] || (Math.abs(a[1] - b[1]) > 1e-14 ? a[1] - b[1] : 0) || a[2] - b[2];
    });
  }

  // xi, spectral radius and period elongation of any method; xi NaN where a root is real and not positive
  function step_ratio(s, omega) {
    if (s.method === "newmark") return damping_ratio(omega, s.alpha, s.delta, s.gg);
    const [l, m] = logarithms_of(s, omega);
    return -(l[0] + m[0]) / (2 * Math.sqrt(modulus(times(l, m))));
  }

  function logarithms_of(s, omega) {
    const [first, second] = roots(s, omega);
    if (first[1] === 0 && Math.min(first[0], second[0]) <= 0) return [[NaN, NaN], [NaN, NaN]];
    return [first, second].map((z) => [Math.log(modulus(z)), Math.atan2(z[1], z[0])]);
  }

  function step_radius(s, omega) {
    if (s.method === "newmark") return spectral_radius(omega, s.alpha, s.delta, s.gg);
    return Math.max(...roots(s, omega).map(modulus));
  }

  function step_elongation(s, omega) {
    if (s.method === "newmark") return period_elongation(omega, s.alpha, s.delta, s.gg);
    const [l, m] = logarithms_of(s, omega);
    return omega / Math.sqrt(modulus(times(l, m))) - 1;
  }

  function step_limit(s) {
    if (s.method === "newmark") return critical_omega(s.alpha, s.delta, s.gg);
    return s.method === "leapfrog" ? Math.sqrt(2 * (1 + s.gg)) : Infinity;
  }

  // ---- validation.theory.rebound: a rigid mass on a spring and a dashpot, by stages -------------------------------------

  const FLIGHT = 80, LONGEST = 200000, AT_REST = 1e-18;  // as there

  // The rebound at one phase theta, the overshoot of the first step below the contact
  function rebound_at(all, omega, theta, gg = 1, zeta = 0) {
    const k = omega * omega, c = 2 * zeta * omega;
    let x = gg - theta, v = -1, a = 0, N = 0, flight = -1;
    for (let n = 0; n < LONGEST; n++) {
      const u = gg * v;
      let pressed = 0, before = { x, v, a, N };
      for (const s of all) {
        const old = (s.af * before.N - s.am * before.a) / (1 - s.am), weight = (1 - s.af) / (1 - s.am);
        const xf = x + s.d_u * u + s.d_g * before.v + s.e_0 * a + s.e_g * before.a + s.beta * old;
        const vf = u + s.g_0 * a + s.g_g * before.a + s.gamma * old;
        const force = -(k * xf + c * vf) / (1 + weight * (k * s.beta + c * s.gamma));
        const now = xf < 0 ? Math.max(force, 0) : 0;
        before = { x: xf + s.beta * weight * now, v: vf + s.gamma * weight * now, a: old + weight * now, N: now };
        pressed = Math.max(pressed, now);
      }
      ({ x, v, a, N } = before);
      flight = pressed > 0 ? 0 : flight >= 0 ? flight + 1 : -1;
      if (gg < 1 && flight === 1) return v;
      // without memory of a the speed changes no more
      if (gg === 1 && v >= 0 && (flight >= FLIGHT || flight >= 1 && a === 0)) return v;
      if (Math.max(Math.abs(x), Math.abs(v), Math.abs(a), N, pressed) < AT_REST) return 0;
    }
    return 0;
  }

  // Mean, least, greatest and mean square over phases at the middles of equal parts
  function rebound_statistics(s, omega, zeta = 0, count = 100) {
    const all = stages(s);
    const e = Array.from({ length: count }, (_, i) => rebound_at(all, omega, s.gg * (i + 0.5) / count, s.gg, zeta));
    const mean = (values) => values.reduce((one, other) => one + other, 0) / count;
    return { mean: mean(e), low: Math.min(...e), high: Math.max(...e), energy: mean(e.map((one) => one * one)) };
  }

  // ---- validation.theory.restitution: the closed form of a dashpot and its inverse ----------------------------------------

  function contact_time(zeta) {
    const s = Math.sqrt(Math.abs(1 - zeta)) * Math.sqrt(1 + zeta);
    if (s === 0) return 2;
    return zeta < 1 ? 2 * Math.atan2(s, zeta) / s : 2 * Math.asinh(s) / s;
  }

  function restitution(zeta, clipped = true) {
    if (clipped) return Math.exp(-zeta * contact_time(zeta));
    return zeta >= 1 ? 0 : Math.exp(-Math.PI * zeta / Math.sqrt((1 - zeta) * (1 + zeta)));
  }

  // zeta of a restitution above 0
  function ratio_of_restitution(e) {
    const loss = -Math.log(e);
    if (!(loss > 0)) return 0;
    let low = loss / Math.PI, high = Math.max(1, Math.expm1(Math.min(loss, 700)));
    for (let i = 0; i < 200; i++) {
      const middle = high > 2 * low ? Math.sqrt(low * high) : (low + high) / 2;
      if (!(low < middle && middle < high)) break;
      if (middle * contact_time(middle) < loss) low = middle; else high = middle;
    }
    return (low + high) / 2;
  }

  // ---- validation.theory.soft_contact, validation.advice.engines: contacts of physics engines ----------------------------

  // Spring and dashpot of an engine's numbers on an effective mass, at a step
  function soft_contact({ engine, mass, step, hertz, damping_ratio: ratio, erp, cfm, timeconst, dampratio, dmax, stiffness, e }) {
    if (engine === "bullet") return { k: erp / (step * cfm), c: (1 - erp) / cfm, share: 1 };
    if (engine === "mujoco") return { k: mass / (timeconst * dampratio) ** 2, c: 2 * mass / timeconst, share: 1 - dmax };
    const w = engine === "spring" ? Math.sqrt(stiffness / mass) : 2 * Math.PI * hertz;
    const zeta = engine === "spring" ? ratio_of_restitution(e) : ratio;
    return { k: mass * w * w, c: 2 * zeta * mass * w, share: 1 };
  }

  return { stages, solves, roots, step_ratio, step_radius, step_elongation, step_limit, rebound_at, rebound_statistics,
    restitution, ratio_of_restitution, soft_contact, trace, determinant, spectral_radius, damping_ratio, period_elongation, critical_omega, dda_frequency,
    contact_frequency, family, advise, squared_frequency, wavenumber, ratio, passage, branches, impact_statistics,
    base_frequency, linspace, geomspace };
})();
