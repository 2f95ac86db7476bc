// A citation can be unfolded and read without this script; with it, a button copies it.

/** @type {(details: Element) => void} */
function addCopyButton(details) {
  const text = details.querySelector(".bibtex")?.textContent ?? "";
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "Copy citation";
  button.addEventListener("click", async () => {
    await navigator.clipboard.writeText(text);
    button.textContent = "Copied";
  });
  details.append(button);
}

for (const details of document.querySelectorAll("details.citation")) addCopyButton(details);

// The tables of the chapters are folded: an address opens the table of its result, and paper has all.
function openTarget() {
  const row = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  const table = row?.closest("details.results-of-chapter");
  if (!(table instanceof HTMLDetailsElement) || table.open) return;
  table.open = true;
  row?.scrollIntoView();
}

openTarget();
window.addEventListener("hashchange", openTarget);
window.addEventListener("beforeprint", () => {
  for (const table of document.querySelectorAll("details.results-of-chapter"))
    table.setAttribute("open", "");
});
