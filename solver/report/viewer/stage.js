// The large picture of the motion: in space by WebGL, else on a plain canvas.
import { element, merged } from "./dom.js";
import { PlaneView } from "./plane.js";
import { SpaceView } from "./space.js";

const mostTabs = 5; // further views are in a list
const kinds = { path: "path", phase: "phase plane", profile: "profile" };

export class Stage {
  constructor(state) {
    this.state = state;
    this.views = state.data.picture.views;
    this.canvas = element("canvas", { "aria-label": "Motion" });
    this.flat = element("div", { class: "flat" }, this.canvas);
    this.deep = element("div", { class: "deep", hidden: true });
    this.hint = element("p", { class: "hint" });
    this.remarks = element("p", { class: "remarks" }, state.data.picture.remarks.join(", "));
    this.node = element(
      "section",
      { class: "card stage", "aria-label": "Motion" },
      this.tabs(),
      this.flat,
      this.deep,
      this.hint,
      this.remarks,
    );
    this.plane = new PlaneView(this.canvas, state);
    for (const place of [this.flat, this.deep]) place.addEventListener("dblclick", () => this.reset());
    this.draw = merged(() => this.current?.draw());
    state.on("select", () => this.show());
    state.on("view", () => this.show());
    state.on("time", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.node);
  }

  tabs() {
    if (this.views.length < 2) return null;
    const text = (view) => view.axes.map((axis) => axis.name).join(", ");
    const listed = this.views.length > mostTabs ? 1 : this.views.length;
    this.buttons = this.views
      .slice(0, listed)
      .map((view, k) =>
        element(
          "button",
          { type: "button", title: kinds[view.kind], onclick: () => this.state.setView(k) },
          text(view),
        ),
      );
    if (listed < this.views.length) {
      const options = this.views
        .slice(listed)
        .map((view, k) => element("option", { value: k + listed }, text(view)));
      this.choice = element(
        "select",
        { "aria-label": "Phase planes", onchange: () => this.state.setView(Number(this.choice.value)) },
        element("option", { value: "", disabled: true }, "phase plane \u2026"),
        ...options,
      );
    }
    return element(
      "div",
      { class: "tabs", role: "group", "aria-label": "Views" },
      ...this.buttons,
      this.choice,
    );
  }

  /** Made when it is first needed; where there is no WebGL the plain canvas serves. */
  space() {
    if (this.deepView === undefined) {
      this.deep.hidden = false;
      try {
        this.deepView = new SpaceView(this.deep, this.state);
      } catch {
        this.deepView = null;
        this.flatReason = "without WebGL, seen in parallel projection. ";
      }
    }
    return this.deepView;
  }

  show() {
    const { state } = this,
      view = this.views[state.view];
    if (!view) return;
    this.buttons?.forEach((button, k) => button.setAttribute("aria-pressed", k === state.view));
    if (this.choice) this.choice.value = state.view < this.buttons.length ? "" : state.view;
    const space = view.axes.length === 3 ? this.space() : null;
    this.flat.hidden = Boolean(space);
    this.deep.hidden = !space;
    this.current = space ?? this.plane;
    const all = state.data.trajectories,
      front = state.trajectory;
    const behind = view.together && all.length > 1 ? all : [];
    const moves = view.axes.length === 3 ? "drag to turn" : "drag to move";
    const reason = view.axes.length === 3 && !space ? this.flatReason : "";
    this.hint.textContent = `${reason}${moves}, wheel to zoom, double-click to reset`;
    this.current.show(view, front, behind, view.together ? view.range : view.ranges[state.selected]);
    if (this.shown !== state.view) this.reset();
    this.shown = state.view;
    this.draw();
  }

  reset() {
    this.current?.reset();
    this.draw();
  }
  magnify(factor) {
    this.current?.magnify(factor);
    this.draw();
  }
  themeChanged() {
    this.plane.themeChanged();
    this.deepView?.themeChanged();
    this.draw();
  }
}
