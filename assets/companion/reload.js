// Reloads the page when `build.js` tells of another build than BUILD. A page from disk may load scripts but not fetch
// files.
function built(build) { if (build !== BUILD) location.reload(); }
setInterval(() => {
  const script = document.createElement("script");
  script.src = `build.js?${Date.now()}`;
  script.onload = () => script.remove();
  script.onerror = script.onload;
  document.head.append(script);
}, 1000);
