/* A page in a frame tells its height, and is told whether its surroundings are dark. */

/** @type {(themed?: () => void) => void} */
function answerFrame(themed = () => {}) {
  if (window.parent === window) return;
  const page = document.documentElement;
  page.classList.add("embedded");
  const tell = () => window.parent.postMessage({ explorerHeight: page.offsetHeight }, "*");
  new ResizeObserver(tell).observe(document.body);
  window.addEventListener("message", ({ data }) => {
    if (!["light", "dark"].includes(data?.theme)) return;
    page.style.colorScheme = data.theme;
    themed();
  });
}
