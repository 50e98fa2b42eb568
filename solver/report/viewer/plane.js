// Motion on a plain canvas: paths in the plane, phase planes, profiles of arrays. Space is seen from one side, in
// small pictures and where there is no WebGL.
import { faded, mixed, themeColour, tone } from "./colour.js";
import { fitCanvas } from "./dom.js";
import { marks } from "./marks.js";
import { drawMotion } from "./motion.js";
import { projection } from "./projection.js";
import { axisText, ticks } from "./text.js";

export class PlaneView {
  /** Of a canvas; a small one has no axes and cannot be moved. */
  constructor(canvas, state, small = false) {
    this.canvas = canvas;
    this.state = state;
    this.small = small;
    this.still = document.createElement("canvas");
    this.reset();
    if (!small) this.listen();
  }

  reset() {
    this.zoom = 1;
    this.shift = [0, 0];
    this.yaw = -0.6;
    this.pitch = 0.42;
    this.stale = true;
  }

  /** What is drawn: a view of the picture, the trajectory in front, others behind it. */
  show(view, front, behind, range) {
    this.view = view;
    this.front = front;
    this.behind = behind;
    this.range = range;
    this.space = view.axes.length === 3;
    this.stale = true;
  }

  draw() {
    const context = fitCanvas(this.canvas);
    if (!context || !this.view) return;
    const width = this.canvas.clientWidth,
      height = this.canvas.clientHeight;
    if (this.stale || this.still.width !== this.canvas.width || this.still.height !== this.canvas.height) {
      this.project = projection(this, width, height);
      this.drawStill(width, height);
      this.stale = false;
    }
    context.clearRect(0, 0, width, height);
    context.drawImage(this.still, 0, 0, width, height);
    this.drawObstacles(context, this.obstaclesNow());
    drawMotion(this, context);
  }

  drawStill(width, height) {
    const ratio = this.canvas.width / width;
    this.still.width = this.canvas.width;
    this.still.height = this.canvas.height;
    const context = this.still.getContext("2d");
    context.scale(ratio, ratio);
    if (!this.small && !this.space) this.drawAxes(context, width, height);
    if (!this.small && this.space) this.drawRoom(context);
    if (this.view.kind === "profile") return;
    this.drawObstacles(
      context,
      (this.view.obstacles ?? []).filter((curve) => curve.t === undefined),
    );
    for (const other of this.behind) this.drawPaths(context, other, 0.3, 1.1, tone(other.colour));
    this.drawPaths(context, this.front, 0.55, this.small ? 1.3 : 1.8, null);
    if (!this.small) this.drawMarks(context);
    if (!this.small) this.drawEnds(context);
    this.drawCentres(context);
  }

  drawAxes(context, width, height) {
    const { at, back, pad } = this.project;
    const [low, high] = [back(pad.left, height - pad.bottom), back(width - pad.right, pad.top)];
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = themeColour("muted");
    context.lineWidth = 1;
    const line = (from, to, strong) => {
      context.strokeStyle = themeColour(strong ? "axis" : "grid");
      context.beginPath();
      context.moveTo(...from.map((x) => Math.round(x) + 0.5));
      context.lineTo(...to.map((x) => Math.round(x) + 0.5));
      context.stroke();
    };
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const tick of ticks(low[0], high[0], width / 90)) {
      const x = at([tick.at, low[1]])[0];
      line([x, pad.top], [x, height - pad.bottom], tick.at === 0);
      context.fillText(tick.text, x, height - pad.bottom + 6);
    }
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const tick of ticks(low[1], high[1], height / 60)) {
      const y = at([low[0], tick.at])[1];
      line([pad.left, y], [width - pad.right, y], tick.at === 0);
      context.fillText(tick.text, pad.left - 7, y);
    }
    context.fillStyle = themeColour("text");
    context.font = "italic 13px Georgia, serif";
    context.textBaseline = "alphabetic";
    context.fillText(axisText(this.view.axes[0]), width - pad.right, height - 7);
    context.textAlign = "left";
    context.fillText(axisText(this.view.axes[1]), 10, 16);
    context.beginPath();
    context.rect(pad.left, pad.top, width - pad.left - pad.right, height - pad.top - pad.bottom);
    context.clip();
  }

  /** The edges of the box that the paths are in. */
  drawRoom(context) {
    const corner = (bits) => this.range.map(([low, high], axis) => (bits & (1 << axis) ? high : low));
    context.strokeStyle = themeColour("grid");
    for (let bits = 0; bits < 8; ++bits)
      for (let axis = 0; axis < 3; ++axis) {
        if (bits & (1 << axis)) continue;
        context.beginPath();
        context.moveTo(...this.project.at(corner(bits)));
        context.lineTo(...this.project.at(corner(bits | (1 << axis))));
        context.stroke();
      }
    context.fillStyle = themeColour("muted");
    context.font = "italic 13px Georgia, serif";
    this.view.axes.forEach((axis, k) => context.fillText(axisText(axis), ...this.project.at(corner(1 << k))));
  }

  bodyColour(trajectory, body) {
    return tone(this.view.bodies.length > 1 ? body.colour : trajectory.colour);
  }

  drawPaths(context, trajectory, opacity, width, colour) {
    context.lineWidth = width;
    context.lineJoin = "round";
    // Bodies on one path take turns, so that each colour is seen.
    const bodies = this.view.bodies,
      slices = bodies.length === 1 ? 1 : Math.ceil(120 / bodies.length);
    const paths = bodies.map((body) => {
      const tracks = body.columns.map((number) => trajectory.track(number));
      return Array.from(tracks[0], (_, k) => this.project.at(tracks.map((track) => track[k])));
    });
    for (let slice = 0; slice < slices; ++slice)
      bodies.forEach((body, i) => {
        const last = paths[i].length - 1;
        const from = Math.floor((slice * last) / slices),
          to = Math.floor(((slice + 1) * last) / slices);
        context.strokeStyle = mixed(
          themeColour("panel"),
          colour ?? this.bodyColour(trajectory, body),
          opacity,
        );
        context.beginPath();
        for (let k = from; k <= to; ++k) context.lineTo(...paths[i][k]);
        context.stroke();
      });
  }

  /** Of boundaries that move, those of the time that is nearest. */
  obstaclesNow() {
    const moving = (this.view.obstacles ?? []).filter((curve) => curve.t !== undefined);
    const time = this.state.time;
    const gap = Math.min(...moving.map((curve) => Math.abs(curve.t - time)));
    return moving.filter((curve) => Math.abs(curve.t - time) === gap);
  }

  /** Boundaries of what inequalities along the path forbid. */
  drawObstacles(context, curves) {
    context.strokeStyle = themeColour("muted");
    context.lineWidth = this.small ? 0.8 : 1.4;
    for (const { x, y } of curves) {
      context.beginPath();
      x.forEach((across, k) => context.lineTo(...this.project.at([across, y[k]])));
      context.stroke();
    }
  }

  place(trajectory, body, time) {
    return this.project.at(body.columns.map((number) => trajectory.at(number, time)));
  }

  /** A ring where an open path begins, a square where it ends. */
  drawEnds(context) {
    if (this.view.closed) return;
    for (const body of this.view.bodies) {
      const colour = this.bodyColour(this.front, body);
      const [from, to] = [this.place(this.front, body, 0), this.place(this.front, body, this.front.duration)];
      if (Math.hypot(to[0] - from[0], to[1] - from[1]) < 3) continue;
      context.lineWidth = 1.8;
      context.strokeStyle = colour;
      context.fillStyle = themeColour("panel");
      context.beginPath();
      context.arc(...from, 5, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
      context.fillStyle = colour;
      context.fillRect(to[0] - 4, to[1] - 4, 8, 8);
    }
  }

  /** Contacts as parts of the path, waypoints as rings. */
  drawMarks(context) {
    for (const body of this.view.bodies) {
      const { contacts, waypoints } = marks(this.state, this.front, body);
      context.lineWidth = 4;
      context.strokeStyle = themeColour("contact");
      for (const part of contacts) {
        context.beginPath();
        for (const place of part) context.lineTo(...this.project.at(place));
        context.stroke();
      }
      context.lineWidth = 2;
      context.strokeStyle = themeColour("waypoint");
      context.fillStyle = themeColour("panel");
      for (const place of waypoints) {
        context.beginPath();
        context.arc(...this.project.at(place), 4, 0, 2 * Math.PI);
        context.fill();
        context.stroke();
      }
    }
  }

  drawCentres(context) {
    for (const centre of this.view.centres) {
      const [x, y] = this.project.at(centre.at);
      context.fillStyle = themeColour("centre");
      context.beginPath();
      context.arc(x, y, this.small ? 2.5 : 5, 0, 2 * Math.PI);
      context.fill();
      if (this.small || !centre.name) continue;
      context.font = "12px system-ui, sans-serif";
      context.textAlign = "left";
      context.fillText(centre.name, x + 9, y + 4);
    }
  }

  /** Drag to shift or turn, wheel to zoom. */
  listen() {
    this.canvas.addEventListener("pointerdown", (event) => this.canvas.setPointerCapture(event.pointerId));
    this.canvas.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      if (this.space) {
        this.yaw += 0.01 * event.movementX;
        this.pitch = Math.min(Math.max(this.pitch + 0.01 * event.movementY, -1.57), 1.57);
      } else {
        this.shift = [this.shift[0] + event.movementX, this.shift[1] + event.movementY];
      }
      this.redraw();
    });
    this.canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.magnify(Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
      },
      { passive: false },
    );
  }

  /** About a point of the canvas, or its middle. */
  magnify(factor, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2) {
    const zoom = Math.min(Math.max(this.zoom * factor, 0.2), 500),
      by = zoom / this.zoom;
    const { pad = { left: 0, top: 0 }, inner } = this.project;
    const middle = [pad.left + inner[0] / 2, pad.top + inner[1] / 2];
    this.shift = [x, y].map((at, k) => at - middle[k] + (this.shift[k] - at + middle[k]) * by);
    this.zoom = zoom;
    this.redraw();
  }

  redraw() {
    this.stale = true;
    this.draw();
  }
  themeChanged() {
    this.stale = true;
  }
}
