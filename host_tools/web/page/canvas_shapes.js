// Drawing on a canvas in world coordinates (metres, z up).

/** A view of the world: `centre_x` and `base_z` (bottom edge) in metres, scale in pixels per metre. */
function makeView(context, width, height, centre_x, base_z, scale) {
  return {
    context, width, height, centre_x, base_z, scale,
    x: (x) => width / 2 + (x - centre_x) * scale,
    y: (z) => height - (z - base_z) * scale,
  };
}

/**
 * Fits a canvas to its box in device pixels; returns its context and size in CSS pixels. Who draws often gives the
 * size of the box, as asking for it makes the browser lay the page out.
 */
function fitCanvas(canvas, { width, height } = { width: canvas.clientWidth, height: canvas.clientHeight }) {
  const ratio = window.devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

/** A link: a bar with round ends whose radius (metres) goes from `ra` to `rb`. */
function drawLink(view, a, b, ra, rb, fill, edge) {
  const c = view.context;
  const angle = Math.atan2(view.y(b.z) - view.y(a.z), view.x(b.x) - view.x(a.x));
  c.beginPath();
  c.arc(view.x(a.x), view.y(a.z), ra * view.scale, angle + Math.PI / 2, angle - Math.PI / 2);
  c.arc(view.x(b.x), view.y(b.z), rb * view.scale, angle - Math.PI / 2, angle + Math.PI / 2);
  c.closePath();
  c.fillStyle = fill;
  c.fill();
  c.lineWidth = 1.5;
  c.strokeStyle = edge;
  c.stroke();
}

function drawDisc(view, centre, radius_m, fill, edge) {
  const c = view.context;
  c.beginPath();
  c.arc(view.x(centre.x), view.y(centre.z), radius_m * view.scale, 0, 2 * Math.PI);
  c.fillStyle = fill;
  c.fill();
  if (edge) {
    c.lineWidth = 1.5;
    c.strokeStyle = edge;
    c.stroke();
  }
}

function drawPath(view, points, colour, width, dash = []) {
  const c = view.context;
  c.beginPath();
  for (const p of points) c.lineTo(view.x(p.x), view.y(p.z));
  c.setLineDash(dash);
  c.lineWidth = width;
  c.strokeStyle = colour;
  c.lineJoin = 'round';
  c.lineCap = 'round';
  c.stroke();
  c.setLineDash([]);
}

/** An arrow from `a` to `b`, `width` in pixels. */
function drawArrow(view, a, b, colour, width) {
  const c = view.context;
  const [x0, y0, x1, y1] = [view.x(a.x), view.y(a.z), view.x(b.x), view.y(b.z)];
  const length = Math.hypot(x1 - x0, y1 - y0);
  if (!(length > 3)) return;
  const head = Math.min(length, 3.5 * width + 3);
  const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
  const [bx, by] = [x1 - head * ux, y1 - head * uy];
  c.strokeStyle = colour;
  c.fillStyle = colour;
  c.lineWidth = width;
  c.lineCap = 'butt';
  c.beginPath();
  c.moveTo(x0, y0);
  c.lineTo(bx + ux, by + uy);
  c.stroke();
  c.beginPath();
  c.moveTo(x1, y1);
  c.lineTo(bx - 0.45 * head * uy, by + 0.45 * head * ux);
  c.lineTo(bx + 0.45 * head * uy, by - 0.45 * head * ux);
  c.fill();
}

/** A foothold on the ground: a triangle pointing up at it; hollow when it is only planned. */
function drawFoothold(view, place, colour, filled) {
  const c = view.context;
  const [x, y] = [view.x(place.x), view.y(place.z) + 3];
  c.beginPath();
  c.moveTo(x, y);
  c.lineTo(x - 5, y + 9);
  c.lineTo(x + 5, y + 9);
  c.closePath();
  c.lineWidth = 1.5;
  c.strokeStyle = colour;
  c.stroke();
  if (!filled) return;
  c.fillStyle = colour;
  c.fill();
}
