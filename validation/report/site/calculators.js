"use strict";
// The page of the calculators: settings in, numbers and the equal command out. The settings stand in the address.
(() => {
  const form = document.querySelector(".settings"), answer = document.querySelector(".answer");

  // A number with significant digits, as a power of ten outside 1e-3 to 1e6
  function written(value, digits = 5) {
    if (!Number.isFinite(value)) return Number.isNaN(value) ? "–" : "∞";
    const rounded = Math.abs(value) < 1e-12 ? 0 : Number(value.toPrecision(digits)), size = Math.abs(rounded);
    const text = size === 0 || (size >= 1e-3 && size < 1e6) ? String(rounded) : rounded.toExponential();
    return text.replace("-", "−");
  }
  const percent = (value) => `${written(100 * value)} %`;

  function settings() {
    const s = Object.fromEntries([...new FormData(form)].map(([name, text]) => [name, name === "solve_for" ? text : Number(text)]));
    return { ...s, width: s.side, height: s.side, stiffness: s.stiffness_ratio * s.young };
  }

  function command(words, s) {
    const keys = { "block.side": s.side, "block.density": s.density, "block.young": s.young, "contact.stiffness": s.stiffness,
      "time.step": s.step, "time.alpha": s.alpha, "time.delta": s.delta, "time.gg": s.gg };
    return `dda-validate ${words} ${Object.entries(keys).map(([key, value]) => `--set ${key}=${value}`).join(" ")}`;
  }

  function show(place, lines, typed) {
    answer.querySelector(`${place} tbody`).replaceChildren(...lines.map(([head, ...cells]) => {
      const row = document.createElement("tr");
      const parts = [["th", head], ...cells.map((text) => ["td", text])];
      row.append(...parts.map(([name, textContent]) => Object.assign(document.createElement(name), { textContent })));
      return row;
    }));
    answer.querySelector(`${place} .command`).textContent = typed;
  }

  function compute() {
    const bad = [...form.elements].find((one) => one.willValidate && !one.checkValidity()), wrong = document.querySelector(".wrong");
    wrong.hidden = bad === undefined;
    answer.hidden = bad !== undefined;
    if (bad) {
      wrong.textContent = `${bad.labels[0].textContent.trim()}: must be from ${bad.min} to ${bad.max}`;
      return;
    }
    const s = settings(), { modes, limit, transit } = damping.analyse(s), both = Object.values(modes);
    show("#damping", [
      ["frequency [rad/s]", ...both.map((mode) => written(mode.frequency))],
      ["ω dt", ...both.map((mode) => written(mode.omega))],
      ["damping ratio ξ", ...both.map((mode) => percent(mode.damping))],
      ["algorithmic part", ...both.map((mode) => percent(mode.algorithmic))],
      ["kinetic part", ...both.map((mode) => percent(mode.kinetic))],
      ["amplitude kept in a step", ...both.map((mode) => percent(mode.spectral_radius))],
      ["period elongation", ...both.map((mode) => percent(mode.period_elongation))],
      ["stable up to dt [s]", written(limit), ""],
      ["travel time of the wave [s]", written(transit), ""],
    ], command("advise damping figures-3-4", s));
    const { values, reach } = adviser.advise(s, s, s.target, s.solve_for);
    const unit = s.solve_for === "dt" ? " s" : "", name = { dt: "dt", gg: "gg", scheme: "δ" }[s.solve_for];
    const alpha = (value) => s.solve_for === "scheme" ? `, α = ${written(adviser.family(value), 8)}` : "";
    show("#adviser", [
      ...values.map((value, i) => [i ? "or" : "set", `${name} = ${written(value, 8)}${unit}${alpha(value)}`]),
      ...(values.length ? [] : [["set", "no value does"]]),
      ...(reach ? [["least that can be had", percent(reach.least)],
        ["greatest that can be had", `${percent(reach.greatest)} at ${name} = ${written(reach.greatest_at)}${unit}`]] : []),
    ], command(`advise step figures-3-4 --damping ${s.target} --solve-for ${s.solve_for}`, s));
    answer.dataset.values = JSON.stringify({ modes, values });
  }

  function from_address() {
    for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
      const one = form.elements.namedItem(name);
      const known = one instanceof HTMLSelectElement ? [...one.options].some((option) => option.value === text)
        : one instanceof HTMLInputElement && text.trim() !== "" && Number.isFinite(Number(text));
      if (known) one.value = text;
    }
    compute();
  }

  form.addEventListener("input", () => {
    compute();
    if (form.checkValidity()) history.replaceState(null, "", `#${new URLSearchParams(new FormData(form))}`);
  });
  form.addEventListener("reset", () => requestAnimationFrame(() => {
    history.replaceState(null, "", location.pathname);
    compute();
  }));
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", from_address);
  from_address();
})();
