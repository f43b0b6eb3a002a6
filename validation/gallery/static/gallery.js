"use strict";
// What the pages do: charts with values and zoom, tables that filter, calculators that answer. No data is fetched.
(() => {
  const STEPS = 65534, NONE = 65535;  // of a value in two bytes, see validation/gallery/histories.py
  const { written } = numerals;
  let printing = false;
  const charts = [];  // functions that draw again, for another width or another colour scheme

  function element(name, properties = {}, ...children) {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
  }

  const data_of = (place) => JSON.parse(place.querySelector("script.data").textContent);
  const PAPER = { "--text": "#000", "--soft": "#333", "--line": "#ccc" }, PAPER_WIDTH = 680;  // px
  const color = (name) => printing ? PAPER[name] : getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const dark = matchMedia("(prefers-color-scheme: dark)");

  // A line that is not seen on a dark ground: black becomes the colour of the text, a dark colour is lightened
  function seen(line) {
    if (!dark.matches || printing) return line;
    const [red, green, blue] = [1, 3, 5].map((i) => (parseInt(line.slice(i, i + 2), 16) / 255) ** 2.2);
    const luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    if (luminance < 0.01) return color("--text");
    return luminance < 0.1 ? `color-mix(in srgb, ${line} 60%, white)` : line;
  }

  // ---- charts ------------------------------------------------------------------------------------------------------

  // spec: x, lines [{label, color, dash, width, y, points}], xlabel, ylabel, log, logy, range, at (a marked x)
  function chart(place, spec) {
    place.replaceChildren();
    if (spec === null) return;
    const axis = { stroke: color("--soft"), grid: { stroke: color("--line"), width: 0.5 }, ticks: { stroke: color("--line") },
      font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif", labelSize: 18 };
    const values = (u, splits) => splits.map((v) => v === null ? "" : written(v, 6));
    const options = {
      width: Math.max(280, Math.min(place.clientWidth, printing ? PAPER_WIDTH : Infinity)), height: place.clientWidth < 600 ? 260 : 340,
      scales: { x: { time: false, distr: spec.log ? 3 : 1, range: (u, low, high) => [low, high] }, y: { distr: spec.logy ? 3 : 1, range: spec.range } },
      axes: [{ ...axis, label: spec.xlabel, values, ...(spec.log ? logarithmic : {}) },
        { ...axis, label: spec.ylabel, size: 62, values, ...(spec.logy ? logarithmic : {}) }],
      legend: { live: true }, cursor: { drag: { x: true, y: false }, points: { size: 6 } },
      series: [{ label: spec.xlabel, value: (u, v) => written(v) }, ...spec.lines.map((line) => ({
        label: line.label, stroke: seen(line.color), dash: line.dash, width: (line.width || 1) * 1.5, pxAlign: 0,
        spanGaps: Boolean(line.points), points: { show: Boolean(line.points || line.dots), size: line.dots ? 4 : 7 },
        ...(line.dots ? { paths: () => null } : {}),  // an exact solution at few instants: joined it would be a zigzag
        value: (u, v) => written(v) }))],
      hooks: { draw: [(u) => mark(u, spec.at)], setCursor: [(u) => spec.cursor && spec.cursor(u.cursor.idx)] },
    };
    const plot = new uPlot(options, [spec.x, ...spec.lines.map((line) => line.y)], place);
    place.prepend(zoom_buttons(plot, spec));
    place.tabIndex = 0;
    place.setAttribute("role", "group");
    place.setAttribute("aria-label", `${place.dataset.label}; arrows move the cursor, plus and minus zoom, 0 shows all`);
    place.onkeydown = (event) => key(event, plot, spec);
    plot.root.querySelector("canvas").setAttribute("aria-hidden", "true");
  }

  // Ticks of a logarithmic axis: the library's own do not end where the axis begins beside a power of ten
  const logarithmic = {
    splits: (plot, axis, low, high) => {
      const found = [];
      for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++)
        for (let digit = 1; digit < 10; digit++) found.push(Number(`${digit}e${power}`));
      const inside = found.filter((value) => value >= low && value <= high);
      return inside.length > 2 ? inside : [0, 1, 2, 3, 4].map((i) => low * (high / low) ** (i / 4));
    },
    // labels of all ticks, of 1, 2 and 5, or of powers of ten, as many as there is room for
    filter: (plot, splits, axis) => {
      const room = (axis === 0 ? plot.bbox.width / 64 : plot.bbox.height / 20) / devicePixelRatio;
      const chosen = ["123456789", "125", "15", "1"].map((digits) =>
        splits.map((value) => digits.includes(value.toExponential()[0]) ? value : null));
      return chosen.find((some) => some.filter((value) => value !== null).length <= room) || chosen[3];
    },
  };

  function mark(plot, at) {
    if (at === null || at === undefined) return;
    const x = plot.valToPos(at, "x", true), { left, width, top, height } = plot.bbox;
    if (x < left || x > left + width) return;
    plot.ctx.save();
    plot.ctx.strokeStyle = color("--soft");
    plot.ctx.setLineDash([3, 4]);
    plot.ctx.beginPath();
    plot.ctx.moveTo(x, top);
    plot.ctx.lineTo(x, top + height);
    plot.ctx.stroke();
    plot.ctx.restore();
  }

  function zoom(plot, spec, factor) {
    const to = spec.log ? Math.log : Number, from = spec.log ? Math.exp : Number;
    const { min, max } = plot.scales.x, index = plot.cursor.idx;
    const first = spec.x[0], last = spec.x[spec.x.length - 1];
    if (factor === null) return plot.setScale("x", { min: first, max: last });
    const middle = index === null || index === undefined ? (to(min) + to(max)) / 2 : to(spec.x[index]);
    const low = middle - (middle - to(min)) * factor, high = middle + (to(max) - middle) * factor;
    plot.setScale("x", { min: Math.max(first, from(low)), max: Math.min(last, from(high)) });
  }

  function zoom_buttons(plot, spec) {
    const button = (text, title, factor) => element("button", { type: "button", textContent: text, title,
      ariaLabel: title, onclick: () => zoom(plot, spec, factor) });
    return element("div", { className: "zoom" }, button("+", "Zoom in", 0.5), button("−", "Zoom out", 2),
      button("all", "Show all", null));
  }

  function key(event, plot, spec) {
    const steps = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10 }, factors = { "+": 0.5, "=": 0.5, "-": 2, 0: null };
    if (event.target !== event.currentTarget || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key in factors) zoom(plot, spec, factors[event.key]);
    else if (event.key in steps) {
      const old = plot.cursor.idx ?? 0, index = Math.min(spec.x.length - 1, Math.max(0, old + steps[event.key]));
      plot.setCursor({ left: plot.valToPos(spec.x[index], "x"), top: plot.bbox.height / devicePixelRatio / 2 });
    } else return;
    event.preventDefault();
  }

  function drawn(draw) {
    charts.push(draw);
    draw();
  }

  const redraw = () => charts.forEach((draw) => draw());
  let width = innerWidth;
  addEventListener("resize", () => {
    if (innerWidth !== width) requestAnimationFrame(redraw);
    width = innerWidth;
  });
  dark.addEventListener("change", redraw);
  addEventListener("beforeprint", () => { printing = true; redraw(); });
  addEventListener("afterprint", () => { printing = false; redraw(); });

  // ---- histories ---------------------------------------------------------------------------------------------------

  function unpacked([low, high, text]) {
    const bytes = Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
    return Array.from({ length: bytes.length / 2 }, (_, i) => {
      const k = bytes[2 * i] + 256 * bytes[2 * i + 1];
      return k === NONE ? null : low * (1 - k / STEPS) + high * (k / STEPS);
    });
  }

  // Instants of the samples: every step, or begin and middle of each part
  function instants({ time: [first, last, listed], steps }, samples) {
    if (listed.length) return listed;
    const at = (i) => steps > 1 ? first + (last - first) * i / (steps - 1) : first;
    if (samples === steps) return Array.from({ length: steps }, (_, i) => at(i));
    const parts = samples / 2, edge = (i) => Math.floor(i * steps / parts);
    return Array.from({ length: samples }, (_, j) => {
      const i = Math.floor(j / 2);
      return at(j % 2 ? Math.floor((edge(i) + edge(i + 1)) / 2) : edge(i));
    });
  }

  // Factor and unit with the SI prefix that brings a value between 1 and 1000
  function engineering(largest, unit) {
    if (!unit || !(largest > 0) || !Number.isFinite(largest)) return [1, unit];
    const power = Math.min(9, Math.max(-9, 3 * Math.floor(Math.log10(largest) / 3)));
    return [10 ** -power, { "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G" }[power] + unit];
  }

  function histories(section) {
    const data = data_of(section), form = section.querySelector("form");
    const place = section.querySelector(".chart"), names = Object.keys(data.columns);
    drawn(() => {
      const one = data.cases[form.case.value], column = form.column.value, [title, unit] = data.columns[column];
      const curves = Object.entries(one.columns[column] || {}).map(([solver, packed]) => [solver, unpacked(packed)]);
      if (!curves.length) return place.replaceChildren(element("p", { textContent: `No solver reports ${column} here.` }));
      const limit = column === "displacement" && one.limit !== null ? one.limit : Infinity;
      const known = curves.flatMap(([, y]) => y).filter((v) => v !== null).map((v) => Math.min(limit, Math.max(-limit, v)));
      const low = Math.min(0, ...known), high = Math.max(0, ...known), pad = 0.05 * (high - low) || 1;
      const [factor, shown] = engineering(Math.max(-low, high), unit);
      return chart(place, {
        x: instants(one, curves[0][1].length), xlabel: "time [s]", ylabel: `${title}${shown ? ` [${shown}]` : ""}`,
        range: [factor * (low - pad), factor * (high + pad)],
        lines: curves.map(([solver, y]) => ({ label: solver, ...data.solvers[solver], dots: (one.dots[column] || []).includes(solver),
          y: y.map((v) => v === null ? null : factor * v) })) });
    });
    const tell = () => {
      const index = form.case.value, one = data.cases[index];
      section.querySelector(".drawn").textContent = one.whole ? `All ${one.steps} steps are drawn.` :
        `Of ${one.steps} steps the least and the greatest value of each of equal parts are drawn.`;
      const dots = [...new Set(Object.values(one.dots).flat())];
      if (dots.length) section.querySelector(".drawn").textContent +=
        ` Dots: ${dots.join(" and ")} at the steps, too few to be joined.`;
      section.querySelector(".told").replaceChildren(...one.told.map((text) => element("li", { textContent: text })));
      numbers(section.querySelector(".numbers"), data, index);
      for (const option of form.column.options) option.disabled = !(names[option.index] in one.columns);
      if (form.column.selectedOptions[0]?.disabled) form.column.value = Object.keys(one.columns)[0];
    };
    form.addEventListener("change", () => { tell(); charts[0](); });
    tell();
  }

  function numbers(table, data, index) {
    const heads = ["solver", ...data.metrics.map(([name, unit]) => unit === "1" ? name : `${name} [${unit}]`), "steps"];
    const titles = ["", ...data.metrics.map(([, , says]) => says), "steps that were run"];
    // a line a metric, a column a solver: few solvers, many metrics
    const rows = data.numbers[index];
    table.tHead.replaceChildren(element("tr", {}, element("th", { textContent: "" }),
      ...rows.map((row) => element("th", { textContent: row[0], className: "number" }))));
    table.tBodies[0].replaceChildren(...heads.slice(1).map((head, i) => element("tr", {},
      element("th", { textContent: head, title: titles[i + 1], scope: "row" }),
      ...rows.map((row) => element("td", { textContent: row[i + 1], className: "decimal" })))));
  }

  // ---- verdicts ----------------------------------------------------------------------------------------------------

  const FIRST_ROWS = 60;

  function verdicts(section) {
    const { words, rows } = data_of(section), form = section.querySelector("form"), body = section.querySelector("tbody");
    const said = form.querySelector("output"), more = section.querySelector(".more");
    const texts = rows.map((row) => row.slice(0, 6).map((i) => words[i]).join(" ").toLowerCase());
    let all = false;
    const show = () => {
      const wanted = form.words.value.toLowerCase().split(/\s+/).filter(Boolean);
      const boxes = [...form.querySelectorAll("[name=verdict]")].filter((box) => box.checked).map((box) => box.value);
      const found = rows.filter((row, i) => boxes.includes(words[row[0]]) && wanted.every((word) => texts[i].includes(word)));
      const kept = all ? found : found.slice(0, FIRST_ROWS);
      body.replaceChildren(...kept.map((row) => verdict_row(row, words)));
      said.textContent = `${found.length} of ${rows.length} gates`;
      more.hidden = kept.length === found.length;
      more.textContent = `Show the other ${found.length - kept.length}`;
    };
    more.addEventListener("click", () => { all = true; show(); });
    form.addEventListener("input", show);
    form.addEventListener("submit", (event) => event.preventDefault());
    addEventListener("beforeprint", () => { all = true; show(); });
    show();
  }

  function verdict_row(row, words) {
    const kinds = { PASS: "pass", FAIL: "fail", "NOT RUN": "notrun" };
    const cells = row.slice(0, 6).map((i, column) => element("td", { textContent: words[i],
      className: column === 0 ? kinds[words[i]] : column === 3 ? "code" : "" }));
    const number = row[6] + 1;
    const link = element("a", { href: `#reason-${number}`, textContent: `why ${number}` });
    return element("tr", {}, ...cells, element("td", {}, link));
  }

  // ---- calculators -----------------------------------------------------------------------------------------------------

  function calculator(place) {
    const form = place.querySelector("form"), compute = calculators[place.dataset.calculator];
    const sliders = [...form.querySelectorAll("[type=range]")];
    sliders.forEach((slider) => {
      const number = form.elements[slider.dataset.for], low = Number(number.min), high = Number(number.max);
      const to = "log" in slider.dataset ? (v) => Math.log(v / low) / Math.log(high / low) : (v) => (v - low) / (high - low);
      const from = "log" in slider.dataset ? (s) => low * (high / low) ** s : (s) => low + s * (high - low);
      slider.show = () => { slider.value = 1000 * to(Number(number.value)); slider.ariaValueText = number.value; };
      slider.addEventListener("input", () => { number.value = Number(from(slider.value / 1000).toPrecision(3)); });
    });
    form.addEventListener("input", (event) => {
      if (event.target.name === "scheme" && event.target.value !== "custom")
        [form.alpha.value, form.delta.value] = event.target.value.split(",");
      answer();
      if (form.checkValidity()) history.replaceState(null, "", address());
    });
    form.addEventListener("reset", () => requestAnimationFrame(() => {
      history.replaceState(null, "", location.pathname);
      answer();
    }));
    addEventListener("hashchange", () => { from_address(); answer(); });
    form.addEventListener("submit", (event) => event.preventDefault());

    // The settings stand behind # in the address, so that an answer can be sent; names that the form lacks are left out.
    function address() {
      const texts = [...new FormData(form)].filter(([name]) => name !== "scheme");
      return `#${new URLSearchParams(texts)}`;
    }

    function from_address() {
      for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
        const one = form.elements.namedItem(name);
        const known = one instanceof HTMLSelectElement ? [...one.options].some((option) => option.value === text)
          : one instanceof HTMLInputElement && text.trim() !== "" && Number.isFinite(Number(text));
        if (known) one.value = text;
      }
    }

    function answer() {
      const wrong = place.querySelector(".wrong"), bad = [...form.elements].find((one) => one.willValidate && !one.checkValidity());
      wrong.hidden = bad === undefined;
      if (bad !== undefined) {
        wrong.textContent = `${form.querySelector(`label[for=${bad.id}]`).textContent.trim()}: must be from ${bad.min} to ${bad.max}`;
        return;
      }
      sliders.forEach((slider) => slider.show());
      if (form.elements.scheme) {
        const options = [...form.scheme.options], pair = `${Number(form.alpha.value)},${Number(form.delta.value)}`;
        form.scheme.value = options.some((option) => option.value === pair) ? pair : "custom";
      }
      for (const [select, applies] of Object.entries(APPLIES))
        if (form.elements[select]) for (const [name, values] of Object.entries(applies))
          if (form.elements[name]) form.elements[name].closest(".control").hidden = !values.includes(form.elements[select].value);
      place.querySelector(".share").href = address();
      const found = compute(settings(form));
      place.answer = found;
      place.querySelector(".facts").replaceChildren(...found.facts.map(([name, value]) =>
        element("div", {}, element("dt", { textContent: name }), element("dd", { textContent: value }))));
      modes(place.querySelector(".modes"), found.table);
      place.querySelector(".command").textContent = found.command;
      for (const one of place.querySelectorAll(".chart")) chart(one, found.charts[one.dataset.chart]);
    }
    from_address();
    drawn(answer);
  }

  // Which controls go with which choice of a select; the others are hidden
  const RADII = ["chung-hulbert", "hht", "wbz", "composite"];
  const APPLIES = {
    method: { scheme: ["newmark"], alpha: ["newmark"], delta: ["newmark"], rho_inf: RADII },
    solve_for: { e: ["restitution"], zeta: ["damping_ratio"] },
    engine: { hertz: ["box2d"], damping_ratio: ["box2d"], erp: ["bullet"], cfm: ["bullet"], timeconst: ["mujoco"],
      dampratio: ["mujoco"], dmax: ["mujoco"], stiffness: ["spring"], e: ["spring"] },
  };

  function settings(form) {
    const texts = [...new FormData(form)].filter(([name]) => name !== "scheme");
    return Object.fromEntries(texts.map(([name, value]) =>
      [name, form.elements[name] instanceof HTMLSelectElement ? value : Number(value)]));
  }

  function modes(table, rows) {
    table.hidden = rows === undefined;
    if (rows === undefined) return;
    table.replaceChildren(...rows.map((row, i) => element("tr", {}, ...row.map((text, j) =>
      element(i && j ? "td" : "th", { textContent: text })))));
  }

  document.querySelectorAll(".histories").forEach(histories);
  document.querySelectorAll(".verdicts").forEach(verdicts);
  document.querySelectorAll(".calculator").forEach(calculator);
})();
