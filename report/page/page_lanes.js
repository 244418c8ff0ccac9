// SPDX-License-Identifier: Apache-2.0
// Signals as a timing diagram: uPlot has the time axis, the zoom and the cursor, this paints the lanes.
const LANE = 24;

/** Parts of the window in which one line is in motion: [line, from, to]. */
function linesBetween(t0, t1) {
  const out = [], last = RUN.bucketAt(t1);
  for (let b = RUN.bucketAt(t0), from = b; b <= last; ++b) {
    if (b < last && RUN.line[b + 1] === RUN.line[from]) continue;
    if (RUN.line[from] > 0) out.push([RUN.line[from], RUN.start + from * RUN.bucket, RUN.start + (b + 1) * RUN.bucket]);
    from = b + 1;
  }
  return out;
}
/** Parts of the window in which a signal is on: [from, to]. */
function onBetween(signal, t0, t1) {
  const out = [];
  let i = before(signal.toggles, t0), state = RUN.signalAt(signal, t0), from = t0;
  for (++i; ; ++i) {
    const to = i >= signal.toggles.length ? t1 : Math.min(signal.toggles[i], t1);
    if (state && to > from) out.push([from, to]);
    if (to >= t1) return out;
    [state, from] = [!state, to];
  }
}

function lanes(parent) {
  const row = timeRow(parent, "lanes"), shown = () => RUN.signals.filter(s => S.constant || s.toggles.length > 0);
  const height = () => (shown().length + 1) * LANE + 8 + 26;
  const u = new uPlot(timeOptions(row.plot, height(), true, {series: [{show: false}], axis: {values: (v, at) => at.map(() => ""), grid: {show: false}},
    draw: [paint, alarmMarks]}), [[0, 1], [null, null]], row.plot);
  timeInput(u, row.plot);

  function paint(v) {
    const {ctx, bbox} = v, scale = devicePixelRatio, x = t => clamp(v.valToPos(t, "x", true), bbox.left, bbox.left + bbox.width);
    const top = k => bbox.top + k * LANE * scale;
    ctx.save();
    ctx.font = 11 * scale + "px system-ui,sans-serif";
    ctx.textAlign = "center";
    ctx.textBaseline = "middle";
    let odd = 0;
    for (const [line, from, to] of linesBetween(S.t0, S.t1)) {
      const [a, b] = [x(from), x(to)];
      ctx.fillStyle = css((odd ^= 1) ? "--lane-b" : "--lane-a");
      ctx.fillRect(a, top(0) + 4 * scale, Math.max(b - a - 0.5, 0.5), 16 * scale);
      if (b - a < (8 + 7 * String(line).length) * scale) continue;
      ctx.fillStyle = css("--text");
      ctx.fillText(String(line), (a + b) / 2, top(0) + 12.5 * scale);
    }
    ctx.lineWidth = 1.4 * scale;
    shown().forEach((s, n) => lane(ctx, s, x, top(n + 1) + 5 * scale, top(n + 2) - 5 * scale, bbox.left + bbox.width, scale));
    ctx.restore();
  }
  function lane(ctx, s, x, high, low, right, scale) {
    ctx.strokeStyle = css("--lane-line");
    ctx.fillStyle = css("--lane-on");
    ctx.beginPath();
    ctx.moveTo(x(S.t0), low);
    for (const [from, to] of onBetween(s, S.t0, S.t1)) {
      const [a, b] = [x(from), x(to)];
      ctx.fillRect(a, high, b - a, low - high);
      for (const [px, py] of [[a, low], [a, high], [b, high], [b, low]]) ctx.lineTo(px, py);
    }
    ctx.lineTo(right, low);
    ctx.stroke();
    if (s.truncated < 0 || s.truncated >= S.t1) return;
    // From here on it changed too often to be kept.
    const from = x(s.truncated);
    ctx.fillStyle = css("--panel");
    ctx.fillRect(from, high - 2 * scale, right - from, low - high + 4 * scale);
    ctx.strokeStyle = css("--faint");
    ctx.beginPath();
    for (let at = from; at < right; at += 6 * scale) {
      ctx.moveTo(at, low);
      ctx.lineTo(Math.min(at + low - high, right), high);
    }
    ctx.stroke();
  }
  const update = inNextFrame(() => draw());
  function draw() {
    u.batch(() => {
      u.setSize({width: Math.max(row.plot.clientWidth, 80), height: height()});
      u.setData([[S.t0, S.t1], [null, null]], false);
      u.setScale("x", {min: S.t0, max: S.t1});
      u.setScale("y", {min: 0, max: 1});
    });
    follow();
  }
  function follow() {
    followCursor(u);
    row.names.replaceChildren(el("span", {class: "lane"}, tr("line") + " " + (RUN.lineAt(S.cursor) || "–")),
      ...shown().map(s => el("span", {class: "lane" + (RUN.signalAt(s, S.cursor) ? " on" : ""), title: s.name}, s.name)));
  }
  for (const type of ["window", "theme", "size", "constant", "lang"]) on(type, update);
  on("cursor", follow);
  update();
  return {draw};
}

/** Names of signals that never changed, by state, for the sentence below the diagram. */
function steadySignals() {
  const steady = RUN.signals.filter(s => s.toggles.length === 0), names = state => steady.filter(s => s.initial === state).map(s => s.name);
  return {on: names(true), off: names(false), count: steady.length};
}
