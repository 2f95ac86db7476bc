/* The page of a surface. */

{
  const [main, data] = ["main", "#surface-data"].map((name) => document.querySelector(name));
  if (!(main instanceof HTMLElement && data)) throw new Error("The page has no place or no data.");
  const surface = showSurface(main, JSON.parse(data.textContent));
  window.surface = surface;
  // In a frame the page tells its height, and is told whether its surroundings are dark.
  if (window.parent !== window) {
    const page = document.documentElement;
    page.classList.add("embedded");
    const tell = () => window.parent.postMessage({ explorerHeight: page.offsetHeight }, "*");
    new ResizeObserver(tell).observe(document.body);
    window.addEventListener("message", ({ data: told }) => {
      if (!["light", "dark"].includes(told?.theme)) return;
      page.style.colorScheme = told.theme;
      surface?.redraw();
    });
  }
}
