"use strict";
// The calculators' pages: settings in, numbers, charts and the equal command out. The formulas are in formulas.js.
const calculators = (() => {
  const f = formulas;
  const figure = (value, digits = 4) => numerals.written(value, digits);
  const percent = (value) => `${figure(100 * value)} %`;
  const BLUE = "#0072b2", ORANGE = "#d55e00", GREEN = "#009e73", GREY = "#888888";

  // Rounding is shown as none
  const cleaned = (value) => Math.abs(value) < 1e-12 ? 0 : value;
  const finite = (value) => Number.isFinite(value) ? value : null;

  function block_of(s) {
    return { width: s.side, height: s.side, density: s.density, young: s.young,
      stiffness: s.stiffness_ratio * s.young };
  }

  function set(values) {
    return Object.entries(values).map(([key, value]) => `--set ${key}=${value}`).join(" ");
  }

  function stepping(s) {
    return { "time.step": s.step, "time.gg": s.gg, "time.alpha": s.alpha, "time.delta": s.delta };
  }

  function of_block(s) {
    return { "block.side": s.side, "block.density": s.density, "block.young": s.young,
      "contact.stiffness": s.stiffness_ratio * s.young };
  }

  // ---- damping budget --------------------------------------------------------------------------------------------

  function mode(frequency, { step, alpha, delta, gg }) {
    const omega = frequency * step, total = f.damping_ratio(omega, alpha, delta, gg);
    const own = f.damping_ratio(omega, alpha, delta);
    return { frequency, omega, damping: finite(total), algorithmic: finite(own), kinetic: finite(total - own),
      radius: f.spectral_radius(omega, alpha, delta, gg), elongation: finite(f.period_elongation(omega, alpha, delta, gg)) };
  }

  function damping(s) {
    const block = block_of(s), first = f.dda_frequency(block), contact = f.contact_frequency(block);
    const modes = { "first axial": mode(first, s), contact: mode(contact, s) };
    const limit = f.critical_omega(s.alpha, s.delta, s.gg) / contact;
    const dt = f.geomspace(Math.min(1e-3 / first, s.step / 2), Math.max(30 / first, s.step * 2), 240);
    const over = (w, gg) => dt.map((step) => finite(100 * f.damping_ratio(w * step, s.alpha, s.delta, gg)));
    const transit = s.side / Math.sqrt(s.young / s.density);
    return {
      values: { modes, limit, transit },
      table: [["", "first axial mode", "contact mode"],
        ...[["frequency", "frequency", (v) => `${figure(v)} rad/s`], ["ω dt", "omega", figure],
          ["damping ratio", "damping", percent], ["algorithmic part", "algorithmic", percent],
          ["kinetic part", "kinetic", (v) => v === null ? "–" : percent(cleaned(v))],
          ["amplitude kept in a step", "radius", percent],
          ["period elongation", "elongation", (v) => v === null ? "–" : percent(v)]]
          .map(([label, key, text]) => [label, ...Object.values(modes).map((m) => m[key] === null ? "–" : text(m[key]))])],
      facts: [["Stable up to dt", Number.isFinite(limit) ? `${figure(limit)} s` : "any dt"],
        ["Transit of the wave h/c", `${figure(transit)} s`],
        ["Rate of the discount c = −ln(gg)/dt", s.gg > 0 ? `${figure(-Math.log(s.gg) / s.step + 0)} 1/s` : "∞"]],
      charts: { budget: { x: dt, log: true, xlabel: "dt [s]", ylabel: "ξ [%]", at: s.step, lines: [
        { label: "first axial, total", color: ORANGE, y: over(first, s.gg) },
        { label: "first axial, algorithmic", color: ORANGE, dash: [6, 4], y: over(first, 1) },
        { label: "contact mode, total", color: BLUE, y: over(contact, s.gg) }] } },
      command: `dda-validate damping figures-3-4 ${set({ ...of_block(s), ...stepping(s) })}`,
    };
  }

  // ---- adviser ---------------------------------------------------------------------------------------------------

  const NAMES = { dt: "dt", gg: "gg", scheme: "δ" };

  function adviser(s) {
    const block = block_of(s), first = f.dda_frequency(block), found = f.advise(s, block, s.target, s.solve_for);
    const unit = s.solve_for === "dt" ? " s" : "";
    const tell = (value) => `${NAMES[s.solve_for]} = ${figure(value, 6)}${unit}` +
      (s.solve_for === "scheme" ? `, α = ${figure(f.family(value), 6)}` : "") +
      (s.solve_for === "gg" && value > 0 ? ` (c = ${figure(-Math.log(value) / s.step + 0)} 1/s)` : "");
    const reach = found.reach;
    const facts = [["First axial mode", `${figure(first)} rad/s`]];
    if (found.values.length) found.values.forEach((value, i) => facts.unshift([i ? "or" : "Set", tell(value)]));
    else facts.unshift(["No value does", reach === null ? "the mode has no damping ratio here" :
      `what can be had lies between ${percent(cleaned(reach.least))} and ${percent(reach.greatest)}`]);
    if (reach !== null) facts.push(["Least that can be had", percent(cleaned(reach.least))],
      ["Greatest that can be had", `${percent(reach.greatest)} at ${NAMES[s.solve_for]} = ${figure(reach.greatest_at)}${unit}`]);
    return { values: { first, ...found }, facts, charts: { search: search_chart(s, first, found) },
      command: `dda-validate advise figures-3-4 --damping ${s.target} --solve-for ${s.solve_for} ` +
        set({ ...of_block(s), ...stepping(s) }) };
  }

  function search_chart(s, first, found) {
    const at = found.values, x = {
      dt: () => f.geomspace(Math.min(1e-3 / first, ...at), Math.max(30 / first, ...at) * 1.2, 240),
      gg: () => f.linspace(Math.min(0.8, ...at), 1, 240), scheme: () => f.linspace(0.5, 1.5, 240) }[s.solve_for]();
    const xi = {
      dt: (v) => f.damping_ratio(first * v, s.alpha, s.delta, s.gg),
      gg: (v) => f.damping_ratio(first * s.step, s.alpha, s.delta, v),
      scheme: (v) => f.damping_ratio(first * s.step, f.family(v), v, s.gg) }[s.solve_for];
    return { x, log: s.solve_for === "dt", xlabel: s.solve_for === "dt" ? "dt [s]" : NAMES[s.solve_for], ylabel: "ξ [%]",
      at: at.length ? at[0] : null, lines: [
        { label: "ξ of the first axial mode", color: ORANGE, y: x.map((v) => finite(100 * xi(v))) },
        { label: "wanted", color: GREY, dash: [4, 4], y: x.map(() => 100 * s.target) }] };
  }

  // ---- rebound ---------------------------------------------------------------------------------------------------

  function map_defined(s) {
    return s.alpha > 0 && s.delta >= 0.5 && s.delta <= Math.min(1, s.alpha + 0.5) && s.gg > 0 && s.gg <= 1;
  }

  const LEAST_OMEGA = 0.01;  // hundreds of steps in one contact: nothing is to be seen below

  function rebound(s) {
    const block = block_of(s), frequency = f.base_frequency(block), omega = frequency * s.step;
    const command = `dda-validate contact unlocked-constant --set time.steps=50 ${set({ ...of_block(s), ...stepping(s) })}`;
    const facts = [["w_c dt", figure(omega)]], values = { frequency, omega, statistics: null };
    if (!map_defined(s) || omega < LEAST_OMEGA) {
      const why = omega < LEAST_OMEGA ? "w_c dt is below 0.01: the contact is followed in hundreds of steps" :
        "The map is defined for α > 0 and 1/2 ≤ δ ≤ min(1, α + 1/2)";
      return { values, facts: [[why, "no map"], ...facts], charts: { phase: null, steps: null }, command };
    }
    const now = f.impact_statistics(s, omega), lines = f.branches(s, omega);
    values.statistics = now;
    const at = (theta) => {
      const line = lines.find((part) => theta <= part.high) || lines[lines.length - 1];
      return line.constant + line.slope * theta;
    };
    const theta = f.linspace(0, s.gg, 201), dt = f.geomspace(0.02 / frequency, 20 / frequency, 90);
    const over = dt.map((step) => f.impact_statistics(s, frequency * step));
    return { values, command,
      facts: [["A contact returns, on average", figure(now.mean)], ["at least", figure(now.low)],
        ["at most", figure(now.high)], ["of the energy", figure(now.energy)], ...facts],
      charts: {
        phase: { x: theta, xlabel: "phase θ", ylabel: "e", lines: [
          { label: "restitution", color: ORANGE, y: theta.map(at) }] },
        steps: { x: dt, log: true, xlabel: "dt [s]", ylabel: "e", at: s.step, lines: [
          { label: "mean", color: ORANGE, y: over.map((o) => o.mean) },
          { label: "least", color: BLUE, dash: [5, 4], y: over.map((o) => o.low) },
          { label: "greatest", color: GREEN, dash: [5, 4], y: over.map((o) => o.high) }] } } };
  }

  // ---- wave loss -------------------------------------------------------------------------------------------------

  function wave(s) {
    const column = { height: s.side, density: s.density, young: s.young }, speed = Math.sqrt(s.young / s.density);
    const distance = s.wavelengths * speed / s.frequency, now = f.passage(column, s, s.frequency, distance);
    const nyquist = 0.5 / s.step, x = f.geomspace(Math.min(s.frequency / 20, nyquist / 100), Math.min(s.frequency * 20, nyquist), 240);
    const all = x.map((frequency) => f.passage(column, s, frequency, distance));
    const late = cleaned(now.delay);
    const passage = s.frequency > nyquist  // where the steps see an alias of lower frequency, which is no such wave
      ? [["No answer", `F must be at most 1/(2 dt) = ${figure(nyquist)} Hz`]]
      : [["Arrives of the amplitude", percent(1 - cleaned(now.loss))],
        [late < 0 ? "early by" : "late by", `${figure(Math.abs(late))} periods`],
        ["Steady ratio −Im W/|W| of the step at F", percent(cleaned(now.damping))],
        ["Error of the phase speed", percent(cleaned(now.speed_error))]];
    return { values: { ...now, wavelength: speed / s.frequency },
      facts: [...passage,
        ["Blocks a wavelength", figure(speed / s.frequency / s.side)],
        ["Steps a period", figure(1 / (s.frequency * s.step))], ["c dt / h", figure(speed * s.step / s.side)]],
      charts: {
        arrives: { x, log: true, xlabel: "frequency [Hz]", ylabel: "arrives [%]", at: s.frequency, lines: [
          { label: `over ${figure(distance)} m`, color: ORANGE, y: all.map((p) => 100 * (1 - p.loss)) }] },
        speed: { x, log: true, xlabel: "frequency [Hz]", ylabel: "speed error [%]", at: s.frequency, lines: [
          { label: "phase speed − c, over c", color: BLUE, y: all.map((p) => finite(100 * p.speed_error)) }] } },
      command: `dda-validate advise figures-3-4 --fmax ${s.frequency} --wavelengths ${s.wavelengths} ` +
        set({ "block.side": s.side, "block.density": s.density, "block.young": s.young, ...stepping(s) }) };
  }

  return { damping, adviser, rebound, wave };
})();
