// Play, speed, and the time with windows and conjugate times on it.
import { contactsOf, fieldsOf, waypointsOf } from "./data.js";
import { drawing, element, setText } from "./dom.js";
import { axisText, brief } from "./text.js";

const mostMarks = 400;
const steps = 10000; // of the slider

/** "waypoint at 1.5: impulse of x 0.2". */
function impulseText(t, impulse) {
  const jumps = Object.entries(impulse).map(([name, jump]) => `${name} ${brief(jump)}`);
  return `waypoint at ${brief(t)}: impulse of ${jumps.join(", ")}`;
}

export class Timeline {
  constructor(state) {
    this.state = state;
    this.icon = drawing("path", {});
    this.button = element(
      "button",
      { type: "button", class: "play", onclick: () => state.play(!state.playing) },
      drawing("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, this.icon),
    );
    this.slider = element("input", {
      type: "range",
      min: 0,
      max: steps,
      step: 1,
      value: 0,
      "aria-label": "Time",
      oninput: () => (state.play(false), state.setPhase(this.slider.value / steps)),
    });
    this.marks = element("div", { class: "marks" });
    this.readout = element("output", { class: "time" });
    this.speed = element("output", { class: "speed", title: "Speed" });
    const slower = element(
      "button",
      { type: "button", title: "Slower", onclick: () => state.setSpeed(state.speed / 2) },
      "\u2212",
    );
    const faster = element(
      "button",
      { type: "button", title: "Faster", onclick: () => state.setSpeed(state.speed * 2) },
      "+",
    );
    this.legend = element("p", { class: "legend" });
    this.node = element(
      "section",
      { class: "card timeline", "aria-label": "Time" },
      element(
        "div",
        { class: "row" },
        this.button,
        element("div", { class: "track" }, this.marks, this.slider),
        this.readout,
        element("span", { class: "speeds" }, slower, this.speed, faster),
      ),
      this.legend,
    );
    state.on("time", () => this.moved());
    state.on("play", () => this.played());
    state.on("select", () => this.mark());
    this.mark();
    this.played();
    this.moved();
  }

  moved() {
    const { state } = this;
    if (document.activeElement !== this.slider || state.playing)
      this.slider.value = Math.round(state.phase * steps);
    const { name, unit } = state.data.picture.time;
    setText(this.readout, `${name} = ${brief(state.time, 5)}${unit ? ` ${unit}` : ""}`);
    this.readout.dataset.value = state.time;
  }

  played() {
    const { playing, speed } = this.state;
    this.button.setAttribute("aria-label", playing ? "Pause" : "Play");
    this.button.setAttribute("aria-pressed", playing);
    this.icon.setAttribute("d", playing ? "M7 5h4v14H7zM14 5h4v14h-4z" : "M8 5v14l11-7z");
    setText(this.speed, `${speed >= 1 ? speed : `1/${1 / speed}`}\u00d7`);
  }

  /** Windows as bands, contacts as bars, conjugate times as diamonds, waypoints as rings. */
  mark() {
    const { state } = this,
      fields = fieldsOf(state.data, state.selected),
      duration = state.trajectory.duration;
    const windows = (fields.windows ?? []).slice(0, mostMarks),
      times = (fields.conjugate_times ?? []).slice(0, mostMarks),
      contacts = contactsOf(fields).slice(0, mostMarks),
      waypoints = waypointsOf(fields).slice(0, mostMarks);
    const share = (time) => `${(100 * time) / duration}%`;
    this.marks.replaceChildren(
      ...windows.map(([from, to], k) =>
        element("span", {
          class: `window ${k % 2 ? "odd" : "even"}`,
          style: `left:${share(from)};width:${share(to - from)}`,
          title: `window ${k + 1}: ${brief(from)} to ${brief(to)}`,
        }),
      ),
      ...contacts.map(({ constraint, from, to }) =>
        element("span", {
          class: "contact",
          style: `left:${share(from)};width:max(2px, ${share(to - from)})`,
          title: `contact ${constraint + 1}: ${brief(from)} to ${brief(to)}`,
        }),
      ),
      ...times.map((time) =>
        element("span", {
          class: "conjugate",
          style: `left:${share(time)}`,
          title: `conjugate to 0: ${brief(time)}`,
        }),
      ),
      ...waypoints.map(({ t, impulse }) =>
        element("span", { class: "waypoint", style: `left:${share(t)}`, title: impulseText(t, impulse) }),
      ),
    );
    const said = [];
    const count = (list, word) => `${list.length} ${word}${list.length > 1 ? "s" : ""}`;
    if (windows.length)
      said.push(`${fields.windows.length} minimising window${windows.length > 1 ? "s" : ""}`);
    if (times.length)
      said.push(`\u25c6 ${fields.conjugate_times.length} conjugate time${times.length > 1 ? "s" : ""}`);
    if (contacts.length) said.push(`\u25ac ${count(fields.contacts, "contact")}`);
    if (waypoints.length) said.push(`\u25cb ${count(fields.waypoints, "waypoint")}`);
    setText(this.legend, said.join(" \u00b7 "));
    this.legend.title = axisText(state.data.picture.time);
  }
}
