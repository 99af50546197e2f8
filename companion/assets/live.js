// The switches of live figures, and what a reader can do with a picture.

const REST_MS = 200;
const MOST_SCALE = 8;
const FIRST_SLIDERS = ["fuzz", "index", "defocus", "bounces", "vfov", "samples"];

let sharedGpu = null;
// Whether there is a device: a browser may have WebGPU without one.
let canRun = false;
const panels = [];

// The device, opened on first use. If it fails, every live picture becomes a still again.
function theGpu() {
  if (sharedGpu) return sharedGpu;
  const opening = (sharedGpu = Gpu.open());
  const forget = () => {
    if (sharedGpu === opening) sharedGpu = null;
  };
  opening.then((gpu) => {
    const fail = (reason) => {
      forget();
      panels.filter((panel) => panel.session?.gpu === gpu).forEach((panel) => panel.stop(reason));
      gpu.device.destroy();
    };
    gpu.device.lost.then(() => fail("The graphics device was lost. Press Run to start again."));
    gpu.device.addEventListener("uncapturederror", ({ error }) => fail(error.message));
  }, forget);
  return opening;
}

// What one press of Run starts: the reader's settings, and the film that is made of them. A loop belongs to one
// session and touches nothing after its end.
export class Session {
  constructor(panel, stage) {
    Object.assign(this, { panel, stage, isEnded: false, wake: () => {} });
    this.reset();
  }

  reset() {
    const { camera, depth, samples } = this.stage;
    this.settings = { camera, depth, samples, material: {} };
    this.change(this.film !== undefined);
    this.isChanged = false;
  }

  // Starts the film again. While something moves, pictures are as coarse as they must be to follow.
  change(isMoving = true) {
    this.isStale = this.isChanged = true;
    this.isMoving = isMoving;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => {
      this.isMoving = false;
      this.wake();
    }, REST_MS);
    this.wake();
  }

  // Whether the stage's buffers serve the camera after this move.
  allows(move) {
    return isServed(this.stage, move(this.settings.camera));
  }

  move(move) {
    this.settings.camera = move(this.settings.camera);
    this.change();
  }

  value(slider) {
    const { camera, material } = this.settings;
    if (slider.key === "focus") return focusDistance(camera);
    if (slider.key === "bounces") return this.settings.depth - 1;
    if (slider.key in MATERIAL_FIELDS) return material[this.stage.sliders.indexOf(slider)] ?? slider.value;
    return camera[slider.key] ?? this.settings[slider.key];
  }

  set(slider, value) {
    const { key } = slider, move = (camera) => ({ ...camera, [key]: value });
    if (key in this.settings.camera) {
      if (this.allows(move)) this.move(move);
    } else if (key in MATERIAL_FIELDS) {
      this.settings.material[this.stage.sliders.indexOf(slider)] = value;
      this.change();
    } else if (key === "bounces") {
      // A path has one ray more than bounces.
      this.settings.depth = value + 1;
      this.change();
    } else {
      this.settings[key] = value;
      // More samples continue the film; fewer need a new one.
      if (key === "samples" && value >= this.film?.done) this.wake();
      else this.change();
    }
  }

  async run() {
    this.gpu = await theGpu();
    try {
      await this.work();
    } finally {
      this.film?.destroy();
    }
  }

  async work() {
    while (!this.isEnded) {
      const isSeen = this.panel.isInView && !document.hidden;
      const needsFilm = this.isStale || (this.film.scale > 1 && !this.isMoving);
      if (!isSeen || (!needsFilm && this.film.done >= this.settings.samples)) {
        await new Promise((wake) => (this.wake = wake));
      } else if (needsFilm) {
        await this.startFilm();
      } else {
        await this.pass(this.film);
      }
    }
  }

  async startFilm() {
    this.isStale = false;
    const { width, height } = this.stage;
    let scale = 1;
    // A coarse picture has to be done after two dispatches.
    const affordable = 2 * (this.film?.kernel.budget.paths ?? Infinity);
    while (this.isMoving && scale < MOST_SCALE && (width * height) / scale ** 2 > affordable) scale *= 2;
    const old = this.film;
    const film = await Film.start(this.gpu, this.stage, this.settings, scale);
    old?.destroy();
    this.film = film;
    // A film that was started in a move shows its first pass, whatever has moved since.
    film.mayBeCut = !this.isMoving;
  }

  // Adds a block of samples to all pixels and shows the picture.
  async pass(film) {
    const block = film.block(this.settings.samples);
    for (let tile = 0; tile < film.tiles; ) {
      tile += await film.trace(tile, block);
      if (this.isEnded || (this.isStale && film.mayBeCut)) return;
      if (film.done === 0) this.panel.tell(`first sample: ${Math.round((100 * tile) / film.tiles)} %`);
    }
    film.done += block.count;
    const image = await film.image();
    if (this.isEnded) return;
    this.panel.show(image, film.done, this.settings.samples, film.seconds);
    await new Promise(requestAnimationFrame);
  }

  end() {
    this.isEnded = true;
    clearTimeout(this.rest);
    this.wake();
  }
}

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function toggle(textContent, onclick) {
  const button = element("button", { type: "button", textContent, onclick });
  button.setAttribute("aria-pressed", "false");
  return button;
}

// A panel's picture and its frame, where others can lie over it. A picture that is moved into a frame is painted again.
function framed(root) {
  const still = root.querySelector("img"), found = still.closest(".live-frame"), frame = found ?? element("div", { className: "live-frame" });
  if (!found) {
    still.replaceWith(frame);
    frame.append(still);
  }
  return [still, frame];
}

// Whether texts call a slider so: `fuzz` or, to tell one of several, `fuzz.left`.
const isCalled = ({ key, name }, wanted) => wanted === key || wanted === `${key}.${name}`;

// A figure's picture with its switch and sliders.
class Panel {
  constructor(root, stage) {
    const [still, frame] = framed(root);
    Object.assign(this, { root, stage, session: null, linked: [this], isInView: true, inputs: [] });
    this.canvas = element("canvas", { className: `live-canvas ${still.className}`, hidden: true });
    this.canvas.setAttribute("role", stage.has_rays ? "application" : "img");
    this.canvas.setAttribute("aria-label", still.alt);
    this.hint = element("span", { className: "live-hint", textContent: "drag to turn", hidden: true });
    frame.append(this.canvas, this.hint);
    // A part that is shown enlarged follows the picture.
    const part = root.querySelector(".crop img");
    if (part) {
      this.part = element("canvas", { hidden: true });
      this.part.style.cssText = part.style.cssText;
      part.after(this.part);
    }

    this.button = toggle("Run", () => (this.session ? this.stop("") : this.start()));
    const button = (textContent, onclick) => element("button", { type: "button", textContent, onclick });
    this.adjust = button("Adjust", () => this.open(this.sliders.hidden));
    this.reset = button("Reset", () => {
      for (const panel of this.linked.filter(({ session }) => session)) {
        panel.session.reset();
        panel.update();
      }
    });
    this.label = root.querySelector(".label[data-label]");
    this.told = element("span", { className: "live-told" });
    this.said = element("span", { className: "live-told" });
    this.said.setAttribute("role", "status");
    this.sliders = element("div", { className: "live-sliders", hidden: true });
    const hint =
      "Drag to turn, pinch to come closer. Or click the picture, then use the wheel, the arrow keys, plus and minus.";
    this.sliders.append(element("p", { textContent: hint }));
    this.bar = element("div", { className: "live-bar" }, this.button, this.adjust, this.reset, this.told, this.said);
    root.append(element("div", { className: "live-controls" }, this.bar, this.sliders));
    this.open(false);
    this.update();
    this.button.hidden = this.bar.hidden = !canRun;
    if (stage.has_rays) this.listen();
    const watcher = new IntersectionObserver((entries) => {
      this.isInView = entries.at(-1).isIntersecting;
      this.session?.wake();
    });
    watcher.observe(frame);
  }

  // The slider that a link of the page or the stage's material asks for comes first; the others are folded.
  addSliders() {
    const { sliders } = this.stage, link = document.querySelector(`a.try[data-stage="${this.root.dataset.stage}"]`);
    const wanted = [link?.dataset.set.split(/[.=]/)[0], ...FIRST_SLIDERS].find((key) => sliders.some((slider) => slider.key === key));
    const more = element("details", {}, element("summary", { textContent: "More" }));
    const [first, others] = [true, false].map((isFirst) => sliders.filter((slider) => (slider.key === wanted) === isFirst));
    this.inputs = [...first.map((slider) => this.slider(slider, this.sliders)), ...others.map((slider) => this.slider(slider, more))];
    if (others.length) this.sliders.append(more);
  }

  slider(slider, place) {
    const { min, max, step, label, unit, key } = slider;
    const [read, write] = key === "samples" ? [(x) => 2 ** x, Math.log2] : [Number, (x) => x];
    const input = element("input", { type: "range", min, max, step });
    const output = element("output");
    place.append(element("label", {}, element("span", { textContent: label }), input, output));
    input.oninput = () => this.change(slider, read(input.value));
    return () => {
      const value = this.session?.value(slider) ?? slider.value;
      input.value = write(value);
      output.textContent = `${+value.toFixed(2)}${unit}`;
    };
  }

  // Two views under one seam stay one view.
  change(slider, value) {
    const isShared = (panel) => panel === this || (slider.key === "vfov" && panel.stage.camera.vfov === this.stage.camera.vfov);
    const live = this.linked.filter((panel) => panel.session && isShared(panel));
    if (slider.key === "vfov" && !live.every(({ session }) => session.allows((camera) => ({ ...camera, vfov: value })))) return;
    for (const panel of live) {
      const own = panel.stage.sliders.find(({ key, label }) => key === slider.key && label === slider.label);
      if (own) panel.session.set(own, value);
      panel.update();
    }
  }

  // The label says what the picture shows: its numbers come from the state.
  name(valueOf) {
    if (!this.label) return;
    const number = (wanted) => +valueOf(this.stage.sliders.find((slider) => isCalled(slider, wanted))).toFixed(2);
    const said = this.label.dataset.label.replace(/{(.*?)}/g, (_, wanted) => number(wanted));
    this.label.textContent = said.replace(/\b1 (sample|bounce|degree)s/, "1 $1");
  }

  update() {
    this.inputs.forEach((show) => show());
    this.name((slider) => this.session?.value(slider) ?? slider.value);
    const isLive = this.session !== null;
    // A second picture of the usual settings leaves while the settings are others.
    this.root.classList.toggle("changed", Boolean(this.session?.isChanged));
    this.button.textContent = isLive ? "Stop" : "Run";
    this.button.setAttribute("aria-pressed", isLive);
    this.adjust.hidden = !isLive || this.inputs.length === 0;
    this.reset.hidden = this.adjust.hidden;
  }

  open(isOpen) {
    this.sliders.hidden = !isOpen;
    this.adjust.setAttribute("aria-expanded", isOpen);
  }

  start() {
    const { stage } = this;
    stage.buffers = stage.buffers.map((buffer) => (typeof buffer === "string" ? decoded(buffer) : buffer));
    if (this.inputs.length === 0) this.addSliders();
    this.said.textContent = "";
    this.tell("starting");
    this.unset();
    const session = (this.session = new Session(this, stage));
    this.update();
    // Under a seam, a still could show another view.
    for (const panel of this.linked) if (!panel.session) panel.start();
    session.run().catch(async (error) => {
      // If the device was lost, all its work fails, often before the loss is known; that message is the better one.
      await new Promise((passed) => setTimeout(passed, REST_MS));
      if (!session.isEnded) this.stop(error.message);
    });
  }

  // Without WebGPU, a link shows a picture of its settings that was made with the page.
  showStill(file, settings) {
    const [still] = framed(this.root), part = this.root.querySelector(".crop img");
    this.usual ??= [still, part].filter(Boolean).map((image) => [image, image.src, image.srcset]);
    for (const [image] of this.usual) Object.assign(image, { srcset: "", src: file });
    const wanted = new URLSearchParams(settings);
    this.name((slider) => {
      const found = [...wanted].find(([name]) => isCalled(slider, name));
      return found ? Number(found[1]) : slider.value;
    });
    this.back ??= this.root.appendChild(element("button", { type: "button", className: "live-back", textContent: "Back to the usual picture", onclick: () => this.unset() }));
    this.back.hidden = false;
    this.root.classList.add("changed");
  }

  unset() {
    if (!this.usual) return;
    for (const [image, src, srcset] of this.usual) Object.assign(image, { src, srcset });
    this.usual = null;
    this.back.hidden = true;
    this.root.classList.remove("changed");
    this.name((slider) => slider.value);
  }

  // Back to the still, with a sentence for the reader if there is something to say.
  stop(reason) {
    this.session?.end();
    this.session = null;
    this.pointers?.clear();
    this.canvas.hidden = this.hint.hidden = true;
    if (this.part) this.part.hidden = true;
    this.tell("");
    this.said.textContent = reason;
    this.open(false);
    this.update();
  }

  show(image, done, wanted, seconds) {
    const { canvas } = this;
    if (canvas.width !== image.width || canvas.height !== image.height) {
      [canvas.width, canvas.height] = [image.width, image.height];
    }
    canvas.getContext("2d").putImageData(image, 0, 0);
    canvas.hidden = false;
    // The samples of an unchanged picture fade in over the still, which has less noise.
    canvas.style.opacity = this.session.isChanged ? 1 : Math.min(1, done / wanted);
    if (this.part) {
      [this.part.width, this.part.height] = [image.width, image.height];
      this.part.getContext("2d").putImageData(image, 0, 0);
      this.part.hidden = false;
    }
    this.hint.hidden = this.hasMoved || !this.stage.has_rays;
    this.hint.textContent = this.linked.length > 1 ? "drag to turn both, or drag the handle" : "drag to turn";
    this.tell(`${done} of ${wanted} samples, ${seconds.toFixed(1)} s`);
  }

  tell(text) {
    this.told.textContent = text;
  }

  // Starts the picture with these settings, such as `fuzz=1` or `fuzz.left=0&depth=2`, as the text asks for them.
  try(settings) {
    if (this.session) this.reset.click();
    else this.start();
    for (const [wanted, value] of new URLSearchParams(settings)) {
      this.stage.sliders.filter((slider) => isCalled(slider, wanted)).forEach((slider) => this.change(slider, Number(value)));
    }
    this.open(true);
    this.update();
  }

  // By the first of these moves that all views allow.
  move(...moves) {
    this.hasMoved = this.hint.hidden = true;
    const live = this.linked.filter(({ session }) => session);
    const move = moves.find((move) => live.every(({ session }) => session.allows(move)));
    for (const panel of move ? live : []) {
      panel.session.move(move);
      panel.update();
    }
  }

  listen() {
    const { canvas } = this;
    canvas.tabIndex = 0;
    canvas.setAttribute("aria-description", "Arrow keys turn the scene, plus and minus move the camera.");
    const pointers = (this.pointers = new Map());
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
    };
    const turn = (right, up) => {
      this.move((c) => orbit(c, right, up), (c) => orbit(c, right, 0), (c) => orbit(c, 0, up));
    };
    const approach = (factor) => this.move((c) => dolly(c, factor));
    canvas.onpointerdown = (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    };
    canvas.onpointermove = (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const spreadBefore = spread();
      const now = { x: event.clientX, y: event.clientY };
      pointers.set(event.pointerId, now);
      const radiansPerPixel = Math.PI / canvas.clientWidth;
      if (pointers.size === 1) turn((now.x - before.x) * radiansPerPixel, (now.y - before.y) * radiansPerPixel);
      else if (spread() > 0) approach(spreadBefore / spread());
    };
    canvas.onpointerup = canvas.onpointercancel = canvas.onlostpointercapture = (event) => pointers.delete(event.pointerId);
    // The wheel scrolls the page until the picture has been clicked.
    canvas.onwheel = (event) => {
      if (document.activeElement !== canvas) return;
      event.preventDefault();
      approach(Math.exp(clamped(event.deltaY, -200, 200) / 600));
    };
    const keys = {
      ArrowLeft: () => turn(-0.1, 0),
      ArrowRight: () => turn(0.1, 0),
      ArrowUp: () => turn(0, -0.1),
      ArrowDown: () => turn(0, 0.1),
      "+": () => approach(0.9),
      "-": () => approach(1 / 0.9),
    };
    canvas.onkeydown = (event) => {
      if (!(event.key in keys) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      keys[event.key]();
    };
  }
}

// In a figure of two pictures of one shape, a button lays the second over the first, as far as a slider says. A drag
// then turns both, if they are live.
function addWipe(root, live) {
  const [first, second] = root.querySelectorAll(".panel");
  const shape = (panel) => ["width", "height"].map((side) => panel.querySelector("img").getAttribute(side));
  const [[aWidth, aHeight], [bWidth, bHeight]] = [first, second].map(shape);
  if (aWidth * bHeight !== aHeight * bWidth) return;
  const slider = element("input", { type: "range", className: "live-wipe", min: 0, max: 100, step: 0.5, value: 50 });
  slider.setAttribute("aria-label", "Wipe between the two pictures");
  slider.hidden = true;
  slider.oninput = () => root.style.setProperty("--live-wipe", `${slider.value}%`);
  // The seam follows the pointer from its handle or, over stills, from anywhere.
  const grab = (event) => {
    const { target } = event, { left, width } = root.getBoundingClientRect();
    if (slider.hidden || (target !== slider && (live.some((panel) => panel.session) || !target.closest(".live-frame")))) return;
    event.preventDefault();
    slider.focus();
    const follow = ({ clientX }) => {
      slider.value = (100 * (clientX - left)) / width;
      slider.oninput();
    };
    follow(event);
    target.setPointerCapture(event.pointerId);
    target.onpointermove = follow;
    target.onlostpointercapture = () => (target.onpointermove = null);
  };
  root.addEventListener("pointerdown", grab);
  const button = toggle("Wipe", () => {
    const isOn = slider.hidden;
    slider.hidden = !isOn;
    slider.oninput();
    root.classList.toggle("live-wiping", isOn);
    button.setAttribute("aria-pressed", isOn);
    for (const panel of live) panel.linked = isOn ? live : [panel];
    // A still beside a picture that was turned would show another view.
    const running = live.find((panel) => panel.session);
    if (!isOn || !running) return;
    const { from, at, up } = running.session.settings.camera;
    for (const panel of live) {
      if (!panel.session) panel.start();
      if (panel !== running) panel.session.move((camera) => ({ ...camera, from, at, up }));
    }
  });
  let bar = second.querySelector(".live-bar");
  if (!bar) {
    for (const panel of [first, second]) framed(panel);
    bar = element("div", { className: "live-bar" });
    second.append(element("div", { className: "live-controls" }, bar));
  }
  bar.hidden = false;
  bar.insertBefore(button, bar.children[1] ?? null);
  root.append(slider);
}

// Brings a picture that is out of view beside the text, until Escape or its button sends it back.
let docked = null;
function undock() {
  if (!docked) return;
  const { panel, place, link } = docked;
  docked = null;
  place.replaceWith(panel.root);
  document.querySelector(".live-dock").remove();
  link.focus({ preventScroll: true });
}
function dock(panel, link) {
  if (docked?.panel === panel) return;
  undock();
  const frame = panel.canvas.parentElement, { top, bottom, height } = frame.getBoundingClientRect();
  if (Math.min(bottom, innerHeight) - Math.max(top, 0) > height / 2) return;
  // A figure within a screen is scrolled to: docked, it would hide the text around it.
  if (top > -innerHeight && bottom < 2 * innerHeight) return frame.scrollIntoView({ block: top < 0 ? "start" : "end" });
  const place = element("div", { className: "panel" });
  place.style.height = `${panel.root.offsetHeight}px`;
  panel.root.replaceWith(place);
  const back = element("button", { type: "button", textContent: "Back to its place (Esc)", onclick: undock });
  document.querySelector("main").append(element("aside", { className: "live-dock panels", ariaLabel: "Live picture" }, back, panel.root));
  docked = { panel, place, link };
}

async function start(given) {
  // One Escape closes one thing.
  addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || event.defaultPrevented || !docked) return;
    event.preventDefault();
    undock();
  });
  use(given);
  canRun = Boolean(await navigator.gpu?.requestAdapter().catch(() => null));
  document.documentElement.classList.toggle("gpu", canRun);
  for (const root of document.querySelectorAll(".panels")) {
    const made = [...root.querySelectorAll(".panel[data-stage]")]
      .filter((panel) => data.stages[panel.dataset.stage])
      .map((panel) => (panel.live = new Panel(panel, data.stages[panel.dataset.stage])));
    panels.push(...made);
    if (root.querySelectorAll(".panel").length === 2) addWipe(root, made);
    // The page answers between two figures.
    await new Promise((passed) => setTimeout(passed));
  }
  if (!canRun) say("In a browser with WebGPU, the pictures of this page can be turned and changed.");
  for (const link of document.querySelectorAll("a.try")) {
    const panel = document.querySelector(link.hash).querySelector(`[data-stage="${link.dataset.stage}"]`).live;
    link.addEventListener("click", (event) => {
      if (!panel) return;
      event.preventDefault();
      if (canRun) panel.try(link.dataset.set);
      else panel.showStill(link.dataset.still, link.dataset.set);
      dock(panel, link);
    });
  }
  document.addEventListener("visibilitychange", () => panels.forEach((panel) => panel.session?.wake()));
}

// A sentence below the first live picture.
function say(textContent) {
  document.querySelector(".panel[data-stage]")?.after(element("p", { className: "live-notice", textContent }));
}

// Data and fonts that the first screen does not need can be in a file of their own.
function load() {
  const onload = () => {
    const { fonts, live } = globalThis.later;
    document.head.append(element("style", { textContent: fonts }));
    start(live);
  };
  const onerror = () => say("The file later.js is missing beside this page, so its pictures cannot run.");
  document.head.append(element("script", { src: "later.js", onload, onerror }));
}

if (typeof document !== "undefined") {
  const embedded = document.getElementById("live-data");
  if (embedded) start(JSON.parse(embedded.textContent));
  else if (document.readyState === "complete") load();
  else addEventListener("load", load);
}
