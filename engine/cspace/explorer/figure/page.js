/* A page of its own: its robot; in a frame it tells its height, and is told the theme around it. */
{
  const page = document.documentElement;
  window.cspaceData = { robot: JSON.parse(document.getElementById("robot-data").textContent) };
  if (window.parent !== window) {
    const tell = () => window.parent.postMessage({ explorerHeight: page.offsetHeight }, "*");
    new ResizeObserver(tell).observe(document.body);
    window.addEventListener("message", ({ data }) => {
      if (["light", "dark"].includes(data?.theme)) page.style.colorScheme = data.theme;
    });
  }
}
