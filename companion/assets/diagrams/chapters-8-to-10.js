// Chapters 8 to 10: samples, light, metal.
Object.assign(diagrams, {
  points: {
    title: "Random points and Sobol points",
    isRandom: true,
    size: [560, 290],
    state: { count: 6, cut: 3, seed: 2 },
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
      const corner = label([21, 28], "centre", "weak small") + label([301, 28], "centre", "weak small");
      return [a.svg + b.svg + corner, `Empty cells of 64: random ${a.empty}, Sobol ${b.empty}. The share of points inside the quarter circle estimates π: random is off by ${a.error.toFixed(3)}, Sobol by ${b.error.toFixed(3)}.`];
    },
  },
  directions: {
    title: "The light at one point of a matte ball",
    size: [560, 290],
    isRandom: true,
    hint: "Drag the point around the ball, and take more directions.",
    state: { P: [166, 107], count: 6, seed: 1 },
    handles: [{ label: "Point on the ball", get: (s) => s.P, set: (s, p) => (s.P = at([130, 165], 68, unit(minus(p, [130, 165])))) }],
    sliders: [slider("count", "Directions", 0, 10, 1, (x) => 2 ** x), slider("seed", "Seed", 1, 30, 1)],
    draw({ P, count, seed }) {
      const C = [130, 165], n = unit(minus(P, C)), N = 2 ** count;
      // In space; the drawing shows two coordinates. Below the horizon is the ground, which sends half of the light.
      const light = (climb) => (climb > 0 ? 1 - 0.25 * (climb + 1) : 0.4), direction = (u0, u1) => {
        const up = u0, side = Math.sqrt(1 - up * up), across = side * Math.cos(2 * Math.PI * u1);
        return [n[0] * up - n[1] * across, n[1] * up + n[0] * across];
      };
      const values = range(N, (i) => direction(random(2 * i, seed), random(2 * i + 1, seed))), means = [];
      values.reduce((sum, d, i) => (means[i] = (sum + light(-d[1]))) && sum + light(-d[1]), 0);
      const whole = range(4096, (i) => light(-direction(...point(true, i, 1))[1])).reduce((a, b) => a + b, 0) / 4096;
      const plot = (k, y) => [320 + (k / 10) * 205, 235 - 170 * y], curveOf = range(N, (i) => plot(Math.log2(i + 1), means[i] / (i + 1)));
      const rays = values.slice(0, 256).map((d) => line(P, at(P, 80, d), -d[1] > 0 ? "q1 faint" : "q5 faint")).join("");
      const svg = box([0, 233, 290, 57], "gap") + ball(C, 68) + rays + arrow(P, at(P, 44, n), "q2 thick") + vector(at(P, 56, n), "n", "q2") + circle(P, 4, "solid") + label([10, 24], "sky", "weak") + label([10, 280], "ground", "weak") +
        line(plot(0, 0), plot(10, 0), "axis") + line(plot(0, 0), plot(0, 1), "axis") + line(plot(0, whole), plot(10, whole), "q2 edge") + label(at(plot(10, whole), 1, [0, -6]), "whole hemisphere", "q2", "end") + curve(curveOf, "q1") + spot(curveOf.at(-1), "", "q1") +
        [0, 5, 10].map((k) => label(at(plot(k, 0), 1, [0, 18]), (2 ** k).toLocaleString("en"), "weak", "middle")).join("") + label([430, 273], "directions", "weak", "middle") + label([312, 40], "mean light", "weak");
      return [svg, `${N} ${N === 1 ? "direction" : "directions"}: mean ${percent(means[N - 1] / N)}, whole hemisphere ${percent(whole)} of white.`];
    },
  },
  path: {
    title: "A path and its throughput",
    size: [560, 300],
    hint: "Drag the aim of the camera ray, and change the random numbers.",
    state: { aim: [160, 140], bounces: 5, seed: 3 },
    handles: [handle("Aim of the camera ray", "aim", [60, 20, 480, 225])],
    sliders: [slider("bounces", "Bounces", 0, 7, 1), slider("seed", "Random numbers", 1, 30, 1)],
    draw(s) {
      const { steps, throughput, isLit } = walk([30, 120], s.aim, s.bounces + 1, s.seed, ROOM), products = steps.flatMap(({ throughput: t }) => (t ? [t] : []));
      const balls = ROOM.map(({ c, r, colour }) => `<circle cx="${c[0]}" cy="${c[1]}" r="${r}" class="plain" style="fill:${rgb(colour)}"/>` + (r < 100 ? circle(at(c, 0.36 * r, [-0.6, -0.8]), 0.42 * r, "shine") : ""));
      const rays = steps.map(({ o, p, n }) => arrow(o, n ? p : at(o, 90, unit(minus(p, o))), "q1 thick") + (n ? arrow(p, at(p, 26, n), "q2") + circle(p, 3.5, "solid") : label(at(at(o, 100, unit(minus(p, o))), 1, [4, 0]), "sky", "weak")));
      const shown = isLit ? products : [...products, [0, 0, 0]], swatches = shown.map((t, i) => box([70 + 52 * i, 262, 30, 30], "swatch", `style="fill:${rgb(t)}"`) + (i ? label([61 + 52 * i, 282], "→", "weak", "middle") : ""));
      const svg = `<svg x="0" y="0" width="560" height="252" viewBox="0 0 560 252">${balls.join("")}${rays.join("")}${circle([30, 120], 6, "solid")}${label([12, 145], "eye")}</svg>` + label([8, 282], "product", "weak") + swatches.join("") + label([70 + 52 * shown.length, 282], isLit ? "× the sky’s light" : "cut off", "weak");
      const product = throughput.map((x) => fixed(x)).join(", "), climb = Math.atan2(120 - s.aim[1], s.aim[0] - 30);
      return [svg, `At most ${s.bounces} ${s.bounces === 1 ? "bounce" : "bounces"}, seed ${s.seed}, camera ray at ${degrees(climb, 1)}: ${steps.map(({ ball }) => ball?.name ?? "sky").join(" → ")}. ` + (isLit ? `Throughput (${product}) times the light of the sky.` : "Cut off: black.")];
    },
  },
  acne: {
    title: "Rounded hit points below a thin coat",
    size: [560, 270],
    hint: "Drag the coat up and down, and choose what the program does.",
    state: { coat: [520, 135], remedy: "t > 0", seed: 2 },
    handles: [handle("Thickness of the coat", "coat", [520, 40, 0, 150], [0, 1])],
    choices: [{ key: "remedy", label: "A hit counts if", options: ["t > 0", "t > 0.001", "not the sphere it left"] }],
    sliders: [slider("seed", "Random numbers", 1, 20, 1)],
    draw({ coat, remedy, seed }) {
      // 0.001 is 80 pixels.
      const ground = 200, top = coat[1], least = remedy === "t > 0.001" ? 80 : 0;
      const rays = range(9, (i) => {
        const o = [40 + 52 * i, ground + 26 * (random(2 * i, seed) - 0.5)], turn = 1.9 * (random(2 * i + 1, seed) - 0.5), d = [Math.sin(turn), -Math.cos(turn)];
        const [own, outer] = [ground, top].map((y) => (o[1] - y) / -d[1]), isAcne = remedy !== "not the sphere it left" && own > 0 && own > least, isLost = !isAcne && outer <= least;
        return { o, end: at(o, isAcne ? own : isLost ? 150 / -d[1] : outer, d), isAcne, isLost };
      });
      const acne = rays.filter(({ isAcne }) => isAcne).length, lost = rays.filter(({ isLost }) => isLost).length;
      const svg = box([0, ground, 560, 70], "body plain") + box([0, top, 560, ground - top], "pane plain") + line([0, ground], [560, ground], "axis") + line([0, top], [560, top], "q4") + label([8, 262], "ball", "weak") + label([8, top - 6], "coat", "q4") +
        rays.map(({ o, end, isAcne, isLost }) => (isLost ? line(o, end, "q3 edge") : arrow(o, end, isAcne ? "q3 thick" : "q1")) + circle(o, 4, isAcne || isLost ? "q3 solid" : "q1 solid")).join("") + line([545, ground], [545, ground - 80], "weak") + line([540, ground - 80], [550, ground - 80]) + label([536, ground - 84], "0.001", "weak", "end");
      return [svg, `Coat of ${fixed((ground - top) / 80000, 5)}. ${acne} of 9 rays hit the surface that they leave${acne ? ": acne" : ""}; ${lost} pass through the coat${lost ? ", as if it were not there" : ""}.`];
    },
  },
  beam: {
    title: "A beam on a surface",
    size: [560, 250],
    hint: "Drag the beam.",
    state: { p: [190, 70] },
    handles: [{ label: "Direction of the beam", get: (s) => s.p, set: (s, p) => (s.p = at([280, 200], 160, unit([clamp(p[0] - 280, -150, 150), Math.min(p[1] - 200, -42)]))) }],
    draw({ p }) {
      const P = [280, 200], d = unit(minus(p, P)), side = [-d[1], d[0]], cosine = -d[1], half = 36, patch = half / cosine;
      const [left, right] = [-1, 1].map((k) => at(P, k * patch, [1, 0])), edge = (q, k) => at(at(p, k * half, side), 0, d);
      const svg = polygon([edge(p, -1), edge(p, 1), right, left], "q3 filled") + line([0, 200], [560, 200], "axis") + line(left, right, "q3 thick") + arrow(P, at(P, 70, [0, -1]), "q2 thick") + vector([292, 140], "n", "q2") + arrow(p, P, "q3 thick") + angle(P, [0, -1], d, 46, "θ") +
        line(edge(p, -1), edge(p, 1), "q4 thick") + letter(at(p, 16, d), "1", "q4") + letter([280, 222], "1 / cos θ", "q3") + range(9, (i) => circle([at(left, (i + 0.5) / 9, minus(right, left))[0], 236], 3, "q3 solid")).join("");
      return [svg, `θ = ${degrees(Math.acos(cosine))}: the beam lights ${fixed(1 / cosine)} times its width, so each point gets cos θ = ${fixed(cosine)} of the light.`];
    },
  },
  cosine: {
    title: "Uniform and cosine-weighted directions",
    isRandom: true,
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
        const [u0, u1] = point(true, i, 1), y = 1 - 2 * u0, rho = Math.sqrt(1 - y * y) * Math.cos(2 * Math.PI * u1);
        const sum = [rho, 1 + y], depth = Math.sqrt(1 - y * y) * Math.sin(2 * Math.PI * u1), length = Math.hypot(rho, 1 + y, depth) || 1;
        share[0] += Math.abs(y) >= Math.cos(theta);
        share[1] += sum[1] / length >= Math.cos(theta);
        return circle([140 + 110 * rho * 1, 210 - 110 * Math.abs(y)], 1.6, "q4 solid") + circle([420 + (80 * sum[0]) , 210 - 80 * sum[1]], 1.6, "q2 solid");
      });
      const wedge = (O, r) => [-1, 1].map((side) => line(O, at(O, r, [side * Math.sin(theta), -Math.cos(theta)]), "thin")).join("");
      const svg = line([10, 210], [270, 210], "axis") + line([300, 210], [540, 210], "axis") + circle([420, 130], 80, "body") + dots.join("") + wedge([140, 210], 110) + wedge(P, 165) +
        arrow([140, 210], [140, 100], "q2 thick") + arrow(P, [420, 130], "q2 thick") + arrow([420, 130], p, "q4 thick") + line(P, p, "q1 thick") +
        vector([408, 178], "n", "q2") + vector(at(p, 1, [12, -4]), "n + u", "q1", "start") + vector(at(along([420, 130], p, 0.5), 1, [11, 8]), "u", "q4") + angle(P, [0, -1], unit(minus(p, P)), 52, "θ") + angle([420, 130], [0, -1], unit(minus(p, [420, 130])), 26, "2θ") + label([140, 240], "uniform over the hemisphere", "weak", "middle") + label([420, 240], "the normal plus a unit vector", "weak", "middle");
      return [svg, `Within θ = ${degrees(theta)} of the normal: uniform ${percent(1 - Math.cos(theta))}, counted ${percent(share[0] / count)}; cosine share sin²θ = ${percent(Math.sin(theta) ** 2)}, counted ${percent(share[1] / count)}.`];
    },
  },
  gamma: {
    title: "From a number to a byte and to light",
    size: [560, 300],
    hint: "Drag the number along its axis.",
    state: { x: [177, 235] },
    handles: [handle("Number", "x", [52, 235, 250, 0])],
    draw({ x }) {
      const v = (x[0] - 52) / 250, plot = (a, y) => [52 + 250 * a, 235 - 205 * y], byte = (a) => Math.floor(256 * Math.min(a, 0.999)), shown = (a) => (byte(a) / 255) ** 2.2;
      const curveOf = (code, kind) => curve(range(65, (i) => plot(i / 64, shown(code(i / 64)))), kind), grey = (a) => `style="fill:rgb(${range(3, () => byte(a))})"`;
      const rows = [["linear", (a) => a, "q3", 60], ["square root", Math.sqrt, "q2", 140]];
      const svg = [0, 0.5, 1].map((y) => line(plot(0, y), plot(1, y), "fine") + label(at(plot(0, y), 1, [-6, 4]), percent(y), "weak", "end")).join("") + line(plot(0, 0), plot(1, 0), "axis") + line(plot(0, 0), plot(1, 1), "thin") + rows.map(([name, code, kind, y]) => curveOf(code, kind) + line(plot(v, 0), plot(v, shown(code(v))), `${kind} edge`) + spot(plot(v, shown(code(v))), byte(code(v)), kind) +
        label([320, y - 8], `${name}: byte ${byte(code(v))}`, kind) + box([506, y, 40, 30], "swatch", grey(code(v))) + range(9, (i) => box([320 + 20 * i, y, 20, 30], "plain", grey(code((i + 0.5) / 9)))).join("")).join("") + label([177, 266], "number: linear light", "weak", "middle") + label([36, 18], "light of the display", "weak") + label([320, 196], "equal steps of light", "weak");
      return [svg, `Number ${fixed(v)}. ` + rows.map(([name, code]) => `${name[0].toUpperCase() + name.slice(1)}: byte ${byte(code(v))}, ${percent(shown(code(v)))} of white`).join(". ") + "."];
    },
  },
  mirror: {
    title: "The mirror direction in two steps",
    size: [560, 260],
    hint: "Drag the incoming ray, and go through the steps.",
    state: { p: [180, 50], step: 2 },
    handles: [{ label: "Incoming ray", get: (s) => s.p, set: (s, p) => (s.p = at([280, 150], 125, unit([Math.min(p[0] - 280, -8), Math.min(p[1] - 150, -8)]))) }],
    sliders: [slider("step", "Steps", 0, 2, 1)],
    draw({ p, step }) {
      const P = [280, 150], d = unit(minus(P, p)), cosine = d[1], ends = range(3, (k) => at(at(P, 100, d), 100 * cosine * k, [0, -1])), r = ends[2];
      const ups = range(step, (k) => arrow(ends[k], ends[k + 1], "q2 thick") + vector(at(along(ends[k], ends[k + 1], 0.5), 1, [34, 4]), "cos θ n", "q2")).join("");
      const svg = box([0, 150, 560, 110], "body plain") + line([0, 150], [560, 150], "axis") + arrow(p, P, "q1 thick") + vector(at(along(p, P, 0.45), 13, [d[1], -d[0]]), "d", "q1") + arrow(P, ends[0], "q1 thick") + vector(at(along(P, ends[0], 0.6), 13, [-d[1], d[0]]), "d", "q1") + arrow(P, at(P, 100, [0, -1]), "q2") + vector([268, 58], "n", "q2") + angle(P, [0, -1], unit(minus(p, P)), 36, "θ") +
        ups + (step === 2 ? arrow(P, r, "q3 thick") + vector(at(r, 14, unit(minus(r, P))), "r", "q3") : "") + circle(P, 4, "solid");
      return [svg, `cos θ = ${fixed(cosine)}. ${["d continues into the metal", "d + cos θ n lies in the surface", "r = d + 2 cos θ n leaves it at the same angle"][step]}; its length is ${fixed(Math.hypot(...minus(ends[step], P)) / 100)}.`];
    },
  },
  fuzz: {
    title: "Fuzzy reflection",
    size: [560, 245],
    hint: "Drag the incoming ray, and change the fuzz.",
    state: { p: [152, 84], fuzz: 0.5 },
    handles: [{
      label: "Incoming ray",
      get: (s) => s.p,
      set: (s, p) => {
        const v = minus(p, [280, 190]);
        s.p = at([280, 190], 150, unit([Math.min(v[0], -1), Math.min(v[1], -1)]));
      },
    }],
    sliders: [slider("fuzz", "Fuzz", 0, 1, 0.05, fixed)],
    draw({ p, fuzz }) {
      const P = [280, 190], d = unit(minus(P, p)), cosine = d[1], mirror = at(P, 88, [d[0], -d[1]]), r = 88 * fuzz;
      const lost = fuzz > 0 ? Math.max(0, (fuzz - cosine) / (2 * fuzz)) : 0;
      const rays = range(24, (i) => at(mirror, r, [Math.cos((i * Math.PI) / 12), Math.sin((i * Math.PI) / 12)])).map((end) => line(P, end, end[1] < 190 ? "q4 faint" : "q3 faint"));
      const svg = box([0, 190, 560, 55], "body plain") + line([0, 190], [560, 190], "axis") + label([12, 234], "metal", "weak") + rays.join("") + arrow(p, P, "q1 thick") + vector(at(along(p, P, 0.5), 13, [d[1], -d[0]]), "d", "q1") + arrow(P, at(P, 88, [0, -1]), "q2 thick") + vector([268, 108], "n", "q2") +
        angle(P, [0, -1], unit(minus(p, P)), 40, "θ") + arrow(P, mirror, "thick") + vector(at(along(P, mirror, 0.62), 12, [-d[1], -d[0]]), "r") + circle(mirror, r, "q4") + line(mirror, at(mirror, r, [Math.SQRT1_2, -Math.SQRT1_2]), "q4") + letter(at(at(mirror, 0.6 * r, [Math.SQRT1_2, -Math.SQRT1_2]), 1, [9, 8]), "f", "q4");
      return [svg, `At θ = ${degrees(Math.acos(cosine))} with fuzz f = ${fixed(fuzz)}, ${percent(lost, 1)} of the paths point into the metal and are absorbed.`];
    },
  },
});
