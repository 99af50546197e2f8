// Diagrams that can be dragged. Each has a state, a function that draws it as SVG with a reading in words, handles on
// the drawing, sliders and choices below it. The stills for print and for readers without scripts are drawn by the same
// functions: node docs/companion/stills.mjs. A diagram of random numbers says so, and the page checks its reading.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1];
const at = (o, t, d) => [o[0] + t * d[0], o[1] + t * d[1]];
const minus = (a, b) => at(a, -1, b);
const unit = (v) => at([0, 0], 1 / (Math.hypot(...v) || 1), v);
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
const within = (p, [x, y, width, height]) => [clamp(p[0], x, x + width), clamp(p[1], y, y + height)];
const round = (x) => Math.round(x * 10) / 10;
const range = (n, make) => Array.from({ length: n }, (_, i) => make(i));
// Numbers as the text prints them: a true minus, and no minus before 0.
const fixed = (x, digits = 2) => x.toFixed(digits).replace(/^-(?=0\.?0*$)/, "").replace("-", "−");
const percent = (x, digits = 0) => `${fixed(100 * x, digits)} %`;
const degrees = (x, digits = 0) => `${fixed((180 * x) / Math.PI, digits)}°`;

const line = (a, b, kind = "", more = "") =>
  `<line x1="${round(a[0])}" y1="${round(a[1])}" x2="${round(b[0])}" y2="${round(b[1])}" class="${kind}" ${more}/>`;
const arrow = (a, b, kind) => {
  const d = unit(minus(b, a)), back = at(b, -9, d), side = [-d[1], d[0]];
  return line(a, back, kind) + polygon([b, at(back, 4, side), at(back, -4, side)], `${kind} solid`);
};
const polygon = (points, kind) => `<polygon points="${points.map((p) => p.map(round)).join(" ")}" class="${kind}"/>`;
const curve = (points, kind) => `<polyline points="${points.map((p) => p.map(round)).join(" ")}" class="${kind}"/>`;
const circle = (c, r, kind) => `<circle cx="${round(c[0])}" cy="${round(c[1])}" r="${round(Math.max(0, r))}" class="${kind}"/>`;
const box = ([x, y, w, h], kind, more = "") =>
  `<rect x="${round(x)}" y="${round(y)}" width="${round(w)}" height="${round(h)}" class="${kind}" ${more}/>`;
const label = (p, text, kind = "", anchor = "start") =>
  `<text x="${round(p[0])}" y="${round(p[1])}" class="${kind}" text-anchor="${anchor}">${text}</text>`;
// A letter of the formulas: a number is slanted, a vector bold.
const letter = (p, text, kind = "", anchor = "middle") => label(p, text, `${kind} letter`, anchor);
const vector = (p, text, kind = "", anchor = "middle") => label(p, text, `${kind} vector`, anchor);
const ball = (c, r, kind = "body") => circle(c, r, kind) + circle(at(c, 0.36 * r, [-0.6, -0.8]), 0.42 * r, "shine");
const turned = (d, a) => [d[0] * Math.cos(a) - d[1] * Math.sin(a), d[0] * Math.sin(a) + d[1] * Math.cos(a)];
// An arc from direction a to direction b around p, with its letter.
const angle = (p, a, b, r, text, kind = "") => {
  const whole = Math.atan2(a[0] * b[1] - a[1] * b[0], dot(a, b));
  return curve(range(17, (i) => at(p, r, turned(a, (whole * i) / 16))), kind) + letter(at(at(p, r + 12, turned(a, whole / 2)), 4, [0, 1]), text, kind);
};
const along = (a, b, share) => at(a, share, minus(b, a));
const spot = (p, text, kind) => circle(p, 3.5, `${kind} solid`) + label(at(p, 1, [8, -8]), text, kind);

// Numbers that are the same in each drawing.
function hashed(n, seed) {
  let x = Math.imul(n + 1, 0x9e3779b1) ^ Math.imul(seed + 1, 0x85ebca6b);
  x = Math.imul(x ^ (x >>> 16), 0x7feb352d);
  x = Math.imul(x ^ (x >>> 15), 0x846ca68b);
  return (x ^ (x >>> 16)) >>> 0;
}
const random = (n, seed) => hashed(n, seed) / 2 ** 32;

// Sobol's points as in shaders/rng.wgsl.
function sobol(index, stream) {
  let x = 0;
  for (let i = 0; i < 32; i++) x |= ((index >>> i) & 1) << (31 - i);
  x ^= Math.imul(x, 0x3d20adea);
  x = (x + stream) | 0;
  x = Math.imul(x, (stream >>> 16) | 1);
  x ^= Math.imul(x, 0x05526c56);
  x ^= Math.imul(x, 0x53a22864);
  let u = x ^ (x << 16);
  for (const [mask, shift] of [[0x00ff00ff, 8], [0x0f0f0f0f, 4], [0x33333333, 2], [0x55555555, 1]]) u ^= (u & mask) << shift;
  return [(x >>> 0) / 2 ** 32, (u >>> 0) / 2 ** 32];
}
// The bits of an Owen-scrambled index are reversed before the scrambling; the first coordinate is then the index's own.
const point = (isSobol, n, seed) => (isSobol ? sobol(n, hashed(seed, 7)) : [random(2 * n, seed), random(2 * n + 1, seed)]);

const schlick = (cosine, index) => {
  const f0 = ((1 - index) / (1 + index)) ** 2;
  return f0 + (1 - f0) * (1 - cosine) ** 5;
};
const fresnel = (cosine, ratio) => {
  const sine2 = ratio ** 2 * (1 - cosine ** 2);
  if (sine2 > 1) return 1;
  const inner = Math.sqrt(1 - sine2);
  return (((ratio * cosine - inner) / (ratio * cosine + inner)) ** 2 + ((cosine - ratio * inner) / (cosine + ratio * inner)) ** 2) / 2;
};

// The shapes of 2D scenes.
const SPHERES = range(24, (i) => ({ c: [180 + 70 * (i % 6) + 40 * random(i, 3), 45 + 60 * Math.floor(i / 6) + 36 * random(i, 31)], r: 7 + 9 * random(i, 5) }));
function tree(items) {
  const low = [0, 1].map((k) => Math.min(...items.map(({ c, r }) => c[k] - r)));
  const high = [0, 1].map((k) => Math.max(...items.map(({ c, r }) => c[k] + r)));
  const bounds = [...low, ...minus(high, low)];
  if (items.length <= 2) return { bounds, items, children: [] };
  const k = bounds[2] > bounds[3] ? 0 : 1, sorted = [...items].sort((a, b) => a.c[k] - b.c[k]), half = items.length >> 1;
  return { bounds, items: [], children: [tree(sorted.slice(0, half)), tree(sorted.slice(half))] };
}
const TREE = tree(SPHERES);
// The distance at which a ray enters a box; infinity if it misses.
const entry = (o, d, [x, y, w, h]) => {
  const [a, b] = [[x, y], [x + w, y + h]].map((p) => [(p[0] - o[0]) / (d[0] || 1e-9), (p[1] - o[1]) / (d[1] || 1e-9)]);
  const enter = Math.max(Math.min(a[0], b[0]), Math.min(a[1], b[1]), 0);
  return enter <= Math.min(Math.max(a[0], b[0]), Math.max(a[1], b[1])) ? enter : Infinity;
};
const hitOf = (o, d, { c, r }) => {
  const f = minus(c, o), h = dot(d, f), l = at(f, -h, d), s2 = r * r - dot(l, l);
  return s2 < 0 ? Infinity : [h - Math.sqrt(s2), h + Math.sqrt(s2)].find((t) => t > 1e-6) ?? Infinity;
};

const GROUND = { c: [300, 10240], r: 10000, colour: [0.8, 0.8, 0.3], name: "ground" };
const ROOM = [
  { c: [360, 130], r: 62, colour: [0.35, 0.5, 0.9], name: "matte blue" },
  { c: [455, 195], r: 46, colour: [0.85, 0.65, 0.3], isMetal: true, name: "gold" },
  GROUND,
];
// A path from the eye. Its last step has no ball if it ends in the sky, and black as the product if it is cut off.
function walk(eye, aim, rays, seed, room) {
  let o = eye, d = unit(minus(aim, o)), throughput = [1, 1, 1];
  const steps = [];
  for (let i = 0; i < rays; i++) {
    const hits = room.map((ball) => hitOf(o, d, ball)), t = Math.min(...hits), ball = room[hits.indexOf(t)];
    if (t === Infinity) return { steps: [...steps, { o, p: at(o, 900, d), sky: (1 - d[1]) / 2 }], throughput, isLit: true };
    const p = at(o, t, d), n = at([0, 0], 1 / ball.r, minus(p, ball.c));
    throughput = throughput.map((x, k) => x * ball.colour[k]);
    steps.push({ o, p, n, ball, throughput });
    const sine = 2 * random(i, seed) - 1;
    d = ball.isMetal ? at(d, -2 * dot(d, n), n) : at(at([0, 0], Math.sqrt(1 - sine * sine), n), sine, [-n[1], n[0]]);
    o = p;
  }
  return { steps, throughput: [0, 0, 0], isLit: false };
}
const rgb = (c) => `rgb(${c.map((x) => Math.round(255 * Math.sqrt(x)))})`;

const single = Math.fround;
function lostDigits(l, distance, r2 = 1) {
  const dot3 = (a, b) => single(single(a[0] * b[0]) + single(single(a[1] * b[1]) + single(a[2] * b[2])));
  const d = [1, 2, -2].map((x) => single(x / 3)), f = d.map((x, i) => single(distance * x + (l * [2, 1, 2][i]) / 3));
  const h = dot3(d, f), across = f.map((x, i) => single(x - single(h * d[i])));
  return [single(single(h * h) - single(dot3(d, d) * single(dot3(f, f) - r2))), single(r2 - dot3(across, across))];
}

const handle = (name, key, area, axis = [1, 1]) => ({
  label: name,
  get: (s) => s[key],
  set: (s, p) => (s[key] = within(at(s[key], 1, minus(p, s[key]).map((x, k) => x * axis[k])), area)),
});
const slider = (key, label, min, max, step, show = String) => ({ key, label, min, max, step, show });

export const diagrams = {};
