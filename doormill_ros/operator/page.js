"use strict";
// Everything shown goes through textContent, so that no text of a recipe or a node becomes markup.
const SILENCE = 15000; // ms without a sign of life
const byId = (id) => document.getElementById(id);
let heard = 0;
let token = "";

function write(id, text) {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
}

function cell(row, text) {
  row.insertCell().textContent = text;
}

function showHistory(history) {
  const rows = history.map((run) => {
    const row = document.createElement("tr");
    row.className = run.success ? "milled" : "refused";
    cell(row, new Date(run.ended * 1000).toLocaleString([], { dateStyle: "short", timeStyle: "short" }));
    cell(row, run.door_id);
    cell(row, run.outcome);
    cell(row, run.message);
    return row;
  });
  byId("history").replaceChildren(...rows);
}

function showFaults(faults) {
  const items = faults.map((fault) => {
    const item = document.createElement("li");
    item.textContent = `${fault.node}: ${fault.message}`;
    return item;
  });
  byId("faults").replaceChildren(...items);
}

function showPicture(picture) {
  const image = byId("picture");
  image.hidden = !picture;
  if (!picture || image.dataset.number === String(picture.number)) return;
  image.dataset.number = picture.number;
  image.src = `/picture/${picture.number}`;
  write("caption", picture.caption);
}

const millimetres = (metres) => (metres < 0 ? "not known" : `${(1000 * metres).toFixed(2)} mm`);
let model = null;

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
    const text = `${door.door_id}, run ${door.run_id}: ${millimetres(door.largest)}, version ${door.model_version}`;
    const beyond = limit > 0 && door.largest > limit ? "beyond" : "within";
    mark(drawing, "circle", { class: beyond, cx: x(i), cy: y(door.largest), r: 6 }, text);
  });
}

function showModel(found, control) {
  model = found;
  byId("model").hidden = !found;
  if (!found) return;
  write("verdict", found.sentence || "No inspected door was questioned yet.");
  write("measure-next", found.next_measurement ? `Measure this next: ${found.next_measurement}.` : "");
  write("model-message", found.message);
  byId("model-message").hidden = !found.message;
  const waiting = found.waiting ? `; ${found.waiting} inspections wait for their bag` : "";
  write("expected", `expected error ${millimetres(found.expected)}${found.asking ? ", being worked out anew" : ""}${waiting}`);
  const proposed = found.proposed
    ? `version ${found.proposed} is proposed: ${millimetres(found.expected_proposed)}`
    : "none is proposed";
  write("version", `${found.version || "that of the start"} in use; ${proposed}`);
  const count = found.doors.length;
  const drawn = `Largest deviation of the last ${count} inspected doors`;
  const lines = found.limit > 0 ? `; red: the limit of ${millimetres(found.limit)}` : "";
  write("trend-caption", count ? `${drawn}${lines}; dashed: another version.` : "No door was inspected yet.");
  showTrend(found.doors, found.limit);
  byId("remarks").replaceChildren(...found.remarks.map((text) => {
    const item = document.createElement("li");
    item.textContent = text;
    return item;
  }));
  byId("model-control").hidden = !control;
  byId("accept").textContent = found.proposed ? `Accept version ${found.proposed}` : "Accept";
  byId("accept").disabled = !found.proposed;
  byId("revert").textContent = found.version ? `Take version ${found.version} back` : "Take back";
  byId("revert").disabled = !found.version;
}

function show(view) {
  // A refusal waits for the operator too, but nobody shall take it for a success from afar.
  byId("step").className = view.refusal ? `${view.urgency} refused` : view.urgency;
  write("next-step", view.next_step);
  write("refusal", view.refusal);
  byId("refusal").hidden = !view.refusal;
  write("state", view.state ? `${view.state}: ${view.state_reason}` : "unknown");
  write("door", view.run_id ? `${view.door_id}, stage ${view.stage}` : "none");
  const last = view.history[0];
  write("last", last ? `${last.door_id}, ${last.outcome}` : "none yet");
  byId("progress").hidden = !view.run_id;
  byId("progress").value = view.progress;
  write("notice", view.notice);
  showFaults(view.faults);
  showPicture(view.picture);
  showHistory(view.history);
  byId("control").hidden = !view.control;
  showModel(view.model, view.control);
}

function alive() {
  heard = Date.now();
  byId("lost").hidden = true;
}

function connect() {
  const source = new EventSource("/events");
  alive();
  source.addEventListener("message", (event) => { alive(); show(JSON.parse(event.data)); });
  source.addEventListener("alive", alive);
  source.addEventListener("error", () => {
    byId("lost").hidden = false;
    // The browser tries again by itself unless the answer told it not to.
    if (source.readyState === EventSource.CLOSED) setTimeout(connect, 2000);
  });
}

async function order(path, body, told = "answer", buttons = [byId("mill"), byId("cancel")],
  wrong = "the door id is empty or too long") {
  buttons.forEach((button) => { button.disabled = true; });
  try {
    // An Authorization header: the token is in no address and no history.
    const response = await fetch(path, {
      method: "POST",
      headers: { "Authorization": `Bearer ${token}`, "Content-Type": "application/json" },
      body: JSON.stringify(body),
    });
    const answer = await response.json();
    const detail = typeof answer.detail === "string" ? answer.detail : wrong;
    write(told, answer.message || detail);
  } catch {
    write(told, "the cell did not answer; look whether it is still running");
  } finally {
    buttons.forEach((button) => { button.disabled = false; });
    if (model) showModel(model, true);
  }
}

function orderModel(path, version) {
  const body = { version, who: byId("who").value.trim(), why: byId("why").value.trim() };
  order(path, body, "model-answer", [byId("accept"), byId("revert")], "your name and why are wanted");
}

let asked = null;

async function offerDoors() {
  const prefix = byId("wanted").value.trim();
  if (prefix === asked) return;
  asked = prefix;
  try {
    const response = await fetch(`/doors?prefix=${encodeURIComponent(prefix)}`);
    if (!response.ok || asked !== prefix) return;
    const options = (await response.json()).map((id) => {
      const option = document.createElement("option");
      option.value = id;
      return option;
    });
    byId("doors").replaceChildren(...options);
  } catch {
    asked = null; // typing works without the list
  }
}

byId("wanted").addEventListener("focus", offerDoors);
byId("wanted").addEventListener("input", offerDoors);
byId("token").addEventListener("input", (event) => { token = event.target.value.trim().replace(/[^!-~]/g, ""); });
byId("mill").addEventListener("click", () => order("/control/mill", { door_id: byId("wanted").value.trim() }));
byId("cancel").addEventListener("click", () => order("/control/cancel", {}));
byId("accept").addEventListener("click", () => orderModel("/control/accept", model.proposed));
byId("revert").addEventListener("click", () => orderModel("/control/revert", model.version));
setInterval(() => { if (Date.now() - heard > SILENCE) byId("lost").hidden = false; }, 1000);
connect();
