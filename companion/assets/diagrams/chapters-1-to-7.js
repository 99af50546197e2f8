// Chapters 1 to 7: vectors, rays, spheres.
Object.assign(diagrams, {
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
      return [svg, `Seed ${seed}, pixel ${row + 1}: ${route}. ` + (isLit ? `Product (${numbers(throughput)}) × sky (${numbers(sky(last.sky))}) = pixel (${numbers(pixel)}).` : "Five bounces, and still no sky: black.")];
    },
  },
  vectors: {
    title: "Sum, multiple, dot and cross product of two vectors",
    size: [560, 290],
    hint: "Drag the ends of a and b, and choose what to do with them.",
    state: { a: [235, 95], b: [330, 205], what: "a + b", s: 1.5 },
    handles: [handle("End of a", "a", [20, 15, 520, 260]), handle("End of b", "b", [20, 15, 520, 260])],
    choices: [{ key: "what", label: "Operation", options: ["a + b", "s a", "a · b", "a × b"] }],
    sliders: [{ ...slider("s", "Number s", -1.5, 2, 0.1, fixed), also: { what: "s a" } }],
    draw({ a, b, what, s }) {
      const O = [200, 180], A = minus(a, O), B = minus(b, O), unitPx = 50, long = Math.hypot(...B), end = at(a, 1, B), [dotted, crossed] = [dot(A, B), A[1] * B[0] - A[0] * B[1]].map((x) => x / unitPx ** 2);
      const foot = at(O, dot(A, B) / (long * long || 1), B), piece = dot(A, B) / (long || 1) / unitPx;
      const grid = range(11, (i) => line([i * unitPx, 0], [i * unitPx, 290], "fine")).concat(range(6, (i) => line([0, 30 + i * unitPx], [560, 30 + i * unitPx], "fine"))).join("");
      const shapes = {
        "a + b": () => [line(a, end, "edge") + line(b, end, "edge") + arrow(O, end, "q3 thick") + vector(at(end, 1, [0, -8]), "a + b", "q3"), `a + b = (${fixed((A[0] + B[0]) / unitPx, 1)}, ${fixed(-(A[1] + B[1]) / unitPx, 1)}): along a, then along b, or the other way round.`],
        "s a": () => [line(at(O, -9, A), at(O, 9, A), "thin") + arrow(O, at(O, s, A), "q3 thick") + vector(at(at(O, s, A), 1, [24, -4]), `${fixed(s, 1)} a`, "q3"), `${fixed(s, 1)} a is ${fixed(Math.abs(s), 1)} times as long as a${s < 0 ? " and points the other way" : ""}.`],
        "a · b": () => [line(at(O, -9, B), at(O, 9, B), "thin") + line(a, foot, "edge") + line(O, foot, "q3 thick") + spot(foot, fixed(piece), "q3"), `a reaches ${fixed(piece)} along b, and b is ${fixed(long / unitPx)} long: a · b = ${fixed(dotted)}${Math.abs(dotted) < 0.05 ? ", a right angle" : ""}.`],
        "a × b": () => [polygon([O, a, end, b], "q3 filled") + circle(O, 9, "q3") + (crossed < 0 ? line(at(O, 6, [-1, -1]), at(O, 6, [1, 1]), "q3") + line(at(O, 6, [-1, 1]), at(O, 6, [1, -1]), "q3") : circle(O, 3, "q3 solid")), `a × b points ${crossed < 0 ? "into" : "out of"} the page and is ${fixed(Math.abs(crossed))} long, the area of the parallelogram.`],
      };
      const [shown, words] = shapes[what]();
      return [grid + shown + arrow(O, a, "q1 thick") + vector(at(a, 14, unit(A)), "a", "q1") + arrow(O, b, "q4 thick") + vector(at(b, 14, unit(B)), "b", "q4") + circle(O, 3.5, "solid"), words];
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
      set: (s, p) => {
        const x = clamp(p[0], 264, 456);
        s.p = [x, clamp(p[1], 90 + (x - 360) * 0.45, 205 + (x - 360) * 0.45)];
      },
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
      const chord = ts.length ? measure(m, at(o, h - s, u), 14, "k", "q3") + line(C, at(o, h + s, u), "edge") + letter(at(along(C, at(o, h + s, u), 0.5), 1, [6, -6]), "r") : "";
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
});
