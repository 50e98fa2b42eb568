// A branch: its diagram, a slider along its points, and the orbit of the point that is chosen.
import { tone } from "./colour.js";
import { element, setText } from "./dom.js";
import { figureCard } from "./figures.js";
import { brief } from "./text.js";

const diagramHeight = 300;
const reach = 40; // pixels around a point that take a press

export class Family {
  constructor(state) {
    this.state = state;
    const { data } = state;
    const card = figureCard(data.diagram, "Diagram of the branch", diagramHeight, (x, y, plot) =>
      this.press(x, y, plot),
    );
    this.panel = card.panels[0];
    this.panel.moved = () => this.moved();
    this.panels = card.panels;
    this.slider = element("input", {
      type: "range",
      min: 0,
      max: data.places.length - 1,
      step: 1,
      value: 0,
      "aria-label": "Point of the branch",
      oninput: () => state.select(Number(this.slider.value)),
    });
    this.label = element("output", { class: "point" });
    card.node.append(element("div", { class: "row" }, this.slider, this.label));
    this.node = card.node;
    this.dot = element("div", { class: "chosen" });
    state.on("select", () => this.moved());
    this.moved();
  }

  press(x, y, plot) {
    let nearest = null,
      least = reach;
    this.state.data.places.forEach((place, k) => {
      if (!place) return;
      const distance = Math.hypot(plot.valToPos(place[0], "x") - x, plot.valToPos(place[1], "y") - y);
      if (distance < least) [nearest, least] = [k, distance];
    });
    if (nearest !== null) this.state.select(nearest);
  }

  moved() {
    const { selected, data } = this.state,
      place = data.places[selected],
      point = data.result.points[selected];
    this.slider.value = selected;
    const kind = point.kind === "regular" ? "" : `, ${point.kind}`;
    setText(this.label, `${data.parameter} = ${brief(point.parameter)}${kind}`);
    const { plot } = this.panel;
    this.dot.hidden = !place || !plot;
    if (this.dot.hidden) return;
    if (!this.dot.isConnected) plot.over.append(this.dot);
    this.dot.style.borderColor = tone(data.colours[selected]);
    const [x, y] = [plot.valToPos(place[0], "x"), plot.valToPos(place[1], "y")];
    this.dot.style.transform = `translate(${x}px, ${y}px)`;
  }
  themeChanged() {
    this.panels.forEach((panel) => panel.themeChanged());
    this.moved();
  }
}
