// The fields of the result, to the last digit.
import { fieldsOf } from "./data.js";
import { drawing, element } from "./dom.js";
import { full } from "./text.js";

const first = [
  "status",
  "message",
  "duration",
  "action",
  "energy",
  "energy_drift",
  "error_estimate",
  "residual",
  "morse_index",
  "nullity",
  "minimizing",
  "certificate",
];
const elsewhere = new Set(["title", "samples", "solutions", "nodes", "windows", "start"]);
const mostRows = 64; // of an object
const longest = 16; // entries of a list that are written out

const label = (key) => key.replaceAll("_", " ");

/** Any value of JSON. */
function value(data) {
  if (data === null) return element("span", { class: "none" }, "\u2013");
  if (typeof data === "boolean") return data ? "yes" : "no";
  if (typeof data === "number") return full(data);
  if (typeof data === "string") return data;
  if (Array.isArray(data)) return list(data);
  return table(Object.entries(data));
}

function list(entries) {
  if (!entries.length) return "none";
  if (entries.every((entry) => entry === null || typeof entry === "number")) {
    const shown = entries
      .slice(0, longest)
      .map((entry) => (entry === null ? "\u2013" : full(entry)))
      .join(", ");
    return entries.length > longest ? `${shown} and ${entries.length - longest} more` : shown;
  }
  const complex = entries.every((entry) => Array.isArray(entry) && entry.length === 2);
  const shown = entries
    .slice(0, longest)
    .map((entry) => element("li", {}, complex ? entry.map(full).join(", ") : value(entry)));
  if (entries.length > longest) shown.push(element("li", {}, `and ${entries.length - longest} more`));
  return element("ul", {}, ...shown);
}

function table(all) {
  const entries = all.slice(0, mostRows);
  if (all.length > mostRows) entries.push(["\u2026", `${all.length - mostRows} more`]);
  return element(
    "table",
    {},
    element(
      "tbody",
      {},
      ...entries.map(([key, data]) =>
        element("tr", {}, element("th", { scope: "row" }, key), element("td", {}, value(data))),
      ),
    ),
  );
}

/** Multipliers about the unit circle; the radius r is drawn as 2r/(1 + r), so that all are in sight. */
function circle(multipliers) {
  const radius = (r) => (2 * r) / (1 + r);
  const dots = multipliers.map(([re, im]) => {
    const r = Math.hypot(re, im),
      scale = r > 0 ? radius(r) / r : 0;
    const on = Math.abs(r - 1) < 1e-6;
    return drawing("circle", { cx: 40 * re * scale, cy: -40 * im * scale, r: 4, class: on ? "on" : "off" });
  });
  return drawing(
    "svg",
    { viewBox: "-90 -90 180 180", class: "multipliers", role: "img", "aria-label": "Multipliers" },
    drawing("circle", { r: 80, class: "bound" }),
    drawing("circle", { r: 40, class: "unit" }),
    drawing("path", { d: "M-80 0H80M0 -80V80", class: "bound" }),
    ...dots,
  );
}

export class Numbers {
  constructor(state) {
    this.state = state;
    this.node = element("section", { class: "card numbers", "aria-label": "Numbers" });
    state.on("select", () => this.fill());
    this.fill();
  }

  fill() {
    const fields = fieldsOf(this.state.data, this.state.selected);
    const keys = [
      ...first.filter((key) => key in fields),
      ...Object.keys(fields).filter((key) => !first.includes(key) && !elsewhere.has(key)),
    ];
    if (fields.windows) keys.splice(Math.min(first.length, keys.length), 0, "windows");
    if (fields.start) keys.push("start");
    const row = (key) =>
      element(
        "div",
        { class: typeof fields[key] === "object" && fields[key] !== null ? "wide" : null },
        element("dt", {}, label(key)),
        element(
          "dd",
          { "data-field": key, "data-value": JSON.stringify(fields[key]) },
          key === "multipliers" && fields[key] ? circle(fields[key]) : null,
          value(fields[key]),
        ),
      );
    this.node.replaceChildren(element("dl", {}, ...keys.map(row)));
  }
}

/** The rows of a comparison. */
export function rowTable(rows) {
  const keys = Object.keys(rows[0]);
  return element(
    "section",
    { class: "card rows", "aria-label": "Rows" },
    element(
      "table",
      {},
      element(
        "thead",
        {},
        element("tr", {}, ...keys.map((key) => element("th", { scope: "col" }, label(key)))),
      ),
      element(
        "tbody",
        {},
        ...rows.map((row, k) =>
          element(
            "tr",
            {},
            ...keys.map((key) => element("td", { "data-row": k, "data-field": key }, value(row[key]))),
          ),
        ),
      ),
    ),
  );
}
