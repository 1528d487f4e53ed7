/* Plots against time with one mark for the present; a click or a drag sets the time. */

const MARGIN = 42; // CSS pixels for the labels of the vertical axis
const BELOW = 14; // the same for those of the time

class TimePlot {
  /**
   * @param place Element to which the plot is added.
   * @param seek Called with the time [s] that the user chooses.
   */
  constructor(place, plot, run, colours, seek) {
    Object.assign(this, { plot, run, colours });
    this.element = document.createElement("div");
    this.element.className = `plot ${plot.kind}`;
    this.label = document.createElement("p");
    this.box = document.createElement("div");
    this.box.className = "curves";
    this.canvas = document.createElement("canvas");
    this.mark = document.createElement("div");
    this.mark.className = "mark";
    this.box.append(this.canvas, this.mark);
    this.element.append(this.label, this.box);
    place.append(this.element);
    const choose = (event) => seek(this.timeAt(event.clientX - this.box.getBoundingClientRect().left));
    this.box.addEventListener("pointerdown", (event) => { this.box.setPointerCapture(event.pointerId); choose(event); });
    this.box.addEventListener("pointermove", (event) => { if (event.buttons) choose(event); });
    this.values = this.legend();
  }

  get times() { return this.run.t; }

  timeAt(x) {
    const share = (x - MARGIN) / (this.box.clientWidth - MARGIN);
    const [first, last] = [this.times[0], this.times[this.times.length - 1]];
    return first + Math.min(1, Math.max(0, share)) * (last - first);
  }

  x(t) {
    const [first, last] = [this.times[0], this.times[this.times.length - 1]];
    return MARGIN + (this.width - MARGIN) * (last > first ? (t - first) / (last - first) : 0);
  }

  legend() {
    const { title, unit, curves = [] } = this.plot;
    this.label.append(element("strong", unit ? `${title} [${unit}]` : title));
    return (curves.length ? curves : [{ name: "" }]).map((curve) => {
      const value = element("span", "", "value");
      if (curve.name && curves.length > 1) {
        const swatch = element("span", "", "swatch");
        swatch.style.background = this.colours.named(curve.colour);
        this.label.append(swatch, element("span", `${curve.name} `));
      }
      this.label.append(value);
      return value;
    });
  }

  resize() {
    this.width = this.box.clientWidth;
    this.height = { band: 26, stripes: 56 }[this.plot.kind] || 76 + BELOW;
    this.context = sharpContext(this.canvas, this.width, this.height);
    ({ band: () => this.band(), stripes: () => this.stripes() }[this.plot.kind] || (() => this.curves()))();
  }

  at(row, t) {
    this.mark.style.transform = `translateX(${this.x(t)}px)`;
    if (this.plot.kind === "band") {
      this.values[0].textContent = this.colours.nameOf(this.run.state[row]);
    } else if (this.plot.kind !== "stripes") {
      const i = rowAt(this.plot.t || this.times, t);
      this.plot.curves.forEach((curve, k) => { this.values[k].textContent = shown(curve.values[i]); });
    }
  }

  /** Draw the states as coloured stretches. */
  band() {
    const { state } = this.run;
    for (let start = 0; start < state.length;) {
      let end = start + 1;
      while (end < state.length && state[end] === state[start]) end += 1;
      const [from, to] = [this.x(this.times[start]), this.x(this.times[Math.min(end, state.length - 1)])];
      this.context.fillStyle = this.colours.of(state[start]);
      this.context.fillRect(from, 2, Math.max(to - from, 1), this.height - 4);
      start = end;
    }
  }

  /** Draw many channels as a strip of greys, the first channel at the bottom. */
  stripes() {
    const { channels, rows, levels, names } = this.plot;
    const bytes = Uint8Array.from(atob(levels), (letter) => letter.charCodeAt(0));
    const image = new ImageData(rows, channels);
    for (let row = 0; row < rows; row += 1) {
      for (let channel = 0; channel < channels; channel += 1) {
        const level = bytes[row * channels + channel];
        image.data.set([level, level, level, 255], 4 * ((channels - 1 - channel) * rows + row));
      }
    }
    const small = document.createElement("canvas");
    [small.width, small.height] = [rows, channels];
    small.getContext("2d").putImageData(image, 0, 0);
    this.context.imageSmoothingEnabled = false;
    this.context.drawImage(small, MARGIN, 0, this.width - MARGIN, this.height);
    this.text(names[channels - 1], 10);
    this.text(names[0], this.height - 2);
  }

  curves() {
    const { curves, fromZero } = this.plot;
    const times = this.plot.t || this.times;
    const all = curves.flatMap((curve) => curve.values.filter((value) => value !== null));
    let low = all.length ? all.reduce((a, b) => Math.min(a, b)) : 0;
    let high = all.length ? all.reduce((a, b) => Math.max(a, b)) : 1;
    if (low > 0 && (fromZero || low < 0.5 * high)) low = 0;
    const step = niceStep((high - low) || Math.abs(high) || 1);
    [low, high] = [Math.floor(low / step) * step, Math.ceil(high / step) * step];
    if (low === high) high = low + step;
    const y = (value) => this.height - BELOW - 6 - (this.height - BELOW - 12) * (value - low) / (high - low);
    this.timeAxis();
    for (let value = low; value <= high + 0.01 * step; value += step) {
      outline(this.context, [[MARGIN, y(value)], [this.width, y(value)]], this.colours.grid(), 1);
      const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      this.text(value.toFixed(digits).replace(/^-(?=[0.]+$)/, ""), y(value) + 4);
    }
    for (const curve of curves) {
      this.context.strokeStyle = this.colours.named(curve.colour);
      this.context.lineWidth = 1.4;
      this.context.setLineDash(curve.dashes);
      this.context.beginPath();
      let gap = true;
      curve.values.forEach((value, i) => {
        if (value === null) { gap = true; return; }
        this.context[gap ? "moveTo" : "lineTo"](this.x(times[i]), y(value));
        gap = false;
      });
      this.context.stroke();
    }
    this.context.setLineDash([]);
  }

  /** Write round times below the curves, the last one with its unit. */
  timeAxis() {
    const [first, last] = [this.times[0], this.times[this.times.length - 1]];
    const step = niceStep((last - first) || 1) / (this.width > 420 ? 2 : 1);
    const ticks = [];
    for (let t = Math.ceil(first / step) * step; t <= last + 1e-6; t += step) ticks.push(t);
    this.context.fillStyle = this.colours.faint();
    this.context.font = "11px system-ui, sans-serif";
    ticks.forEach((t, i) => {
      const isLast = i === ticks.length - 1;
      this.context.textAlign = isLast ? "right" : "center";
      this.context.fillText(isLast ? `${shown(t)} s` : shown(t), this.x(t), this.height - 2);
    });
  }

  text(words, y) {
    this.context.fillStyle = this.colours.faint();
    this.context.font = "11px system-ui, sans-serif";
    this.context.textAlign = "right";
    this.context.fillText(words, MARGIN - 5, y);
  }
}

/** Return a step of 1, 2 or 5 times a power of ten that divides a range into two to five parts. */
function niceStep(range) {
  const power = 10 ** Math.floor(Math.log10(range / 2));
  return [5, 2, 1].map((factor) => factor * power).find((step) => range / step >= 2) || power;
}

/** Return the index of the last of the increasing times that is not after t; 0 where all are. */
function rowAt(times, t) {
  let [low, high] = [0, times.length - 1];
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (times[middle] <= t + 1e-6) low = middle; else high = middle - 1;
  }
  return low;
}

function shown(value) {
  if (value === null || value === undefined) return "-";
  return String(Number(value.toPrecision(3)));
}

function element(kind, text = "", name = "") {
  const result = document.createElement(kind);
  result.textContent = text;
  if (name) result.className = name;
  return result;
}
