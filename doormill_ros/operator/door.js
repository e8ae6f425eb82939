// The door in hand, or the last one: its features, which of them is milled, and how far each is off.
import { byId, size, text, write } from "./language.js";

const GAP = 160; // mm between two faces
const TICK = 1000; // ms
const NONE = "–";
const FACES = ["hinge_edge", "front", "lock_edge"];
let drawn = null;
let begun = null; // when this page saw the robot begin with that run

function made(parent, kind, attributes, words) {
  const element = document.createElementNS(byId("drawing").namespaceURI, kind);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (words) element.textContent = words;
  parent.append(element);
  return element;
}

// The robot tells that it mills, not what: while it does, the plan's clock tells features before, in and after work.
function cameTo(feature) {
  if (feature.came_to !== "in_work" || feature.end <= 0 || !begun) return feature.came_to;
  const passed = (Date.now() - begun.at) / 1000;
  if (passed < feature.begin) return "planned";
  return passed < feature.end ? "in_work" : "milled";
}

function drawFaces(door) {
  const drawing = byId("drawing");
  drawing.replaceChildren();
  const widths = { hinge_edge: door.thickness, front: door.width, lock_edge: door.thickness };
  let left = GAP;
  for (const face of FACES) {
    const frame = { class: "wood", x: left, y: GAP, width: widths[face], height: door.height };
    made(drawing, "rect", frame);
    made(drawing, "text", { x: left + widths[face] / 2, y: GAP - 30, "text-anchor": "middle" }, text(`face.${face}`));
    for (const feature of door.features.filter((one) => one.face === face)) {
      const points = feature.outline.map(([u, v]) => `${left + u},${GAP + door.height - v}`).join(" ");
      const came = cameTo(feature);
      const polygon = made(drawing, "polygon", { class: feature.hidden ? `${came} hidden` : came, points });
      made(polygon, "title", {}, text("drawing.feature", { feature: feature.name, came: text(`came.${came}`) }));
    }
    left += widths[face] + GAP;
  }
  drawing.setAttribute("viewBox", `0 0 ${left} ${door.height + 2 * GAP}`);
}

function listFeatures(door) {
  const rows = door.features.map((feature) => {
    const row = document.createElement("tr");
    const came = cameTo(feature);
    row.className = came;
    const error = feature.deviation < 0 ? NONE : size(feature.deviation);
    const allowed = feature.tolerance > 0 ? size(feature.tolerance) : NONE;
    for (const words of [feature.name, text(`came.${came}`), error, allowed]) row.insertCell().textContent = words;
    return row;
  });
  byId("drawing-features").replaceChildren(...rows);
}

export function showDoor(door) {
  drawn = door;
  byId("door-drawing").hidden = !door;
  if (!door) return;
  const inWork = door.features.some((feature) => feature.came_to === "in_work");
  if (!inWork) begun = null;
  else if (!begun || begun.run !== door.run_id) begun = { run: door.run_id, at: Date.now() };
  byId("drawing-hint").hidden = !inWork || !door.features.some((feature) => feature.end > 0);
  write("drawing-title", text("drawing", { door: door.door_id }));
  drawFaces(door);
  listFeatures(door);
}

setInterval(() => { if (begun && drawn) showDoor(drawn); }, TICK);
