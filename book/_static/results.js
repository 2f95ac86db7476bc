// A citation can be unfolded and read without this script; with it, a button copies it.

/** @type {(details: Element) => void} */
function addCopyButton(details) {
  const text = details.querySelector("pre")?.textContent ?? "";
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
