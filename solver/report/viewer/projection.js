// From numbers of axes to pixels of a canvas.

/** Around the picture, for numbers and names of axes. */
export const edges = { left: 58, right: 18, top: 28, bottom: 40 };
const smallEdges = { left: 8, right: 8, top: 8, bottom: 8 };
const diagonal = 1.45; // of a box in space, of its longest side, as it is seen at most

/** `at` gives pixels of a point, `back` the point of a pixel in the plane. */
export function projection(plane, width, height) {
  const pad = plane.small ? smallEdges : edges;
  const inner = [Math.max(width - pad.left - pad.right, 10), Math.max(height - pad.top - pad.bottom, 10)];
  const middle = plane.range.map(([low, high]) => low + (high - low) / 2);
  const sizes = plane.range.map(([low, high]) => high - low);
  const origin = [pad.left + inner[0] / 2 + plane.shift[0], pad.top + inner[1] / 2 + plane.shift[1]];
  if (plane.space) return spaceProjection(plane, middle, sizes, inner, origin);
  let scale = [inner[0] / sizes[0], inner[1] / sizes[1]];
  if (plane.view.equal) scale = scale.fill(Math.min(...scale));
  scale = scale.map((each) => each * plane.zoom);
  const at = (point) => [
    origin[0] + (point[0] - middle[0]) * scale[0],
    origin[1] - (point[1] - middle[1]) * scale[1],
  ];
  const back = (x, y) => [middle[0] + (x - origin[0]) / scale[0], middle[1] - (y - origin[1]) / scale[1]];
  return { at, back, pad, inner };
}

function spaceProjection(plane, middle, sizes, inner, origin) {
  const largest = Math.max(...sizes);
  const units = sizes.map((size) => (plane.view.equal ? 1 / largest : 1 / size));
  const scale = (Math.min(...inner) / diagonal) * plane.zoom;
  const [ca, sa, cb, sb] = [
    Math.cos(plane.yaw),
    Math.sin(plane.yaw),
    Math.sin(plane.pitch),
    Math.cos(plane.pitch),
  ];
  const at = (point) => {
    const [x, y, z] = point.map((value, axis) => (value - middle[axis]) * units[axis]);
    const across = ca * x - sa * y,
      away = sa * x + ca * y;
    return [origin[0] + across * scale, origin[1] - (cb * away + sb * z) * scale];
  };
  return { at, back: null, inner };
}
