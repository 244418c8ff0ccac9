// SPDX-License-Identifier: Apache-2.0
// The run as typed arrays, the page's one state, and who wants to know when it changes.
const D = JSON.parse(document.getElementById("data").textContent);
const R = D.report, RUN = D.run;

function bytesOf(text) {
  const raw = atob(text), out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) out[i] = raw.charCodeAt(i);
  return new DataView(out.buffer);
}
function floats(text) {
  const view = bytesOf(text), out = new Float32Array(view.byteLength / 4);
  for (let i = 0; i < out.length; ++i) out[i] = view.getFloat32(4 * i, true);
  return out;
}
function integers(text) {
  const view = bytesOf(text), out = new Int32Array(view.byteLength / 4);
  for (let i = 0; i < out.length; ++i) out[i] = view.getInt32(4 * i, true);
  return out;
}

const SERIES = new Map();
for (const s of RUN.series) {
  const low = floats(s.low);
  SERIES.set(s.name, {name: s.name, unit: s.unit, low, high: s.high === undefined ? low : floats(s.high)});
}
const LINE = integers(RUN.line);
const PATH = {};
for (const key of ["x", "y", "z", "t", "speed"]) PATH[key] = floats(RUN.path[key]);
PATH.line = integers(RUN.path.line);
PATH.rapid = new Uint8Array(bytesOf(RUN.path.rapid).buffer);
PATH.n = PATH.x.length;
const SIGNALS = RUN.signals.map(s => ({name: s.name, initial: s.initial, toggles: floats(s.toggles), truncated: s.truncated}));
const LINES = new Map(RUN.lines.map(([line, first, total]) => [line, {first, total}]));
const VIEW = RUN.view;  // letters behind x, y, z; "" where there is none
const T_END = Math.max(RUN.start + RUN.duration, RUN.start + RUN.period);
const AXES = RUN.axes.map(letter => ({letter, report: R.axes[letter] || {unit: "mm", limits: {}}}));

const S = {lang: D.language, theme: null, t0: RUN.start, t1: T_END, cursor: RUN.start, playing: 0, hidden: new Set(),
  rapids: true, whole: false, constant: false, follow: true, line: 0};
const listeners = {};
function on(type, f) { (listeners[type] = listeners[type] || []).push(f); }
function emit(type) { for (const f of listeners[type] || []) f(); }

function clamp(v, low, high) { return Math.min(Math.max(v, low), high); }
function setCursor(t) {
  S.cursor = clamp(t, RUN.start, T_END);
  emit("cursor");
}
function setWindow(t0, t1) {
  const least = Math.min(20 * RUN.period, T_END - RUN.start), width = clamp(t1 - t0, least, T_END - RUN.start);
  const from = clamp((t0 + t1 - width) / 2, RUN.start, T_END - width);
  S.t0 = from;
  S.t1 = from + width;
  emit("window");
}
/** Index of the last element that is not above t; -1 when all are. */
function before(list, t) {
  let low = -1, high = list.length;
  while (high - low > 1) {
    const mid = (low + high) >> 1;
    if (list[mid] <= t) low = mid; else high = mid;
  }
  return low;
}
function bucketAt(t) { return clamp(Math.floor((t - RUN.start) / RUN.bucket + 1e-6), 0, LINE.length - 1); }
function lineAt(t) { return LINE.length ? LINE[bucketAt(t)] : 0; }
function valueAt(name, t) {
  const s = SERIES.get(name);
  if (!s || !s.low.length) return NaN;
  const b = bucketAt(t);
  return Math.abs(s.high[b]) > Math.abs(s.low[b]) ? s.high[b] : s.low[b];
}
/** Share of the way from vertex i to the next that is done at time t; the speed changes evenly between vertices. */
function wayAt(i, t) {
  const j = Math.min(i + 1, PATH.n - 1), span = PATH.t[j] - PATH.t[i], u = span > 0 ? clamp((t - PATH.t[i]) / span, 0, 1) : 0;
  const v0 = PATH.speed[i], v1 = PATH.speed[j], sum = v0 + v1;
  return sum > 0 ? (2 * v0 * u + (v1 - v0) * u * u) / sum : u;
}
/** Place on the path at time t. */
function placeAt(t) {
  if (!PATH.n) return null;
  const i = clamp(before(PATH.t, t), 0, PATH.n - 1), j = Math.min(i + 1, PATH.n - 1);
  const s = PATH.rapid[j] === 2 ? +(t >= PATH.t[j]) : wayAt(i, t);
  const mix = list => list[i] + s * (list[j] - list[i]);
  return {x: mix(PATH.x), y: mix(PATH.y), z: mix(PATH.z), i};
}
function signalAt(signal, t) {
  return ((before(signal.toggles, t) + 1) % 2 === 1) !== signal.initial;
}
/** What the stretch that ends at vertex i is; homing stands for all motion outside the program. */
function kindOf(i) {
  if (PATH.rapid[i] === 2) return "jump";
  if (!PATH.rapid[i]) return "feed";
  return PATH.line[i] ? "rapid" : "homing";
}
/** Length of the stretch that ends at vertex i > 0. */
function lengthOf(i) { return Math.hypot(PATH.x[i] - PATH.x[i - 1], PATH.y[i] - PATH.y[i - 1], PATH.z[i] - PATH.z[i - 1]); }
/** Box around the vertices that `chosen(i)` names; null when it names none. */
function extents(chosen) {
  const box = {low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity]};
  for (let i = 0; i < PATH.n; ++i) {
    if (!chosen(i)) continue;
    [PATH.x, PATH.y, PATH.z].forEach((list, k) => {
      box.low[k] = Math.min(box.low[k], list[i]);
      box.high[k] = Math.max(box.high[k], list[i]);
    });
  }
  return box.low[0] <= box.high[0] ? box : null;
}
const BOX = extents(() => true) || {low: [0, 0, 0], high: [0, 0, 0]};
/** Box of what was cut, a little wider; everything when nothing was cut, or only a point. */
const CUT = (() => {
  const cut = i => i > 0 && i < PATH.n && kindOf(i) === "feed" && lengthOf(i) > 4 * RUN.tolerance;
  const box = extents(i => cut(i) || cut(i + 1));
  const size = box ? Math.max(...box.low.map((low, k) => box.high[k] - low)) : 0;
  if (size < 1e-3) return BOX;
  return {low: box.low.map((v, k) => Math.max(v - 0.04 * size, BOX.low[k])), high: box.high.map((v, k) => Math.min(v + 0.04 * size, BOX.high[k]))};
})();
/** What the path views show when they fit: the cut, or all there is. */
function shownBox() { return S.whole ? BOX : CUT; }
/** Length and time of feed, rapid and homing, and time standing still. */
/** Seconds between t0 and t1 in which an axis moves that the path does not show: a rotary one, a fourth. */
function otherMotion(t0, t1) {
  const others = AXES.filter(a => !VIEW.includes(a.letter)).map(a => SERIES.get(a.letter + ".velocity")).filter(Boolean);
  let seconds = 0;
  for (let b = bucketAt(t0); others.length && b <= bucketAt(t1); ++b)
    if (others.some(s => s.high[b] > 1e-6 || s.low[b] < -1e-6)) seconds += RUN.bucket;
  return Math.min(seconds, t1 - t0);
}
/** Where an axis was that the path does not show; null: not known. */
function placesOf(letter) {
  const s = SERIES.get(letter + ".position");
  return s && s.low.length ? [s.low.reduce((m, v) => Math.min(m, v), Infinity), s.high.reduce((m, v) => Math.max(m, v), -Infinity)] : null;
}
function amounts() {
  const out = {feed: 0, rapid: 0, homing: 0, feedTime: 0, rapidTime: 0, homingTime: 0};
  for (let i = 1; i < PATH.n; ++i) {
    const d = lengthOf(i), dt = PATH.t[i] - PATH.t[i - 1];
    const kind = kindOf(i);
    if (kind === "jump") continue;
    if (d < 4 * RUN.tolerance && dt > 20 * RUN.period) {
      out[kind + "Time"] += otherMotion(PATH.t[i - 1], PATH.t[i]);
      continue;
    }
    out[kind] += d;
    out[kind + "Time"] += dt;
  }
  out.still = Math.max(0, RUN.duration - out.feedTime - out.rapidTime - out.homingTime);
  return out;
}

function css(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }
function axisColour(letter) {
  const own = {X: 0, Y: 1, Z: 2}, index = own[letter] !== undefined ? own[letter] : 3 + RUN.axes.indexOf(letter) % 5;
  return css("--axis-" + index);
}
function el(tag, properties, ...children) {
  const out = document.createElement(tag);
  for (const [key, value] of Object.entries(properties || {})) {
    if (key === "class") out.className = value;
    else if (key.startsWith("on")) out.addEventListener(key.slice(2), value);
    else if (value !== undefined && value !== false) out.setAttribute(key, value);
  }
  out.append(...children.filter(c => c !== null && c !== undefined));
  return out;
}
/** Two canvases one over the other, sized to their box: what stays, and what follows the cursor. */
function layers(box) {
  const make = () => box.appendChild(el("canvas"));
  const base = make(), over = make();
  return {
    box, base, over,
    resize() {
      const scale = window.devicePixelRatio || 1;
      for (const c of [base, over]) {
        c.width = Math.round(box.clientWidth * scale);
        c.height = Math.round(box.clientHeight * scale);
      }
      return scale;
    },
    context(which) {
      const g = this[which].getContext("2d"), scale = window.devicePixelRatio || 1;
      g.setTransform(scale, 0, 0, scale, 0, 0);
      g.clearRect(0, 0, box.clientWidth, box.clientHeight);
      g.font = css("--canvas-font");
      return g;
    },
  };
}
/** Steps of 1, 2, 5 × 10^n, about `count` of them between low and high. */
function ticks(low, high, count) {
  const rough = (high - low) / Math.max(count, 1), power = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= rough * 0.999) || power;
  const out = [], decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; ++k) out.push(k * step);
  return {step, decimals, at: out};
}
