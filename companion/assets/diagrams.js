// Diagrams that can be dragged. Each has a state, a function that draws it as SVG with a reading in words, handles on
// the drawing and sliders below it. The stills for print and for readers without scripts are drawn by the same
// functions: node docs/companion/stills.mjs

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

export const diagrams = {
  hero: {
    title: "One path of light, from the eye to the sky",
    size: [720, 330],
    narrow: [560, 520],
    hint: "Drag a ball, or the pixel that the ray goes through. Another seed sends the light another way.",
    state: { aim: [120, 156], blue: [420, 120], gold: [480, 235], red: [255, 225], seed: 3 },
    handles: [
      handle("Pixel of the ray", "aim", [120, 84, 0, 162], [0, 1]), handle("Blue ball", "blue", [190, 60, 330, 175]),
      handle("Golden ball", "gold", [190, 60, 330, 175]), handle("Red ball", "red", [190, 60, 330, 175]),
    ],
    sliders: [slider("seed", "Seed", 1, 30, 1)],
    draw({ aim, blue, gold, red, seed }, isNarrow) {
      const eye = [30, 165], row = clamp(Math.floor((aim[1] - 75) / 18), 0, 9), through = [120, 84 + 18 * row];
      const room = [
        { c: blue, r: 58, colour: [0.3, 0.5, 0.95], name: "blue ball" }, { c: gold, r: 48, colour: [0.95, 0.72, 0.3], isMetal: true, name: "golden mirror" },
        { c: red, r: 40, colour: [0.9, 0.25, 0.2], name: "red ball" }, { ...GROUND, c: [300, 10285] },
      ];
      const { steps, throughput, isLit } = walk(eye, through, 6, seed, room), last = steps.at(-1);
      const sky = (share) => [1 - 0.5 * share, 1 - 0.3 * share, 1], pixel = isLit ? throughput.map((x, k) => x * sky(last.sky)[k]) : [0, 0, 0];
      const swatch = (p, size, colour) => box([...p, size, size], "swatch", `style="fill:${rgb(colour)}"`);
      const bands = range(16, (i) => `<rect x="0" y="${20.6 * i}" width="560" height="21" class="plain" style="fill:${rgb(sky(1 - i / 15))}"/>`);
      const balls = room.map(({ c, r, colour }) => `<circle cx="${c[0]}" cy="${c[1]}" r="${r}" class="plain" style="fill:${rgb(colour)}"/>` + (r < 100 ? circle(at(c, 0.36 * r, [-0.6, -0.8]), 0.42 * r, "shine") : ""));
      const rays = steps.map(({ o, p, n }) => arrow(o, n ? p : at(o, 130, unit(minus(p, o))), "ink thick") + (n ? circle(p, 4, "ink solid") : ""));
      const cells = range(10, (i) => box([111, 75 + 18 * i, 18, 18], "cell", i === row ? `style="fill:${rgb(pixel)}"` : ""));
      const scene = `<svg x="0" y="0" width="560" height="330" viewBox="0 0 560 330">${[...bands, ...balls, ...cells, ...rays].join("")}${circle(eye, 7, "ink solid")}${label([14, 150], "eye", "ink")}${label([100, 66], "pixels", "ink")}</svg>`;
      // Beside the scene, or below it in two columns.
      const place = (i) => (isNarrow ? [8 + 200 * Math.floor(i / 3), 366 + 50 * (i % 3)] : [576, 22 + 34 * i]), side = isNarrow ? 30 : 22;
      const factors = steps.map(({ ball, throughput: t }, i) => swatch(place(i), side, ball ? t : sky(last.sky)) + label(at(place(i), 1, [side + 8, 0.7 * side]), `× ${ball?.name ?? "the sky"}`));
      const end = isNarrow ? [420, 366] : [576, 246];
      const svg = scene + factors.join("") + label(at(place(0), 1, [0, -8]), "product", "weak") + swatch(end, 70, pixel) + label(at(end, 1, isNarrow ? [0, 92] : [80, 39]), "= pixel");
      const route = steps.map(({ ball }) => ball?.name ?? "sky").join(" → ");
      const numbers = (c) => c.map((x) => fixed(x)).join(", ");
      return [svg, `Seed ${seed}, pixel ${row + 1}: ${route}. ` + (isLit ? `Product (${numbers(throughput)}) × sky (${numbers(sky(last.sky))}) = pixel (${numbers(pixel)}).` : "Six rays, and still no sky: black.")];
    },
  },
  rows: {
    title: "Vectors one after another, and rows of components",
    size: [560, 262],
    narrow: [400, 330],
    state: { chosen: 2 },
    sliders: [slider("chosen", "Vector", 0, 7, 1)],
    draw({ chosen }, isNarrow) {
      const kinds = ["q1", "q2", "q3"], names = ["x", "y", "z"], cell = (x, y, k, i) =>
        box([x, y, 21, 24], i === chosen ? `${kinds[k]} filled` : "edge") + letter([x + 10.5, y + 17], `${names[k]}${"₀₁₂₃₄₅₆₇"[i]}`, kinds[k]);
      // A register's lanes, from left to right, and its place; on a phone, the three above are one below another.
      const above = (register) => (isNarrow ? [26, 44 + 36 * register] : [26 + 168 * register, 40]), left = isNarrow ? 44 : 110, below = isNarrow ? 206 : 138;
      const whole = range(24, (i) => cell(...at(above(Math.floor(i / 8)), 21 * (i % 8), [1, 0]), i % 3, Math.floor(i / 3)));
      const rows = range(24, (i) => cell(left + 21 * (i % 8), below + 32 * Math.floor(i / 8), Math.floor(i / 8), i % 8));
      const bracket = (x, y) => curve([[x, y + 6], [x, y], [x + 168, y], [x + 168, y + 6]], "");
      const titles = ["vectors one after another: a register holds parts of three", "rows of components: a register holds one component of eight vectors"];
      const title = (text, y) => (isNarrow ? text.split(": ") : [text]).map((line, i) => label([left - (isNarrow ? 40 : 84), y + 17 * i], line, "weak")).join("");
      const svg = whole.join("") + range(3, (i) => bracket(...at(above(i), -(isNarrow ? 7 : 10), [0, 1]))).join("") + title(titles[0], isNarrow ? 14 : 20) + rows.join("") + title(titles[1], below - (isNarrow ? 33 : 18)) +
        kinds.map((kind, k) => letter([left - 14, below + 17 + 32 * k], names[k], kind)).join("") + bracket(left, below - 6) + ["one instruction adds this row", "one this", "and one this"].map((text, k) => label([left + (isNarrow ? 176 : 190), below + 17 + 32 * k], isNarrow && k === 0 ? "one addition" : text, "weak")).join("");
      const places = range(3, (k) => { const i = 3 * chosen + k; return `lane ${i % 8} of register ${Math.floor(i / 8) + 1}`; });
      return [svg, `Vector ${chosen}: above, its components are in ${places.join(", ")}. Below, all three are in lane ${chosen}, where they can be multiplied and added at once.`];
    },
  },
  streams: {
    title: "One stream of random numbers, or numbers for each path",
    size: [560, 228],
    state: { path: 2, rays: 5 },
    sliders: [slider("path", "Path", 1, 8, 1), slider("rays", "Its rays", 1, 6, 1)],
    draw({ path, rays }) {
      // Without the change, a path has from 1 to 4 rays.
      const before = range(8, (i) => 1 + Math.floor(4 * random(i, 2))), lengths = before.map((n, i) => (i === path - 1 ? rays : n));
      const starts = lengths.map((_, i) => lengths.slice(0, i).reduce((a, b) => a + b, 0)), isOther = rays !== before[path - 1];
      const cell = (p, i, changes) => box([...p, 16, 18], i === path - 1 ? "q1 filled" : isOther && changes ? "q3 filled" : "edge");
      const row = (place, changes) => lengths.map((n, i) => range(n, (k) => cell(at(place(i), 17 * k, [1, 0]), i, changes(i))).join("") + label(at(place(i), 1, [1, 34]), i + 1, i === path - 1 ? "q1" : isOther && changes(i) ? "q3" : "weak")).join("");
      const later = isOther ? 8 - path : 0;
      const svg = label([8, 20], "the book: one stream; each path takes the next numbers", "weak") + row((i) => [8 + 17 * starts[i], 32], (i) => i >= path) +
        label([8, 112], "here: each path has its own, computed from pixel, sample and bounce", "weak") + row((i) => [8 + 136 * (i % 4), i < 4 ? 124 : 180], () => false);
      return [svg, `Path ${path} has ${rays} ${rays === 1 ? "ray" : "rays"}${isOther ? ` instead of ${before[path - 1]}` : ", as before"}. With one stream, ${later} other ${later === 1 ? "path" : "paths"} get different numbers; with numbers of their own, none.`];
    },
  },
  viewport: {
    title: "The eye, the viewport and the ray of a pixel",
    size: [560, 300],
    hint: "Drag the pixel.",
    state: { p: [385, 120] },
    handles: [{
      label: "Pixel",
      get: (s) => s.p,
      set: (s, p) => (s.p = [clamp(p[0], 264, 456), clamp(p[1], 90 + (p[0] - 360) * 0.45, 205 + (p[0] - 360) * 0.45)]),
    }],
    draw({ p }) {
      const O = [90, 165], X = [56, 26], Y = [0, -68], W = [-270, 12], place = ([x, y, z]) => at(at(at(O, x, X), y, Y), z, W);
      const w = 16 / 9, x = (p[0] - place([0, 0, -1])[0]) / X[0], y = (place([0, 0, -1])[1] + X[1] * x - p[1]) / -Y[1];
      const [i, j] = [clamp(Math.floor((x + w) * 4.5), 0, 15), clamp(Math.floor((1 - y) * 4.5), 0, 8)];
      const corner = (i, j) => place([i / 4.5 - w, 1 - j / 4.5, -1]), s = [(i + 0.5) / 4.5 - w, 1 - (j + 0.5) / 4.5], S = place([...s, -1]);
      const pane = (a, b, c, d, kind) => polygon([corner(a, b), corner(c, b), corner(c, d), corner(a, d)], kind);
      const grid = range(15, (k) => line(corner(k + 1, 0), corner(k + 1, 9), "fine")).concat(range(8, (k) => line(corner(0, k + 1), corner(16, k + 1), "fine")));
      const basis = [["u", [0.9, 0, 0], "q4"], ["v", [0, 0.9, 0], "q5"], ["w", [0, 0, 0.2], "q2"]].map(([name, end, kind]) => arrow(O, place(end), `${kind} thick`) + vector(at(place(end), 1.0, name === "v" ? [0, -7] : name === "w" ? [-10, 4] : [11, 12]), name, kind));
      const far = place([2 * s[0], 2 * s[1], -2]);
      const svg = pane(0, 0, 16, 9, "pane") + grid.join("") + pane(i, j, i + 1, j + 1, "q3 filled") + line(O, place([0, 0, -1]), "thin") + line(S, along(S, far, 0.6), "q1 thin") + arrow(O, S, "q1 thick") +
        basis.join("") + circle(O, 5, "solid") + vector(at(O, 1, [-6, 22]), "o") + vector(at(along(O, S, 0.55), 10, [0, -1]), "d", "q1") + vector(at(S, 1, [24, -14]), "s", "q3") +
        label(at(corner(16, 4.5), 1, [10, 4]), "2", "weak") + label(at(along(corner(0, 9), corner(16, 9), 0.5), 1, [6, 22]), "2 · 16/9", "weak", "middle") + label(at(along(O, place([0, 0, -1]), 0.42), 1, [0, 17]), "1", "weak", "middle");
      const length = Math.hypot(s[0], s[1], 1);
      return [svg, `16 by 9 pixels. Column i = ${i}, row j = ${j}: s = (${fixed(s[0])}, ${fixed(s[1])}), so d points to (${fixed(s[0])}, ${fixed(s[1])}, −1); with length 1 it climbs by ${fixed(s[1] / length)}.`];
    },
  },
  sphere: {
    title: "A ray and a sphere",
    size: [560, 270],
    hint: "Drag the origin and the direction. The slider moves the origin back in the arithmetic only, and shows what single precision makes of the discriminant.",
    state: { o: [60, 205], d: [190, 150], far: 0 },
    handles: [handle("Origin of the ray", "o", [10, 10, 540, 250]), handle("Direction of the ray", "d", [10, 10, 540, 250])],
    sliders: [slider("far", "Distance of the origin", 0, 4, 1, (x) => (x ? `${10 ** x} r` : "as drawn"))],
    draw({ o, d, far }) {
      const C = [350, 125], r = 95, u = unit(minus(d, o)), f = minus(C, o), h = dot(u, f), m = at(o, h, u), l = minus(C, m);
      const disc = r * r - dot(l, l), s = Math.sqrt(Math.max(disc, 0)), ts = disc < 0 ? [] : [h - s, h + s];
      const away = Math.max(10 ** far, Math.abs(h) / r), [book, ours] = lostDigits(Math.hypot(...l) / r, away);
      const side = dot([-u[1], u[0]], l) > 0 ? [u[1], -u[0]] : [-u[1], u[0]], aside = (p, by) => at(p, by, side), names = ["t₁", "t₂"];
      const measure = (a, b, by, name, kind) => line(aside(a, by), aside(b, by), `${kind} edge`) + line(aside(a, by - 4), aside(a, by + 4), kind) + line(aside(b, by - 4), aside(b, by + 4), kind) + letter(at(aside(along(a, b, 0.5), by + 11), 5, [0, 1]), name, kind);
      const chord = ts.length ? measure(m, at(o, h - s, u), 14, "s", "q3") + line(C, at(o, h + s, u), "edge") + letter(at(along(C, at(o, h + s, u), 0.5), 1, [6, -6]), "r") : "";
      const svg = ball(C, r) + line(o, at(o, -900, u), "thin") + line(o, at(o, 900, u), "q1") + line(o, C, "edge") + vector(at(along(o, C, 0.62), 1, [2, 18]), "f") + measure(o, m, 34, "h", "q4") + chord +
        line(m, C, "q5 thick") + vector(at(along(m, C, 0.5), 9, u), "l", "q5") + spot(m, "", "q4") + circle(C, 3.5, "solid") + vector(at(C, 1, [8, -8]), "C") + arrow(o, at(o, 70, u), "q1 thick") + vector(at(aside(at(o, 52, u), -12), 4, [0, 1]), "d", "q1") +
        ts.map((t, i) => circle(at(o, t, u), 4, t > 0 ? "q3 solid" : "q3 hollow") + letter(at(aside(at(o, t, u), -13), 4, [0, 1]), names[i], "q3")).join("") + vector(at(o, 1, [-16, 20]), "o");
      const roots = ts.map((t, i) => `${names[i]} = ${fixed(t / r)}${t < 0 ? " (behind)" : ""}`).join(", ");
      return [svg, `h = ${fixed(h / r)}, discriminant ${fixed(disc / r / r)}: ${disc < 0 ? "the ray misses" : roots} (in radii). ` +
        `From ${away.toFixed(1)} radii away, in single precision: book ${book.toPrecision(4)}, perpendicular ${ours.toPrecision(4)}.`.replaceAll("-", "−")];
    },
  },
  subtract: {
    title: "A difference of squares, and a square of a difference",
    size: [560, 250],
    state: { away: 2 },
    sliders: [slider("away", "Distance", 1, 4, 0.25, (x) => String(Math.round(10 ** x)))],
    draw({ away }) {
      const D = 10 ** away, [book, ours] = lostDigits(0.3, D, 0.25), gap = 2 ** (Math.floor(Math.log2(D * D)) - 23), unitPx = 70 / 0.16, step = gap * unitPx;
      const ruler = (x0, y, spacing) => {
        if (spacing < 3) return box([x0, y - 6, 250, 12], "gap");
        return range(Math.min(90, Math.floor(125 / spacing) * 2 + 1), (i) => x0 + 125 + (i - Math.floor(125 / spacing)) * spacing).map((x) => line([x, y - 7], [x, y + 7], "edge")).join("");
      };
      const span = (x0, y, name, kind) => box([x0 + 90, y - 3, 70, 6], `${kind} solid`) + label([x0 + 125, y - 14], name, kind, "middle");
      const square = (x, y, side, kind, name) => box([x, y, side, side], kind) + letter([x + side / 2, y + side / 2 + 5], name);
      const o = [310, 165], C = [492, 118], u = unit([200, -12]), h = dot(u, minus(C, o)), m = at(o, h, u);
      const svg = label([15, 18], "the book: subtract two areas", "weak") + square(15, 34, 92, "body", "h²") + square(123, 36, 90, "body", "c") + letter([115, 85], "−") + line([15, 205], [265, 205], "axis") + ruler(15, 205, step) + span(15, 205, "h² − c = 0.16", "q3") +
        label([15, 236], "ticks: floats near h²", "weak") + label([300, 18], "here: subtract two vectors", "weak") + arrow(o, m, "q1 thick") + arrow(m, C, "q5 thick") + arrow(o, C, "thick") + circle(C, 52, "edge") + circle(o, 4, "solid") + vector(at(o, 1, [-12, 5]), "o") + vector(at(C, 1, [10, -8]), "C") +
        vector(at(along(o, C, 0.5), 1, [-4, -10]), "f") + letter(at(along(o, m, 0.55), 1, [0, 18]), "h", "q4") + vector(at(along(o, m, 0.55), 1, [11, 18]), "d", "q1") + vector(at(along(m, C, 0.5), 1, [12, 6]), "l", "q5") + line([300, 205], [550, 205], "axis") + ruler(300, 205, 0) + span(300, 205, "r² − l · l = 0.16", "q3") + label([300, 236], "floats near r² lie too close to draw", "weak");
      const show = (x) => x.toPrecision(5).replace("-", "−");
      return [svg, `Distance ${D.toFixed(0)}, radius 0.5, ray 0.3 from the centre. Floats near h² = ${Math.round(D * D).toLocaleString("en")} are ${gap.toPrecision(2)} apart. In single precision: book ${show(book)}, here ${show(ours)}.`];
    },
  },
  sides: {
    title: "The normal on the ray’s side",
    size: [560, 240],
    hint: "Drag the origin, also into the ball, and the aim.",
    state: { o: [80, 75], aim: [215, 70] },
    handles: [handle("Origin of the ray", "o", [20, 15, 520, 210]), handle("Aim of the ray", "aim", [20, 15, 520, 210])],
    draw({ o, aim }) {
      const C = [310, 125], r = 85, d = unit(minus(aim, o)), t = hitOf(o, d, { c: C, r }), isInside = Math.hypot(...minus(o, C)) < r;
      if (t === Infinity) return [ball(C, r) + line(o, at(o, 900, d), "q1 thick"), "The ray misses."];
      const P = at(o, t, d), outward = at([0, 0], 1 / r, minus(P, C)), cosine = dot(d, outward), n = at([0, 0], cosine < 0 ? 1 : -1, outward);
      const svg = ball(C, r) + line(C, P, "thin") + circle(C, 3.5, "solid") + vector(at(C, 1, [-10, 14]), "C") + arrow(P, at(P, 62, outward), "edge") + (cosine < 0 ? "" : label(at(at(P, 76, outward), 4, [0, 1]), "outward", "weak", "middle")) +
        arrow(o, P, "q1 thick") + vector(at(along(o, P, 0.5), 10, [d[1], -d[0]]), "d", "q1") + arrow(P, at(P, 48, n), "q2 thick") + vector(at(at(at(P, 40, n), 13, [-n[1], n[0]]), 4, [0, 1]), "n", "q2") + circle(P, 4, "solid") + vector(at(P, 13, turned(outward, 1.2)), "P");
      return [svg, `d · outward = ${fixed(cosine)}: the ray comes from ${isInside ? "inside, so n is the outward normal, flipped" : "outside, so n is the outward normal"}. d · n = ${fixed(dot(d, n))}, never positive.`];
    },
  },
  snell: {
    title: "Refraction and reflection at a surface",
    size: [560, 290],
    hint: "Drag the ray, also from air into glass or from glass into air.",
    state: { p: [82, 62], index: 1.5 },
    handles: [{
      label: "Angle of the ray",
      get: (s) => s.p,
      set: (s, p) => {
        const v = minus(p, [170, 140]);
        s.p = at([170, 140], 118, unit([Math.min(v[0], -0.5), Math.abs(v[1]) < 1 ? 1 : v[1]]));
      },
    }],
    sliders: [slider("index", "Index of refraction", 1, 2.5, 0.05, fixed)],
    draw({ p, index }) {
      const C = [170, 140], v = minus(p, C), isInside = v[1] > 0, ratio = isInside ? index : 1 / index, side = isInside ? 1 : -1, n = [0, side];
      const sine = -v[0] / Math.hypot(...v), theta = Math.asin(sine), sine2 = ratio * sine, isTotal = sine2 > 1;
      const R = (t) => (ratio * Math.sin(t) > 1 ? 1 : schlick(Math.cos(t), index)), here = R(theta);
      const plot = (t, y) => [370 + (t / (Math.PI / 2)) * 175, 235 - 195 * y];
      const angles = range(91, (i) => (i * Math.PI) / 180), critical = Math.asin(Math.min(1, 1 / ratio));
      const reflected = [sine, side * Math.sqrt(1 - sine * sine)], refracted = isTotal ? null : [sine2, -side * Math.sqrt(1 - sine2 ** 2)];
      const ticks = [0, 0.5, 1].map((y) => line(plot(0, y), plot(Math.PI / 2, y), "fine") + label(at(plot(0, y), 1, [-7, 4]), percent(y), "weak", "end"));
      const svg = box([0, 140, 320, 150], "body plain") + line([0, 140], [320, 140], "axis") + line([170, 14], [170, 276], "thin") + label([10, 20], "air", "weak") + label([10, 280], "glass", "weak") +
        arrow(C, at(C, 62, n), "q2 thick") + vector(at(at(C, 66, n), 1, [-12, 4]), "n", "q2") + arrow(p, C, "q1 thick") + vector(at(along(p, C, 0.42), 13, [unit(v)[1], -unit(v)[0]]), "d", "q1") + angle(C, n, unit(v), 30, "θ") +
        `<g opacity="${(0.15 + 0.85 * here).toFixed(2)}">${arrow(C, at(C, 118, reflected), "q3 thick")}</g>` + label(at(at(C, 128, reflected), 1, [4, 4]), "reflected", "q3") +
        (refracted ? `<g opacity="${(1 - 0.85 * here).toFixed(2)}">${arrow(C, at(C, 118, refracted), "q4 thick")}</g>` + label(at(at(C, 128, refracted), 1, [0, 5]), "refracted", "q4") + angle(C, [0, -side], refracted, 38, "θₜ") : "") +
        ticks.join("") + line(plot(0, 0), plot(0, 1), "axis") + label([370, 22], "reflected share", "q3") + ["0°", "30°", "60°", "90°"].map((text, i) => label(at(plot((i * Math.PI) / 6, 0), 1, [0, 18]), text, "weak", "middle")).join("") + label([457, 272], "angle θ", "weak", "middle") +
        (ratio > 1 ? line(plot(critical, 0), plot(critical, 1), "thin") + label(at(plot(critical, 0.5), 1, [6, 0]), "critical", "weak") + label(at(plot(critical, 0.5), 1, [6, 15]), degrees(critical, 1), "weak") : "") +
        curve(angles.map((t) => plot(t, fresnel(Math.cos(t), ratio))), "thin") + curve(angles.map((t) => plot(t, R(t))), "q3") + spot(plot(theta, here), "", "q3");
      return [svg, `θ = ${degrees(theta)} ${isInside ? "inside glass" : "in air"}: ` + (isTotal ? "no angle on the other side, so all light is reflected." :
        `θₜ = ${degrees(Math.asin(sine2))}; Schlick reflects ${percent(here, 1)}, Fresnel ${percent(fresnel(Math.cos(theta), ratio), 1)} (dotted).`)];
    },
  },
  shell: {
    title: "A ray in a hollow ball of glass",
    size: [560, 300],
    hint: "Drag the ray up and down. The sliders change the glass.",
    state: { b: [40, 44], index: 1.5, inner: 0.8 },
    handles: [handle("Height of the ray", "b", [40, 24, 0, 125], [0, 1])],
    sliders: [slider("index", "Index of refraction", 1, 2, 0.05, fixed), slider("inner", "Inner radius", 0.4, 0.96, 0.02, (x) => `${fixed(x)} r`)],
    draw({ b, index, inner }) {
      const C = [300, 150], r = 122, q = inner * r, height = 150 - b[1], sine = height / r;
      let o = b, d = [1, 0], said = "";
      const hits = [], rays = [];
      // From surface to surface: which one, and whether the ray passes it.
      for (let i = 0; i < 7; i++) {
        const meets = [r, q].map((radius) => ({ radius, f: minus(C, o), h: dot(d, minus(C, o)) })).flatMap(({ radius, f, h }) => {
          const l2 = dot(f, f) - h * h, s = Math.sqrt(radius * radius - l2);
          return Number.isNaN(s) ? [] : [h - s, h + s].map((t) => ({ t, radius }));
        }).filter(({ t }) => t > 1e-3).sort((a, b) => a.t - b.t);
        if (!meets.length) break;
        const { t, radius } = meets[0], p = at(o, t, d), out = at([0, 0], 1 / radius, minus(p, C)), isOut = dot(d, out) > 0, n = at([0, 0], isOut ? -1 : 1, out);
        const eta = isOut === (radius === q) ? 1 / index : index, cosine = -dot(d, n), sine2 = eta * eta * (1 - cosine * cosine);
        rays.push([o, p]);
        hits.push({ p, n, d, cosine, radius, isTotal: sine2 > 1 });
        d = sine2 > 1 ? at(d, 2 * cosine, n) : at(at([0, 0], eta, d), eta * cosine - Math.sqrt(1 - sine2), n);
        o = p;
      }
      rays.push([o, at(o, 330, d)]);
      const mark = ({ p, n, d }, text) => arrow(p, at(p, 44, n), "q2") + angle(p, at([0, 0], -1, d), n, 26, text);
      const atAir = hits.find(({ radius }) => radius === q), isTotal = atAir?.isTotal, critical = Math.asin(1 / index);
      const svg = circle(C, r, "body") + circle(C, q, "cavity") + line([10, 150], [550, 150], "thin") + line([C[0], 150 - q], [545, 150 - q], "thin") + circle(C, 3.5, "solid") + vector(at(C, 1, [0, 18]), "C") +
        line(C, at(C, r, unit([-0.5, 1])), "edge") + letter(at(at(C, 0.62 * r, unit([-0.5, 1])), 1, [-10, 2]), "r") + line(C, at(C, q, unit([0.5, 1])), "edge") + letter(at(at(C, 0.6 * q, unit([0.5, 1])), 1, [11, 2]), "q") +
        line([62, 150], [62, b[1]], "q4") + letter([52, (150 + b[1]) / 2 + 5], "b", "q4") + rays.map(([a, p], i) => (i + 1 === rays.length ? arrow(a, p, "q1 thick") : line(a, p, "q1 thick"))).join("") + (hits.length ? mark(hits[0], "θ") : "") + (atAir ? mark(atAir, "") : "") +
        hits.map(({ p, isTotal }) => circle(p, 4, isTotal ? "q3 solid" : "solid")).join("") + label([545, 143 - q], "b = q", "weak", "end") + label([C[0], 145 + r], "glass", "weak", "middle") + label([C[0], 140 + q], "air", "weak", "middle");
      if (atAir) said = `, the air at ${degrees(Math.acos(atAir.cosine))} (critical ${index > 1 ? degrees(critical, 1) : "never"}): ${isTotal ? "total reflection" : "it goes through"}`;
      return [svg, `b = ${fixed(sine)} r: the ray meets the glass at θ = ${degrees(Math.asin(Math.min(1, Math.abs(sine))))}${said || ", and misses the air"}. Alone, the ball of air would be ${Math.abs(height) < q ? "hit" : "missed"}.`];
    },
  },
  basis: {
    title: "The camera’s three directions",
    size: [560, 300],
    hint: "Drag the eye.",
    state: { eye: [130, 95], vfov: 30 },
    handles: [handle("Position of the eye", "eye", [40, 40, 250, 150])],
    sliders: [slider("vfov", "Field of view", 10, 90, 5, (x) => `${x}°`)],
    draw({ eye, vfov }) {
      // An oblique view: x to the right, y up, z towards the reader.
      const place = ([x, y, z]) => [400 + 62 * x - 42 * z, 195 - 62 * y + 36 * z];
      const from = [(eye[0] - 400 + 42) / 62, (195 + 36 - eye[1]) / 62, 1], dot3 = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0), scaled = (a, s) => a.map((x) => x * s);
      const plus = (a, b) => a.map((x, k) => x + b[k]), one = (a) => scaled(a, 1 / (Math.hypot(...a) || 1)), cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
      const w = one(from), u = one(cross([0, 1, 0], w)), v = cross(w, u), E = place(from), A = place([0, 0, 0]);
      const half = Math.tan((vfov * Math.PI) / 360), away = 0.42 * Math.hypot(...from), corner = (a, b) => place(plus(from, scaled(plus(plus(scaled(u, a * half * 16 / 9), scaled(v, b * half)), scaled(w, -1)), away)));
      const pane = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)], middle = (b) => corner(0, b);
      const axis = (d, name, kind, length = 0.95) => arrow(E, place(plus(from, scaled(d, length))), `${kind} thick`) + vector(at(place(plus(from, scaled(d, length + 0.22))), 5, [0, 1]), name, kind);
      const floor = range(7, (i) => line(place([i - 5, -0.5, -1]), place([i - 5, -0.5, 2]), "fine")).concat(range(4, (i) => line(place([-5, -0.5, i - 1]), place([1, -0.5, i - 1]), "fine")));
      const svg = floor.join("") + ball(A, 31) + line(E, A, "thin") + polygon(pane, "pane") + pane.map((p) => line(E, p, "edge")).join("") + line(E, middle(1), "q3") + line(E, middle(-1), "q3") + angle(E, unit(minus(middle(1), E)), unit(minus(middle(-1), E)), 34, "", "q3") + label(at(along(middle(1), middle(-1), 0.5), 1, [8, 4]), "angle", "q3") +
        axis(w, "w", "q2") + axis(u, "u", "q4") + axis(v, "v", "q5") + line(E, place(plus(from, [0, 1.1, 0])), "thin") + label(at(place(plus(from, [0, 1.18, 0])), 1, [4, -2]), "up", "weak") + circle(E, 5, "solid") + circle(A, 3.5, "solid") + label(at(A, 1, [8, 16]), "at") + label(at(E, 1, [-16, 22]), "from", "", "end");
      const show = (a) => `(${a.map((x) => fixed(x)).join(", ")})`;
      return [svg, `from − at = ${show(from)}. w = ${show(w)}, u = ${show(u)}, v = ${show(v)}. Half the viewport’s height is tan ${vfov / 2}° = ${fixed(half)}. u · w = ${fixed(dot3(u, w))}.`];
    },
  },
  floats: {
    title: "The spacing of floating-point numbers",
    size: [560, 150],
    hint: "Drag the number. The slider multiplies it.",
    state: { p: [245, 60], scale: 3 },
    handles: [handle("Number", "p", [45, 60, 485, 0])],
    sliders: [slider("scale", "Times", -3, 8, 1, (x) => (x < 0 ? `1/${10 ** -x}` : `${(10 ** x).toLocaleString("en")}`))],
    draw({ p, scale }) {
      const place = (x) => 30 + 31.25 * x, x = (p[0] - 30) / 31.25, octaves = [0.5, 1, 2, 4, 8];
      const numbers = octaves.flatMap((low) => range(8, (i) => low * (1 + i / 8))).concat(16), nearest = numbers.reduce((a, b) => (Math.abs(b - x) < Math.abs(a - x) ? b : a));
      const gap = 2 ** (Math.floor(Math.log2(x)) - 3), value = x * 10 ** scale, ulp = 2 ** (Math.floor(Math.log2(value)) - 23);
      const tints = octaves.map((low, i) => box([place(low), 78, place(2 * low) - place(low), 30], i % 2 ? "body plain" : "gap")), arrowDown = arrow([p[0], 66], [place(nearest), 82], "q3 thick");
      const svg = tints.join("") + numbers.map((n) => line([place(n), 78], [place(n), 108], n === nearest ? "q3 thick" : "edge")).join("") + line([30, 108], [545, 108], "axis") + [1, 2, 4, 8, 16].map((n) => label([place(n), 126], n, "weak", "middle")).join("") + arrowDown + letter([p[0], 42], "x", "q3");
      const show = (n) => (n >= 1e6 || n < 1e-3 ? n.toPrecision(3).replace("e+", " × 10^").replace("e-", " × 10^−") : Number(n.toPrecision(4)).toLocaleString("en", { maximumSignificantDigits: 4 }));
      return [svg, `With 3 bits, x = ${fixed(x)} rounds to ${nearest}, and neighbours are ${gap} apart. In single precision, near ${show(value)}, they are ${show(ulp)} apart.`];
    },
  },
  lens: {
    title: "A thin lens",
    size: [560, 260],
    hint: "Drag the plane in focus, the point and the rim of the lens.",
    state: { focus: [310, 24], z: [430, 125], a: [50, 75] },
    handles: [
      handle("Focus distance", "focus", [150, 24, 390, 0]), handle("Distance of the point", "z", [150, 125, 390, 0]), handle("Radius of the lens", "a", [50, 45, 0, 72]),
    ],
    draw({ focus, z, a }) {
      const [F, Z, A] = [focus[0] - 50, z[0] - 50, 125 - a[1]], blur = A * Math.abs(1 - Z / F), unitPx = 70, onViewport = A * Math.abs(1 / F - 1 / Z) * unitPx;
      const starts = [-1, -0.5, 0, 0.5, 1].map((x) => [50, 125 + x * A]), rays = starts.map((o) => line(o, at(o, Math.max(Z, F) / F, minus([50 + F, 125], o)), "q1")).join("");
      const measure = (y, x, name, kind) => line([50, y], [x, y], `${kind} edge`) + line([x, y - 4], [x, y + 4], kind) + letter([(50 + x) / 2, y - 5], name, kind);
      const svg = line([50, 125], [550, 125], "thin") + line([50 + unitPx, 60], [50 + unitPx, 190], "pane") + label([50 + unitPx, 52], "viewport", "weak", "middle") + line([focus[0], 24], [focus[0], 205], "q5 edge") + label([focus[0] + 24, 29], "plane in focus", "q5") +
        rays + `<ellipse cx="50" cy="125" rx="${round(4 + A / 14)}" ry="${round(A)}" class="q4 filled"/>` + letter([30, 129 - A / 2], "Fτ", "q4", "end") + label([36, 134 + A / 2], "lens", "q4", "end") + line([z[0], 125 - blur], [z[0], 125 + blur], "q3 thick") + label([z[0] + 12, 120 - blur], "disk", "q3") +
        line([50 + unitPx, 125 - onViewport], [50 + unitPx, 125 + onViewport], "q3 thick") + measure(225, focus[0], "F", "q5") + measure(250, z[0], "z", "q3") + measure(205, 50 + unitPx, "1", "");
      const share = Math.abs(1 - F / Z);
      return [svg, `τ = ${fixed(A / F)}, so the lens has radius Fτ = ${fixed(A / F)} F, and z = ${fixed(Z / F)} F. There the rays fill a disk of ${fixed(blur / A)} Fτ; on the viewport it is τ |1 − F/z| = ${fixed(share)} τ. ${blur < 1 ? "The point is in focus." : ""}`];
    },
  },
  cosine: {
    title: "Uniform and cosine-weighted directions",
    size: [560, 255],
    hint: "Drag the end of the sum.",
    state: { p: [476, 73], count: 200 },
    handles: [{
      label: "Angle of the sum",
      get: (s) => s.p,
      set: (s, p) => {
        const v = unit(minus(p, [420, 130]));
        s.p = at([420, 130], 80, [Math.max(v[0], 0.02), v[1]]);
      },
    }],
    sliders: [slider("count", "Directions", 1, 600, 1)],
    draw({ p, count }) {
      const P = [420, 210], theta = Math.atan2(p[0] - P[0], P[1] - p[1]), share = [0, 0];
      const dots = range(count, (i) => {
        const [u0, u1] = [random(2 * i, 1), random(2 * i + 1, 1)], y = 1 - 2 * u0, rho = Math.sqrt(1 - y * y) * Math.cos(2 * Math.PI * u1);
        const sum = [rho, 1 + y], depth = Math.sqrt(1 - y * y) * Math.sin(2 * Math.PI * u1), length = Math.hypot(rho, 1 + y, depth) || 1;
        share[0] += Math.abs(y) >= Math.cos(theta);
        share[1] += sum[1] / length >= Math.cos(theta);
        return circle([140 + 110 * rho * 1, 210 - 110 * Math.abs(y)], 1.6, "q4 solid") + circle([420 + (80 * sum[0]) , 210 - 80 * sum[1]], 1.6, "q2 solid");
      });
      const wedge = (O, r) => [-1, 1].map((side) => line(O, at(O, r, [side * Math.sin(theta), -Math.cos(theta)]), "thin")).join("");
      const svg = line([10, 210], [270, 210], "axis") + line([300, 210], [540, 210], "axis") + circle([420, 130], 80, "body") + dots.join("") + wedge([140, 210], 110) + wedge(P, 165) +
        arrow([140, 210], [140, 100], "q2 thick") + arrow(P, [420, 130], "q2 thick") + arrow([420, 130], p, "q4 thick") + line(P, p, "q1 thick") +
        vector([408, 178], "n", "q2") + vector(at(p, 1, [12, -4]), "n + u", "q1", "start") + vector(at(along([420, 130], p, 0.5), 1, [11, 8]), "u", "q4") + angle(P, [0, -1], unit(minus(p, P)), 52, "θ") + angle([420, 130], [0, -1], unit(minus(p, [420, 130])), 26, "2θ") + label([140, 240], "uniform over the hemisphere", "weak", "middle") + label([420, 240], "the normal plus a unit vector", "weak", "middle");
      return [svg, `Within θ = ${degrees(theta)} of the normal: uniform ${percent(1 - Math.cos(theta))} (counted ${percent(share[0] / count)}), cosine sin²θ = ${percent(Math.sin(theta) ** 2)} (counted ${percent(share[1] / count)}).`];
    },
  },
  path: {
    title: "A path and its throughput",
    size: [560, 300],
    hint: "Drag the aim of the camera ray, and change the random numbers.",
    state: { aim: [160, 140], rays: 6, seed: 3 },
    handles: [handle("Aim of the camera ray", "aim", [60, 20, 480, 225])],
    sliders: [slider("rays", "Rays per path", 1, 8, 1), slider("seed", "Random numbers", 1, 30, 1)],
    draw(s) {
      const { steps, throughput, isLit } = walk([30, 120], s.aim, s.rays, s.seed, ROOM), products = steps.flatMap(({ throughput: t }) => (t ? [t] : []));
      const balls = ROOM.map(({ c, r, colour }) => `<circle cx="${c[0]}" cy="${c[1]}" r="${r}" class="plain" style="fill:${rgb(colour)}"/>` + (r < 100 ? circle(at(c, 0.36 * r, [-0.6, -0.8]), 0.42 * r, "shine") : ""));
      const rays = steps.map(({ o, p, n }) => arrow(o, n ? p : at(o, 90, unit(minus(p, o))), "q1 thick") + (n ? arrow(p, at(p, 26, n), "q2") + circle(p, 3.5, "solid") : label(at(at(o, 100, unit(minus(p, o))), 1, [4, 0]), "sky", "weak")));
      const shown = isLit ? products : [...products, [0, 0, 0]], swatches = shown.map((t, i) => box([70 + 52 * i, 262, 30, 30], "swatch", `style="fill:${rgb(t)}"`) + (i ? label([61 + 52 * i, 282], "→", "weak", "middle") : ""));
      const svg = `<svg x="0" y="0" width="560" height="252" viewBox="0 0 560 252">${balls.join("")}${rays.join("")}${circle([30, 120], 6, "solid")}${label([12, 145], "eye")}</svg>` + label([8, 282], "product", "weak") + swatches.join("") + label([70 + 52 * shown.length, 282], isLit ? "× the sky’s light" : "cut off", "weak");
      const product = throughput.map((x) => fixed(x)).join(", "), climb = Math.atan2(120 - s.aim[1], s.aim[0] - 30);
      return [svg, `At most ${s.rays} rays, seed ${s.seed}, camera ray at ${degrees(climb, 1)}: ${steps.map(({ ball }) => ball?.name ?? "sky").join(" → ")}. ` + (isLit ? `Throughput (${product}) times the light of the sky.` : `Cut off after ${s.rays} ${s.rays === 1 ? "ray" : "rays"}: black.`)];
    },
  },
  points: {
    title: "Random points and Sobol points",
    size: [560, 290],
    state: { count: 6, cut: 3, seed: 1 },
    sliders: [slider("count", "Points", 0, 8, 1, (x) => 2 ** x), slider("cut", "Cells", 0, 6, 1, (x) => `${2 ** x} × ${2 ** (6 - x)}`), slider("seed", "Seed", 1, 30, 1)],
    draw({ count, cut, seed }) {
      const [columns, rows] = [2 ** cut, 2 ** (6 - cut)], n = 2 ** count;
      const panel = (isSobol, x0) => {
        const points = range(n, (i) => point(isSobol, i, seed)), place = ([x, y]) => [x0 + 250 * x, 12 + 250 * y];
        const hit = new Set(points.map(([x, y]) => Math.floor(x * columns) * 64 + Math.floor(y * rows)));
        const empty = range(64, (i) => [i % columns, Math.floor(i / columns)]).filter(([x, y]) => !hit.has(x * 64 + y));
        const inside = points.filter(([x, y]) => x * x + y * y < 1).length / n;
        const cells = empty.map(([x, y]) => box([...place([x / columns, y / rows]), 250 / columns, 250 / rows], "gap")).join("");
        const lines = range(columns - 1, (i) => line(place([(i + 1) / columns, 0]), place([(i + 1) / columns, 1]), "fine")).concat(range(rows - 1, (i) => line(place([0, (i + 1) / rows]), place([1, (i + 1) / rows]), "fine")));
        const arc = range(31, (i) => place([Math.sin((i * Math.PI) / 60), Math.cos((i * Math.PI) / 60)]));
        const kind = isSobol ? "q2" : "q3";
        return { empty: empty.length, error: Math.abs(4 * inside - Math.PI), svg: cells + box([x0, 12, 250, 250], "edge") + lines.join("") + curve(arc, "thin") + points.map((p) => circle(place(p), 2.6, `${kind} solid`)).join("") + label([x0 + 125, 282], isSobol ? "scrambled Sobol" : "random", kind, "middle") };
      };
      const [a, b] = [panel(false, 15), panel(true, 295)];
      return [a.svg + b.svg, `Empty cells of 64: random ${a.empty}, Sobol ${b.empty}. The share of points inside the quarter circle estimates π: random is off by ${a.error.toFixed(3)}, Sobol by ${b.error.toFixed(3)}.`];
    },
  },
  error: {
    title: "Error against samples",
    size: [560, 245],
    state: { count: 4 },
    sliders: [slider("count", "Samples per pixel", 0, 10, 1, (x) => 2 ** x)],
    draw({ count }) {
      const PIXELS = 24, plot = (k, e) => [60 + 22 * k, 30 - 40 * Math.log2(e * 2) * 0.45];
      // Each pixel is crossed by an edge and half covered.
      const pixels = (isSobol, n) => range(PIXELS, (i) => range(n, (k) => point(isSobol, k, i + 40)).filter(([x, y]) => x + 0.7 * y < 0.85).length / n);
      const rmse = (isSobol, k) => Math.sqrt(pixels(isSobol, 2 ** k).reduce((sum, x) => sum + (x - 0.5) ** 2, 0) / PIXELS);
      const kinds = [[false, "q3", "random", 60], [true, "q2", "Sobol", 150]];
      const rows = kinds.map(([isSobol, kind, name, y]) => label([340, y - 6], name, kind) + pixels(isSobol, 2 ** count).map((x, i) => box([340 + 17 * (i % 12), y + 17 * Math.floor(i / 12), 17, 17], "plain", `style="fill:${rgb([x, x, x])}"`)).join(""));
      const curves = kinds.map(([isSobol, kind, name]) => curve(range(11, (k) => plot(k, Math.max(rmse(isSobol, k), 0.001))), kind) + spot(plot(count, Math.max(rmse(isSobol, count), 0.001)), "", kind));
      const ticks = [0.5, 0.1, 0.01].map((e) => line(plot(0, e), plot(10, e), "fine") + label([52, plot(0, e)[1] + 4], e, "weak", "end"));
      const svg = ticks.join("") + line(plot(0, 0.5), plot(10, 0.5 / 32), "thin") + label(at(plot(7, 0.5 / 2 ** 3.5), 1, [6, -6]), "1/√N", "weak") + curves.join("") + rows.join("") + label([60, 218], "1", "weak", "middle") + label([170, 218], "32", "weak", "middle") + label([280, 218], "1,024", "weak", "middle") + label([170, 238], "samples per pixel", "weak", "middle") + label([18, 16], "RMSE", "weak") + label([340, 24], "24 pixels on an edge", "weak");
      const said = kinds.map(([isSobol, , name]) => `${name} ${rmse(isSobol, count).toFixed(4)}`).join(", ");
      return [svg, `24 pixels, each half covered by an edge, with ${2 ** count} samples. RMSE: ${said}; the law of the square root says ${(0.5 / Math.sqrt(2 ** count)).toFixed(4)}.`];
    },
  },
  select: {
    title: "Mask and select on eight lanes",
    size: [560, 280],
    state: Object.fromEntries(range(8, (i) => [`t${i}`, [104 + 58 * i, 40 + 110 * random(i, 9)]])),
    hint: "Drag the orange bars.",
    handles: range(8, (i) => handle(`t in lane ${i}`, `t${i}`, [104 + 58 * i, 20, 0, 140])),
    draw(s) {
      const lanes = range(8, (i) => ({ x: 92 + 58 * i, t: (160 - s[`t${i}`][1]) / 20, nearest: 2 + 4 * random(i, 12) }));
      const row = (y, name, kind, show) => label([64, y], name, kind, "end") + lanes.map((lane) => label([lane.x, y], show(lane), kind, "middle")).join("");
      const bars = lanes.map(({ x, t, nearest }) => box([x - 21, 160 - 20 * nearest, 17, 20 * nearest], "q4 solid") + box([x + 4, 160 - 20 * t, 17, 20 * t], "q3 solid") + line([x, 160], [x, 20], "fine"));
      const less = ({ t, nearest }) => t < nearest;
      const cells = lanes.filter(less).map(({ x }) => box([x - 26, 211, 52, 20], "on"));
      const svg = bars.join("") + cells.join("") + line([10, 160], [550, 160], "axis") + row(182, "nearest", "q4", (lane) => lane.nearest.toFixed(1)) + row(203, "t", "q3", (lane) => lane.t.toFixed(1)) +
        row(226, "mask", "", (lane) => (less(lane) ? "true" : "false")) + row(252, "select", "", (lane) => Math.min(lane.t, lane.nearest).toFixed(1));
      const taken = lanes.filter(less).length;
      return [svg, `t < nearest in ${taken} of 8 lanes; the nearest are now ${lanes.map(({ t, nearest }) => Math.min(t, nearest).toFixed(2)).join(", ")}. One compare gives all eight answers, and one select takes t there and keeps nearest elsewhere. No lane branched.`];
    },
  },
  fuzz: {
    title: "Fuzzy reflection",
    size: [560, 290],
    hint: "Drag the incoming ray, and change the fuzz.",
    state: { p: [140, 150], fuzz: 0.5 },
    handles: [{
      label: "Incoming ray",
      get: (s) => s.p,
      set: (s, p) => {
        const v = minus(p, [280, 220]);
        s.p = at([280, 220], 156, unit([Math.min(v[0], -1), Math.min(v[1], -1)]));
      },
    }],
    sliders: [slider("fuzz", "Fuzz", 0, 1, 0.05, fixed)],
    draw({ p, fuzz }) {
      const P = [280, 220], d = unit(minus(P, p)), cosine = d[1], mirror = at(P, 100, [d[0], -d[1]]), r = 100 * fuzz;
      const lost = fuzz > 0 ? Math.max(0, (fuzz - cosine) / (2 * fuzz)) : 0;
      const rays = range(24, (i) => at(mirror, r, [Math.cos((i * Math.PI) / 12), Math.sin((i * Math.PI) / 12)])).map((end) => line(P, end, end[1] < 220 ? "q4 faint" : "q3 faint"));
      const svg = box([0, 220, 560, 70], "body plain") + line([0, 220], [560, 220], "axis") + label([12, 278], "metal", "weak") + rays.join("") + arrow(p, P, "q1 thick") + vector(at(along(p, P, 0.5), 13, [d[1], -d[0]]), "d", "q1") + arrow(P, at(P, 100, [0, -1]), "q2 thick") + vector([268, 130], "n", "q2") +
        angle(P, [0, -1], unit(minus(p, P)), 40, "θ") + arrow(P, mirror, "thick") + vector(at(along(P, mirror, 0.62), 12, [-d[1], -d[0]]), "r") + circle(mirror, r, "q4") + line(mirror, at(mirror, r, [Math.SQRT1_2, -Math.SQRT1_2]), "q4") + letter(at(at(mirror, 0.6 * r, [Math.SQRT1_2, -Math.SQRT1_2]), 1, [9, 8]), "f", "q4");
      return [svg, `At θ = ${degrees(Math.acos(cosine))} with fuzz f = ${fixed(fuzz)}, ${percent(lost, 1)} of the paths point into the metal and are absorbed.`];
    },
  },
  hierarchy: {
    title: "A packet in a hierarchy of boxes",
    size: [720, 290],
    narrow: [600, 470],
    hint: "Drag the rays, and change their spread.",
    state: { o: [30, 150], aim: [330, 130], spread: 0.25 },
    handles: [handle("Origin of the rays", "o", [10, 20, 100, 250]), handle("Direction of the rays", "aim", [160, 20, 380, 250])],
    sliders: [slider("spread", "Spread of the rays", 0, 1, 0.05, fixed)],
    draw({ o, aim, spread }, isNarrow) {
      const middle = Math.atan2(aim[1] - o[1], aim[0] - o[0]);
      const rays = range(8, (i) => middle + spread * (i / 7 - 0.5)).map((a) => [Math.cos(a), Math.sin(a)]);
      const visits = [], tested = new Set(), nearest = rays.map(() => 560);
      const visit = (node) => {
        const mask = rays.map((d, i) => entry(o, d, node.bounds) < nearest[i]);
        if (!mask.some(Boolean)) return;
        visits.push({ node, mask });
        for (const item of node.items) {
          tested.add(item);
          rays.forEach((d, i) => (nearest[i] = Math.min(nearest[i], hitOf(o, d, item))));
        }
        const first = (child) => Math.min(...rays.map((d) => entry(o, d, child.bounds)));
        [...node.children].sort((a, b) => first(a) - first(b)).forEach(visit);
      };
      visit(TREE);
      const drawn = (node, depth = 0) => {
        const place = visits.findIndex((visit) => visit.node === node), [x, y] = node.bounds;
        const frame = box(node.bounds, place < 0 ? "fine" : "q4", `style="stroke-opacity:${place < 0 ? 0.25 : 0.35 + 0.13 * depth};stroke-width:${Math.max(0.8, 2.6 - 0.4 * depth)}"`);
        return frame + (place < 0 ? "" : label([x + 3 + 13 * (depth % 2), y + 10], place + 1, "q4 small")) + node.children.map((child) => drawn(child, depth + 1)).join("");
      };
      const ends = rays.map((d, i) => at(o, nearest[i], d));
      // A row of squares for each box, or a column below the drawing.
      const step = isNarrow ? Math.min(24, 584 / visits.length) : 8.5, isNumbered = visits.length < 30;
      const square = (row, i) => (isNarrow ? [8 + step * row, 326 + 17 * i, 0.75 * step, 14] : [622 + 11 * i, 26 + step * row, 9, 6.5]);
      const number = (row) => (isNarrow ? label([8 + step * (row + 0.37), 318], row + 1, "q4 small", "middle") : label([616, 33 + step * row], row + 1, "q4 small", "end"));
      const rows = visits.map(({ mask }, row) => (isNumbered ? number(row) : "") + mask.map((isIn, i) => box(square(row, i), isIn ? "q1 solid" : "edge")).join(""));
      const svg = drawn(TREE) + SPHERES.map((ball) => circle(ball.c, ball.r, tested.has(ball) ? "q3" : "body")).join("") + ends.map((end) => line(o, end, "q1")).join("") + (isNarrow ? label([8, 298], "visited boxes", "weak") : label([710, 18], "visited boxes", "weak", "end")) + rows.join("");
      const mean = visits.reduce((sum, { mask }) => sum + mask.filter(Boolean).length, 0) / (visits.length || 1);
      return [svg, `The packet opens ${visits.length} boxes, and on average ${mean.toFixed(1)} of its 8 rays are in one. It tests ${tested.size} of ${SPHERES.length} balls.`];
    },
  },
};

const NS = "http://www.w3.org/2000/svg";

// A row below a diagram with a slider.
function sliderRow({ key, label, min, max, step, show }, state, changed) {
  const row = document.createElement("label"), input = document.createElement("input"), output = document.createElement("output");
  Object.assign(input, { type: "range", min, max, step });
  input.value = state[key];
  input.oninput = () => {
    state[key] = Number(input.value);
    output.textContent = show(state[key]);
    changed();
  };
  output.textContent = show(state[key]);
  row.append(label, input, output);
  return row;
}

const isPhone = typeof matchMedia === "undefined" ? { matches: false } : matchMedia("(max-width: 40rem)");

function start(figure, { size, narrow, state, hint = "", handles = [], sliders = [], draw }) {
  const svg = figure.querySelector("svg"), layer = svg.querySelector("g");
  const controls = document.createElement("div"), reading = document.createElement("p");
  controls.className = "diagram-controls";
  reading.className = "reading";
  svg.setAttribute("role", "group");
  figure.classList.add("moves");
  const knobs = handles.map((handle) => {
    const knob = svg.appendChild(document.createElementNS(NS, "circle"));
    const attributes = { r: 9, class: "knob", tabindex: 0, role: "slider", "aria-label": handle.label, "aria-valuemin": 0, "aria-valuemax": 1000 };
    for (const [key, value] of Object.entries(attributes)) knob.setAttribute(key, value);
    const move = (p) => {
      handle.set(state, p);
      show();
    };
    knob.onpointerdown = (event) => knob.setPointerCapture(event.pointerId);
    knob.onpointermove = (event) => {
      if (!knob.hasPointerCapture(event.pointerId)) return;
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      move([p.x, p.y]);
    };
    knob.onkeydown = (event) => {
      const step = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5] }[event.key];
      if (!step) return;
      event.preventDefault();
      move(at(handle.get(state), 1, step));
    };
    return () => {
      const [x, y] = handle.get(state);
      knob.setAttribute("cx", x);
      knob.setAttribute("cy", y);
      knob.setAttribute("aria-valuenow", Math.round(x + y));
      knob.setAttribute("aria-valuetext", reading.textContent);
    };
  });
  function show() {
    const isNarrow = narrow && isPhone.matches, [shapes, words] = draw(state, isNarrow);
    svg.setAttribute("viewBox", `0 0 ${(isNarrow ? narrow : size).join(" ")}`);
    layer.innerHTML = shapes;
    reading.textContent = words;
    knobs.forEach((knob) => knob());
  }
  const told = Object.assign(document.createElement("p"), { className: "hint", textContent: hint });
  controls.append(...(hint ? [told] : []), ...sliders.map((slider) => sliderRow(slider, state, show)), reading);
  figure.querySelector(".scroll").after(controls);
  if (narrow) isPhone.addEventListener("change", show);
  show();
}

// The lanes that work at a step, from the drawings that the page holds.
function startTimeline(figure) {
  const drawings = [...figure.querySelectorAll("svg")].map((svg) => {
    const boxes = [...svg.querySelectorAll("path:not(.waits)")].flatMap((path) => [...path.getAttribute("d").matchAll(/M([\d.]+) ([\d.]+)h([\d.]+)/g)]);
    const starts = boxes.map((box) => Number(box[1]));
    const cursor = svg.appendChild(document.createElementNS(NS, "line"));
    Object.entries({ class: "cursor", y1: -3, y2: 83 }).forEach(([key, value]) => cursor.setAttribute(key, value));
    return { starts, cursor };
  });
  const all = [...new Set(drawings.flatMap(({ starts }) => starts))].sort((a, b) => a - b);
  const controls = document.createElement("div"), reading = document.createElement("p"), state = { step: 8 };
  controls.className = "diagram-controls";
  reading.className = "reading";
  const show = () => {
    const x = all[state.step - 1];
    const counts = drawings.map(({ starts, cursor }) => {
      cursor.setAttribute("x1", x + 2);
      cursor.setAttribute("x2", x + 2);
      return starts.filter((start) => start === x).length;
    });
    reading.textContent = `Step ${state.step}: ${counts[0]} of 8 lanes work without refill, ${counts[1]} with it.`;
  };
  controls.append(sliderRow(slider("step", "Step", 1, all.length, 1), state, show), reading);
  figure.querySelector("figcaption").before(controls);
  show();
}

if (typeof document !== "undefined") {
  // Each starts when the reader comes near.
  const watcher = new IntersectionObserver((entries) => {
    for (const { target } of entries.filter((entry) => entry.isIntersecting)) {
      watcher.unobserve(target);
      if (target.matches(".timeline")) startTimeline(target);
      else start(target, diagrams[target.id.replace("diagram-", "")]);
    }
  }, { rootMargin: "1000px" });
  const moving = [...document.querySelectorAll(".diagram")].filter(({ id }) => id.replace("diagram-", "") in diagrams);
  [...moving, ...document.querySelectorAll(".timeline")].forEach((figure) => watcher.observe(figure));
}
