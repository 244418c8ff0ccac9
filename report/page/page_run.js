// SPDX-License-Identifier: Apache-2.0
// A run as typed arrays: this page's own, and another one that may be laid over it.
class Run {
  /** From the data of a page. */
  static async of(data) {
    const run = new Run(), d = data.run;
    Object.assign(run, {data, period: d.period, start: d.start, bucket: d.bucket, tolerance: d.tolerance, duration: d.duration, view: d.view, shift: 0});
    run.end = Math.max(run.start + run.duration, run.start + run.period);
    const axes = data.report.en.axes;
    run.axes = d.axes.map(letter => ({letter, report: axes[letter] || {unit: "mm", limits: {}}}));
    run.series = new Map();
    for (const s of d.series) {
      const low = await column(s.low, Float32Array);
      run.series.set(s.name, {name: s.name, unit: s.unit, low, high: s.high === undefined ? low : await column(s.high, Float32Array)});
    }
    run.line = await column(d.line, Int32Array);
    run.path = {};
    for (const key of ["x", "y", "z", "t", "speed", "deviation"]) run.path[key] = await column(d.path[key], Float32Array);
    for (const key of ["line", "tool", "rapid"]) run.path[key] = await column(d.path[key], Int32Array);
    run.path.n = run.path.x.length;
    run.signals = [];
    for (const s of d.signals) run.signals.push({name: s.name, initial: s.initial, toggles: await column(s.toggles), truncated: s.truncated});
    const [number, first, total] = [await column(d.lines.number), await column(d.lines.first), await column(d.lines.total)];
    run.frames = d.frames || [];
    run.lines = new Map([...number].map((line, i) => [line, {first: first[i], total: total[i]}]));
    run.program = new TextDecoder().decode(await inflated(data.program.text)).split(/\r?\n/);
    if (run.program[run.program.length - 1] === "") run.program.pop();
    run.stretches = d.every.stretches.map(s => ({rows: s.columns.length ? s.columns[0].n - s.lead : 0, from: run.start + (s.first + s.lead) * d.period, raw: s, values: null, asked: null}));
    run.boxes();
    return run;
  }

  bucketAt(t) { return clamp(Math.floor((t - this.start) / this.bucket + 1e-6), 0, this.line.length - 1); }
  lineAt(t) { return this.line.length ? this.line[this.bucketAt(t)] : 0; }
  /** Of the cycle at t where every cycle is at hand, else the value of its bucket that is farthest from 0. */
  valueAt(name, t) {
    const s = this.series.get(name), stretch = this.stretchAt(t);
    if (stretch && stretch.values && stretch.values.has(name))
      return stretch.values.get(name)[clamp(Math.floor((t - stretch.from) / this.period + 1e-6), 0, stretch.rows - 1)];
    if (!s || !s.low.length) return NaN;
    const b = this.bucketAt(t);
    return Math.abs(s.high[b]) > Math.abs(s.low[b]) ? s.high[b] : s.low[b];
  }
  recorded(name) { return this.series.has(name) && this.series.get(name).low.length > 0; }

  stretchAt(t) { return this.stretches.find(s => t >= s.from - 1e-9 && t < s.from + s.rows * this.period); }
  /** Stretches of every cycle between t0 and t1 in order, or null where some of it is not kept. */
  everyBetween(t0, t1) {
    const found = [];
    let reached = Math.max(t0, this.start);
    for (const s of this.stretches) {
      const end = s.from + s.rows * this.period;
      if (end <= reached + 1e-9) continue;
      if (s.from > reached + 0.5 * this.period) break;
      found.push(s);
      if ((reached = end) >= Math.min(t1, this.end) - 0.5 * this.period) return found;
    }
    return null;
  }
  /** Unpacks a stretch; position gives velocity, acceleration and jerk as far as enough cycles stand before it. */
  async unpack(stretch) {
    const values = new Map(), {lead, columns} = stretch.raw, channels = this.data.run.every.channels, plain = new Map();
    for (let c = 0; c < channels.length; ++c) plain.set(channels[c], await column(columns[c]));
    const keep = (name, list) => values.set(name, Float32Array.from(list.subarray(lead)));
    for (const [name, list] of plain) if (!name.endsWith(".derived")) keep(name, list);
    for (const {letter} of this.axes) {
      const derived = plain.get(letter + ".derived");
      let list = plain.get(letter + ".position");
      ["velocity", "acceleration", "jerk"].forEach((name, order) => {
        const next = new Float64Array(list.length);
        for (let i = 1; i < list.length; ++i) next[i] = derived[i] > order ? (list[i] - list[i - 1]) / this.period : 0;
        keep(letter + "." + name, list = next);
      });
    }
    stretch.values = values;
  }
  /** True: every cycle between t0 and t1 is at hand. Otherwise it is unpacked, if it is kept, and `ready` called. */
  every(t0, t1, ready) {
    const needed = this.everyBetween(t0, t1);
    if (!needed) return false;
    const missing = needed.filter(s => !s.values);
    if (!missing.length) return true;
    const unpacked = this.stretches.filter(s => s.values && !needed.includes(s));
    for (const s of unpacked.slice(0, Math.max(0, unpacked.length - 60))) s.values = s.asked = null;
    for (const s of missing) if (!s.asked) s.asked = this.unpack(s).then(ready);
    return false;
  }

  /** Share of the way from vertex i to the next that is done at time t; the speed changes evenly between vertices. */
  wayAt(i, t) {
    const p = this.path, j = Math.min(i + 1, p.n - 1), span = p.t[j] - p.t[i], u = span > 0 ? clamp((t - p.t[i]) / span, 0, 1) : 0;
    const v0 = p.speed[i], v1 = p.speed[j], sum = v0 + v1;
    return sum > 0 ? (2 * v0 * u + (v1 - v0) * u * u) / sum : u;
  }
  /** Place on the path at time t. */
  placeAt(t) {
    const p = this.path;
    if (!p.n) return null;
    const i = clamp(before(p.t, t), 0, p.n - 1), j = Math.min(i + 1, p.n - 1), s = p.rapid[j] === 2 ? +(t >= p.t[j]) : this.wayAt(i, t);
    const mix = list => list[i] + s * (list[j] - list[i]);
    return {x: mix(p.x), y: mix(p.y), z: mix(p.z), i};
  }
  /** Time at a fractional vertex index. */
  timeAt(index) {
    const i = Math.floor(index), j = Math.min(i + 1, this.path.n - 1);
    let [low, high] = [this.path.t[i], this.path.t[j]];
    for (let n = 0; n < 30; ++n) {
      const mid = (low + high) / 2;
      if (this.wayAt(i, mid) < index - i) low = mid; else high = mid;
    }
    return high;
  }
  /** Coordinate of an axis in the program in motion at t, as it writes it, from the machine's places; null: none. */
  workAt(axis, t, places) {
    const f = before(this.frames.map(c => c.t), t), map = f < 0 ? null : this.frames[f].axes[axis];
    return map && map.length ? places.reduce((sum, place, a) => sum + map[a + 1] * place, map[0]) : null;
  }
  /** What keeps the path from being faster at t: an axis near a limit, the feed where the speed is steady, else the tolerance of its corners. */
  boundAt(t) {
    const speed = this.valueAt("path.speed", t), step = Math.max(this.bucket, 0.01);
    if (!(speed > 1e-6)) return {what: "rest", letter: ""};
    const beside = [t - step, t + step].map(at => this.valueAt("path.speed", clamp(at, this.start, this.end)));
    const steady = beside.every(v => Math.abs(v - speed) <= 0.002 * speed);
    let most = steady ? 0.75 : 0.6, found = {what: steady ? "feed" : "tolerance", letter: ""};
    for (const {letter, report} of this.axes)
      for (const what of ["velocity", "acceleration", "jerk"]) {
        const limit = (report.limits || {})[what], share = limit ? Math.abs(this.valueAt(letter + "." + what, t)) / limit : 0;
        if (share > most) [most, found] = [share, {what, letter}];
      }
    return found;
  }
  /** What bound longest on the stretch that ends at vertex i. */
  boundOn(i) {
    const from = this.path.t[i - 1], to = this.path.t[i], most = 40, n = clamp(Math.ceil((to - from) / this.bucket), 1, most), times = new Map();
    for (let k = 0; k < n; ++k) {
      const {what} = this.boundAt(from + (k + 0.5) / n * (to - from));
      times.set(what, (times.get(what) || 0) + 1);
    }
    return [...times].reduce((a, b) => b[1] > a[1] ? b : a)[0];
  }
  signalAt(signal, t) { return ((before(signal.toggles, t) + 1) % 2 === 1) !== signal.initial; }
  /** What the stretch that ends at vertex i is; homing stands for all motion outside the program. */
  kindOf(i) {
    if (this.path.rapid[i] === 2) return "jump";
    if (!this.path.rapid[i]) return "feed";
    return this.path.line[i] ? "rapid" : "homing";
  }
  /** Length of the stretch that ends at vertex i > 0. */
  lengthOf(i) {
    const p = this.path;
    return Math.hypot(p.x[i] - p.x[i - 1], p.y[i] - p.y[i - 1], p.z[i] - p.z[i - 1]);
  }
  /** Box around the vertices that `chosen(i)` names; null when it names none. */
  extents(chosen) {
    const box = {low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity]};
    for (let i = 0; i < this.path.n; ++i) {
      if (!chosen(i)) continue;
      [this.path.x, this.path.y, this.path.z].forEach((list, k) => {
        box.low[k] = Math.min(box.low[k], list[i]);
        box.high[k] = Math.max(box.high[k], list[i]);
      });
    }
    return box.low[0] <= box.high[0] ? box : null;
  }
  /** box: all there is; cut: what was cut, a little wider, or all when nothing was cut, or only a point. */
  boxes() {
    this.box = this.extents(() => true) || {low: [0, 0, 0], high: [0, 0, 0]};
    const cuts = i => i > 0 && i < this.path.n && this.kindOf(i) === "feed" && this.lengthOf(i) > 4 * this.tolerance;
    const cut = this.extents(i => cuts(i) || cuts(i + 1)), size = cut ? Math.max(...cut.low.map((low, k) => cut.high[k] - low)) : 0;
    this.cut = size < 1e-3 ? this.box : {low: cut.low.map((v, k) => Math.max(v - 0.04 * size, this.box.low[k])), high: cut.high.map((v, k) => Math.min(v + 0.04 * size, this.box.high[k]))};
  }
  /** When the program began to move; the beginning of the run when it never did. */
  get begin() {
    const i = this.path.line.findIndex(line => line > 0);
    return i < 0 ? this.start : this.path.t[Math.max(0, i - 1)];
  }
  /** Seconds between t0 and t1 in which an axis moves that the path does not show: a rotary one, a fourth. */
  otherMotion(t0, t1) {
    const others = this.axes.filter(a => !this.view.includes(a.letter)).map(a => this.series.get(a.letter + ".velocity")).filter(Boolean);
    let seconds = 0;
    for (let b = this.bucketAt(t0); others.length && b <= this.bucketAt(t1); ++b)
      if (others.some(s => s.high[b] > 1e-6 || s.low[b] < -1e-6)) seconds += this.bucket;
    return Math.min(seconds, t1 - t0);
  }
  /** Where an axis was that the path does not show; null: not known. */
  placesOf(letter) {
    const s = this.series.get(letter + ".position");
    return s && s.low.length ? [s.low.reduce((m, v) => Math.min(m, v), Infinity), s.high.reduce((m, v) => Math.max(m, v), -Infinity)] : null;
  }
  /** Length and time of feed, rapid and homing, and time standing still. */
  amounts() {
    const out = {feed: 0, rapid: 0, homing: 0, feedTime: 0, rapidTime: 0, homingTime: 0};
    for (let i = 1; i < this.path.n; ++i) {
      const d = this.lengthOf(i), dt = this.path.t[i] - this.path.t[i - 1], kind = this.kindOf(i);
      if (kind === "jump") continue;
      if (d < 4 * this.tolerance && dt > 20 * this.period) {
        out[kind + "Time"] += this.otherMotion(this.path.t[i - 1], this.path.t[i]);
        continue;
      }
      out[kind] += d;
      out[kind + "Time"] += dt;
    }
    out.still = Math.max(0, this.duration - out.feedTime - out.rapidTime - out.homingTime);
    return out;
  }
  axis(letter) { return this.axes.find(a => a.letter === letter); }
  /** 2 where people read a diameter, else 1. */
  shownTimes(letter) { const a = this.axis(letter); return a && a.report.diameter ? 2 : 1; }
  /** The letter as people write it beside a place. */
  shownName(letter) { return this.shownTimes(letter) === 2 ? letter + "⌀" : letter; }
  /** A turned part: a diameter in the plane of the path. */
  get turned() { return this.view[1] !== "" && this.shownTimes(this.view[1]) === 2; }
}
