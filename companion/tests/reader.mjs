// Uses the companion as a reader would and prints what it saw as JSON: see src/tests/reader.rs.
// Usage: node reader.mjs PAGE.html
import { existsSync, readFileSync } from "node:fs";
import { delimiter, dirname, join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { Picture, claims } from "./claims.mjs";

const executablePath = process.env.PATH.split(delimiter).map((path) => join(path, "chromium")).find(existsSync);
const flags = ["--no-sandbox", "--headless=new", "--enable-unsafe-webgpu", "--disable-gpu-compositing"];
const vulkan = ["--enable-features=Vulkan", "--use-vulkan=swiftshader"];
const browser = await chromium.launch({ executablePath, args: [...flags, ...vulkan] });
setTimeout(() => process.exit(1), 400_000).unref();
const seen = { console: [], cut: [], still: [], links: [], set: [] };
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
page.on("console", (message) => seen.console.push(message.text()));
page.on("pageerror", (error) => seen.console.push(String(error)));
// What a link sets is seen without rendering: pictures wait for the device until it is let go.
await page.addInitScript(() => {
  const { requestDevice } = GPUAdapter.prototype, isFree = new Promise((free) => (window.freeDevice = free));
  GPUAdapter.prototype.requestDevice = async function (...given) {
    await isFree;
    return requestDevice.apply(this, given);
  };
});
await page.goto(pathToFileURL(process.argv[2]).href);

// Code that is wider than its box, in each language; and a page that is wider than the window.
for (const width of [400, 800, 1280, 1920]) {
  await page.setViewportSize({ width, height: 900 });
  const cut = await page.evaluate(() => {
    const all = [...document.querySelectorAll("pre")];
    all.forEach((pre) => pre.parentElement.classList.add("shown"));
    document.querySelectorAll(".fold").forEach((fold) => (fold.open = true));
    const wide = all.filter((pre) => pre.scrollWidth > pre.clientWidth).map((pre) => pre.textContent.slice(0, 60));
    return [...wide, ...(document.documentElement.scrollWidth > innerWidth ? ["the page"] : [])];
  });
  seen.cut.push(...cut.map((text) => `${width}: ${text}`));
}
await page.setViewportSize({ width: 1280, height: 900 });

// Diagrams that come near start, and the page moves until then.
const placed = async (element) => {
  await element.scrollIntoViewIfNeeded();
  await element.evaluate(async (element) => {
    const frame = () => new Promise(requestAnimationFrame), top = () => element.getBoundingClientRect().top;
    for (let still = 0, before = top(); still < 3; before = top()) {
      await frame();
      still = top() === before ? still + 1 : 0;
    }
  });
  return element.boundingBox();
};

// Diagrams start when the reader comes near.
for (const figure of await page.locator("figure:is(.diagram, .timeline)").all()) await figure.scrollIntoViewIfNeeded();
await page.locator("figure:has(.reading)").nth(28).waitFor({ state: "attached" });

// Each handle is dragged and moved by keys, each slider is set: the drawing or its reading must change.
for (const figure of await page.locator("figure:has(.reading)").all()) {
  const id = await figure.getAttribute("id");
  const changes = async (name, act) => {
    // What is drawn may change without the reading, but not the handle alone.
    const look = () => figure.evaluate((figure) => figure.querySelector(".reading").textContent + figure.querySelector("svg > g")?.innerHTML);
    const before = await look();
    const hasChanged = async () => (await look()) !== before;
    await act(hasChanged);
    if (!(await hasChanged())) seen.still.push(`${id}: ${name}`);
  };
  for (const knob of await figure.locator(".knob").all()) {
    const name = await knob.getAttribute("aria-label");
    await changes(`drag ${name}`, async () => {
      const { x, y, width } = await placed(knob);
      await page.mouse.move(x + width / 2, y + width / 2);
      await page.mouse.down();
      await page.mouse.move(x + 40, y + 45);
      await page.mouse.up();
    });
    await changes(`keys ${name}`, async (hasChanged) => {
      await knob.focus();
      // A handle may be at an end, or move less than the drawing shows.
      for (const key of "ArrowLeft ArrowUp ".repeat(6).trim().split(" ")) if (!(await hasChanged())) await page.keyboard.press(key);
    });
  }
  for (const slider of await figure.locator("input").all()) {
    await changes("slider", async () => {
      await slider.focus();
      await page.keyboard.press((await slider.inputValue()) === (await slider.getAttribute("max")) ? "Home" : "End");
    });
  }
}
seen.diagrams = await page.locator("figure:has(.reading)").count();

// Two still pictures can be wiped, too.
const pair = page.locator("[id^=denoised-]");
await pair.getByRole("button", { name: "Wipe" }).click();
if ((await pair.locator(".live-wiping").count()) !== 1) seen.still.push("the wipe of a denoised picture");

// The seam follows a pointer that moves fast, from its handle and from anywhere on the pictures.
const seam = () => pair.locator(".panels").evaluate((panels) => parseFloat(panels.style.getPropertyValue("--live-wipe")));
const { x, y, width, height } = await placed(pair.locator(".panels"));
for (const from of [0.5, 0.2]) {
  await page.mouse.move(x + from * width, y + height / 3);
  await page.mouse.down();
  await page.mouse.move(x + 0.9 * width, y + height / 3);
  await page.mouse.up();
  if (Math.abs((await seam()) - 90) > 2) seen.still.push(`the seam, dragged from ${from}`);
  await page.mouse.move(x + 0.9 * width, y + height / 3);
  await page.mouse.down();
  await page.mouse.move(x + 0.5 * width, y + height / 3);
  await page.mouse.up();
}

// Find leads to a text by Enter and says when it finds nothing. Back leads to where the reader was, and so does a reload.
const field = page.getByRole("searchbox");
// Whether this comes to hold, and goes on to.
const becomes = async (holds, given) => {
  const isSo = await page.waitForFunction(holds, given, { timeout: 5_000 }).catch(() => null);
  await page.evaluate(() => new Promise((passed) => setTimeout(passed, 100)));
  return isSo !== null && page.evaluate(holds, given);
};
const isAt = (given) => becomes(([id, top]) => Math.abs(document.getElementById(id).getBoundingClientRect().top - top) <= 3, given);
const leads = (hash) => becomes((hash) => location.hash === hash, hash);
await field.fill("zyzzyva");
if (!(await page.locator(".count").innerText()).includes("Nothing")) seen.still.push("a search for nothing");
await field.fill("archimedes");
await field.press("Enter");
if (!(await becomes(() => document.querySelectorAll(".found-here").length === 1))) seen.still.push("a search in the text");
const metal = page.locator("#figure-metal"), { y: top } = await placed(metal);
await page.locator("#figure-metal ~ p a[href='#camera']").first().click();
if (!(await leads("#camera"))) seen.still.push("a link to a chapter");
await page.goBack();
if (!(await isAt(["figure-metal", top]))) seen.still.push(`Back: ${(await placed(metal)).y} instead of ${top}`);
await page.reload();
if (!(await isAt(["figure-metal", top]))) seen.still.push(`reload: ${(await placed(metal)).y} instead of ${top}`);
await page.goto(`${page.url().split("#")[0]}#term-lane`);
const { y: termTop } = await placed(page.locator("#term-lane"));
await page.mouse.wheel(0, 30);
if (!(await isAt(["term-lane", termTop - 30])) || !(await leads("#term-lane"))) seen.still.push("a deep link");

// Each link that sets a picture: it comes to the reader, with the state that the program has of the link (the test
// compares them), and returns. The next link of a stage finds it set by the last.
const click = (link) => link.evaluate((link) => {
  const { live } = document.querySelector(`:is(${link.hash}, .live-dock) [data-stage="${link.dataset.stage}"]`);
  link.click();
  const { top, bottom } = live.canvas.parentElement.getBoundingClientRect();
  const wasNear = top < innerHeight && bottom > 0;
  dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
  const isGood = wasNear && document.querySelector(link.hash).contains(live.root);
  return { stage: link.dataset.stage, set: link.dataset.set, still: link.dataset.still, settings: { ...live.session.settings }, isGood };
});
// What the text says must hold of the picture of that state, which the program renders for the page.
const folder = dirname(process.argv[2]);
const drawn = async (file) => {
  const address = `data:image/png;base64,${readFileSync(join(folder, file)).toString("base64")}`;
  return new Picture(await page.evaluate(async (address) => {
    const image = Object.assign(new Image(), { src: address });
    await image.decode();
    return window.pixels(image);
  }, address));
};
await page.evaluate(() => {
  window.pixels = (image) => {
    const canvas = new OffscreenCanvas(480, Math.round((480 * image.height) / image.width)), context = canvas.getContext("2d");
    context.drawImage(image, 0, 0, canvas.width, canvas.height);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    let letters = "";
    for (let i = 0; i < data.length; i += 30000) letters += String.fromCharCode(...data.subarray(i, i + 30000));
    return { width: canvas.width, height: canvas.height, data: btoa(letters) };
  };
});
const found = new Set(), usual = new Map();
const check = (rows, now, stage, how) => {
  for (const row of rows) {
    const holds = row[2](now, usual.get(stage), usual);
    if (holds !== true) seen.links.push(`${row[0]}, ${how}: “${row[1]}” is not true: ${JSON.stringify(holds)}`);
  }
};
const rowsOf = new Map(), own = [];
for (const link of await page.locator("a.try").all()) {
  const text = (await link.evaluate((link) => link.closest("p, li, figcaption").textContent)).replace(/\s+/g, " ");
  await placed(link);
  const { still, isGood, ...state } = await click(link), key = `${state.stage}?${state.set}`;
  seen.set.push(state);
  const rows = claims.filter(([wanted, words]) => wanted === key && text.includes(words));
  if (rows.length === 0) seen.links.push(`${key}: claims.mjs has no words of “${text}”`);
  if (!isGood) seen.links.push(`${key}: the picture does not come and return`);
  if (!usual.has(state.stage)) usual.set(state.stage, await drawn(`figures/${state.stage}.png`));
  // The steps of a rim's staircase are those of the stage's own size.
  if (state.set.startsWith("samples")) own.push(key);
  else check(rows, await drawn(still), state.stage, "still");
  rows.forEach((row) => found.add(row));
  rowsOf.set(key, rows);
}
seen.links.push(...claims.filter((row) => !found.has(row)).map(([key, words]) => `${key}: no link says “${words}”`));

// A label says what its picture shows, and Reset and Stop bring the usual numbers back.
const linked = page.locator('a.try[data-set="samples=1"]'), named = page.locator('#figure-antialiasing .panel[data-stage="antialiased"] .label');
await placed(linked);
await linked.click();
if ((await named.innerText()) !== "1 sample per pixel") seen.still.push(`a label: ${await named.innerText()}`);
await page.locator('#figure-antialiasing .panel[data-stage="antialiased"]').evaluate((panel) => panel.live.stop(""));
if ((await named.innerText()) !== "64 samples per pixel") seen.still.push(`a label after Stop: ${await named.innerText()}`);

// A link of each kind is rendered: samples, the camera and the material.
await page.evaluate(() => {
  document.querySelectorAll(".panel[data-stage]").forEach(({ live }) => live?.stop(""));
  window.freeDevice();
});
for (const key of [...own, "normals?vfov=120", "glass-schlick?index=2.4"]) {
  const [stage, set] = key.split("?"), link = page.locator(`a.try[data-stage="${stage}"][data-set="${set}"]`).first();
  const panel = await page.locator(`${await link.getAttribute("href")} .panel[data-stage="${stage}"]`).elementHandle();
  await placed(link);
  await link.click();
  const samples = await panel.evaluate(({ live: { session } }) => {
    session.change(false);
    return (session.settings.samples = Math.min(session.settings.samples, 4));
  });
  await page.waitForFunction(([{ live: { session, stage, told } }, samples]) => {
    const { film, isStale } = session;
    return film && !isStale && film.width === stage.width && told.textContent.startsWith(`${samples} of`);
  }, [panel, samples], { timeout: 60_000 });
  check(rowsOf.get(key), new Picture(await panel.evaluate(({ live }) => window.pixels(live.canvas))), stage, "live");
  await panel.evaluate(({ live }) => live.stop(""));
}

// The right picture beside a mistake comes by keys, too.
const mistake = page.locator(".mistakes[data-has-right] img[tabindex]").first();
await mistake.focus();
if ((await mistake.locator("xpath=following-sibling::img").evaluate((right) => getComputedStyle(right).opacity)) !== "1") seen.still.push("a mistake, by keys");

// A dropped file does not replace the page, and one line says what to do instead.
const dropped = await page.evaluate(() => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File(["P6"], "mine.ppm"));
  const event = new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true });
  document.querySelector("#figure-metal").dispatchEvent(event);
  return event.defaultPrevented && document.querySelectorAll(".check-missing, .cover .check-box").length === 1;
});
if (!dropped) seen.still.push("a drop");

// [ and ] make a place to come back to.
await page.evaluate(() => document.getElementById("diffuse").scrollIntoView());
await becomes(() => document.querySelector(".contents [aria-current]")?.hash.startsWith("#diffuse"));
await page.keyboard.press("]");
if (!(await leads("#metal"))) seen.still.push(`] leads to ${page.url()}`);

// Without WebGPU, a link shows a still of its state.
const plain = await browser.newPage({ viewport: { width: 1280, height: 900 } });
await plain.addInitScript(() => Object.defineProperty(Navigator.prototype, "gpu", { get: () => undefined }));
await plain.goto(pathToFileURL(process.argv[2]).href);
await plain.locator(".live-notice").waitFor();
await plain.locator('a.try[data-stage="antialiased"]').first().click();
const shows = plain.locator('.panel[data-stage="antialiased"]:has(.live-back)');
if (!(await shows.locator("img").first().getAttribute("src")).includes("antialiased-try")) seen.still.push("a link without WebGPU");
if ((await shows.locator(".label").innerText()) !== "1 sample per pixel") seen.still.push("a label without WebGPU");
await shows.locator(".live-back").click();
if ((await shows.locator("img").first().getAttribute("src")).includes("try")) seen.still.push("the usual picture without WebGPU");
if (await plain.locator(".runs:visible, .live-bar button:visible:text-is('Run')").count()) seen.still.push("Run, where nothing runs");
console.log(JSON.stringify(seen));
await browser.close();
