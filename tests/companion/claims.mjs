// What the text says of each link that sets a picture: the link, words beside it, and what must hold of the picture
// `now` that it makes, compared with `was`, the same with the stage's own settings and as many samples.

// A picture of bytes, 480 pixels wide, of which parts are given as shares: left, top, right, bottom.
export class Picture {
  constructor({ width, height, data }) {
    Object.assign(this, { width, height, data });
  }

  at(x, y) {
    const place = 4 * (Math.min(y, this.height - 1) * this.width + Math.min(x, this.width - 1));
    return this.data.slice(place, place + 3);
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

  // How much a block of 6 by 6 pixels, in which noise averages out, differs from its right neighbour.
  shapes([left, top, right, bottom]) {
    const size = 6, block = (x, y) => this.light([x / this.width, y / this.height, (x + size) / this.width, (y + size) / this.height]);
    let sum = 0, count = 0;
    for (let y = Math.round(top * this.height); y + size <= bottom * this.height; y += size)
      for (let x = Math.round(left * this.width); x + 2 * size <= right * this.width; x += size, count++) sum += Math.abs(block(x, y) - block(x + size, y));
    return sum / count;
  }

  difference(other, part) {
    return this.mean((pixel, x, y) => Math.abs(light(pixel) - light(other.at(x, y))), part);
  }
}

const light = ([r, g, b]) => (r + g + b) / 3;
const far = (a, b) => Math.abs(light(a) - light(b)) > 20;
const isBlack = (pixel) => light(pixel) < 8;
// Otherwise the value, for the message.
const within = (low, value, high) => (low < value && value < high) || value;
const below = (value, limit) => within(-Infinity, value, limit);
const isRed = ([r, g]) => r > 200 && g < 60;
const isGround = ([r, g, b]) => g > 1.25 * b && r > 1.1 * b;
const isSky = ([r, g, b]) => b > 1.05 * r && b > 150;
// Of the ball in the middle, and of the three balls of chapters 10 and 11.
const all = [0, 0, 1, 1], UNDER = [0.45, 0.68, 0.55, 0.74], RIM = [0.6, 0.5, 0.74, 0.65], GLASS_RIM = [0.07, 0.3, 0.11, 0.7], GLASS_TOP = [0.18, 0.3, 0.26, 0.4], GLASS_FLOOR = [0.18, 0.6, 0.26, 0.7];
const MIDDLE = [0.42, 0.35, 0.58, 0.65], TOP = [0.46, 0.24, 0.54, 0.3], LEFT = [0.15, 0.35, 0.29, 0.65], RIGHT = [0.71, 0.35, 0.85, 0.65];

export const claims = [
  ["diffuse?depth=1", "leaves the ball black", (now) => now.light(MIDDLE) < 2],
  ["diffuse?depth=1", "every surface is black", (now) => now.light([0, 0.7, 1, 1]) < 2 && now.light([0, 0, 1, 0.3]) > 150],
  ["diffuse?depth=2", "light it from the sky", (now) => now.light(MIDDLE) > 40],
  ["diffuse?depth=2", "the underside of the ball loses half", (now, was) => within(0.3, now.light(UNDER) / was.light(UNDER), 0.7)],
  ["sky?vfov=120", "more blue at the top", (now, was) => now.at(240, 0)[0] < was.at(240, 0)[0] - 4],
  ["sky?vfov=120", "more white at the bottom", (now, was) => now.at(240, 269)[0] > was.at(240, 269)[0] + 4],
  ["sky?vfov=20", "nearly one colour", (now) => now.at(240, 269)[0] - now.at(240, 0)[0] < 30],
  ["red-sphere?vfov=60", "just touches the upper", (now) => [0, 269].every((y) => isRed(now.at(240, y)) && !isRed(now.at(280, y)))],
  ["normals?vfov=120", "the ball shrinks", (now, was) => isSky(now.at(300, 135)) && !isSky(was.at(300, 135))],
  ["normals?vfov=120", "its colours stay", (now) => now.at(240, 135)[2] > 250 && now.at(240, 100)[1] > 200],
  ["antialiased?samples=1", "the staircase returns", (now, was) => now.mean((pixel, x, y) => far(pixel, was.at(x, y)), RIM) > 0.02],
  ["antialiased?samples=4", "a few steps of grey", (now, was) => within(0.002, now.mean((pixel, x, y) => far(pixel, was.at(x, y)), RIM), 0.02)],
  ["shadow-acne?depth=3", "the ball turns darker", (now, was) => below(now.light(MIDDLE) / was.light(MIDDLE), 0.9)],
  ["metal?fuzz=0.2", "it blurs", (now, was) => below(now.shapes(LEFT) / was.shapes(LEFT), 0.9)],
  ["metal?depth=2", "turns black", (now, was) => now.mean(isBlack, LEFT) > 0.1 && was.mean(isBlack, LEFT) < 0.01],
  ["metal-fuzzy?fuzz=1", "nothing is reflected that you could recognise", (now, was) => below(now.shapes(LEFT) / was.shapes(LEFT), 0.8)],
  ["metal-fuzzy?fuzz=0", "the right panel is the left one", (now, _, usual) => below(now.difference(usual.get("metal")), 2)],
  ["glass-schlick?index=2.4", "become bright", (now, was) => now.light(GLASS_RIM) - was.light(GLASS_RIM)],
  ["glass-refract?index=1.1", "turns upright", (now, was) => [now, was].map((picture) => picture.mean(isSky, GLASS_TOP) - picture.mean(isSky, GLASS_FLOOR))],
  ["hollow-glass?index=1", "bright rings are left", (now) => [0.2, 0.25, 0.3, 0.35, 0.38, 0.4, 0.42, 0.44, 0.46, 0.48, 0.5, 0.52, 0.55].map((r) => now.light([0.21 - r * 0.28 - 0.003, 0.5, 0.21 - r * 0.28 + 0.003, 0.52]))],
  ["fov-wide?vfov=120", "no longer reach the edges", (now, was) => [0, 8].map((y) => [now.at(160, y), was.at(160, y)])],
  ["fov-narrow?vfov=5", "where they touch", (now) => [now.at(60, 135), now.at(420, 135), now.at(240, 5)]],
  ["view-close?vfov=8", "the blue ball alone fills most", (now) => now.mean(([r, g, b]) => b > 1.3 * r)],
  ["defocus?defocus=0", "the second panel is the first", (now, _, usual) => below(now.difference(usual.get("view-close")), 2)],
  ["defocus?defocus=20", "only the blue ball is left", (now, was) => [now.shapes(all), was.shapes(all), now.shapes([0.4, 0.2, 0.6, 0.8]), was.shapes([0.4, 0.2, 0.6, 0.8])]],
  ["defocus?focus=2.9", "focus on the hollow ball", (now, was) => [now.shapes([0, 0.3, 0.4, 1]), was.shapes([0, 0.3, 0.4, 1])]],
  ["book?defocus=0", "the front of the crowd is sharp", (now, was) => [now.shapes([0, 0.8, 1, 1]), was.shapes([0, 0.8, 1, 1])]],
  ["book?defocus=0", "a pinhole camera", (now, was) => [now.shapes([0, 0.8, 1, 1]), was.shapes([0, 0.8, 1, 1])]],
  ["book?depth=2", "lose most of what they show", (now, was) => [now.light([0.4, 0.2, 0.6, 0.6]), was.light([0.4, 0.2, 0.6, 0.6])]],
];
