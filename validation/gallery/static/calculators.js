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
    const step = { "time.step": s.step, "time.gg": s.gg };
    if (s.method === undefined || s.method === "newmark") return { ...step, "time.alpha": s.alpha, "time.delta": s.delta };
    if (s.method === "leapfrog") return { ...step, "time.scheme": s.method, "time.start": "consistent" };
    return { ...step, "time.scheme": s.method, "time.rho_inf": s.rho_inf };
  }

  // What stands in the place of an answer where a scheme has no such rho_inf
  function refusal(s) {
    return s.method === "hht" && s.rho_inf < 0.5 ? "HHT-α has ρ∞ from 0.5 to 1" : null;
  }

  function of_block(s) {
    return { "block.side": s.side, "block.density": s.density, "block.young": s.young,
      "contact.stiffness": s.stiffness_ratio * s.young };
  }

  // ---- damping budget --------------------------------------------------------------------------------------------

  function mode(frequency, s) {
    const omega = frequency * s.step, total = f.step_ratio(s, omega);
    const own = f.step_ratio({ ...s, gg: 1 }, omega);
    return { frequency, omega, damping: finite(total), algorithmic: finite(own), kinetic: finite(total - own),
      radius: f.step_radius(s, omega), elongation: finite(f.step_elongation(s, omega)) };
  }

  function damping(s) {
    const block = block_of(s), first = f.dda_frequency(block), contact = f.contact_frequency(block);
    const modes = { "first axial": mode(first, s), contact: mode(contact, s) };
    if (refusal(s)) return { values: null, facts: [["No answer", refusal(s)]], charts: { budget: null }, command: "" };
    const limit = f.step_limit(s) / contact;
    const dt = f.geomspace(Math.min(1e-3 / first, s.step / 2), Math.max(30 / first, s.step * 2), 240);
    const over = (w, gg) => dt.map((step) => finite(100 * f.step_ratio({ ...s, gg }, w * step)));
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
    if (s.method !== "newmark") return !refusal(s);
    return s.alpha > 0 && s.delta >= 0.5 && s.delta <= Math.min(1, s.alpha + 0.5) && s.gg > 0 && s.gg <= 1;
  }

  const LEAST_OMEGA = 0.01;  // hundreds of steps in one contact: nothing is to be seen below

  function rebound(s) {
    const block = block_of(s), frequency = f.base_frequency(block), omega = frequency * s.step;
    const command = `dda-validate contact unlocked-constant --set time.steps=50 ${set({ ...of_block(s), ...stepping(s) })}`;
    const facts = [["w_c dt", figure(omega)]], values = { frequency, omega, statistics: null };
    if (!map_defined(s) || omega < LEAST_OMEGA) {
      const why = omega < LEAST_OMEGA ? "w_c dt is below 0.01: the contact is followed in hundreds of steps" :
        refusal(s) ?? "The map is defined for α > 0 and 1/2 ≤ δ ≤ min(1, α + 1/2)";
      return { values, facts: [[why, "no map"], ...facts], charts: { phase: null, steps: null }, command };
    }
    const exact = s.method === "newmark";  // straight lines; of the other schemes a hundred phases
    if (!exact && !(omega < f.step_limit(s)))
      return { values, facts: [["Beyond w_c dt = 2 the leapfrog throws the mass", "no map"], ...facts],
        charts: { phase: null, steps: null }, command };
    const statistics = exact ? f.impact_statistics : f.rebound_statistics;
    const now = statistics(s, omega), lines = exact ? f.branches(s, omega) : [], all = f.stages(s);
    values.statistics = now;
    const at = (theta) => {
      if (!exact) return f.rebound_at(all, omega, theta, s.gg);
      const line = lines.find((part) => theta <= part.high) || lines[lines.length - 1];
      return line.constant + line.slope * theta;
    };
    const theta = f.linspace(0, s.gg, 201);
    const dt = f.geomspace((exact ? 0.02 : 0.1) / frequency, Math.min(20, 0.99 * f.step_limit(s)) / frequency, exact ? 90 : 40);
    const over = dt.map((step) => statistics(s, frequency * step));
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
    if (refusal(s)) return { values: null, facts: [["No answer", refusal(s)]], charts: { arrives: null, speed: null }, command: "" };
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

  // ---- hidden damping of all schemes -------------------------------------------------------------------------------

  const SHOWN = {  // name, and what is fixed of it; rho_inf of the others is that of the page
    "(1/2, 1)": { method: "newmark", alpha: 0.5, delta: 1 },
    "(1/4, 1/2)": { method: "newmark", alpha: 0.25, delta: 0.5 },
    "CH 0": { method: "chung-hulbert", rho_inf: 0 },
    "CH": { method: "chung-hulbert" },
    "HHT": { method: "hht" },
    "WBZ": { method: "wbz" },
    "composite": { method: "composite" },
    "leapfrog": { method: "leapfrog" },
  };
  const COLORS = [ORANGE, GREY, GREEN, BLUE, "#5d3a9b", "#cc79a7", "#8c6d1f", "#56b4e9"];
  const IMPACTS = [0.3, 1, 2, 3, 5, 10, 100, 1e5];  // w_c dt at which rebounds are looked at

  function schemes(s) {
    const block = block_of(s), frequencies = { at: 2 * Math.PI * s.frequency, first: f.dda_frequency(block),
      contact: f.contact_frequency(block) };
    const impact = f.base_frequency(block) * s.step, values = {};
    for (const [name, fixed] of Object.entries(SHOWN)) {
      const one = { rho_inf: s.rho_inf, gg: 1, ...fixed };
      if (refusal(one)) continue;
      const grows = frequencies.contact * s.step > f.step_limit(one);
      const ratios = Object.fromEntries(Object.entries(frequencies).map(([key, w]) => [key, grows ? null : finite(f.step_ratio(one, w * s.step))]));
      const explicit = one.method === "leapfrog";
      values[name] = { ...ratios, grows, solves: f.solves(one) / s.step, contact_radius: f.step_radius(one, frequencies.contact * s.step),
        rebound: grows ? null : f.rebound_statistics(one, Math.min(Math.max(impact, 0.05), 1e5)).high,
        greatest: explicit ? null : Math.max(...IMPACTS.map((omega) => f.rebound_statistics(one, omega, 0, 40).high)) };
    }
    const text = (value) => value === null ? "–" : percent(cleaned(value)), plain = (value) => value === null ? "–" : figure(value, 3);
    const hertz = f.geomspace(s.frequency / 30, Math.min(s.frequency * 100, 0.5 / s.step), 160);
    return { values, frequencies,
      table: [["scheme", `ξ at ${figure(s.frequency)} Hz`, "first axial", "contact", "contact kept a step", "solves a second", "rebound", "at any step"],
        ...Object.entries(values).map(([name, v]) => [name + (["CH", "HHT", "WBZ", "composite"].includes(name) ? ` ${s.rho_inf}` : ""),
          text(v.at), text(v.first), text(v.contact), percent(v.contact_radius), figure(v.solves), plain(v.rebound), plain(v.greatest)])],
      facts: [["ω dt of the frequency", figure(frequencies.at * s.step)], ["of the first axial mode", figure(frequencies.first * s.step)],
        ["of the contact mode", figure(frequencies.contact * s.step)],
        ...(s.rho_inf < 0.5 ? [["HHT-α", "has ρ∞ from 0.5 to 1"]] : []),
        ...(values.leapfrog.grows ? [["Leapfrog", "the step is beyond its limit"]] : [])],
      charts: { spectrum: { x: hertz, log: true, xlabel: "frequency [Hz]", ylabel: "ξ [%]", at: s.frequency,
        lines: Object.keys(values).map((name, i) => ({ label: name, color: COLORS[i],
          y: hertz.map((one) => finite(100 * f.step_ratio({ rho_inf: s.rho_inf, gg: 1, ...SHOWN[name] }, 2 * Math.PI * one * s.step))) })) } },
      command: `dda-validate advise figures-3-4 --damping ${Math.max(1e-5, Number((values["(1/2, 1)"].at ?? 0.05).toPrecision(3)))} --at ${s.frequency} ` +
        set({ ...of_block(s), "time.step": s.step }) };
  }

  // ---- restitution and damping ratio ----------------------------------------------------------------------------------

  function dashpot(s) {
    const zeta = s.solve_for === "restitution" ? f.ratio_of_restitution(s.e) : s.zeta, e = f.restitution(zeta);
    const w = Math.sqrt(s.stiffness / s.mass), c = 2 * zeta * Math.sqrt(s.stiffness * s.mass), omega = w * s.step;
    const one = { ...s, gg: 1 }, limited = s.method === "leapfrog" && omega >= 2;
    const mapped = !refusal(s) && !limited && omega >= LEAST_OMEGA;
    const now = mapped ? f.rebound_statistics(one, omega, zeta) : null;
    const ratios = f.geomspace(0.01, 10, 200), top = s.method === "leapfrog" ? 1.8 : 10;
    const dt = f.geomspace(0.05 / w, top / w, 40);
    const over = refusal(s) ? [] : dt.map((step) => f.rebound_statistics(one, w * step, zeta));
    return { values: { zeta, e, c, unclipped: f.restitution(zeta, false), omega, rebound: now },
      facts: [s.solve_for === "restitution" ? ["Damping ratio ζ", figure(zeta, 6)] : ["Restitution e", figure(e, 6)],
        ["Dashpot c", `${figure(c)} N s/m`], ["A contact that pulls would return", figure(f.restitution(zeta, false))],
        ...(now ? [["The scheme returns, on average", figure(now.mean)], ["at least", figure(now.low)], ["at most", figure(now.high)]]
          : [["No rebound of steps", refusal(s) ?? (limited ? "w_c dt is beyond the limit 2" : "w_c dt is below 0.01")]]),
        ["w_c dt", figure(omega)]],
      charts: { closed: { x: ratios, log: true, xlabel: "ζ", ylabel: "e", at: zeta, lines: [
        { label: "pushes only", color: ORANGE, y: ratios.map((z) => f.restitution(z)) },
        { label: "pulls until the gap closes", color: GREY, dash: [5, 4], y: ratios.map((z) => f.restitution(z, false)) }] },
      steps: refusal(s) ? null : { x: dt, log: true, xlabel: "dt [s]", ylabel: "e", at: s.step, lines: [
        { label: "mean", color: ORANGE, y: over.map((o) => o.mean) }, { label: "least", color: BLUE, dash: [5, 4], y: over.map((o) => o.low) },
        { label: "greatest", color: GREEN, dash: [5, 4], y: over.map((o) => o.high) },
        { label: "exact in time", color: GREY, y: dt.map(() => e) }] } },
      command: `dda-validate translate spring --stiffness ${s.stiffness} --restitution ${e} --mass ${s.mass} --step ${s.step}` };
  }

  // ---- contacts of physics engines --------------------------------------------------------------------------------------

  function engines(s) {
    const { k, c, share } = f.soft_contact(s), w = Math.sqrt(k / s.mass), zeta = c / (2 * Math.sqrt(k * s.mass)), W = w * s.step;
    const explicit = s.engine === "mujoco", resists = 1 + 2 * zeta * W + W * W;
    const determinant = explicit ? 1 - 2 * zeta * W : 1 / resists, gravity = 9.81, rest = share * s.mass * gravity / k;
    const a1 = 2 * zeta + W, a2 = W * a1, own = { mass: s.mass, step: s.step };
    const stated = { box2d: `--hertz ${s.hertz} --damping-ratio ${s.damping_ratio}`, bullet: `--erp ${s.erp} --cfm ${s.cfm}`,
      mujoco: `--timeconst ${s.timeconst} --dampratio ${s.dampratio} --dmax ${s.dmax}`,
      spring: `--stiffness ${s.stiffness} --restitution ${s.e}` }[s.engine];
    // implicit Euler is one stage whose force is that of its end
    const euler = [{ d_u: 1, d_g: 0, e_0: 0, e_g: 0, beta: 1, g_0: 0, g_g: 0, gamma: 1, am: 0, af: 0 }];
    const dt = f.geomspace(0.05 / w, 10 / w, 40), phases = f.linspace(0.025, 0.975, 20);
    const mean = (step) => phases.reduce((all, theta) => all + f.rebound_at(euler, w * step, theta, 1, zeta), 0) / phases.length;
    return { values: { stiffness: k, damping: c, frequency: w, damping_ratio: zeta, restitution: f.restitution(zeta),
      rest_penetration: rest, determinant, hertz: w / (2 * Math.PI), erp: s.step * k / (s.step * k + c), cfm: 1 / (s.step * k + c),
      timeconst: zeta ? 1 / (w * zeta) : null, ...own },
      facts: [["Stiffness k", `${figure(k)} N/m`], ["Dashpot c", `${figure(c)} N s/m`], ["Damping ratio ζ", figure(zeta)],
        ["Restitution, exact in time", figure(f.restitution(zeta))], ["Penetration at rest", `${figure(1e3 * rest)} mm`],
        ["Determinant of a closed step", figure(determinant, 6)], ["w h", figure(W)],
        ["Box2D", `hertz ${figure(w / (2 * Math.PI))}, damping ratio ${figure(zeta)}, massScale ${figure(a2 / (1 + a2))}`],
        ["Bullet", `erp ${figure(s.step * k / (s.step * k + c))}, cfm ${figure(1 / (s.step * k + c))}`],
        ["MuJoCo", zeta ? `timeconst ${figure(1 / (w * zeta))} s, dampratio ${figure(zeta)}` : "no timeconst without a dashpot"],
        ...(explicit && s.timeconst < 2 * s.step ? [["MuJoCo takes", "two steps for a shorter timeconst"]] : []),
        ["Scene, two corners", `contact.stiffness = ${figure(k / 2)}, damping_ratio = ${figure(zeta)}`]],
      charts: { landing: { x: dt, log: true, xlabel: "h [s]", ylabel: "e", at: s.step, lines: [
        { label: "implicit steps (Box2D, Bullet), mean", color: ORANGE, y: dt.map(mean) },
        { label: "exact in time", color: GREY, dash: [4, 4], y: dt.map(() => f.restitution(zeta)) }] } },
      command: `dda-validate translate ${s.engine} ${stated} --mass ${s.mass} --step ${s.step}` };
  }

  return { damping, adviser, rebound, wave, schemes, dashpot, engines };
})();
