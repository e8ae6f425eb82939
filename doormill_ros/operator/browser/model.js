// The part of the page on the robot's model. In English the monitor speaks in its own words.
import { ENGLISH, byId, known, language, say, size, text, write } from "./language.js";
import { nextSentence, stopReason, trouble, verdictSentence } from "./monitor_words.js";

export let shown = null;

function mark(parent, kind, attributes, title) {
  const element = document.createElementNS(byId("trend").namespaceURI, kind);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (title) mark(element, "title", {}).textContent = title;
  parent.append(element);
  return element;
}

function showTrend(doors, limit) {
  const drawing = byId("trend");
  drawing.replaceChildren();
  if (!doors.length) return;
  const most = 1.1 * Math.max(limit, ...doors.map((door) => door.largest), 1e-6);
  const x = (i) => 20 + 960 * (doors.length === 1 ? 0.5 : i / (doors.length - 1));
  const y = (value) => 210 - 200 * (value / most);
  mark(drawing, "line", { class: "axis", x1: 10, x2: 990, y1: y(0), y2: y(0) });
  if (limit > 0) mark(drawing, "line", { class: "limit", x1: 10, x2: 990, y1: y(limit), y2: y(limit) });
  doors.forEach((door, i) => {
    const changed = i > 0 && door.model_version !== doors[i - 1].model_version;
    if (changed) {
      const between = (x(i) + x(i - 1)) / 2;
      mark(drawing, "line", { class: "version", x1: between, x2: between, y1: 10, y2: 210 });
    }
    const told = { door: door.door_id, run: door.run_id, size: size(door.largest), version: door.model_version };
    const beyond = limit > 0 && door.largest > limit ? "beyond" : "within";
    mark(drawing, "circle", { class: beyond, cx: x(i), cy: y(door.largest), r: 6 }, text("trend.door", told));
  });
}

function showMessage(found) {
  const reasons = [found.stopped && stopReason(found), found.error_code && trouble(found.error_code)];
  say("model-message", found.message, reasons.filter(Boolean).join("; "));
  // Which run or file it is about stands only in the monitor's words.
  const more = language() !== ENGLISH && found.error_code;
  write("model-words", more ? found.message : "", ENGLISH);
  byId("model-words").hidden = !more;
}

function showFigures(found) {
  const waiting = found.waiting ? text("expected.waiting", { count: found.waiting }) : "";
  const asking = found.asking ? text("expected.asking") : "";
  write("expected", text("expected", { size: size(found.expected), asking, waiting }));
  const better = { version: found.proposed, size: size(found.expected_proposed) };
  const proposed = found.proposed ? text("proposed", better) : text("proposed.none");
  write("version", text(found.version ? "version.used" : "version.start", { version: found.version, proposed }));
  const limit = found.limit > 0 ? text("trend.limit", { size: size(found.limit) }) : "";
  const count = found.doors.length;
  write("trend-caption", count ? text("trend", { count, limit }) : text("trend.none"));
  showTrend(found.doors, found.limit);
}

export function showModel(found, control) {
  shown = found;
  byId("model").hidden = !found;
  if (!found) return;
  say("verdict", found.sentence || text("none_questioned"), found.sentence ? verdictSentence(found) : text("none_questioned"));
  say("measure-next", found.next_measurement, nextSentence(found), (next) => text("measure", { next }));
  showMessage(found);
  showFigures(found);
  byId("remarks-hint").hidden = language() === ENGLISH || !found.remarks.length;
  byId("remarks").replaceChildren(...found.remarks.map((words) => {
    const item = document.createElement("li");
    item.textContent = words;
    return item;
  }));
  byId("model-control").hidden = !control;
  write("accept", found.proposed ? text("accept.version", { version: found.proposed }) : text("accept"));
  byId("accept").disabled = !found.proposed;
  write("revert", found.version ? text("revert.version", { version: found.version }) : text("revert"));
  byId("revert").disabled = !found.version;
}

// Why an order was refused: the sentence of its error's code, where that is about the model.
export const refusedModelOrder = (code, other) => (known(`error.${code}`) ? text(`error.${code}`) : other);
