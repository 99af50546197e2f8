document.documentElement.classList.add("js");
// Live figures keep room for their switches.
document.documentElement.classList.toggle("gpu", navigator.gpu !== undefined);
try {
  const theme = localStorage.getItem("theme");
  if (theme === "light" || theme === "dark") document.documentElement.dataset.theme = theme;
} catch {
  // A browser may keep nothing for pages from disk.
}
