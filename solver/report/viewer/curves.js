// Coordinates against time, by uPlot: windows as bands, conjugate times and the time that is shown as lines.
import uPlot from "uplot";
import { faded, themeColour, tone } from "./colour.js";
import { contactsOf, fieldsOf, waypointsOf } from "./data.js";
import { element, setText } from "./dom.js";
import { axisNumbers, axisText, brief } from "./text.js";

const height = 170,
  mostNames = 6,
  mostPanels = 12,
  mostBands = 400;

/** Axes of any plot, in the colours of the theme. */
export const plotAxis = (more) => ({
  stroke: () => themeColour("muted"),
  grid: { stroke: () => themeColour("grid"), width: 1 },
  ticks: { stroke: () => themeColour("grid"), width: 1, size: 5 },
  font: "11px system-ui, sans-serif",
  values: (plot, splits) => axisNumbers(splits),
  ...more,
});

export class Curves {
  constructor(state) {
    this.state = state;
    const panels = state.data.picture.panels;
    this.panels = panels.slice(0, mostPanels).map((panel) => new CurvePanel(panel, state));
    const left = panels.length - this.panels.length;
    this.node = element(
      "section",
      { class: "curves", "aria-label": "Coordinates against time" },
      ...this.panels.map((panel) => panel.node),
      left > 0 ? element("p", { class: "remarks" }, `and ${left} more coordinates`) : null,
    );
    state.on("select", () => this.panels.forEach((panel) => panel.fill()));
    state.on("time", () => this.panels.forEach((panel) => panel.moved()));
  }
  themeChanged() {
    for (const panel of this.panels) panel.plot?.redraw();
  }
}

class CurvePanel {
  constructor(panel, state) {
    this.panel = panel;
    this.state = state;
    this.values = panel.columns.length <= mostNames ? panel.columns.map((_, k) => this.readout(k)) : [];
    const name = axisText(panel);
    this.place = element("div", { class: "plot" });
    this.node = element(
      "figure",
      { class: "card curve" },
      element(
        "figcaption",
        {},
        this.values.length === 1 ? null : element("b", {}, name),
        ...this.values.flat(),
      ),
      this.place,
    );
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  readout(k) {
    const lone = this.panel.columns.length === 1;
    const name = lone ? axisText(this.panel) : this.state.data.picture.columns[this.panel.columns[k]].name;
    const value = element("output", { "data-column": this.panel.columns[k] });
    const swatch = element("i", { "data-colour": this.panel.colours[k] });
    return element("span", { class: "value" }, swatch, `${name} = `, value);
  }

  colour(k) {
    const lone = this.panel.columns.length === 1 && this.state.count > 1;
    return tone(lone ? this.state.trajectory.colour : this.panel.colours[k]);
  }

  resize() {
    const width = this.place.clientWidth;
    if (!width) return;
    if (this.plot) this.plot.setSize({ width, height });
    else this.make(width);
    this.moved();
  }

  make(width) {
    const { state } = this;
    const options = {
      width,
      height,
      padding: [8, 14, 0, 0],
      legend: { show: false },
      cursor: { x: false, y: false, points: { show: false }, drag: { x: false, y: false } },
      scales: { x: { time: false, range: () => [0, this.extent()] }, y: { range: () => this.panel.range } },
      axes: [plotAxis({ size: 28 }), plotAxis({ size: 58 })],
      series: [
        {},
        ...this.panel.columns.map((_, k) => ({
          width: 1.7,
          stroke: () => this.colour(k),
          points: { show: false },
          pxAlign: 0,
        })),
      ],
      hooks: {
        drawClear: [(plot) => this.drawBands(plot)],
        drawAxes: [(plot) => (this.drawWalls(plot), this.drawOthers(plot))],
      },
    };
    this.plot = new uPlot(options, this.data(), this.place);
    this.playhead = element("div", { class: "playhead" });
    this.plot.over.append(this.playhead);
    this.plot.over.addEventListener("pointerdown", (event) => {
      this.plot.over.setPointerCapture(event.pointerId);
      this.scrub(event);
    });
    this.plot.over.addEventListener("pointermove", (event) => event.buttons && this.scrub(event));
    state.on("theme", () => this.plot.redraw());
  }

  /** Others are drawn beside a solution where each panel has one curve. */
  others() {
    return this.panel.columns.length === 1
      ? this.state.data.trajectories.filter((each) => each !== this.state.trajectory)
      : [];
  }
  extent() {
    const all = this.panel.columns.length === 1 ? this.state.data.trajectories : [this.state.trajectory];
    return Math.max(...all.map((each) => each.duration));
  }
  data() {
    const trajectory = this.state.trajectory;
    return [trajectory.fineTimes, ...this.panel.columns.map((number) => trajectory.track(number))];
  }
  fill() {
    this.plot?.setData(this.data());
  }

  scrub(event) {
    this.state.play(false);
    const time = this.plot.posToVal(event.clientX - this.plot.over.getBoundingClientRect().left, "x");
    this.state.setPhase(time / this.state.trajectory.duration);
  }

  moved() {
    if (!this.plot) return;
    const { state } = this,
      time = state.time;
    this.playhead.style.transform = `translateX(${this.plot.valToPos(time, "x")}px)`;
    this.values.forEach((node, k) => {
      const output = node.querySelector("output"),
        value = state.trajectory.at(this.panel.columns[k], time);
      setText(output, brief(value));
      node.querySelector("i").style.background = this.colour(k);
    });
  }

  drawBands(plot) {
    const fields = fieldsOf(this.state.data, this.state.selected),
      { ctx, bbox } = plot;
    const at = (time) => plot.valToPos(time, "x", true);
    ctx.save();
    ctx.fillStyle = themeColour("band");
    (fields.windows ?? []).slice(0, mostBands).forEach(([from, to], k) => {
      if (k % 2) ctx.fillRect(at(from), bbox.top, at(to) - at(from), bbox.height);
    });
    ctx.fillStyle = themeColour("contact");
    const thick = 5 * devicePixelRatio;
    for (const { from, to } of contactsOf(fields))
      ctx.fillRect(at(from), bbox.top + bbox.height - thick, Math.max(at(to) - at(from), thick / 2), thick);
    const lines = (times, colour, dash) => {
      ctx.strokeStyle = themeColour(colour);
      ctx.lineWidth = 1.2 * devicePixelRatio;
      ctx.setLineDash(dash.map((length) => length * devicePixelRatio));
      ctx.beginPath();
      for (const time of times.slice(0, mostBands)) {
        ctx.moveTo(at(time), bbox.top);
        ctx.lineTo(at(time), bbox.top + bbox.height);
      }
      ctx.stroke();
    };
    lines(fields.conjugate_times ?? [], "conjugate", [4, 4]);
    lines(
      waypointsOf(fields).map((waypoint) => waypoint.t),
      "waypoint",
      [1, 3],
    );
    ctx.restore();
  }

  /** Boundaries of what inequalities forbid to a lone coordinate. */
  drawWalls(plot) {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.strokeStyle = themeColour("muted");
    ctx.lineWidth = 1.4 * devicePixelRatio;
    for (const { x, y } of this.panel.walls ?? []) {
      ctx.beginPath();
      x.forEach((time, k) => ctx.lineTo(plot.valToPos(time, "x", true), plot.valToPos(y[k], "y", true)));
      ctx.stroke();
    }
    ctx.restore();
  }

  drawOthers(plot) {
    const { ctx, bbox } = plot,
      number = this.panel.columns[0];
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.lineWidth = devicePixelRatio;
    for (const other of this.others()) {
      const times = other.fineTimes,
        values = other.track(number);
      ctx.strokeStyle = faded(tone(other.colour), 0.35);
      ctx.beginPath();
      for (let k = 0; k < times.length; ++k)
        ctx.lineTo(plot.valToPos(times[k], "x", true), plot.valToPos(values[k], "y", true));
      ctx.stroke();
    }
    ctx.restore();
  }
}
