// SPDX-License-Identifier: Apache-2.0
// Charts over time: one window, one cursor for all of them and for the signals.
/** Names stand beside the plots, or above them on a narrow screen. */
function compact() { return window.innerWidth < 700; }
function gutter() { return compact() ? 50 : 168; }
const RIGHT = 12;
function plotWidth(box) { return Math.max(10, box.clientWidth - gutter() - RIGHT); }
function xOf(box, t) { return gutter() + (t - S.t0) / (S.t1 - S.t0) * plotWidth(box); }
function tOf(box, x) { return S.t0 + (x - gutter()) / plotWidth(box) * (S.t1 - S.t0); }

/** Pointer and wheel of everything that lies over the time axis. */
function timeInput(box) {
  let drag = null;
  const at = e => e.clientX - box.getBoundingClientRect().left;
  const mark = box.appendChild(el("div", {class: "selection"}));
  box.addEventListener("pointerdown", e => {
    if (at(e) < gutter()) return;
    drag = {from: at(e), last: at(e), move: e.shiftKey || e.pointerType === "touch"};
    box.setPointerCapture(e.pointerId);
    box.focus({preventScroll: true});
  });
  box.addEventListener("pointermove", e => {
    const x = at(e);
    if (drag && drag.move) {
      const dt = (drag.last - x) / plotWidth(box) * (S.t1 - S.t0);
      drag.last = x;
      setWindow(S.t0 + dt, S.t1 + dt);
    } else if (drag) {
      const [a, b] = [Math.min(drag.from, x), Math.max(drag.from, x)];
      mark.style.cssText = `display:block;left:${Math.max(a, gutter())}px;width:${b - Math.max(a, gutter())}px`;
    }
    if (x >= gutter()) setCursor(tOf(box, x));
  });
  const finish = e => {
    mark.style.display = "none";
    if (drag && !drag.move && Math.abs(at(e) - drag.from) > 6) {
      const [a, b] = [drag.from, at(e)].map(x => tOf(box, clamp(x, gutter(), box.clientWidth - RIGHT)));
      setWindow(Math.min(a, b), Math.max(a, b));
    }
    drag = null;
  };
  box.addEventListener("pointerup", finish);
  box.addEventListener("pointercancel", () => { drag = null; mark.style.display = "none"; });
  box.addEventListener("dblclick", () => setWindow(RUN.start, T_END));
  box.addEventListener("wheel", e => {
    if (!e.ctrlKey && !e.metaKey && document.activeElement !== box) return;
    e.preventDefault();
    const t = tOf(box, at(e)), f = Math.exp(e.deltaY * 0.0015);
    setWindow(t - (t - S.t0) * f, t + (S.t1 - t) * f);
  }, {passive: false});
}

/** Vertical lines of the time grid; labels below when `labels`. Returns nothing. */
function timeGrid(g, box, top, bottom, labels) {
  const grid = ticks(S.t0, S.t1, plotWidth(box) / 90);
  g.strokeStyle = css("--grid");
  g.fillStyle = css("--faint");
  g.lineWidth = 1;
  g.textBaseline = "top";
  for (const t of grid.at) {
    const x = Math.round(xOf(box, t)) + 0.5;
    g.beginPath(); g.moveTo(x, top); g.lineTo(x, bottom); g.stroke();
    if (!labels) continue;
    g.textAlign = x > box.clientWidth - 30 ? "right" : "center";
    g.fillText(fixed(t, grid.decimals) + " " + unit("s"), Math.min(x, box.clientWidth - 2), bottom + 5);
  }
}
function alarmMarks(g, box, top, bottom) {
  g.strokeStyle = css("--bad");
  g.lineWidth = 1.5;
  for (const a of R.alarms) {
    if (a.t < S.t0 || a.t > S.t1) continue;
    const x = xOf(box, a.t);
    g.beginPath(); g.moveTo(x, top); g.lineTo(x, bottom); g.stroke();
  }
}
function cursorMark(g, box, top, bottom) {
  if (S.cursor < S.t0 || S.cursor > S.t1) return;
  const x = xOf(box, S.cursor);
  g.strokeStyle = css("--mark");
  g.lineWidth = 1;
  g.beginPath(); g.moveTo(x, top); g.lineTo(x, bottom); g.stroke();
}
function clipText(g, text, width) {
  if (g.measureText(text).width <= width) return text;
  let n = text.length;
  while (n > 1 && g.measureText(text.slice(0, n) + "…").width > width) --n;
  return text.slice(0, n) + "…";
}

/** Least and greatest value of a series in each pixel column, or the plain points where there are fewer. */
function drawSeries(g, box, series, colour, yOf) {
  const n = series.low.length, b0 = clamp(bucketAt(S.t0) - 1, 0, n - 1), b1 = clamp(bucketAt(S.t1) + 1, 0, n - 1);
  const step = RUN.bucket, xAt = b => xOf(box, RUN.start + b * step);
  g.strokeStyle = g.fillStyle = colour;
  g.lineWidth = 1.4;
  g.lineJoin = "round";
  g.beginPath();
  if (b1 - b0 <= plotWidth(box) * 1.5) {
    for (let b = b0; b <= b1; ++b) {
      const x = xAt(b);
      if (b === b0) g.moveTo(x, yOf(series.low[b])); else g.lineTo(x, yOf(series.low[b]));
      if (series.high[b] !== series.low[b]) g.lineTo(x, yOf(series.high[b]));
    }
  } else {
    let column = -1, low = 0, high = 0, last = 0, first = true;
    const flush = () => {
      // From the last value to the nearer end of this column's span, then to the other: one line, nothing lost.
      const nearHigh = Math.abs(last - high) < Math.abs(last - low), [a, b] = nearHigh ? [high, low] : [low, high];
      if (first) g.moveTo(column, yOf(a)); else g.lineTo(column, yOf(a));
      if (a !== b) g.lineTo(column, yOf(b));
      [first, last] = [false, b];
    };
    for (let b = b0; b <= b1; ++b) {
      const x = Math.round(xAt(b) * 2) / 2;
      if (x !== column) {
        if (column >= 0) flush();
        [column, low, high] = [x, series.low[b], series.high[b]];
      } else {
        low = Math.min(low, series.low[b]);
        high = Math.max(high, series.high[b]);
      }
    }
    if (column >= 0) flush();
  }
  g.stroke();
}
function visibleRange(curves) {
  let low = Infinity, high = -Infinity;
  for (const c of curves) {
    const b0 = bucketAt(S.t0), b1 = bucketAt(S.t1);
    for (let b = b0; b <= b1; ++b) {
      if (c.series.low[b] < low) low = c.series.low[b];
      if (c.series.high[b] > high) high = c.series.high[b];
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

/** One chart. spec: {title, unit, factor, curves: [{series, label, letter, colour(), limit}], labels}. */
function chart(box, spec) {
  const L = layers(box);
  let TOP = 8, yOf = () => 0, asked = false;
  const bottom = () => box.clientHeight - (spec.labels ? 24 : 6);
  const shown = () => spec.curves.filter(c => !c.letter || !S.hidden.has(c.letter));
  function scaleY() {
    let [low, high] = visibleRange(shown());
    const most = Math.max(Math.abs(low), Math.abs(high));
    for (const c of shown())
      if (c.limit && c.limit <= 1.6 * most) [low, high] = [low < -0.2 * most ? Math.min(low, -c.limit) : low, Math.max(high, c.limit)];
    if (low > 0) low = 0;
    if (high < 0) high = 0;
    if (high - low < 1e-9) [low, high] = [low - 1, high + 1];
    const pad = 0.06 * (high - low);
    [low, high] = [low < 0 ? low - pad : 0, high > 0 ? high + pad : 0];
    yOf = v => TOP + (high - v) / (high - low) * (bottom() - TOP);
    return [low, high];
  }
  function limitLines(g, low, high) {
    g.setLineDash([2, 4]);
    g.lineWidth = 1;
    for (const c of shown())
      for (const v of c.limit ? [c.limit, -c.limit] : []) {
        if (v < low || v > high) continue;
        g.strokeStyle = c.colour();
        g.beginPath(); g.moveTo(gutter(), yOf(v)); g.lineTo(box.clientWidth - RIGHT, yOf(v)); g.stroke();
      }
    g.setLineDash([]);
  }
  function draw() {
    asked = false;
    TOP = compact() ? 24 : 8;
    L.resize();
    const g = L.context("base"), [low, high] = scaleY(), f = spec.factor || 1;
    timeGrid(g, box, TOP, bottom(), spec.labels);
    const grid = ticks(low * f, high * f, (bottom() - TOP) / 24);
    for (const v of grid.at) {
      const y = Math.round(yOf(v / f)) + 0.5;
      g.strokeStyle = css(Math.abs(v) < 1e-12 ? "--axis-line" : "--grid");
      g.beginPath(); g.moveTo(gutter(), y); g.lineTo(box.clientWidth - RIGHT, y); g.stroke();
      g.fillStyle = css("--faint");
      g.textAlign = "right"; g.textBaseline = "middle";
      g.fillText(fixed(v, grid.decimals), gutter() - 6, clamp(y, TOP + 4, bottom() - 2));
    }
    g.save();
    g.beginPath(); g.rect(gutter(), 0, plotWidth(box), box.clientHeight); g.clip();
    for (const c of shown()) drawSeries(g, box, c.series, c.colour(), yOf);
    limitLines(g, low, high);
    alarmMarks(g, box, TOP, bottom());
    g.restore();
    follow();
  }
  function follow() {
    const g = L.context("over"), f = spec.factor || 1, room = gutter() - 54;
    cursorMark(g, box, TOP, bottom());
    g.textAlign = "left"; g.textBaseline = "top";
    if (compact()) return nameAbove(g, f);
    g.font = "600 " + css("--canvas-font");
    g.fillStyle = css("--text");
    g.fillText(clipText(g, tr(spec.title), room + 12), 2, TOP);
    g.font = css("--canvas-font");
    g.fillStyle = css("--faint");
    g.fillText(unit(spec.unit), 2, TOP + 15);
    shown().forEach((c, k) => {
      const y = TOP + 34 + 15 * k;
      if (y > bottom() - 8) return;
      g.fillStyle = c.colour();
      const v = valueAt(c.series.name, S.cursor) * f;
      g.fillText(clipText(g, (c.label ? c.label + " " : "") + num(v, 4), room), 2, y);
    });
  }
  function nameAbove(g, f) {
    let x = 2;
    const put = (text, colour, weight) => {
      g.font = weight + css("--canvas-font");
      g.fillStyle = colour;
      g.fillText(text, x, 6);
      x += g.measureText(text).width + 8;
    };
    put(tr(spec.title), css("--text"), "600 ");
    put(unit(spec.unit), css("--faint"), "");
    for (const c of shown()) put((c.label ? c.label + " " : "") + num(valueAt(c.series.name, S.cursor) * f, 3), c.colour(), "");
  }
  function redraw() {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  }
  timeInput(box);
  for (const type of ["window", "theme", "size", "series", "lang"]) on(type, redraw);
  on("cursor", follow);
  redraw();
  return {draw};
}

/** Nothing is recorded of a run without a cycle. */
function recorded(name) { return SERIES.has(name) && SERIES.get(name).low.length > 0; }
function chartSpecs() {
  const out = [], kinds = [["velocity", "velocity", "mm/s", 1], ["acceleration", "acceleration", "mm/s²", 1],
    ["jerk", "jerk", "mm/s³", 1], ["error", "following_error", "µm", 1000]];
  const single = (name, title, u) => recorded(name) &&
    out.push({title, unit: u, curves: [{series: SERIES.get(name), label: "", colour: () => css("--accent")}]});
  single("path.speed", "pathSpeed", "mm/s");
  for (const [kind, limit, u, factor] of kinds)
    for (const turns of [false, true])
      out.push({title: kind, unit: turns ? u.replace("mm", "deg").replace("µm", "arcsec") : u, factor: turns && u === "µm" ? 3600 : factor,
        curves: AXES.filter(a => (a.report.unit === "deg") === turns && recorded(a.letter + "." + kind)).map(a => ({series: SERIES.get(a.letter + "." + kind),
          label: a.letter, letter: a.letter, colour: () => axisColour(a.letter), limit: (a.report.limits || {})[limit]}))});
  for (const name of ["spindle", "spindle2"])
    if (recorded(name + ".cmd"))
      out.push({title: "spindle", unit: "rpm", curves: [
        {series: SERIES.get(name + ".cmd"), label: "→", colour: () => css("--axis-3")},
        {series: SERIES.get(name + ".act"), label: "", colour: () => css("--axis-4")}]});
  const drawn = out.filter(s => s.curves.length);
  if (drawn.length) drawn[drawn.length - 1].labels = true;
  return drawn;
}
