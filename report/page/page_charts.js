// SPDX-License-Identifier: Apache-2.0
// Charts over time, drawn by uPlot: one window and one cursor for all of them and for the signals.
const {uPlot} = LIBRARIES;
const AXIS_WIDTH = 62, FONT = "11px system-ui,sans-serif";

/** A row of the page: names at the left, a plot at the right. Returns {box, names, plot}. */
function timeRow(parent, kind) {
  const names = el("div", {class: "names"}), plot = el("div", {class: "plot", tabindex: "0"});
  const box = parent.appendChild(el("div", {class: "chart " + kind}, names, plot));
  return {box, names, plot};
}
/** Pointer and wheel over the time axis: what uPlot does not do by itself. */
function timeInput(u, plot) {
  let last = null;
  const fingers = new Map();  // place of each finger on the plot
  const spread = () => { const [a, b] = [...fingers.values()]; return {at: (a + b) / 2 - u.over.getBoundingClientRect().left, width: Math.max(Math.abs(a - b), 8)}; };
  u.over.addEventListener("pointerdown", e => {
    plot.focus({preventScroll: true});
    if (e.pointerType === "touch") fingers.set(e.pointerId, e.clientX);
    if (e.shiftKey || e.pointerType === "touch") last = e.clientX;
  });
  u.over.addEventListener("pointermove", e => {
    if (last === null) return;
    if (fingers.has(e.pointerId) && fingers.size === 2) {
      const old = spread();
      fingers.set(e.pointerId, e.clientX);
      const now = spread(), t = u.posToVal(old.at, "x"), f = old.width / now.width, move = (old.at - now.at) / u.over.clientWidth * (S.t1 - S.t0);
      setWindow(t - (t - S.t0) * f + move, t + (S.t1 - t) * f + move);
      return;
    }
    if (fingers.has(e.pointerId)) fingers.set(e.pointerId, e.clientX);
    const dt = (last - e.clientX) / u.over.clientWidth * (S.t1 - S.t0);
    last = e.clientX;
    setWindow(S.t0 + dt, S.t1 + dt);
  });
  for (const type of ["pointerup", "pointercancel", "pointerleave"]) u.over.addEventListener(type, e => {
    fingers.delete(e.pointerId);
    last = fingers.size ? [...fingers.values()][0] : null;
  });
  u.over.addEventListener("dblclick", () => setWindow(RUN.start, RUN.end));
  u.over.addEventListener("wheel", e => {
    if (!e.ctrlKey && !e.metaKey && document.activeElement !== plot) return;
    e.preventDefault();
    const t = u.posToVal(e.clientX - u.over.getBoundingClientRect().left, "x"), f = Math.exp(e.deltaY * 0.0015);
    setWindow(t - (t - S.t0) * f, t + (S.t1 - t) * f);
  }, {passive: false});
}
function alarmMarks(u) {
  const {ctx, bbox} = u;
  ctx.save();
  ctx.strokeStyle = css("--bad");
  ctx.lineWidth = 1.5 * devicePixelRatio;
  for (const a of report().alarms) {
    if (a.t < S.t0 || a.t > S.t1) continue;
    const x = u.valToPos(a.t, "x", true);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
  }
  ctx.restore();
}
function limitLines(u, curves, factor) {
  const {ctx, bbox} = u, {min, max} = u.scales.y;
  ctx.save();
  ctx.setLineDash([2, 4].map(v => v * devicePixelRatio));
  ctx.lineWidth = devicePixelRatio;
  for (const c of curves)
    for (const v of c.limit ? [c.limit * factor, -c.limit * factor] : []) {
      if (v < min || v > max) continue;
      ctx.strokeStyle = c.colour();
      const y = u.valToPos(v, "y", true);
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
  ctx.restore();
}

/** What charts and signals have in common; `own` adds to it. */
function timeOptions(plot, height, labels, own) {
  const stroke = () => css("--faint"), grid = {stroke: () => css("--grid"), width: 1}, none = {show: false};
  return {
    width: Math.max(plot.clientWidth, 80), height, legend: none, padding: [8, 12, labels ? 0 : 6, 0],
    cursor: {
      y: false, points: none, drag: {x: true, y: false, setScale: false, dist: 6},
      bind: {mousedown: (u, target, next) => e => { if (e.button === 0 && !e.shiftKey) next(e); }, dblclick: () => null},
    },
    scales: {x: {time: false, auto: false}, y: {auto: false}},
    axes: [
      {show: labels, stroke, grid, ticks: none, font: FONT, size: 26, gap: 4, values: (u, at) => at.map(t => num(t, 9) + " " + unit("s"))},
      {stroke, grid, ticks: none, font: FONT, size: AXIS_WIDTH, values: (u, at) => at.map(v => num(v, 6)), ...own.axis},
    ],
    series: [{}, ...own.series], bands: own.bands || [],
    hooks: {
      setSelect: [u => {
        const {left, width} = u.select;
        if (width <= 0) return;
        u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
        if (width > 6) setWindow(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
      }],
      setCursor: [u => { if (u.cursor.event && u.cursor.left >= 0) setCursor(u.posToVal(u.cursor.left, "x")); }],
      // uPlot draws once before it has data.
      draw: own.draw.map(f => u => { if (u.scales.x.max > u.scales.x.min && u.scales.y.max > u.scales.y.min) f(u); }),
    },
  };
}
function followCursor(u) {
  const inside = S.cursor >= S.t0 && S.cursor <= S.t1;
  u.setCursor({left: inside ? u.valToPos(S.cursor, "x") : -10, top: inside ? 1 : -10}, false, false);
}

/** Bounds of the y axis: all that is drawn and 0, and a limit that is not far off. */
function boundsOf(columns, curves, factor) {
  let low = Infinity, high = -Infinity;
  for (const c of columns)
    for (const v of c) {
      if (v === null) continue;
      if (v < low) low = v;
      if (v > high) high = v;
    }
  if (low > high) [low, high] = [0, 1];
  const most = Math.max(Math.abs(low), Math.abs(high));
  for (const c of curves) {
    const limit = c.limit * factor;
    if (limit && limit <= 1.6 * most) [low, high] = [low < -0.2 * most ? Math.min(low, -limit) : low, Math.max(high, limit)];
  }
  [low, high] = [Math.min(low, 0), Math.max(high, 0)];
  if (high - low < 1e-9) [low, high] = [low - 1, high + 1];
  const pad = 0.06 * (high - low);
  return [low < 0 ? low - pad : 0, high > 0 ? high + pad : 0];
}

/** One chart. spec: {title, unit, factor, curves: [{name, label, letter, colour(), limit}], labels}. */
function chart(parent, spec) {
  const row = timeRow(parent, spec.labels ? "last" : ""), factor = spec.factor || 1, height = spec.labels ? 152 : 126;
  const faded = c => () => c.colour() + "55", series = [], fills = [];
  // Each curve is two lines and the band between them; the other run's stand behind them, dashed.
  for (const other of [true, false])
    for (const c of spec.curves) {
      const stroke = other ? () => css("--other") : c.colour, dash = other ? [5, 3] : undefined;
      fills.push({series: [series.length + 2, series.length + 1], fill: other ? () => css("--other") + "33" : faded(c)});
      for (let edge = 0; edge < 2; ++edge) series.push({stroke, dash, width: other ? 1 : 1.2, points: {show: false}, spanGaps: false});
    }
  const shown = () => spec.curves.filter(c => !c.letter || !S.hidden.has(c.letter));
  const u = new uPlot(timeOptions(row.plot, height, spec.labels, {series, bands: fills, axis: {splits: undefined},
    draw: [v => limitLines(v, shown(), factor), alarmMarks]}), [[], ...series.map(() => [])], row.plot);
  timeInput(u, row.plot);
  const update = inNextFrame(() => draw());
  function draw() {
    const grid = timeGrid(() => emit("unpacked")), nothing = grid.at.map(() => null), columns = [];
    for (const run of [OTHER, RUN])
      for (const c of spec.curves) {
        const hidden = !run || !run.recorded(c.name) || (c.letter && S.hidden.has(c.letter));
        if (hidden) { columns.push(Array.from(nothing, () => null), Array.from(nothing, () => null)); continue; }
        if (run === OTHER && grid.every) run.every(S.t0 - run.shift, S.t1 - run.shift, () => emit("unpacked"));
        const {low, high} = bands(run, c.name, grid);
        for (const edge of [low, high]) columns.push(factor === 1 ? edge : edge.map(v => v === null ? null : v * factor));
      }
    const [min, max] = boundsOf(columns, shown(), factor);
    u.batch(() => {
      u.setSize({width: Math.max(row.plot.clientWidth, 80), height});
      u.setData([Array.from(grid.at), ...columns], false);
      u.setScale("x", {min: S.t0, max: S.t1});
      u.setScale("y", {min, max});
    });
    follow();
  }
  function follow() {
    followCursor(u);
    const values = shown().map(c => el("span", {style: `color:${c.colour()}`}, (c.label ? c.label + " " : "") + num(RUN.valueAt(c.name, S.cursor) * factor, 4)));
    row.names.replaceChildren(el("b", {}, tr(spec.title)), el("span", {class: "note"}, unit(spec.unit)), ...values);
  }
  for (const type of ["window", "theme", "size", "series", "lang", "unpacked", "other"]) on(type, update);
  on("cursor", follow);
  update();
  return {draw};
}

/** Nothing is recorded of a run without a cycle. */
function chartSpecs() {
  const out = [], kinds = [["velocity", "velocity", "mm/s", 1], ["acceleration", "acceleration", "mm/s²", 1],
    ["jerk", "jerk", "mm/s³", 1], ["error", "following_error", "µm", 1000]];
  const single = (name, title, u) => RUN.recorded(name) && out.push({title, unit: u, curves: [{name, label: "", colour: () => css("--accent")}]});
  single("path.speed", "pathSpeed", "mm/s");
  for (const [kind, limit, u, factor] of kinds)
    for (const turns of [false, true])
      out.push({title: kind, unit: turns ? u.replace("mm", "deg").replace("µm", "arcsec") : u, factor: turns && u === "µm" ? 3600 : factor,
        curves: RUN.axes.filter(a => (a.report.unit === "deg") === turns && RUN.recorded(a.letter + "." + kind)).map(a => ({name: a.letter + "." + kind,
          label: a.letter, letter: a.letter, colour: () => axisColour(a.letter), limit: (a.report.limits || {})[limit]}))});
  for (const name of ["spindle", "spindle2"])
    if (RUN.recorded(name + ".cmd"))
      out.push({title: "spindle", unit: "rpm", curves: [{name: name + ".cmd", label: "→", colour: () => css("--axis-3")}, {name: name + ".act", label: "", colour: () => css("--axis-4")}]});
  const off = RUN.recorded("thread.off") ? RUN.series.get("thread.off") : null;
  if (off && (off.low.some(v => v < 0) || off.high.some(v => v > 0)))
    out.push({title: "threadOff", unit: "µm", factor: 1000, curves: [{name: "thread.off", label: "", colour: () => css("--accent")}]});
  const drawn = out.filter(s => s.curves.length);
  if (drawn.length) drawn[drawn.length - 1].labels = true;
  return drawn;
}
