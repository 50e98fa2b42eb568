// Panels that are laid out already, as curves and marks: diagrams, comparisons, spectra and fits.
import uPlot from "uplot";
import { themeColour, tone } from "./colour.js";
import { plotAxis } from "./curves.js";
import { drawing, element } from "./dom.js";

/** A sample of a shape beside its text. */
function sample({ colour, shape }) {
  const shapes = {
    line: () => drawing("path", { d: "M0 6H18", "stroke-width": 2.4 }),
    ring: () => drawing("circle", { cx: 9, cy: 6, r: 4, "stroke-width": 2, fill: "none" }),
    square: () => drawing("rect", { x: 5, y: 2, width: 8, height: 8, class: "filled" }),
    disc: () => drawing("circle", { cx: 9, cy: 6, r: 4, class: "filled" }),
    dot: () => drawing("circle", { cx: 9, cy: 6, r: 2.5, class: "filled" }),
  };
  if (!shapes[shape]) return null;
  const node = drawing(
    "svg",
    { viewBox: "0 0 18 12", class: "sample", "data-colour": colour },
    shapes[shape](),
  );
  return node;
}

export function legend(entries) {
  return element(
    "p",
    { class: "legend" },
    ...entries.map((entry) => element("span", {}, sample(entry), entry.text)),
  );
}

/** Colours of samples and swatches, again for each theme. */
export function paintSamples() {
  for (const node of document.querySelectorAll("[data-colour]")) node.style.color = tone(node.dataset.colour);
}

function drawMark(context, { colour, shape }, x, y, ratio) {
  const radius = (shape === "dot" ? 2.2 : shape === "square" ? 4 : 4.5) * ratio;
  context.fillStyle = context.strokeStyle = tone(colour);
  context.lineWidth = 2 * ratio;
  context.beginPath();
  if (shape === "square") context.rect(x - radius, y - radius, 2 * radius, 2 * radius);
  else context.arc(x, y, radius, 0, 2 * Math.PI);
  if (shape === "ring") {
    context.fillStyle = themeColour("panel");
    context.fill();
    context.stroke();
  } else {
    context.fill();
  }
}

export class FigurePanel {
  /** `pressed` gets the place of a press, in data units, and the plot. */
  constructor(panel, height, pressed) {
    this.panel = panel;
    this.height = height;
    this.pressed = pressed;
    this.place = element("div", { class: "plot" });
    this.node = element(
      "figure",
      { class: "panel" },
      panel.caption || panel.y.label
        ? element("figcaption", {}, element("b", {}, panel.y.label), panel.caption)
        : null,
      this.place,
      panel.legend.length ? legend(panel.legend) : null,
    );
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  resize() {
    const width = this.place.clientWidth,
      height = this.height;
    if (!width) return;
    if (this.plot) return (this.plot.setSize({ width, height }), this.moved?.());
    const { x, y } = this.panel;
    const splits = (axis) => ({
      splits: axis.ticks.map((tick) => tick.at),
      values: () => axis.ticks.map((tick) => tick.text),
      filter: (plot, values) => values,
    });
    const options = {
      width,
      height,
      padding: [10, 18, 0, 0],
      legend: { show: false },
      cursor: { x: false, y: false, points: { show: false }, drag: { x: false, y: false } },
      scales: { x: { time: false, range: () => [x.low, x.high] }, y: { range: () => [y.low, y.high] } },
      axes: [
        plotAxis({
          ...splits(x),
          size: x.label ? 30 : 28,
          label: x.label || undefined,
          labelSize: 20,
          labelGap: 2,
          labelFont: "italic 13px Georgia, serif",
        }),
        plotAxis({ ...splits(y), size: 62 }),
      ],
      series: [{}, { show: true, points: { show: false }, width: 0 }],
      hooks: { draw: [(plot) => this.draw(plot)] },
    };
    this.plot = new uPlot(
      options,
      [
        [x.low, x.high],
        [null, null],
      ],
      this.place,
    );
    if (this.pressed) {
      this.plot.over.classList.add("pressable");
      const press = (event) => this.pressed(event.offsetX, event.offsetY, this.plot);
      this.plot.over.addEventListener("pointerdown", press);
      this.plot.over.addEventListener("pointermove", (event) => event.buttons && press(event));
    }
    this.moved?.();
  }

  draw(plot) {
    const { ctx, bbox } = plot,
      ratio = devicePixelRatio;
    const at = (x, y) => [plot.valToPos(x, "x", true), plot.valToPos(y, "y", true)];
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left - 6 * ratio, bbox.top - 6 * ratio, bbox.width + 12 * ratio, bbox.height + 12 * ratio);
    ctx.clip();
    ctx.lineJoin = "round";
    for (const curve of this.panel.curves) {
      ctx.strokeStyle = tone(curve.colour);
      ctx.lineWidth = curve.width * ratio;
      ctx.beginPath();
      for (let k = 0; k < curve.x.length; ++k) ctx.lineTo(...at(curve.x[k], curve.y[k]));
      ctx.stroke();
    }
    for (const mark of this.panel.marks) drawMark(ctx, mark, ...at(mark.x, mark.y), ratio);
    ctx.restore();
  }
  themeChanged() {
    this.plot?.redraw();
  }
}

/** A figure as a card. */
export function figureCard(figure, title, height, pressed) {
  const panels = figure.panels.map((panel) => new FigurePanel(panel, height, pressed));
  const node = element(
    "section",
    { class: `card figure${panels.length > 1 ? " several" : ""}`, "aria-label": title },
    figure.legend.length ? legend(figure.legend) : null,
    ...panels.map((panel) => panel.node),
  );
  return { node, panels };
}
