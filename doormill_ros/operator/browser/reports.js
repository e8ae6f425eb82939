// What nodes report: headline and what to do in the reader's language, and under it their own words, which are English.
import { ENGLISH, UNNAMED, byId, errorText, known, language, text, write } from "./language.js";

const made = (kind, properties) => Object.assign(document.createElement(kind), properties);

// Into elements that stay, so that a screen reader says again only what has changed.
export function showReport(id, code, own) {
  const said = (own && errorText(code)) || { headline: "", advice: "" };
  for (const name of ["headline", "advice"]) {
    write(`${id}-${name}`, said[name]);
    byId(`${id}-${name}`).hidden = !said[name];
  }
  write(`${id}-words`, own, ENGLISH);
  byId(`${id}-report`).hidden = !own;
}

// A node as the operator calls it, with its name, by which it is started again.
export function nodeName(node) {
  const robot = /(?:^|[/])robot([12])[/]/.exec(node);
  const parts = node.split("/");
  const own = parts.slice(parts.at(-1) === "controller" ? -2 : -1).join("/");
  if (!known(`node.${own}`)) return node;
  const said = text(`node.${own}`);
  return text("node", { said: robot ? text("node.robot", { robot: robot[1], said }) : said, node });
}

export function showFaults(faults) {
  byId("faults").replaceChildren(...faults.map(({ node, message, error_code: code }) => {
    const { headline, advice } = errorText(code || UNNAMED);
    const title = text("fault", { node: nodeName(node), headline });
    const report = made("p", { className: "own", textContent: `${text("report")} ` });
    report.append(made("span", { textContent: `${node}: ${message}`, lang: ENGLISH }));
    const item = made("li", {});
    item.append(made("strong", { textContent: title }), made("p", { textContent: advice }), report);
    return item;
  }));
}
