// Puts the page together.
import { startTheme } from "./colour.js";
import { Curves } from "./curves.js";
import { readData } from "./data.js";
import { element } from "./dom.js";
import { Family } from "./family.js";
import { figureCard, paintSamples } from "./figures.js";
import { startKeys } from "./keys.js";
import { Numbers, rowTable } from "./numbers.js";
import { Solutions } from "./solutions.js";
import { Stage } from "./stage.js";
import { State } from "./state.js";
import { Timeline } from "./timeline.js";

const orbitsElsewhere =
  "This file has no orbits; extremal continue SCENE --samples 200 --output FILE saves them with the branch.";
const figureHeight = 220,
  comparisonHeight = 460;

/** What the address asks for: #solution=2&time=0.4&view=1&theme=dark&pause */
function asked() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const number = (key) => (wanted.has(key) ? Number(wanted.get(key)) : null);
  return {
    theme: wanted.get("theme"),
    selected: number("solution"),
    view: number("view"),
    phase: number("time"),
    pause: wanted.has("pause"),
  };
}

const data = readData();
const state = new State(data);
const wanted = asked();
const parts = [];
const add = (part) => (parts.push(part), part.node);
const toggleTheme = startTheme(wanted.theme, () => {
  paintSamples();
  for (const part of parts) part.themeChanged?.();
});

const moving = data.trajectories.length > 0;
const stage = moving && data.picture.views.length ? new Stage(state) : null;
const left = [],
  right = [],
  below = [];
if (stage) left.push(add(stage));
if (moving) left.push(add(new Timeline(state)));
if (data.kind === "solution" && data.trajectories.length > 1) left.push(add(new Solutions(state)));
if (data.kind === "branch" && !moving) left.push(element("p", { class: "remarks" }, orbitsElsewhere));
if (data.kind === "branch") (moving ? right : left).push(add(new Family(state)));
if (data.kind !== "comparison") right.push(add(new Numbers(state)));
if (moving) below.push(add(new Curves(state)));
for (const figure of data.figures) {
  const card = figureCard(
    figure,
    data.kind === "comparison" ? "Time against error" : "Figure",
    data.kind === "comparison" ? comparisonHeight : figureHeight,
  );
  parts.push(...card.panels);
  below.push(card.node);
}
if (data.kind === "comparison") below.push(rowTable(data.result.rows));

const helpButton = element("button", { type: "button", title: "Keys (?)", "aria-label": "Keys" }, "?");
const header = element(
  "header",
  {},
  element("h1", {}, document.title),
  element(
    "nav",
    {},
    element(
      "button",
      { type: "button", title: "Light or dark (t)", "aria-label": "Light or dark", onclick: toggleTheme },
      "\u25d0",
    ),
    helpButton,
  ),
);
document.body.append(
  header,
  element(
    "main",
    { class: data.kind },
    left.length
      ? element(
          "div",
          { class: "above" },
          element("div", { class: "left" }, ...left),
          element("div", { class: "right" }, ...right),
        )
      : null,
    element("div", { class: "below" }, ...below),
  ),
);
helpButton.addEventListener("click", startKeys(state, stage, toggleTheme));

paintSamples();
if (wanted.selected !== null) state.select(wanted.selected);
if (wanted.view !== null) state.view = Math.min(wanted.view, (data.picture?.views.length ?? 1) - 1);
if (moving) {
  state.tell("view");
  state.setPhase(wanted.phase ?? 0);
  state.play(!wanted.pause && !window.matchMedia("(prefers-reduced-motion: reduce)").matches);
}
document.documentElement.dataset.ready = "true";
