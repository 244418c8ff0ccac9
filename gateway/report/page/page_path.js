// SPDX-License-Identifier: Apache-2.0
// The path: a plan with equal scales and a view that turns. Both colour the feed by speed and follow the cursor.
const SPEED_STEPS = 24;
const SPEED_MAX = (() => {
  let most = 0;
  for (let i = 0; i < PATH.n; ++i) if (!PATH.rapid[i] && PATH.speed[i] > most) most = PATH.speed[i];
  return most || 1;
})();
const RAMP = {
  light: [[68, 34, 120], [49, 94, 168], [22, 142, 132], [110, 170, 44], [214, 120, 10]],
  dark: [[140, 110, 240], [80, 160, 250], [52, 208, 180], [170, 222, 90], [255, 176, 64]],
};
function speedColour(ratio) {
  const ramp = RAMP[isDark() ? "dark" : "light"], x = clamp(ratio, 0, 1) * (ramp.length - 1);
  const i = Math.min(Math.floor(x), ramp.length - 2), s = x - i;
  return "rgb(" + ramp[i].map((c, k) => Math.round(c + s * (ramp[i + 1][k] - c))).join(",") + ")";
}

/** Draws all stretches by groups of equal colour; px, py = screen coordinates of the vertices. */
function drawStretches(g, px, py) {
  const groups = Array.from({length: SPEED_STEPS}, () => new Path2D());
  for (let i = 1; i < PATH.n; ++i) {
    if (PATH.rapid[i]) continue;
    const mean = (PATH.speed[i] + PATH.speed[i - 1]) / 2, p = groups[Math.min(SPEED_STEPS - 1, Math.floor(mean / SPEED_MAX * SPEED_STEPS))];
    p.moveTo(px[i - 1], py[i - 1]);
    p.lineTo(px[i], py[i]);
  }
  g.lineCap = g.lineJoin = "round";
  if (S.rapids) {
    g.lineWidth = 1.2;
    for (const [kind, dash] of [["rapid", [5, 4]], ["homing", [1.5, 3.5]]]) {
      // Dashes need whole polylines, not single stretches.
      const whole = new Path2D();
      for (let i = 1; i < PATH.n; ++i) {
        if (kindOf(i) !== kind) continue;
        if (i === 1 || kindOf(i - 1) !== kind) whole.moveTo(px[i - 1], py[i - 1]);
        whole.lineTo(px[i], py[i]);
      }
      g.strokeStyle = css("--" + kind);
      g.setLineDash(dash);
      g.stroke(whole);
    }
    g.setLineDash([]);
  }
  g.lineWidth = 1.6;
  groups.forEach((p, k) => {
    g.strokeStyle = speedColour((k + 0.5) / SPEED_STEPS);
    g.stroke(p);
  });
}
function drawLine(g, px, py, line) {
  if (!line) return;
  const p = new Path2D();
  for (let i = 1; i < PATH.n; ++i) {
    if (PATH.line[i] !== line || PATH.rapid[i] === 2) continue;
    p.moveTo(px[i - 1], py[i - 1]);
    p.lineTo(px[i], py[i]);
  }
  g.lineCap = "round";
  g.strokeStyle = css("--mark");
  g.globalAlpha = 0.35;
  g.lineWidth = 9;
  g.stroke(p);
  g.globalAlpha = 1;
}
function drawTool(g, x, y) {
  g.fillStyle = css("--mark");
  g.strokeStyle = css("--panel");
  g.lineWidth = 2;
  g.beginPath();
  g.arc(x, y, 5.5, 0, 2 * Math.PI);
  g.fill();
  g.stroke();
}
/** Nearest vertex on the screen within 14 px, or -1. */
function nearest(px, py, x, y) {
  let best = 14 * 14, at = -1;
  for (let i = 0; i < PATH.n; ++i) {
    if (PATH.rapid[i] === 2 || (!S.rapids && PATH.rapid[i])) continue;
    // The nearest point of the stretch, so that long lines can be met between their ends.
    let d = (px[i] - x) ** 2 + (py[i] - y) ** 2;
    if (i > 0) {
      const ux = px[i] - px[i - 1], uy = py[i] - py[i - 1], u2 = ux * ux + uy * uy;
      const s = u2 > 0 ? clamp(((x - px[i - 1]) * ux + (y - py[i - 1]) * uy) / u2, 0, 1) : 1;
      d = (px[i - 1] + s * ux - x) ** 2 + (py[i - 1] + s * uy - y) ** 2;
      if (d < best) { best = d; at = i - 1 + s; }
    } else if (d < best) { best = d; at = i; }
  }
  return at;
}
/** Time at a fractional vertex index. */
function timeAt(index) {
  const i = Math.floor(index), j = Math.min(i + 1, PATH.n - 1);
  let [low, high] = [PATH.t[i], PATH.t[j]];
  for (let n = 0; n < 30; ++n) {
    const mid = (low + high) / 2;
    if (wayAt(i, mid) < index - i) low = mid; else high = mid;
  }
  return high;
}

/** What both views share: projection in, drawing and pointer handling out. */
function pathView(box, view) {
  const L = layers(box), tip = box.appendChild(el("div", {class: "tip"}));
  const px = new Float32Array(PATH.n), py = new Float32Array(PATH.n);
  let asked = false, ready = false;
  function project() {
    view.prepare(box.clientWidth, box.clientHeight);
    for (let i = 0; i < PATH.n; ++i) [px[i], py[i]] = view.project(PATH.x[i], PATH.y[i], PATH.z[i]);
  }
  function draw() {
    asked = false;
    L.resize();
    project();
    const g = L.context("base");
    view.scenery(g, box.clientWidth, box.clientHeight);
    drawStretches(g, px, py);
    ready = true;
    follow();
  }
  function follow() {
    if (!ready) return;
    const g = L.context("over"), place = placeAt(S.cursor);
    drawLine(g, px, py, S.line || lineAt(S.cursor));
    if (place) drawTool(g, ...view.project(place.x, place.y, place.z));
  }
  function redraw() {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  }
  function hover(x, y) {
    const at = nearest(px, py, x, y);
    box.classList.toggle("found", at >= 0);
    tip.style.display = at < 0 ? "none" : "block";
    if (at < 0) return;
    const t = timeAt(at), place = placeAt(t);
    setCursor(t);
    const coordinates = VIEW.map((letter, k) => letter && letter + " " + fixed([place.x, place.y, place.z][k], 3)).filter(Boolean);
    tip.textContent = coordinates.join("  ") + "\n" + tr("line") + " " + lineAt(t) + " · " + num(valueAt("path.speed", t)) + " " +
      unit("mm/s") + " · " + fixed(t, 3) + " " + unit("s");
    tip.style.left = clamp(x + 14, 4, Math.max(4, box.clientWidth - tip.offsetWidth - 4)) + "px";
    tip.style.top = clamp(y + 16, 4, Math.max(4, box.clientHeight - tip.offsetHeight - 4)) + "px";
  }
  let drag = null;
  box.addEventListener("pointerdown", e => {
    drag = {x: e.offsetX, y: e.offsetY};
    box.setPointerCapture(e.pointerId);
    box.focus({preventScroll: true});
  });
  box.addEventListener("pointermove", e => {
    const r = box.getBoundingClientRect(), x = e.clientX - r.left, y = e.clientY - r.top;
    if (!drag) return hover(x, y);
    view.drag(x - drag.x, y - drag.y, e.shiftKey || e.buttons === 2 || e.buttons === 4);
    drag = {x, y};
    redraw();
  });
  box.addEventListener("pointerup", () => { drag = null; });
  box.addEventListener("pointerleave", () => { tip.style.display = "none"; });
  box.addEventListener("contextmenu", e => e.preventDefault());
  box.addEventListener("wheel", e => {
    if (!e.ctrlKey && !e.metaKey && document.activeElement !== box) return;
    e.preventDefault();
    const r = box.getBoundingClientRect();
    view.zoom(Math.exp(-e.deltaY * 0.0015), e.clientX - r.left, e.clientY - r.top);
    redraw();
  }, {passive: false});
  box.addEventListener("dblclick", () => { view.fit(); redraw(); });
  for (const type of ["theme", "size", "rapids", "lang"]) on(type, redraw);
  for (const type of ["cursor", "line"]) on(type, follow);
  return {redraw, fit() { view.fit(); redraw(); }, draw};
}

/** Travel of the machine along axis k of the view, [low, high]; null where it has no end. */
function travelOf(k) {
  const axis = AXES.find(a => a.letter === VIEW[k]), limits = axis && axis.report.limits;
  return limits && limits.travel_max !== undefined ? [limits.travel_min, limits.travel_max] : null;
}

/** The plan: x to the right, y up, one scale. */
function planView() {
  let scale = 0, cx = 0, cy = 0, w = 1, h = 1, fitted = true;
  const travel = [travelOf(0), travelOf(1)];
  /** "Everything" has the box of the machine's travel in it. */
  const planBox = () => {
    const box = shownBox(), low = [...box.low], high = [...box.high];
    if (S.whole) travel.forEach((ends, k) => {
      if (ends) [low[k], high[k]] = [Math.min(low[k], ends[0]), Math.max(high[k], ends[1])];
    });
    return {low, high};
  };
  const drawTravel = (g, width, height) => {
    if (!travel[0] || !travel[1]) return;
    const [x0, y0] = view.project(travel[0][0], travel[1][1]), [x1, y1] = view.project(travel[0][1], travel[1][0]);
    g.fillStyle = css("--travel");
    for (const [x, y, w, h] of [[0, 0, x0, height], [x1, 0, width - x1, height], [x0, 0, x1 - x0, y0], [x0, y1, x1 - x0, height - y1]])
      if (w > 0 && h > 0) g.fillRect(x, y, w, h);
    g.strokeStyle = css("--faint");
    g.lineWidth = 1.2;
    g.setLineDash([8, 4]);
    g.strokeRect(x0, y0, x1 - x0, y1 - y0);
    g.setLineDash([]);
    if (y0 < 0 || y0 > height || x0 > width || x1 < 0) return;
    g.fillStyle = css("--faint");
    g.textAlign = "left"; g.textBaseline = "bottom";
    g.fillText(tr("travel"), Math.max(x0, 0) + 4, y0 > 16 ? y0 - 3 : y0 + 15);
  };
  const view = {
    fit() { fitted = true; },
    prepare(width, height) {
      [w, h] = [width, height];
      if (!fitted) return;
      const box = planBox(), dx = box.high[0] - box.low[0], dy = box.high[1] - box.low[1];
      scale = Math.min((w - 72) / Math.max(dx, 1e-3), (h - 64) / Math.max(dy, 1e-3));
      if (!isFinite(scale) || dx + dy <= 0) scale = 1;
      [cx, cy] = [(box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2];
    },
    project(x, y) { return [w / 2 + 14 + (x - cx) * scale, h / 2 - 10 - (y - cy) * scale]; },
    drag(dx, dy) { fitted = false; cx -= dx / scale; cy += dy / scale; },
    zoom(factor, x, y) {
      fitted = false;
      const ux = cx + (x - w / 2 - 14) / scale, uy = cy - (y - h / 2 + 10) / scale;
      scale = clamp(scale * factor, 1e-3, 1e6);
      cx = ux - (x - w / 2 - 14) / scale;
      cy = uy + (y - h / 2 + 10) / scale;
    },
    scenery(g, width, height) {
      const left = cx - (w / 2 + 14) / scale, right = cx + (w / 2 - 14) / scale;
      const low = cy - (h / 2 + 10) / scale, high = cy + (h / 2 - 10) / scale;
      const step = ticks(left, right, width / 80).step;
      g.strokeStyle = css("--grid");
      g.fillStyle = css("--faint");
      g.lineWidth = 1;
      const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      for (let k = Math.ceil(left / step); k * step <= right; ++k) {
        const x = Math.round(view.project(k * step, 0)[0]) + 0.5;
        g.beginPath(); g.moveTo(x, 0); g.lineTo(x, height); g.stroke();
        g.textAlign = "center"; g.textBaseline = "bottom";
        if (x > 30) g.fillText(fixed(k * step, decimals), x, height - 4);
      }
      for (let k = Math.ceil(low / step); k * step <= high; ++k) {
        const y = Math.round(view.project(0, k * step)[1]) + 0.5;
        g.beginPath(); g.moveTo(0, y); g.lineTo(width, y); g.stroke();
        g.textAlign = "left"; g.textBaseline = "middle";
        if (y < height - 18) g.fillText(fixed(k * step, decimals), 4, y);
      }
      drawTravel(g, width, height);
      g.font = "600 " + css("--canvas-font");
      g.fillStyle = axisColour(VIEW[0]); g.textAlign = "right"; g.textBaseline = "bottom";
      g.fillText((VIEW[0] || "") + " →", width - 8, height - 18);
      g.fillStyle = axisColour(VIEW[1]); g.textAlign = "left"; g.textBaseline = "top";
      g.fillText("↑ " + (VIEW[1] || ""), 8, 6);
    },
  };
  return view;
}

/** The view that turns: parallel projection, yaw about the vertical axis, then pitch. */
function spaceView() {
  let yaw = -0.65, pitch = 0.6, zoom = 1, mx = 0, my = 0, w = 1, h = 1;
  let box = shownBox(), centre = [0, 0, 0], scale = 1, cosY, sinY, cosP, sinP;
  const raw = (x, y, z) => {
    const a = x - centre[0], b = y - centre[1], c = z - centre[2];
    const u = a * cosY - b * sinY, v = a * sinY + b * cosY;
    return [u, -(v * sinP + c * cosP)];
  };
  const corners = () => [0, 1, 2, 3, 4, 5, 6, 7].map(n => [0, 1, 2].map(k => (n >> k & 1 ? box.high : box.low)[k]));
  const view = {
    fit() { zoom = 1; mx = my = 0; },
    turn(y, p) { [yaw, pitch] = [y, p]; view.fit(); },
    prepare(width, height) {
      [w, h] = [width, height];
      box = shownBox();
      centre = [0, 1, 2].map(k => (box.low[k] + box.high[k]) / 2);
      [cosY, sinY, cosP, sinP] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
      // The sphere around everything keeps its size while it turns; a flat path may fill more.
      let rx = 1e-3, ry = 1e-3;
      for (const c of corners()) {
        const [u, v] = raw(...c);
        rx = Math.max(rx, Math.abs(u));
        ry = Math.max(ry, Math.abs(v));
      }
      scale = zoom * Math.min((w - 56) / (2 * rx), (h - 64) / (2 * ry));
    },
    project(x, y, z) {
      const [u, v] = raw(x, y, z);
      return [w / 2 + mx + u * scale, h / 2 + my + v * scale];
    },
    drag(dx, dy, move) {
      if (move) { mx += dx; my += dy; return; }
      yaw += dx * 0.008;
      pitch = clamp(pitch + dy * 0.008, -Math.PI / 2, Math.PI / 2);
    },
    zoom(factor, x, y) {
      const before = zoom;
      zoom = clamp(zoom * factor, 0.2, 200);
      const f = zoom / before;
      mx = (x - w / 2) - f * (x - w / 2 - mx);
      my = (y - h / 2) - f * (y - h / 2 - my);
    },
    scenery(g, width, height) {
      const c = corners();
      g.strokeStyle = css("--grid");
      g.lineWidth = 1;
      for (let n = 0; n < 8; ++n)
        for (let k = 0; k < 3; ++k) {
          if (n >> k & 1) continue;
          g.beginPath();
          g.moveTo(...view.project(...c[n]));
          g.lineTo(...view.project(...c[n | 1 << k]));
          g.stroke();
        }
      const span = Math.max(box.high[0] - box.low[0], box.high[1] - box.low[1], 1e-3), step = ticks(0, span, 8).step;
      g.globalAlpha = 0.6;
      for (const k of [0, 1])
        for (let n = Math.ceil(box.low[k] / step); n * step <= box.high[k]; ++n) {
          const from = [box.low[0], box.low[1], box.low[2]], to = [box.high[0], box.high[1], box.low[2]];
          from[k] = to[k] = n * step;
          g.beginPath(); g.moveTo(...view.project(...from)); g.lineTo(...view.project(...to)); g.stroke();
        }
      g.globalAlpha = 1;
      const o = [46, height - 46];
      VIEW.forEach((letter, k) => {
        if (!letter) return;
        const unitVector = [0, 1, 2].map(n => centre[n] + (n === k ? 1 : 0)), [u, v] = raw(...unitVector);
        g.strokeStyle = g.fillStyle = axisColour(letter);
        g.lineWidth = 2;
        g.beginPath(); g.moveTo(...o); g.lineTo(o[0] + 30 * u, o[1] + 30 * v); g.stroke();
        g.textAlign = "center"; g.textBaseline = "middle";
        g.fillText(letter, o[0] + 39 * u, o[1] + 39 * v);
      });
    },
  };
  return view;
}
