"use strict";
// A desk in a frame of the book: light or dark as the book is, and as high as what it shows.

(() => {
  const page = document.documentElement;
  page.className = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  window.addEventListener("message", ({ data, source }) => {
    if (source !== window.parent || !["light", "dark"].includes(data?.theme)) return;
    page.className = data.theme;
  });
  const tell = () => {
    const explorerHeight = document.body.offsetHeight;
    if (window.parent !== window) window.parent.postMessage({ explorerHeight }, "*");
  };
  new ResizeObserver(tell).observe(document.body);
})();
