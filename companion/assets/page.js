// Colours: the system's, light or dark.
(() => {
  const choice = document.createElement("fieldset");
  const root = document.documentElement;
  choice.className = "theme";
  choice.innerHTML = "<legend>Colours</legend>";
  document.querySelector(".contents .list").append(choice);
  for (const value of ["auto", "light", "dark"]) {
    const label = choice.appendChild(document.createElement("label"));
    const input = Object.assign(document.createElement("input"), { type: "radio", name: "theme", value });
    label.append(input, Object.assign(document.createElement("span"), { textContent: value[0].toUpperCase() + value.slice(1) }));
    input.checked = value === (root.dataset.theme ?? "auto");
    input.addEventListener("change", () => {
      if (input.value === "auto") delete root.dataset.theme;
      else root.dataset.theme = input.value;
      try {
        if (input.value === "auto") localStorage.removeItem("theme");
        else localStorage.setItem("theme", input.value);
      } catch {
        // A browser may keep nothing for pages from disk.
      }
    });
  }
})();

// The list of chapters: open beside the text where there is room, otherwise behind a button that names the chapter.
(() => {
  const details = document.querySelector(".contents details");
  const now = document.querySelector(".contents .now");
  const links = new Map([...details.querySelectorAll("ol a")].map((link) => [link.hash.slice(1), link]));
  const hasRoom = matchMedia("(min-width: 70rem)");
  const fit = () => (details.open = hasRoom.matches);
  const close = () => {
    if (!hasRoom.matches) details.open = false;
  };
  fit();
  hasRoom.addEventListener("change", fit);
  details.addEventListener("click", (event) => {
    if (event.target.closest("a")) close();
  });
  details.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || hasRoom.matches) return;
    details.open = false;
    details.querySelector("summary").focus();
  });
  document.querySelector("main").addEventListener("click", close);

  // A search in headings, terms and the text, and the way back to where the reader was.
  const make = (name, properties) => Object.assign(document.createElement(name), properties);
  const words = (heading) => {
    const copy = heading.cloneNode(true);
    copy.querySelectorAll(".anchor, .book").forEach((link) => link.remove());
    return copy.textContent.trim();
  };
  const entry = (target) => {
    const item = make("li");
    item.append(make("a", { href: `#${target.id}`, textContent: words(target) }));
    return item;
  };
  const placeholder = "Find in the page";
  const field = make("input", { type: "search", className: "find", placeholder, ariaLabel: placeholder });
  const found = make("ul", { className: "found" }), count = make("p", { className: "count", role: "status" });
  const MOST = 14;
  const headings = [...document.querySelectorAll("main :is(h2, h3, dt)[id]")];
  let texts;
  // A place in the text has no address of its own, so a press goes there.
  const quote = (element, text, place) => {
    const item = make("li"), { id } = element.closest(".chapter").querySelector("h2"), link = make("a", { href: `#${id}` });
    const chapter = make("span", { className: "in", textContent: links.get(id)?.textContent.trim() ?? "" });
    link.append(chapter, make("small", { textContent: `…${text.slice(Math.max(0, place - 24), place + 48)}…` }));
    link.addEventListener("click", (event) => {
      event.preventDefault();
      history.pushState(null, "", location.href);
      element.closest("details:not([open])")?.setAttribute("open", "");
      const { language } = element.closest(".code:not(.shown)")?.dataset ?? {};
      if (language) element.closest(".tabbed").querySelector(`button[data-language="${language}"]`)?.click();
      element.scrollIntoView({ block: "center" });
      document.querySelectorAll(".found-here").forEach((old) => old.classList.remove("found-here"));
      element.classList.add("found-here");
    });
    item.append(link);
    return item;
  };
  const find = () => {
    const wanted = field.value.trim().toLowerCase();
    found.replaceChildren();
    count.textContent = "";
    if (wanted.length < 2) return;
    texts ??= [...document.querySelectorAll(".chapter :is(p, li, td, dd, figcaption, pre)")].filter((element) => !element.querySelector("p, li, td")).map((element) => [element, element.textContent.replace(/\s+/g, " ")]);
    // The beginning of a word counts more than its middle.
    const hit = (text, show) => {
      const place = text.toLowerCase().search(new RegExp(`(?<!\\p{L})${wanted.replace(/[\\^$.*+?()[\]{}|/]/g, "\\$&")}`, "u"));
      return place >= 0 ? [{ rank: 0, show: () => show(place) }] : text.toLowerCase().includes(wanted) ? [{ rank: 1, show: () => show(text.toLowerCase().indexOf(wanted)) }] : [];
    };
    const hits = [...headings.flatMap((heading) => hit(words(heading), () => entry(heading))), ...texts.flatMap(([element, text]) => hit(text, (place) => quote(element, text, place)))];
    hits.sort((a, b) => a.rank - b.rank);
    found.replaceChildren(...hits.slice(0, MOST).map(({ show }) => show()));
    count.textContent = hits.length > MOST ? `${MOST} of ${hits.length}; type more to narrow it down` : hits.length ? `${hits.length} found` : `Nothing has “${field.value.trim()}”.`;
  };
  field.addEventListener("input", find);
  field.addEventListener("keydown", (event) => {
    if (event.key === "Enter") found.querySelector("a")?.click();
    if (event.key !== "Escape" || !field.value) return;
    event.preventDefault();
    field.value = "";
    find();
  });
  // Arrows lead through the list and back to the field.
  const list = make("div", {});
  list.append(field, count, found);
  list.addEventListener("keydown", (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key], stops = [field, ...found.querySelectorAll("a")];
    const next = step && stops[stops.indexOf(document.activeElement) + step];
    if (!next) return;
    event.preventDefault();
    next.focus();
  });
  details.querySelector(".home").after(list);
  const remember = (value) => {
    try {
      if (value) localStorage.setItem("place", value);
      return localStorage.getItem("place");
    } catch {
      // A browser may keep nothing for pages from disk.
      return null;
    }
  };
  const left = document.getElementById(remember() ?? "");
  if (left && !location.hash) {
    list.after(make("a", { className: "back", href: `#${left.id}`, textContent: `Continue at ${words(left)}` }));
  }

  // The current chapter's sections are in the list.
  const sections = [...document.querySelectorAll(".chapter")];
  const headingsOf = (section) => (section ? [...section.querySelectorAll(":is(h2, h3)[id]")] : []);
  const hasPassed = (element) => element.getBoundingClientRect().top < innerHeight * 0.3;
  const point = (link, isCurrent) => {
    if (isCurrent) link.setAttribute("aria-current", "true");
    else link.removeAttribute("aria-current");
  };
  let current, chapter;
  const mark = () => {
    const [first, ...others] = headingsOf(sections.findLast(hasPassed));
    const passed = others.findLast(hasPassed) ?? first;
    if (passed === current && current !== undefined) return;
    if (first !== chapter || current === undefined) {
      chapter = first;
      const link = links.get(chapter?.id);
      links.forEach((other) => point(other, other === link));
      details.querySelector("ol ul")?.remove();
      const inside = make("ul");
      inside.append(...others.map(entry));
      if (inside.children.length) link?.after(inside);
      now.textContent = link ? link.textContent.trim() : "Chapters";
      if (hasRoom.matches) link?.scrollIntoView({ block: "nearest" });
    }
    for (const link of details.querySelectorAll("ol ul a")) point(link, link.hash === `#${passed?.id}`);
    if (passed && current !== undefined) remember(passed.id);
    current = passed ?? null;
  };
  let waiting = 0;
  addEventListener("scroll", () => {
    clearTimeout(waiting);
    waiting = setTimeout(mark, 150);
  }, { passive: true });
  mark();
  // [ and ] lead to the chapter before and after.
  addEventListener("keydown", (event) => {
    const step = { "[": -1, "]": 1 }[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.target.matches("input, select, textarea")) return;
    const chapters = [...links.keys()], next = chapters[chapters.indexOf(chapter?.id) + step];
    if (!next) return;
    history.pushState(null, "", `#${next}`);
    document.getElementById(next).scrollIntoView();
    mark();
  });
})();

// The languages of code. A choice holds for all pieces, and what the reader looks at stays where it is.
(() => {
  const choose = (language) => {
    for (const box of document.querySelectorAll(`.tabbed:has([data-language="${language}"])`)) {
      for (const code of box.querySelectorAll(".code")) code.classList.toggle("shown", code.dataset.language === language);
      for (const button of box.querySelectorAll("button")) {
        button.setAttribute("aria-pressed", button.dataset.language === language);
      }
    }
  };
  for (const button of document.querySelectorAll(".tabs button")) {
    button.addEventListener("click", () => {
      const before = button.getBoundingClientRect().top;
      choose(button.dataset.language);
      scrollBy({ top: button.getBoundingClientRect().top - before, behavior: "instant" });
    });
  }
})();

// The definition of a term, beside its link, for the pointer and the keyboard. Escape hides it.
(() => {
  const tip = Object.assign(document.createElement("div"), { className: "tip", id: "tip", role: "tooltip", hidden: true });
  document.body.append(tip);
  let term = null;
  let waiting = 0;
  const hide = () => {
    clearTimeout(waiting);
    tip.hidden = true;
    term?.removeAttribute("aria-describedby");
    term = null;
  };
  const show = (link) => {
    const definition = document.getElementById(link.hash.replace("#term-", "def-"));
    if (!definition || term === link) return;
    hide();
    term = link;
    link.setAttribute("aria-describedby", "tip");
    tip.innerHTML = definition.innerHTML;
    // Links inside could not be reached.
    tip.querySelectorAll("a").forEach((inner) => inner.replaceWith(...inner.childNodes));
    tip.hidden = false;
    const place = link.getClientRects()[0];
    const margin = 12;
    const left = Math.min(place.left, document.documentElement.clientWidth - tip.offsetWidth - margin);
    const below = place.bottom + 6;
    const fits = below + tip.offsetHeight + margin < innerHeight;
    tip.style.left = `${Math.max(margin, left) + scrollX}px`;
    tip.style.top = `${(fits ? below : place.top - tip.offsetHeight - 6) + scrollY}px`;
  };
  const later = (action, delay) => {
    clearTimeout(waiting);
    waiting = setTimeout(action, delay);
  };
  for (const link of document.querySelectorAll("a.term")) {
    link.addEventListener("pointerenter", (event) => {
      if (event.pointerType === "mouse") later(() => show(link), 150);
    });
    link.addEventListener("pointerleave", () => later(hide, 250));
    link.addEventListener("focus", () => link.matches(":focus-visible") && show(link));
    link.addEventListener("blur", hide);
  }
  tip.addEventListener("pointerenter", () => clearTimeout(waiting));
  tip.addEventListener("pointerleave", () => later(hide, 250));
  addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || event.defaultPrevented || !term) return;
    event.preventDefault();
    hide();
  });
  addEventListener("resize", hide);
})();

// A mistake beside the right picture: pointing at it, pressing it or reaching it by keys shows the other in its place.
for (const list of document.querySelectorAll(".mistakes[data-has-right]")) {
  const [right, ...wrong] = list.querySelectorAll("img");
  // A copy is loaded at once, so it is made when it is needed.
  const copy = () => list.querySelector(".right") || wrong.forEach((picture) => picture.after(Object.assign(right.cloneNode(), { className: `${right.className} right`, alt: "" })));
  for (const kind of ["pointerover", "focusin"]) list.addEventListener(kind, copy, { once: true });
  for (const picture of wrong) picture.tabIndex = 0;
  const textContent = "Point at a wrong picture, press it, or reach it with Tab to see the right one in its place.";
  list.before(Object.assign(document.createElement("p"), { className: "mistakes-hint", textContent }));
}
