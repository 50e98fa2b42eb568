// The solutions of a search side by side, each in motion; a press brings one to the front.
import { fieldsOf } from "./data.js";
import { element } from "./dom.js";
import { PlaneView } from "./plane.js";

const mostMoving = 24; // further cards stand still

export class Solutions {
  constructor(state) {
    this.state = state;
    this.cards = state.data.trajectories.map((trajectory, k) => this.card(trajectory, k));
    this.node = element(
      "section",
      { class: "card solutions", role: "group", "aria-label": "Solutions" },
      ...this.cards.map((card) => card.node),
    );
    state.on("select", () => this.mark());
    state.on("view", () => this.show());
    state.on("time", () => this.draw());
    new ResizeObserver(() => this.draw(true)).observe(this.node);
    this.mark();
  }

  card(trajectory, k) {
    const canvas = element("canvas", {}),
      fields = fieldsOf(this.state.data, k);
    const lone = this.state.data.picture.views.every(
      (view) => view.kind !== "path" || view.bodies.length === 1,
    );
    const index = fields.morse_index;
    const node = element(
      "button",
      { type: "button", onclick: () => this.state.select(k) },
      canvas,
      element("span", {}, lone ? element("i", { "data-colour": trajectory.colour }) : null, trajectory.label),
      element("small", {}, index === null || index === undefined ? "" : `index ${index}`),
    );
    return { node, trajectory, view: new PlaneView(canvas, this.state, true) };
  }

  show() {
    const view = this.state.data.picture.views[this.state.view];
    this.cards.forEach((card, k) =>
      card.view.show(view, card.trajectory, [], view.together ? view.range : view.ranges[k]),
    );
    this.draw(true);
  }
  mark() {
    this.cards.forEach((card, k) => card.node.setAttribute("aria-pressed", k === this.state.selected));
    this.cards[this.state.selected].node.scrollIntoView({ block: "nearest", inline: "nearest" });
  }
  draw(all = false) {
    this.cards.forEach((card, k) => (all || k < mostMoving) && card.view.draw());
  }
  themeChanged() {
    for (const card of this.cards) card.view.themeChanged();
    this.draw(true);
  }
}
