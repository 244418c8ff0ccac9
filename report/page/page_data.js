// SPDX-License-Identifier: Apache-2.0
// How numbers come out of the page's data, and small tools for its elements.
/** Bytes that the page carries: base64 of deflated data. */
async function inflated(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
/** A column of numbers: multiples of q, differences of order o, seven bits a byte (record/column.hpp). */
async function column(c, Numbers = Float64Array) {
  const bytes = await inflated(c.d), out = new Numbers(c.n), sums = [0, 0, 0];
  for (let i = 0, at = 0; i < c.n; ++i) {
    let bits = 0, scale = 1, byte;
    do {
      byte = bytes[at++];
      bits += (byte & 127) * scale;
      scale *= 128;
    } while (byte & 128);
    let value = bits % 2 ? -(bits + 1) / 2 : bits / 2;
    for (let k = c.o - 1; k >= 0; --k) value = sums[k] += value;
    out[i] = value * c.q;
  }
  return out;
}

function clamp(v, low, high) { return Math.min(Math.max(v, low), high); }
/** Index of the last element that is not above t; -1 when all are. */
function before(list, t) {
  let low = -1, high = list.length;
  while (high - low > 1) {
    const mid = (low + high) >> 1;
    if (list[mid] <= t) low = mid; else high = mid;
  }
  return low;
}
/** Steps of 1, 2, 5 × 10^n, about `count` of them between low and high. */
function ticks(low, high, count) {
  const rough = (high - low) / Math.max(count, 1), power = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= rough * 0.999) || power;
  const at = [], decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; ++k) at.push(k * step);
  return {step, decimals, at};
}

const $ = id => document.getElementById(id);
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
function fill(id, ...children) { $(id).replaceChildren(...children.filter(c => c !== null)); }
function css(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }
/** A colour of the style, #rrggbb, as three numbers from 0 to 1. */
function rgb(colour) { return [1, 3, 5].map(k => parseInt(colour.slice(k, k + 2), 16) / 255); }
/** Calls f in the next frame, once however often it is asked for. */
function inNextFrame(f) {
  let asked = false;
  return () => {
    if (!asked) requestAnimationFrame(() => { asked = false; f(); });
    asked = true;
  };
}
