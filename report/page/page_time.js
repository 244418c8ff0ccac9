// SPDX-License-Identifier: Apache-2.0
// The page's one state, who wants to know when it changes, and what of a run is drawn in a window of time.
const D = JSON.parse($("data").textContent);
const S = {lang: D.language, theme: null, t0: 0, t1: 1, cursor: 0, playing: 0, hidden: new Set(), rapids: true, whole: false, constant: false,
  follow: true, line: 0, colour: "speed", tools: new Set(), operation: -1};
let RUN = null;    // of this page
let OTHER = null;  // laid over it
/** The report in the language of the page. */
function report() { return D.report[S.lang]; }

const listeners = {};
function on(type, f) { (listeners[type] = listeners[type] || []).push(f); }
function emit(type) { for (const f of listeners[type] || []) f(); }
function setCursor(t) {
  S.cursor = clamp(t, RUN.start, RUN.end);
  emit("cursor");
}
function setWindow(t0, t1) {
  const least = Math.min(20 * RUN.period, RUN.end - RUN.start), width = clamp(t1 - t0, least, RUN.end - RUN.start);
  const from = clamp((t0 + t1 - width) / 2, RUN.start, RUN.end - width);
  S.t0 = from;
  S.t1 = from + width;
  emit("window");
}

const EVERY_CYCLE = 20000;  // so many of them are drawn one by one
const COLUMNS = 1500;       // else so many bands at most
/** Places in time at which the charts have a value: each cycle, or the middle of each band. */
function timeGrid(ready) {
  const rows = (S.t1 - S.t0) / RUN.period, every = rows <= EVERY_CYCLE && RUN.every(S.t0 - 3 * RUN.period, S.t1 + 3 * RUN.period, ready);
  const step = every ? RUN.period : RUN.bucket * Math.max(1, Math.ceil((S.t1 - S.t0) / (RUN.bucket * COLUMNS)));
  const from = Math.max(0, Math.floor((S.t0 - RUN.start) / step + 1e-6) - 1), to = Math.min(Math.ceil((S.t1 - RUN.start) / step) + 1, Math.ceil((RUN.end - RUN.start) / step - 1e-6));
  const half = step > 1.5 * RUN.period ? step / 2 : 0;
  const at = Float64Array.from({length: Math.max(0, to - from)}, (_, k) => RUN.start + (from + k) * step + half);
  // Cycles that are kept one by one although there are too many to be drawn so are kept for a closer look.
  const kept = rows > EVERY_CYCLE || every || RUN.everyBetween(S.t0, S.t1) !== null;
  return {every: step < 1.5 * RUN.period, kept, step, first: RUN.start + from * step, at};
}
/** What the charts show now, in words. */
function resolutionWords(grid) {
  const step = num(grid.step * 1000, 4) + " " + unit("ms");
  return grid.every ? tr("everyCycle", step) : tr("band", step) + (grid.kept ? "" : " " + tr("notKept"));
}
/** Least and greatest value of a series of a run in each step of the grid; null where the run has none. */
function bands(run, name, grid) {
  const n = grid.at.length, t0 = grid.first - run.shift, t1 = t0 + n * grid.step, low = new Array(n).fill(null), high = new Array(n).fill(null);
  const put = (k, a, b) => {
    if (low[k] === null || a < low[k]) low[k] = a;
    if (high[k] === null || b > high[k]) high[k] = b;
  };
  /** rows from `from` on, `step` apart, into the steps in which they lie; long ones into all that they cover. */
  const spread = (from, step, rows, lows, highs) => {
    if (step > grid.step * 1.001) {
      for (let k = 0; k < n; ++k) {
        const j = Math.floor((t0 + (k + 0.5) * grid.step - from) / step);
        if (j >= 0 && j < rows) put(k, lows[j], highs[j]);
      }
      return;
    }
    const last = Math.min(rows, Math.ceil((t1 - from) / step) + 1);
    for (let j = Math.max(0, Math.floor((t0 - from) / step) - 1); j < last; ++j) {
      const k = Math.floor((from + (j + 0.5) * step - t0) / grid.step);
      if (k >= 0 && k < n) put(k, lows[j], highs[j]);
    }
  };
  const stretches = grid.every ? run.everyBetween(S.t0 - 3 * RUN.period - run.shift, S.t1 + 3 * RUN.period - run.shift) : null;
  if (stretches && stretches.every(s => s.values)) {
    for (const s of stretches) spread(s.from, run.period, s.rows, s.values.get(name), s.values.get(name));
  } else {
    const s = run.series.get(name);
    spread(run.start, run.bucket, s.low.length, s.low, s.high);
  }
  return {low, high};
}

function isDark() { return S.theme ? S.theme === "dark" : window.matchMedia("(prefers-color-scheme: dark)").matches; }
function axisColour(letter) {
  const own = {X: 0, Y: 1, Z: 2}, index = own[letter] !== undefined ? own[letter] : 3 + RUN.axes.findIndex(a => a.letter === letter) % 5;
  return css("--axis-" + index);
}
