/* The floor from above: line, walls and obstacles, the path so far, the robot and its range readings. */

const SCALE_PX = 32; // height of the strip below the map, for the bar of the scale

class FloorMap {
  constructor(canvas, colours) {
    this.canvas = canvas;
    this.colours = colours;
    this.follows = false;
    canvas.addEventListener("click", () => { this.follows = !this.follows; this.draw(); });
  }

  show(run) {
    this.run = run;
    for (const scan of run.scans) {
      const bytes = Uint8Array.from(atob(scan.mm), (letter) => letter.charCodeAt(0));
      scan.ranges = new Uint16Array(bytes.buffer); // of the byte order of every machine that has a browser
    }
    this.window = windowOf(run);
    this.resize();
  }

  /** Give the canvas the shape of the floor, as wide as its place and not higher than the screen allows. */
  resize() {
    if (!this.run) return;
    const width = this.canvas.parentElement.clientWidth;
    const [low, high] = this.window;
    const shape = (high[1] - low[1]) / (high[0] - low[0]);
    const height = SCALE_PX + Math.min(width * shape, Math.max(260, 0.52 * window.innerHeight));
    this.context = sharpContext(this.canvas, width, height);
    this.draw();
  }

  at(row) {
    this.row = row;
    this.draw();
  }

  draw() {
    if (!this.run || this.row === undefined || !this.context) return;
    const { context, run, row } = this;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight - SCALE_PX];
    const pose = [run.pose.x[row], run.pose.y[row], run.pose.theta[row]];
    const [low, high] = this.follows ? aroundRobot(pose, width / height) : this.window;
    const scale = Math.min(width / (high[0] - low[0]), height / (high[1] - low[1]));
    const place = ([x, y]) => [
      0.5 * width + scale * (x - 0.5 * (low[0] + high[0])),
      0.5 * height - scale * (y - 0.5 * (low[1] + high[1])),
    ];
    const ink = this.colours.ink();
    context.clearRect(0, 0, width, height + SCALE_PX);
    context.save();
    context.beginPath();
    context.rect(0, 0, width, height);
    context.clip();
    for (const piece of run.arena.line) fill(context, piece.map(place), this.colours.tape());
    for (const box of run.arena.boxes) {
      const corners = cornersOf(box, row).map(place);
      fill(context, corners, box.kind === "wall" ? this.colours.wall() : this.colours.obstacle());
      outline(context, corners, ink, 1);
    }
    this.path(place, 0, run.state.length - 1, 1, 0.35);
    this.path(place, 0, row, 2.5, 1);
    for (const scan of run.scans) this.scan(scan, place);
    for (const beam of run.beams) this.beam(beam, pose, place);
    this.robot(pose, place, this.colours.of(run.state[row]));
    context.restore();
    this.scale(scale, height + SCALE_PX);
  }

  /** Draw a bar of a round length below the map; `scale` is in pixels per metre. */
  scale(scale, height) {
    const length = niceStep(180 / scale);
    const [x, y, ink] = [10.5, height - 10.5, this.colours.faint()];
    outline(this.context, [[x, y], [x + length * scale, y]], ink, 2);
    this.context.fillStyle = ink;
    this.context.font = "11px system-ui, sans-serif";
    this.context.textAlign = "left";
    this.context.fillText(`${shown(length)} m`, x, y - 6);
  }

  /** Draw the path between two rows, each stretch in the colour of its state. */
  path(place, first, last, width, alpha) {
    const { context, run } = this;
    context.globalAlpha = alpha;
    context.lineWidth = width;
    context.lineJoin = "round";
    for (let start = first; start < last;) {
      let end = start + 1;
      while (end < last && run.state[end] === run.state[start]) end += 1;
      context.strokeStyle = this.colours.of(run.state[start]);
      context.beginPath();
      for (let i = start; i <= end; i += 1) context.lineTo(...place([run.pose.x[i], run.pose.y[i]]));
      context.stroke();
      start = end;
    }
    context.globalAlpha = 1;
  }

  beam(beam, pose, place) {
    const range = beam.range[this.row];
    if (range === null) return;
    const from = onFloor(pose, [beam.x, beam.y]);
    const yaw = pose[2] + beam.yaw;
    const to = place([from[0] + range * Math.cos(yaw), from[1] + range * Math.sin(yaw)]);
    const colour = this.colours.named(beam.colour);
    outline(this.context, [place(from), to], colour, 1.5);
    this.context.fillStyle = colour;
    this.context.fillRect(to[0] - 2.5, to[1] - 2.5, 5, 5);
  }

  /** Draw the end of each ray of the last scan, from where the robot was then. */
  scan(scan, place) {
    const { run } = this;
    const i = rowAt(scan.t, run.t[this.row]);
    if (scan.t[i] > run.t[this.row] + 1e-6) return;
    const row = rowAt(run.t, scan.t[i]);
    const pose = [run.pose.x[row], run.pose.y[row], run.pose.theta[row]];
    const from = onFloor(pose, [scan.x, scan.y]);
    this.context.fillStyle = this.colours.scan();
    scan.angles.forEach((angle, k) => {
      const range = scan.ranges[i * scan.angles.length + k] / 1000;
      if (range === 0) return;
      const [x, y] = place([from[0] + range * Math.cos(pose[2] + angle), from[1] + range * Math.sin(pose[2] + angle)]);
      this.context.fillRect(x - 1.2, y - 1.2, 2.4, 2.4);
    });
  }

  robot(pose, place, colour) {
    const { length, width, track, wheel } = this.run.robot;
    const rectangle = (x, y, long, wide) =>
      [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([i, j]) => place(onFloor(pose, [x + 0.5 * i * long, y + 0.5 * j * wide])));
    const body = rectangle(0, 0, length, width);
    fill(this.context, body, colour, 0.85);
    outline(this.context, body, this.colours.ink(), 1.2);
    for (const side of [1, -1]) fill(this.context, rectangle(0, 0.5 * side * track, wheel, 0.3 * wheel), this.colours.ink());
    const nose = [[0.42, 0], [0.1, 0.22], [0.1, -0.22]].map(([x, y]) => place(onFloor(pose, [x * length, y * width])));
    fill(this.context, nose, this.colours.paper());
    outline(this.context, nose, this.colours.ink(), 1);
  }
}

/** Return the corner with the smallest and that with the largest x and y [m] of everything on the map. */
function windowOf(run) {
  const xs = [...run.pose.x], ys = [...run.pose.y];
  for (const piece of run.arena.line) for (const [x, y] of piece) { xs.push(x); ys.push(y); }
  for (const box of run.arena.boxes) {
    for (let row = 0; row < box.x.length; row += 1) for (const [x, y] of cornersOf(box, row)) { xs.push(x); ys.push(y); }
  }
  const least = (values) => values.reduce((a, b) => Math.min(a, b));
  const most = (values) => values.reduce((a, b) => Math.max(a, b));
  const margin = 0.6 * Math.max(run.robot.length, run.robot.width);
  return [[least(xs) - margin, least(ys) - margin], [most(xs) + margin, most(ys) + margin]];
}

function aroundRobot(pose, shape) {
  const half = 0.45;
  return [[pose[0] - half * shape, pose[1] - half], [pose[0] + half * shape, pose[1] + half]];
}

/** Return the corners of a box at a row; one that stands still has one pose for all rows. */
function cornersOf(box, row) {
  const i = Math.min(row, box.x.length - 1);
  const pose = [box.x[i], box.y[i], box.theta[i]];
  return [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a, b]) => onFloor(pose, [0.5 * a * box.length, 0.5 * b * box.width]));
}

/** Return where a point of a body with a pose in W is on the floor. */
function onFloor(pose, point) {
  const [cos, sin] = [Math.cos(pose[2]), Math.sin(pose[2])];
  return [pose[0] + cos * point[0] - sin * point[1], pose[1] + sin * point[0] + cos * point[1]];
}

function fill(context, points, colour, alpha = 1) {
  context.globalAlpha = alpha;
  context.fillStyle = colour;
  trace(context, points);
  context.fill();
  context.globalAlpha = 1;
}

function outline(context, points, colour, width) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  trace(context, points);
  if (points.length > 2) context.closePath();
  context.stroke();
}

function trace(context, points) {
  context.beginPath();
  for (const point of points) context.lineTo(...point);
}

/** Size a canvas in CSS pixels, and return its context, which is as sharp as the screen. */
function sharpContext(canvas, width, height) {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.height = `${height}px`;
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return context;
}
