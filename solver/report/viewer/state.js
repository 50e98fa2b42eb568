// What the page shows now. Parts of the page listen to what concerns them.

const seconds = 9; // that a motion takes at speed 1
const slowest = 1 / 16,
  fastest = 16;

export class State {
  constructor(data) {
    this.data = data;
    this.selected = 0;
    this.view = 0;
    this.phase = 0; // of the duration of each trajectory, from 0 to 1
    this.speed = 1;
    this.playing = false;
    this.listeners = new Map();
  }

  get count() {
    return Math.max(this.data.trajectories.length, this.data.places?.length ?? 0);
  }
  get trajectory() {
    return this.data.trajectories[this.selected];
  }
  get time() {
    return this.trajectory ? this.phase * this.trajectory.duration : 0;
  }

  on(event, listener) {
    if (!this.listeners.has(event)) this.listeners.set(event, []);
    this.listeners.get(event).push(listener);
  }
  tell(event) {
    for (const listener of this.listeners.get(event) ?? []) listener(this);
  }

  select(number) {
    const wanted = Math.min(Math.max(number, 0), this.count - 1);
    if (wanted === this.selected) return;
    this.selected = wanted;
    this.tell("select");
    this.tell("time");
  }
  setView(number) {
    const views = this.data.picture?.views.length ?? 0;
    if (!views) return;
    this.view = (number + views) % views;
    this.tell("view");
    this.tell("time");
  }
  setPhase(phase) {
    this.phase = Math.min(Math.max(phase, 0), 1);
    this.tell("time");
  }
  setSpeed(speed) {
    this.speed = Math.min(Math.max(speed, slowest), fastest);
    this.tell("play");
  }
  play(playing) {
    this.playing = playing && this.data.trajectories.length > 0;
    this.tell("play");
    if (!this.playing || this.frame) return;
    let before = null;
    const step = (now) => {
      this.frame = null;
      if (!this.playing) return;
      const passed = before === null ? 0 : Math.min((now - before) / 1000, 0.1);
      before = now;
      this.setPhase((this.phase + (passed * this.speed) / seconds) % 1);
      this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
  }
}
