/* A page in a frame tells its height, and is told whether its surroundings are dark. */

function answerFrame() {
  if (window.parent === window) return;
  const page = document.documentElement;
  page.classList.add("embedded");
  const tell = () => window.parent.postMessage({ explorerHeight: page.offsetHeight }, "*");
  new ResizeObserver(tell).observe(document.body);
  window.addEventListener("message", ({ data }) => {
    if (["light", "dark"].includes(data?.theme)) page.style.colorScheme = data.theme;
  });
}
