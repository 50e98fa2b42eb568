// What the page holds, decoded.

const bytes = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer;

/** A column: centre + reach * number, in single precision of its own range. */
function column({ centre, reach, numbers }) {
  return Float64Array.from(new Float32Array(bytes(numbers)), (number) => centre + reach * number);
}

/** Derivatives at the samples by parabolas through neighbours. */
function slopes(t, values) {
  const last = t.length - 1;
  const chord = (k) => (values[k + 1] - values[k]) / (t[k + 1] - t[k]);
  return values.map((_, k) => {
    if (k === 0 || k === last) return last === 0 ? 0 : chord(k === 0 ? 0 : last - 1);
    const before = t[k] - t[k - 1],
      after = t[k + 1] - t[k];
    return (after * chord(k - 1) + before * chord(k)) / (before + after);
  });
}

/** A trajectory: columns of coordinates, of velocities and of forces, cubic between samples. */
export class Trajectory {
  constructor(data, coordinates) {
    this.label = data.label;
    this.colour = data.colour;
    this.data = data;
    this.coordinates = coordinates;
    this.found = 0;
    this.tracks = new Map();
  }

  // Decoded when first drawn: a family has many orbits.
  get t() {
    return (this.times ??= new Float64Array(bytes(this.data.t)));
  }
  get columns() {
    return (this.decoded ??= this.data.columns.map(column));
  }
  get duration() {
    return this.t[this.t.length - 1];
  }

  slopes(number) {
    this.derived ??= [];
    // Forces of contact jump: between samples they stay between their values.
    if (number >= 2 * this.coordinates) return (this.derived[number] ??= new Float64Array(this.t.length));
    const velocity = number < this.coordinates ? this.columns[number + this.coordinates] : undefined;
    return (this.derived[number] ??= velocity ?? slopes(this.t, this.columns[number]));
  }

  /** The interval that holds a time; near the last one, where motion asks. */
  interval(time) {
    const t = this.t,
      last = t.length - 2;
    let k = Math.min(this.found, last);
    if (!(t[k] <= time && time <= t[k + 1])) {
      let low = 0,
        high = last;
      while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (t[middle] <= time) low = middle;
        else high = middle - 1;
      }
      k = low;
    }
    return (this.found = k);
  }

  /** A column at a time in [0, T]. */
  at(number, time) {
    const k = this.interval(time),
      t = this.t,
      values = this.columns[number],
      slope = this.slopes(number);
    const length = t[k + 1] - t[k];
    const u = Math.min(Math.max((time - t[k]) / length, 0), 1),
      w = 1 - u;
    return (
      w * w * (1 + 2 * u) * values[k] +
      u * u * (1 + 2 * w) * values[k + 1] +
      length * u * w * (w * slope[k] - u * slope[k + 1])
    );
  }

  /** Times close enough for smooth curves: the samples, and more between them where they are few. */
  get fineTimes() {
    if (this.fine) return this.fine;
    const t = this.t,
      pieces = Math.max(1, Math.ceil(600 / t.length));
    const fine = new Float64Array((t.length - 1) * pieces + 1);
    for (let k = 0; k + 1 < t.length; ++k)
      for (let i = 0; i < pieces; ++i) fine[k * pieces + i] = t[k] + ((t[k + 1] - t[k]) * i) / pieces;
    fine[fine.length - 1] = this.duration;
    return (this.fine = fine);
  }

  /** A column at the fine times. */
  track(number) {
    if (!this.tracks.has(number))
      this.tracks.set(
        number,
        this.fineTimes.map((time) => this.at(number, time)),
      );
    return this.tracks.get(number);
  }
}

/** The page's data, with trajectories where there are any. */
export function readData() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const picture = data.picture;
  data.trajectories = picture
    ? picture.solutions.map((each) => new Trajectory(each, picture.coordinates))
    : [];
  return data;
}

/** The fields of a solution or of a point of a branch. */
export function fieldsOf(data, number) {
  if (data.kind === "branch") return data.result.points[number];
  return data.result.solutions ? (data.result.solutions[number] ?? data.result) : data.result;
}

/** When inequalities along the path are equalities, and points in between: none where a result has none. */
export const contactsOf = (fields) => fields.contacts ?? [];
export const waypointsOf = (fields) => fields.waypoints ?? [];
