/* Templates: what is written is made once, a value in ${} is changed in its place. In a tag, name=${} is
   an attribute, .name=${} a property and @name=${} a listener; elsewhere a value is text, a template,
   a list of them, or `nothing`. `render` shows a template in an element. */
const [nothing, PLACE, templates] = [Symbol("nothing"), "{{}}", new Map()];
const html = (strings, ...values) => ({ strings, values, around: ["", ""] });
const svg = (strings, ...values) => ({ strings, values, around: ["<svg>", "</svg>"] });
const removeBetween = (before, after) => {
  while (before.nextSibling !== after) before.nextSibling.remove();
};

function nodesBelow(content) {
  const [walker, nodes] = [document.createTreeWalker(content, 129), []]; // elements and comments
  while (walker.nextNode()) nodes.push(walker.currentNode);
  return nodes;
}

/** What is written, and the places of its values: a node's number, and an attribute's name and text. */
function parsed({ strings, around }) {
  const text = strings.reduce((all, piece) => {
    const inTag = all.lastIndexOf("<") > all.lastIndexOf(">");
    const quote = all.endsWith("=") ? '"' : "";
    return all + (inTag ? quote + PLACE + quote : `<!--${PLACE}-->`) + piece;
  });
  const template = document.createElement("template");
  template.innerHTML = around.join(text);
  const { content } = template;
  if (around[0]) content.replaceChildren(...content.firstChild.childNodes);
  const places = nodesBelow(content).flatMap((node, number) => {
    if (!node.attributes) return node.data === PLACE ? [{ number }] : [];
    const open = [...node.attributes].filter(({ value }) => value.includes(PLACE));
    for (const { name } of open) node.removeAttribute(name);
    return open.map(({ name, value }) => ({ number, name, pieces: value.split(PLACE) }));
  });
  return { content, places };
}

/** Show a value before a comment; what stood there is changed, or goes. */
function fill(part, value) {
  const kind = Array.isArray(value) ? "list" : (value?.strings ?? "text");
  if (value === part.value && kind !== "list") return;
  part.value = value;
  if (kind !== part.kind) empty(part, kind);
  if (kind === "list") {
    while (part.items.length < value.length) part.items.push(partBefore(part.end));
    part.items.length = value.length;
    removeBetween(part.items.at(-1)?.end ?? part.start, part.end);
    for (const [i, item] of part.items.entries()) fill(item, value[i]);
  } else if (kind === "text") {
    part.start.nextSibling.data = value === nothing ? "" : String(value ?? "");
  } else {
    const values = [...value.values];
    for (const own of part.items)
      if (own.end) fill(own, values.shift());
      else setAttribute(own, values.splice(0, own.pieces.length - 1));
  }
}

function partBefore(after) {
  const [start, end] = [new Comment(), new Comment()];
  after.before(start, end);
  return { start, end };
}

/** Make a part ready for values of a kind: for text, a list, or a template's own values. */
function empty(part, kind) {
  removeBetween(part.start, part.end);
  Object.assign(part, { kind, items: [] });
  if (kind === "text") part.end.before(new Text());
  if (typeof kind === "string") return;
  if (!templates.has(kind)) templates.set(kind, parsed(part.value));
  const { content, places } = templates.get(kind);
  const copy = document.importNode(content, true);
  const nodes = nodesBelow(copy);
  part.end.before(copy);
  part.items = places.map(({ number, ...place }) =>
    place.name ? { node: nodes[number], ...place } : partBefore(nodes[number]),
  );
}

function setAttribute(part, values) {
  const { node, name, pieces, value: before } = part;
  const [[value], own] = [values, name.slice(1)];
  part.value = value;
  if (name[0] === "@") {
    const hear = (event) => (part.value.handleEvent ?? part.value).call?.(node, event);
    if (!before) node.addEventListener(own, hear, { passive: value.passive });
  } else if (name[0] === ".") {
    const stays = own === "style" || node === document.activeElement; // what is typed stays, too
    if (node[own] !== value && !(stays && before === value)) node[own] = value;
  } else if (value === nothing) node.removeAttribute(name);
  else {
    const text = pieces.reduce((all, one, i) => `${all}${values[i - 1]}${one}`);
    if (node.getAttribute(name) !== text) node.setAttribute(name, text);
  }
}

function render(value, element) {
  element.shown ??= partBefore(element.appendChild(new Comment()));
  fill(element.shown, value);
}
