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
const percent = (x, digits = 0) => `${(100 * x).toFixed(digits)} %`;
const degrees = (x) => `${((180 * x) / Math.PI).toFixed(0)}°`;

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

const ROOM = [
  { c: [230, 185], r: 55, colour: [0.35, 0.5, 0.9], name: "matte blue" },
  { c: [370, 195], r: 45, colour: [0.85, 0.65, 0.3], isMetal: true, name: "gold" },
  { c: [300, 10240], r: 10000, colour: [0.8, 0.8, 0.3], name: "ground" },
];
function walk({ aim, rays, seed }) {
  let o = [30, 120], d = unit(minus(aim, o)), throughput = [1, 1, 1];
  const steps = [];
  for (let i = 0; i < rays; i++) {
    const hits = ROOM.map((ball) => hitOf(o, d, ball)), t = Math.min(...hits), ball = ROOM[hits.indexOf(t)];
    if (t === Infinity) return { steps: [...steps, { o, p: at(o, 700, d) }], throughput, isLit: true };
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
function lostDigits(l, distance) {
  const dot3 = (a, b) => single(single(a[0] * b[0]) + single(single(a[1] * b[1]) + single(a[2] * b[2])));
  const d = [1, 2, -2].map((x) => single(x / 3)), f = d.map((x, i) => single(distance * x + (l * [2, 1, 2][i]) / 3));
  const h = dot3(d, f), across = f.map((x, i) => single(x - single(h * d[i])));
  return [single(single(h * h) - single(dot3(d, d) * single(dot3(f, f) - 1))), single(1 - dot3(across, across))];
}

const handle = (name, key, area, axis = [1, 1]) => ({
  label: name,
  get: (s) => s[key],
  set: (s, p) => (s[key] = within(at(s[key], 1, minus(p, s[key]).map((x, k) => x * axis[k])), area)),
});
const slider = (key, label, min, max, step, show = String) => ({ key, label, min, max, step, show });

export const diagrams = {
  sphere: {
    title: "A ray and a sphere",
    size: [560, 260],
    state: { o: [50, 200], d: [190, 135], far: 0 },
    handles: [handle("Origin of the ray", "o", [10, 10, 540, 240]), handle("Direction of the ray", "d", [10, 10, 540, 240])],
    sliders: [slider("far", "Distance of the origin", 0, 4, 1, (x) => (x ? `${10 ** x} r` : "as drawn"))],
    draw({ o, d, far }) {
      const C = [330, 120], r = 85, u = unit(minus(d, o)), f = minus(C, o), h = dot(u, f), m = at(o, h, u), l = minus(C, m);
      const disc = r * r - dot(l, l), s = Math.sqrt(Math.max(disc, 0)), ts = disc < 0 ? [] : [h - s, h + s];
      const away = Math.max(10 ** far, Math.abs(h) / r), [book, ours] = lostDigits(Math.hypot(...l) / r, away);
      const svg = circle(C, r, "body") + line(o, at(o, 900, u), "q1") + arrow(o, at(o, 60, u), "q1 thick") + line(o, C, "thin") +
        line(m, C, "q5 thick") + label(at(m, 0.5, l), "l", "q5") + spot(m, "", "q4") + spot(C, "C", "") + label(at(o, 75, u), "d", "q1") +
        label(at(at(o, h / 2, u), 16, [-u[1], u[0]]), "h", "q4") + ts.map((t, i) => spot(at(o, t, u), `t${"₁₂"[i]}`, t > 0 ? "q3" : "q3 hollow")).join("");
      const roots = ts.map((t, i) => `t${"₁₂"[i]} = ${(t / r).toFixed(2)}${t < 0 ? " (behind)" : ""}`).join(", ");
      return [svg, `h = ${(h / r).toFixed(2)}, discriminant ${(disc / r / r).toFixed(2)}: ${disc < 0 ? "the ray misses" : roots} (in radii). ` +
        `From ${away.toFixed(0)} radii away, in single precision: book ${book.toPrecision(4)}, perpendicular ${ours.toPrecision(4)}.`];
    },
  },
  snell: {
    title: "Refraction and reflection at a surface",
    size: [560, 280],
    state: { p: [90, 50], index: 1.5 },
    handles: [{
      label: "Angle of the ray",
      get: (s) => s.p,
      set: (s, p) => {
        const v = minus(p, [180, 140]);
        s.p = at([180, 140], 125, unit([Math.min(v[0], -0.5), Math.abs(v[1]) < 1 ? 1 : v[1]]));
      },
    }],
    sliders: [slider("index", "Index of refraction", 1, 2.5, 0.05, (x) => x.toFixed(2))],
    draw({ p, index }) {
      const C = [180, 140], v = minus(p, C), isInside = v[1] > 0, ratio = isInside ? index : 1 / index, side = isInside ? 1 : -1;
      const sine = -v[0] / Math.hypot(...v), theta = Math.asin(sine), sine2 = ratio * sine, isTotal = sine2 > 1;
      const R = (t) => (ratio * Math.sin(t) > 1 ? 1 : schlick(Math.cos(t), index)), here = R(theta);
      const plot = (t, y) => [350 + (t / (Math.PI / 2)) * 190, 240 - 200 * y];
      const angles = range(91, (i) => (i * Math.PI) / 180), critical = Math.asin(Math.min(1, 1 / ratio));
      const svg = box([0, 140, 330, 140], "body") + line([180, 8], [180, 272], "thin") + label([10, 20], "air", "weak") + label([10, 270], "glass", "weak") +
        arrow(p, C, "q1 thick") + line(C, at(C, 125, [sine, side * Math.sqrt(1 - sine * sine)]), "q3 thick", `opacity="${(0.15 + 0.85 * here).toFixed(2)}"`) +
        (isTotal ? "" : line(C, at(C, 125, [sine2, -side * Math.sqrt(1 - sine2 ** 2)]), "q2 thick", `opacity="${(1 - 0.85 * here).toFixed(2)}"`)) +
        line(plot(0, 0), plot(Math.PI / 2, 0), "axis") + line(plot(0, 0), plot(0, 1), "axis") + label([350, 28], "reflected", "q3") + label([540, 258], "90°", "weak", "end") +
        (ratio > 1 ? line(plot(critical, 0), plot(critical, 1), "thin") + label(at(plot(critical, 1), 1, [4, 0]), `critical ${degrees(critical)}`, "weak") : "") +
        curve(angles.map((t) => plot(t, fresnel(Math.cos(t), ratio))), "thin") + curve(angles.map((t) => plot(t, R(t))), "q3") + spot(plot(theta, here), "", "q3");
      return [svg, `${degrees(theta)} ${isInside ? "inside glass" : "in air"}: ` + (isTotal ? "no angle on the other side, so all light is reflected." :
        `refracted to ${degrees(Math.asin(sine2))}; Schlick reflects ${percent(here, 1)}, Fresnel ${percent(fresnel(Math.cos(theta), ratio), 1)} (dotted).`)];
    },
  },
  lens: {
    title: "A thin lens",
    size: [560, 240],
    state: { focus: [310, 20], z: [430, 120], a: [40, 75] },
    handles: [
      handle("Focus distance", "focus", [80, 20, 460, 0]), handle("Distance of the point", "z", [80, 120, 460, 0]), handle("Radius of the lens", "a", [40, 35, 0, 85]),
    ],
    draw({ focus, z, a }) {
      const [F, Z, A] = [focus[0] - 40, z[0] - 40, 120 - a[1]], blur = A * Math.abs(1 - Z / F);
      const rays = [-1, -0.5, 0, 0.5, 1].map((x) => line([40, 120 + x * A], at([40, 120 + x * A], Math.max(Z, F) / F, [F, -x * A]), "q1")).join("");
      const svg = line([focus[0], 20], [focus[0], 225], "thin") + label([focus[0] + 6, 232], "plane in focus", "weak") + line([40, 120 - A], [40, 120 + A], "q4 thick") +
        label([10, 130 + A], "lens", "q4") + rays + line([z[0], 120 - blur], [z[0], 120 + blur], "q3 thick") + label([z[0] + 8, 112 - blur], "blur", "q3");
      return [svg, `Lens radius ${(A / F).toFixed(2)} F. A point at ${(Z / F).toFixed(2)} F becomes a disk; its radius is ${percent(Math.abs(1 - F / Z))} of τ, the lens’s radius over F. ${blur < 1 ? "It is in focus." : ""}`];
    },
  },
  cosine: {
    title: "Uniform and cosine-weighted directions",
    size: [560, 270],
    state: { p: [490, 90], count: 200 },
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
        label([426, 150], "n", "q2") + label(at(p, 10, [1, 0]), "n + u", "q1") + label([140, 240], "uniform over the hemisphere", "weak", "middle") + label([420, 240], "the normal plus a unit vector", "weak", "middle");
      return [svg, `Within θ = ${degrees(theta)} of the normal: uniform ${percent(1 - Math.cos(theta))} (counted ${percent(share[0] / count)}), cosine sin²θ = ${percent(Math.sin(theta) ** 2)} (counted ${percent(share[1] / count)}).`];
    },
  },
  path: {
    title: "A path and its throughput",
    size: [560, 300],
    state: { aim: [200, 180], rays: 6, seed: 3 },
    handles: [handle("Aim of the camera ray", "aim", [60, 20, 480, 250])],
    sliders: [slider("rays", "Rays per path", 1, 8, 1), slider("seed", "Random numbers", 1, 30, 1)],
    draw(s) {
      const { steps, throughput, isLit } = walk(s), balls = ROOM.map(({ c, r, colour }) => `<circle cx="${c[0]}" cy="${c[1]}" r="${r}" style="fill:${rgb(colour)};fill-opacity:.55;stroke-opacity:.3"/>`);
      const rays = steps.map(({ o, p, n }) => line(o, p, "q1 thick") + (n ? arrow(p, at(p, 26, n), "q2") + spot(p, "", "q3") : ""));
      const swatches = steps.map(({ throughput: t }, i) => (t ? box([84 + 34 * i, 268, 28, 20], "edge", `style="fill:${rgb(t)}"`) : ""));
      const svg = `<svg x="0" y="0" width="560" height="262" viewBox="0 0 560 262">${balls.join("")}${rays.join("")}</svg>` + spot([30, 120], "eye", "") + label([8, 283], "product", "weak") + swatches.join("");
      const product = throughput.map((x) => x.toFixed(2)).join(", ");
      const climb = Math.atan2(120 - s.aim[1], s.aim[0] - 30);
      return [svg, `At most ${s.rays} rays, seed ${s.seed}, camera ray at ${((180 * climb) / Math.PI).toFixed(1)}°: ${steps.map(({ ball }) => ball?.name ?? "sky").join(" → ")}. ` + (isLit ? `Throughput (${product}) times the light of the sky.` : `Cut off after ${s.rays} ${s.rays === 1 ? "ray" : "rays"}: black.`)];
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
      return [a.svg + b.svg, `Empty cells of 64: random ${a.empty}, Sobol ${b.empty}. The points below the arc estimate π: random is off by ${a.error.toFixed(3)}, Sobol by ${b.error.toFixed(3)}.`];
    },
  },
  error: {
    title: "Error against samples",
    size: [560, 225],
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
      const svg = ticks.join("") + line(plot(0, 0.5), plot(10, 0.5 / 32), "thin") + label(at(plot(7, 0.5 / 2 ** 3.5), 1, [6, -6]), "1/√N", "weak") + curves.join("") + rows.join("") + label([60, 215], "1", "weak") + label([280, 215], "1,024 samples", "weak", "middle");
      const said = kinds.map(([isSobol, , name]) => `${name} ${rmse(isSobol, count).toFixed(4)}`).join(", ");
      return [svg, `24 pixels, each half covered by an edge, with ${2 ** count} samples. RMSE: ${said}; the law of the square root says ${(0.5 / Math.sqrt(2 ** count)).toFixed(4)}.`];
    },
  },
  select: {
    title: "Mask and select on eight lanes",
    size: [560, 280],
    state: Object.fromEntries(range(8, (i) => [`t${i}`, [92 + 58 * i, 40 + 110 * random(i, 9)]])),
    handles: range(8, (i) => handle(`t in lane ${i}`, `t${i}`, [92 + 58 * i, 20, 0, 140])),
    draw(s) {
      const lanes = range(8, (i) => ({ x: 92 + 58 * i, t: (160 - s[`t${i}`][1]) / 20, nearest: 2 + 4 * random(i, 12) }));
      const row = (y, name, kind, show) => label([60, y], name, kind, "end") + lanes.map((lane) => label([lane.x, y], show(lane), kind, "middle")).join("");
      const bars = lanes.map(({ x, t, nearest }) => box([x - 21, 160 - 20 * nearest, 17, 20 * nearest], "q4 solid") + box([x + 4, 160 - 20 * t, 17, 20 * t], "q3 solid") + line([x, 160], [x, 20], "fine"));
      const less = ({ t, nearest }) => t < nearest;
      const cells = lanes.filter(less).map(({ x }) => box([x - 26, 211, 52, 20], "on"));
      const svg = bars.join("") + cells.join("") + line([10, 160], [550, 160], "axis") + row(182, "near", "q4", (lane) => lane.nearest.toFixed(1)) + row(203, "t", "q3", (lane) => lane.t.toFixed(1)) +
        row(226, "mask", "", (lane) => (less(lane) ? "true" : "false")) + row(252, "select", "", (lane) => Math.min(lane.t, lane.nearest).toFixed(1));
      const taken = lanes.filter(less).length;
      return [svg, `t < nearest in ${taken} of 8 lanes; the nearest are now ${lanes.map(({ t, nearest }) => Math.min(t, nearest).toFixed(2)).join(", ")}. One compare gives all eight answers, and one select takes t there and keeps nearest elsewhere. No lane branched.`];
    },
  },
  fuzz: {
    title: "Fuzzy reflection",
    size: [560, 250],
    state: { p: [117, 135], fuzz: 0.5 },
    handles: [{
      label: "Incoming ray",
      get: (s) => s.p,
      set: (s, p) => {
        const v = minus(p, [280, 200]);
        s.p = at([280, 200], 175, unit([Math.min(v[0], -1), Math.min(v[1], -1)]));
      },
    }],
    sliders: [slider("fuzz", "Fuzz", 0, 1, 0.05, (x) => x.toFixed(2))],
    draw({ p, fuzz }) {
      const P = [280, 200], d = unit(minus(P, p)), cosine = d[1], mirror = at(P, 110, [d[0], -d[1]]), r = 110 * fuzz;
      const lost = fuzz > 0 ? Math.max(0, (fuzz - cosine) / (2 * fuzz)) : 0;
      const rays = range(24, (i) => at(mirror, r, [Math.cos((i * Math.PI) / 12), Math.sin((i * Math.PI) / 12)])).map((end) => line(P, end, end[1] < 200 ? "q4 faint" : "q3 faint"));
      const svg = box([0, 200, 560, 50], "body") + line([0, 200], [560, 200], "axis") + rays.join("") + arrow(p, P, "q1 thick") + arrow(P, at(P, 80, [0, -1]), "q2 thick") + label([288, 130], "n", "q2") + arrow(P, mirror, "q1") + circle(mirror, r, "q4") + label(at(mirror, 1, [6, -r - 6]), "fuzz", "q4");
      return [svg, `At ${degrees(Math.acos(cosine))} from the normal with fuzz ${fuzz.toFixed(2)}, ${percent(lost, 1)} of the paths point into the metal and are absorbed.`];
    },
  },
  hierarchy: {
    title: "A packet in a hierarchy of boxes",
    size: [720, 290],
    state: { o: [30, 150], aim: [330, 130], spread: 0.25 },
    handles: [handle("Origin of the rays", "o", [10, 20, 100, 250]), handle("Direction of the rays", "aim", [160, 20, 380, 250])],
    sliders: [slider("spread", "Spread of the rays", 0, 1, 0.05, (x) => x.toFixed(2))],
    draw({ o, aim, spread }) {
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
      const drawn = (node) => box(node.bounds, visits.some((visit) => visit.node === node) ? "q4" : "fine") + node.children.map(drawn).join("");
      const ends = rays.map((d, i) => at(o, nearest[i], d));
      const rows = visits.map(({ mask }, row) => mask.map((isIn, i) => box([622 + 11 * i, 26 + 8.5 * row, 9, 6.5], isIn ? "q1 solid" : "edge")).join(""));
      const svg = drawn(TREE) + SPHERES.map((ball) => circle(ball.c, ball.r, tested.has(ball) ? "q3" : "body")).join("") + ends.map((end) => line(o, end, "q1")).join("") + label([710, 18], "visited boxes", "weak", "end") + rows.join("");
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

function start(figure, { state, handles = [], sliders = [], draw }) {
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
    const [shapes, words] = draw(state);
    layer.innerHTML = shapes;
    reading.textContent = words;
    knobs.forEach((knob) => knob());
  }
  controls.append(...sliders.map((slider) => sliderRow(slider, state, show)), reading);
  figure.querySelector(".scroll").after(controls);
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
