// The moving layer of a plain canvas.
import { faded, mixed, themeColour, tone } from "./colour.js";
import { edges } from "./projection.js";

const trailPoints = 48,
  trailShare = 0.12; // of the duration

/** What moves, on a plain canvas: bodies with trails, profiles, the hand of an angle. */
export function drawMotion(plane, context) {
  const phase = plane.state.phase;
  context.save();
  if (!plane.small && !plane.space) {
    const { pad } = plane.project;
    context.beginPath();
    context.rect(
      pad.left,
      pad.top,
      plane.canvas.clientWidth - pad.left - pad.right,
      plane.canvas.clientHeight - pad.top - pad.bottom,
    );
    context.clip();
  }
  if (plane.view.kind === "profile") {
    for (const other of plane.behind) drawProfile(plane, context, other, phase, 0.35, tone(other.colour));
    drawProfile(plane, context, plane.front, phase, 1, null);
  } else {
    if (!plane.small) for (const other of plane.behind) drawBodies(plane, context, other, phase, 0.45, 3);
    if (!plane.small) drawTrails(plane, context, phase);
    drawBodies(plane, context, plane.front, phase, 1, plane.small ? 3.5 : 6.5);
    if (plane.view.angle && !plane.small) drawHand(plane, context, phase);
  }
  context.restore();
}

function drawTrails(plane, context, phase) {
  const trajectory = plane.front,
    duration = trajectory.duration;
  for (const body of plane.view.bodies) {
    const colour = plane.bodyColour(trajectory, body);
    let before = null;
    for (let k = 0; k <= trailPoints; ++k) {
      let at = phase - trailShare * (1 - k / trailPoints);
      if (at < 0 && !plane.view.closed) continue;
      if (at < 0) at += 1;
      const here = plane.place(trajectory, body, at * duration);
      if (before) {
        context.strokeStyle = faded(colour, (k / trailPoints) ** 1.5);
        context.lineWidth = 1.5 + (2.5 * k) / trailPoints;
        context.beginPath();
        context.moveTo(...before);
        context.lineTo(...here);
        context.stroke();
      }
      before = here;
    }
  }
}

function drawBodies(plane, context, trajectory, phase, opacity, radius) {
  for (const body of plane.view.bodies) {
    const colour = plane.bodyColour(trajectory, body);
    context.beginPath();
    context.arc(...plane.place(trajectory, body, phase * trajectory.duration), radius, 0, 2 * Math.PI);
    context.fillStyle = mixed(themeColour("panel"), colour, opacity);
    context.fill();
    if (radius < 4) continue;
    context.lineWidth = 2;
    context.strokeStyle = themeColour("panel");
    context.stroke();
  }
}

function drawProfile(plane, context, trajectory, phase, opacity, colour) {
  const time = phase * trajectory.duration;
  const several = plane.view.bodies.length > 1;
  for (const line of plane.view.bodies) {
    const points = line.columns.map((number, k) => plane.project.at([k + 1, trajectory.at(number, time)]));
    const own = faded(colour ?? tone(several ? line.colour : trajectory.colour), opacity);
    context.strokeStyle = context.fillStyle = own;
    context.lineWidth = 1.6;
    context.beginPath();
    for (const point of points) context.lineTo(...point);
    context.stroke();
    if (plane.small || opacity < 1) continue;
    const radius = Math.min(Math.max((0.3 * plane.project.inner[0]) / points.length, 1), 5.5);
    for (const [x, y] of points) {
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fill();
    }
  }
}

/** An angle as a hand that hangs down at zero. */
function drawHand(plane, context, phase) {
  const radius = 34,
    x = plane.canvas.clientWidth - edges.right - radius - 14,
    y = edges.top + radius + 14;
  const angle = plane.front.at(plane.view.bodies[0].columns[0], phase * plane.front.duration);
  const bob = [x + radius * Math.sin(angle), y + radius * Math.cos(angle)];
  context.fillStyle = faded(themeColour("panel"), 0.85);
  context.strokeStyle = themeColour("axis");
  context.lineWidth = 1;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  const colour = tone(plane.front.colour);
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 2.5;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(...bob);
  context.stroke();
  context.beginPath();
  context.arc(...bob, 6, 0, 2 * Math.PI);
  context.fill();
}
