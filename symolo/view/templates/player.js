/* The player: which run is shown, at what time, and the controls. */

class Colours {
  constructor(states) {
    this.states = states;
    const style = getComputedStyle(document.documentElement);
    const variable = (name) => () => style.getPropertyValue(name).trim();
    Object.assign(this, {
      ink: variable("--ink"), paper: variable("--paper"), faint: variable("--faint"), grid: variable("--line"),
      tape: variable("--tape"), wall: variable("--wall"), obstacle: variable("--soft"), scan: variable("--scan"),
    });
  }

  /** Black lines have the colour of the text, which is light on a dark page. */
  named(colour) { return colour === "#000000" ? this.ink() : colour; }
  of(state) { return this.named((this.states[state] || { colour: "#777777" }).colour); }
  nameOf(state) { return (this.states[state] || { name: String(state) }).name; }
}

class Player {
  constructor(data) {
    this.data = data;
    this.colours = new Colours(data.states);
    this.parts = Object.fromEntries(
      ["runs", "cameras", "map", "plots", "now", "play", "time", "clock", "speed", "failure"].map((id) => [id, document.getElementById(id)]),
    );
    this.map = new FloorMap(this.parts.map, this.colours);
    this.plots = [];
    this.t = 0;
    this.playing = false;
    for (const [i, run] of data.runs.entries()) this.parts.runs.append(new Option(run.failure ? `${run.name} (failed)` : run.name, i));
    this.connect();
    this.fromAddress();
  }

  connect() {
    const { runs, play, time } = this.parts;
    runs.addEventListener("change", () => this.show(Number(runs.value)));
    play.addEventListener("click", () => this.toggle());
    time.addEventListener("input", () => this.seek(this.run.t[Number(time.value)]));
    document.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("resize", () => this.resize());
    window.addEventListener("hashchange", () => this.fromAddress());
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.show(this.index, this.t));
  }

  /** Show a run from its beginning, or from a time [s]. */
  show(index, t) {
    this.index = index;
    this.run = this.data.runs[index];
    this.parts.runs.value = String(index);
    this.parts.time.max = this.run.t.length - 1;
    this.parts.failure.hidden = !this.run.failure;
    this.parts.failure.textContent = this.run.failure ? `This run failed: ${this.run.failure}` : "";
    this.cameras = this.run.cameras.map((camera) => this.camera(camera));
    this.parts.cameras.replaceChildren(...this.cameras.map(({ figure }) => figure));
    document.body.classList.toggle("blind", this.cameras.length === 0);
    document.body.classList.toggle("several", this.cameras.length > 1);
    this.parts.plots.replaceChildren();
    const seek = (time) => this.seek(time);
    const isStateless = this.run.state.every((state) => state < 0);
    const plots = [...(isStateless ? [] : [{ kind: "band", title: "state" }]), ...this.run.plots];
    this.plots = plots.map((plot) => new TimePlot(this.parts.plots, plot, this.run, this.colours, seek));
    this.map.show(this.run);
    this.resize();
    this.seek(t === undefined ? this.run.t[0] : t);
  }

  camera(camera) {
    const figure = document.createElement("figure");
    const image = document.createElement("img");
    const caption = document.createElement("figcaption");
    image.width = camera.width;
    image.height = camera.height;
    figure.append(image, caption);
    return { figure, image, caption, camera, index: -1 };
  }

  resize() {
    this.map.resize();
    for (const plot of this.plots) plot.resize();
    this.refresh();
  }

  seek(t) {
    const times = this.run.t;
    this.t = Math.min(Math.max(t, times[0]), times[times.length - 1]);
    this.refresh();
    if (!this.playing) this.toAddress();
  }

  refresh() {
    if (!this.run) return;
    const { run, t } = this;
    this.row = rowAt(run.t, t);
    for (const camera of this.cameras) this.picture(camera);
    this.map.at(this.row);
    for (const plot of this.plots) plot.at(this.row, t);
    const end = run.t[run.t.length - 1];
    this.parts.time.value = this.row;
    this.parts.time.setAttribute("aria-valuetext", `${t.toFixed(1)} s, ${this.colours.nameOf(run.state[this.row])}`);
    this.parts.clock.textContent = `${t.toFixed(2)} / ${end.toFixed(1)} s`;
    const { x, y, theta } = run.pose;
    const degrees = (180 / Math.PI) * theta[this.row];
    this.parts.now.textContent =
      `x ${x[this.row].toFixed(3)} m, y ${y[this.row].toFixed(3)} m, heading ${degrees.toFixed(0)} deg`;
  }

  /** Show the last image that was taken up to now, or the first one before it was taken. */
  picture(view) {
    const { camera } = view;
    const i = rowAt(camera.t, this.t);
    if (view.index === i) return;
    view.index = i;
    view.image.src = `data:image/jpeg;base64,${camera.jpeg[i]}`;
    view.image.alt = `Image ${camera.number[i]} of the ${camera.name}`;
    view.caption.textContent = `${camera.name}: image ${camera.number[i]}, ${camera.t[i].toFixed(2)} s`;
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing && this.row === this.run.t.length - 1) this.t = this.run.t[0];
    this.parts.play.textContent = this.playing ? "Pause" : "Play";
    this.parts.play.setAttribute("aria-pressed", String(this.playing));
    if (this.playing) {
      this.last = undefined;
      requestAnimationFrame((now) => this.step(now));
    } else {
      this.toAddress();
    }
  }

  step(now) {
    if (!this.playing) return;
    const passed = this.last === undefined ? 0 : (now - this.last) / 1000;
    this.last = now;
    this.seek(this.t + Math.min(passed, 0.25) * Number(this.parts.speed.value));
    if (this.row === this.run.t.length - 1) this.toggle(); else requestAnimationFrame((next) => this.step(next));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "SELECT") return;
    const actions = {
      " ": () => this.toggle(),
      k: () => this.toggle(),
      ArrowRight: () => this.seek(this.neighbour(1, event.shiftKey)),
      ArrowLeft: () => this.seek(this.neighbour(-1, event.shiftKey)),
      Home: () => this.seek(this.run.t[0]),
      End: () => this.seek(this.run.t[this.run.t.length - 1]),
      n: () => this.show((this.index + 1) % this.data.runs.length),
      p: () => this.show((this.index + this.data.runs.length - 1) % this.data.runs.length),
      f: () => { this.map.follows = !this.map.follows; this.map.draw(); },
    };
    if (!(event.key in actions) || (event.key === " " && event.target.tagName === "SUMMARY")) return;
    event.preventDefault();
    actions[event.key]();
  }

  /** Return the time of the next or the previous image; of the row if there are no images; a second away with Shift. */
  neighbour(direction, wide) {
    if (wide) return this.t + direction;
    const times = this.cameras.length ? this.cameras[0].camera.t : this.run.t;
    const i = rowAt(times, this.t);
    const before = direction < 0 && times[i] < this.t - 1e-6 ? 0 : direction; // between two images, back to the first
    return times[Math.min(Math.max(i + before, 0), times.length - 1)];
  }

  /** Show the run and the time that the address of the page names after `#`. */
  fromAddress() {
    const wanted = new URLSearchParams(window.location.hash.slice(1));
    const index = this.data.runs.findIndex((run) => run.name === wanted.get("run"));
    const t = Number.parseFloat(wanted.get("t"));
    this.show(Math.max(index, 0), Number.isNaN(t) ? undefined : t);
  }

  toAddress() {
    const place = `#run=${this.run.name}&t=${this.t.toFixed(2)}`;
    if (place !== window.location.hash) window.history.replaceState(null, "", place);
  }
}

const player = new Player(JSON.parse(document.getElementById("data").textContent));
