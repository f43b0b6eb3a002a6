"use strict";
// Numbers as the pages write them.
const numerals = (() => {
  // A number with significant digits, as a power of ten outside 1e-3 to 1e6
  function written(value, digits = 5) {
    if (value === null || value === undefined || Number.isNaN(value)) return "–";
    if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
    const rounded = Number(value.toPrecision(digits)), size = Math.abs(rounded);
    if (size === 0 || (size >= 1e-3 && size < 1e6)) return String(rounded).replace("-", "−");
    const [mantissa, power] = rounded.toExponential().split("e");
    const raised = [...power.replace("+", "")].map((sign) => sign === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[sign]).join("");
    return `${mantissa === "1" ? "" : `${mantissa}×`}10${raised}`.replace("-", "−");
  }

  return { written };
})();
