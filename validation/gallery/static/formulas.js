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

  // W2 = -(z - 1)(z - gg) / (dt^2 [gg ((1 - delta) + delta z) + (1/2 - alpha + alpha z)(z - gg)]), z = e^{iw dt}
  function squared_frequency({ step, alpha, delta, gg }, omega) {
    const half = 0.5 * step * omega;
    const turn = times([0, 2 * Math.sin(half)], [Math.cos(half), Math.sin(half)]);  // z - 1 without subtraction
    const ahead = add([1 - gg, 0], turn);
    const below = add(scaled(gg, add([1, 0], scaled(delta, turn))), times(add([0.5, 0], scaled(alpha, turn)), ahead));
    return over(scaled(-1, times(turn, ahead)), scaled(step ** 2, below));
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

  return { trace, determinant, spectral_radius, damping_ratio, period_elongation, critical_omega, dda_frequency,
    contact_frequency, family, advise, squared_frequency, wavenumber, ratio, passage, branches, impact_statistics,
    base_frequency, linspace, geomspace };
})();
