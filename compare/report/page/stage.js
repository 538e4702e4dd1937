// A run's motion from its knots, and one pane that draws it.
class Motion {
  constructor(run, bodies) {
    this.run = run;
    this.paths = bodies.map(() => []);
    for (const [k, body, x, y, vx, vy] of run.knots) this.paths[body].push([run.times[k], x, y, vx, vy]);
    this.eventTimes = run.events.map((event) => event[1]);
  }

  // x, y, vx, vy of a body; after the run's end it stays where it was.
  at(body, time) {
    const path = this.paths[body];
    const now = Math.min(time, this.run.end);
    const knot = path[Math.max(0, lastNotAfter(path, now, (k) => k[0]))];
    const [t, x, y, vx, vy] = knot;
    return [x + vx * (now - t), y + vy * (now - t), vx, vy];
  }

  // The place in the list of the last event that is not after a time; -1 before the first.
  eventAt(time) {
    return lastNotAfter(this.eventTimes, time, (t) => t);
  }
}

function lastNotAfter(rows, time, key) {
  let [low, high] = [-1, rows.length - 1];
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (key(rows[middle]) <= time) low = middle;
    else high = middle - 1;
  }
  return low;
}

class Pane {
  constructor(canvas, data) {
    this.canvas = canvas;
    this.data = data;
    this.pen = canvas.getContext("2d");
  }

  // Fits the drawing to the size that the page gives the canvas; returns pixels to a unit.
  fit() {
    const [left, bottom, width, height] = this.data.view;
    const across = this.canvas.clientWidth;
    const up = Math.min(across * (height / width), Math.max(260, innerHeight * 0.55));
    const ratio = devicePixelRatio || 1;
    this.canvas.style.height = `${up}px`;
    this.canvas.width = Math.round(across * ratio);
    this.canvas.height = Math.round(up * ratio);
    this.scale = Math.min(across / width, up / height);
    this.ratio = ratio;
    this.shift = [across / 2 - (left + width / 2) * this.scale, up / 2 + (bottom + height / 2) * this.scale];
  }

  place(x, y) {
    return [this.shift[0] + x * this.scale, this.shift[1] - y * this.scale];
  }

  round(x, y, r) {
    const [px, py] = this.place(x, y);
    this.pen.beginPath();
    this.pen.arc(px, py, Math.max(r * this.scale, 1.5), 0, 2 * Math.PI);
  }

  draw(motion, time, look) {
    const { pen, data } = this;
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.fillStyle = look.frame;
    pen.fillRect(0, 0, this.canvas.width, this.canvas.height);
    pen.fillStyle = look.line;
    for (const [x, y, r] of data.pockets) { this.round(x, y, r); pen.fill(); }
    const marked = look.marked;
    data.walls.forEach((wall, k) => this.wall(wall, marked?.walls.includes(k) ? 4 : 1.5, look.soft));
    if (look.ghost) this.bodies(look.ghost, time, { ...look, colour: look.reference, dash: [], fill: false, marked: null, label: false });
    this.bodies(motion, time, { ...look, fill: true, label: true });
  }

  bodies(motion, time, look) {
    const { pen, data } = this;
    data.bodies.forEach(([name, r, fixed], body) => {
      const [x, y] = motion.at(body, time);
      pen.setLineDash(fixed ? [] : look.dash);
      pen.lineWidth = look.fill ? 1.6 : 1;
      pen.strokeStyle = fixed ? look.soft : look.colour;
      this.round(x, y, r);
      if (look.fill) { pen.globalAlpha = 0.18; pen.fillStyle = pen.strokeStyle; pen.fill(); pen.globalAlpha = 1; }
      pen.stroke();
      if (look.marked?.bodies.includes(body)) {
        pen.setLineDash([]);
        pen.lineWidth = 2.5;
        pen.strokeStyle = look.text;
        this.round(x, y, r + 5 / this.scale);
        pen.stroke();
      }
      if (look.label && r * this.scale >= 3 * name.length + 2) {
        pen.fillStyle = look.text;
        pen.font = "11px system-ui, sans-serif";
        pen.textAlign = "center";
        pen.textBaseline = "middle";
        pen.fillText(name, ...this.place(x, y));
      }
    });
    pen.setLineDash([]);
  }

  wall([x0, y0, x1, y1], width, colour) {
    const far = (4 * (this.canvas.width + this.canvas.height)) / this.scale / Math.hypot(x1 - x0, y1 - y0);
    const [dx, dy] = [(x1 - x0) * far, (y1 - y0) * far];
    const [left, bottom, across, up] = this.data.view;
    const along = ((left + across / 2 - x0) * dx + (bottom + up / 2 - y0) * dy) / (dx * dx + dy * dy);
    const [x, y] = [x0 + along * dx, y0 + along * dy];
    this.pen.beginPath();
    this.pen.moveTo(...this.place(x - dx, y - dy));
    this.pen.lineTo(...this.place(x + dx, y + dy));
    this.pen.lineWidth = width;
    this.pen.strokeStyle = colour;
    this.pen.stroke();
  }
}
