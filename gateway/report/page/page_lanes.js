// SPDX-License-Identifier: Apache-2.0
// Signals as a timing diagram, and the program beside the time that each of its lines took.

function lanes(box) {
  const L = layers(box), TOP = 4;
  let asked = false, LANE = 24;
  const shown = () => SIGNALS.filter(s => S.constant || s.toggles.length > 0);
  const rows = () => shown().length + 1;
  const laneTop = k => TOP + k * LANE;
  const bottom = () => laneTop(rows());

  function drawLineLane(g) {
    const top = laneTop(0) + 4, height = 16, b1 = bucketAt(S.t1);
    const fills = [css("--lane-a"), css("--lane-b")];
    let from = bucketAt(S.t0), odd = 0, lastX = -1e9;
    for (let b = from; b <= b1; ++b) {
      if (b < b1 && LINE[b + 1] === LINE[from]) continue;
      const x0 = Math.max(gutter(), xOf(box, RUN.start + from * RUN.bucket)), x1 = Math.min(box.clientWidth - RIGHT, xOf(box, RUN.start + (b + 1) * RUN.bucket));
      if (LINE[from] > 0) {
        g.fillStyle = fills[odd ^= 1];
        g.fillRect(x0, top, Math.max(x1 - x0 - 0.5, 0.5), height);
        const label = String(LINE[from]);
        if (x1 - x0 > 8 + 7 * label.length && x0 > lastX) {
          g.fillStyle = css("--text");
          g.textAlign = "center"; g.textBaseline = "middle";
          g.fillText(label, (x0 + x1) / 2, top + height / 2 + 0.5);
          lastX = x0;
        }
      }
      from = b + 1;
    }
  }
  function drawSignal(g, s, k) {
    const high = laneTop(k) + (compact() ? 18 : 5), low = laneTop(k) + LANE - 5, right = box.clientWidth - RIGHT;
    let i = before(s.toggles, S.t0), state = signalAt(s, S.t0), x = gutter();
    const line = new Path2D(), fill = new Path2D();
    line.moveTo(x, state ? high : low);
    for (++i; ; ++i) {
      const end = i >= s.toggles.length || s.toggles[i] > S.t1, to = end ? right : xOf(box, s.toggles[i]);
      line.lineTo(to, state ? high : low);
      if (state) fill.rect(x, high, to - x, low - high);
      if (end) break;
      state = !state;
      line.lineTo(to, state ? high : low);
      x = to;
    }
    g.fillStyle = css("--lane-on");
    g.fill(fill);
    g.strokeStyle = css("--lane-line");
    g.lineWidth = 1.4;
    g.stroke(line);
    if (s.truncated >= 0 && s.truncated < S.t1) hatch(g, Math.max(gutter(), xOf(box, s.truncated)), high, right, low);
  }
  function hatch(g, x0, y0, x1, y1) {
    g.save();
    g.fillStyle = css("--panel");
    g.fillRect(x0, y0 - 2, x1 - x0, y1 - y0 + 4);
    g.beginPath(); g.rect(x0, y0, x1 - x0, y1 - y0); g.clip();
    g.strokeStyle = css("--faint");
    g.beginPath();
    for (let x = x0 - (y1 - y0); x < x1; x += 6) { g.moveTo(x, y1); g.lineTo(x + (y1 - y0), y0); }
    g.stroke();
    g.restore();
  }
  function draw() {
    asked = false;
    LANE = compact() ? 38 : 24;
    box.style.height = bottom() + 26 + "px";
    L.resize();
    const g = L.context("base");
    for (let k = 1; k < rows(); k += 2) {
      g.fillStyle = css("--stripe");
      g.fillRect(0, laneTop(k), box.clientWidth, LANE);
    }
    timeGrid(g, box, TOP, bottom(), true);
    g.save();
    g.beginPath(); g.rect(gutter(), 0, plotWidth(box), box.clientHeight); g.clip();
    drawLineLane(g);
    shown().forEach((s, k) => drawSignal(g, s, k + 1));
    alarmMarks(g, box, TOP, bottom());
    g.restore();
    follow();
  }
  function follow() {
    const g = L.context("over"), room = gutter() - 30;
    g.textAlign = "left"; g.textBaseline = "middle";
    g.fillStyle = css("--faint");
    g.fillText(compact() ? String(lineAt(S.cursor) || "–") : tr("line") + " " + (lineAt(S.cursor) || "–"), 2, laneTop(0) + 12);
    shown().forEach((s, k) => {
      const y = laneTop(k + 1) + (compact() ? 9 : LANE / 2), state = signalAt(s, S.cursor);
      g.fillStyle = css("--text");
      g.fillText(clipText(g, s.name, compact() ? box.clientWidth - 30 : room), compact() ? 16 : 2, y);
      g.beginPath();
      g.arc(compact() ? 7 : gutter() - 14, y, 4, 0, 2 * Math.PI);
      g.fillStyle = g.strokeStyle = css(state ? "--good" : "--faint");
      if (state) g.fill(); else g.stroke();
    });
    cursorMark(g, box, TOP, bottom());
  }
  function redraw() {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  }
  timeInput(box);
  for (const type of ["window", "theme", "size", "constant", "lang"]) on(type, redraw);
  on("cursor", follow);
  redraw();
  return {draw};
}

/** Names of signals that never changed, by state, for the sentence below the diagram. */
function steadySignals() {
  const steady = SIGNALS.filter(s => s.toggles.length === 0), names = state => steady.filter(s => s.initial === state).map(s => s.name);
  return {on: names(true), off: names(false), count: steady.length};
}

function listing(box) {
  const rows = [];
  let marked = null, longest = 0;
  for (const l of LINES.values()) longest = Math.max(longest, l.total);
  D.program.lines.forEach((text, i) => {
    const n = i + 1, spent = LINES.get(n);
    const bar = el("span", {class: "spent"});
    if (spent) {
      bar.append(el("i", {style: `width:${(100 * spent.total / longest).toFixed(1)}%`}), el("b", {}, ""));
      bar.dataset.seconds = spent.total;
    }
    const row = el("div", {class: "row" + (spent ? " used" : "")}, el("span", {class: "n"}, String(n)), el("span", {class: "code"}, text || " "), bar);
    row.addEventListener("pointerenter", () => { S.line = n; emit("line"); });
    if (spent) row.addEventListener("click", () => setCursor(spent.first));
    rows.push(row);
  });
  box.append(...rows);
  box.addEventListener("pointerleave", () => { S.line = 0; emit("line"); });
  function label() {
    for (const bar of box.querySelectorAll(".spent[data-seconds]"))
      bar.lastChild.textContent = num(+bar.dataset.seconds, 3) + " " + unit("s");
  }
  function follow() {
    const row = rows[lineAt(S.cursor) - 1] || null;
    if (row === marked) return;
    if (marked) marked.classList.remove("now");
    marked = row;
    if (!row) return;
    row.classList.add("now");
    if (S.follow) box.scrollTop = row.offsetTop - box.clientHeight / 2;
  }
  on("cursor", follow);
  on("lang", label);
  label();
  follow();
}
