const NS = "http://www.w3.org/2000/svg";

// A row below a diagram with a slider.
function sliderRow({ key, label, min, max, step, show, also }, state, changed) {
  const row = document.createElement("label"), input = document.createElement("input"), output = document.createElement("output");
  Object.assign(input, { type: "range", min, max, step });
  input.value = state[key];
  input.oninput = () => {
    Object.assign(state, { [key]: Number(input.value) }, also);
    output.textContent = show(state[key]);
    changed();
  };
  output.textContent = show(state[key]);
  row.append(label, input, output);
  return row;
}

// A row of buttons; the chosen one is pressed.
function choiceRow({ key, label, options }, state, changed) {
  const row = document.createElement("div");
  row.className = "choices";
  row.setAttribute("role", "group");
  row.setAttribute("aria-label", label);
  const buttons = options.map((option) => {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: option });
    button.onclick = () => {
      state[key] = option;
      changed();
    };
    return button;
  });
  const press = () => buttons.forEach((button) => button.setAttribute("aria-pressed", button.textContent === state[key]));
  row.press = press;
  row.append(`${label} `, ...buttons);
  return row;
}

const isPhone = typeof matchMedia === "undefined" ? { matches: false } : matchMedia("(max-width: 40rem)");

function start(figure, { size, narrow, state, hint = "", handles = [], choices = [], sliders = [], draw }) {
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
  const rows = choices.map((choice) => choiceRow(choice, state, show));
  function show() {
    const isNarrow = narrow && isPhone.matches, [shapes, words] = draw(state, isNarrow);
    svg.setAttribute("viewBox", `0 0 ${(isNarrow ? narrow : size).join(" ")}`);
    layer.innerHTML = shapes;
    reading.textContent = words;
    rows.forEach((row) => row.press());
    knobs.forEach((knob) => knob());
  }
  const told = Object.assign(document.createElement("p"), { className: "hint", textContent: hint });
  // A box and its node in the tree light up together.
  layer.onpointerover = ({ target }) => {
    for (const shape of layer.querySelectorAll("[data-node]")) shape.classList.toggle("lit", shape.dataset.node === target.dataset.node);
  };
  controls.append(...(hint ? [told] : []), ...rows, ...sliders.map((slider) => sliderRow(slider, state, show)), reading);
  figure.querySelector(".scroll").after(controls);
  if (narrow) isPhone.addEventListener("change", show);
  show();
}

// The lanes that work at a step, from the drawings that the page holds.
function startTimeline(figure) {
  const drawings = [...figure.querySelectorAll("svg")].map((svg) => {
    // A step is a unit of the drawing.
    const starts = [...svg.querySelectorAll("path:not(.waits)")].flatMap((path) => [...path.getAttribute("d").matchAll(/M(\d+) /g)].map((box) => Number(box[1])));
    const cursor = svg.appendChild(document.createElementNS(NS, "line"));
    Object.entries({ class: "cursor", y1: -0.3, y2: 8.15 }).forEach(([key, value]) => cursor.setAttribute(key, value));
    return { starts, cursor };
  });
  const steps = Math.max(...drawings.flatMap(({ starts }) => starts)) + 1;
  const controls = document.createElement("div"), reading = document.createElement("p"), state = { step: 8 };
  controls.className = "diagram-controls";
  reading.className = "reading";
  const show = () => {
    const counts = drawings.map(({ starts, cursor }) => {
      for (const end of ["x1", "x2"]) cursor.setAttribute(end, state.step - 0.6);
      return starts.filter((start) => start === state.step - 1).length;
    });
    reading.textContent = `Step ${state.step}: ${counts[0]} of 8 lanes work without refill, ${counts[1]} with it.`;
  };
  controls.append(sliderRow(slider("step", "Step", 1, steps, 1), state, show), reading);
  figure.querySelector("figcaption").before(controls);
  show();
}

// One after the other; the page answers between them.
async function startAll() {
  let since = performance.now();
  for (const figure of document.querySelectorAll(":is(.diagram, .timeline)")) {
    const diagram = diagrams[figure.id.replace("diagram-", "")];
    if (diagram) start(figure, diagram);
    else if (figure.matches(".timeline")) startTimeline(figure);
    if (performance.now() - since < 10) continue;
    await new Promise((passed) => setTimeout(passed));
    since = performance.now();
  }
}
if (typeof document !== "undefined") startAll();
