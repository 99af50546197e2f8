// What the text says of each link that sets a picture: the link, words beside it, and what must hold of the picture
// `now` that it makes, compared with `was`, the same with the stage's own settings.

// A picture of bytes in base64, 480 pixels wide, of which parts are given as shares: left, top, right, bottom.
export class Picture {
  constructor({ width, height, data }) {
    Object.assign(this, { width, height, data: Buffer.from(data, "base64") });
  }

  at(x, y) {
    const place = 4 * (Math.min(y, this.height - 1) * this.width + Math.min(x, this.width - 1));
    return [...this.data.subarray(place, place + 3)];
  }

  // The mean of a value of each pixel of a part.
  mean(of, [left, top, right, bottom] = [0, 0, 1, 1]) {
    let sum = 0, count = 0;
    for (let y = Math.round(top * this.height); y < Math.round(bottom * this.height); y++)
      for (let x = Math.round(left * this.width); x < Math.round(right * this.width); x++) {
        sum += Number(of(this.at(x, y), x, y));
        count++;
      }
    return sum / count;
  }

  light(part) {
    return this.mean(light, part);
  }

  // The means of the rows of a part.
  rows(of, [left, top, right, bottom]) {
    const rows = [];
    for (let y = Math.round(top * this.height); y < Math.round(bottom * this.height); y++) rows.push(this.mean(of, [left, y / this.height, right, (y + 1) / this.height]));
    return rows;
  }

  // The greatest step of light from one row of a part to the next.
  steepest(part) {
    const rows = this.rows(light, part);
    return Math.max(...rows.slice(1).map((row, i) => Math.abs(row - rows[i])));
  }

  // The blue of the bluest row of a part: how sharp the hollow ball's rim is, before ground without blue.
  rim() {
    return Math.max(...this.rows(([, , blue]) => blue, ARC));
  }

  difference(other, part) {
    return this.mean((pixel, x, y) => Math.abs(light(pixel) - light(other.at(x, y))), part);
  }
}

const light = ([r, g, b]) => (r + g + b) / 3;
const far = (a, b) => Math.max(...a.map((value, k) => Math.abs(value - b[k]))) > 20;
const isBlack = (pixel) => light(pixel) < 8;
// Otherwise the value, for the message.
const within = (low, value, high) => (low < value && value < high) || value;
const below = (value, limit) => within(-Infinity, value, limit);
const isRed = ([r, g]) => r > 200 && g < 60;
const isGround = ([r, g, b]) => g > 1.25 * b && r > 1.1 * b;
const isBlue = ([r, , b]) => b > 1.5 * r;
const isSky = ([r, g, b]) => b > 1.05 * r && g > 150;
const UNDER = [0.45, 0.68, 0.55, 0.74], RIM = [0.6, 0.5, 0.74, 0.65], GLASS_TOP = [0.05, 0.28, 0.2, 0.38], MIRROR = [0.08, 0.42, 0.18, 0.7];
const ARC = [0.06, 0.38, 0.12, 0.6], FOCUS = [0.48, 0.3, 0.62, 0.55];
const LOWER_HALF = [0.05, 0.58, 0.3, 0.7], UPPER_THIRD = [0, 0, 1, 1 / 3], HORIZON = [0, 0.15, 0.3, 0.35];
const MIDDLE = [0.42, 0.35, 0.58, 0.65];

export const claims = [
  ["diffuse?bounces=0", "the ball is black", (now) => now.light(MIDDLE) < 2],
  ["diffuse?bounces=0", "every surface is black", (now) => now.light([0, 0.7, 1, 1]) < 2 && now.light([0, 0, 1, 0.3]) > 150],
  ["diffuse?bounces=1", "lights it from the sky", (now) => now.light(MIDDLE) > 40],
  ["diffuse?bounces=1", "the underside of the ball loses half", (now, was) => within(0.3, now.light(UNDER) / was.light(UNDER), 0.7)],
  ["sky?vfov=120", "more blue at the top", (now, was) => now.at(240, 0)[0] < was.at(240, 0)[0] - 4],
  ["sky?vfov=120", "more white at the bottom", (now, was) => now.at(240, 269)[0] > was.at(240, 269)[0] + 4],
  ["sky?vfov=20", "nearly one colour", (now) => now.at(240, 269)[0] - now.at(240, 0)[0] < 30],
  ["red-sphere?vfov=60", "just touches the upper", (now) => [0, 269].every((y) => isRed(now.at(240, y)) && !isRed(now.at(280, y)))],
  ["normals?vfov=120", "the ball shrinks", (now, was) => now.at(300, 135)[1] > 200 && was.at(300, 135)[1] < 150],
  ["normals?vfov=120", "its colours stay", (now) => now.at(240, 135)[2] > 250 && now.at(240, 100)[1] > 180],
  ["antialiased?samples=1", "the staircase returns", (now, was) => now.mean((pixel, x, y) => far(pixel, was.at(x, y)), RIM) > 0.015],
  ["antialiased?samples=4", "a few steps of grey", (now, was) => within(0.004, now.mean((pixel, x, y) => far(pixel, was.at(x, y)), RIM), 0.015)],
  ["shadow-acne?bounces=2", "the ball turns a little darker", (now, was) => below(now.light(MIDDLE) / was.light(MIDDLE), 0.97)],
  ["metal?fuzz=0.2", "it blurs", (now, was) => below(now.steepest(MIRROR) / was.steepest(MIRROR), 0.6)],
  ["metal?bounces=1", "turns black", (now, was) => now.mean(isBlack, MIRROR) > 0.3 && was.mean(isBlack, MIRROR) < 0.01],
  ["metal-fuzzy?fuzz=1", "sky and ground mix in the left ball", (now, was) => {
    // Ground has no blue.
    const [blue, before] = [now, was].map((picture) => picture.mean(([, , b]) => b, LOWER_HALF));
    return (blue > 30 && before < 10) || [blue, before];
  }],
  ["metal-fuzzy?fuzz=0", "the right panel is the left one", (now, _, usual) => below(now.difference(usual.get("metal")), 2)],
  ["glass-schlick?index=2.4", "it reflects more of the sky", (now, was) => now.mean(([, , b]) => b, GLASS_TOP) > 1.5 * was.mean(([, , b]) => b, GLASS_TOP)],
  ["glass-refract?index=1.1", "almost only sky", (now) => now.mean(isSky, [0.05, 0.3, 0.3, 0.58]) > 0.95],
  ["glass-refract?index=1.1", "a patch of ground in its lower half", (now) => isGround(now.at(99, 181))],
  ["glass-refract?index=1.1", "strip of ground along its upper rim", (now) => now.mean(isGround, [0.1, 0.2, 0.14, 0.26]) > 0.02],
  ["hollow-glass?index=1", "bright rings are left", (now) => {
    // Ground has no blue.
    const [inside, inner, between, outer, outside] = [0.615, 0.7, 0.72, 0.77, 0.81].map((y) => now.mean(([, , b]) => b, [0.12, y, 0.18, y + 0.008]));
    return (inner > 2 * between && outer > 2 * between && inside + outside < 20) || [inside, inner, between, outer, outside];
  }],
  ["fov-wide?vfov=120", "no longer reach the edges", (now, was) => isSky(now.at(48, 8)) && was.at(48, 8)[0] < 30],
  ["fov-narrow?vfov=5", "where they touch", (now) => now.at(60, 135)[2] > 80 && now.at(60, 135)[2] < 220 && now.mean(isSky) < 0.05 && now.at(420, 135)[0] > 80 && now.at(420, 135)[2] < 30],
  ["view-close?vfov=8", "the blue ball alone fills most", (now, was) => now.mean(isBlue) > 0.7 && was.mean(isBlue) < 0.5],
  ["defocus?defocus=0", "the second panel is the first", (now, _, usual) => below(now.difference(usual.get("view-close")), 2)],
  ["defocus?defocus=20", "the other two balls blur twice as much", (now, was) => below(now.rim() / was.rim(), 0.95)],
  ["defocus?focus=2.9", "focus on the hollow ball", (now, was) => now.rim() / was.rim() > 1.03 || now.rim() / was.rim()],
  ["book?vfov=60", "the sky fills the upper third", (now, was) => now.mean(isSky, UPPER_THIRD) > 0.99 && was.mean(isSky, UPPER_THIRD) < 0.9],
  ["book?defocus=0", "the horizon is a sharp line", (now, was) => now.steepest(HORIZON) / was.steepest(HORIZON) > 1.5 || now.steepest(HORIZON) / was.steepest(HORIZON)],
  ["book?bounces=1", "lose most of what they show", (now, was) => below(now.light(FOCUS) / was.light(FOCUS), 0.8)],
];
