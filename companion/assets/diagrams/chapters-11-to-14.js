// Chapters 11 to 14: glass, camera, hierarchy.
Object.assign(diagrams, {
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
  ball: {
    title: "A ball of glass as a lens",
    size: [560, 280],
    hint: "Drag the eye. The sliders choose the glass and the ray that is marked.",
    state: { eye: [30, 140], index: 1.5, ray: 0.7 },
    handles: [handle("Eye", "eye", [10, 30, 120, 220])],
    sliders: [slider("index", "Index of refraction", 1, 2.5, 0.05, fixed), slider("ray", "Marked ray", -0.95, 0.95, 0.05, fixed)],
    draw({ eye, index, ray }) {
      const C = [215, 140], r = 64, away = Math.hypot(...minus(C, eye)), axis = unit(minus(C, eye));
      const bend = (d, n, eta) => { const cosine = -dot(d, n), k = Math.sqrt(1 - eta * eta * (1 - cosine * cosine)); return at(at([0, 0], eta, d), eta * cosine - k, n); };
      // The ray that would pass the centre at b radii.
      const trace = (b) => {
        const d = turned(axis, Math.asin((b * r) / away)), f = minus(C, eye), h = dot(d, f), p = at(eye, h - Math.sqrt(r * r - (dot(f, f) - h * h)), d), n = at([0, 0], 1 / r, minus(p, C)), inside = bend(d, n, 1 / index), m = minus(C, p), q = at(p, 2 * dot(inside, m), inside), out = at([0, 0], -1 / r, minus(q, C));
        return { p, q, n, out, inside, end: bend(inside, out, index) };
      };
      const drawn = ({ p, q, end }, kind) => line(eye, p, kind) + line(p, q, kind) + line(q, at(q, 400, end), kind), near = trace(0.02), marked = trace(ray);
      // Where a ray near the axis crosses it, in radii behind the centre.
      const aside = [-axis[1], axis[0]], height = dot(minus(near.q, C), aside), slope = dot(near.end, aside) / dot(near.end, axis), crossing = height * slope < 0 ? (dot(minus(near.q, C), axis) - height / slope) / r : Infinity;
      const corner = ({ p, n, inside }) => line(at(p, 30, n), at(p, -46, n), "thin") + angle(p, at([0, 0], -1, n), inside, 30, "θₜ", "q2"), mirrored = { p: marked.q, n: at([0, 0], -1, marked.out), inside: at([0, 0], -1, marked.inside) };
      const svg = line(eye, at(eye, 560, axis), "thin") + ball(C, r) + range(9, (i) => drawn(trace(-0.88 + 0.22 * i), "q1 faint")).join("") + drawn(marked, "q3 thick") + corner(marked) + corner(mirrored) + circle(C, 3.5, "solid") + vector(at(C, 1, [0, -9]), "C") + circle(eye, 6, "solid") + label(at(eye, 1, [-8, 24]), "eye") + (crossing < 5 ? spot(at(C, crossing * r, axis), "", "q4") : "");
      const turn = Math.acos(Math.min(1, -dot(marked.inside, marked.n)));
      return [svg, `Index ${fixed(index)}, eye ${fixed(away / r, 1)} radii away: rays near the axis ${crossing < 50 ? `cross ${fixed(crossing, 1)} radii behind the centre; beyond that, all is reversed` : "do not cross behind the ball, so its middle is upright"}. The marked ray has θₜ = ${degrees(turn, 1)} at both ends of its chord.`];
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
  hierarchy: {
    title: "A packet in a hierarchy of boxes",
    size: [830, 290],
    narrow: [600, 500],
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
      // Boxes, and the tree beside or below them; a visited node is as full as its mask.
      const shapes = [], nodes = [];
      const draw = (node, depth, from, to) => {
        const id = nodes.push(node), seen = visits.find((visit) => visit.node === node), share = seen ? seen.mask.filter(Boolean).length / 8 : 0, middle = (from + to) / 2;
        const place = (x, depth) => (isNarrow ? [10 + 580 * x, 330 + 34 * depth] : [590 + 232 * x, 24 + 58 * depth]), here = place(middle, depth);
        shapes.push(box(node.bounds, seen ? "q4" : "fine", `data-node="${id}" style="stroke-opacity:${seen ? 0.35 + 0.13 * depth : 0.25};stroke-width:${Math.max(0.8, 2.6 - 0.4 * depth)}"`));
        node.children.forEach((child, i) => {
          const half = [from + (i * (to - from)) / 2, from + ((i + 1) * (to - from)) / 2];
          shapes.push(line(here, place((half[0] + half[1]) / 2, depth + 1), "edge"));
          draw(child, depth + 1, ...half);
        });
        shapes.push(`<circle cx="${round(here[0])}" cy="${round(here[1])}" r="6" class="${seen ? "q1" : "edge"}" data-node="${id}" style="fill:color-mix(in srgb, var(--q1) ${Math.round(100 * share)}%, var(--bg))"/>`);
      };
      draw(TREE, 0, 0, 1);
      const ends = rays.map((d, i) => at(o, nearest[i], d));
      const svg = SPHERES.map((ball) => circle(ball.c, ball.r, tested.has(ball) ? "q3" : "body")).join("") + ends.map((end) => line(o, end, "q1")).join("") + shapes.join("") + label(isNarrow ? [8, 305] : [590, 16], "the tree", "weak");
      const mean = visits.reduce((sum, { mask }) => sum + mask.filter(Boolean).length, 0) / (visits.length || 1);
      return [svg, `The packet opens ${visits.length} boxes, and on average ${mean.toFixed(1)} of its 8 rays are in one. It tests ${tested.size} of ${SPHERES.length} balls.`];
    },
  },
});
