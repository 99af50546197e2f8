// The check of the reader's own picture. The picture goes to the program, compiled for browsers, which runs in a worker
// and sees only that file; its answer is shown where the picture was dropped.
{
  const { program, stages, scale, pixel_limit: pixelLimit } = JSON.parse(document.getElementById("check-data").textContent);
  const make = (name, properties, ...inside) => {
    const element = Object.assign(document.createElement(name), properties);
    element.append(...inside);
    return element;
  };
  const button = (textContent, act) => {
    const element = make("button", { type: "button", textContent });
    element.addEventListener("click", act);
    return element;
  };
  const install = () => make("a", { href: "#start-install", textContent: "install Weekender" });

  // Screen readers hear the beginning and the answer, but not each step.
  const heard = document.body.appendChild(make("p", { className: "hidden", role: "status" }));
  const panel = make("section", { className: "check", ariaLabel: "Check of your picture" });
  const input = make("input", { type: "file", accept: ".ppm,.pgm,.pnm,.png,image/png", hidden: true, ariaLabel: "Your picture" });
  document.body.append(input);

  // The file with its bytes, the stage that the reader has chosen, and the place of the answer.
  let file, bytes, stage, place, worker, timer, run = 0, urls = [];

  // The places: below the title, and at the mistakes of each chapter. Without the program, one line at the end of the first
  // chapter says how to check a picture.
  const boxes = [];
  const addBox = (box, text) => {
    const choose = button("Choose a file", () => {
      place = box;
      input.click();
    });
    box.append(make("p", {}, make("strong", { textContent: `${text} ` }), "Drop the PPM or PNG that your ray tracer wrote here or anywhere on this page, or paste it. It does not leave your computer. ", choose));
    boxes.push(box);
  };
  const missing = () => [
    "This copy of the page cannot check pictures; ", make("code", { textContent: "weekender check mine.ppm" }), " can: ", install(), ".",
  ];
  if (program) addBox(document.querySelector(".cover .check-box"), "Is your own picture right?");
  else document.querySelector(".chapter").append(make("p", { className: "check-missing" }, ...missing()));
  for (const heading of program ? document.querySelectorAll("h3[data-mistakes]") : []) {
    let last = heading;
    while (last.nextElementSibling?.matches(".mistakes, .mistakes-hint")) last = last.nextElementSibling;
    const box = make("div", { className: "check-box" });
    last.after(box);
    addBox(box, "Is yours right?");
  }

  // The script is loaded when it is first needed. Pages from a disk cannot fetch, but they can load scripts.
  let loaded;
  const load = async () => {
    await new Promise((resolve, reject) => {
      const script = make("script", { src: program });
      script.addEventListener("load", resolve);
      script.addEventListener("error", () => reject(new Error("missing")));
      document.head.append(script);
    });
    const { host, module } = globalThis.weekenderProgram;
    const packed = new Blob([Uint8Array.from(atob(module), (letter) => letter.charCodeAt(0))]);
    const bytes = await new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
    const source = `${host}
onmessage = ({ data: [module, args, files] }) => {
  try {
    postMessage({ result: weekender(module, args, files, (line) => postMessage({ line })) });
  } catch (error) {
    postMessage({ failure: String(error) });
  }
};`;
    return { module: await WebAssembly.compile(bytes), source: URL.createObjectURL(new Blob([source], { type: "text/javascript" })) };
  };
  // A module with one SIMD instruction.
  const hasSimd = () => WebAssembly.validate(Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11));

  const end = () => {
    worker?.terminate();
    clearInterval(timer);
    worker = timer = undefined;
    run++;
  };
  const close = () => {
    end();
    panel.remove();
    urls.forEach((url) => URL.revokeObjectURL(url));
    urls = [];
  };
  // A reader who has gone elsewhere meanwhile stays there.
  const show = (said, isNew, ...inside) => {
    const { top, bottom } = panel.getBoundingClientRect(), isSeen = isNew || (bottom > 0 && top < innerHeight);
    heard.textContent = said;
    panel.replaceChildren(...inside);
    if (isSeen) panel.scrollIntoView({ block: panel.offsetHeight > 0.9 * innerHeight ? "start" : "nearest" });
  };
  const refuse = (...words) => {
    end();
    const text = make("p", {}, ...words);
    show(text.textContent, false, make("p", { className: "check-verdict check-bad", textContent: `${file.name}: this picture cannot be checked` }), text, closing());
  };
  const closing = () => make("p", { className: "check-buttons" }, button("Another picture", () => input.click()), button("Close", close));

  const LARGEST = 1 << 28;
  // The pixels that the head of a PNG or a PPM promises.
  const pixelsOf = (data) => {
    const view = new DataView(data), head = new TextDecoder("latin1").decode(data.slice(0, 512));
    if (head.startsWith("\x89PNG") && data.byteLength > 24) return view.getUint32(16) * view.getUint32(20);
    const [, width, height] = head.replace(/#.*/g, "").match(/^P\d\s*(\d+)\s+(\d+)/) ?? [];
    return width * height || 0;
  };

  // Checks `file` in place of whatever is checked or shown.
  const check = async () => {
    close();
    place.after(panel);
    const what = stage ? stages.find(([id]) => id === stage).slice(1).join(" ") : "every section of the book";
    const tried = make("p", { className: "check-tried", textContent: "Loading the program" }), seconds = make("span");
    const began = performance.now();
    timer = setInterval(() => (seconds.textContent = `${Math.round((performance.now() - began) / 1000)} s`), 1000);
    show(`Checking ${file.name}`, true,
      make("p", {}, make("strong", { textContent: `Comparing ${file.name} with ${what} and the known mistakes. ` }), seconds), tried,
      make("p", { className: "check-buttons" }, button("Cancel (Esc)", cancel)));
    const instead = [" Update the browser, or ", install(), " and run ", make("code", { textContent: "weekender check" }), "."];
    if (!program) return refuse(...missing());
    if (!hasSimd()) return refuse("This browser’s WebAssembly has no SIMD, which the program needs.", ...instead);
    if (!globalThis.DecompressionStream) return refuse("This browser cannot unpack the program: it has no DecompressionStream.", ...instead);
    if (file.size > LARGEST) return refuse(`It has ${Math.round(file.size / 1e6)} MB, more than ${LARGEST >> 20} MiB; the book’s 400 x 225 pixels are enough for a check.`);
    const own = file, mine = run, isOther = () => mine !== run;
    try {
      // The bytes are read once, since a file may change; each check gets a copy.
      const data = await (bytes ??= own.arrayBuffer()).catch(() => null);
      if (isOther()) return;
      if (!data) {
        bytes = undefined;
        return refuse("The file cannot be read, or has changed since. Choose it again.");
      }
      if (pixelsOf(data) > pixelLimit) return refuse("It has more pixels than the memory of a page allows. Render it at 400 x 225, which is enough for a check.");
      const { module, source } = await (loaded ??= load().catch((error) => {
        loaded = undefined;
        throw error;
      }));
      if (isOther()) return;
      worker = new Worker(source);
      worker.addEventListener("error", ({ message }) => refuse(`The program cannot be started: ${message}`));
      const lines = [];
      worker.addEventListener("message", ({ data: { line, result, failure } }) => {
        if (line !== undefined) {
          lines.push(line);
          tried.textContent = line.replace(/[\w.-]+$/, (id) => stages.find((known) => known[0] === id)?.slice(1).join(" ") ?? id);
        } else if (result?.files[FINDING]) {
          end();
          answer(JSON.parse(new TextDecoder().decode(result.files[FINDING])), result.files);
        } else {
          const reason = lines.find((text) => text.startsWith("error: "))?.slice(7) ?? `The program has failed: ${lines.at(-1) ?? failure}`;
          refuse(`${reason.startsWith(own.name) ? reason : reason[0].toUpperCase() + reason.slice(1)}.`);
        }
      });
      const name = own.name.replaceAll("/", "_").replace(/^-?$/, "picture");
      const chosen = stage ? ["--stage", stage] : [];
      worker.postMessage([module, ["check", "--progress", "on", "--out", FOLDER, "--json", FINDING, ...chosen, "--", name], { [name]: new Uint8Array(data) }]);
    } catch (error) {
      if (!isOther()) refuse(...(error.message === "missing" ? ["The file check.js is missing beside this page.", ...instead] : [`${error}`]));
    }
  };
  const FOLDER = ".weekender", FINDING = `${FOLDER}/finding.json`;
  const cancel = () => {
    close();
    heard.textContent = "The check is cancelled";
  };

  // Code stands between backticks, and long code on a line of its own, which needs no comma after it.
  const withCode = (text) => text.split("`").map((part, index, all) => {
    if (index % 2) return make("code", { textContent: part, className: part.length > 16 ? "check-line" : "" });
    return all[index - 1]?.length > 16 ? part.replace(/^[,; ]+/, "") : part;
  });

  const answer = (found, files) => {
    const said = `${found.verdict}. ${found.explanation}.`;
    const look = { right: "good", cannot_check: "bad" }[found.kind] ?? "warn";
    const inside = [make("p", { className: `check-verdict check-${look}`, textContent: found.verdict }), make("p", { textContent: `${found.explanation}.` })];
    if (found.change) inside.push(make("p", { className: "check-change" }, make("small", { textContent: found.kind === "right" ? "Note" : "To change" }), ...withCode(found.change)));
    for (const { title, remedy } of found.damages.filter(({ title }) => title.toLowerCase() !== found.verdict.toLowerCase())) {
      inside.push(make("p", {}, make("strong", { textContent: "The file, too: " }), ...withCode(`${title}; ${remedy}.`)));
    }

    // Links to the section on this page and in the book, and to what the mistake looks like.
    const links = make("p", { className: "check-links" });
    const heading = found.read && [...document.querySelectorAll(":is(h3, .kicker) .book")].find(({ href }) => href === found.read.url);
    const id = heading && (heading.closest("h3") ?? heading.closest(".head").querySelector("h2")).id;
    if (id) links.append(make("a", { href: `#${id}`, textContent: `Read ${found.read.section} here` }));
    if (found.read) links.append(make("a", { href: found.read.url, textContent: `${found.read.section} in the book` }));
    const strip = found.mistake && document.querySelector(`[data-mistake="${found.mistake.id}"]`);
    if (strip) {
      strip.id = `mistake-${found.mistake.id}`;
      links.append(make("a", { href: `#${strip.id}`, textContent: "What it looks like" }));
    }
    if (links.children.length) inside.push(links);

    const choice = make("select", {}, new Option("Find it", ""), ...stages.map(([id, number, title]) => new Option(`${number} ${title}`, id)));
    if (!stage) {
      const [, number, title] = stages.find(([id]) => id === found.stage);
      choice.options[0].text = `Found: ${number} ${title}`;
    }
    choice.value = stage ?? "";
    choice.addEventListener("change", () => {
      stage = choice.value || undefined;
      check();
    });
    inside.push(make("label", { className: "check-section" }, "Section ", choice), pictures(found, files));
    inside.push(make("details", {}, make("summary", { textContent: "Figures" }), make("ul", {}, ...found.seen.map((line) => make("li", { textContent: `${line}.` })))), closing());
    show(said, false, ...inside);
  };

  // Both pictures with a wipe, and their difference with its scale. Marks show where they differ most.
  const pictures = ({ width, height, places }, files) => {
    const picture = (name, alt) => {
      urls.push(URL.createObjectURL(new Blob([files[`${FOLDER}/${name}.png`]], { type: "image/png" })));
      return make("img", { src: urls.at(-1), alt, width, height, className: name });
    };
    const both = make("div", { className: "check-pictures" }, picture("ours", "Ours"), picture("mine", `Yours: ${file.name}`), picture("difference", "Where the two differ, and by how much"));
    for (const [x, y] of places) {
      const mark = both.appendChild(make("span", { className: "check-mark" }));
      Object.assign(mark.style, { left: `${(100 * (x + 0.5)) / width}%`, top: `${(100 * (y + 0.5)) / height}%`, width: `${1000 / width}%` });
    }
    const labels = make("p", { className: "check-names" }, make("span", { textContent: "Yours" }), make("span", { textContent: "Ours" }));
    const wipe = make("input", { type: "range", min: 0, max: 100, value: 50, step: 0.5, ariaLabel: "Boundary between your picture and ours" });
    const move = () => both.style.setProperty("--at", `${wipe.value}%`);
    wipe.addEventListener("input", move);
    const drag = ({ clientX, buttons }) => {
      if (!buttons || both.dataset.view !== "Wipe") return;
      const { left, width } = both.getBoundingClientRect();
      wipe.value = (100 * (clientX - left)) / width;
      move();
    };
    both.addEventListener("pointerdown", drag);
    both.addEventListener("pointermove", drag);
    move();
    const legend = make("p", { className: "check-scale" }, make("small", { textContent: scale.title }), make("span", { className: "check-bar" }), make("span", { className: "check-labels" }, ...scale.labels.map((textContent) => make("span", { textContent }))));
    legend.style.setProperty("--scale", `linear-gradient(to right, ${scale.colours.map((colour) => `rgb(${colour})`)})`);
    const views = ["Wipe", "Yours", "Ours", "Difference"].map((name) => button(name, () => view(name)));
    const view = (name) => {
      both.dataset.view = name;
      for (const one of views) one.ariaPressed = one.textContent === name;
      labels.hidden = wipe.hidden = name !== "Wipe";
      legend.hidden = name !== "Difference";
    };
    view("Wipe");
    return make("div", {}, make("div", { className: "check-buttons", role: "group", ariaLabel: "Picture" }, ...views), labels, both, wipe, legend);
  };

  // A file comes by a drop anywhere, by pasting, or by choosing. A second picture replaces the first.
  const take = (files, at) => {
    if (!files?.length) return false;
    [file] = files;
    stage = bytes = undefined;
    place = at?.closest(".check-box, .cover > *, .chapter > *") ?? place ?? boxes[0] ?? document.querySelector(".check-missing");
    // Dropped on the answer, the next one comes there, too.
    if (place === panel) place = panel.previousElementSibling;
    check();
    return true;
  };
  input.addEventListener("change", () => {
    take(input.files);
    input.value = "";
  });
  // Pictures that are dragged from the page itself carry a mark.
  const OWN = "text/x-weekender";
  addEventListener("dragstart", (event) => event.dataTransfer?.setData(OWN, ""));
  const isFile = ({ dataTransfer }) => dataTransfer?.types.includes("Files") && !dataTransfer.types.includes(OWN);
  const mark = (isOver) => document.documentElement.classList.toggle("check-over", isOver);
  addEventListener("dragover", (event) => {
    if (!isFile(event)) return;
    event.preventDefault();
    event.dataTransfer.dropEffect = "copy";
    mark(true);
  });
  addEventListener("dragleave", (event) => event.relatedTarget || mark(false));
  addEventListener("drop", (event) => {
    mark(false);
    if (!isFile(event)) return;
    event.preventDefault();
    take(event.dataTransfer.files, event.target);
  });
  addEventListener("paste", (event) => {
    if (!program || event.target.closest?.("input, textarea, select, [contenteditable]")) return;
    const middle = document.elementFromPoint(innerWidth / 2, innerHeight / 2);
    if (take(event.clipboardData?.files, middle)) event.preventDefault();
  });
  addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || event.defaultPrevented || !timer) return;
    event.preventDefault();
    cancel();
  });
}
