// What nodes report: headline and what to do in the reader's language, and under it their own words, which are English.
import { ENGLISH, UNNAMED, byId, errorText, known, language, text, write } from "./language.js";

function part(kind, words, spoken = "") {
  const made = document.createElement(kind);
  made.textContent = words;
  if (spoken) made.lang = spoken;
  return made;
}

// Into elements that stay, so that a screen reader says again only what has changed.
export function showReport(id, code, own) {
  const said = (own && errorText(code)) || { headline: "", advice: "" };
  const parts = [["headline", said.headline], ["advice", said.advice], ["words", own, ENGLISH]];
  for (const [name, words, spoken] of parts) {
    write(`${id}-${name}`, words, spoken);
    byId(`${id}-${name}`).hidden = !words;
  }
}

// A node as the operator calls it, with its name, by which it is started again.
export function nodeName(node) {
  const parts = node.split("/");
  const own = parts.slice(parts.at(-1) === "controller" ? -2 : -1).join("/");
  return known(`node.${own}`) ? text("node", { said: text(`node.${own}`), node }) : node;
}

export function showFaults(faults) {
  byId("faults").replaceChildren(...faults.map(({ node, message, error_code: code }) => {
    const item = document.createElement("li");
    const { headline, advice } = errorText(code || UNNAMED);
    const title = text("fault", { node: nodeName(node), headline });
    item.append(part("strong", title), part("p", advice), part("p", `${node}: ${message}`, ENGLISH));
    return item;
  }));
}
