// SPDX-License-Identifier: Apache-2.0
// Cards and tables: what a run amounts to, in words and numbers.
function card(title, value, note, kind) {
  return el("div", {class: "card " + (kind || "")}, el("h3", {}, title), el("p", {class: "value"}, value), note ? el("p", {class: "note"}, note) : null);
}
function clockText(seconds) {
  if (seconds < 60) return num(seconds, 4) + " " + unit("s");
  const minutes = Math.floor(seconds / 60);
  return minutes + ":" + fixed(seconds - 60 * minutes, 1).padStart(4, "0");
}
function cards() {
  const R = report(), a = RUN.amounts(), worst = R.segments.reduce((m, s) => Math.max(m, s.load_worst_cycle), 0);
  const load = R.segments.reduce((m, s) => Math.max(m, s.load), 0), first = R.alarms[0];
  const metres = v => v >= 1000 ? num(v / 1000, 4) + " " + unit("m") : num(v, 4) + " " + unit("mm");
  const out = [
    card(tr("time"), clockText(R.time_s), tr("cyclesOf", num(R.cycles, 9), num(RUN.period * 1000) + " " + unit("ms"))),
    card(tr("blocks"), num(R.blocks, 9), R.finished || !R.blocks_expected ? RUN.data.program.name : tr("ofAbout", num(R.blocks_expected, 9))),
    card(tr("alarms"), String(R.alarms.length), first ? first.text : tr("noAlarms"), R.alarms.length ? "bad" : "good"),
    card(tr("pathLength"), metres(a.feed + a.rapid), tr("feedPath") + " " + metres(a.feed) + ", " + tr("rapidPath") + " " + metres(a.rapid) + (a.homing ? ", " + tr("homingPath") + " " + metres(a.homing) : "")),
    card(tr("cycleTime"), num(R.cycle_us.p99, 3) + " " + unit("µs"), "p50\u00a0" + num(R.cycle_us.p50, 3) + " · " + tr("max") + "\u00a0" + num(R.cycle_us.max, 3)),
  ];
  if (R.virtual_speed > 0) out.push(card(tr("speed"), num(R.virtual_speed, 3), tr("timesReal")));
  if (R.lateness_us) out.push(card(tr("late"), num(R.lateness_us.p99, 3) + " " + unit("µs"), tr("max") + "\u00a0" + num(R.lateness_us.max, 3)));
  out.push(card(tr("overruns"), num(R.overruns, 9), tr("starved") + ": " + num(R.starved, 9), R.overruns + R.starved > 0 ? "bad" : ""));
  if (R.segments.length) out.push(card(tr("busLoad"), num(100 * load, 3) + " %", tr("worst") + " " + num(100 * worst, 3) + " %", load > 0.8 ? "bad" : ""));
  fill("cards", ...out);
  const parts = [["feed", a.feedTime, "feedPath"], ["rapid", a.rapidTime, "rapidPath"], ["homing", a.homingTime, "homingPath"], ["still", a.still, "still"]];
  const total = Math.max(a.feedTime + a.rapidTime + a.homingTime + a.still, 1e-9);
  fill("split", ...parts.filter(p => p[1] > 0).map(([kind, t]) => el("i", {class: kind, style: `width:${100 * t / total}%`})));
  fill("split-key", el("span", {class: "lead"}, tr("moving") + ": "), ...parts.map(([kind, t, name]) => el("span", {class: "key " + kind}, tr(name) + " " + clockText(t))));
}
function limitBars() {
  const kinds = [["velocity", "velocity", "/s", 1], ["acceleration", "acceleration", "/s²", 1], ["jerk", "jerk", "/s³", 1], ["following_error", "error", "", 1]];
  fill("axes", ...RUN.axes.map(a => el("div", {class: "axis"}, el("h3", {style: `color:${axisColour(a.letter)}`}, a.letter, a.report.diameter ? el("span", {class: "note"}, " " + tr("ofRadius")) : null),
    ...kinds.map(([key, name, suffix]) => {
      const value = a.report["max_" + key] || 0, limit = (a.report.limits || {})[key], ratio = limit ? value / limit : 0;
      const fine = key === "following_error" && value < 0.1, of = limit ? " / " + num(limit, 4) + " " + unit(a.report.unit + suffix) : "";
      const over = ratio > 1.001, text = fine ? (a.report.unit === "deg" ? num(value * 3600, 3) + unit("arcsec") : num(value * 1000, 3) + " " + unit("µm")) + of :
        num(value, 4) + (of || " " + unit(a.report.unit + suffix));
      return el("div", {class: "bar" + (over ? " over" : "")}, el("span", {class: "name"}, tr(name)), el("span", {class: "figure"}, text),
        el("span", {class: "track", title: limit ? "" : tr("noLimit")}, el("i", {style: `width:${clamp(100 * ratio, 0, 100)}%`})),
        el("span", {class: "percent"}, limit ? num(100 * ratio, 3) + " %" : "–"));
    }))));
}
function alarmPlace(a) {
  const out = [];
  if (a.axis) out.push(tr("axis") + " " + a.axis);
  if (a.node !== undefined) out.push(tr("node") + " " + a.node);
  if (a.object) out.push(a.object);
  if (a.line) out.push(tr("line").toLowerCase() + " " + a.line);
  if (a.block !== undefined) out.push("N" + a.block);
  if (a.error_code) out.push(a.error_code);
  return out.join(", ") || "–";
}
function alarms() {
  const R = report();
  if (!R.alarms.length) return fill("alarms", el("p", {class: "quiet"}, tr("noAlarms")));
  const head = ["number", "at", "what", "where", "reaction"].map(k => el("th", {}, tr(k)));
  const rows = R.alarms.map(a => {
    const later = a.first_fault && a.first_fault !== a.sequence, root = R.alarms.find(o => o.sequence === a.first_fault);
    const what = el("td", {}, el("strong", {}, sentence(a.text)), el("div", {class: "note"}, sentence(a.remedy || "")),
      later ? el("div", {class: "note"}, tr("consequence") + " " + (root ? root.number : a.first_fault)) : null);
    const seek = el("button", {class: "link", onclick: () => setCursor(a.t)}, fixed(a.t, 3) + " " + unit("s"));
    return el("tr", {class: later ? "later" : ""}, el("td", {}, String(a.number)), el("td", {}, seek), what, el("td", {}, alarmPlace(a)), el("td", {}, tr(a.reaction)));
  });
  fill("alarms", el("table", {}, el("thead", {}, el("tr", {}, ...head)), el("tbody", {}, ...rows)));
}
/** The band from the least to the greatest deviation over a thread, both ways from 0 to `most`. */
function deviationBand(parts, most) {
  const percent = v => (50 - 48 * v / most).toFixed(1);
  return el("div", {class: "band"}, ...parts.map((p, n) => el("i", {style: `left:${(100 * n / parts.length).toFixed(1)}%;width:${(100 / parts.length).toFixed(1)}%;top:${percent(p[1])}%;bottom:calc(100% - ${percent(p[0])}%)`})));
}
/** Threads and taps: the lead that was cut, and how far the path was off the spindle. */
function threads() {
  const list = report().threads || [], shown = list.slice(0, 100), micro = v => num(v * 1000, 3);
  $("thread-section").hidden = !list.length;
  const most = shown.reduce((m, t) => Math.max(m, Math.abs(t.off_mm.least), Math.abs(t.off_mm.greatest)), 1e-6);
  const rows = shown.map(t => el("tr", {}, el("th", {}, tr("line") + " " + t.line, el("span", {class: "note"}, " " + t.axis + (t.file ? ", " + t.file : ""))),
    ...[fixed(t.lead_mm, 4) + " " + unit("mm"), num(t.revolutions, 4), num(t.speed_rpm[0], 4) + " … " + num(t.speed_rpm[1], 4) + " " + unit("rpm"),
      micro(t.off_mm.least) + " … " + micro(t.off_mm.greatest) + " " + unit("µm")].map(v => el("td", {class: "figure"}, v)),
    el("td", {}, deviationBand(t.profile_mm, most), el("div", {class: "note"}, "± " + micro(most) + " " + unit("µm")))));
  const heads = [tr("line"), ...["thread.lead", "thread.turns", "thread.speed", "thread.off"].map(k => tr(k)), tr("thread.profile")];
  fill("threads", el("table", {}, el("thead", {}, el("tr", {}, ...heads.map((h, k) => el("th", {class: k && k < 5 ? "figure" : ""}, h)))), el("tbody", {}, ...rows)),
    ...(list.length > shown.length ? [el("p", {class: "note"}, tr("thread.more", list.length - shown.length))] : []));
}
/** Places that a probe has touched, and how well they repeat: a dot for each touch. */
function touches() {
  const list = report().touches || [];
  $("touch-section").hidden = !list.length;
  const small = (t, v) => t.unit === "deg" ? num(v * 3600, 3) + unit("arcsec") : num(v * 1000, 3) + " " + unit("µm");
  const strip = t => {
    const most = t.places.reduce((m, p) => Math.max(m, Math.abs(p - t.mean)), 0);
    const dots = t.places.slice(0, 500).map(p => el("i", {style: `left:${50 + (most > 0 ? 47 * (p - t.mean) / most : 0)}%`}));
    return [el("div", {class: "strip"}, ...dots), el("div", {class: "note"}, "± " + small(t, most))];
  };
  const rows = list.map(t => el("tr", {}, el("th", {}, t.axis + (t.direction > 0 ? "+" : "−"), t.diameter ? el("span", {class: "note"}, " " + tr("ofRadius")) : null),
    ...[fixed(t.mean, 4) + " " + unit(t.unit), num(t.feed_mm_min, 4) + " " + unit("mm/min"), String(t.places.length), small(t, t.spread), small(t, t.deviation)].map(v => el("td", {class: "figure"}, v)),
    el("td", {}, ...strip(t))));
  const heads = [tr("axis"), ...["touch.place", "feedPath", "touch.count", "touch.spread", "touch.deviation"].map(k => tr(k)), tr("touch.each")];
  fill("touches", el("table", {}, el("thead", {}, el("tr", {}, ...heads.map((h, k) => el("th", {class: k && k < 6 ? "figure" : ""}, h)))), el("tbody", {}, ...rows)));
}
/** Errors for which the program was not begun. */
function findings() {
  const R = report();
  fill("findings", R.findings ? el("table", {}, el("thead", {}, el("tr", {}, el("th", {}, tr("where")), el("th", {}, tr("errorsFound")))),
    el("tbody", {}, ...R.findings.map(f => el("tr", {}, el("td", {}, f.file + ":" + f.line + ":" + f.column), el("td", {}, f.text + " [" + f.code + "]"))))) : null);
}
/** Quantiles of the cycle and its phases, and the load of each bus. */
function timing() {
  const R = report();
  const row = (name, q, kind) => el("tr", {class: kind || ""}, el("th", {}, name), ...["p50", "p99", "p999", "max"].map(k => el("td", {class: "figure"}, num(q[k], 3))));
  const rows = [row(tr("cycle"), R.cycle_us, "sum")];
  for (const [name, q] of Object.entries(R.phases_us)) rows.push(row(tr("phase." + name, name), q));
  if (R.lateness_us) rows.push(row(tr("lateness"), R.lateness_us));
  const heads = (...names) => el("thead", {}, el("tr", {}, ...names.map((n, k) => el("th", {class: k ? "figure" : ""}, n))));
  const phases = el("table", {}, heads(unit("µs"), "p50", "p99", "p99.9", tr("max")), el("tbody", {}, ...rows));
  const buses = el("table", {}, heads(tr("segment"), tr("load"), tr("worst"), tr("sent"), tr("received"), tr("errors")), el("tbody", {}, ...R.segments.map(s =>
    el("tr", {}, el("th", {}, s.name), ...[num(100 * s.load, 3) + " %", num(100 * s.load_worst_cycle, 3) + " %", num(s.frames_sent, 9), num(s.frames_received, 9), num(s.errors, 9)]
      .map(v => el("td", {class: "figure"}, v))))));
  fill("timing", el("div", {class: "table"}, phases), R.segments.length ? el("div", {class: "table"}, buses) : null,
    ...R.segments.filter(s => s.sync_late_us).map(lateSync), R.sync_skew_us ? el("p", {class: "note"}, tr("syncSkew") + ": " + quantiles(R.sync_skew_us)) : null);
}
const quantiles = q => ["p50", "p99", "p999", "max"].map(k => k + " " + num(q[k], 3)).join(", ") + " " + unit("µs");
/** Histogram of the lateness of SYNC on one bus, a bar for each doubling. */
function lateSync(s) {
  const most = s.sync_late_histogram.reduce((m, b) => Math.max(m, b.count), 1);
  const bar = b => el("div", {class: "late", style: `width:${Math.max(1, Math.round(200 * b.count / most))}px`});
  const rows = s.sync_late_histogram.map(b => el("tr", {}, el("th", {}, `${num(b.from_us, 3)}–${num(b.to_us, 3)} ${unit("µs")}`),
    el("td", {class: "figure"}, String(b.count)), el("td", {}, bar(b))));
  return el("div", {class: "table"}, el("p", {class: "note"}, `${tr("syncLate")} ${s.name}: ${quantiles(s.sync_late_us)}`), el("table", {}, el("tbody", {}, ...rows)));
}
function provenance() {
  const p = report().provenance, rows = [];
  const add = (key, ...value) => value.some(Boolean) && rows.push(el("tr", {}, el("th", {}, tr(key)), el("td", {}, ...value)));
  const file = f => f && el("span", {}, f.path + " ", el("code", {class: "hash", title: "SHA-256"}, f.sha256 || "–"));
  const list = (key, items) => add(key, ...items.map(i => el("div", {}, i)));
  add("version", p.version);
  add("commit", p.commit && el("code", {}, p.commit));
  add("machine", file(p.machine));
  add("programFile", file(p.program));
  list("plc", p.plc.map(file));
  add("dialect", p.dialect);
  add("seed", String(p.seed));
  add("clock", p.clock);
  list("buses", p.buses.map(b => `${b.name}: ${b.protocol}, ${b.transport} (${b.kind})`));
  list("nodes", p.nodes.map(n => `${n.bus} ${n.node}: ${n.name} ${n.vendor} ${n.product} ${n.revision} ${n.serial}`));
  add("kernel", p.kernel);
  add("processor", p.processor);
  add("command", el("code", {}, p.command_line.join(" ")));
  const kept = RUN.stretches.reduce((sum, s) => sum + s.rows, 0) * RUN.period;
  add("resolution", tr("resolutionText", num(RUN.bucket * 1000) + " " + unit("ms"), num(RUN.tolerance * 1000) + " " + unit("µm")) + " " +
    (kept >= 0.999 * RUN.duration ? tr("everyKept") : tr("everyPart", clockText(kept))));
  fill("provenance", el("table", {}, el("tbody", {}, ...rows)));
}
/** This run beside the one that is laid over it. */
function comparison() {
  $("compare-section").hidden = !OTHER;
  if (!OTHER) return;
  const here = report(), there = OTHER.data.report[S.lang], a = RUN.amounts(), b = OTHER.amounts();
  const row = (name, x, y, u, digits = 5) => el("tr", {}, el("th", {}, name), ...[x, y, y - x].map((v, k) => el("td", {class: "figure"}, (k === 2 && v > 0 ? "+" : "") + num(v, digits) + " " + u)));
  const rows = [row(tr("time"), here.time_s, there.time_s, unit("s"), 7), row(tr("blocks"), here.blocks, there.blocks, "", 9),
    row(tr("pathLength") + ", " + tr("feedPath"), a.feed, b.feed, unit("mm"), 7), row(tr("pathLength") + ", " + tr("rapidPath"), a.rapid, b.rapid, unit("mm"), 7)];
  for (const {letter, report: mine} of RUN.axes) {
    const other = OTHER.axis(letter);
    if (!other) continue;
    for (const [key, name, suffix] of [["velocity", "velocity", "/s"], ["acceleration", "acceleration", "/s²"], ["jerk", "jerk", "/s³"], ["following_error", "error", ""]])
      rows.push(row(letter + " " + tr(name), mine["max_" + key], other.report["max_" + key], unit(mine.unit + suffix)));
  }
  const heads = ["", tr("thisRun"), OTHER.data.title || tr("otherRun"), tr("difference")].map((n, k) => el("th", {class: k ? "figure" : ""}, n));
  fill("comparison", el("p", {class: "note"}, there.verdict.text), el("table", {}, el("thead", {}, el("tr", {}, ...heads)), el("tbody", {}, ...rows)));
}
