// Motion in space, by WebGL: drag to turn, wheel to zoom.
import {
  BufferGeometry,
  Color,
  DirectionalLight,
  Float32BufferAttribute,
  HemisphereLight,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  MOUSE,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { mixed, themeColour, tone } from "./colour.js";
import { element } from "./dom.js";
import { marks } from "./marks.js";
import { axisText, short } from "./text.js";

const fieldOfView = 30; // degrees, upwards
const trailPoints = 60,
  trailShare = 0.12;
const behindPoints = 300; // of each path behind the one in front
const bodySize = 0.0095,
  centreSize = 0.008,
  markSize = 0.006; // radii, of the distance to the camera
const direction = [0.52, -0.76, 0.42]; // from which the box is seen first
const leastSide = 0.3; // of a box, of its longest side

export class SpaceView {
  /** Throws where WebGL cannot be had. */
  constructor(place, state) {
    if (!document.createElement("canvas").getContext("webgl2")) throw new Error("there is no WebGL");
    this.place = place;
    this.state = state;
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.debug.checkShaderErrors = false; // it would wait for the compiler
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("aria-label", "Motion in space");
    this.labels = element("div", { class: "labels" });
    place.append(this.canvas, this.labels);
    this.camera = new PerspectiveCamera(fieldOfView, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => (this.turned = true));
    this.reset();
  }

  reset() {
    // The ball about the box fits the picture, with a little room for names.
    const radius = this.sides ? Math.hypot(...this.sides) : 1;
    const narrow = Math.min(this.camera.aspect, 1) * Math.tan((fieldOfView * Math.PI) / 360);
    const distance = (1.08 * radius) / Math.sin(Math.atan(narrow));
    this.controls.target.set(0, 0, 0);
    this.camera.position.set(...direction).setLength(distance);
    this.controls.update();
  }
  magnify(factor) {
    this.camera.position.sub(this.controls.target).divideScalar(factor).add(this.controls.target);
    this.controls.update();
  }
  turn(across, up) {
    const arm = this.camera.position.clone().sub(this.controls.target);
    arm.applyAxisAngle(new Vector3(0, 0, 1), across);
    const side = new Vector3().crossVectors(this.camera.up, arm).normalize();
    const turned = arm.clone().applyAxisAngle(side, up);
    if (Math.abs(turned.clone().normalize().z) < 0.999) arm.copy(turned);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
  }

  show(view, front, behind, range) {
    if (view !== this.view) this.dropBackground();
    this.view = view;
    this.front = front;
    this.behind = behind;
    const sizes = range.map(([low, high]) => high - low),
      largest = Math.max(...sizes);
    this.middle = range.map(([low, high]) => low + (high - low) / 2);
    this.units = sizes.map((size) => 1 / (view.equal ? largest : size));
    this.sides = sizes.map((size, axis) => Math.max(size * this.units[axis], leastSide) / 2);
    this.range = range;
    this.build();
  }
  themeChanged() {
    this.dropBackground();
    if (this.view) this.build();
  }

  dropBackground() {
    this.scene?.remove(this.background);
    this.background?.geometry.dispose();
    this.background?.material.dispose();
    this.background = null;
  }

  point(values) {
    return values.map((value, axis) => (value - this.middle[axis]) * this.units[axis]);
  }

  build() {
    this.scene?.remove(this.background);
    this.scene?.traverse((node) => {
      node.geometry?.dispose();
      node.material?.dispose();
    });
    this.scene = new Scene();
    this.scene.add(new HemisphereLight(0xffffff, 0x8890a0, 2.2));
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(1, -1, 2);
    this.scene.add(sun);
    this.labels.replaceChildren();
    this.notes = [];
    this.addRoom();
    this.scene.add((this.background ??= this.pathsBehind()));
    this.addPaths(this.front, 2.6, 0.8, null);
    this.addShadows();
    this.ball = new SphereGeometry(1, 24, 16);
    this.bodies = this.view.bodies.map((body) => this.addBall(this.bodyColour(body), bodySize));
    this.trails = this.view.bodies.map((body) => this.addTrail(this.bodyColour(body)));
    this.fixed = [];
    for (const { name, at } of this.view.centres) {
      const ball = this.addFixed(at, "centre", centreSize);
      if (name) this.note(name, ball.position, "centre");
    }
    this.addMarks();
  }

  bodyColour(body) {
    return tone(this.view.bodies.length > 1 ? body.colour : this.front.colour);
  }

  note(text, position, kind) {
    const label = element("span", { class: kind }, text);
    this.labels.append(label);
    this.notes.push({ label, position: position.clone() });
  }

  /** Floor and edges, with names and ends of the axes. */
  addRoom() {
    const [a, b, c] = this.sides,
      points = [];
    const line = (...ends) => points.push(...ends.flat());
    for (const z of [-c, c]) {
      line([-a, -b, z], [a, -b, z], [a, -b, z], [a, b, z], [a, b, z], [-a, b, z], [-a, b, z], [-a, -b, z]);
    }
    for (const x of [-a, a]) for (const y of [-b, b]) line([x, y, -c], [x, y, c]);
    const lines = 8;
    for (let k = 1; k < lines; ++k) {
      const part = (2 * k) / lines - 1;
      line([part * a, -b, -c], [part * a, b, -c]);
      line([-a, part * b, -c], [a, part * b, -c]);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
    this.scene.add(new LineSegments(geometry, new LineBasicMaterial({ color: themeColour("grid") })));
    const spots = [
      [
        [-a, -1.12 * b, -c],
        [a, -1.12 * b, -c],
      ],
      [
        [1.12 * a, -b, -c],
        [1.12 * a, b, -c],
      ],
      [
        [-1.08 * a, -1.08 * b, -c],
        [-1.08 * a, -1.08 * b, c],
      ],
    ];
    this.view.axes.forEach((axis, k) => {
      const [from, to] = spots[k].map((spot) => new Vector3(...spot));
      this.note(axisText(axis), from.clone().lerp(to, 0.5), "axis");
      // A thin box is made thicker than the paths need.
      const reach = this.sides[k] / this.units[k];
      this.note(short(this.middle[k] - reach), from.clone().lerp(to, 0.04), "number");
      this.note(short(this.middle[k] + reach), from.clone().lerp(to, 0.96), "number");
    });
  }

  addLine(positions, parameters) {
    const geometry = new LineGeometry();
    geometry.setPositions(positions);
    const line = new Line2(geometry, new LineMaterial({ transparent: true, ...parameters }));
    this.scene.add(line);
    return line;
  }

  positions(trajectory, body, floor = false) {
    const tracks = body.columns.map((number) => trajectory.track(number));
    const positions = [];
    for (let k = 0; k < tracks[0].length; ++k) {
      const [x, y, z] = this.point(tracks.map((track) => track[k]));
      positions.push(x, y, floor ? -this.sides[2] : z);
    }
    return positions;
  }

  /** All paths behind as one object: a family has many. */
  pathsBehind() {
    const points = [],
      colours = [];
    for (const other of this.behind) {
      const own = new Color(mixed(themeColour("panel"), tone(other.colour), 0.36)).toArray();
      for (const body of this.view.bodies) {
        const positions = this.positions(other, body),
          last = positions.length / 3 - 1;
        const stride = Math.max(1, Math.floor(last / behindPoints));
        for (let k = 0; k < last; k += stride)
          for (const at of [k, Math.min(k + stride, last)]) {
            points.push(...positions.slice(3 * at, 3 * at + 3));
            colours.push(...own);
          }
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
    geometry.setAttribute("color", new Float32BufferAttribute(colours, 3));
    return new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }));
  }

  addPaths(trajectory, linewidth, opacity, colour) {
    for (const body of this.view.bodies)
      this.addLine(this.positions(trajectory, body), {
        color: mixed(themeColour("panel"), colour ?? this.bodyColour(body), opacity),
        linewidth,
      });
  }

  addShadows() {
    for (const body of this.view.bodies)
      this.addLine(this.positions(this.front, body, true), { color: themeColour("shadow"), linewidth: 1.4 });
  }

  addTrail(colour) {
    const line = this.addLine(new Array(3 * (trailPoints + 1)).fill(0), { vertexColors: true, linewidth: 5 });
    const from = new Color(mixed(themeColour("panel"), colour, 0.75)),
      to = new Color(colour),
      colours = [];
    for (let k = 0; k <= trailPoints; ++k)
      colours.push(
        ...from
          .clone()
          .lerp(to, (k / trailPoints) ** 1.5)
          .toArray(),
      );
    line.geometry.setColors(colours);
    line.frustumCulled = false;
    return line;
  }

  addBall(colour, size) {
    const ball = new Mesh(this.ball, new MeshLambertMaterial({ color: colour }));
    ball.userData.size = size;
    this.scene.add(ball);
    return ball;
  }

  addFixed(at, colour, size) {
    const ball = this.addBall(themeColour(colour), size);
    ball.position.set(...this.point(at));
    this.fixed.push(ball);
    return ball;
  }

  /** Contacts as parts of the path, waypoints as balls. */
  addMarks() {
    for (const body of this.view.bodies) {
      const { contacts, waypoints } = marks(this.state, this.front, body);
      for (const part of contacts)
        this.addLine(
          part.flatMap((place) => this.point(place)),
          { color: themeColour("contact"), linewidth: 5 },
        );
      for (const place of waypoints) this.addFixed(place, "waypoint", markSize);
    }
  }

  moveBodies() {
    const { front, view } = this,
      phase = this.state.phase,
      duration = front.duration;
    const place = (body, time) => this.point(body.columns.map((number) => front.at(number, time)));
    view.bodies.forEach((body, i) => {
      this.bodies[i].position.set(...place(body, phase * duration));
      // Segments of the trail: start and end of each, six numbers, written where they are.
      const { data } = this.trails[i].geometry.attributes.instanceStart;
      for (let k = 0; k <= trailPoints; ++k) {
        const at = phase - trailShare * (1 - k / trailPoints);
        const point = place(body, (at >= 0 ? at : view.closed ? at + 1 : 0) * duration);
        if (k < trailPoints) data.array.set(point, 6 * k);
        if (k > 0) data.array.set(point, 6 * k - 3);
      }
      data.needsUpdate = true;
    });
    for (const ball of [...this.bodies, ...this.fixed])
      ball.scale.setScalar(ball.userData.size * ball.position.distanceTo(this.camera.position));
  }

  draw() {
    const width = this.place.clientWidth,
      height = this.place.clientHeight;
    if (!this.scene || !width || !height) return;
    const ratio = window.devicePixelRatio || 1;
    if (this.width !== width || this.height !== height || this.ratio !== ratio) {
      [this.width, this.height, this.ratio] = [width, height, ratio];
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      if (!this.turned) this.reset();
    }
    this.moveBodies();
    this.renderer.render(this.scene, this.camera);
    for (const { label, position } of this.notes) {
      const at = position.clone().project(this.camera);
      label.style.transform = `translate(${((at.x + 1) / 2) * width}px, ${((1 - at.y) / 2) * height}px)`;
      label.hidden = Math.abs(at.z) > 1;
    }
  }
}
