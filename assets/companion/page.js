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

  const seen = new Set();
  const mark = () => {
    const chapters = [...document.querySelectorAll(".chapter h2")];
    const current = chapters.findLast((heading) => seen.has(heading.id));
    for (const [id, link] of links) {
      if (id === current?.id) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    }
    const link = links.get(current?.id);
    now.textContent = link ? link.textContent.trim() : "Chapters";
    if (hasRoom.matches) link?.scrollIntoView({ block: "nearest" });
  };
  const observer = new IntersectionObserver(
    (entries) => {
      for (const { target, isIntersecting } of entries) {
        const { id } = target.querySelector("h2");
        if (isIntersecting) seen.add(id);
        else seen.delete(id);
      }
      mark();
    },
    { rootMargin: "0px 0px -70% 0px" },
  );
  document.querySelectorAll(".chapter").forEach((chapter) => observer.observe(chapter));
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
