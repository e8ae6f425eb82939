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

async function order(path, body) {
  const buttons = [byId("mill"), byId("cancel")];
  buttons.forEach((button) => { button.disabled = true; });
  try {
    // An Authorization header: the token is in no address and no history.
    const response = await fetch(path, {
      method: "POST",
      headers: { "Authorization": `Bearer ${token}`, "Content-Type": "application/json" },
      body: JSON.stringify(body),
    });
    const answer = await response.json();
    const detail = typeof answer.detail === "string" ? answer.detail : "the door id is empty or too long";
    write("answer", answer.message || detail);
  } catch {
    write("answer", "the cell did not answer; look whether it is still running");
  } finally {
    buttons.forEach((button) => { button.disabled = false; });
  }
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
setInterval(() => { if (Date.now() - heard > SILENCE) byId("lost").hidden = false; }, 1000);
connect();
