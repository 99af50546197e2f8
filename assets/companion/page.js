"use strict";

// Colours: the system's, light or dark.
(() => {
  const choice = document.querySelector(".theme");
  const root = document.documentElement;
  choice.hidden = false;
  for (const input of choice.querySelectorAll("input")) {
    input.checked = input.value === (root.dataset.theme ?? "auto");
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

  // A search in headings and terms, and the way back to where the reader was.
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
  const placeholder = "Find a heading or a term";
  const field = make("input", { type: "search", className: "find", placeholder, ariaLabel: placeholder });
  const found = make("ul", { className: "found" });
  const targets = [...document.querySelectorAll("main :is(h2, h3, dt)[id]")];
  field.addEventListener("input", () => {
    const wanted = field.value.trim().toLowerCase();
    const hits = targets.filter((target) => wanted.length > 1 && words(target).toLowerCase().includes(wanted));
    found.replaceChildren(...hits.slice(0, 12).map(entry));
  });
  details.querySelector(".home").after(field, found);
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
    found.after(make("a", { className: "back", href: `#${left.id}`, textContent: `Continue at ${words(left)}` }));
  }

  // The current chapter's sections are in the list, and the address follows the reader.
  const sections = [...document.querySelectorAll(".chapter")];
  sections.forEach((section) => section.style.setProperty("--text", section.textContent.length));
  const headingsOf = (section) => (section ? [...section.querySelectorAll(":is(h2, h3)[id]")] : []);
  const hasPassed = (element) => element.getBoundingClientRect().top < innerHeight * 0.3;
  const point = (link, isCurrent) => {
    if (isCurrent) link.setAttribute("aria-current", "true");
    else link.removeAttribute("aria-current");
  };
  let current, chapter;
  const mark = () => {
    // A chapter that is far away has no layout, so its headings are not asked.
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
    if (passed && current !== undefined) {
      remember(passed.id);
      history.replaceState(history.state, "", `#${passed.id}`);
    }
    current = passed ?? null;
  };
  let waiting = 0;
  addEventListener("scroll", () => {
    clearTimeout(waiting);
    waiting = setTimeout(mark, 150);
  }, { passive: true });
  mark();
  // A remembered distance from the top would be wrong, as chapters have no height before they are near.
  history.scrollRestoration = "manual";
  addEventListener("load", () => document.getElementById(location.hash.slice(1))?.scrollIntoView());
  // [ and ] lead to the chapter before and after.
  addEventListener("keydown", (event) => {
    const step = { "[": -1, "]": 1 }[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.target.matches("input")) return;
    const chapters = [...links.keys()];
    document.getElementById(chapters[Math.max(0, chapters.indexOf(chapter?.id) + step)])?.scrollIntoView();
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
  const tip = document.getElementById("tip");
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
  addEventListener("keydown", (event) => event.key === "Escape" && hide());
  addEventListener("resize", hide);
})();
