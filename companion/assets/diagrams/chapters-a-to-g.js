// Lanes, threads and numbers.
Object.assign(diagrams, {
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
  amdahl: {
    title: "The gain of many workers",
    size: [560, 270],
    hint: "Drag the number of workers, and change the share.",
    state: { n: [192, 225], s: 0.05 },
    handles: [handle("Number of workers", "n", [60, 225, 330, 0])],
    sliders: [slider("s", "Share s", 0, 0.5, 0.01, fixed)],
    draw({ n, s }) {
      const plot = (k, gain) => [60 + 33 * k, 225 - 20 * Math.log2(gain)], gain = (share, workers) => 1 / (share + (1 - share) / workers), workers = Math.round(2 ** ((n[0] - 60) / 33)), here = gain(s, workers);
      const of = (share, kind) => curve(range(41, (i) => plot(i / 4, gain(share, 2 ** (i / 4)))), kind);
      const svg = [0, 2, 4, 6, 8, 10].map((k) => line(plot(k, 1), plot(k, 1024), "fine") + label(at(plot(k, 1), 1, [0, 23]), 2 ** k, "weak", "middle") + line(plot(0, 2 ** k), plot(10, 2 ** k), "fine") + label(at(plot(0, 2 ** k), 1, [-8, 4]), 2 ** k, "weak", "end")).join("") + of(0, "thin") + [0.01, 0.1, 0.25].map((share) => of(share, "fine")).join("") + of(s, "q1 thick") + (s > 0 ? line(plot(0, 1 / s), plot(10, 1 / s), "q3 edge") + label(at(plot(10, 1 / s), 1, [8, 5]), "1 / s", "q3 letter") : "") +
        line(plot(Math.log2(workers), 1), plot(Math.log2(workers), here), "q4 edge") + spot(plot(Math.log2(workers), here), fixed(here, 1), "q1") + label([225, 265], "workers n", "weak", "middle") + label([66, 14], "times as fast", "weak") + label([400, 24], "all in parallel", "weak");
      return [svg, `s = ${fixed(s)}, n = ${workers}: ${fixed(here, 1)} times as fast${s > 0 ? `, and never more than ${fixed(1 / s, 1)} times` : ""}.`];
    },
  },
  error: {
    title: "Error against samples",
    isRandom: true,
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
  sums: {
    title: "Five numbers added in two orders",
    size: [560, 230],
    hint: "Shuffle the second order.",
    state: { order: 3 },
    sliders: [slider("order", "Shuffle", 1, 20, 1)],
    draw({ order }) {
      const given = [20000000, -20000000, 3, 5, 7], shuffled = given.map((x, i) => [random(i, order), x]).sort((a, b) => a[0] - b[0]).map(([, x]) => x), show = (x) => fixed(x, 0).replace(/\d(?=(\d{3})+$)/g, "$&,");
      const sums = (list, add) => list.reduce((all, x) => [...all, add(all.at(-1) ?? 0, x)], []), floats = (a, b) => single(a + b), exact = (a, b) => a + b, names = ["added", "float", "whole"];
      const results = [];
      const table = (list, y, title) => label([8, y], title, "weak") + [list, sums(list, floats), sums(list, exact)].map((row, k) => { results.push(row.at(-1)); return label([8, y + 24 + 22 * k], names[k], k === 1 ? "q3" : k === 2 ? "q2" : "") + row.map((x, i) => label([158 + 99 * i, y + 24 + 22 * k], show(x), `${k === 1 && x !== sums(list, exact)[i] ? "q3" : k === 2 ? "q2" : k === 1 ? "" : "weak"}`, "end")).join(""); }).join("");
      const svg = table(given, 22, "in this order: each column adds one number") + table(shuffled, 134, "in another order");
      return [svg, `As floats the sums are ${show(results[1])} and ${show(results[4])}; as whole numbers ${show(results[2])} and ${show(results[5])}.`];
    },
  },
});
