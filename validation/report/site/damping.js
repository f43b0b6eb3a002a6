"use strict";
// The damping of a step: pure functions of numbers, named as in Python, and what `dda-validate advise damping` says of a block.
const damping = (() => {
  // ---- dda.scheme.spectral: one mode under the Newmark scheme, Omega = w dt, X = Omega^2 / (1 + alpha Omega^2) ----

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

  // ---- validation.theory.spectra: the DDA block on two corner springs, mu = 0 ----

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

  function of_mode(frequency, { step, alpha, delta, gg }) {
    const omega = frequency * step, total = damping_ratio(omega, alpha, delta, gg);
    const algorithmic = damping_ratio(omega, alpha, delta, 1);
    return { frequency, omega, damping: total, algorithmic, kinetic: total - algorithmic,
      spectral_radius: spectral_radius(omega, alpha, delta, gg),
      period_elongation: period_elongation(omega, alpha, delta, gg) };
  }

  // The two modes of a block, the largest stable step and the transit of the wave
  function analyse(s) {
    const first = dda_frequency(s), contact = contact_frequency(s);
    return { modes: { "first axial": of_mode(first, s), contact: of_mode(contact, s) },
      limit: critical_omega(s.alpha, s.delta, s.gg) / contact, transit: s.height / Math.sqrt(s.young / s.density) };
  }

  return { analyse, contact_frequency, dda_frequency, damping_ratio, spectral_radius };
})();
