"use strict";
// The step, discount or scheme for a damping ratio: the search of `dda-validate advise step`.
const adviser = (() => {
  const { contact_frequency, damping_ratio, dda_frequency, spectral_radius } = damping;

  // ---- validation.advice.search: all values of one parameter that give a function its target ----

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

  // ---- validation.advice.advice: dt, gg or delta for a wanted damping ratio of the first axial mode ----

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

  return { advise, family };
})();
