// The keyboard.
import { element } from "./dom.js";

const small = 0.002,
  large = 0.05; // of the duration

export function startKeys(state, stage, theme) {
  const forward = (event, way) => (
    state.play(false),
    state.setPhase(state.phase + way * (event.shiftKey ? large : small))
  );
  const actions = {
    " ": ["play or pause", () => state.play(!state.playing)],
    ArrowLeft: ["back in time; with Shift more", (event) => forward(event, -1)],
    ArrowRight: ["on in time; with Shift more", (event) => forward(event, 1)],
    Home: ["to the start", () => state.setPhase(0)],
    End: ["to the end", () => (state.play(false), state.setPhase(1))],
    ArrowUp: ["next solution or point", () => state.select(state.selected + 1)],
    ArrowDown: ["solution or point before", () => state.select(state.selected - 1)],
    "]": ["faster", () => state.setSpeed(state.speed * 2)],
    "[": ["slower", () => state.setSpeed(state.speed / 2)],
    v: ["next view", () => state.setView(state.view + 1)],
    "+": ["zoom in", () => stage?.magnify(1.25)],
    "-": ["zoom out", () => stage?.magnify(0.8)],
    r: ["the whole picture again", () => stage?.reset()],
    t: ["light or dark", theme],
    "?": ["this list", () => (help.open ? help.close() : help.showModal())],
  };
  const names = {
    " ": "Space",
    ArrowLeft: "\u2190",
    ArrowRight: "\u2192",
    ArrowUp: "\u2191",
    ArrowDown: "\u2193",
  };
  const help = element(
    "dialog",
    { "aria-label": "Keys", onclick: () => help.close() },
    element("h2", {}, "Keys"),
    element(
      "dl",
      {},
      ...Object.entries(actions).map(([key, [text]]) =>
        element("div", {}, element("dt", {}, element("kbd", {}, names[key] ?? key)), element("dd", {}, text)),
      ),
    ),
  );
  document.body.append(help);
  document.addEventListener("click", (event) => {
    if (event.detail > 0) event.target.closest("button")?.blur(); // pressed by a pointer
  });
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    // A button that the keyboard has come to takes Space itself.
    if (!action || (event.key === " " && event.target instanceof HTMLButtonElement)) return;
    event.preventDefault();
    action[1](event);
  });
  return () => help.showModal();
}
